//! Whole surfaces, wrapped around functions whose zeros are known.

use super::border::Border;
use super::*;
use crate::field::Grid;
use crate::mesh::{Faces, Point};
use crate::subdivision::Split;

/// Cubes of `cube` cells each in the box of a field, those with their centre inside taken as one body, whose surface is the
/// base mesh. Cubes are added where that surface would not be a manifold.
pub(super) fn cubes(field: &ScalarField, cube: usize) -> PolygonMesh {
    let grid = field.grid();
    let counts = grid.extent.map(|nodes| (nodes - 1) / cube);
    let spot = |cell: [usize; 3], half: f64| {
        let local = cell.map(|index| (index as f64 + half) * cube as f64);
        grid.origin + grid.spacing * Point::from_array(local)
    };
    let mut body = Body { counts, inside: Vec::new() };
    let cells: Vec<[usize; 3]> = body.cells(counts).collect();
    body.inside = cells.iter().map(|&cell| field.sample_clamped(spot(cell, 0.5)) < 0.0).collect();
    while body.fill_once() {}
    let corners = counts.map(|count| count + 1);
    let number = |[i, j, k]: [usize; 3]| (k * corners[1] + j) * corners[0] + i;
    let quads: Vec<[usize; 4]> = body.sides().map(|quad| quad.map(number)).collect();
    let mut numbers = vec![None; corners.iter().product()];
    let all: Vec<[usize; 3]> = body.cells(corners).collect();
    let (mut positions, mut faces) = (Vec::new(), Faces::default());
    for quad in quads {
        let quad = quad.map(|corner| {
            *numbers[corner].get_or_insert_with(|| {
                positions.push(spot(all[corner], 0.0));
                positions.len() as u32 - 1
            })
        });
        faces.push(&quad);
    }
    PolygonMesh::new(positions, faces)
}

struct Body {
    counts: [usize; 3],
    inside: Vec<bool>,
}

impl Body {
    fn cells(&self, [width, height, depth]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
        (0..depth).flat_map(move |k| (0..height).flat_map(move |j| (0..width).map(move |i| [i, j, k])))
    }

