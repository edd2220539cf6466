//! The facts that hold for every basis, and those of the bicubic one.

use std::num::NonZeroI32;

use proptest::prelude::*;
use wavelift_kernel::stencil::{Adjacency, I16F16, Neighbours};

use super::*;
use crate::mesh::{Faces, Features, Point};
use crate::subdivision::{Hierarchy, Split, Step, VertexRule};

/// Numbers without a pattern.
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    ((*seed >> 33) as f64) / f64::from(1_u32 << 31) - 0.5
}

fn points(count: usize) -> Vec<Point> {
    let mut seed = 5;
    (0..count).map(|_| Point::new(noise(&mut seed), noise(&mut seed), noise(&mut seed))).collect()
}

fn coordinates(count: usize, range: f64) -> Vec<[i32; 3]> {
    points(count).iter().map(|point| point.to_array().map(|value| (2.0 * range * value) as i32)).collect()
}

/// A prism over a polygon of so many sides, its lids split to a fan of triangles: valences 3, 4, `sides` and faces of 3
/// and 4 sides; a lid is missing where it is said to be open.
fn prism(sides: u32, open: bool) -> (usize, Faces) {
    let mut faces = Faces::default();
    for side in 0..sides {
        let next = (side + 1) % sides;
        faces.push(&[side, next, sides + next, sides + side]);
        faces.push(&[sides + side, sides + next, 2 * sides]);
    }
    if open {
        return (2 * sides as usize + 1, faces);
    }
    faces.push(&(0..sides).rev().collect::<Vec<_>>());
    (2 * sides as usize + 1, faces)
}

/// Hierarchies with every rule: smooth of valence 3 to 7, open, creased, with sharp vertices and a crease that ends.
fn hierarchies() -> Vec<Hierarchy> {
    let mut all = Vec::new();
    for sides in 3..8 {
        let features = Features {
            edges: (0..sides)
                .map(|side| [side.min((side + 1) % sides), side.max((side + 1) % sides)])
                .collect(),
            vertices: vec![0, 2 * sides],
        };
        let dart = Features { edges: vec![[sides, 2 * sides]], vertices: vec![] };
        for (open, features) in
            [(false, Features::default()), (true, features.clone()), (false, features), (false, dart)]
        {
            let (vertices, faces) = prism(sides, open);
            all.push(Hierarchy::new(vertices, &faces, &features, 3));
        }
    }
    all
}

fn largest_difference(one: &[Point], other: &[Point]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (*one - *other).length()).fold(0.0, f64::max)
}

#[test]
fn the_inverse_restores_the_input() {
    for basis in Basis::ALL {
        for hierarchy in hierarchies() {
            let original = points(hierarchy.finest_vertices());
            let mut changed = original.clone();
            forward(basis, &hierarchy, &mut changed);
            assert!(largest_difference(&original, &changed) > 0.1);
            inverse(basis, &hierarchy, &mut changed);
            assert!(largest_difference(&original, &changed) < 1e-11);
        }
    }
}

#[test]
fn a_level_is_what_further_steps_start_from() {
    for hierarchy in hierarchies() {
        let coefficients = points(hierarchy.finest_vertices());
        let count = hierarchy.vertices(2);
        let mut level = coefficients[..count].to_vec();
        inverse_to_level(Basis::Bicubic, &hierarchy, 2, &mut level);
        let mut finest = coefficients.clone();
        finest[count..].fill(Point::ZERO);
        inverse(Basis::Bicubic, &hierarchy, &mut finest);
        forward_step(Basis::Bicubic, &hierarchy.steps()[2], &mut finest);
        assert!(largest_difference(&level, &finest[..count]) < 1e-12);
    }
}

/// Fitting what subdivision made gives it back, and no details; what expansion made is fitted by nothing.
#[test]
fn fs_and_ce_are_identities_and_fe_and_cs_are_zero() {
    for basis in Basis::ALL {
        for hierarchy in hierarchies() {
            for step in hierarchy.steps() {
                let (old, all) = (step.split.coarser_vertices(), step.split.finer_vertices());
                for kept in [0..old, old..all] {
                    let mut given = vec![Point::ZERO; all];
                    given[kept.clone()].copy_from_slice(&points(all)[kept]);
                    let mut result = given.clone();
                    inverse_step(basis, step, &mut result);
                    forward_step(basis, step, &mut result);
                    assert!(largest_difference(&given, &result) < 1e-12);
                }
            }
        }
    }
}

