//! The references checked against themselves and against numbers worked out by hand.

use conformance::oracle::lifting::{Psi, forward, inverse, lift_line, max_levels};
use conformance::oracle::noise::Noise;
use conformance::oracle::stencil::{
    Neighbours, ONE, inverse_mesh_lift, inverse_s_lift, inverse_w_lift, mesh_lift, s_lift, w_lift,
};

/// The signal of the worked examples; each takes its first n samples.
const SIGNAL: [i32; 5] = [5, -2, 4, 9, -3];

/// One level of the first n = 1, 2, … samples of [`SIGNAL`], low half first.
fn assert_worked(psi: Psi, expected: [&[i32]; 5]) {
    for (n, expected) in (1..).zip(expected) {
        let mut line = SIGNAL[..n].to_vec();
        forward(psi, &mut line, [n, 1, 1], 1);
        assert_eq!(line, expected, "{psi:?}, n = {n}");
    }
}

#[test]
fn haar_by_hand() {
    assert_worked(
        Psi::H,
        [
            &[5],
            // d0 = 5 + 2 = 7; c0 = 5 - [3.5] = 5 - 4
            &[1, 7],
            // c1 = 4 has no d
            &[1, 4, 7],
            // d1 = 4 - 9 = -5; c1 = 4 - [-2.5] = 4 + 2
            &[1, 6, 7, -5],
            // c2 = -3 has no d
            &[1, 6, -3, 7, -5],
        ],
    );
}

#[test]
fn quadratic_by_hand() {
    assert_worked(
        Psi::Q,
        [
            &[5],
            // c0 = 5 - [-2/3] = 6; d0 = 2 + [(54 + 18) / 8 = 9] = 11; c0 = 6 - [44/9 = 4.9] = 1
            &[1, 11],
            // c1 = 4 - [-2/3] = 5; d0 = 2 + [(54 + 15) / 8 = 8.6] = 11; c0 = 6 - 5; c1 has no d
            &[1, 5, 11],
            // d1 = -9 + [(45 + 15) / 8 = 7.5] = -1; c1 = 5 - [-4/9] = 5
            &[1, 5, 11, -1],
            // c2 = -3 - [9/3] = -6; d1 = -9 + [(45 - 18) / 8 = 3.4] = -6; c1 = 5 - [-24/9 = -2.7] = 8
            &[1, 8, -6, 11, -6],
        ],
    );
}

#[test]
fn duchaineau_by_hand() {
    assert_worked(
        Psi::D,
        [
            &[5],
            // the first two steps are those of the quadratic; c0 = 6 - [132/27 = 4.9] = 1
            &[1, 11],
            // c1 = 5 - [(0 - 4 (0 - 11)) / 27 = 1.6] = 3
            &[1, 3, 11],
            // c0 = 6 - [(132 + 4) / 27 = 5.04] = 1; c1 = 5 - [(-12 + 44) / 27 = 1.2] = 4
            &[1, 4, 11, -1],
            // c0 = 6 - [(132 + 24) / 27 = 5.8] = 0; c1 = 5 - [(-72 + 44) / 27 = -1.04] = 6;
            // c2 = -6 - [(0 - 24) / 27 = -0.9] = -5
            &[0, 6, -5, 11, -6],
        ],
    );
}

#[test]
fn linear_by_hand() {
    assert_worked(
        Psi::One,
        [
            &[5],
            // d0 = -2 + [-10/2] = -7; c0 = 5 + [-14/4 = -3.5] = 5 - 3
            &[2, -7],
            // d0 = -2 + [-9/2 = -4.5] = -2 - 4; c0 = 5 + [-12/4]; c1 = 4 + [-12/4]
            &[2, 1, -6],
            // d1 = 9 + [-8/2] = 5; c1 = 4 + [(-6 + 5) / 4] = 4
            &[2, 4, -6, 5],
            // d1 = 9 + [-1/2] = 9; c1 = 4 + [3/4] = 5; c2 = -3 + [18/4 = 4.5] = 2
            &[2, 5, 2, -6, 9],
        ],
    );
}

