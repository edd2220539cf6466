//! What simpler meshes must have in common with the ones that they were made from.

use super::*;
use crate::collection::collection;
use crate::field::ScalarField;
use crate::isosurface::contour;
use crate::measure::{Bvh, SurfaceDistance};
use crate::mesh::{FeatureAngles, Point, PolygonMesh, Report, Surface, TriangleMesh, read};
use crate::subdivision::SubdivisionSurface;

const NO_LIMIT: f64 = f64::INFINITY;

fn wave(extent: usize, frequency: f64, shift: f64) -> ScalarField {
    ScalarField::from_function(Grid::unit([extent; 3]), |at| {
        let [x, y, z] = (frequency * at).to_array();
        x.sin() * y.cos() + (1.1 * y).sin() * z.cos() + (0.9 * z).sin() * (1.2 * x).cos() - shift
    })
}

/// Positive inside a ring of the radii 10 and 4.
fn ring() -> ScalarField {
    ScalarField::from_function(Grid::unit([34; 3]), |at| {
        let at = at - Point::splat(16.6);
        4.0 - (at.x.hypot(at.y) - 10.0).hypot(at.z)
    })
}

/// Characteristic and boundary loops of each component, in order.
fn topology(surface: &impl Surface) -> Vec<(i64, usize)> {
    let report = Report::of(surface);
    assert!(report.is_manifold(), "{report:?}");
    assert_eq!(report.inconsistent_edges + report.degenerate_faces + report.duplicate_faces, 0);
    let mut parts: Vec<_> =
        report.components.iter().map(|part| (part.euler(), part.boundary_loops)).collect();
    parts.sort_unstable();
    parts
}

/// Numbers of edges of the vertices, and whether the vertices are on the boundary.
fn valences(mesh: &PolygonMesh) -> Vec<(usize, bool)> {
    let split = crate::subdivision::Split::new(mesh.positions.len(), mesh.faces());
    let mut valences = vec![(0, false); mesh.positions.len()];
    for (ends, faces) in split.edges.iter().zip(&split.edge_faces) {
        for end in ends {
            valences[*end as usize].0 += 1;
            valences[*end as usize].1 |= faces[1].is_none();
        }
    }
    valences
}

/// Share of the triangles that look away from where the nearest triangles of the original look.
fn turned(simple: &TriangleMesh, original: &TriangleMesh) -> f64 {
    let normal = |mesh: &TriangleMesh, triangle: usize| {
        let [a, b, c] = mesh.triangles[triangle].map(|vertex| mesh.positions[vertex as usize]);
        ((b - a).cross(c - a), (a + b + c) / 3.0)
    };
    let tree = Bvh::new(original);
    let turned = (0..simple.triangles.len()).filter(|&triangle| {
        let (direction, centre) = normal(simple, triangle);
        let nearest = tree.closest(centre).expect("a triangle").triangle;
        normal(original, nearest as usize).0.dot(direction) < 0.0
    });
    turned.count() as f64 / simple.triangles.len() as f64
}

fn check_all(mesh: &TriangleMesh, grid: Option<Grid>, share: usize) -> (Collapsed, PolygonMesh) {
    let constraints = Constraints { border: grid, ..Constraints::default() };
    let target = Target { vertices: mesh.positions.len() / share, error: NO_LIMIT };
    let collapsed = collapse_edges(mesh, &constraints, target).expect("a manifold");
    let base = base_mesh(mesh, &constraints, target).expect("a manifold").mesh;
    let before = topology(mesh);
    assert_eq!(topology(&collapsed.mesh), before);
    assert_eq!(topology(&base), before);
    assert_eq!(base.positions, collapsed.mesh.positions);
    assert!(base.faces().iter().all(|face| (3..=5).contains(&face.len())));
    for (valence, boundary) in valences(&base) {
        assert!((if boundary { 2 } else { 3 }..=8).contains(&valence), "{valence}");
    }
    (collapsed, base)
}