/// A constant is a point everywhere: weights of points sum to 1 and those of details to 0, at any valence and feature.
#[test]
fn weights_of_stencils_sum_to_one_or_zero() {
    for basis in Basis::ALL {
        for hierarchy in hierarchies() {
            let mut constant = vec![Point::ONE; hierarchy.finest_vertices()];
            forward(basis, &hierarchy, &mut constant);
            let base = hierarchy.vertices(0);
            assert!(largest_difference(&constant[..base], &vec![Point::ONE; base]) < 1e-12, "{basis:?}");
            assert!(constant[base..].iter().all(|detail| detail.length() < 1e-12), "{basis:?}");
            // A detail moves no sum: the other way round, its function is made of weights for details alone.
            inverse(basis, &hierarchy, &mut constant);
            assert!(constant.iter().all(|point| (*point - Point::ONE).length() < 1e-12));
        }
    }
}

/// A square of `side` by `side` quads, split once; its points are functions of their place.
fn square(side: u32) -> (Step, Vec<[f64; 2]>) {
    let mut faces = Faces::default();
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        let corner = row * (side + 1) + column;
        faces.push(&[corner, corner + 1, corner + side + 2, corner + side + 1]);
    }
    let vertices = (side as usize + 1).pow(2);
    let hierarchy = Hierarchy::new(vertices, &faces, &Features::default(), 1);
    let step = hierarchy.steps()[0].clone();
    let mut places: Vec<[f64; 2]> =
        (0..vertices).map(|i| [i % (side as usize + 1), i / (side as usize + 1)].map(|x| x as f64)).collect();
    let mean = |places: &[[f64; 2]]| {
        [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64)
    };
    let edges: Vec<_> =
        step.split.edges.iter().map(|ends| mean(&ends.map(|end| places[end as usize]))).collect();
    let middles: Vec<_> = faces
        .iter()
        .map(|face| mean(&face.iter().map(|&corner| places[corner as usize]).collect::<Vec<_>>()))
        .collect();
    places.extend(edges);
    places.extend(middles);
    (step, places)
}

fn inside([x, y]: [f64; 2], side: f64, margin: f64) -> bool {
    x >= margin && y >= margin && x <= side - margin && y <= side - margin
}

/// On a grid S is the tensor product of the subdivision (1 6 1)/8, (4 4)/8.
#[test]
fn on_a_grid_subdivision_is_that_of_bicubic_splines() {
    let (step, places) = square(6);
    let old = step.split.coarser_vertices();
    let mut fine = points(places.len());
    fine[old..].fill(Point::ZERO);
    let coarse = fine[..old].to_vec();
    inverse_step(Basis::Bicubic, &step, &mut fine);
    let weights = |x: f64| -> Vec<(usize, f64)> {
        let low = x.floor() as usize;
        if x.fract() == 0.0 {
            vec![(low - 1, 0.125), (low, 0.75), (low + 1, 0.125)]
        } else {
            vec![(low, 0.5), (low + 1, 0.5)]
        }
    };
    let mut checked = 0;
    for (place, fine) in places.iter().zip(&fine).filter(|(place, _)| inside(**place, 6.0, 1.0)) {
        let mut expected = Point::ZERO;
        for (column, wide) in weights(place[0]) {
            for (row, high) in weights(place[1]) {
                expected += coarse[row * 7 + column] * (wide * high);
            }
        }
        assert!((*fine - expected).length() < 1e-13);
        checked += 1;
    }
    assert_eq!(checked, 81);
}

/// Control points that are values of a polynomial of a degree in x and in y stay so; the bicubic basis takes no details
/// for degree 3, the bilinear one for degree 1, the biquintic one for degree 5.
#[test]
fn polynomials_have_no_details() {
    for (basis, degree) in [(Basis::Bilinear, 1), (Basis::Bicubic, 3), (Basis::Biquintic, 5)] {
        let (step, places) = square(10);
        let value = |[x, y]: [f64; 2]| {
            let power = |x: f64, n| (x / 10.0 - 0.3).powi(n);
            Point::new(
                power(x, degree) * power(y, degree),
                power(x, degree) + power(y, 1),
                power(x, 1) * power(y, degree),
            )
        };
        let mut fine: Vec<Point> = places.iter().map(|&place| value(place)).collect();
        forward_step(basis, &step, &mut fine);
        let old = step.split.coarser_vertices();
        let details = places.iter().zip(&fine).skip(old).filter(|(place, _)| inside(**place, 10.0, 3.0));
        assert!(details.clone().count() > 40);
        details.for_each(|(_, detail)| assert!(detail.length() < 1e-12, "{basis:?} {detail}"));
    }
}

