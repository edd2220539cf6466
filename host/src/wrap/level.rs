//! The mesh of one level while it is fitted to the surface.

use rayon::prelude::*;

use super::border::{Border, Sides};
use super::refine::refine;
use super::relax::relaxed;
use super::rings::{Kind, Rings};
use super::{WrapError, WrapOptions, attract, probe};
use crate::mesh::{Faces, Features, Point, PolygonMesh};
use crate::subdivision::Split;

/// Least part of a vertex' normal within the side of the box that it is held to, for a line to go along it.
const LEAST_FREE: f64 = 0.1;

/// A mesh, what its vertices are, and where they are.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) faces: Faces,
    pub(super) features: Features,
    pub(super) rings: Rings,
    /// The sides of the box that each vertex is held to.
    pub(super) sides: Vec<Sides>,
    pub(super) positions: Vec<Point>,
}

/// A field and the box that it fills.
#[derive(Clone, Copy)]
pub(super) struct Space<'a> {
    pub(super) probe: probe::Probe<'a>,
    pub(super) border: Border,
    pub(super) cell: f64,
}

impl Level {
    /// The base mesh. Boundary vertices on sides of the box are held to them.
    pub(super) fn base(mesh: &PolygonMesh, border: &Border) -> Result<Self, WrapError> {
        let (faces, features, positions) = (mesh.faces().clone(), mesh.features.clone(), mesh.positions.clone());
        let rings = Rings::new(positions.len(), &faces, &features)?;
        let on_sides = |vertex: usize| match rings.is_closed(vertex) {
            true => Sides::default(),
            false => border.sides(positions[vertex]),
        };
        let sides = (0..positions.len()).map(on_sides).collect();
        Ok(Self { faces, features, rings, sides, positions }.with_corners_fixed())
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
        Ok(Self { faces, features, rings, sides, positions }.with_corners_fixed())
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
    pub(super) fn attract(&mut self, space: &Space, reach: f64) -> Vec<u32> {
        let found: Vec<Option<Point>> =
            (0..self.positions.len()).into_par_iter().map(|vertex| self.attracted(vertex, space, reach)).collect();
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
    fn attracted(&self, vertex: usize, space: &Space, reach: f64) -> Option<Point> {
        let (place, sides) = (self.positions[vertex], self.sides[vertex]);
        if self.rings.kind(vertex) == Kind::Fixed && sides.count() != 2 {
            return Some(place);
        }
        let normal = self.rings.normal(vertex, &self.positions).normalize_or_zero();
        let direction = sides.free_part(normal);
        if direction.length() < LEAST_FREE {
            return None;
        }
        let line = attract::Line {
            probe: &space.probe,
            from: place,
            direction: direction.normalize(),
            cell: space.cell,
        };
        let at = line.nearest_zero(reach * self.rings.edge_length(vertex, &self.positions))?;
        Some(space.border.hold(sides, place + at * line.direction))
    }
}
