//! How a mesh lost its edges, so that every point of what is left can be led back to where it was.
//!
//! A collapse replaces the triangles around an edge by fewer ones with the same outline. Laid out flat, both fill one
//! polygon ([`super::layout`]), so that each point of the new triangles is one of the old ones; all collapses together map
//! the base mesh one to one to the mesh that it came from, whatever shape either has.
//!
//! Source of the idea: A. Lee, W. Sweldens, P. Schröder, L. Cowsar, D. Dobkin, MAPS: Multiresolution adaptive
//! parameterization of surfaces, 1998, for vertex removal; J. Cohen, D. Manocha, M. Olano, Simplifying polygonal models
//! using successive mappings, 1997, for edge collapse.

use super::corners::{NONE, next, previous};
use super::layout::{Layout, Star, Wing};
use super::spots::spots;
use super::surface::Surface;
use crate::mesh::{Point, PolygonMesh, TriangleMesh};

/// A place on a triangle mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) triangle: u32,
    /// Of the corners of the triangle, in their order; they add up to 1.
    pub(super) weights: [f64; 3],
}

/// One collapse. Sides and vertices have the numbers of the mesh before all collapses.
#[derive(Clone, Debug, PartialEq)]
struct Step {
    /// The vertex that was kept, and the one that went.
    ends: [u32; 2],
    /// Where they were.
    places: [Point; 2],
    /// Whether the boundary passed through them.
    boundary: [bool; 2],
    /// The sides of the edge, which went with their triangles.
    sides: [u32; 2],
    /// Vertices across from it.
    across: [u32; 2],
    /// Number of wings at either end.
    wings: [u8; 2],
}

/// All collapses of a mesh, and what they left.
///
/// Memory: about 250 bytes a collapse.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    steps: Vec<Step>,
    /// The wings of all steps, those of the first end first.
    wings: Vec<Wing>,
    /// Numbers that the vertices and triangles that are left had before.
    names: Names,
    /// The triangles that are left, over the vertices that are.
    triangles: Vec<[u32; 3]>,
}

/// Numbers before all collapses.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Names {
    pub(super) vertices: Vec<u32>,
    pub(super) triangles: Vec<u32>,
}

impl Names {
    /// Every vertex and triangle by its number.
    pub(super) fn new(vertices: usize, triangles: usize) -> Self {
        Self { vertices: (0..vertices as u32).collect(), triangles: (0..triangles as u32).collect() }
    }

    /// Leaves out what is gone, as [`Surface::compact`] does.
    pub(super) fn compact(&mut self, surface: &Surface) {
        let mut vertices = surface.vertices.iter();
        self.vertices.retain(|_| vertices.next().is_some_and(|vertex| vertex.leaving != NONE));
        let mut triangle = 0;
        self.triangles.retain(|_| {
            triangle += 1;
            surface.corners.from(3 * (triangle - 1)) != NONE
        });
    }

    fn side(&self, side: u32) -> u32 {
        if side == NONE { NONE } else { 3 * self.triangles[side as usize / 3] + side % 3 }
    }

    fn vertex(&self, vertex: u32) -> u32 {
        if vertex == NONE { NONE } else { self.vertices[vertex as usize] }
    }
}

impl History {
    /// Takes down a collapse of the edge of a side into its first vertex, before it happens.
    pub(super) fn record(&mut self, surface: &Surface, names: &Names, side: u32) {
        let corners = &surface.corners;
        let sides = [side, corners.twin(side)];
        let gone = sides.map(|side| side / 3);
        let ends = corners.ends(side);
        let wings = ends.map(|end| {
            let before = self.wings.len();
            let out = corners.around(surface.vertex(end).leaving).filter(|side| !gone.contains(&(side / 3)));
            self.wings.extend(out.map(|side| Wing {
                side: names.side(side),
                rim: [corners.to(side), corners.from(previous(side))].map(|vertex| names.vertex(vertex)),
            }));
            (self.wings.len() - before) as u8
        });
        let across = sides.map(|side| if side == NONE { NONE } else { corners.from(previous(side)) });
        self.steps.push(Step {
            ends: ends.map(|end| names.vertex(end)),
            places: ends.map(|end| surface.vertex(end).position),
            boundary: ends.map(|end| surface.vertex(end).boundary),
            sides: sides.map(|side| names.side(side)),
            across: across.map(|vertex| names.vertex(vertex)),
            wings,
        });
    }

    /// Ends the record: what is left.
    pub(super) fn end(&mut self, names: Names, triangles: &[[u32; 3]]) {
        self.names = names;
        self.triangles = triangles.to_vec();
    }

