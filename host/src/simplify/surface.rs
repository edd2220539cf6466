//! The surface being simplified: connectivity, vertices, and what must be kept of them.

use super::corners::{Corners, NONE, next, previous};
use super::{Constraints, SimplifyError};
use crate::field::Grid;
use crate::mesh::{Features, Point, TriangleMesh};

/// How a vertex may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Freely.
    Smooth,
    /// Along the sharp edges or the boundary that pass through it.
    Curve,
    /// Not at all: a sharp vertex, or curves end or meet here.
    Corner,
}

/// All that is known of a vertex, in one place because it is needed at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) position: Point,
    /// A side that leaves it: at the boundary the one with nothing to its right. [`NONE`] where no triangle is.
    pub(super) leaving: u32,
    /// Error of collapses that it came from (Vis2000 §4.1, E_acc), in edge lengths.
    pub(super) accumulated: f32,
    /// How many vertices it was made of, and how many it may be.
    pub(super) stands_for: u32,
    pub(super) most: u32,
    /// Number of its edges.
    pub(super) valence: u16,
    pub(super) kind: Kind,
    /// Whether the boundary passes through it.
    pub(super) boundary: bool,
    /// Border planes of the volume in which it stays: one bit each.
    pub(super) planes: u8,
    /// Whether it is sharp in itself.
    pub(super) pinned: bool,
}

/// A mesh that loses edges.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) corners: Corners,
    pub(super) vertices: Vec<Vertex>,
    /// Whether the edge of each side is sharp; empty where no edge is.
    sharp: Vec<bool>,
}

impl Surface {
    pub(super) fn new(mesh: &TriangleMesh, constraints: &Constraints) -> Result<Self, SimplifyError> {
        if let Some(vertex) = mesh.positions.iter().position(|position| !position.is_finite()) {
            return Err(SimplifyError::NotFinite { vertex });
        }
        let corners = Corners::new(mesh.positions.len(), &mesh.triangles)?;
        let vertices = mesh.positions.iter().map(|&position| Vertex {
            position,
            leaving: NONE,
            accumulated: 0.0,
            stands_for: 1,
            most: u32::MAX,
            valence: 0,
            kind: Kind::Smooth,
            boundary: false,
            planes: 0,
            pinned: false,
        });
        let mut surface = Self { vertices: vertices.collect(), corners, sharp: Vec::new() };
        surface.find_fans()?;
        surface.mark_features(&constraints.features)?;
        surface.classify(constraints.border.as_ref());
        Ok(surface)
    }

    /// Finds the sides that leave each vertex, which must be one fan or one round.
    fn find_fans(&mut self) -> Result<(), SimplifyError> {
        for side in 0..self.corners.len() {
            let vertex = &mut self.vertices[self.corners.from(side) as usize];
            vertex.valence = vertex.valence.saturating_add(1);
            if self.corners.twin(side) == NONE {
                vertex.boundary = true;
                vertex.leaving = side;
            } else if vertex.leaving == NONE {
                vertex.leaving = side;
            }
        }
        for (index, vertex) in
            self.vertices.iter_mut().enumerate().filter(|(_, vertex)| vertex.leaving != NONE)
        {
            let faces = self.corners.around(vertex.leaving).count();
            if faces != usize::from(vertex.valence) {
                return Err(match vertex.valence {
                    u16::MAX => SimplifyError::TooLarge,
                    _ => SimplifyError::PinchedVertex { vertex: index as u32 },
                });
            }
            vertex.valence = vertex.valence.saturating_add(u16::from(vertex.boundary));
        }
        Ok(())
    }

    fn mark_features(&mut self, features: &Features) -> Result<(), SimplifyError> {
        if !features.edges.is_empty() {
            self.sharp = vec![false; self.corners.len() as usize];
        }
        for &edge in &features.edges {
            let side = self.side(edge).ok_or(SimplifyError::NoSuchEdge { edge })?;
            self.set_sharp(side);
        }
        for &vertex in &features.vertices {
            let pinned = self.vertices.get_mut(vertex as usize);
            pinned.ok_or(SimplifyError::NoSuchSharpVertex { vertex })?.pinned = true;
        }
        Ok(())
    }

    /// Mean length of the edges, 0 where there are none.
    pub(super) fn mean_edge(&self) -> f64 {
        let edges = (0..self.corners.len()).filter(|&side| self.corners.is_edge(side));
        let (count, sum) = edges.fold((0.0, 0.0), |(count, sum), side| {
            let [from, to] = self.corners.ends(side).map(|vertex| self.vertex(vertex).position);
            (count + 1.0, sum + from.distance(to))
        });
        sum / f64::max(count, 1.0)
    }

    /// A side between two vertices, either way.
    fn side(&self, [from, to]: [u32; 2]) -> Option<u32> {
        let leads = |from: u32, to: u32| {
            let leaving = self.vertices.get(from as usize)?.leaving;
            self.corners.around(leaving).find(|&side| self.corners.to(side) == to)
        };
        leads(from, to).or_else(|| leads(to, from))
    }

    fn set_sharp(&mut self, side: u32) {
        let twin = self.corners.twin(side);
        for side in [side, twin].into_iter().filter(|&side| side != NONE) {
            self.sharp[side as usize] = true;
        }
    }

    fn classify(&mut self, border: Option<&Grid>) {
        for index in 0..self.vertices.len() {
            let Vertex { leaving, boundary, pinned, position, .. } = self.vertices[index];
            let inner = self.corners.around(leaving).filter(|&side| self.corners.twin(side) != NONE);
            let creases = inner.filter(|&side| self.is_curve(side)).count();
            let vertex = &mut self.vertices[index];
            vertex.kind = match (creases, boundary) {
                _ if pinned => Kind::Corner,
                (0, false) => Kind::Smooth,
                (2, false) | (0, true) => Kind::Curve,
                _ => Kind::Corner,
            };
            if let (Some(grid), true) = (border, boundary) {
                vertex.planes = planes(grid, position);
                if vertex.planes.count_ones() > 1 {
                    vertex.kind = Kind::Corner;
                }
            }
        }
    }