/// A crease is transformed as a curve of its own: what lies beside it does not matter.
#[test]
fn creases_and_sharp_vertices_do_not_move_with_what_is_beside_them() {
    for basis in Basis::ALL {
        for hierarchy in hierarchies() {
            let step = &hierarchy.steps()[0];
            let mut points = points(step.split.finer_vertices());
            let mut others = points.clone();
            let on_feature = |vertex: usize| {
                let edge = vertex.checked_sub(step.split.coarser_vertices());
                match edge.map(|edge| step.rules.edges.get(edge)) {
                    None => step.rules.vertices[vertex] != VertexRule::Smooth,
                    Some(rule) => rule == Some(&crate::subdivision::EdgeRule::Sharp),
                }
            };
            for (vertex, point) in others.iter_mut().enumerate() {
                if !on_feature(vertex) {
                    *point += Point::splat(0.25);
                }
            }
            inverse_step(basis, step, &mut points);
            inverse_step(basis, step, &mut others);
            for vertex in 0..points.len() {
                if on_feature(vertex) {
                    assert_eq!(points[vertex], others[vertex]);
                }
            }
        }
    }
}

#[test]
fn kept_coefficients_are_the_largest() {
    let (vertices, faces) = prism(5, false);
    let hierarchy = Hierarchy::new(vertices, &faces, &Features::default(), 3);
    let count = hierarchy.finest_vertices();
    let mut original = points(count);
    for level in 0..3 {
        original[hierarchy.vertices(level)..].iter_mut().for_each(|detail| *detail *= 0.2);
    }
    inverse(Basis::Bicubic, &hierarchy, &mut original);
    let norms = Norms::new(Basis::Bicubic, 3);
    let mut last = f64::INFINITY;
    for kept in [vertices, count / 20, count / 5, count / 2, count] {
        let mut coefficients = original.clone();
        forward(Basis::Bicubic, &hierarchy, &mut coefficients);
        assert_eq!(keep_largest(&norms, &hierarchy, &mut coefficients, kept), kept);
        inverse(Basis::Bicubic, &hierarchy, &mut coefficients);
        let error: f64 =
            coefficients.iter().zip(&original).map(|(one, other)| (*one - *other).length_squared()).sum();
        assert!(error < last);
        last = error;
    }
    assert!(last < 1e-20);
}

#[test]
fn integers_are_restored() {
    for basis in Basis::ALL {
        for hierarchy in hierarchies() {
            for range in [100.0, 1e6, f64::from(i32::MAX)] {
                let original = coordinates(hierarchy.finest_vertices(), range);
                let mut changed = original.clone();
                lossless::forward(basis, &hierarchy, &mut changed);
                assert_ne!(original, changed);
                lossless::inverse(basis, &hierarchy, &mut changed);
                assert_eq!(original, changed);
            }
        }
    }
}

/// A constant large enough has details near zero beside features too, although units differ there.
#[test]
fn integer_units_agree_at_features() {
    for basis in Basis::ALL {
        for hierarchy in hierarchies() {
            let mut constant = vec![[1 << 24; 3]; hierarchy.finest_vertices()];
            lossless::forward(basis, &hierarchy, &mut constant);
            let details = &constant[hierarchy.vertices(0)..];
            let largest = details.iter().flatten().map(|detail| detail.abs()).max();
            // The w-lift by 4/3 makes errors of rounding 64/9 as large; a wrong unit would make millions.
            let bound = if basis == Basis::Biquintic { 16 } else { 2 };
            assert!(largest <= Some(bound), "{basis:?} {largest:?}");
        }
    }
}

/// Lists of neighbours as compressed rows.
struct Rows(Vec<u32>, Vec<u32>);

