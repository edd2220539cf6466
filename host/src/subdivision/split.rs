//! One step of subdivision, connectivity only.
//!
//! Source: Vis2000 §3.1, Diss §4.1.2: the vertices of the finer mesh (the *supermesh*) are the old ones (v), one in each
//! edge (e) and one in each face (f).

use std::collections::HashMap;

use crate::mesh::{Faces, Features};

/// A mesh of polygons and the quads it splits into.
///
/// Vertices of the finer mesh are numbered: the old ones as they were; then one for each edge, in the order in which
/// sides first meet it face by face; then one for each face. So the vertices of a coarse mesh are always the first ones of
/// a finer mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    vertices: usize,
    faces: usize,
    /// Ends of each edge, as the first side that meets it runs.
    pub edges: Vec<[u32; 2]>,
    /// The faces on both sides of each edge: that of the first side, and the other one, if there is one.
    pub edge_faces: Vec<[Option<u32>; 2]>,
    /// For each side of each face, in the order of [`Faces::corners`], the edge from that corner to the next.
    pub side_edges: Vec<u32>,
    /// Quads of the finer mesh, as many as the faces have corners, in that order: corner, the edge after it, face, the
    /// edge before it.
    pub quads: Vec<[u32; 4]>,
}

impl Split {
    /// Splits faces over `vertices` vertices, none of whose edges is shared by more than two sides; further sides of an
    /// edge are taken for boundaries of their own.
    ///
    /// Cost: one pass over the corners, with a hash table of the edges.
    ///
    /// # Panics
    /// If the finer mesh has 2^32 vertices or more.
    pub fn new(vertices: usize, faces: &Faces) -> Self {
        let mut split = Self {
            vertices,
            faces: faces.len(),
            edges: Vec::new(),
            edge_faces: Vec::new(),
            side_edges: Vec::with_capacity(faces.corners().len()),
            quads: Vec::with_capacity(faces.corners().len()),
        };
        // Edges that wait for their second side.
        let mut open = HashMap::with_capacity(faces.corners().len() / 4);
        for (face, corners) in faces.iter().enumerate() {
            for (side, &from) in corners.iter().enumerate() {
                let to = corners[(side + 1) % corners.len()];
                let edge = open.remove(&[from.min(to), from.max(to)]).unwrap_or_else(|| {
                    open.insert([from.min(to), from.max(to)], split.edges.len());
                    split.edges.push([from, to]);
                    split.edge_faces.push([None; 2]);
                    split.edges.len() - 1
                });
                let [first, second] = &mut split.edge_faces[edge];
                *if first.is_none() { first } else { second } = Some(face as u32);
                split.side_edges.push(edge as u32);
            }
        }
        assert!(u32::try_from(split.finer_vertices()).is_ok(), "fewer than 2^32 vertices");
        split.make_quads(faces);
        split
    }

    fn make_quads(&mut self, faces: &Faces) {
        let mut start = 0;
        for (face, corners) in faces.iter().enumerate() {
            let edges = &self.side_edges[start..start + corners.len()];
            start += corners.len();
            let centre = self.face_vertex(face);
            for (side, &corner) in corners.iter().enumerate() {
                let before = edges[(side + corners.len() - 1) % corners.len()];
                let [after, before] = [edges[side], before].map(|edge| self.edge_vertex(edge as usize));
                self.quads.push([corner, after, centre, before]);
            }
        }
    }

    /// Vertices of the coarser mesh.
    pub fn coarser_vertices(&self) -> usize {
        self.vertices
    }

    /// Vertices of the finer mesh.
    pub fn finer_vertices(&self) -> usize {
        self.vertices + self.edges.len() + self.faces
    }

    /// The vertex in an edge.
    pub fn edge_vertex(&self, edge: usize) -> u32 {
        (self.vertices + edge) as u32
    }

    /// The vertex in a face.
    pub fn face_vertex(&self, face: usize) -> u32 {
        (self.vertices + self.edges.len() + face) as u32
    }

    /// The finer mesh as faces, for the next step.
    pub fn finer_faces(&self) -> Faces {
        self.quads.iter().map(<[u32; 4]>::as_slice).collect()
    }

    /// Features of the finer mesh: both halves of every sharp edge, and the sharp vertices.
    pub fn finer_features(&self, features: &Features) -> Features {
        let sharp = |&(_, ends): &(usize, &[u32; 2])| {
            features.edges.binary_search(&[ends[0].min(ends[1]), ends[0].max(ends[1])]).is_ok()
        };
        let halves = self.edges.iter().enumerate().filter(sharp);
        let mut edges: Vec<_> =
            halves.flat_map(|(edge, ends)| ends.map(|end| [end, self.edge_vertex(edge)])).collect();
        edges.sort_unstable();
        Features { edges, vertices: features.vertices.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Faces {
        [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]].iter().map(<[u32; 3]>::as_slice).collect()
    }

    #[test]
    fn a_tetrahedron_becomes_twelve_quads() {
        let split = Split::new(4, &tetrahedron());
        assert_eq!(split.edges, [[0, 1], [1, 2], [2, 0], [0, 3], [3, 1], [3, 2]]);
        assert_eq!(split.finer_vertices(), 4 + 6 + 4);
        assert_eq!(split.quads.len(), 12);
        assert_eq!(split.quads[0], [0, 4, 10, 6]);
        assert!(split.edge_faces.iter().all(|faces| faces.iter().all(Option::is_some)));
        let finer = Split::new(split.finer_vertices(), &split.finer_faces());
        // Euler: every split keeps V - E + F.
        assert_eq!(14 + 12, 2 + finer.edges.len());
    }

    #[test]
    fn features_are_halved() {
        let split = Split::new(4, &tetrahedron());
        let features = Features { edges: vec![[0, 1], [0, 2]], vertices: vec![3] };
        let finer = split.finer_features(&features);
        assert_eq!(finer.edges, [[0, 4], [0, 6], [1, 4], [2, 6]]);
        assert_eq!(finer.vertices, [3]);
    }

    #[test]
    fn a_single_polygon_has_a_boundary_all_round() {
        let faces: Faces = [[0, 1, 2, 3, 4]].iter().map(<[u32; 5]>::as_slice).collect();
        let split = Split::new(5, &faces);
        assert!(split.edge_faces.iter().all(|faces| *faces == [Some(0), None]));
        assert_eq!(split.quads.len(), 5);
        assert_eq!(split.quads[4], [4, 9, 10, 8]);
    }
}
