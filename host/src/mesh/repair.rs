//! What an imported mesh needs before it is taken for a surface.

use std::collections::{HashMap, HashSet};
use std::fmt;

use super::edges::{Edges, Sets, Side};
use super::{Point, TriangleMesh};

/// What was changed, and what could not be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Vertices of boundaries that became one with another at the same place.
    pub welded_vertices: usize,
    /// Triangles with a vertex twice, and those with the same vertices in the same order as one before, that were left out.
    pub dropped_triangles: usize,
    /// Vertices without triangles that were left out.
    pub dropped_vertices: usize,
    /// Triangles that were turned to agree with their neighbours.
    pub turned_triangles: usize,
    /// Whether everything was turned inside out, since it looked inwards.
    pub turned_all: bool,
    /// Components with one side only, such as a Möbius strip; they are cut open.
    pub one_sided_components: usize,
    /// Edges of more than two triangles, or of two that cannot face the same way, that were taken apart. Orientation does
    /// not pass over them.
    pub nonmanifold_edges: usize,
    /// Vertices that were added where sheets touched, so that each has its own.
    pub split_vertices: usize,
}

impl fmt::Display for Repairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = [
            (self.welded_vertices, "vertices at the place of another became one with it"),
            (self.dropped_triangles, "triangles with a vertex twice or there twice left out"),
            (self.dropped_vertices, "vertices of no triangle left out"),
            (self.turned_triangles, "triangles turned to agree with their neighbours"),
            (self.one_sided_components, "components with one side only cut open"),
            (self.nonmanifold_edges, "edges of more than two triangles taken apart"),
            (self.split_vertices, "vertices added where sheets touched"),
        ];
        let mut separator = "";
        for (count, text) in what.into_iter().filter(|(count, _)| *count > 0) {
            write!(f, "{separator}{count} {text}")?;
            separator = "; ";
        }
        if self.turned_all {
            write!(f, "{separator}all turned, as the whole looked inwards")?;
        }
        Ok(())
    }
}

impl TriangleMesh {
    /// Makes one vertex of those on boundaries at the same place, drops what is degenerate, there twice or not used, and
    /// turns triangles so that neighbours agree and the whole looks outwards, and takes sheets apart that touch, so that a
    /// manifold is left.
    ///
    /// In each component the fewer triangles are turned. The whole is turned if the volume that its closed components
    /// enclose is negative in sum: hollows inside a body so keep looking into their hollow. Triangles without area whose
    /// vertices differ are kept, since without them there would be a hole; open components are turned with the whole.
    ///
    /// Cost: five sortings of the sides.
    pub fn repair(&mut self) -> Repairs {
        let mut repairs = Repairs { dropped_triangles: self.drop_triangles(), ..Repairs::default() };
        repairs.welded_vertices = self.weld_boundaries();
        repairs.dropped_triangles += self.drop_triangles();
        repairs.dropped_vertices = self.drop_vertices();
        self.orient(&mut repairs);
        let taken = self.take_apart();
        (repairs.nonmanifold_edges, repairs.split_vertices) = (taken.edges, taken.vertices);
        repairs
    }

    fn weld_boundaries(&mut self) -> usize {
        let mut at: HashMap<[u64; 3], u32> = HashMap::new();
        let mut on_boundary: Vec<u32> = Vec::new();
        let edges = Edges::new(self);
        on_boundary.extend(edges.iter().filter(|sides| sides.len() == 1).flat_map(|sides| sides[0].ends));
        on_boundary.sort_unstable();
        on_boundary.dedup();
        let mut replaced: Vec<u32> = (0..self.positions.len() as u32).collect();
        let mut welded = 0;
        for vertex in on_boundary {
            // Adding 0 makes -0 and 0 the same.
            let place = (self.positions[vertex as usize] + Point::ZERO).to_array().map(f64::to_bits);
            let first = *at.entry(place).or_insert(vertex);
            replaced[vertex as usize] = first;
            welded += usize::from(first != vertex);
        }
        self.triangles.iter_mut().flatten().for_each(|corner| *corner = replaced[*corner as usize]);
        welded
    }

    fn drop_triangles(&mut self) -> usize {
        let before = self.triangles.len();
        let mut known = HashSet::with_capacity(before);
        self.triangles.retain(|&[a, b, c]| {
            let smallest = a.min(b).min(c);
            let from_smallest =
                [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|turned| turned[0] == smallest);
            a != b && b != c && c != a && known.insert(from_smallest)
        });
        before - self.triangles.len()
    }

    fn drop_vertices(&mut self) -> usize {
        let before = self.positions.len();
        let mut used = vec![false; before];
        self.triangles.iter().flatten().for_each(|&corner| used[corner as usize] = true);
        let mut next = 0;
        let numbers: Vec<u32> = used
            .iter()
            .map(|&used| {
                next += u32::from(used);
                next.wrapping_sub(1)
            })
            .collect();
        self.triangles.iter_mut().flatten().for_each(|corner| *corner = numbers[*corner as usize]);
        let mut used = used.into_iter();
        self.positions.retain(|_| used.next() == Some(true));
        before - self.positions.len()
    }

