//! Catmull–Clark connectivity: what a mesh becomes when every face of n sides is split into n quads, and what moves its
//! vertices.

mod hierarchy;
mod limit;
mod rules;
mod split;
mod surface;

pub use hierarchy::{Hierarchy, Step};
pub(crate) use limit::area_vectors;
pub use limit::{Limit, limit, normals};
pub use rules::{EdgeRule, Rules, VertexRule};
pub use split::Split;
pub use surface::{Splits, SubdivisionSurface};
