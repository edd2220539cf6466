//! The mesh of one level while it is fitted to the surface.

use rayon::prelude::*;

use super::border::{Border, Sides};
use super::goal::Goal;
use super::refine::refine;
use super::relax::relaxed;
use super::rings::{Kind, Rings};
use super::{WrapError, WrapOptions, attract};
use crate::field::ScalarField;
use crate::mesh::{Faces, Features, Point, PolygonMesh};
use crate::subdivision::Split;

/// Least part of a vertex' normal within the side of the box that it is held to, for a line to go along it.
const LEAST_FREE: f64 = 0.1;
/// How far along a line the surface may be, in distances from it: the reciprocal of the least cosine between the line and
/// the surface's normal, were it a plane.
const MOST_SLANTED: f64 = 3.0;
/// Least reach of a vertex, in cells.
const LEAST_REACH: f64 = 0.5;
/// Nearer than this to the surface is on it, in cells.
const NEAR: f64 = 0.01;
/// What is on the border, in cells: nearer than positions in `f32` tell apart.
const ON_BORDER: f64 = 1e-4;

/// A mesh, what its vertices are, and where they are.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) faces: Faces,
    pub(super) features: Features,
    pub(super) rings: Rings,
    /// The sides of the box that each vertex is held to.
    pub(super) sides: Vec<Sides>,
    /// The connected component of each vertex.
    pub(super) components: Vec<u32>,
    pub(super) positions: Vec<Point>,
}

/// A field and the box that it fills.
#[derive(Clone, Copy, Debug)]
pub(super) struct Space<'a> {
    pub(super) distance: &'a ScalarField,
    pub(super) border: Border,
    pub(super) cell: f64,
}

impl<'a> Space<'a> {
    /// The space of a distance field.
    pub(super) fn new(distance: &'a ScalarField) -> Self {
        let grid = distance.grid();
        let cell = grid.cell_edge();
        let corners = [grid.origin, grid.position(grid.extent.map(|nodes| nodes - 1))];
        Self { distance, border: Border::new(corners, ON_BORDER * cell), cell }
    }

    /// How far a point is from the surface, in cells' edges.
    pub(super) fn distance_in_cells(&self, point: Point) -> f64 {
        self.distance.sample_clamped(point).abs() / self.cell
    }

    /// Which way the surface near a vertex of a mesh faces: along the gradient of the distance, which is a unit vector but
    /// where sheets of the surface are closer than a cell or two. There the normal of the mesh, a unit vector, makes up for
    /// what the gradient is short of.
    pub(super) fn outwards(&self, point: Point, normal: Point) -> Point {
        let gradient = self.distance.sample_clamped_with_gradient(point).1;
        gradient + (1.0 - gradient.length()).max(0.0) * normal
    }
}

impl Level {
    /// The base mesh. Boundary vertices on sides of the box are held to them.
    pub(super) fn base(mesh: &PolygonMesh, border: &Border) -> Result<Self, WrapError> {
        let (faces, features, positions) =
            (mesh.faces().clone(), mesh.features.clone(), mesh.positions.clone());
        let rings = Rings::new(positions.len(), &faces, &features)?;
        let on_sides = |vertex: usize| match rings.is_closed(vertex) {
            true => Sides::default(),
            false => border.sides(positions[vertex]),
        };
        let sides = (0..positions.len()).map(on_sides).collect();
        let components = components(&rings);
        Ok(Self { faces, features, rings, sides, components, positions }.with_corners_fixed())
    }

    /// The next finer level.
    pub(super) fn refined(&self, border: &Border) -> Result<Self, WrapError> {
        let split = Split::new(self.positions.len(), &self.faces);
        let mut positions = refine(&self.faces, &self.features, &self.rings, &split, &self.positions);
        let (faces, features) = (split.finer_faces(), split.finer_features(&self.features));
        let rings = Rings::new(positions.len(), &faces, &features)?;
        let in_edges = split.edges.iter().zip(&split.edge_faces).map(|(ends, faces)| match faces {
            [_, None] => {
                let [from, to] = ends.map(|end| self.sides[end as usize]);
                from.between(to)
            }
            _ => Sides::default(),
        });
        let mut sides: Vec<Sides> = self.sides.iter().copied().chain(in_edges).collect();
        sides.resize(positions.len(), Sides::default());
        for (place, &sides) in positions.iter_mut().zip(&sides) {
            *place = border.hold(sides, *place);
        }
        let firsts = split.edges.iter().map(|ends| ends[0]).chain(self.faces.iter().map(|face| face[0]));
        let added = firsts.map(|first| self.components[first as usize]);
        let components = self.components.iter().copied().chain(added).collect();
        Ok(Self { faces, features, rings, sides, components, positions }.with_corners_fixed())
    }

    /// The first vertex of each component.
    pub(super) fn first_of_components(&self) -> Vec<u32> {
        let mut firsts = Vec::new();
        for (vertex, &component) in (0..).zip(&self.components) {
            if component as usize == firsts.len() {
                firsts.push(vertex);
            }
        }
        firsts
    }

    /// Vertices on an edge of the box only move along it, by attraction.
    fn with_corners_fixed(mut self) -> Self {
        for (vertex, sides) in self.sides.iter().enumerate() {
            if sides.count() > 1 {
                self.rings.fix(vertex);
            }
        }
        self
    }