#[test]
fn a_ring_keeps_its_handle_and_its_volume() {
    let mesh = contour(&ring(), 0.0).unwrap();
    let (collapsed, base) = check_all(&mesh, None, 30);
    assert_eq!(topology(&base), [(0, 0)]);
    assert!(collapsed.mesh.positions.len() <= mesh.positions.len() / 30);
    let volumes = [&mesh, &collapsed.mesh].map(|mesh| Report::of(mesh).volume());
    assert!((volumes[1] / volumes[0] - 1.0).abs() < 0.01, "{volumes:?}");
    let distance = SurfaceDistance::between(&mesh, &collapsed.mesh, 20_000).unwrap();
    assert!(distance.rms(1.0) < 0.3, "{distance:?}");
    assert!(turned(&collapsed.mesh, &mesh) < 0.001);
    let quads = base.faces().iter().filter(|face| face.len() == 4).count();
    assert!(quads * 5 > base.faces().len() * 2, "{quads} of {}", base.faces().len());
}

#[test]
fn what_cannot_be_smaller_is_left() {
    let ball = ScalarField::from_function(Grid::unit([12; 3]), |at| 4.1 - at.distance(Point::splat(5.4)));
    let mesh = contour(&ball, 0.0).unwrap();
    let none = Target { vertices: 0, error: NO_LIMIT };
    let collapsed = collapse_edges(&mesh, &Constraints::default(), none).unwrap();
    assert_eq!(topology(&collapsed.mesh), [(2, 0)]);
    // Of some 250 vertices.
    assert!((12..20).contains(&collapsed.mesh.positions.len()), "{}", collapsed.mesh.positions.len());
}

#[test]
fn handles_and_open_borders_survive_windows_and_all() {
    let field = wave(64, 0.45, 0.1);
    let mesh = contour(&field, 0.0).unwrap();
    let (collapsed, _) = check_all(&mesh, Some(*field.grid()), 20);
    assert!(mesh.positions.len() > 16 << 11, "windows are met");
    assert!(collapsed.mesh.positions.len() <= mesh.positions.len() / 20);
    assert!(turned(&collapsed.mesh, &mesh) < 0.01);
    let on_border = |mesh: &TriangleMesh| {
        // Boundary vertices in one plane and in two, by the planes.
        let polygons = PolygonMesh::from(mesh.clone());
        let inner = |at: f64| (1e-9..63.0 - 1e-9).contains(&at);
        let flags = valences(&polygons);
        let border = polygons.positions.iter().zip(flags).filter(|(_, (_, boundary))| *boundary);
        let planes = border.map(|(at, _)| at.to_array().into_iter().filter(|&at| !inner(at)).count());
        planes.fold([0; 3], |mut counts, planes| {
            counts[planes.min(2)] += 1;
            counts
        })
    };
    let [before, after] = [&mesh, &collapsed.mesh].map(on_border);
    assert_eq!([before[0], after[0]], [0, 0], "boundary vertices leave the border");
    assert_eq!(before[2], after[2], "turns of the boundary on the edges of the volume");
}

#[test]
fn many_components_survive() {
    let field = wave(40, 0.9, 1.4);
    let mesh = contour(&field, 0.0).unwrap();
    let parts = topology(&mesh).len();
    assert!(parts > 20, "{parts}");
    check_all(&mesh, Some(*field.grid()), 50);
}

#[test]
fn errors_stay_below_the_limit() {
    let mesh = contour(&ring(), 0.0).unwrap();
    let target = Target { vertices: 0, error: 0.5 };
    let collapsed = collapse_edges(&mesh, &Constraints::default(), target).unwrap();
    assert!(collapsed.error <= 0.5, "{}", collapsed.error);
    let [before, after] = [&mesh, &collapsed.mesh].map(|mesh| mesh.positions.len());
    assert!(after * 3 < before * 2, "{after} of {before}");
    let distance = SurfaceDistance::between(&mesh, &collapsed.mesh, 20_000).unwrap();
    assert!(distance.rms(1.0) < 0.5, "{distance:?}");
}