#[test]
fn cubic_by_hand() {
    assert_worked(
        Psi::Three,
        [
            &[5],
            // c0 = 5 + [4/4] = 6; d0 = -2 - 12 = -14; c0 = 6 + [-84/16 = -5.3] = 1
            &[1, -14],
            // c1 = 4 + [4/4] = 5; d0 = -2 - 11 = -13; c0 = 6 + [-78/16 = -4.9] = 1; c1 = 5 - 5
            &[1, 0, -13],
            // c1 = 4 + [-7/4] = 2; d0 = -2 - 8; d1 = 9 - 4; c0 = 6 + [-60/16 = -3.8]; c1 = 2 + [-15/16]
            &[2, 1, -10, 5],
            // c2 = -3 + [-18/4 = -4.5] = -7; d1 = 9 - (2 - 7) = 14; c1 = 2 + [12/16] = 3;
            // c2 = -7 + [84/16 = 5.3] = -2
            &[2, 3, -2, -10, 14],
        ],
    );
}

#[test]
fn quintic_by_hand() {
    assert_worked(
        Psi::Five,
        [
            &[5],
            // d0 = -2 + [-10/6 = -1.7] = -4; c0 = 5 + [72/16 = 4.5] = 10; d0 = -4 + [-80/3 = -26.7] = -31;
            // c0 = 10 + [-310/32 = -9.7] = 0
            &[0, -31],
            // d0 = -2 + [-9/6 = -1.5] = -3; c0 = 5 + [54/16 = 3.4] = 8; c1 = 4 + 3 = 7;
            // d0 = -3 + [-60/3] = -23; c0 = 8 + [-230/32 = -7.2] = 1; c1 = 7 - 7
            &[1, 0, -23],
            // d1 = 9 + [-8/6 = -1.3] = 8; c1 = 4 + [-45/16 = -2.8] = 1; d0 = -3 + [-36/3] = -15;
            // d1 = 8 + [-8/3 = -2.7] = 5; c0 = 8 + [-150/32 = -4.7] = 3; c1 = 1 + [-50/32 = -1.6] = -1
            &[3, -1, -15, 5],
            // d1 = 9 + [-1/6] = 9; c1 = 4 + [-54/16 = -3.4] = 1; c2 = -3 + [-162/16 = -10.1] = -13;
            // d1 = 9 + [48/3] = 25; c1 = 1 + [50/32 = 1.6] = 3; c2 = -13 + [250/32 = 7.8] = -5
            &[3, 3, -5, -15, 25],
        ],
    );
}

#[test]
fn numerators_fold_to_32_bits_with_their_sign() {
    // -(-2^30 - 2^30) = 2^31 folds to -2^31, so d0 = -2^30; c0 = -2^30 + [-2^31 / 4]
    let mut line = [-1 << 30, 0];
    lift_line(Psi::One, &mut line);
    assert_eq!(line, [-(1 << 30) - (1 << 29), -1 << 30]);
    // d0 = 2^31 - 1 + 2^31 = 2^32 - 1 folds to -1; c0 = 2^31 - 1 - [-1/2] = 2^31 - 1
    let mut line = [i32::MAX, i32::MIN];
    lift_line(Psi::H, &mut line);
    assert_eq!(line, [i32::MAX, -1]);
}

#[test]
fn slices_and_levels_by_hand() {
    // x: (1, 5) -> d = -4, c = 1 - [-2] = 3; (2, 8) -> d = -6, c = 2 - [-3] = 5
    // y: (3, 5) -> d = -2, c = 3 - [-1] = 4; (-4, -6) -> d = 2, c = -4 - [1] = -5
    let mut slice = [1, 5, 2, 8];
    forward(Psi::H, &mut slice, [2, 2, 1], 1);
    assert_eq!(slice, [4, -5, -2, 2]);
    // level 1: (1, 5), (2, 8), 6 -> 3, 5, 6 | -4, -6; level 2: (3, 5), 6 -> 4, 6 | -2; level 3: (4, 6) -> 5 | -2
    let mut line = [1, 5, 2, 8, 6];
    forward(Psi::H, &mut line, [5, 1, 1], 3);
    assert_eq!(line, [5, -2, -2, -4, -6]);
}

