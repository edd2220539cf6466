//! Host.

pub mod atomic;
pub mod volume;
