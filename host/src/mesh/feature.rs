//! Sharp edges and vertices, found by angles.
//!
//! Source: Vis2000 §3.4 tells what features do; that an edge is sharp where its faces meet at more than a given angle is
//! as in Hubeli, Gross, *Multiresolution Feature Extraction for Unstructured Meshes*, 2001 (second order difference).

use super::edges::Edges;
use super::triangulation::area_vector;
use super::{Features, Point, Surface};

/// Angles beyond which something is sharp, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureAngles {
    /// Between the normals of the two faces of an edge.
    pub edge: f64,
    /// Between the directions of two sharp edges, or edges of the boundary, that follow each other.
    pub turn: f64,
}

impl Default for FeatureAngles {
    fn default() -> Self {
        Self { edge: 40.0, turn: 50.0 }
    }
}

impl Features {
    /// Finds the sharp edges of a surface by the angle between the normals of their faces, and the sharp vertices: those
    /// where other than two sharp or boundary edges meet, one of them sharp at least, and those where two meet that turn.
    ///
    /// Edges of the boundary are not listed among the sharp ones. A vertex where a sharp edge ends is sharp.
    ///
    /// Cost: sorting of the sides.
    pub fn by_angle(surface: &impl Surface, angles: FeatureAngles) -> Self {
        let points = surface.points();
        let normals: Vec<Point> =
            surface.polygons().map(|corners| area_vector(points, corners).normalize_or_zero()).collect();
        let [edge_cosine, turn_cosine] = [angles.edge, angles.turn].map(|angle| angle.to_radians().cos());
        let mut found = Self::default();
        let mut meeting = vec![Meeting::default(); points.len()];
        for sides in Edges::new(surface).iter() {
            let is_sharp = match sides {
                [_] => false,
                [a, b] => normals[a.face as usize].dot(normals[b.face as usize]) < edge_cosine,
                _ => true,
            };
            let ends = sides[0].ends;
            if is_sharp {
                found.edges.push(ends);
            }
            if is_sharp || sides.len() == 1 {
                let [from, to] = ends.map(|end| points[end as usize]);
                let along = (to - from).normalize_or_zero();
                meeting[ends[0] as usize].add(along, is_sharp);
                meeting[ends[1] as usize].add(-along, is_sharp);
            }
        }
        let is_sharp = |(_, meeting): &(usize, &Meeting)| meeting.is_sharp(turn_cosine);
        found.vertices =
            meeting.iter().enumerate().filter(is_sharp).map(|(vertex, _)| vertex as u32).collect();
        found
    }
}

/// Sharp edges and edges of the boundary that leave a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Meeting {
    sharp: u32,
    boundary: u32,
    /// Direction of the first, and of the last one after it.
    first: Point,
    last: Point,
}

impl Meeting {
    fn add(&mut self, along: Point, is_sharp: bool) {
        if self.sharp + self.boundary == 0 {
            self.first = along
        } else {
            self.last = along
        }
        self.sharp += u32::from(is_sharp);
        self.boundary += u32::from(!is_sharp);
    }

    fn is_sharp(&self, turn_cosine: f64) -> bool {
        match self.sharp + self.boundary {
            2 => -self.first.dot(self.last) < turn_cosine,
            _ => self.sharp > 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collection::collection;
    use crate::mesh::{Faces, PolygonMesh, read};

    fn cube() -> PolygonMesh {
        let corner = |bits: u32| [bits & 1, bits >> 1 & 1, bits >> 2].map(f64::from);
        let positions = (0..8).map(|bits| Point::from_array(corner(bits))).collect();
        let faces: [&[u32]; 6] =
            [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
        PolygonMesh::new(positions, Faces::from_iter(faces))
    }

    #[test]
    fn all_of_a_cube_is_sharp_and_nothing_at_a_wider_angle() {
        let sharp = Features::by_angle(&cube(), FeatureAngles::default());
        assert_eq!((sharp.edges.len(), sharp.vertices.len()), (12, 8));
        assert!(sharp.edges.is_sorted() && sharp.edges.iter().all(|[a, b]| a < b));
        let none = Features::by_angle(&cube(), FeatureAngles { edge: 91.0, turn: 50.0 });
        assert_eq!(none, Features::default());
    }

    #[test]
    fn boundaries_turn_at_the_corners_of_a_sheet_and_where_a_crease_ends() {
        // Two columns of two squares, folded along the middle.
        let positions = (0..9).map(|at| {
            let (x, y) = (f64::from(at % 3), f64::from(at / 3));
            Point::new(x.min(1.0), y, (x - 1.0).max(0.0))
        });
        let faces: Vec<[u32; 4]> = [0, 1, 3, 4].map(|at| [at, at + 1, at + 4, at + 3]).to_vec();
        let sheet = PolygonMesh::new(positions.collect(), faces.iter().map(<[u32; 4]>::as_slice).collect());
        let found = Features::by_angle(&sheet, FeatureAngles::default());
        assert_eq!(found.edges, [[1, 4], [4, 7]]);
        assert_eq!(found.vertices, [0, 1, 2, 6, 7, 8]);
    }

    #[test]
    fn the_creases_of_the_fandisk_are_closed_curves() {
        let Ok(mesh) = read(&collection().join("meshes/fandisk.ply")) else {
            println!("skipped: no collection of meshes beside the repository, and WAVELIFT_DATA names none");
            return;
        };
        let found = Features::by_angle(&mesh, FeatureAngles::default());
        let mut degrees = vec![0; mesh.positions.len()];
        found.edges.iter().flatten().for_each(|&end| degrees[end as usize] += 1);
        let count = |wanted: u32| degrees.iter().filter(|&&degree| degree == wanted).count();
        let [ends, corners] = [count(1), count(3)];
        println!(
            "{} sharp edges, {} sharp vertices, {ends} ends, {corners} corners",
            found.edges.len(),
            found.vertices.len()
        );
        assert!(found.edges.len() > 400 && found.edges.len() < 1000);
        assert!(ends <= 2 && corners >= 16);
        assert!(found.vertices.iter().all(|&vertex| degrees[vertex as usize] > 0));
    }
}
