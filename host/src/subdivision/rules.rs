//! Which rule each vertex and edge of a mesh follows.
//!
//! Source: the three rules of Vis2000 §3.4. An edge of the boundary counts as sharp.

use std::collections::HashSet;

use super::Split;
use crate::mesh::Features;

/// What moves a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexRule {
    /// All edges and faces around it.
    Smooth,
    /// Only the sharp edges that end in it.
    Crease,
    /// Nothing: a sharp vertex, or one without faces.
    Fixed,
}

/// What moves the vertex in an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeRule {
    /// Its ends and the faces on its two sides.
    Smooth,
    /// Only its ends, as one of them is sharp.
    Held,
    /// Only its ends; and it moves them: a sharp edge or one of the boundary.
    Sharp,
}

/// The rules of a mesh that is split.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rules {
    /// One a vertex.
    pub vertices: Vec<VertexRule>,
    /// One an edge, in the order of [`Split::edges`].
    pub edges: Vec<EdgeRule>,
    /// For each vertex the number of edges that move it; 1 for a fixed one.
    pub movers: Vec<u32>,
}

impl Rules {
    /// The rules of the base mesh, given its first split.
    ///
    /// Cost: one pass over vertices and edges.
    pub fn new(split: &Split, features: &Features) -> Self {
        let sharp: HashSet<_> = features.edges.iter().collect();
        let marked = |edge: usize| {
            let [from, to] = split.edges[edge];
            sharp.contains(&[from.min(to), from.max(to)])
        };
        let mut vertices = vec![VertexRule::Smooth; split.coarser_vertices()];
        for &vertex in &features.vertices {
            vertices[vertex as usize] = VertexRule::Fixed;
        }
        Self::of_mesh(split, vertices, marked)
    }

    /// The rules of the finer mesh, given the split of this one and that of the finer one.
    ///
    /// Cost: one pass over vertices and edges.
    pub fn finer(&self, split: &Split, finer: &Split) -> Self {
        let (old, middles) = (split.coarser_vertices(), split.face_vertex(0) as usize);
        let mut vertices = vec![VertexRule::Smooth; split.finer_vertices()];
        for (vertex, rule) in self.vertices.iter().enumerate() {
            if *rule == VertexRule::Fixed {
                vertices[vertex] = VertexRule::Fixed;
            }
        }
        // Half an edge has an end that was there and one in the edge; the others lead into a face.
        let marked = |edge: usize| {
            let [from, to] = finer.edges[edge].map(|end| end as usize);
            let (least, most) = (from.min(to), from.max(to));
            least < old && most < middles && self.edges[most - old] == EdgeRule::Sharp
        };
        Self::of_mesh(finer, vertices, marked)
    }

    /// The rules of a mesh whose fixed vertices are marked, and for whose edges it is told whether they are sharp.
    fn of_mesh(split: &Split, mut vertices: Vec<VertexRule>, marked: impl Fn(usize) -> bool) -> Self {
        let mut sharp_ends = vec![0; vertices.len()];
        let mut ends = vec![0; vertices.len()];
        let mut edges = vec![EdgeRule::Smooth; split.edges.len()];
        for (edge, rule) in edges.iter_mut().enumerate() {
            if split.edge_faces[edge][1].is_none() || marked(edge) {
                *rule = EdgeRule::Sharp;
            } else if split.edges[edge].iter().any(|&end| vertices[end as usize] == VertexRule::Fixed) {
                *rule = EdgeRule::Held;
            }
            for end in split.edges[edge].map(|end| end as usize) {
                ends[end] += 1;
                sharp_ends[end] += u32::from(*rule == EdgeRule::Sharp);
            }
        }
        let mut movers = vec![1; vertices.len()];
        for (vertex, rule) in vertices.iter_mut().enumerate() {
            if *rule == VertexRule::Fixed || ends[vertex] == 0 {
                *rule = VertexRule::Fixed;
            } else if sharp_ends[vertex] > 0 {
                *rule = VertexRule::Crease;
                movers[vertex] = sharp_ends[vertex];
            } else {
                movers[vertex] = ends[vertex];
            }
        }
        Self { vertices, edges, movers }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Faces;

    #[test]
    fn features_move_nothing_across_them() {
        // A square of 2 by 2 quads with a sharp vertex in the middle and a sharp edge to it.
        let quads = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]];
        let faces: Faces = quads.iter().map(<[u32; 4]>::as_slice).collect();
        let split = Split::new(9, &faces);
        let smooth = Rules::new(&split, &Features::default());
        assert_eq!(smooth.vertices[4], VertexRule::Smooth);
        assert_eq!((smooth.movers[4], smooth.movers[1]), (4, 2));
        assert_eq!(smooth.vertices[1], VertexRule::Crease);

        let features = Features { edges: vec![[1, 4]], vertices: vec![4] };
        let rules = Rules::new(&split, &features);
        assert_eq!((rules.vertices[4], rules.movers[4], rules.movers[1]), (VertexRule::Fixed, 1, 3));
        let count = |rules: &Rules, rule| rules.edges.iter().filter(|&&edge| edge == rule).count();
        assert_eq!(
            [EdgeRule::Sharp, EdgeRule::Held, EdgeRule::Smooth].map(|rule| count(&rules, rule)),
            [9, 3, 0]
        );

        let next = split.finer();
        let finer = rules.finer(&split, &next);
        assert_eq!(finer, Rules::new(&next, &split.finer_features(&features)));
        assert_eq!(count(&finer, EdgeRule::Sharp), 18);
    }
}
