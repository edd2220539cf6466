//! Points and normals of the limit surface, and normals of meshes.
//!
//! Where the surface is smooth, one step of the bicubic subdivision of Vis2000 eq. (3.8) makes points e in the n edges
//! around a vertex v and f in the faces. On averages over all directions the step does the same at any valence as on a
//! grid, so that the limit of v is v/9 + 8 ē/9, the (1 4 1)/6 of B-splines. On differences between directions it is that
//! of Catmull and Clark, so that tangents have the weights of Halstead, Kass & DeRose, *Efficient, Fair Interpolation
//! using Catmull-Clark Surfaces*, SIGGRAPH 1993. A crease is a cubic B-spline: 2 v/3 + v̄/3.

use std::f64::consts::TAU;

use super::{EdgeRule, Step, VertexRule};
use crate::mesh::{Point, PolygonMesh};

/// A mesh level on the limit surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// One point a vertex.
    pub positions: Vec<Point>,
    /// One unit normal a vertex; on features, where the limit has more than one, that of [`normals`].
    pub normals: Vec<Point>,
}

/// The limits of the vertices of a mesh, given the step that would split it next, under bicubic subdivision without
/// further details.
///
/// Cost: a few passes over the mesh.
///
/// # Panics
/// If the mesh has other vertices than the step splits.
pub fn limit(step: &Step, mesh: &PolygonMesh) -> Limit {
    let points = &mesh.positions;
    assert_eq!(points.len(), step.split.coarser_vertices(), "the mesh that the step splits");
    let faces: Vec<Point> = mesh
        .faces()
        .iter()
        .map(|face| face.iter().map(|&corner| points[corner as usize]).sum::<Point>() / face.len() as f64)
        .collect();
    let edges: Vec<Point> = edge_points(step, points, &faces);
    let mut sums = vec![Point::ZERO; points.len()];
    for ((edge, ends), rule) in edges.iter().zip(&step.split.edges).zip(&step.rules.edges) {
        for end in ends.map(|end| end as usize) {
            if step.rules.vertices[end] == VertexRule::Smooth || *rule == EdgeRule::Sharp {
                sums[end] += *edge;
            }
        }
    }
    let positions: Vec<Point> = (0..points.len())
        .map(|vertex| {
            let average = sums[vertex] / f64::from(step.rules.movers[vertex]);
            match step.rules.vertices[vertex] {
                VertexRule::Smooth => (points[vertex] + average * 8.0) / 9.0,
                // With edges halfway between old points: 2 v/3 + v̄/3.
                VertexRule::Crease => (points[vertex] + average * 2.0) / 3.0,
                VertexRule::Fixed => points[vertex],
            }
        })
        .collect();
    let mut on_limit = PolygonMesh::new(positions, mesh.faces().clone());
    let mut all = normals(&on_limit);
    smooth_normals(step, &edges, &faces, &mut all);
    Limit { positions: std::mem::take(&mut on_limit.positions), normals: all }
}

/// Points in edges after one step.
fn edge_points(step: &Step, points: &[Point], faces: &[Point]) -> Vec<Point> {
    let sides = step.split.edges.iter().zip(&step.split.edge_faces).zip(&step.rules.edges);
    sides
        .map(|((ends, beside), rule)| {
            let middle = (points[ends[0] as usize] + points[ends[1] as usize]) / 2.0;
            match (*beside, rule) {
                ([Some(one), Some(other)], EdgeRule::Smooth) => {
                    middle / 2.0 + (faces[one as usize] + faces[other as usize]) / 4.0
                }
                _ => middle,
            }
        })
        .collect()
}

/// Replaces the normals of smooth vertices by the cross products of the tangents of the limit.
fn smooth_normals(step: &Step, edges: &[Point], faces: &[Point], normals: &mut [Point]) {
    let split = &step.split;
    let mut at_vertex: Vec<Vec<u32>> = vec![Vec::new(); normals.len()];
    for (side, quad) in split.quads.iter().enumerate() {
        if step.rules.vertices[quad[0] as usize] == VertexRule::Smooth {
            at_vertex[quad[0] as usize].push(side as u32);
        }
    }
    for (normal, sides) in normals.iter_mut().zip(&mut at_vertex) {
        let Some(ring) = ordered(step, sides) else { continue };
        let n = ring.len() as f64;
        let cosine = |turn: f64| (TAU * turn / n).cos();
        // The weight of edge points to that of face points.
        let weight = 1.0 + cosine(1.0) + (TAU / (2.0 * n)).cos() * (2.0 * (9.0 + cosine(1.0))).sqrt();
        let tangent = |turned: f64| -> Point {
            let at = |(place, &[edge, face]): (usize, &[usize; 2])| {
                let [here, next] = [0.0, 1.0].map(|turn| cosine(place as f64 + turn - turned));
                edges[edge] * (weight * here) + faces[face] * (here + next)
            };
            ring.iter().enumerate().map(at).sum()
        };
        let cross = tangent(0.0).cross(tangent(n / 4.0));
        if let Some(unit) = cross.try_normalize() {
            *normal = unit;
        }
    }
}