/// A cube of `size` squares along an edge, each cut in two, and its sharp edges.
fn cube(size: u32) -> (TriangleMesh, Features) {
    let mut names = std::collections::HashMap::new();
    let mut mesh = TriangleMesh::default();
    for face in 0..6 {
        for square in 0..size * size {
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[right, up]| {
                let [right, up] = [square % size + right, square / size + up];
                let mut at = [0; 3];
                at[face / 2] = if face % 2 == 1 { size } else { 0 };
                at[(face / 2 + 1) % 3] = if face % 2 == 1 { right } else { up };
                at[(face / 2 + 2) % 3] = if face % 2 == 1 { up } else { right };
                *names.entry(at).or_insert_with(|| {
                    mesh.positions.push(Point::from_array(at.map(f64::from)));
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|three| three.map(|place| corners[place])));
        }
    }
    let features = Features::by_angle(&mesh, FeatureAngles::default());
    (mesh, features)
}

#[test]
fn a_cube_with_sharp_edges_becomes_a_cube() {
    let (mesh, features) = cube(9);
    assert_eq!(features.edges.len(), 12 * 9);
    let constraints = Constraints { features, ..Constraints::default() };
    let target = Target { vertices: 0, error: 1e-3 };
    let collapsed = collapse_edges(&mesh, &constraints, target).unwrap();
    let volume = Report::of(&collapsed.mesh).volume();
    assert!((volume - 729.0).abs() < 1e-9, "{volume}");
    for corner in 0..8 {
        let corner = Point::from_array([0, 1, 2].map(|axis| f64::from(9 * (corner >> axis & 1))));
        assert!(collapsed.mesh.positions.contains(&corner));
    }
    assert_eq!(topology(&collapsed.mesh), [(2, 0)]);
    let length: f64 = collapsed
        .features
        .edges
        .iter()
        .map(|edge| {
            let [from, to] = edge.map(|end| collapsed.mesh.positions[end as usize]);
            from.distance(to)
        })
        .sum();
    assert!((length - 108.0).abs() < 1e-9, "{length}");
    assert!(collapsed.mesh.positions.len() < 30, "{}", collapsed.mesh.positions.len());
}

#[test]
fn sharp_features_of_fandisk_survive() {
    let path = collection().join("meshes/fandisk.ply");
    let Ok(mesh) = read(&path) else { return println!("skipped: no {}", path.display()) };
    let features = Features::by_angle(&mesh, FeatureAngles::default());
    let length = |positions: &[Point], edges: &[[u32; 2]]| -> f64 {
        edges.iter().map(|edge| positions[edge[0] as usize].distance(positions[edge[1] as usize])).sum()
    };
    let before = length(&mesh.positions, &features.edges);
    let corners = corners_of(&mesh.positions, &features);
    let constraints = Constraints { features, ..Constraints::default() };
    let base = base_mesh(&mesh, &constraints, Target { vertices: 300, error: NO_LIMIT }).unwrap().mesh;
    assert_eq!(topology(&base), topology(&mesh));
    let after = length(&base.positions, &base.features.edges);
    assert!((after / before - 1.0).abs() < 0.02, "{before} {after}");
    assert_eq!(corners_of(&base.positions, &base.features), corners);
}

/// Places where sharp edges end or more than two meet, in order.
fn corners_of(positions: &[Point], features: &Features) -> Vec<[u64; 3]> {
    let mut counts = vec![0; positions.len()];
    features.edges.as_flattened().iter().for_each(|&end| counts[end as usize] += 1);
    let corners = positions.iter().zip(counts).filter(|&(_, count)| count == 1 || count > 2);
    let mut places: Vec<_> = corners.map(|(at, _)| at.to_array().map(f64::to_bits)).collect();
    places.sort_unstable();
    places
}

#[test]
fn the_same_mesh_gives_the_same_base() {
    let mesh = contour(&wave(32, 0.5, 0.0), 0.0).unwrap();
    let target = Target { vertices: 300, error: NO_LIMIT };
    let [one, two] = [0, 1].map(|_| base_mesh(&mesh, &Constraints::default(), target).unwrap().mesh);
    assert_eq!(one, two);
}

#[test]
fn meshes_that_are_none_are_refused() {
    let positions = vec![Point::ZERO, Point::X, Point::Y, Point::Z, Point::ONE];
    let refused = |positions: &[Point], triangles: &[[u32; 3]], features: Features| {
        let mesh = TriangleMesh { positions: positions.to_vec(), triangles: triangles.to_vec() };
        let target = Target { vertices: 0, error: NO_LIMIT };
        collapse_edges(&mesh, &Constraints { features, ..Constraints::default() }, target)
            .map(|_| ())
            .unwrap_err()
    };
    let pinched = [[0, 1, 2], [0, 3, 4]];
    assert_eq!(
        refused(&positions, &pinched, Features::default()),
        SimplifyError::PinchedVertex { vertex: 0 }
    );
    let edge = Features { edges: vec![[1, 3]], vertices: vec![] };
    assert_eq!(refused(&positions, &pinched[..1], edge), SimplifyError::NoSuchEdge { edge: [1, 3] });
    let vertex = Features { edges: vec![], vertices: vec![9] };
    let expected = SimplifyError::NoSuchSharpVertex { vertex: 9 };
    assert_eq!(refused(&positions, &pinched[..1], vertex), expected);
    let infinite = [Point::ZERO, Point::X, Point::splat(f64::NAN)];
    let expected = SimplifyError::NotFinite { vertex: 2 };
    assert_eq!(refused(&infinite, &pinched[..1], Features::default()), expected);
    let empty = TriangleMesh::default();
    let target = Target { vertices: 0, error: NO_LIMIT };
    assert!(base_mesh(&empty, &Constraints::default(), target).unwrap().mesh.faces().is_empty());
}

#[test]
fn octrees_of_waves_are_manifolds() {
    for (solid, finest) in [(Solid::Minimum, 0), (Solid::Minimum, 1), (Solid::Mean, 1)] {
        let field = wave(45, 0.35, 0.2);
        let options = OctreeOptions { solid, finest, coarsest: 2, deviation: 0.05 };
        let mesh = octree_mesh(&field, &options);
        let report = Report::of(&mesh);
        assert!(report.is_manifold() && report.inconsistent_edges == 0, "{report:?}");
        assert!(mesh.faces().iter().all(|face| (4..=9).contains(&face.len())));
        let idle = valences(&mesh).iter().filter(|&&(valence, boundary)| valence < 3 && !boundary).count();
        assert!(idle * 100 < mesh.positions.len(), "{idle} vertices of two edges");
        assert!(mesh.faces().len() > 30, "{}", mesh.faces().len());
    }
}

/// A square of `size` by `size` cells in the plane, its inner vertices shaken.
fn shaken_square(size: u32) -> TriangleMesh {
    let mut random = 1_u32;
    let mut shake = |at: u32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let off = f64::from(random >> 16) / 65_536.0 - 0.5;
        f64::from(at) + if at.is_multiple_of(size) { 0.0 } else { 0.8 * off }
    };
    let positions = (0..(size + 1) * (size + 1)).map(|node| {
        let [x, y] = [node % (size + 1), node / (size + 1)].map(&mut shake);
        Point::new(x, y, 0.0)
    });
    let cells = (0..size * size).map(|cell| cell / size * (size + 1) + cell % size);
    let triangles =
        cells.flat_map(|node| [[node, node + 1, node + size + 2], [node, node + size + 2, node + size + 1]]);
    TriangleMesh { positions: positions.collect(), triangles: triangles.collect() }
}

