//! Every wavelet on every short extent with every number of levels: the kernel's coefficients are those of the
//! reference, and its inverse restores the samples.

use conformance::inputs::Input;
use conformance::lent::Lent;
use conformance::oracle::lifting::max_levels;
use conformance::oracle::noise::Noise;
use conformance::reference::{forward, sides};
use wavelift_kernel::{Extent, Plan, PlanError, Wavelet};

/// Lengths of an axis: the shortest, and those around powers of two.
const LENGTHS: [u32; 12] = [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33];

/// Lengths of which every brick is tried at every level.
const BRICK_LENGTHS: [u32; 6] = [1, 2, 3, 5, 8, 17];

/// Forward as the reference, and back again.
fn check(plan: &Plan, samples: &[i32]) {
    let expected = forward(plan, samples);
    let (mut lent, mut scratch) = (Lent::samples(samples), Lent::stale(plan.scratch_len()));
    plan.forward(lent.lend(), scratch.lend()).expect("memory of the right lengths");
    scratch.take_back();
    let coefficients = lent.take_back();
    assert!(coefficients == expected, "{plan:?}: coefficients of {samples:?}");
    let (mut lent, mut scratch) = (Lent::samples(&coefficients), Lent::stale(plan.scratch_len()));
    plan.inverse(lent.lend(), scratch.lend()).expect("memory of the right lengths");
    scratch.take_back();
    assert!(lent.take_back() == samples, "{plan:?}: the inverse does not restore {samples:?}");
}

/// A smooth field, of a depth that leaves room for every wavelet's growth.
fn smooth(extent: Extent) -> Vec<i32> {
    let waves = Input::Waves { periods: [13, 9, 21], amplitude: 30_000, offset: 1000 };
    waves.generate(extent).expect("a generator")
}

/// Checks each number of levels that the extent allows, and that one more is refused; returns how many there are.
fn check_all_levels(wavelet: Wavelet, axes: [u32; 3], noise: &mut Noise) -> usize {
    let extent = Extent::new(axes).expect("a small extent");
    let max = u8::try_from(max_levels(sides(extent))).expect("a few levels");
    for levels in 0..=max {
        let plan = Plan::new(wavelet, extent, levels).expect("as many levels as the reference has");
        check(&plan, &noise.full_range(extent.samples()));
        check(&plan, &smooth(extent));
    }
    assert_eq!(Plan::new(wavelet, extent, max + 1), Err(PlanError::TooManyLevels { max }), "{axes:?}");
    assert_eq!(Plan::new(wavelet, extent, u8::MAX), Err(PlanError::TooManyLevels { max }), "{axes:?}");
    usize::from(max) + 1
}

fn check_lines(wavelet: Wavelet) {
    let mut noise = Noise::new(1);
    let axes = LENGTHS.into_iter().flat_map(|n| [[n, 1, 1], [1, n, 1], [1, 1, n]]);
    let plans: usize = axes.map(|axes| check_all_levels(wavelet, axes, &mut noise)).sum();
    assert_eq!(plans, 150);
}

fn check_slices(wavelet: Wavelet) {
    let mut noise = Noise::new(2);
    let pairs = LENGTHS.into_iter().flat_map(|a| LENGTHS.map(|b| (a, b)));
    let axes = pairs.flat_map(|(a, b)| [[a, b, 1], [a, 1, b], [1, a, b]]);
    let plans: usize = axes.map(|axes| check_all_levels(wavelet, axes, &mut noise)).sum();
    assert_eq!(plans, 2208);
}

fn bricks(lengths: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    lengths
        .iter()
        .flat_map(move |&x| lengths.iter().flat_map(move |&y| lengths.iter().map(move |&z| [x, y, z])))
}

fn check_bricks(wavelet: Wavelet) {
    let mut noise = Noise::new(3);
    let plans: usize = bricks(&BRICK_LENGTHS).map(|axes| check_all_levels(wavelet, axes, &mut noise)).sum();
    assert_eq!(plans, 1010);
}

/// All levels at once of all bricks.
fn check_deepest_bricks(wavelet: Wavelet) {
    let mut noise = Noise::new(4);
    for axes in bricks(&LENGTHS) {
        let extent = Extent::new(axes).expect("a small extent");
        let plan = Plan::new(wavelet, extent, extent.max_levels()).expect("as many levels as there are");
        check(&plan, &noise.full_range(extent.samples()));
    }
}

macro_rules! each_wavelet {
    ($($name:ident: $wavelet:ident,)*) => {$(
        mod $name {
            use super::Wavelet;

            #[test]
            fn lines() {
                super::check_lines(Wavelet::$wavelet);
            }

            #[test]
            fn slices() {
                super::check_slices(Wavelet::$wavelet);
            }

            #[test]
            fn bricks() {
                super::check_bricks(Wavelet::$wavelet);
            }

            #[test]
            fn deepest_bricks() {
                super::check_deepest_bricks(Wavelet::$wavelet);
            }
        }
    )*};
}

each_wavelet! {
    haar: Haar,
    quadratic: Quadratic,
    duchaineau: Duchaineau,
    linear: Linear,
    cubic: Cubic,
    quintic: Quintic,
}

#[test]
fn no_wavelet_is_left_out() {
    let modules = ["haar", "quadratic", "duchaineau", "linear", "cubic", "quintic"];
    assert_eq!(Wavelet::ALL.map(Wavelet::name), modules);
}
