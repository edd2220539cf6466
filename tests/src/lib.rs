//! Conformance: what the tests of this package share.

pub mod corrupt;
pub mod effort;
pub mod inputs;
pub mod lent;
pub mod mutation;
pub mod oracle;
pub mod reference;
pub mod slabs;
pub mod streams;
pub mod vectors;
