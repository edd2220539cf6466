//! Crests: vertices of the finest mesh go where the surface is most.
//!
//! A trilinear field is bent where cells meet, and so are its isosurfaces. A mesh whose vertices lie anywhere on them cuts
//! the crests off, by more the rougher the field is. So points of the target that the mesh passes at a distance each draw
//! the nearest vertex to them, unless that strains its faces.

use std::collections::HashMap;

use rayon::prelude::*;

use super::cluster::{self, Cluster};
use super::goal::Goal;
use super::level::{Level, Space};
use super::quality;
use crate::mesh::Point;

/// How far a vertex may be drawn, in lengths of its edges.
const LEASH: f64 = 0.75;
/// No corner may come below this: the sine of an angle.
const LEAST_CORNER: f64 = 0.2;

/// A point of the target, and the vertex that is to go there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// The vertex of the finest mesh.
    pub vertex: u32,
    /// The point.
    pub place: Point,
}

/// Draws vertices to points, no vertex to two; how many moved.
///
/// Clusters of vertices are drawn in parallel, so that the result does not depend on threads.
pub(super) fn draw(level: &mut Level, space: &Space, goal: &Goal, draws: &[Draw]) -> usize {
    let places: HashMap<u32, Point> = draws.iter().map(|draw| (draw.vertex, draw.place)).collect();
    let is_drawn = |face: &[u32]| face.iter().any(|corner| places.contains_key(corner));
    let faces: Vec<u32> =
        (0..).zip(level.faces.iter()).filter(|(_, face)| is_drawn(face)).map(|(face, _)| face).collect();
    if faces.is_empty() {
        return 0;
    }
    let drawn = |cluster| drawn(cluster, space, goal, &places);
    let moved: Vec<Vec<(u32, Point)>> =
        cluster::around(level, &faces, 0).into_par_iter().map(drawn).collect();
    let mut count = 0;
    for (vertex, place) in moved.into_iter().flatten() {
        level.positions[vertex as usize] = place;
        count += 1;
    }
    count
}

/// The vertices of a cluster that could be drawn, and where they went.
fn drawn(
    mut cluster: Cluster,
    space: &Space,
    goal: &Goal,
    places: &HashMap<u32, Point>,
) -> Vec<(u32, Point)> {
    let facing = |cluster: &Cluster, vertex: usize| {
        goal.outwards(cluster.positions[vertex], cluster.normals[vertex], space)
    };
    let mut outwards: Vec<Point> =
        (0..cluster.positions.len()).map(|vertex| facing(&cluster, vertex)).collect();
    let mut moved = Vec::new();
    for vertex in 0..cluster.movable {
        let Some(&place) = places.get(&cluster.vertices[vertex]) else { continue };
        let before = (cluster.positions[vertex], outwards[vertex]);
        let fits = space.border.hold(cluster.sides[vertex], place) == place;
        let near = place.distance(before.0) <= LEASH * cluster.edge_length(vertex);
        let ends = cluster.neighbours[vertex].len();
        if !fits || !near || ends < 2 || (ends == 2 && cluster.sides[vertex].count() == 0) {
            continue;
        }
        let least = least_corner(&cluster, &outwards, vertex);
        cluster.positions[vertex] = place;
        outwards[vertex] = facing(&cluster, vertex);
        let agrees = outwards[vertex].dot(cluster.normals[vertex]) > 0.0;
        if agrees && least_corner(&cluster, &outwards, vertex) >= least.min(LEAST_CORNER) {
            moved.push((cluster.vertices[vertex], place));
        } else {
            (cluster.positions[vertex], outwards[vertex]) = before;
        }
    }
    moved
}

/// The least corner of the faces of a vertex.
fn least_corner(cluster: &Cluster, outwards: &[Point], vertex: usize) -> f64 {
    let of_face = |&face: &u32| {
        let face = cluster.faces.get(face as usize);
        let outwards = face.iter().map(|&corner| outwards[corner as usize]).sum();
        quality::least_corner(face, &cluster.positions, outwards)
    };
    cluster.faces_of[vertex].iter().map(of_face).fold(1.0, f64::min)
}
