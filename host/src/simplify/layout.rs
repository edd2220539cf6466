//! The triangles around an edge, laid out flat, before and after its collapse.
//!
//! The outline is laid out around the merged vertex by distances and angles, these scaled to fill a round, or half of one on
//! the boundary (M. Floater, Parametrization and smooth approximation of surface triangulations, 1997); the ends of the edge
//! go inside by mean value coordinates (M. Floater, 2003). Where a triangle would turn over that way, the outline is a
//! regular polygon instead and all weights are equal, under which none does (W. Tutte, How to draw a graph, 1963).

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::corners::NONE;
use super::legality::MOST;
use crate::mesh::Point;

/// Least area of a laid out triangle, against that of a square over the mean distance of the outline.
const LEAST_AREA: f64 = 1e-4;
/// Corners of an outline, at most.
const CORNERS: usize = MOST as usize + 1;

/// A triangle that keeps two vertices when an edge is collapsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wing {
    /// The side of it that leaves the end of the edge.
    pub(super) side: u32,
    /// The vertices that it keeps, counter-clockwise.
    pub(super) rim: [u32; 2],
}

/// What is around an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Star<'a> {
    /// The merged vertex.
    pub(super) centre: Point,
    /// The ends of the edge.
    pub(super) ends: [Point; 2],
    /// Whether the boundary passes through them.
    pub(super) boundary: [bool; 2],
    /// Wings of the first end, and from `split` on of the second one, each in any order.
    pub(super) wings: &'a [Wing],
    pub(super) split: usize,
    /// Vertices across from the edge to its left and right; [`NONE`] to the right of a boundary.
    pub(super) across: [u32; 2],
}

/// The vertices around a star, counter-clockwise.
struct Outline {
    names: [u32; CORNERS],
    /// The place of each wing's first vertex.
    of_wings: [usize; MOST as usize],
    /// Number of vertices.
    corners: usize,
    /// Whether it goes all around the merged vertex.
    closed: bool,
}

/// A star laid out flat around the merged vertex, which is at zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// What the triangles after the collapse have beside the merged vertex, in the order of the wings.
    rims: [[DVec2; 2]; MOST as usize],
    /// Triangles before it: those of the wings from the end on, then those at the edge where its sides begin.
    before: [[DVec2; 3]; MOST as usize + 2],
    wings: usize,
    triangles: usize,
}

/// Weights of what an end is joined to: the corners of the outline, and last the other end.
type Weights = [f64; CORNERS + 1];

impl Outline {
    fn new(star: &Star) -> Self {
        let wings = star.wings;
        let first = wings.iter().position(|wing| wings.iter().all(|other| other.rim[1] != wing.rim[0]));
        let (names, of_wings) = ([NONE; CORNERS], [0; MOST as usize]);
        let mut outline = Self { names, of_wings, corners: 0, closed: first.is_none() };
        let mut wing = Some(first.unwrap_or(0));
        while let Some(here) = wing.filter(|_| outline.corners < wings.len()) {
            outline.of_wings[here] = outline.corners;
            outline.names[outline.corners] = wings[here].rim[0];
            outline.corners += 1;
            outline.names[outline.corners] = wings[here].rim[1];
            wing = wings.iter().position(|next| next.rim[0] == wings[here].rim[1]);
        }
        outline.corners += usize::from(!outline.closed);
        outline
    }

    fn find(&self, vertex: u32) -> Option<usize> {
        self.names[..self.corners].iter().position(|&name| name == vertex)
    }

    /// Places of both ends of a wing's rim.
    fn rim(&self, wing: usize) -> [usize; 2] {
        let from = self.of_wings[wing];
        [from, (from + 1) % self.corners]
    }

    /// The angle that it fills.
    fn angle(&self) -> f64 {
        match (self.closed, self.corners) {
            (true, _) => TAU,
            // A single triangle: half a round would leave it without area.
            (false, 2) => TAU / 3.0,
            (false, _) => PI,
        }
    }

