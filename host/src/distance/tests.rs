use super::surface::nearest;
use super::*;
use crate::mesh::Point;

/// Distance to the nearest of all triangles.
fn brute(mesh: &TriangleMesh, from: Point) -> f64 {
    let distances = mesh.triangles.iter().map(|triangle| {
        nearest(triangle.map(|corner| mesh.positions[corner as usize]), from).0.distance(from)
    });
    distances.fold(f64::INFINITY, f64::min)
}

/// Share of every `step`-th node that is off the distance to all triangles by more than a share of a cell's edge.
fn share_off(distance: &ScalarField, mesh: &TriangleMesh, step: usize, most: f64) -> f64 {
    let grid = distance.grid();
    let nodes: Vec<usize> = (0..grid.len()).step_by(step).collect();
    let off = nodes.par_iter().filter(|&&node| {
        let exact = brute(mesh, grid.position(grid.node(node)));
        (f64::from(distance.values()[node].abs()) - exact).abs() > most * grid.cell_edge()
    });
    off.count() as f64 / nodes.len() as f64
}

fn waves(extent: [usize; 3], spacing: Point) -> ScalarField {
    let grid = Grid { extent, origin: Point::new(1.0, -2.0, 3.0), spacing };
    ScalarField::from_function(grid, |p| {
        (p.x * 0.5).sin() + (p.y * 0.35).sin() * (p.z * 0.4).cos() + 0.3 * (p.x * p.z * 0.05).sin()
    })
}

#[test]
fn distances_are_those_to_the_contour() {
    for spacing in [Point::ONE, Point::new(0.5, 1.0, 1.6)] {
        let field = waves([40, 36, 33], spacing);
        let mesh = contour(&field, 0.25).unwrap();
        let found = of_isosurface(&field, 0.25, &Options::default()).unwrap();
        let off = share_off(&found.field, &mesh, 61, 0.01);
        println!("{off} off, {:?}", found.report);
        assert!(off <= 0.01, "{off}");
        let signs = found.field.values().iter().zip(field.values());
        assert!(signs.clone().all(|(distance, value)| (*distance < 0.0) == (*value > 0.25)));
    }
}

#[test]
fn neither_blocks_nor_threads_change_a_thing() {
    let field = waves([50, 34, 41], Point::new(1.0, 0.7, 1.3));
    let run = |block, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| of_isosurface(&field, 0.1, &Options { block, ..Options::default() })).unwrap()
    };
    let one = run(128, 1);
    for (block, threads) in [(128, 2), (32, 1), (16, 3), (7, 2), (4, 1)] {
        assert_eq!(run(block, threads), one, "{block} {threads}");
    }
}

#[test]
fn a_limit_cuts_off_and_changes_nothing_else() {
    let field = waves([40, 36, 33], Point::ONE);
    let whole = of_isosurface(&field, 1.5, &Options::default()).unwrap();
    let cut = of_isosurface(&field, 1.5, &Options { limit: 3.0, ..Options::default() }).unwrap();
    assert!(cut.report.updates < whole.report.updates);
    for (cut, whole) in cut.field.values().iter().zip(whole.field.values()) {
        assert!((cut - whole.clamp(-3.0, 3.0)).abs() < 0.05, "{cut} {whole}");
    }
}
