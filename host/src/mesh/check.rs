//! Whether a mesh is a surface, and which.

use std::collections::HashSet;
use std::fmt;

use super::edges::{Edges, Sets, Side};
use super::triangulation::area_vector;
use super::{Point, Surface};

/// Cosine of the angle between the normals of two faces beyond which they are folded onto each other: 150 degrees.
const FOLD: f64 = -0.866_025_403_784_438_6;

/// What there is to say of a mesh, polygons or triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Vertices that faces use.
    pub vertices: usize,
    /// Vertices that no face uses.
    pub isolated_vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Faces.
    pub faces: usize,
    /// Parts that hang together by edges, in the order of their first faces.
    pub components: Vec<Component>,
    /// Edges of one face.
    pub boundary_edges: usize,
    /// Edges of more than two faces.
    pub nonmanifold_edges: usize,
    /// Vertices whose faces are not one fan or disk, as where two cones touch with their tips.
    pub nonmanifold_vertices: usize,
    /// Edges whose two faces run along them in the same direction.
    pub inconsistent_edges: usize,
    /// Edges whose two faces are folded onto each other: normals more than 150 degrees apart.
    pub folded_edges: usize,
    /// Faces without area, or with a vertex twice.
    pub degenerate_faces: usize,
    /// Faces with the same vertices as one before them.
    pub duplicate_faces: usize,
    /// Vertices at exactly the place of one before them.
    pub repeated_positions: usize,
}

/// A part that hangs together. Vertices in which it only touches itself or another part count for each of both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Component {
    /// Faces.
    pub faces: usize,
    /// Edges.
    pub edges: usize,
    /// Vertices.
    pub vertices: usize,
    /// Edges of one face.
    pub boundary_edges: usize,
    /// Closed curves that these make.
    pub boundary_loops: usize,
    /// Edges with more than two faces, or two that run the same way.
    pub faulty_edges: usize,
    /// Enclosed volume, positive if the faces look outwards. For an open part, that of the cone over its boundary to
    /// the middle of the mesh, which tells little.
    pub volume: f64,
}

impl Component {
    /// Vertices - edges + faces.
    pub const fn euler(&self) -> i64 {
        self.vertices as i64 - self.edges as i64 + self.faces as i64
    }

    /// Number of handles, from euler = 2 - 2 genus - boundary loops. None if there are faulty edges, since the part need
    /// not be a surface with two sides then.
    pub const fn genus(&self) -> Option<u64> {
        let twice = 2 - self.boundary_loops as i64 - self.euler();
        if self.faulty_edges == 0 && twice >= 0 { Some(twice as u64 / 2) } else { None }
    }

    /// Whether it has no boundary and looks inwards. A hollow inside another part should.
    pub fn is_inward(&self) -> bool {
        self.boundary_edges == 0 && self.volume < 0.0
    }
}

impl Report {
    /// Examines a mesh.
    ///
    /// Cost: sorting of the sides; 40 bytes a side; about 2 s for a million triangles.
    pub fn of(surface: &impl Surface) -> Self {
        let edges = Edges::new(surface);
        let mut parts = Parts::new(surface, &edges);
        let mut report = Self {
            faces: surface.polygons().len(),
            edges: edges.iter().count(),
            repeated_positions: repeated_positions(surface.points()),
            ..Self::default()
        };
        report.count_vertices(surface, &mut parts);
        report.count_edges(&edges, &mut parts);
        report.count_faces(surface, &parts);
        report.folded_edges = folded_edges(surface, &edges);
        report
    }

    /// Whether every edge has one or two faces and every vertex one fan of them.
    pub const fn is_manifold(&self) -> bool {
        self.nonmanifold_edges == 0 && self.nonmanifold_vertices == 0
    }

    /// Whether it encloses something: a manifold without boundary.
    pub const fn is_closed(&self) -> bool {
        self.is_manifold() && self.boundary_edges == 0
    }

    /// Handles of all components together, if all have a genus.
    pub fn genus(&self) -> Option<u64> {
        self.components.iter().map(Component::genus).sum()
    }

    /// Boundary loops of all components.
    pub fn boundary_loops(&self) -> usize {
        self.components.iter().map(|component| component.boundary_loops).sum()
    }

    /// Enclosed volume of all components.
    pub fn volume(&self) -> f64 {
        self.components.iter().map(|component| component.volume).sum()
    }

    fn count_vertices(&mut self, surface: &impl Surface, parts: &mut Parts) {
        let mut fans = vec![0_u32; surface.points().len()];
        let corners = surface.polygons().flatten();
        for (corner, &vertex) in corners.enumerate() {
            if parts.fans.root(corner as u32) as usize == corner {
                fans[vertex as usize] += 1;
                let face = parts.face_of[corner];
                self.component(parts.component_of[face as usize]).vertices += 1;
            }
        }
        self.isolated_vertices = fans.iter().filter(|&&fans| fans == 0).count();
        self.vertices = fans.len() - self.isolated_vertices;
        self.nonmanifold_vertices = fans.iter().filter(|&&fans| fans > 1).count();
    }