/// Edges and faces around a vertex, counter-clockwise, given the sides that begin there; `None` if they are no ring.
fn ordered(step: &Step, sides: &mut [u32]) -> Option<Vec<[usize; 2]>> {
    let split = &step.split;
    let after = |side: u32| split.quads[side as usize][1];
    for place in 1..sides.len() {
        let before = split.quads[sides[place - 1] as usize][3];
        let next = place + sides[place..].iter().position(|&side| after(side) == before)?;
        sides.swap(place, next);
    }
    let closes = sides.len() > 2 && split.quads[*sides.last()? as usize][3] == after(sides[0]);
    let place = |&side: &u32| {
        let quad = split.quads[side as usize];
        [(quad[1] - split.edge_vertex(0)) as usize, (quad[2] - split.face_vertex(0)) as usize]
    };
    closes.then(|| sides.iter().map(place).collect())
}

/// Unit normals of the vertices of a mesh: of all faces around, by area. Zero where there is none.
///
/// Cost: one pass.
pub fn normals(mesh: &PolygonMesh) -> Vec<Point> {
    area_vectors(mesh).iter().map(|area| area.try_normalize().unwrap_or(Point::ZERO)).collect()
}

/// For each vertex twice the sum of the areas around it, each times its normal.
pub(crate) fn area_vectors(mesh: &PolygonMesh) -> Vec<Point> {
    let mut vectors = vec![Point::ZERO; mesh.positions.len()];
    for face in mesh.faces().iter() {
        let at = |corner: usize| mesh.positions[face[corner] as usize];
        let area = (1..face.len() - 1).map(|corner| (at(corner) - at(0)).cross(at(corner + 1) - at(0)));
        let area: Point = area.sum();
        face.iter().for_each(|&corner| vectors[corner as usize] += area);
    }
    vectors
}

#[cfg(test)]
mod tests {
    use super::super::{Hierarchy, Split, SubdivisionSurface};
    use super::*;
    use crate::mesh::Faces;
    use crate::surface_wavelet::{Basis, inverse_step};

    /// A pyramid over a polygon, closed from below, with a sharp edge, a sharp vertex or neither.
    fn pyramid(sides: u32) -> PolygonMesh {
        let mut faces: Faces = (0..sides)
            .map(|side| [side, (side + 1) % sides, sides])
            .collect::<Vec<_>>()
            .iter()
            .map(<[u32; 3]>::as_slice)
            .collect();
        faces.push(&(0..sides).rev().collect::<Vec<_>>());
        let at = |side: u32| {
            let turn = TAU * f64::from(side) / f64::from(sides);
            Point::new(turn.cos() * 1.5, turn.sin(), 0.1 * turn)
        };
        let points = (0..sides).map(at).chain([Point::new(0.2, 0.1, 1.0)]).collect();
        PolygonMesh::new(points, faces)
    }

    /// After many steps old vertices have come to their limits, and normals of the finest mesh to those.
    #[test]
    fn limits_are_where_subdivision_goes() {
        for sides in 3..8 {
            for (edges, vertices) in
                [(vec![], vec![]), (vec![[0, 1], [0, sides - 1]], vec![]), (vec![], vec![sides])]
            {
                let mut mesh = pyramid(sides);
                mesh.features.edges = edges;
                mesh.features.vertices = vertices;
                let mut surface = SubdivisionSurface::from(mesh.clone());
                let levels = 7;
                let hierarchy = Hierarchy::new(mesh.positions.len(), mesh.faces(), &mesh.features, levels);
                let expected = limit(&hierarchy.steps()[0], &mesh);
                for step in hierarchy.steps() {
                    let added = step.split.finer_vertices() - step.split.coarser_vertices();
                    surface.refine(&step.split, &vec![Point::ZERO; added]);
                    inverse_step(Basis::Bicubic, step, &mut surface.positions);
                }
                let fine = surface.level(levels);
                let normals = normals(&fine);
                let rules = &hierarchy.steps()[0].rules.vertices;
                let found = fine.positions.iter().zip(&normals).zip(rules);
                for ((found, limit), normal) in found.zip(&expected.positions).zip(&expected.normals) {
                    let ((point, fine_normal), rule) = found;
                    assert!((*point - *limit).length() < 1e-3);
                    assert!(*rule != VertexRule::Smooth || fine_normal.dot(*normal) > 0.9995, "{sides}");
                }
            }
        }
    }

    #[test]
    fn a_plane_has_its_normal() {
        let faces: Faces = [&[0, 1, 2, 3][..]].into_iter().collect();
        let points = vec![Point::ZERO, Point::X, Point::new(1.0, 1.0, 0.0), Point::Y];
        let mesh = PolygonMesh::new(points, faces);
        assert_eq!(normals(&mesh), [Point::Z; 4]);
        let split = Split::new(4, mesh.faces());
        let rules = super::super::Rules::new(&split, &mesh.features);
        assert_eq!(limit(&Step { split, rules }, &mesh).normals, [Point::Z; 4]);
    }
}
