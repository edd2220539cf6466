//! A mesh while its file is read.

use std::collections::HashMap;

use super::{Faces, MeshFault, Point, PolygonMesh};

/// Vertices and faces so far.
#[derive(Debug, Default)]
pub(super) struct Builder {
    positions: Vec<Point>,
    faces: Faces,
    /// Vertices at each place, if those at the same place are to be one.
    welded: Option<HashMap<[u64; 3], u32>>,
}

impl Builder {
    /// A mesh in which vertices at exactly the same place become one, numbered as they are first met.
    pub(super) fn welding() -> Self {
        Self { welded: Some(HashMap::new()), ..Self::default() }
    }

    /// Takes room for vertices that a file promises: for no more than `bytes` bytes can hold, each of one at least.
    pub(super) fn expect_vertices(&mut self, count: u64, bytes: usize) {
        self.positions.reserve(usize::try_from(count).unwrap_or(bytes).min(bytes / 3));
    }

    /// Vertices so far.
    pub(super) fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// Corners of faces so far.
    pub(super) fn corners(&self) -> usize {
        self.faces.corners().len()
    }

    /// Appends a vertex, and returns its number.
    pub(super) fn vertex(&mut self, position: [f64; 3]) -> Result<u32, MeshFault> {
        let vertex = self.positions.len();
        let point = Point::from_array(position);
        if !point.is_finite() {
            return Err(MeshFault::NotFinite { vertex });
        }
        let number = u32::try_from(vertex).map_err(|_| MeshFault::TooLarge)?;
        if let Some(welded) = &mut self.welded {
            // Adding 0 makes -0 and 0 the same.
            let known = *welded.entry(position.map(|value| (value + 0.0).to_bits())).or_insert(number);
            if known != number {
                return Ok(known);
            }
        }
        self.positions.push(point);
        Ok(number)
    }

    /// Appends a face.
    pub(super) fn face(&mut self, corners: &[u32]) -> Result<(), MeshFault> {
        if corners.len() < 3 {
            return Err(MeshFault::Sides { face: self.faces.len(), sides: corners.len() });
        }
        if u32::try_from(self.corners() + corners.len()).is_err() {
            return Err(MeshFault::TooLarge);
        }
        self.faces.push(corners);
        Ok(())
    }

    /// An index from a file as one of a vertex that is there or may come.
    pub(super) fn index(&self, index: i64) -> Result<u32, MeshFault> {
        u32::try_from(index).map_err(|_| self.no_vertex(self.faces.len(), index))
    }

    fn no_vertex(&self, face: usize, index: i64) -> MeshFault {
        MeshFault::Index { face, index, vertices: self.positions.len() }
    }

    /// The mesh, if it has faces and these have vertices.
    pub(super) fn finish(self) -> Result<PolygonMesh, MeshFault> {
        if self.faces.is_empty() {
            return Err(MeshFault::NoFaces { vertices: self.positions.len() });
        }
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&corner| corner as usize >= self.positions.len()) {
                return Err(self.no_vertex(face, i64::from(index)));
            }
        }
        Ok(PolygonMesh::new(self.positions, self.faces))
    }
}
