//! The components of a mesh, and how many vertices each may still lose.
//!
//! The text's rules let a closed component go down to a tetrahedron, which says nothing of its shape; and since the volume
//! is kept, the corners of that lie far outside of what it was. So a component keeps more vertices the more it had.

use super::corners::{Corners, NONE};
use super::surface::Vertex;
use crate::mesh::Sets;

/// Vertices that every component keeps, if it has them.
const FEWEST: u32 = 4;
/// One more is kept for so many that it had, …
const FOR_EACH: u32 = 24;
/// … but no more than so many.
const MOST: u32 = 20;

/// Which component each vertex belongs to.
#[derive(Debug)]
pub(super) struct Parts {
    /// A vertex of its component, for each vertex: its number before any was gone.
    of: Vec<u32>,
    /// How many vertices the component may lose, at that vertex.
    spare: Vec<u32>,
}

impl Parts {
    /// Cost: one pass over the corners.
    pub(super) fn new(vertices: &[Vertex], corners: &Corners) -> Self {
        let mut sets = Sets::new(vertices.len());
        for side in 0..corners.len() {
            let [from, to] = corners.ends(side);
            sets.join(from, to);
        }
        let of: Vec<u32> = (0..vertices.len() as u32).map(|vertex| sets.root(vertex)).collect();
        let mut spare = vec![0_u32; vertices.len()];
        of.iter().for_each(|&root| spare[root as usize] += 1);
        for count in &mut spare {
            *count = count.saturating_sub((FEWEST + *count / FOR_EACH).min(MOST));
        }
        Self { of, spare }
    }

    /// Whether the component of a vertex may lose one more; if so, it is counted as gone.
    pub(super) fn spare(&mut self, vertex: u32) -> bool {
        let spare = &mut self.spare[self.of[vertex as usize] as usize];
        let left = spare.checked_sub(1);
        *spare = left.unwrap_or(0);
        left.is_some()
    }

    /// Leaves out the vertices that are gone, as [`super::surface::Surface::compact`] does.
    pub(super) fn compact(&mut self, vertices: &[Vertex]) {
        let mut vertices = vertices.iter();
        self.of.retain(|_| vertices.next().is_some_and(|vertex| vertex.leaving != NONE));
    }
}
