//! Host.

pub mod atomic;
pub mod codec;
pub mod volume;
