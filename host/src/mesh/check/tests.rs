use super::*;
use crate::collection::collection;
use crate::measure::Bvh;
use crate::mesh::{TriangleMesh, read, self_intersections};

fn mesh(corners: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriangleMesh {
    let positions = corners.iter().map(|&corner| Point::from_array(corner)).collect();
    TriangleMesh { positions, triangles: triangles.to_vec() }
}

const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

#[test]
fn a_tetrahedron_is_a_sphere() {
    let report = Report::of(&mesh(&CORNERS, &TETRAHEDRON));
    assert_eq!((report.vertices, report.edges, report.faces), (4, 6, 4));
    assert!(report.is_closed() && report.genus() == Some(0) && report.components.len() == 1);
    assert!((report.volume() - 1.0 / 6.0).abs() < 1e-15);
    assert_eq!(report.to_string(), "4 vertices, 6 edges, 4 faces; components 1, genus 0, boundary loops 0");
    let inward = Report::of(&mesh(&CORNERS, &TETRAHEDRON.map(|[a, b, c]| [a, c, b])));
    assert!(
        inward.components[0].is_inward() && inward.to_string().ends_with("1 components that look inwards")
    );
}

#[test]
fn faults_are_counted() {
    let open = Report::of(&mesh(&CORNERS, &TETRAHEDRON[..3]));
    assert_eq!((open.boundary_edges, open.boundary_loops(), open.genus()), (3, 1, Some(0)));
    let turned = Report::of(&mesh(&CORNERS, &[[0, 1, 2], TETRAHEDRON[1], TETRAHEDRON[2], TETRAHEDRON[3]]));
    assert_eq!((turned.inconsistent_edges, turned.genus(), turned.folded_edges), (3, None, 0));
    let twice = Report::of(&mesh(&CORNERS, &[&TETRAHEDRON[..], &[[2, 1, 0]]].concat()));
    assert_eq!((twice.nonmanifold_edges, twice.duplicate_faces, twice.is_manifold()), (3, 1, false));
    let corners = [&CORNERS[..], &[[0.0; 3], [2.0, 0.0, 0.0]]].concat();
    let thin = Report::of(&mesh(&corners, &[[0, 1, 5], [0, 0, 2]]));
    assert_eq!((thin.degenerate_faces, thin.isolated_vertices, thin.repeated_positions), (2, 2, 1));
    let folded = Report::of(&mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, 1.0, 0.1]],
        &[[0, 1, 2], [1, 0, 3]],
    ));
    assert_eq!(folded.folded_edges, 1);
    assert_eq!(Report::of(&TriangleMesh::default()), Report::default());
}

#[test]
fn parts_that_touch_in_a_vertex_are_two() {
    let corners = [&CORNERS[..], &[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]].concat();
    let mirrored =
        TETRAHEDRON.map(|triangle| triangle.map(|corner| if corner == 0 { 0 } else { corner + 3 }));
    let mirrored = mirrored.map(|[a, b, c]| [a, c, b]);
    let report = Report::of(&mesh(&corners, &[TETRAHEDRON, mirrored].concat()));
    assert_eq!((report.components.len(), report.nonmanifold_vertices, report.vertices), (2, 1, 7));
    assert_eq!(report.components[0], report.components[1]);
    assert_eq!(report.genus(), Some(0));
}

#[test]
fn a_ring_of_quads_has_a_handle_and_a_strip_two_loops() {
    let quads: Vec<[u32; 4]> = (0..16)
        .map(|quad| {
            let (i, j) = (quad / 4, quad % 4);
            let at = |i: u32, j: u32| i % 4 * 4 + j % 4;
            [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        })
        .collect();
    let points: Vec<Point> = (0..16)
        .map(|vertex| {
            let [u, v] = [vertex / 4, vertex % 4].map(|step| f64::from(step) * std::f64::consts::FRAC_PI_2);
            Point::new((2.0 + v.cos()) * u.cos(), (2.0 + v.cos()) * u.sin(), v.sin())
        })
        .collect();
    let of = |quads: &[[u32; 4]]| {
        let faces = quads.iter().map(<[u32; 4]>::as_slice).collect();
        Report::of(&crate::mesh::PolygonMesh::new(points.clone(), faces))
    };
    let ring = of(&quads);
    assert_eq!((ring.genus(), ring.is_closed(), ring.components[0].euler()), (Some(1), true, 0));
    assert!(ring.volume() > 0.0);
    let strip: Vec<[u32; 4]> =
        quads.iter().enumerate().filter(|(quad, _)| quad % 4 == 0).map(|(_, quad)| *quad).collect();
    let strip = of(&strip);
    assert_eq!((strip.genus(), strip.boundary_loops(), strip.isolated_vertices), (Some(0), 2, 8));
}

/// The number before a word, or after it.
fn number(text: &str, word: &str, after: bool) -> usize {
    let words: Vec<&str> = text.split_whitespace().collect();
    let place = words.iter().position(|found| *found == word).expect(word);
    words[if after { place + 1 } else { place - 1 }].parse().expect(word)
}

#[test]
fn meshes_of_the_collection_are_what_its_manifest_says() {
    let Ok(manifest) = std::fs::read_to_string(collection().join("MANIFEST.tsv")) else {
        println!("skipped: no collection of meshes beside the repository, and WAVELIFT_DATA names none");
        return;
    };
    for line in manifest.lines().filter(|line| line.contains("\tmeshes/")) {
        let fields: Vec<&str> = line.split('\t').collect();
        let facts = &line[line.find("; V ").expect("facts")..];
        let mesh = read(&collection().join(fields[1])).unwrap_or_else(|error| panic!("{error}"));
        let report = Report::of(&mesh);
        let pairs = self_intersections(&mesh, &Bvh::new(&mesh), 1000).len();
        println!("{}: {report}; {pairs} pairs of triangles that meet", fields[0]);
        assert_eq!(mesh.positions.len(), number(facts, "V", true));
        assert_eq!(report.faces, number(facts, "F", true));
        assert_eq!(report.components.len(), number(facts, "components", true));
        assert_eq!(report.genus(), Some(number(facts, "genus", true) as u64));
        assert_eq!(report.boundary_loops(), number(facts, "loops", false));
        assert_eq!(report.volume() < 0.0, line.contains("wound inwards"), "{}", fields[0]);
        assert!(report.is_manifold() && report.inconsistent_edges == 0 && report.degenerate_faces == 0);
    }
}
