//! All steps of subdivision from a base mesh, with their rules.

use std::ops::Range;

use super::{Rules, Split, SubdivisionSurface};
use crate::mesh::{Faces, Features};

/// One step of subdivision and what moves the vertices of the mesh that it splits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The coarser mesh and its quads.
    pub split: Split,
    /// What moves its vertices.
    pub rules: Rules,
}

/// The connectivity of a base mesh and all its levels as arrays of indices: for a finest mesh of n vertices about 40 n
/// bytes, next to the 24 n of its points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hierarchy {
    base_vertices: usize,
    /// Where the sides of each face of the base mesh begin, and the end of the last.
    base_starts: Vec<usize>,
    steps: Vec<Step>,
}

impl Hierarchy {
    /// Splits a base mesh of so many vertices `levels` times.
    ///
    /// Cost: one pass over the quads of all levels; only the base mesh is hashed.
    ///
    /// # Panics
    /// If a level has 2^32 vertices or more.
    pub fn new(base_vertices: usize, base: &Faces, features: &Features, levels: u32) -> Self {
        let mut steps: Vec<Step> = Vec::with_capacity(levels as usize);
        for _ in 0..levels {
            let step = match steps.last() {
                None => {
                    let split = Split::new(base_vertices, base);
                    let rules = Rules::new(&split, features);
                    Step { split, rules }
                }
                Some(Step { split, rules }) => {
                    let finer = split.finer();
                    let rules = rules.finer(split, &finer);
                    Step { split: finer, rules }
                }
            };
            steps.push(step);
        }
        let starts = base.iter().scan(0, |end, face| {
            *end += face.len();
            Some(*end)
        });
        Self { base_vertices, base_starts: std::iter::once(0).chain(starts).collect(), steps }
    }

    /// The steps from coarse to fine.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Number of vertices of a level, the base mesh being level 0.
    ///
    /// # Panics
    /// If there are fewer levels.
    pub fn vertices(&self, level: usize) -> usize {
        level.checked_sub(1).map_or(self.base_vertices, |step| self.steps[step].split.finer_vertices())
    }

    /// Which sides a face of the mesh that a step splits has, in the order of [`Split::side_edges`].
    pub fn sides(&self, step: usize, face: usize) -> Range<usize> {
        if step == 0 { self.base_starts[face]..self.base_starts[face + 1] } else { 4 * face..4 * face + 4 }
    }

    /// Number of vertices of the finest mesh.
    pub fn finest_vertices(&self) -> usize {
        self.vertices(self.steps.len())
    }
}

impl From<&SubdivisionSurface> for Hierarchy {
    fn from(surface: &SubdivisionSurface) -> Self {
        Self::new(surface.base_vertices(), &surface.base, &surface.features, surface.levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Point, PolygonMesh};

    #[test]
    fn steps_are_those_of_the_surface() {
        let faces: Faces = [&[0, 1, 2, 3][..], &[0, 3, 4], &[3, 2, 4]].into_iter().collect();
        let mut surface = SubdivisionSurface::from(PolygonMesh::new(vec![Point::ZERO; 5], faces));
        surface.features.edges = vec![[0, 3]];
        for _ in 0..2 {
            let split = Split::new(surface.positions.len(), surface.level(surface.levels).faces());
            surface.refine(&split, &vec![Point::ZERO; split.finer_vertices() - split.coarser_vertices()]);
        }
        let hierarchy = Hierarchy::from(&surface);
        assert!(hierarchy.steps().iter().map(|step| &step.split).eq(&surface.splits().collect::<Vec<_>>()));
        assert_eq!(hierarchy.finest_vertices(), surface.positions.len());
        assert_eq!(hierarchy.vertices(0), 5);
        assert_eq!(
            hierarchy.steps()[1].rules,
            Rules::new(&hierarchy.steps()[1].split, &surface.level(1).features)
        );
    }
}
