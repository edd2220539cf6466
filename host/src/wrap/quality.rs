//! Corners of faces that are turned over.

use rayon::prelude::*;

use super::goal::Goal;
use super::level::{Level, Space};
use crate::mesh::Point;

/// Faces that are not as they should be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inverted {
    /// Faces of which a corner is turned over or has no area.
    pub corners: usize,
    /// Faces that are turned over as a whole.
    pub faces: usize,
}

/// Sine of the angle at `place` from `next` to `before`, negative where it is turned over against the direction `outwards`,
/// and less the more it is out of the tangent plane: 1 is a right angle in it. No angle is -1.
pub(super) fn corner(before: Point, place: Point, next: Point, outwards: Point) -> f64 {
    let (to_next, to_before) = (next - place, before - place);
    let sine = to_next.cross(to_before).dot(outwards)
        / (to_next.length_squared() * to_before.length_squared() * outwards.length_squared()).sqrt();
    if sine.is_finite() { sine } else { -1.0 }
}

/// All corners of a face.
fn corners(face: &[u32], positions: &[Point], outwards: Point) -> impl Iterator<Item = f64> {
    let at = move |place: usize| positions[face[place % face.len()] as usize];
    (0..face.len()).map(move |place| corner(at(place), at(place + 1), at(place + 2), outwards))
}

/// The least corner of a face.
pub(super) fn least_corner(face: &[u32], positions: &[Point], outwards: Point) -> f64 {
    corners(face, positions, outwards).fold(1.0, f64::min)
}

/// How much the corners of a face are below `fair`: the sum of squares.
pub(super) fn shortfall(face: &[u32], positions: &[Point], outwards: Point, fair: f64) -> f64 {
    corners(face, positions, outwards).map(|corner| (fair - corner).max(0.0).powi(2)).sum()
}

/// Twice the area of a face, as a vector.
fn area(face: &[u32], positions: &[Point]) -> Point {
    let at = |place: usize| positions[face[place] as usize];
    let spokes = (1..face.len() - 1).map(|place| (at(place) - at(0)).cross(at(place + 1) - at(0)));
    spokes.sum()
}

/// The faces with a corner below `least`, in order, and counts of those below zero.
pub(super) fn inverted(level: &Level, space: &Space, goal: &Goal, least: f64) -> (Vec<u32>, Inverted) {
    let positions = &level.positions;
    let outwards: Vec<Point> = (0..positions.len())
        .into_par_iter()
        .map(|vertex| goal.outwards(positions[vertex], level.normal(vertex), space))
        .collect();
    let judge = |face: usize| {
        let corners = level.faces.get(face);
        let outwards = corners.iter().map(|&corner| outwards[corner as usize]).sum();
        let worst = least_corner(corners, positions, outwards);
        let over = area(corners, positions).dot(outwards) <= 0.0;
        (worst < least).then_some((face as u32, worst <= 0.0, over))
    };
    let found: Vec<_> = (0..level.faces.len()).into_par_iter().filter_map(judge).collect();
    let count = |is: fn(&(u32, bool, bool)) -> bool| found.iter().filter(|one| is(one)).count();
    let counts = Inverted { corners: count(|one| one.1), faces: count(|one| one.2) };
    (found.into_iter().map(|(face, ..)| face).collect(), counts)
}

/// Those of some faces that have a corner below `least`, in order.
pub(super) fn bad_of(level: &Level, space: &Space, goal: &Goal, faces: &[u32], least: f64) -> Vec<u32> {
    let outwards = |&corner: &u32| {
        let vertex = corner as usize;
        goal.outwards(level.positions[vertex], level.normal(vertex), space)
    };
    let is_bad = |&&face: &&u32| {
        let corners = level.faces.get(face as usize);
        least_corner(corners, &level.positions, corners.iter().map(outwards).sum()) < least
    };
    faces.par_iter().filter(is_bad).copied().collect()
}