    /// Corners by their distances from the merged vertex and the angles between them.
    fn natural(&self, star: &Star, places: &[Point]) -> [DVec2; CORNERS] {
        let mut spokes = [Point::ZERO; CORNERS];
        let mut mean = 0.0;
        for (spoke, &name) in spokes.iter_mut().zip(&self.names[..self.corners]) {
            *spoke = places[name as usize] - star.centre;
            mean += spoke.length() / self.corners as f64;
        }
        let mut turns = [0.0; CORNERS];
        for wing in 0..star.wings.len() {
            let [from, to] = self.rim(wing);
            turns[from] = spokes[from].angle_between(spokes[to]);
        }
        let scale = self.angle() / turns.iter().sum::<f64>();
        let mut angle = 0.0;
        std::array::from_fn(|corner| {
            let place = DVec2::from_angle(angle) * (spokes[corner].length() / mean);
            angle += scale * turns[corner];
            place
        })
    }

    /// Corners of a regular polygon, or of half of one.
    fn even(&self) -> [DVec2; CORNERS] {
        let turns = self.corners - usize::from(!self.closed);
        std::array::from_fn(|corner| DVec2::from_angle(self.angle() * corner as f64 / turns as f64))
    }
}

impl Layout {
    /// Lays a star out, the vertices of its outline being at `places`.
    pub(super) fn new(star: &Star, places: &[Point]) -> Self {
        let outline = Outline::new(star);
        let corners = outline.natural(star, places);
        let weights = mean_values(star, &outline, places);
        let layout = Self::of_corners(star, &outline, &corners, weights);
        if layout.is_sound() {
            return layout;
        }
        let even = weights.map(|weights| weights.map(|weight| if weight == 0.0 { 0.0 } else { 1.0 }));
        Self::of_corners(star, &outline, &outline.even(), even)
    }

    fn of_corners(star: &Star, outline: &Outline, corners: &[DVec2; CORNERS], weights: [Weights; 2]) -> Self {
        let ends = ends(star, outline, corners, &weights);
        let nowhere = DVec2::ZERO;
        let mut layout = Self {
            rims: [[nowhere; 2]; MOST as usize],
            before: [[nowhere; 3]; MOST as usize + 2],
            wings: star.wings.len(),
            triangles: star.wings.len(),
        };
        for wing in 0..layout.wings {
            let [from, to] = outline.rim(wing).map(|corner| corners[corner]);
            layout.rims[wing] = [from, to];
            layout.before[wing] = [ends[usize::from(wing >= star.split)], from, to];
        }
        for (side, &across) in star.across.iter().enumerate().filter(|&(_, &across)| across != NONE) {
            let apex = outline.find(across).map_or(nowhere, |corner| corners[corner]);
            layout.before[layout.wings + side] = [ends[side], ends[1 - side], apex];
            layout.triangles += 1;
        }
        layout
    }

    /// Whether no triangle is turned over or nearly without area.
    fn is_sound(&self) -> bool {
        let after = self.rims[..self.wings].iter().all(|[from, to]| from.perp_dot(*to) > LEAST_AREA);
        after && self.before[..self.triangles].iter().all(|corners| area(*corners) > LEAST_AREA)
    }

    /// A place in the triangle of a wing after the collapse, by the weights of its rim.
    pub(super) fn place(&self, wing: usize, weights: [f64; 2]) -> DVec2 {
        let [from, to] = self.rims[wing];
        weights[0] * from + weights[1] * to
    }

