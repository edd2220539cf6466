use super::*;
use crate::measure::Triangle;
use crate::mesh::Point;

/// Distance to the nearest of all triangles.
fn brute(mesh: &TriangleMesh, from: Point) -> f64 {
    let distances = mesh.triangles.iter().map(|triangle| {
        Triangle(triangle.map(|corner| mesh.positions[corner as usize])).nearest(from).point.distance(from)
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
    // Cells of unequal sides leave more to chance.
    for (spacing, most) in [(Point::ONE, 0.01), (Point::new(0.5, 1.0, 1.6), 0.02)] {
        let field = waves([40, 36, 33], spacing);
        let mesh = contour(&field, 0.25).unwrap();
        let found = of_isosurface(&field, 0.25, &Options::default()).unwrap();
        let off = share_off(&found.field, &mesh, 23, 0.01);
        println!("{off} off, {:?}", found.report);
        assert!(off <= most, "{off}");
        let signs = found.field.values().iter().zip(field.values());
        assert!(signs.clone().all(|(distance, value)| (*distance < 0.0) == (*value > 0.25)));
    }
}

#[test]
fn neither_slabs_nor_threads_change_a_thing() {
    let field = waves([50, 34, 41], Point::new(1.0, 0.7, 1.3));
    let run = |slab, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| of_isosurface(&field, 0.1, &Options { slab, ..Options::default() })).unwrap()
    };
    let one = run(128, 1);
    for (slab, threads) in [(128, 2), (32, 1), (16, 3), (7, 2), (4, 1)] {
        assert_eq!(run(slab, threads), one, "{slab} {threads}");
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

/// A torus around z of radii 1 and 0.4 as a closed mesh of triangles, counter-clockwise seen from outside.
fn torus(around: u32, across: u32) -> TriangleMesh {
    let angle = |n: u32, of: u32| std::f64::consts::TAU * f64::from(n) / f64::from(of);
    let vertices = (0..around).flat_map(|u| (0..across).map(move |v| (u, v)));
    let positions = vertices.clone().map(|(u, v)| {
        let (u, v) = (angle(u, around), angle(v, across));
        let radius = 1.0 + 0.4 * v.cos();
        Point::new(radius * u.cos(), radius * u.sin(), 0.4 * v.sin())
    });
    let triangles = vertices.flat_map(|(u, v)| {
        let at = |u: u32, v: u32| (u % around) * across + v % across;
        let [a, b, c, d] = [at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)];
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh { positions: positions.collect(), triangles: triangles.collect() }
}

/// Two pyramids with a common square base: sharp edges and vertices, and triangles of many cells.
fn octahedron(size: f64) -> TriangleMesh {
    let axes = [Point::X, Point::Y, Point::Z];
    let positions = axes.iter().flat_map(|&axis| [axis * size, -axis * size]).collect();
    let signs = (0..8_u32).map(|n| [n & 1, n >> 1 & 1, n >> 2]);
    let triangles = signs.map(|[x, y, z]| {
        let [a, b, c] = [x, 2 + y, 4 + z];
        if (x + y + z) % 2 == 0 { [a, b, c] } else { [a, c, b] }
    });
    TriangleMesh { positions, triangles: triangles.collect() }
}

#[test]
fn distances_to_a_torus_are_exact_with_the_right_signs() {
    let mesh = torus(40, 16);
    let grid = grid_around(&mesh, 40, 4).unwrap();
    let found = of_mesh(&mesh, &grid, &Options::default()).unwrap();
    assert!(share_off(&found.field, &mesh, 13, 0.01) <= 0.01);
    for node in 0..grid.len() {
        let point = grid.position(grid.node(node));
        let exact = (point.truncate().length() - 1.0).hypot(point.z) - 0.4;
        if exact.abs() > 0.02 {
            assert_eq!(found.field.values()[node] < 0.0, exact < 0.0, "{point}");
        }
    }
}

#[test]
fn large_triangles_and_sharp_edges_are_exact_within_a_limit_too() {
    let mesh = octahedron(1.3);
    let grid =
        Grid { origin: Point::splat(-2.0), spacing: Point::new(0.1, 0.125, 0.08), extent: [41, 33, 51] };
    for limit in [f64::INFINITY, 0.3] {
        let found = of_mesh(&mesh, &grid, &Options { limit, ..Options::default() }).unwrap();
        let mut off = 0;
        for node in 0..grid.len() {
            let point = grid.position(grid.node(node));
            let value = f64::from(found.field.values()[node]);
            let exact = brute(&mesh, point).min(limit);
            off += usize::from((value.abs() - exact).abs() > 0.001);
            let side = point.abs().element_sum() - 1.3;
            assert!(side.abs() < 1e-6 || (side < 0.0) == (value < 0.0), "{point} {value}");
        }
        assert!(off * 100 <= grid.len(), "{off}");
    }
}

#[test]
fn meshes_that_are_no_solids_get_a_clear_answer() {
    let options = Options::default();
    let grid = Grid { origin: Point::splat(-1.0), ..Grid::unit([8, 8, 8]) };
    let mut mesh = octahedron(2.0);
    mesh.triangles.pop();
    assert!(of_mesh(&mesh, &grid, &options).unwrap().field.values().iter().all(|value| value.is_finite()));
    // Inside out, doubled, and without area.
    mesh.triangles.extend(octahedron(2.0).triangles.iter().map(|&[a, b, c]| [a, c, b]));
    mesh.triangles.push([1, 1, 1]);
    mesh.triangles.push([0, 1, 0]);
    assert!(of_mesh(&mesh, &grid, &options).unwrap().field.values().iter().all(|value| value.is_finite()));
    mesh.triangles.push([0, 1, 6]);
    assert_eq!(
        of_mesh(&mesh, &grid, &options).unwrap_err(),
        DistanceError::NoSuchVertex { triangle: mesh.triangles.len() - 1 }
    );
    mesh.triangles.pop();
    mesh.positions[3].y = f64::NAN;
    assert_eq!(of_mesh(&mesh, &grid, &options).unwrap_err(), DistanceError::NotFinite { vertex: 3 });
    assert_eq!(grid_around(&mesh, 10, 1), Err(DistanceError::NotFinite { vertex: 3 }));
    let empty = TriangleMesh::default();
    assert_eq!(of_mesh(&empty, &grid, &options).unwrap_err(), DistanceError::NoSurface);
    assert_eq!(grid_around(&empty, 10, 1), Err(DistanceError::NoSurface));
    let point = TriangleMesh { positions: vec![Point::ONE; 3], triangles: vec![[0, 1, 2]] };
    assert!(matches!(grid_around(&point, 10, 1), Err(DistanceError::Grid(_))));
    assert!(of_mesh(&point, &grid, &options).is_ok());
    let far = Grid { origin: Point::splat(1e300), ..grid };
    assert_eq!(of_mesh(&octahedron(1.0), &far, &options).unwrap_err(), DistanceError::NoSurface);
    let thin = Grid { spacing: Point::new(1.0, 0.0, 1.0), ..grid };
    assert!(matches!(of_mesh(&octahedron(1.0), &thin, &options), Err(DistanceError::Grid(_))));
    let flat = ScalarField::new(Grid::unit([3, 3, 3]), vec![1.0; 27]);
    assert_eq!(of_isosurface(&flat, 2.0, &options).unwrap_err(), DistanceError::NoSurface);
}

#[test]
fn grids_have_the_mesh_in_their_middle() {
    let grid = grid_around(&octahedron(2.0), 8, 3).unwrap();
    assert_eq!((grid.extent, grid.spacing), ([15; 3], Point::splat(0.5)));
    assert_eq!(grid.origin, Point::splat(-3.5));
}