#[test]
fn levels_last_while_an_axis_is_longer_than_one() {
    let cases =
        [([1, 1, 1], 0), ([2, 1, 1], 1), ([1, 3, 1], 2), ([4, 1, 5], 3), ([64, 9, 33], 6), ([1, 1, 65], 7)];
    for (extent, levels) in cases {
        assert_eq!(max_levels(extent), levels, "{extent:?}");
    }
}

#[test]
fn inverse_restores_every_extent_over_the_whole_range() {
    const LENGTHS: [usize; 8] = [1, 2, 3, 4, 5, 7, 8, 9];
    let mut noise = Noise::new(3);
    let mut count = 0;
    for (x, y, z) in LENGTHS
        .iter()
        .flat_map(|&x| LENGTHS.iter().flat_map(move |&y| LENGTHS.iter().map(move |&z| (x, y, z))))
    {
        let extent = [x, y, z];
        for psi in Psi::ALL {
            for levels in 0..=max_levels(extent) {
                let original = noise.full_range(x * y * z);
                let mut samples = original.clone();
                forward(psi, &mut samples, extent, levels);
                inverse(psi, &mut samples, extent, levels);
                assert_eq!(samples, original, "{psi:?} {extent:?} {levels} levels");
                count += 1;
            }
        }
    }
    // 1, 2, 4, 7 and 8 of the lengths end within 0, 1, 2, 3 and 4 levels; their cubes are the extents that do.
    let extents = [1, 8 - 1, 64 - 8, 343 - 64, 512 - 343];
    let transforms: i32 = extents.iter().zip(1..).map(|(extents, depths)| extents * depths).sum();
    assert_eq!(count, 6 * transforms);
}

const fn fixed(numerator: i64, denominator: i64) -> i64 {
    assert!(numerator * ONE % denominator == 0, "the fraction has no exact fixed point form");
    numerator * ONE / denominator
}

/// An operation on an interleaved line with parameters a and b.
type LineLift = fn(&mut [i64], i64, i64);

#[test]
fn line_operations_build_the_dyadic_wavelets() {
    // Diss Table 3.3, the last step of the cubic scaled as in §3.4.3.
    // The thirds and sixths of the quintic have no fixed point form.
    let linear: &[(LineLift, i64)] = &[(w_lift, fixed(-1, 2)), (s_lift, fixed(1, 4))];
    let cubic: &[(LineLift, i64)] = &[(s_lift, fixed(-1, 4)), (w_lift, -ONE), (s_lift, fixed(3, 16))];
    let mut noise = Noise::new(4);
    for (psi, operations) in [(Psi::One, linear), (Psi::Three, cubic)] {
        for n in 1..=40 {
            let mut expected = noise.within(1 << 20, n);
            let mut line: Vec<i64> = expected.iter().copied().map(i64::from).collect();
            lift_line(psi, &mut expected);
            operations.iter().for_each(|(lift, a)| lift(&mut line, *a, 1));
            assert!(line.iter().copied().eq(expected.into_iter().map(i64::from)), "{psi:?}, n = {n}");
        }
    }
}

#[test]
fn line_operations_by_hand_and_back() {
    // c0 = 2 · 5 + [3/8 · -4 = -1.5] = 9; c1 = 2 · 4 + [3/8 · 7 = 2.6] = 11
    let mut line = [5, -2, 4, 9];
    s_lift(&mut line, fixed(3, 8), 2);
    assert_eq!(line, [9, -2, 11, 9]);
    // d0 = 6 + [-1/2 · 20]; d1 = -27 + [-1/2 · 22]
    w_lift(&mut line, fixed(-1, 2), -3);
    assert_eq!(line, [9, -4, 11, -38]);
    inverse_w_lift(&mut line, fixed(-1, 2), -3);
    inverse_s_lift(&mut line, fixed(3, 8), 2);
    assert_eq!(line, [5, -2, 4, 9]);
}