    fn place(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// Adds cubes around one corner after the other, where those inside or those outside do not hang together by their
    /// faces; whether any was added.
    fn fill_once(&mut self) -> bool {
        let mut filled = false;
        for corner in self.cells(self.counts.map(|count| count + 1)) {
            let around: Vec<[usize; 3]> = (0..8_usize)
                .map(|bits| [0, 1, 2].map(|axis| (corner[axis] + (bits >> axis & 1)).wrapping_sub(1)))
                .filter(|cell| (0..3).all(|axis| cell[axis] < self.counts[axis]))
                .collect();
            for inside in [true, false] {
                let alike: Vec<_> =
                    around.iter().copied().filter(|&cell| self.inside[self.place(cell)] == inside).collect();
                if !hang_together(&alike) {
                    around.iter().for_each(|&cell| {
                        let place = self.place(cell);
                        self.inside[place] = true;
                    });
                    filled = true;
                }
            }
        }
        filled
    }

    /// Quads between cubes inside and outside, as corners of cubes, counter-clockwise seen from outside.
    fn sides(&self) -> impl Iterator<Item = [[usize; 3]; 4]> {
        let beside = |cell: [usize; 3], axis: usize| {
            let mut next = cell;
            next[axis] += 1;
            (next[axis] < self.counts[axis]).then_some(next)
        };
        let axes = move |cell| (0..3).filter_map(move |axis| Some((cell, axis, beside(cell, axis)?)));
        self.cells(self.counts).flat_map(axes).filter_map(move |(cell, axis, next)| {
            let [here, there] = [cell, next].map(|cell| self.inside[self.place(cell)]);
            let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |a: usize, b: usize| {
                let mut corner = next;
                corner[one] += a;
                corner[other] += b;
                corner
            };
            let mut quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if there {
                quad.reverse();
            }
            (here != there).then_some(quad)
        })
    }
}

/// Whether cubes are connected by their faces.
fn hang_together(cells: &[[usize; 3]]) -> bool {
    let beside =
        |a: &[usize; 3], b: &[usize; 3]| (0..3).map(|axis| a[axis].abs_diff(b[axis])).sum::<usize>() == 1;
    let mut met: Vec<[usize; 3]> = cells.first().copied().into_iter().collect();
    let mut next = 0;
    while next < met.len() {
        let here = met[next];
        met.extend(
            cells
                .iter()
                .filter(|cell| beside(cell, &here) && !met.contains(cell))
                .copied()
                .collect::<Vec<_>>(),
        );
        next += 1;
    }
    met.len() == cells.len()
}

fn sphere(extent: usize, radius: f64) -> ScalarField {
    let middle = Point::splat((extent - 1) as f64 / 2.0);
    ScalarField::from_function(Grid::unit([extent; 3]), |point| point.distance(middle) - radius)
}

#[test]
fn cubes_make_a_manifold() {
    let mesh = cubes(&sphere(33, 11.0), 8);
    let split = Split::new(mesh.positions.len(), mesh.faces());
    assert_eq!(mesh.positions.len() + mesh.faces().len(), split.edges.len() + 2);
}

/// The finest level of what was wrapped with few options other than usual.
fn wrapped(field: &ScalarField, cube: usize, levels: u32) -> Wrapped {
    wrap(&cubes(field, cube), field, &WrapOptions { levels, ..WrapOptions::default() }).unwrap()
}

/// That all vertices are on the surface, the faces near it, and none inverted.
fn assert_fits(wrapped: &Wrapped, most_at_faces: f64) {
    let report = &wrapped.report;
    let last = report.levels.last().unwrap();
    assert!(last.at_vertices.most < 1e-3 && last.at_faces.most < most_at_faces, "{last:?}");
    assert_eq!((last.unsnapped, report.inverted), (0, Inverted::default()));
    assert!(report.failures.is_empty(), "{:?}", report.failures);
    assert!(wrapped.surface.positions.iter().all(|place| place.is_finite()));
}

#[test]
fn a_sphere_is_wrapped() {
    let wrapped = wrapped(&sphere(33, 11.0), 8, 3);
    assert_fits(&wrapped, 0.05);
    assert_eq!((wrapped.surface.levels, wrapped.report.components), (3, 1));
    let distances: Vec<f64> = wrapped.report.levels.iter().map(|level| level.at_faces.rms).collect();
    assert!(distances.is_sorted_by(|coarse, fine| 3.0 * fine < *coarse), "{distances:?}");
}

#[test]
fn a_torus_keeps_its_hole() {
    let grid = Grid::unit([65, 65, 33]);
    let field = ScalarField::from_function(grid, |point| {
        let from_axis = Point::new(point.x - 32.0, point.y - 32.0, 0.0).length();
        (from_axis - 20.0).hypot(point.z - 16.0) - 8.0
    });
    let wrapped = wrapped(&field, 8, 3);
    assert_fits(&wrapped, 0.15);
    let mesh = wrapped.surface.level(3);
    let split = Split::new(mesh.positions.len(), mesh.faces());
    assert_eq!(mesh.positions.len() + mesh.faces().len(), split.edges.len());
}

#[test]
fn near_spheres_do_not_mix() {
    let middles = [Point::new(12.0, 16.0, 16.0), Point::new(31.5, 16.0, 16.0)];
    let field = ScalarField::from_function(Grid::unit([45, 33, 33]), |point| {
        middles.map(|middle| point.distance(middle) - 9.0).into_iter().fold(f64::INFINITY, f64::min)
    });
    let wrapped = wrapped(&field, 4, 3);
    assert_fits(&wrapped, 0.15);
    assert_eq!(wrapped.report.components, 2);
    let radii =
        wrapped.surface.positions.iter().map(|place| place.distance(middles[usize::from(place.x > 21.75)]));
    assert!(radii.into_iter().all(|radius| (radius - 9.0).abs() < 0.05));
}

/// A triply periodic surface that runs into all sides of the box.
fn gyroid() -> ScalarField {
    let scale = std::f64::consts::TAU / 32.0;
    ScalarField::from_function(Grid::unit([49, 41, 33]), |point| {
        let ([sx, sy, sz], [cx, cy, cz]) =
            [f64::sin, f64::cos].map(|f| (point * scale).to_array().map(f)).into();
        let slope = Point::new(cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz).length();
        (sx * cy + sy * cz + sz * cx) / (scale * slope.max(0.3))
    })
}

#[test]
fn boundaries_stay_on_the_sides_of_the_box() {
    let field = gyroid();
    let wrapped = wrapped(&field, 4, 2);
    let last = wrapped.report.levels.last().unwrap();
    assert!(last.at_vertices.rms < 0.01 && last.at_faces.rms < 0.1, "{last:?}");
    assert_eq!(wrapped.report.inverted, Inverted::default());
    let mesh = wrapped.surface.level(2);
    let split = Split::new(mesh.positions.len(), mesh.faces());
    let border = Border::new([Point::ZERO, Point::new(48.0, 40.0, 32.0)], 0.0);
    let mut ends = 0;
    for (edge, faces) in split.edges.iter().zip(&split.edge_faces) {
        if faces[1].is_none() {
            let [from, to] = edge.map(|end| mesh.positions[end as usize]);
            let shared = border.sides(from).between(border.sides(to));
            assert!(border.sides(from).count() > 0 && shared.count() == 1, "{from} {to}");
            assert!(field.sample_clamped(from).abs() < 0.05, "{from}");
            ends += 1;
        }
    }
    assert!(ends > 500, "{ends}");
    assert!(mesh.positions.iter().all(|&place| border.excess(place) == 0.0));
}

#[test]
fn threads_do_not_matter() {
    let field = gyroid();
    let base = cubes(&field, 8);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| wrap(&base, &field, &WrapOptions::default()).unwrap().surface)
    };
    assert_eq!(with(1), with(5));
}

