#![doc = include_str!("../README.md")]

pub mod array;
pub mod atomic;
pub mod bound;
pub mod codec;
#[cfg(test)]
mod collection;
pub mod distance;
pub mod field;
pub mod integers;
pub mod isosurface;
pub mod measure;
pub mod mesh;
pub mod picture;
pub mod pipeline;
pub mod preview;
pub mod progress;
pub mod simplify;
pub mod subdivision;
pub mod surface_codec;
pub mod surface_wavelet;
pub mod tables;
pub mod transform;
pub mod volume;
pub mod wrap;

pub use ndarray;
pub use wavelift_kernel as kernel;
