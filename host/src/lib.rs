#![doc = include_str!("../README.md")]

pub mod atomic;
pub mod bound;
pub mod codec;
pub mod integers;
pub mod tables;
pub mod transform;
pub mod volume;
