//! Measures of surfaces: closest points, distances between surfaces, and how evenly quads lie on them.

mod bounds;
mod bvh;
mod triangle;

pub use bounds::Bounds;
pub use bvh::{Bvh, Closest};
pub use triangle::{Nearest, Triangle};