    fn count_edges(&mut self, edges: &Edges, parts: &mut Parts) {
        for sides in edges.iter() {
            let component = self.component(parts.component_of[sides[0].face as usize]);
            component.edges += 1;
            component.boundary_edges += usize::from(sides.len() == 1);
            let inconsistent = sides.len() == 2 && sides[0].forward == sides[1].forward;
            component.faulty_edges += usize::from(sides.len() > 2 || inconsistent);
            self.boundary_edges += usize::from(sides.len() == 1);
            self.nonmanifold_edges += usize::from(sides.len() > 2);
            self.inconsistent_edges += usize::from(inconsistent);
        }
        let boundary = || edges.iter().filter(|sides| sides.len() == 1).map(|sides| sides[0]);
        let mut loops = parts.fans.clone();
        boundary().for_each(|side| loops.join(side.corners[0], side.corners[1]));
        let mut counted = vec![false; parts.face_of.len()];
        for side in boundary() {
            let root = loops.root(side.corners[0]) as usize;
            let new = !std::mem::replace(&mut counted[root], true);
            self.component(parts.component_of[side.face as usize]).boundary_loops += usize::from(new);
        }
    }

    fn count_faces(&mut self, surface: &impl Surface, parts: &Parts) {
        let points = surface.points();
        let middle = crate::measure::Bounds::around(points.iter().copied()).centre();
        let mut known: HashSet<Box<[u32]>> = HashSet::with_capacity(surface.polygons().len());
        let mut sorted = Vec::new();
        for (face, corners) in surface.polygons().enumerate() {
            let first = points[corners[0] as usize] - middle;
            let fan =
                corners[1..].array_windows().map(|pair| pair.map(|corner| points[corner as usize] - middle));
            let component = self.component(parts.component_of[face]);
            component.faces += 1;
            component.volume += fan.map(|[a, b]| first.dot(a.cross(b)) / 6.0).sum::<f64>();
            sorted.clear();
            sorted.extend_from_slice(corners);
            sorted.sort_unstable();
            let repeats = sorted.array_windows().any(|[a, b]| a == b);
            self.degenerate_faces += usize::from(repeats || area_vector(points, corners) == Point::ZERO);
            self.duplicate_faces += usize::from(!known.insert(sorted.as_slice().into()));
        }
    }

    fn component(&mut self, index: u32) -> &mut Component {
        let count = self.components.len().max(index as usize + 1);
        self.components.resize(count, Component::default());
        &mut self.components[index as usize]
    }
}

/// What belongs together.
struct Parts {
    /// Component of each face.
    component_of: Vec<u32>,
    /// Face of each corner.
    face_of: Vec<u32>,
    /// Corners around a vertex that hang together by edges.
    fans: Sets,
}

impl Parts {
    fn new(surface: &impl Surface, edges: &Edges) -> Self {
        let faces = surface.polygons().len();
        let face_of: Vec<u32> = surface
            .polygons()
            .enumerate()
            .flat_map(|(face, corners)| std::iter::repeat_n(face as u32, corners.len()))
            .collect();
        let mut fans = Sets::new(face_of.len());
        let mut hang_together = Sets::new(faces);
        for [a, b] in edges.iter().flat_map(<[Side]>::array_windows) {
            hang_together.join(a.face, b.face);
            fans.join(a.corners[0], b.corners[0]);
            fans.join(a.corners[1], b.corners[1]);
        }
        let (component_of, _) = hang_together.counted();
        Self { component_of, face_of, fans }
    }
}

fn repeated_positions(points: &[Point]) -> usize {
    let mut sorted: Vec<[u64; 3]> =
        points.iter().map(|point| (*point + Point::ZERO).to_array().map(f64::to_bits)).collect();
    sorted.sort_unstable();
    sorted.array_windows().filter(|[a, b]| a == b).count()
}

fn folded_edges(surface: &impl Surface, edges: &Edges) -> usize {
    let normals: Vec<Point> = surface
        .polygons()
        .map(|corners| area_vector(surface.points(), corners).normalize_or_zero())
        .collect();
    let folded = |sides: &&[Side]| {
        let [a, b] = sides else { return false };
        let cosine = normals[a.face as usize].dot(normals[b.face as usize]);
        (if a.forward == b.forward { -cosine } else { cosine }) < FOLD
    };
    edges.iter().filter(folded).count()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let genus = self.genus().map_or_else(|| "unknown".to_owned(), |genus| genus.to_string());
        write!(f, "{} vertices, {} edges, {} faces; ", self.vertices, self.edges, self.faces)?;
        write!(
            f,
            "components {}, genus {genus}, boundary loops {}",
            self.components.len(),
            self.boundary_loops()
        )?;
        let inward = self.components.iter().filter(|component| component.is_inward()).count();
        let remarks = [
            (self.isolated_vertices, "vertices without faces"),
            (self.boundary_edges, "boundary edges"),
            (self.nonmanifold_edges, "edges of more than two faces"),
            (self.nonmanifold_vertices, "vertices where surfaces touch"),
            (self.inconsistent_edges, "edges between faces of opposite orientation"),
            (inward, "components that look inwards"),
            (self.folded_edges, "folded edges"),
            (self.degenerate_faces, "faces without area"),
            (self.duplicate_faces, "faces that are there twice"),
            (self.repeated_positions, "vertices at the place of another"),
        ];
        remarks
            .iter()
            .filter(|(count, _)| *count > 0)
            .try_for_each(|(count, what)| write!(f, "; {count} {what}"))
    }
}

#[cfg(test)]
mod tests;