    /// Moves all vertices at once towards their neighbours.
    pub(super) fn relax(&mut self, border: &Border, options: &WrapOptions) {
        let (alpha, keep_height) = (options.relaxation, options.keep_height);
        let moved = |vertex: usize| {
            let place = relaxed(&self.rings, vertex, &self.positions, alpha, keep_height);
            border.hold(self.sides[vertex], place)
        };
        self.positions = (0..self.positions.len()).into_par_iter().map(moved).collect();
    }

    /// Moves all vertices at once to the surface, along their normals; those that find none within reach stay. Returns which
    /// ones these are.
    pub(super) fn attract(&mut self, space: &Space, options: &WrapOptions) -> Vec<u32> {
        let found: Vec<Option<Point>> = (0..self.positions.len())
            .into_par_iter()
            .map(|vertex| self.attracted(vertex, space, options))
            .collect();
        let mut missed = Vec::new();
        for (vertex, (place, found)) in self.positions.iter_mut().zip(found).enumerate() {
            match found {
                Some(found) => *place = found,
                None => missed.push(vertex as u32),
            }
        }
        missed
    }

    /// Where a vertex is attracted to.
    fn attracted(&self, vertex: usize, space: &Space, options: &WrapOptions) -> Option<Point> {
        let (place, sides) = (self.positions[vertex], self.sides[vertex]);
        let reach = self.reach(vertex, space, options.reach);
        match self.rings.kind(vertex) {
            Kind::Fixed if sides.count() != 2 => return Some(place),
            Kind::Crease(ends) if sides.count() == 0 => {
                let [before, after] = ends.map(|end| self.positions[end as usize]);
                match options.lines {
                    Some(lines) => return lines.closest(place, after - before, reach),
                    None if !self.rings.is_closed(vertex) => return Some(place),
                    None => {}
                }
            }
            _ => {}
        }
        let direction = sides.free_part(self.normal(vertex));
        if direction.length() < LEAST_FREE {
            return None;
        }
        let direction = direction.normalize();
        let (distance, gradient) = space.distance.sample_clamped_with_gradient(place);
        // Where the nearest surface faces as the mesh does, a line that meets it much farther off is a bad one.
        let agrees = gradient.dot(direction) > 0.0;
        let reach = if agrees { reach.min(MOST_SLANTED * distance.abs() + NEAR * space.cell) } else { reach };
        let line = attract::Line { field: space.distance, from: place, direction, cell: space.cell };
        let at = line.nearest_zero(reach)?;
        Some(space.border.hold(sides, place + at * line.direction))
    }

    /// Leads vertices that attraction missed towards the surface on the shortest way, where that faces as they do. Returns
    /// which ones do not get there.
    pub(super) fn lead(&mut self, space: &Space, goal: &Goal, missed: &[u32], reach: f64) -> Vec<u32> {
        let led = |&vertex: &u32| self.approached(vertex as usize, space, goal, reach);
        let places: Vec<Point> = missed.par_iter().map(led).collect();
        for (&vertex, place) in missed.iter().zip(places) {
            self.positions[vertex as usize] = place;
        }
        let is_off = |&vertex: &u32| space.distance_in_cells(self.positions[vertex as usize]) > NEAR;
        missed.iter().copied().filter(is_off).collect()
    }

    /// The unit normal of the mesh at a vertex; zero where it has none.
    pub(super) fn normal(&self, vertex: usize) -> Point {
        self.rings.normal(vertex, &self.positions).normalize_or_zero()
    }

    /// How far a vertex may look, given in lengths of its edges: in a dense mesh as far as the field tells things apart.
    fn reach(&self, vertex: usize, space: &Space, reach: f64) -> f64 {
        (reach * self.rings.edge_length(vertex, &self.positions)).max(LEAST_REACH * space.cell)
    }

    /// Moves all vertices at once to a goal.
    pub(super) fn approach(&mut self, space: &Space, goal: &Goal, reach: f64) {
        let moved = |vertex| self.approached(vertex, space, goal, reach);
        self.positions = (0..self.positions.len()).into_par_iter().map(moved).collect();
    }

    /// The place nearest to a vertex on a goal, if the surface there faces as the mesh does.
    fn approached(&self, vertex: usize, space: &Space, goal: &Goal, reach: f64) -> Point {
        let (place, sides) = (self.positions[vertex], self.sides[vertex]);
        let may_move = match self.rings.kind(vertex) {
            Kind::Smooth => true,
            Kind::Crease(_) => sides.count() > 0,
            Kind::Fixed => sides.count() == 2,
        };
        if !may_move {
            return place;
        }
        let reach = self.reach(vertex, space, reach);
        let found = goal.approach(place, sides, reach, space);
        let normal = self.normal(vertex);
        let agrees = normal.dot(goal.outwards(found, normal, space)) > 0.0;
        if agrees { found } else { place }
    }
}

/// Numbers the connected components of a mesh in the order of their first vertices.
fn components(rings: &Rings) -> Vec<u32> {
    let mut components = vec![u32::MAX; rings.len()];
    let mut count = 0;
    for first in 0..rings.len() {
        if components[first] != u32::MAX {
            continue;
        }
        components[first] = count;
        let mut waiting = vec![first as u32];
        while let Some(vertex) = waiting.pop() {
            for &next in rings.neighbours(vertex as usize) {
                if components[next as usize] == u32::MAX {
                    components[next as usize] = count;
                    waiting.push(next);
                }
            }
        }
        count += 1;
    }
    components
}
