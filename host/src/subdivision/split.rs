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
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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
        let mut split = Self::empty(vertices, faces.len(), faces.corners().len());
        // Edges that wait for their second side.
        let mut open = HashMap::with_capacity(faces.corners().len() / 4);
        for (face, corners) in faces.iter().enumerate() {
            for (side, &from) in corners.iter().enumerate() {
                let to = corners[(side + 1) % corners.len()];
                let ends = [from.min(to), from.max(to)];
                let mut edge = open.remove(&ends).unwrap_or(u32::MAX);
                if edge == u32::MAX {
                    open.insert(ends, split.edges.len() as u32);
                }
                split.meet(&mut edge, [from, to], face as u32);
            }
        }
        assert!(u32::try_from(split.finer_vertices()).is_ok(), "fewer than 2^32 vertices");
        split.make_quads(faces.iter());
        split
    }

    /// The split of the finer mesh: what [`Split::new`] makes of [`Split::finer_faces`], but without a hash table, as
    /// each edge of the finer mesh is half an old one or leads into the middle of a face.
    ///
    /// Cost: one pass over the quads.
    ///
    /// # Panics
    /// If the mesh after that has 2^32 vertices or more.
    pub fn finer(&self) -> Self {
        let mut finer = Self::empty(self.finer_vertices(), self.quads.len(), 4 * self.quads.len());
        // Halves of each edge, by its ends; then, for each side, the way from its edge to the middle of its face.
        let halves = 2 * self.edges.len();
        let mut numbers = vec![u32::MAX; halves + self.quads.len()];
        let half = |edge_vertex: u32, end: u32| {
            let edge = edge_vertex as usize - self.vertices;
            2 * edge + usize::from(self.edges[edge][0] != end)
        };
        let mut first = 0;
        for face in self.quads.chunk_by(|one, next| one[2] == next[2]) {
            for (side, quad) in face.iter().enumerate() {
                let before = (side + face.len() - 1) % face.len();
                let ways = [side, before].map(|side| halves + first + side);
                let met = [half(quad[1], quad[0]), ways[0], ways[1], half(quad[3], quad[0])];
                for (corner, met) in met.into_iter().enumerate() {
                    let ends = [quad[corner], quad[(corner + 1) % 4]];
                    finer.meet(&mut numbers[met], ends, (first + side) as u32);
                }
            }
            first += face.len();
        }
        assert!(u32::try_from(finer.finer_vertices()).is_ok(), "fewer than 2^32 vertices");
        finer.make_quads(self.quads.iter().map(<[u32; 4]>::as_slice));
        finer
    }

    fn empty(vertices: usize, faces: usize, sides: usize) -> Self {
        Self {
            vertices,
            faces,
            edges: Vec::with_capacity(sides / 2),
            edge_faces: Vec::with_capacity(sides / 2),
            side_edges: Vec::with_capacity(sides),
            quads: Vec::with_capacity(sides),
        }
    }

    /// A side of `face` with these ends, of an edge whose number is known if a side met it before.
    fn meet(&mut self, number: &mut u32, ends: [u32; 2], face: u32) {
        if *number == u32::MAX {
            *number = self.edges.len() as u32;
            self.edges.push(ends);
            self.edge_faces.push([Some(face), None]);
        } else {
            self.edge_faces[*number as usize][1] = Some(face);
        }
        self.side_edges.push(*number);
    }

    fn make_quads<'a>(&mut self, faces: impl Iterator<Item = &'a [u32]>) {
        let mut start = 0;
        for (face, corners) in faces.enumerate() {
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
        assert_eq!(finer, split.finer());
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
        assert_eq!(split.finer(), Split::new(split.finer_vertices(), &split.finer_faces()));
    }

    #[test]
    fn the_third_side_of_an_edge_is_an_edge_of_its_own() {
        let faces: Faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]].iter().map(<[u32; 3]>::as_slice).collect();
        let split = Split::new(5, &faces);
        assert_eq!(split.edges.len(), 8);
        let finer = Split::new(split.finer_vertices(), &split.finer_faces());
        assert_eq!(finer, split.finer());
        assert_eq!(finer.finer(), Split::new(finer.finer_vertices(), &finer.finer_faces()));
    }
}
