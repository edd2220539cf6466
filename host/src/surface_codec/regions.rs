//! Parts of a surface that are coded on their own: runs of faces of the base mesh.

use std::ops::Range;

use crate::mesh::Faces;
use crate::subdivision::Hierarchy;

/// Steps that all regions share: waves of later ones reach no further than the faces next to their own.
const SHARED_STEPS: usize = 2;

/// Which region each vertex belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Regions {
    /// Vertices before this one belong to all.
    shared: usize,
    /// Regions of the later ones.
    of_vertices: Vec<u32>,
    faces_per_region: usize,
    faces: usize,
}

impl Regions {
    /// Regions of so many faces of the base mesh each, but the last.
    pub(super) fn new(hierarchy: &Hierarchy, base: &Faces, faces_per_region: usize) -> Self {
        let shared_steps = Self::shared_steps(hierarchy);
        let shared = hierarchy.vertices(shared_steps);
        let mut of_vertices = Vec::with_capacity(hierarchy.finest_vertices() - shared);
        let mut of_faces: Vec<u32> = (0..base.len()).map(|face| (face / faces_per_region) as u32).collect();
        for (step, each) in hierarchy.steps().iter().enumerate() {
            let split = &each.split;
            if step >= shared_steps {
                let first = |faces: &[Option<u32>; 2]| faces[0].map_or(0, |face| of_faces[face as usize]);
                of_vertices.extend(split.edge_faces.iter().map(first));
                of_vertices.extend(&of_faces);
            }
            let middle = split.face_vertex(0);
            of_faces = split.quads.iter().map(|quad| of_faces[(quad[2] - middle) as usize]).collect();
        }
        Self { shared, of_vertices, faces_per_region, faces: base.len() }
    }

    /// Number of steps that all regions share.
    pub(super) fn shared_steps(hierarchy: &Hierarchy) -> usize {
        hierarchy.steps().len().min(SHARED_STEPS)
    }

    /// The region of a vertex; `None` if it belongs to all.
    pub(super) fn of_vertex(&self, vertex: usize) -> Option<u32> {
        vertex.checked_sub(self.shared).map(|place| self.of_vertices[place])
    }

    /// Number of regions.
    pub(super) fn len(&self) -> usize {
        self.faces.div_ceil(self.faces_per_region)
    }

    /// The faces of the base mesh that make up a region.
    pub(super) fn faces(&self, region: usize) -> Range<usize> {
        let start = region * self.faces_per_region;
        start..(start + self.faces_per_region).min(self.faces)
    }

    /// A region and all that share a vertex of the base mesh with it.
    pub(super) fn with_neighbours(&self, base: &Faces, region: usize) -> Vec<usize> {
        let own: std::collections::HashSet<u32> =
            self.faces(region).flat_map(|face| base.get(face).iter().copied()).collect();
        let touches = |other: &usize| {
            self.faces(*other).any(|face| base.get(face).iter().any(|corner| own.contains(corner)))
        };
        (0..self.len()).filter(touches).collect()
    }
}
