//! Surfaces with subdivision connectivity.

use super::{Hierarchy, Limit, Split, limit};
use crate::mesh::{Faces, Features, Point, PolygonMesh};

/// A base mesh split a number of times, and a point for every vertex of the finest mesh.
///
/// Vertices are numbered as [`Split`] numbers them, so the points of a coarser level are the first ones.
#[derive(Clone, Debug, PartialEq)]
pub struct SubdivisionSurface {
    /// Polygons of the base mesh, no edge of which has more than two sides.
    pub base: Faces,
    /// Sharp edges and vertices of the base mesh.
    pub features: Features,
    /// How often the base mesh was split.
    pub levels: u32,
    /// One point a vertex of the finest mesh.
    pub positions: Vec<Point>,
}

/// The steps of subdivision from a base mesh up to some level.
#[derive(Clone, Debug)]
pub struct Splits {
    next: Split,
    left: u32,
}

impl From<PolygonMesh> for SubdivisionSurface {
    /// The surface of no levels: the base mesh itself.
    fn from(mesh: PolygonMesh) -> Self {
        let base = mesh.faces().clone();
        Self { base, features: mesh.features, levels: 0, positions: mesh.positions }
    }
}

impl SubdivisionSurface {
    /// Number of vertices of the base mesh.
    ///
    /// Cost: one pass over the sides of the base mesh, with a hash table.
    pub fn base_vertices(&self) -> usize {
        self.vertices(0)
    }

    /// Number of vertices of a level, the base mesh being level 0.
    ///
    /// # Panics
    /// If there are fewer points than the base mesh and the levels ask for.
    pub fn vertices(&self, level: u32) -> usize {
        let split = Split::new(0, &self.base);
        let (mut edges, mut faces, mut sides) =
            (split.edges.len(), self.base.len(), self.base.corners().len());
        let mut finer = Vec::new();
        for _ in 0..self.levels {
            finer.push(edges + faces);
            // Each edge is halved and each corner of a face gets an edge to the middle; each quad has four sides.
            (edges, faces, sides) = (2 * edges + sides, sides, 4 * sides);
        }
        let later: usize = finer.get(level as usize..).unwrap_or_default().iter().sum();
        self.positions.len().checked_sub(later).expect("a point for every vertex of the finest mesh")
    }

    /// The steps of subdivision, from the base mesh to the finest one.
    pub fn splits(&self) -> Splits {
        self.splits_to(self.levels)
    }

    /// Adds a level, given the points of the vertices that the split of the finest mesh adds.
    ///
    /// # Panics
    /// If there are not as many points as the split has new vertices.
    pub fn refine(&mut self, split: &Split, added: &[Point]) {
        self.positions.extend_from_slice(added);
        assert_eq!(
            self.positions.len(),
            split.finer_vertices(),
            "a point for every vertex of the finer mesh"
        );
        self.levels += 1;
    }

    /// A level as a mesh: polygons at level 0, else quads, with the features of that level.
    ///
    /// Quads that come from the same face of level 1 follow each other: patch `i` has the quads
    /// `i * 4^(level-1)..(i + 1) * 4^(level-1)`.
    ///
    /// # Panics
    /// If `level` is more than `levels`.
    pub fn level(&self, level: u32) -> PolygonMesh {
        assert!(level <= self.levels, "a level that the surface has");
        let (mut faces, mut features) = (self.base.clone(), self.features.clone());
        for split in self.splits_to(level) {
            (faces, features) = (split.finer_faces(), split.finer_features(&features));
        }
        let positions = self.positions[..self.vertices(level)].to_vec();
        let mut mesh = PolygonMesh::new(positions, faces);
        mesh.features = features;
        mesh
    }

    /// For each face of a level the face of the base mesh that it is part of: a patch of one colour.
    pub fn patches(&self, level: u32) -> Vec<u32> {
        let parts = |face: &[u32]| if level == 0 { 1 } else { face.len() << (2 * (level - 1)) };
        let faces = self.base.iter().enumerate();
        faces.flat_map(|(face, corners)| std::iter::repeat_n(face as u32, parts(corners))).collect()
    }

    /// Where bicubic subdivision would bring the vertices of a level, and the normals there; the faces are those of
    /// [`SubdivisionSurface::level`].
    ///
    /// # Panics
    /// If `level` is more than `levels`.
    pub fn limit(&self, level: u32) -> Limit {
        let hierarchy = Hierarchy::new(self.base_vertices(), &self.base, &self.features, level + 1);
        limit(&hierarchy.steps()[level as usize], &self.level(level))
    }

    fn splits_to(&self, level: u32) -> Splits {
        Splits { next: Split::new(self.base_vertices(), &self.base), left: level }
    }
}

impl Iterator for Splits {
    type Item = Split;

    fn next(&mut self) -> Option<Split> {
        self.left = self.left.checked_sub(1)?;
        let after = if self.left > 0 { self.next.finer() } else { Split::default() };
        Some(std::mem::replace(&mut self.next, after))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left as usize, Some(self.left as usize))
    }
}

impl ExactSizeIterator for Splits {}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box without a bottom, whose lid is two triangles.
    fn surface() -> SubdivisionSurface {
        let faces: Faces =
            [&[0, 1, 5, 4][..], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7], &[4, 5, 6], &[4, 6, 7]]
                .into_iter()
                .collect();
        let corner = |i: u32| Point::new(f64::from((i + 1) & 2), f64::from(i & 2), f64::from(i & 4));
        let mut mesh = PolygonMesh::new((0..8).map(corner).collect(), faces);
        mesh.features.edges = vec![[4, 6]];
        mesh.into()
    }

    #[test]
    fn levels_are_prefixes_of_each_other() {
        let mut surface = surface();
        for _ in 0..3 {
            let split = Split::new(surface.positions.len(), surface.level(surface.levels).faces());
            let added = vec![Point::X; split.finer_vertices() - split.coarser_vertices()];
            surface.refine(&split, &added);
        }
        let counts: Vec<_> = surface.splits().map(|split| split.coarser_vertices()).collect();
        assert_eq!(counts, [0, 1, 2].map(|level| surface.vertices(level)));
        assert_eq!(surface.vertices(3), surface.positions.len());
        assert_eq!(surface.base_vertices(), 8);
        let mesh = surface.level(2);
        assert_eq!(mesh.faces().len(), 22 * 4);
        assert_eq!(mesh.positions, surface.positions[..mesh.positions.len()]);
        assert_eq!(mesh.features.edges.len(), 4);
        assert_eq!(surface.level(0).faces(), &surface.base);
        assert_eq!(surface.patches(0), [0, 1, 2, 3, 4, 5]);
        let patches = surface.patches(2);
        assert_eq!(patches.len(), mesh.faces().len());
        // Four faces of 4 times 4 quads, then two of 3 times 4.
        assert_eq!([patches[15], patches[16], patches[64], patches[87]], [0, 1, 4, 5]);
        assert_eq!(surface.limit(3).positions.len(), surface.positions.len());
    }

    #[test]
    #[should_panic(expected = "a point for every vertex")]
    fn a_split_of_another_mesh_is_refused() {
        let mut surface = surface();
        let split = Split::new(3, &[&[0, 1, 2][..]].into_iter().collect());
        surface.refine(&split, &[]);
    }
}