    fn orient(&mut self, repairs: &mut Repairs) {
        let edges = Edges::new(self);
        let count = self.triangles.len();
        // Each triangle twice: as it is, and turned. Those that fit together make up a set; a component has two sets, or
        // one if it has one side.
        let mut fitting = Sets::new(2 * count);
        let turned = count as u32;
        for sides in edges.iter() {
            let [a, b] = sides else { continue };
            let [same, other] = if a.forward == b.forward { [turned, 0] } else { [0, turned] };
            fitting.join(a.face, b.face + same);
            fitting.join(a.face + turned, b.face + other);
        }
        let mut sizes = vec![0_u32; 2 * count];
        (0..turned).for_each(|face| sizes[fitting.root(face) as usize] += 1);
        for face in 0..turned {
            let [kept, opposite] = [fitting.root(face), fitting.root(face + turned)];
            if kept == opposite {
                // Its first triangle counts for the component.
                repairs.one_sided_components += usize::from(kept == face);
                continue;
            }
            let fewer = sizes[kept as usize] < sizes[opposite as usize];
            let tie = sizes[kept as usize] == sizes[opposite as usize] && kept > opposite;
            if fewer || tie {
                self.triangles[face as usize].swap(1, 2);
                repairs.turned_triangles += 1;
            }
        }
        repairs.turned_all = self.closed_volume(&edges) < 0.0;
        if repairs.turned_all {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
    }

    /// Signed volume of the components without boundary.
    fn closed_volume(&self, edges: &Edges) -> f64 {
        let mut together = Sets::new(self.triangles.len());
        for [a, b] in edges.iter().flat_map(<[Side]>::array_windows) {
            together.join(a.face, b.face);
        }
        let mut is_open = vec![false; self.triangles.len()];
        for sides in edges.iter().filter(|sides| sides.len() == 1) {
            is_open[together.root(sides[0].face) as usize] = true;
        }
        let middle = crate::measure::Bounds::around(self.positions.iter().copied()).centre();
        let closed = (0..self.triangles.len()).filter(|&face| !is_open[together.root(face as u32) as usize]);
        let volumes = closed.map(|face| {
            let [a, b, c] = self.triangles[face].map(|corner| self.positions[corner as usize] - middle);
            a.dot(b.cross(c)) / 6.0
        });
        volumes.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Report;

    const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn tetrahedron() -> TriangleMesh {
        TriangleMesh { positions: CORNERS.map(Point::from_array).to_vec(), triangles: TETRAHEDRON.to_vec() }
    }

    #[test]
    fn what_is_whole_stays_as_it_is() {
        let mut mesh = tetrahedron();
        assert_eq!(mesh.repair(), Repairs::default());
        assert_eq!(mesh, tetrahedron());
        assert_eq!(TriangleMesh::default().repair(), Repairs::default());
    }

    #[test]
    fn triangles_apart_and_turned_become_a_surface_again() {
        let mut mesh = TriangleMesh::default();
        for (index, triangle) in TETRAHEDRON.iter().enumerate() {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(triangle.map(|corner| Point::from_array(CORNERS[corner as usize])));
            mesh.triangles.push(if index == 1 {
                [first + 2, first + 1, first]
            } else {
                [0, 1, 2].map(|k| first + k)
            });
        }
        mesh.triangles.extend([[0, 1, 2], [3, 3, 4]]);
        mesh.positions.push(Point::ONE);
        let repairs = mesh.repair();
        // Twelve corners become four, and one vertex is used by no triangle.
        let expected = Repairs {
            welded_vertices: 8,
            dropped_triangles: 2,
            dropped_vertices: 9,
            turned_triangles: 1,
            ..Repairs::default()
        };
        assert_eq!(repairs, expected);
        let report = Report::of(&mesh);
        assert!(report.is_closed() && report.genus() == Some(0), "{report}");
        assert_eq!(report.vertices, 4);
        assert!((report.volume() - 1.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn repairs_are_told_in_words() {
        let repairs = Repairs { welded_vertices: 3, turned_all: true, ..Repairs::default() };
        assert_eq!(
            repairs.to_string(),
            "3 vertices at the place of another became one with it; all turned, as the whole looked inwards"
        );
    }

    #[test]
    fn what_looks_inwards_is_turned_and_hollows_stay_hollow() {
        let mut mesh = tetrahedron();
        let hollow = mesh.positions.iter().map(|&point| point * 0.25 + 0.125).collect::<Vec<_>>();
        mesh.positions.extend(hollow);
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh.triangles.extend(TETRAHEDRON.map(|triangle| triangle.map(|corner| corner + 4)));
        let repairs = mesh.repair();
        assert_eq!(repairs, Repairs { turned_all: true, ..Repairs::default() });
        let volumes: Vec<f64> = Report::of(&mesh).components.iter().map(|part| part.volume).collect();
        assert!(volumes[0] > 0.0 && volumes[1] < 0.0);
    }

    #[test]
    fn one_sided_strips_and_edges_of_three_are_taken_apart() {
        let positions: Vec<Point> = (0..10)
            .map(|vertex| {
                let turn = f64::from(vertex / 2) * std::f64::consts::TAU / 5.0;
                let width = f64::from(vertex % 2) - 0.5;
                let radius = 2.0 + width * (turn / 2.0).cos();
                Point::new(radius * turn.cos(), radius * turn.sin(), width * (turn / 2.0).sin())
            })
            .collect();
        let mut triangles: Vec<[u32; 3]> = (0..4)
            .flat_map(|step| [[0, 2, 1], [1, 2, 3]].map(|corners| corners.map(|k| step * 2 + k)))
            .collect();
        triangles.extend([[8, 1, 9], [9, 1, 0]]);
        let mut strip = TriangleMesh { positions, triangles };
        let repairs = strip.repair();
        assert_eq!(
            (repairs.one_sided_components, repairs.nonmanifold_edges, repairs.split_vertices),
            (1, 1, 2)
        );
        let report = Report::of(&strip);
        assert!(report.is_manifold() && report.inconsistent_edges == 0 && report.boundary_loops() == 1);
        let mut fins = tetrahedron();
        fins.positions.push(Point::ONE);
        fins.triangles.push([0, 1, 4]);
        assert_eq!(fins.repair().nonmanifold_edges, 1);
        assert!(Report::of(&fins).is_manifold());
    }
}
