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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Grid, ScalarField};
    use crate::wrap::goal::Target;
    use crate::wrap::{WrapOptions, tests::cubes, wrap};

    #[test]
    fn vertices_are_drawn_where_that_strains_nothing() {
        let middle = Point::splat(16.0);
        let field = ScalarField::from_function(Grid::unit([33; 3]), |point| point.distance(middle) - 11.0);
        let surface = wrap(&cubes(&field, 8), &field, &WrapOptions::default()).unwrap().surface;
        let (space, goal) = (Space::new(&field), Goal::new(Target::Distance));
        let mut level = Level::base(&surface.level(3), &space.border).unwrap();
        let kept = level.positions.clone();
        let length = level.rings.edge_length(0, &kept);
        let aside = |vertex: u32, lengths: f64| {
            let place = kept[vertex as usize];
            let along = (kept[level.rings.neighbours(vertex as usize)[0] as usize] - place).normalize();
            let moved = place + lengths * length * along;
            Draw { vertex, place: middle + (moved - middle).normalize() * 11.0 }
        };
        // A little aside, beyond all neighbours, and to where the surface faces the other way.
        let far = kept.len() as u32 - 1;
        let opposite = Draw { vertex: 9, place: 2.0 * middle - kept[9] };
        let draws = [aside(0, 0.2), aside(far, 3.0), opposite];
        assert_eq!(draw(&mut level, &space, &goal, &draws), 1);
        let moved: Vec<usize> =
            (0..kept.len()).filter(|&vertex| kept[vertex] != level.positions[vertex]).collect();
        assert_eq!((moved, level.positions[0]), (vec![0], draws[0].place));
        assert_eq!(draw(&mut level, &space, &goal, &[]), 0);
    }
}
