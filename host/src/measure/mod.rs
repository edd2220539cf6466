//! Measures of surfaces: closest points, distances between surfaces, and how evenly quads lie on them.

mod bounds;
mod bvh;
mod deviation;
mod distortion;
mod triangle;

pub use bounds::Bounds;
pub use bvh::{Bvh, Closest};
pub use deviation::{Deviation, SurfaceDistance};
pub use distortion::{Distortion, QuadShape, Spread};
pub use triangle::{Nearest, Triangle};