#[test]
fn places_cover_a_flat_mesh_once() {
    let mesh = shaken_square(40);
    let target = Target { vertices: 40, error: NO_LIMIT };
    assert!(base_mesh(&mesh, &Constraints::default(), target).unwrap().history.is_none());
    let recorded = Constraints { recorded: true, ..Constraints::default() };
    let BaseMesh { mesh: base, history, .. } = base_mesh(&mesh, &recorded, target).unwrap();
    assert!(base.positions.len() < 200, "{}", base.positions.len());
    let levels = 4;
    let mut finest = SubdivisionSurface::from(base.clone());
    finest.positions = history.unwrap().places(&mesh, &base, levels);
    finest.levels = levels;
    let finest = finest.level(levels);
    let (mut whole, mut over) = (0.0, 0);
    for [a, b, c] in &finest.triangulated().triangles {
        let [a, b, c] = [a, b, c].map(|&corner| finest.positions[corner as usize]);
        let area = (b - a).cross(c - a).z;
        whole += area / 2.0;
        over += usize::from(area < 0.0);
    }
    // The boundary may cut the corners of the square a little, and what spans a corner of a triangle may turn over.
    println!("{whole} {over} of {}", 2 * finest.faces().len());
    assert!((whole - 1600.0).abs() < 8.0, "{whole}");
    assert!(over * 100 < finest.faces().len(), "{over} of {}", finest.faces().len());
}