    /// Whether a side lies on the boundary or on a sharp edge.
    pub(super) fn is_curve(&self, side: u32) -> bool {
        self.corners.twin(side) == NONE || self.is_sharp(side)
    }

    fn is_sharp(&self, side: u32) -> bool {
        self.sharp.get(side as usize).is_some_and(|&sharp| sharp)
    }

    /// The neighbour of a vertex along a curve that is not `other`.
    pub(super) fn along(&self, vertex: u32, other: u32) -> Option<Point> {
        let mut last = NONE;
        let out = self.corners.around(self.vertex(vertex).leaving).inspect(|&side| last = side);
        let neighbour =
            out.filter(|&side| self.is_curve(side)).map(|side| self.corners.to(side)).find(|&to| to != other);
        neighbour
            .or_else(|| {
                // The boundary comes in past the last side.
                let into = previous(last);
                Some(self.corners.from(into)).filter(|&from| self.corners.twin(into) == NONE && from != other)
            })
            .map(|vertex| self.vertex(vertex).position)
    }

    pub(super) fn vertex(&self, vertex: u32) -> &Vertex {
        &self.vertices[vertex as usize]
    }

    /// Collapses the edge of a side into its first vertex, which takes the place and the rights given.
    ///
    /// The edge must be legal.
    pub(super) fn collapse(&mut self, side: u32, merged: Vertex) -> u32 {
        let [kept, gone] = self.corners.ends(side);
        self.rename(gone, kept);
        let mut leaving = NONE;
        for side in [side, self.corners.twin(side)].into_iter().filter(|&side| side != NONE) {
            leaving = self.close(side);
        }
        self.vertices[gone as usize].leaving = NONE;
        self.vertices[kept as usize] = Vertex { leaving, ..merged };
        if merged.boundary {
            self.vertices[kept as usize].leaving = self.rightmost(leaving);
        }
        kept
    }

    /// Names the sides that leave one vertex after another.
    fn rename(&mut self, gone: u32, kept: u32) {
        let start = self.vertex(gone).leaving;
        let mut side = start;
        while side != NONE {
            self.corners.set_vertex(side, kept);
            side = self.corners.left(side);
            if side == start {
                break;
            }
        }
    }

    /// Takes out a triangle at a collapsed edge; gives a side that leaves the merged vertex and is still there.
    fn close(&mut self, side: u32) -> u32 {
        let [second, third] = [next(side), previous(side)];
        let apex = self.corners.from(third);
        let sharp = self.is_sharp(second) || self.is_sharp(third);
        let [into, out] = self.corners.close(side);
        if sharp {
            self.set_sharp(if into == NONE { out } else { into });
        }
        let vertex = &mut self.vertices[apex as usize];
        vertex.valence -= 1;
        if vertex.leaving == third {
            vertex.leaving = into;
        }
        if out == NONE { next(into) } else { out }
    }

    /// The last side clockwise that leaves the vertex of a side on the boundary.
    fn rightmost(&self, side: u32) -> u32 {
        let mut side = side;
        loop {
            match self.corners.right(side) {
                NONE => return side,
                right => side = right,
            }
        }
    }

    /// The same surface without gaps where triangles and vertices are gone; all keep their order.
    pub(super) fn compact(self) -> Self {
        let mut names = vec![NONE; self.vertices.len()];
        let mut vertices = Vec::new();
        for (vertex, name) in
            self.vertices.into_iter().zip(&mut names).filter(|(vertex, _)| vertex.leaving != NONE)
        {
            *name = vertices.len() as u32;
            vertices.push(vertex);
        }
        let (corners, sides) = self.corners.compact(&names);
        for vertex in &mut vertices {
            vertex.leaving = sides[vertex.leaving as usize];
        }
        let left = self.sharp.iter().zip(&sides).filter(|&(_, &side)| side != NONE);
        let sharp = left.map(|(&sharp, _)| sharp).collect();
        Self { corners, vertices, sharp }
    }

    /// The mesh and the features that are left; vertices keep their order.
    pub(super) fn into_mesh(self) -> (TriangleMesh, Features) {
        let surface = self.compact();
        let corners = &surface.corners;
        let sharp = (0..corners.len())
            .filter(|&side| corners.is_edge(side) && corners.twin(side) != NONE && surface.is_sharp(side));
        let mut edges: Vec<_> =
            sharp.map(|side| corners.ends(side)).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        let numbered = (0..).zip(&surface.vertices);
        let vertices = numbered.filter(|(_, vertex)| vertex.pinned).map(|(index, _)| index).collect();
        let positions = surface.vertices.iter().map(|vertex| vertex.position).collect();
        (TriangleMesh { positions, triangles: corners.triangles() }, Features { edges, vertices })
    }
}

/// Which planes of a grid's border a point lies in, a bit each.
fn planes(grid: &Grid, point: Point) -> u8 {
    /// Rounding of positions, in cells.
    const NEAR: f64 = 1e-5;
    let local = grid.local(point).to_array();
    let planes = local.into_iter().zip(grid.extent).enumerate().map(|(axis, (at, extent))| {
        let last = extent.saturating_sub(1) as f64;
        (u8::from(at.abs() < NEAR) | u8::from((at - last).abs() < NEAR) << 1) << (2 * axis)
    });
    planes.fold(0, |all, plane| all | plane)
}
