//! Triangles to be distant from.

use rayon::prelude::*;
use wide::f32x8;

use super::DistanceError;
use super::lanes::{LANES, Triangles};
use super::rows::load;
use crate::field::Grid;
use crate::mesh::{Point, TriangleMesh};

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// A mesh whose indices are in range, relative to the origin of a grid, in units of its cells' edge: numbers are moderate
/// whatever the units of the mesh are.
#[derive(Debug)]
pub(super) struct Surface<'a> {
    pub(super) positions: Vec<Point>,
    pub(super) triangles: &'a [[u32; 3]],
    /// Distance between nodes, in cells' edges.
    pub(super) spacing: Point,
}

/// A triangle as lanes take it, see [`Triangles`]: first corner, axes, second and third corner, and, as bits, the triangles
/// across its sides, or [`NONE`]. Side n runs from corner n to the next one. The last number is not used.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Facet([f32; 16]);

impl<'a> Surface<'a> {
    /// Checks a mesh.
    pub(super) fn new(mesh: &'a TriangleMesh, grid: &Grid) -> Result<Self, DistanceError> {
        if grid.is_empty() {
            return Err(DistanceError::Grid("no nodes"));
        }
        let edge = grid.cell_edge();
        let spacing = grid.spacing / edge;
        let moderate = |step: &f64| *step > 1e-6 && *step < 1e6;
        if !(edge.is_normal() && spacing.to_array().iter().all(moderate)) {
            return Err(DistanceError::Grid("a spacing that is not three positive numbers of like size"));
        }
        let vertices = mesh.positions.len();
        let missing = |triangle: &[u32; 3]| triangle.iter().any(|&corner| corner as usize >= vertices);
        if let Some(triangle) = mesh.triangles.iter().position(missing) {
            return Err(DistanceError::NoSuchVertex { triangle });
        }
        if let Some(vertex) = mesh.positions.iter().position(|point| !point.is_finite()) {
            return Err(DistanceError::NotFinite { vertex });
        }
        let positions = mesh.positions.par_iter().map(|&point| (point - grid.origin) / edge).collect();
        Ok(Self { positions, triangles: &mesh.triangles, spacing })
    }

    /// Corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [Point; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    /// Where a node lies.
    pub(super) fn node(&self, node: [usize; 3]) -> Point {
        self.spacing * Point::from_array(node.map(|index| index as f64))
    }

    /// All triangles, without their neighbours.
    pub(super) fn facets(&self) -> Vec<Facet> {
        let count = self.triangles.len() as u32;
        let facet = |triangle| Facet::new(self.corners(triangle), [NONE; 3]);
        (0..count).into_par_iter().with_min_len(4096).map(facet).collect()
    }

    /// The triangles across the sides of each triangle: those that have the side the other way round, in pairs. Sides
    /// without a partner have none.
    ///
    /// Sides wait for their partners in a list of their edge's lower vertex.
    ///
    /// Cost: about 20 ns a triangle, on one thread.
    pub(super) fn across(&self) -> Vec<[u32; 3]> {
        let mut across = vec![[NONE; 3]; self.triangles.len()];
        let mut first = vec![NONE; self.positions.len()];
        let mut after = vec![[NONE; 3]; self.triangles.len()];
        let ends = |side: u32| {
            let corners = self.triangles[(side / 3) as usize];
            [corners[(side % 3) as usize], corners[((side + 1) % 3) as usize]]
        };
        for side in 0..3 * self.triangles.len() as u32 {
            let [from, to] = ends(side);
            let list = &mut first[from.min(to) as usize];
            let (mut before, mut other) = (NONE, *list);
            while other != NONE && ends(other) != [to, from] {
                before = other;
                other = after[(other / 3) as usize][(other % 3) as usize];
            }
            let place = |side: u32| ((side / 3) as usize, (side % 3) as usize);
            let (triangle, corner) = place(side);
            if other == NONE {
                after[triangle][corner] = std::mem::replace(list, side);
                continue;
            }
            let (partner, at) = place(other);
            across[triangle][corner] = partner as u32;
            across[partner][at] = triangle as u32;
            let rest = after[partner][at];
            if before == NONE {
                *list = rest;
            } else {
                after[place(before).0][place(before).1] = rest;
            }
        }
        across
    }
}

impl Facet {
    pub(super) fn new([a, b, c]: [Point; 3], across: [u32; 3]) -> Self {
        let (along, to_third) = (b - a, c - a);
        let second = along.length();
        // Triangles without area have sides all the same, and sides without length have corners.
        let axis = if second > 0.0 { along / second } else { to_third.try_normalize().unwrap_or(Point::X) };
        let third = to_third.dot(axis);
        let up = to_third - third * axis;
        let height = up.length();
        let other = if height > 0.0 { up / height } else { axis.any_orthonormal_vector() };
        let mut numbers = [0.0; 16];
        for (numbers, point) in numbers.chunks_exact_mut(3).zip([a, axis, other]) {
            numbers.copy_from_slice(&point.as_vec3().to_array());
        }
        let [first, next, last] = across.map(f32::from_bits);
        numbers[9..15].copy_from_slice(&[second as f32, third as f32, height as f32, first, next, last]);
        Self(numbers)
    }

    /// Length of the first side.
    pub(super) fn side(&self) -> f32 {
        self.0[9]
    }

    /// Learns which triangles are across the sides.
    pub(super) fn join(&mut self, across: [u32; 3]) {
        self.0[12..15].copy_from_slice(&across.map(f32::from_bits));
    }

    /// The triangle across a side.
    pub(super) fn across(&self, side: usize) -> Option<u32> {
        let triangle = self.0[12 + side].to_bits();
        (triangle != NONE).then_some(triangle)
    }

    /// The triangle for all lanes, seen from an origin.
    #[inline(always)]
    pub(super) fn spread(&self, origin: [f32; 3]) -> Triangles {
        let [a_x, a_y, a_z, x, y, z, u, v, w, second, third_x, third_y, ..] = self.0;
        let wide = f32x8::splat;
        Triangles {
            corner: [wide(a_x - origin[0]), wide(a_y - origin[1]), wide(a_z - origin[2])],
            axes: [[wide(x), wide(y), wide(z)], [wide(u), wide(v), wide(w)]],
            second: wide(second),
            third: [wide(third_x), wide(third_y)],
        }
    }

    /// Eight triangles, and those across their sides.
    #[inline(always)]
    pub(super) fn gather(facets: [&Self; LANES]) -> (Triangles, [f32x8; 3]) {
        let part = |first: usize| f32x8::transpose(std::array::from_fn(|lane| load(&facets[lane].0, first)));
        let [a_x, a_y, a_z, x, y, z, u, v] = part(0);
        let [w, second, third_x, third_y, first, next, last, _] = part(8);
        let triangles = Triangles {
            corner: [a_x, a_y, a_z],
            axes: [[x, y, z], [u, v, w]],
            second,
            third: [third_x, third_y],
        };
        (triangles, [first, next, last])
    }
}