#[test]
fn line_operations_invert_for_any_parameters() {
    let mut noise = Noise::new(5);
    for (n, b) in (1..=33).flat_map(|n| [-4, -1, 1, 2, 3, 4].map(|b| (n, b))) {
        let original: Vec<i64> = noise.within(i32::MAX, n).into_iter().map(i64::from).collect();
        let a = i64::from(noise.within(i32::MAX, 1)[0]);
        let mut line = original.clone();
        s_lift(&mut line, a, b);
        w_lift(&mut line, a / 3, b);
        inverse_w_lift(&mut line, a / 3, b);
        inverse_s_lift(&mut line, a, b);
        assert_eq!(line, original, "n = {n}, a = {a} / {ONE}, b = {b}");
    }
}

#[test]
fn mesh_operation_by_hand() {
    // One corner with three edges and three centres, each edge between two centres.
    let neighbours = Neighbours {
        centres_of_corner: vec![vec![0, 1, 2]],
        edges_of_corner: vec![vec![0, 1, 2]],
        centres_of_edge: vec![vec![0, 1], vec![1, 2], vec![2, 0]],
    };
    let (original_corners, original_edges, centres) = ([10], [1, 2, 4], [3, 5, -2]);
    let (mut corners, mut edges) = (original_corners, original_edges);
    // a = 1/4, b = 2: corner = 4 · 10 + [1/4 · 2 + 2 · 7/3 = 5.2] = 45; rounding both terms alone would add 1 + 5
    // edges: 2 · 1 + [1/2 · 4]; 2 · 2 + [1/2 · 3/2]; 2 · 4 + [1/2 · 1/2]
    mesh_lift(&mut corners, &mut edges, &centres, &neighbours, (fixed(1, 4), 2));
    assert_eq!((corners, edges), ([45], [4, 5, 8]));
    inverse_mesh_lift(&mut corners, &mut edges, &centres, &neighbours, (fixed(1, 4), 2));
    assert_eq!((corners, edges), (original_corners, original_edges));
    // a = -1/4, b = 1: corner = 10 + [1/4 · 2 - 7/3 = -1.8] = 8; rounding both terms alone would add 1 - 2
    // edges: 1 + [-1/2 · 4]; 2 + [-1/2 · 3/2]; 4 + [-1/2 · 1/2]
    mesh_lift(&mut corners, &mut edges, &centres, &neighbours, (fixed(-1, 4), 1));
    assert_eq!((corners, edges), ([8], [-1, 1, 4]));
}

/// A grid of odd width and height whose vertices, edges and faces are its samples (x, y) with two, one and no even
/// coordinates, reflected about the border: the stencils of an operation that writes the corners.
struct Grid {
    width: usize,
    height: usize,
    corners: Vec<usize>,
    edges: Vec<usize>,
    centres: Vec<usize>,
}

impl Grid {
    /// Corners are the samples whose coordinates both leave `parity` modulo 2, centres those where neither does.
    fn new(width: usize, height: usize, parity: usize) -> Self {
        let kind = |wanted: usize| -> Vec<usize> {
            (0..width * height)
                .filter(|k| {
                    usize::from(k % width % 2 == parity) + usize::from(k / width % 2 == parity) == wanted
                })
                .collect()
        };
        Self { width, height, corners: kind(2), edges: kind(1), centres: kind(0) }
    }

    /// Where among `kind` the samples at these offsets from sample `at` are; offsets that leave `kind` drop out.
    fn among(&self, kind: &[usize], at: usize, offsets: &[(isize, isize)]) -> Vec<usize> {
        let reflect = |k: isize, n: usize| {
            let last = n as isize - 1;
            last.abs_diff((last - k.abs()).abs())
        };
        let place = |&(dx, dy): &(isize, isize)| {
            let x = reflect((at % self.width) as isize + dx, self.width);
            let y = reflect((at / self.width) as isize + dy, self.height);
            kind.binary_search(&(x + y * self.width)).ok()
        };
        offsets.iter().filter_map(place).collect()
    }