impl Rows {
    fn new(rows: impl Iterator<Item = Vec<u32>>) -> Self {
        let mut all = Self(vec![0], vec![]);
        for row in rows {
            all.1.extend(row);
            all.0.push(all.1.len() as u32);
        }
        all
    }

    fn over(&self, neighbours: usize) -> Adjacency<'_> {
        Adjacency::new(&self.0, &self.1, neighbours).unwrap()
    }
}

/// Applies lifts on a smooth closed mesh by the kernel, one coordinate at a time.
fn by_kernel(split: &Split, lifts: &[lossless::IntegerLift], points: &mut [[i32; 3]]) {
    let (old, edges) = (split.coarser_vertices(), split.edges.len());
    let faces = points.len() - old - edges;
    let of_vertex = |corner: usize, of: usize, first: u32| {
        Rows::new((0..old as u32).map(|vertex| {
            let at = split.quads.iter().filter(|quad| quad[corner] == vertex);
            at.map(|quad| quad[of] - first).collect()
        }))
    };
    let of_face = |of: usize, first: u32| {
        Rows::new((0..faces).map(|face| {
            let at = split.quads.iter().filter(|quad| quad[2] == split.face_vertex(face));
            at.map(|quad| quad[of] - first).collect()
        }))
    };
    let faces_of_old = of_vertex(0, 2, split.face_vertex(0));
    let edges_of_old = of_vertex(0, 1, split.edge_vertex(0));
    let faces_of_edges =
        Rows::new(split.edge_faces.iter().map(|faces| faces.iter().flatten().copied().collect()));
    let (old_of_faces, edges_of_faces) = (of_face(0, 0), of_face(1, split.edge_vertex(0)));
    let old_of_edges = Rows::new(split.edges.iter().map(|ends| ends.to_vec()));
    let s = Neighbours::new(faces_of_old.over(faces), edges_of_old.over(edges), faces_of_edges.over(faces))
        .unwrap();
    let w =
        Neighbours::new(old_of_faces.over(old), edges_of_faces.over(edges), old_of_edges.over(old)).unwrap();
    for axis in 0..3 {
        let mut values: Vec<i32> = points.iter().map(|point| point[axis]).collect();
        let (v, rest) = values.split_at_mut(old);
        let (e, f) = rest.split_at_mut(edges);
        for lift in lifts {
            let a = I16F16::from_num(lift.a.numerator as f64 / lift.a.denominator as f64);
            let one = NonZeroI32::new(1).unwrap();
            match lift.kind {
                Kind::S => s.lift(v, e, f, a, one).unwrap(),
                Kind::W => w.lift(f, e, v, a, one).unwrap(),
            }
        }
        points.iter_mut().zip(values).for_each(|(point, value)| point[axis] = value);
    }
}

/// The kernel's lifts, of 128 bits and any weights, are the oracle; its weights are of 16 binary places, so that the sixths
/// of the biquintic basis are not among them.
#[test]
fn smooth_integer_lifts_are_those_of_the_kernel() {
    for basis in [Basis::Bilinear, Basis::Bicubic] {
        for sides in 3..8 {
            let (vertices, faces) = prism(sides, false);
            let hierarchy = Hierarchy::new(vertices, &faces, &Features::default(), 2);
            let mut points = coordinates(hierarchy.finest_vertices(), 1e5);
            let mut expected = points.clone();
            lossless::forward(basis, &hierarchy, &mut points);
            for step in hierarchy.steps().iter().rev() {
                by_kernel(&step.split, lossless::lifts(basis), &mut expected[..step.split.finer_vertices()]);
            }
            assert_eq!(points, expected);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn any_integers_are_restored(seed: u64, basis in 0_usize..3, kind in 0_usize..4) {
        let hierarchy = &hierarchies()[kind];
        let mut seed = seed;
        let original: Vec<[i32; 3]> = (0..hierarchy.finest_vertices())
            .map(|_| std::array::from_fn(|_| (noise(&mut seed) * 2_f64.powi(33)) as i32))
            .collect();
        let mut changed = original.clone();
        lossless::forward(Basis::ALL[basis], hierarchy, &mut changed);
        lossless::inverse(Basis::ALL[basis], hierarchy, &mut changed);
        prop_assert_eq!(original, changed);
    }
}
