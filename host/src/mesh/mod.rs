//! Meshes: triangles of contours and scans, polygons of base meshes.
//!
//! Positions are in the units of the field or file they come from. Faces are counter-clockwise seen from outside, which
//! for an isosurface is where values are below the isovalue.

mod builder;
mod check;
mod edges;
mod error;
mod feature;
mod file;
mod gltf;
mod intersection;
mod manifold;
mod obj;
mod off;
mod ply;
mod repair;
mod stl;
mod text;
mod triangulation;

pub use check::{Component, Report};
pub(crate) use edges::Sets;
pub use error::{MeshFault, MeshFileError};
pub use feature::FeatureAngles;
pub use file::{MeshFormat, files, read, read_polygons, write, write_as};
pub use glam::DVec3 as Point;
pub use intersection::self_intersections;
pub use repair::Repairs;
pub use triangulation::Triangulation;

/// Points and polygons over them: what files, checks, measures and pictures need of a mesh.
pub trait Surface: Sync {
    /// One point a vertex.
    fn points(&self) -> &[Point];

    /// Corners of each face, counter-clockwise seen from outside.
    fn polygons(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone;
}

/// A surface of triangles with shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// One point a vertex.
    pub positions: Vec<Point>,
    /// Three indices of `positions` a triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A surface of polygons with shared vertices, each of three sides or more.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonMesh {
    /// One point a vertex.
    pub positions: Vec<Point>,
    faces: Faces,
    /// What subdivision keeps sharp.
    pub features: Features,
}

/// Polygons as compressed rows of corners.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faces {
    /// Where the corners of each face begin, and the end of the last: one more than there are faces.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

/// Sharp edges and vertices of a mesh (Vis2000 §3.4). Edges of the boundary are not listed: they are where one face ends.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Features {
    /// Edges that stay sharp, the smaller vertex first, in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// Vertices that stay where they are, in ascending order.
    pub vertices: Vec<u32>,
}

impl Default for Faces {
    fn default() -> Self {
        Self { starts: vec![0], corners: Vec::new() }
    }
}

impl Faces {
    /// Appends a polygon, given by its corners.
    ///
    /// # Panics
    /// If all faces together have 2^32 corners or more.
    pub fn push(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.starts.push(u32::try_from(self.corners.len()).expect("fewer than 2^32 corners"));
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Corners of face `face`, counter-clockwise.
    pub fn get(&self, face: usize) -> &[u32] {
        &self.corners[self.starts[face] as usize..self.starts[face + 1] as usize]
    }

    /// The faces in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        self.starts.array_windows().map(|&[start, end]| &self.corners[start as usize..end as usize])
    }

    /// Corners of all faces together: each face and each of its sides once.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }
}

impl<'a> FromIterator<&'a [u32]> for Faces {
    fn from_iter<I: IntoIterator<Item = &'a [u32]>>(faces: I) -> Self {
        let mut all = Self::default();
        faces.into_iter().for_each(|face| all.push(face));
        all
    }
}

impl PolygonMesh {
    /// A mesh without features.
    ///
    /// # Panics
    /// If a face has fewer than three corners, or a corner names no position.
    pub fn new(positions: Vec<Point>, faces: Faces) -> Self {
        assert!(faces.iter().all(|face| face.len() >= 3), "a polygon has three sides or more");
        assert!(faces.corners().iter().all(|&corner| (corner as usize) < positions.len()));
        Self { positions, faces, features: Features::default() }
    }

    /// The polygons.
    pub fn faces(&self) -> &Faces {
        &self.faces
    }
}

impl Surface for TriangleMesh {
    fn points(&self) -> &[Point] {
        &self.positions
    }

    fn polygons(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        self.triangles.iter().map(<[u32; 3]>::as_slice)
    }
}

impl Surface for PolygonMesh {
    fn points(&self) -> &[Point] {
        &self.positions
    }

    fn polygons(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        self.faces.iter()
    }
}

impl From<TriangleMesh> for PolygonMesh {
    fn from(mesh: TriangleMesh) -> Self {
        let faces = mesh.triangles.iter().map(<[u32; 3]>::as_slice).collect();
        Self::new(mesh.positions, faces)
    }
}
