//! Catmull–Clark connectivity: what a mesh becomes when every face of n sides is split into n quads.

mod split;
mod surface;

pub use split::Split;
pub use surface::{Splits, SubdivisionSurface};