#[test]
fn the_finest_vertices_go_to_the_target() {
    let distance = sphere(33, 11.0);
    // The same surface but for half a cell, as an isosurface and as triangles.
    let squares =
        ScalarField::from_function(*distance.grid(), |point| -point.distance_squared(Point::splat(16.0)));
    let triangles = crate::isosurface::contour(&squares, -11.5 * 11.5).unwrap();
    let tree = crate::measure::Bvh::new(&triangles);
    for target in [Target::Isosurface(&squares, -11.5 * 11.5), Target::Triangles(&tree)] {
        let options = WrapOptions { target, ..WrapOptions::default() };
        let wrapped = wrap(&cubes(&distance, 8), &distance, &options).unwrap();
        let radii = wrapped.surface.positions.iter().map(|place| place.distance(Point::splat(16.0)));
        let worst = radii.map(|radius| (radius - 11.5).abs()).fold(0.0, f64::max);
        // Squares between nodes are up to 0.75 off.
        assert!(worst < 0.04, "{worst}");
        assert!(wrapped.report.failures.is_empty() && wrapped.report.inverted == Inverted::default());
    }
}

#[test]
fn sharp_edges_go_to_their_lines() {
    let (middle, half) = (Point::splat(16.0), Point::new(10.0, 8.0, 9.0));
    let field = ScalarField::from_function(Grid::unit([33; 3]), |point| {
        let beyond = (point - middle).abs() - half;
        beyond.max(Point::ZERO).length() + beyond.max_element().min(0.0)
    });
    let corner = |index: u32| {
        let side = [0, 1, 2].map(|axis| f64::from(index >> axis & 1) * 2.0 - 1.0);
        middle + half * Point::from_array(side)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Faces = quads.iter().map(<[u32; 4]>::as_slice).collect();
    let mut edges = Split::new(8, &faces).edges;
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    let lines = Lines::new(edges.iter().map(|edge| edge.map(corner)).collect());
    let mut base = PolygonMesh::new((0..8).map(corner).collect(), faces);
    base.features = crate::mesh::Features { edges, vertices: (0..8).collect() };
    let options = WrapOptions { lines: Some(&lines), ..WrapOptions::default() };
    let wrapped = wrap(&base, &field, &options).unwrap();
    let mesh = wrapped.surface.level(3);
    assert_eq!(mesh.positions[..8], base.positions);
    assert_eq!(mesh.features.edges.len(), 12 * 8);
    for end in mesh.features.edges.iter().flatten() {
        let beyond = ((mesh.positions[*end as usize] - middle).abs() - half).abs().to_array();
        assert!(beyond.iter().filter(|&&off| off < 1e-9).count() >= 2, "{beyond:?}");
    }
    assert_fits(&wrapped, 0.05);
}

#[test]
fn levels_end_at_the_tolerance() {
    let field = sphere(33, 11.0);
    let options = WrapOptions { levels: 9, tolerance: 0.1, ..WrapOptions::default() };
    let wrapped = wrap(&cubes(&field, 8), &field, &options).unwrap();
    let [before, last] = wrapped.report.levels[wrapped.report.levels.len() - 2..] else { unreachable!() };
    assert!(before.at_faces.rms > 0.1 && last.at_faces.rms <= 0.1);
    assert_eq!(last.level, wrapped.surface.levels);
}

/// Waves in all directions, over the length of their gradient.
fn waves(extent: usize, length: f64) -> ScalarField {
    let scale = std::f64::consts::TAU / length;
    let wave = |point: Point| {
        let terms = (0..24_u32).map(|term| {
            let angle = |salt: u32| f64::from((term * 7 + salt).wrapping_mul(2_654_435_761) >> 8) * 1e-3;
            let direction = Point::new(angle(1).cos(), angle(2).cos(), angle(3).cos()) * scale;
            (direction.dot(point) + angle(4)).sin()
        });
        terms.sum::<f64>()
    };
    ScalarField::from_function(Grid::unit([extent; 3]), |point| {
        let slope = |axis: Point| (wave(point + axis * 0.01) - wave(point - axis * 0.01)) / 0.02;
        let gradient = Point::new(slope(Point::X), slope(Point::Y), slope(Point::Z));
        (wave(point) / gradient.length().max(1e-9)).clamp(-4.0, 4.0)
    })
}

/// The cubes leave out and join what is finer than they are, so that some of the mesh has no surface to go to.
#[test]
fn what_does_not_fit_is_told() {
    let field = waves(49, 40.0);
    let wrapped = wrapped(&field, 4, 2);
    let (report, last) = (&wrapped.report, wrapped.report.levels.last().unwrap());
    assert!(last.unsnapped > 0 && last.unsnapped < last.vertices / 20, "{last:?}");
    assert!(last.inverted_before.corners > 10 * last.inverted.corners, "{last:?}");
    assert!(
        report.failures.iter().any(|failure| failure.cause == Cause::OutOfReach),
        "{:?}",
        report.failures
    );
    let unfit: usize = report.failures.iter().map(|failure| failure.unfit).sum();
    assert!(unfit > 0 && unfit <= last.unsnapped, "{unfit} {last:?}");
}

#[test]
fn a_mesh_without_surface_nearby_stays() {
    let field = sphere(65, 11.0);
    let far = cubes(&sphere(33, 4.0), 4);
    let moved = far.positions.iter().map(|place| *place - Point::splat(10.0)).collect();
    let wrapped =
        wrap(&PolygonMesh::new(moved, far.faces().clone()), &field, &WrapOptions::default()).unwrap();
    assert_eq!(wrapped.report.failures[0].cause, Cause::NoSurface);
    assert_eq!(wrapped.report.failures[0].unfit, wrapped.surface.positions.len());
}

#[test]
fn bad_fields_and_options_are_refused() {
    let field = sphere(17, 5.0);
    let base = cubes(&field, 4);
    let refused = |field: &ScalarField| wrap(&base, field, &WrapOptions::default()).map(|_| ()).unwrap_err();
    let mut values = field.values().to_vec();
    values[7] = f32::NAN;
    assert_eq!(refused(&ScalarField::new(*field.grid(), values)), WrapError::FieldNotFinite { index: 7 });
    let outside = ScalarField::from_function(*field.grid(), |_| 3.0);
    assert_eq!(refused(&outside), WrapError::NoZero);
    let slice = ScalarField::from_function(Grid::unit([17, 1, 17]), |point| point.x - 3.0);
    assert_eq!(refused(&slice), WrapError::FieldTooThin { axis: 1, nodes: 1 });
    let with = |change: fn(&mut WrapOptions)| {
        let mut options = WrapOptions::default();
        change(&mut options);
        wrap(&base, &field, &options).map(|_| ()).unwrap_err()
    };
    let named = |error| matches!(error, WrapError::Option { .. });
    assert!(named(with(|options| options.relaxation = 1.5)));
    assert!(named(with(|options| options.reach = f64::NAN)));
    assert!(named(with(|options| options.tolerance = -1.0)));
    assert!(matches!(with(|options| options.levels = u32::MAX), WrapError::TooManyVertices { .. }));
    let other = WrapOptions { target: Target::Isosurface(&slice, 0.0), ..WrapOptions::default() };
    assert_eq!(wrap(&base, &field, &other).map(|_| ()).unwrap_err(), WrapError::OtherGrid);
}

#[test]
fn bad_base_meshes_are_refused() {
    let field = sphere(17, 5.0);
    let base = cubes(&field, 4);
    let refused = |positions: &[Point], faces: &[&[u32]]| {
        let mesh = PolygonMesh::new(positions.to_vec(), faces.iter().copied().collect());
        wrap(&mesh, &field, &WrapOptions::default()).map(|_| ()).unwrap_err()
    };
    let mut positions = base.positions.clone();
    assert_eq!(refused(&positions, &[]), WrapError::Empty);
    assert_eq!(refused(&positions, &[&[0, 1, 2], &[3, 4, 3]]), WrapError::RepeatedCorner { face: 1 });
    assert_eq!(refused(&positions[..5], &[&[0, 1, 2], &[0, 3, 4]]), WrapError::NotManifold { vertex: 0 });
    assert_eq!(refused(&positions[..4], &[&[0, 1, 2]]), WrapError::LooseVertex { vertex: 3 });
    positions[2].x = f64::INFINITY;
    assert_eq!(refused(&positions, &[&[0, 1, 2]]), WrapError::VertexNotFinite { vertex: 2 });
    positions[2].x = 30.0;
    assert_eq!(refused(&positions, &[&[0, 1, 2]]), WrapError::OutsideField { vertex: 2, distance: 14.0 });
}