    /// The vertex of the mesh that a vertex of the base mesh was, or grew from.
    pub fn origin(&self, vertex: u32) -> u32 {
        self.names.vertices[vertex as usize]
    }

    /// Where the vertices of a surface belong on the mesh that its base mesh came from: the same places in the numbering of
    /// `Split` as those of `base` split `levels` times, spread over the mesh without folds or gaps, whatever its shape.
    ///
    /// `base` is what [`super::base_mesh`] made of `mesh` when it took this record.
    ///
    /// Cost: about a microsecond a vertex, on one thread.
    pub fn places(&self, mesh: &TriangleMesh, base: &PolygonMesh, levels: u32) -> Vec<Point> {
        self.back(mesh, &base.positions, &mut spots(base, &self.triangles, levels))
    }

    /// Leads places on what is left, whose vertices are at `positions`, back to `mesh`, from which it came.
    fn back(&self, mesh: &TriangleMesh, positions: &[Point], spots: &mut [Spot]) -> Vec<Point> {
        let mut places = mesh.positions.clone();
        for (&name, &place) in self.names.vertices.iter().zip(positions) {
            places[name as usize] = place;
        }
        for spot in &mut *spots {
            spot.triangle = self.names.triangles[spot.triangle as usize];
        }
        let mut walk = Walk::new(mesh.triangles.len(), spots);
        let mut end = self.wings.len();
        for step in self.steps.iter().rev() {
            let begin = end - usize::from(step.wings[0]) - usize::from(step.wings[1]);
            walk.undo(step, &self.wings[begin..end], &mut places);
            end = begin;
        }
        let at = |spot: &Spot| {
            let corners =
                mesh.triangles[spot.triangle as usize].map(|corner| mesh.positions[corner as usize]);
            corners.iter().zip(spot.weights).map(|(&corner, weight)| weight * corner).sum()
        };
        spots.iter().map(at).collect()
    }
}

/// Places on their way back, listed by triangle.
struct Walk<'a> {
    spots: &'a mut [Spot],
    /// The first place in each triangle, and after each place the next one.
    first: Vec<u32>,
    after: Vec<u32>,
    /// Places around the edge that comes back, each with its wing.
    found: Vec<(u32, u32)>,
}

impl<'a> Walk<'a> {
    fn new(triangles: usize, spots: &'a mut [Spot]) -> Self {
        let after = vec![NONE; spots.len()];
        let mut walk = Self { spots, first: vec![NONE; triangles], after, found: Vec::new() };
        (0..walk.spots.len() as u32).for_each(|spot| walk.list(spot));
        walk
    }

    fn list(&mut self, spot: u32) {
        let first = &mut self.first[self.spots[spot as usize].triangle as usize];
        self.after[spot as usize] = std::mem::replace(first, spot);
    }

    /// Takes a collapse back.
    fn undo(&mut self, step: &Step, wings: &[Wing], places: &mut [Point]) {
        self.found.clear();
        for (number, wing) in (0..).zip(wings) {
            let mut spot = std::mem::replace(&mut self.first[wing.side as usize / 3], NONE);
            while spot != NONE {
                self.found.push((spot, number));
                spot = self.after[spot as usize];
            }
        }
        if !self.found.is_empty() {
            let star = Star {
                centre: places[step.ends[0] as usize],
                ends: step.places,
                boundary: step.boundary,
                wings,
                split: usize::from(step.wings[0]),
                across: step.across,
            };
            let layout = Layout::new(&star, places);
            for (spot, wing) in std::mem::take(&mut self.found) {
                self.spots[spot as usize] = moved(step, wings, &layout, wing, self.spots[spot as usize]);
                self.list(spot);
            }
        }
        for (end, place) in step.ends.into_iter().zip(step.places) {
            places[end as usize] = place;
        }
    }
}

/// Where a place in a wing was before a collapse.
fn moved(step: &Step, wings: &[Wing], layout: &Layout, wing: u32, spot: Spot) -> Spot {
    let [rim, last] = turn(wings[wing as usize].side).map(|corner| spot.weights[corner]);
    let (found, weights) = layout.before(layout.place(wing as usize, [rim, last]));
    // Corners: the end, and counter-clockwise on; in the triangles of the edge, where its sides begin.
    let side = if found < wings.len() { wings[found].side } else { step.sides[found - wings.len()] };
    let mut back = Spot { triangle: side / 3, weights: [0.0; 3] };
    back.weights[side as usize % 3] = weights[0];
    for (corner, weight) in turn(side).into_iter().zip([weights[1], weights[2]]) {
        back.weights[corner] = weight;
    }
    back
}

/// The two corners after that of a side, as places in their triangle.
fn turn(side: u32) -> [usize; 2] {
    [next(side), previous(side)].map(|corner| corner as usize % 3)
}
