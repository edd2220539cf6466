//! Conformance: what the tests of this package share.

pub mod inputs;
pub mod oracle;
pub mod vectors;
