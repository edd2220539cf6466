use std::collections::HashMap;

use super::contour;
use crate::field::{Grid, ScalarField};
use crate::mesh::{Point, TriangleMesh};

mod cases;
mod topology;

/// Random numbers, the same everywhere.
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11
    }

    /// A field of whole numbers from `-bound` to `bound`.
    pub(super) fn field(&mut self, extent: [usize; 3], bound: u64) -> ScalarField {
        let grid = Grid::unit(extent);
        let values = (0..grid.len()).map(|_| (self.next() % (2 * bound + 1)) as f32 - bound as f32);
        ScalarField::new(grid, values.collect())
    }
}

/// Panics unless the mesh is an oriented manifold whose boundary lies on the border of the grid, with all vertices used and
/// no degenerate triangle.
pub(super) fn assert_manifold(mesh: &TriangleMesh, grid: &Grid) {
    let mut sides = HashMap::new();
    for (face, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            assert!(from != to, "triangle {face} has a corner twice");
            assert!(sides.insert((from, to), face).is_none(), "side {from} {to} twice");
        }
        let [a, b, c] = [a, b, c].map(|corner| mesh.positions[corner as usize]);
        assert!((b - a).cross(c - a).length() > 1e-9, "triangle {face} has no area: {a} {b} {c}");
    }
    let last = grid.local(grid.position(grid.extent.map(|nodes| nodes - 1)));
    let on_border = |corner: u32| {
        let local = grid.local(mesh.positions[corner as usize]);
        (0..3).map(|axis| (local[axis] < 1e-9, local[axis] > last[axis] - 1e-9)).collect::<Vec<_>>()
    };
    for &(from, to) in sides.keys().filter(|(from, to)| !sides.contains_key(&(*to, *from))) {
        let shared = on_border(from).into_iter().zip(on_border(to));
        assert!(shared.clone().any(|(a, b)| a.0 && b.0 || a.1 && b.1), "hole at {from} {to}");
    }
    assert_one_fan_a_vertex(mesh);
}

/// Panics unless the triangles around each vertex are one fan.
fn assert_one_fan_a_vertex(mesh: &TriangleMesh) {
    // What follows each corner around each vertex.
    let mut around = vec![HashMap::new(); mesh.positions.len()];
    for &[a, b, c] in &mesh.triangles {
        for [center, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
            around[center as usize].insert(from, to);
        }
    }
    for (vertex, next) in around.iter().enumerate() {
        let first = next.keys().find(|from| !next.values().any(|to| to == *from)).or(next.keys().next());
        let mut corner = *first.expect("a vertex of some triangle");
        let mut steps = 0;
        while let Some(&to) = next.get(&corner) {
            (corner, steps) = (to, steps + 1);
            if Some(&corner) == first {
                break;
            }
        }
        assert_eq!(steps, next.len(), "several fans at vertex {vertex}");
    }
}

/// Vertices - edges + faces.
pub(super) fn euler_characteristic(mesh: &TriangleMesh) -> i64 {
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let edges: std::collections::HashSet<_> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    mesh.positions.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64
}

#[test]
fn a_ball_is_round_closed_and_faces_outwards() {
    let center = Point::splat(5.0);
    let field = ScalarField::from_function(Grid::unit([11, 11, 11]), |p| 4.0 - p.distance(center));
    let mesh = contour(&field, 0.25).unwrap();
    assert_manifold(&mesh, field.grid());
    assert_eq!(euler_characteristic(&mesh), 2);
    for &triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        assert!((b - a).cross(c - a).dot(a - center) > 0.0);
        assert!((a.distance(center) - 3.75).abs() < 0.1);
    }
}

#[test]
fn noise_of_any_kind_gives_manifolds() {
    let mut noise = Noise(1);
    // From values that are mostly equal to the isovalue, to values that never are.
    for (bound, isovalue) in [(1, 0.0), (1, 0.5), (2, 0.0), (3, 1.0), (1000, 0.0), (1000, 0.5)] {
        for _ in 0..12 {
            let field = noise.field([9, 8, 7], bound);
            let mesh = contour(&field, isovalue).unwrap();
            assert_manifold(&mesh, field.grid());
        }
    }
}

#[test]
fn rows_of_any_length_and_any_number_of_threads_agree() {
    let mut noise = Noise(2);
    for width in [2, 3, 63, 64, 65, 66, 127, 128, 129, 130] {
        let field = noise.field([width, 5, 6], 100);
        let mesh = contour(&field, 7.0).unwrap();
        assert_manifold(&mesh, field.grid());
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| contour(&field, 7.0)).unwrap(), mesh);
        }
    }
}

#[test]
fn grids_without_cells_and_values_that_are_not_numbers_do_no_harm() {
    let flat = ScalarField::new(Grid::unit([2, 2, 1]), vec![0.0, 1.0, 1.0, 0.0]);
    assert_eq!(contour(&flat, 0.5).unwrap(), TriangleMesh::default());
    let values = [f32::NAN, f32::INFINITY, 1.0, f32::NEG_INFINITY, f32::MAX, f32::MIN, f32::NAN, 0.0];
    let field = ScalarField::new(Grid::unit([2, 2, 2]), values.to_vec());
    for isovalue in [0.5, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mesh = contour(&field, isovalue).unwrap();
        assert!(mesh.positions.iter().all(|point| point.is_finite()));
    }
}

#[test]
fn spacing_and_origin_move_the_surface() {
    let field = Noise(3).field([6, 5, 4], 50);
    let grid =
        Grid { origin: Point::new(3.0, -2.0, 1.0), spacing: Point::new(0.5, 2.0, 3.0), ..*field.grid() };
    let moved = contour(&ScalarField::new(grid, field.values().to_vec()), 0.5).unwrap();
    let mesh = contour(&field, 0.5).unwrap();
    assert_eq!(moved.triangles, mesh.triangles);
    for (found, point) in moved.positions.iter().zip(&mesh.positions) {
        assert!(found.distance(grid.origin + grid.spacing * *point) < 1e-12);
    }
}