    /// The triangle before the collapse in which a place is, by its number among wings and then sides, and the weights of
    /// its corners.
    pub(super) fn before(&self, place: DVec2) -> (usize, [f64; 3]) {
        let (mut best, mut least) = ((0, [1.0, 0.0, 0.0]), f64::NEG_INFINITY);
        for (number, &[a, b, c]) in self.before[..self.triangles].iter().enumerate() {
            let whole = area([a, b, c]);
            let weights =
                [area([place, b, c]), area([a, place, c]), area([a, b, place])].map(|part| part / whole);
            let outside = weights.into_iter().fold(f64::INFINITY, f64::min);
            if outside > least {
                (best, least) = ((number, weights), outside);
            }
            if least >= 0.0 {
                break;
            }
        }
        // Between triangles rounding leaves none.
        let inside = best.1.map(|weight| weight.max(0.0));
        let sum: f64 = inside.iter().sum();
        (best.0, inside.map(|weight| weight / sum))
    }
}

/// Twice the area of a triangle, negative where it is turned over.
fn area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Where the ends of the edge go.
fn ends(star: &Star, outline: &Outline, corners: &[DVec2; CORNERS], weights: &[Weights; 2]) -> [DVec2; 2] {
    if star.boundary == [true; 2] {
        // Along the boundary, which comes from the last corner to the first end, by the lengths of its edges.
        let [last, first] = [outline.corners - 1, 0].map(|corner| corners[corner]);
        let before = weights[0][outline.corners - 1].recip();
        let [between, after] = [weights[0][CORNERS], weights[1][0]].map(f64::recip);
        let legs = [last.length(), first.length()];
        let length = (legs[0] + legs[1]) / (before + between + after);
        let at = |way: f64| {
            if way < legs[0] { last * (1.0 - way / legs[0]) } else { first * ((way - legs[0]) / legs[1]) }
        };
        return [at(length * before), at(length * (before + between))];
    }
    let sums = weights.map(|weights| weights.iter().sum::<f64>());
    let pulls = weights
        .map(|weights| weights.iter().zip(corners).map(|(&weight, &corner)| weight * corner).sum::<DVec2>());
    let [to_second, to_first] = weights.map(|weights| weights[CORNERS]);
    match star.boundary {
        [true, _] => [DVec2::ZERO, pulls[1] / sums[1]],
        [_, true] => [pulls[0] / sums[0], DVec2::ZERO],
        _ => {
            let determinant = sums[0] * sums[1] - to_second * to_first;
            [
                (sums[1] * pulls[0] + to_second * pulls[1]) / determinant,
                (sums[0] * pulls[1] + to_first * pulls[0]) / determinant,
            ]
        }
    }
}

/// Mean value coordinates of both ends; on the boundary, of the edges along it, one over their lengths.
fn mean_values(star: &Star, outline: &Outline, places: &[Point]) -> [Weights; 2] {
    let mut weights = [[0.0; CORNERS + 1]; 2];
    let mut add = |end: usize, rim: [Option<u32>; 2]| {
        let spokes =
            rim.map(|name| name.map_or(star.ends[1 - end], |name| places[name as usize]) - star.ends[end]);
        let lengths = spokes.map(Point::length);
        let half_tangent = (spokes[0].cross(spokes[1]).length()
            / (lengths[0] * lengths[1] + spokes[0].dot(spokes[1])))
        .max(f64::MIN_POSITIVE);
        for (name, length) in rim.into_iter().zip(lengths) {
            let corner = name.map_or(Some(CORNERS), |name| outline.find(name));
            weights[end][corner.unwrap_or(0)] += half_tangent / length;
        }
    };
    for (number, wing) in star.wings.iter().enumerate() {
        add(usize::from(number >= star.split), wing.rim.map(Some));
    }
    for (side, &across) in star.across.iter().enumerate().filter(|&(_, &across)| across != NONE) {
        add(side, [None, Some(across)]);
        add(1 - side, [Some(across), None]);
    }
    if star.boundary == [true; 2] {
        let length = |from: Point, to: Point| from.distance(to).recip();
        let [last, first] = [outline.corners - 1, 0].map(|corner| places[outline.names[corner] as usize]);
        weights[0][outline.corners - 1] = length(last, star.ends[0]);
        weights[0][CORNERS] = length(star.ends[0], star.ends[1]);
        weights[1][0] = length(star.ends[1], first);
    }
    weights
}
