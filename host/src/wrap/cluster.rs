//! A small part of a mesh, cut out to be worked on.

use std::collections::HashMap;

use rayon::prelude::*;

use super::border::Sides;
use super::level::Level;
use super::rings::Kind;
use crate::mesh::{Faces, Point, Sets};

/// Vertices that hang together, and all of their faces. Vertices are numbered anew: those that may move, in ascending order,
/// then the others of these faces.
#[derive(Debug)]
pub(super) struct Cluster {
    /// Numbers in the whole mesh.
    pub(super) vertices: Vec<u32>,
    /// How many of them may move.
    pub(super) movable: usize,
    /// The faces of the vertices that may move.
    pub(super) faces: Faces,
    /// Numbers of the faces in the whole mesh.
    pub(super) numbers: Vec<u32>,
    /// Faces of each vertex that may move.
    pub(super) faces_of: Vec<Vec<u32>>,
    /// Edge neighbours of each vertex that may move: on a crease or an edge of the box, only those along it; none where it
    /// is fixed.
    pub(super) neighbours: Vec<Vec<u32>>,
    /// The sides of the box that vertices are held to.
    pub(super) sides: Vec<Sides>,
    /// Unit normals of the mesh at the vertices.
    pub(super) normals: Vec<Point>,
    /// Where the vertices are.
    pub(super) positions: Vec<Point>,
}

impl Cluster {
    /// Mean length of the edges of a vertex that may move.
    pub(super) fn edge_length(&self, vertex: usize) -> f64 {
        let (ends, place) = (&self.neighbours[vertex], self.positions[vertex]);
        let lengths = ends.iter().map(|&end| self.positions[end as usize].distance(place));
        lengths.sum::<f64>() / ends.len().max(1) as f64
    }
}

/// The parts of a mesh within some rings of faces; no face has vertices that may move of two parts.
///
/// Cost: one pass over the faces of the mesh for each ring.
pub(super) fn around(level: &Level, faces: &[u32], rings: usize) -> Vec<Cluster> {
    let mut marked = vec![false; level.positions.len()];
    for &face in faces {
        level.faces.get(face as usize).iter().for_each(|&corner| marked[corner as usize] = true);
    }
    for _ in 0..rings {
        let ring: Vec<u32> = touching(level, &marked);
        for face in ring {
            level.faces.get(face as usize).iter().for_each(|&corner| marked[corner as usize] = true);
        }
    }
    let faces = touching(level, &marked);
    parts(level, &marked, &faces).into_par_iter().map(|faces| cut(level, &marked, &faces)).collect()
}

/// Faces with a marked vertex.
fn touching(level: &Level, marked: &[bool]) -> Vec<u32> {
    let is_marked = |face: &[u32]| face.iter().any(|&corner| marked[corner as usize]);
    let faces = level.faces.iter().enumerate().filter(|(_, face)| is_marked(face));
    faces.map(|(face, _)| face as u32).collect()
}

/// Splits faces, in ascending order, into parts that share no marked vertex.
fn parts(level: &Level, marked: &[bool], faces: &[u32]) -> Vec<Vec<u32>> {
    let marked_corners =
        |face: u32| level.faces.get(face as usize).iter().copied().filter(|&corner| marked[corner as usize]);
    let mut sets = Sets::new(level.positions.len());
    for &face in faces {
        let mut corners = marked_corners(face);
        if let Some(first) = corners.next() {
            corners.for_each(|corner| sets.join(first, corner));
        }
    }
    let mut places = HashMap::new();
    let mut parts = Vec::<Vec<u32>>::new();
    for &face in faces {
        let Some(corner) = marked_corners(face).next() else { continue };
        let place = *places.entry(sets.root(corner)).or_insert(parts.len());
        if place == parts.len() {
            parts.push(Vec::new());
        }
        parts[place].push(face);
    }
    parts
}

/// Cuts faces out.
fn cut(level: &Level, marked: &[bool], faces: &[u32]) -> Cluster {
    let corners = || faces.iter().flat_map(|&face| level.faces.get(face as usize)).copied();
    let [mut vertices, mut rim] = [true, false]
        .map(|wanted| corners().filter(|&corner| marked[corner as usize] == wanted).collect::<Vec<_>>());
    for list in [&mut vertices, &mut rim] {
        list.sort_unstable();
        list.dedup();
    }
    let movable = vertices.len();
    vertices.append(&mut rim);
    let number = |vertex: u32| {
        let (inner, rim) = vertices.split_at(movable);
        let found =
            inner.binary_search(&vertex).or_else(|_| rim.binary_search(&vertex).map(|place| movable + place));
        found.expect("a vertex of these faces") as u32
    };
    let mut local = Faces::default();
    let mut faces_of = vec![Vec::new(); movable];
    for (place, &face) in (0..).zip(faces) {
        let corners: Vec<u32> = level.faces.get(face as usize).iter().map(|&corner| number(corner)).collect();
        local.push(&corners);
        for &corner in corners.iter().filter(|&&corner| (corner as usize) < movable) {
            faces_of[corner as usize].push(place);
        }
    }
    let neighbours = |&vertex: &u32| {
        let ends = match level.rings.kind(vertex as usize) {
            Kind::Smooth => level.rings.neighbours(vertex as usize).to_vec(),
            Kind::Crease(ends) => ends.to_vec(),
            // Along an edge of the box.
            Kind::Fixed if level.sides[vertex as usize].count() == 2 => {
                level.rings.ends(vertex as usize).to_vec()
            }
            Kind::Fixed => Vec::new(),
        };
        ends.iter().map(|&end| number(end)).collect()
    };
    Cluster {
        neighbours: vertices[..movable].iter().map(neighbours).collect(),
        sides: vertices.iter().map(|&vertex| level.sides[vertex as usize]).collect(),
        normals: vertices.iter().map(|&vertex| level.normal(vertex as usize)).collect(),
        positions: vertices.iter().map(|&vertex| level.positions[vertex as usize]).collect(),
        vertices,
        movable,
        faces: local,
        numbers: faces.to_vec(),
        faces_of,
    }
}