    fn neighbours(&self) -> Neighbours {
        const DIAGONAL: [(isize, isize); 4] = [(-1, -1), (1, -1), (-1, 1), (1, 1)];
        const STRAIGHT: [(isize, isize); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
        let lists = |of: &[usize], kind: &[usize], offsets: &[(isize, isize)]| {
            of.iter().map(|&at| self.among(kind, at, offsets)).collect()
        };
        Neighbours {
            centres_of_corner: lists(&self.corners, &self.centres, &DIAGONAL),
            edges_of_corner: lists(&self.corners, &self.edges, &STRAIGHT),
            centres_of_edge: lists(&self.edges, &self.centres, &STRAIGHT),
        }
    }

    /// `lift` applied to every row, then to every column.
    fn by_lines(&self, samples: &mut [i64], lift: impl Fn(&mut [i64])) {
        samples.chunks_mut(self.width).for_each(&lift);
        for x in 0..self.width {
            let mut column: Vec<_> = samples[x..].iter().step_by(self.width).copied().collect();
            lift(&mut column);
            column.into_iter().enumerate().for_each(|(y, value)| samples[x + y * self.width] = value);
        }
    }
}

#[test]
fn on_a_grid_the_mesh_operation_is_rows_then_columns() {
    let mut noise = Noise::new(6);
    let line_lifts: [(usize, LineLift); 2] = [(0, s_lift), (1, w_lift)];
    for ((parity, line_lift), (a, b)) in line_lifts.into_iter().flat_map(|lift| {
        [(-1, 1), (3, 2), (-9, -1), (5, 4)].map(|(sixteenths, b)| (lift, (fixed(sixteenths, 16), b)))
    }) {
        let grid = Grid::new(7, 5, parity);
        // Multiples of 16² keep every term whole, so that rounding cannot tell the two ways apart.
        let mut samples: Vec<i64> = noise.within(1000, 35).into_iter().map(|v| i64::from(v) * 256).collect();
        let values = |of: &[usize], samples: &[i64]| -> Vec<i64> { of.iter().map(|&k| samples[k]).collect() };
        let [mut corners, mut edges, centres] =
            [&grid.corners, &grid.edges, &grid.centres].map(|of| values(of, &samples));
        mesh_lift(&mut corners, &mut edges, &centres, &grid.neighbours(), (a, b));
        grid.by_lines(&mut samples, |line| line_lift(line, a, b));
        assert_eq!(
            corners,
            values(&grid.corners, &samples),
            "corners, parity {parity}, a = {a} / {ONE}, b = {b}"
        );
        assert_eq!(edges, values(&grid.edges, &samples), "edges, parity {parity}, a = {a} / {ONE}, b = {b}");
    }
}

#[test]
fn mesh_operation_inverts_at_any_valence() {
    let mut noise = Noise::new(7);
    for (valence, b) in (3..=8).flat_map(|valence| [-2, -1, 1, 3].map(|b| (valence, b))) {
        let ring: Vec<usize> = (0..valence).collect();
        let neighbours = Neighbours {
            centres_of_corner: vec![ring.clone()],
            edges_of_corner: vec![ring.clone()],
            centres_of_edge: ring.iter().map(|&k| vec![k, (k + 1) % valence]).collect(),
        };
        let wide = |values: Vec<i32>| -> Vec<i64> { values.into_iter().map(i64::from).collect() };
        let [corner, a] = [1, 2].map(|_| i64::from(noise.within(1 << 20, 1)[0]));
        let (edges, centres) = (wide(noise.within(1 << 20, valence)), wide(noise.within(1 << 20, valence)));
        let (mut corners, mut lifted) = (vec![corner], edges.clone());
        mesh_lift(&mut corners, &mut lifted, &centres, &neighbours, (a, b));
        inverse_mesh_lift(&mut corners, &mut lifted, &centres, &neighbours, (a, b));
        assert_eq!((corners, lifted), (vec![corner], edges), "valence {valence}, a = {a} / {ONE}, b = {b}");
    }
}
