//! The filters of Diss Tables 3.2 and 3.4 follow from the lifting steps, and the integer reference follows the filters.
//!
//! The steps stand here a second time, as a table for real-valued signals. Signals are integers scaled by [`UNIT`], a
//! multiple of every denominator that the steps build up, so that each division comes out even: the arithmetic is exact.

use conformance::oracle::lifting::{Psi, lift_line};
use conformance::oracle::noise::Noise;

/// What 1 is scaled to: a multiple of 6 · 16 · 3 · 32 (ψ_5) and of 3 · 8 · 27 (ψ_D), with room for the tables' fractions.
const UNIT: i64 = (1 << 20) * 729;

/// What a line offers in place of a sample that it lacks.
#[derive(Clone, Copy)]
enum Edge {
    Reflected,
    SameKind,
    Zero,
}

/// x[k] <- own x[k] + (Σ weight x[k + offset]) / denominator for every second k from `first`.
struct Step {
    first: usize,
    own: i64,
    taps: &'static [(isize, i64)],
    denominator: i64,
    edge: Edge,
}

/// The step on the c (`first` 0) or the d (`first` 1).
const fn step(first: usize, own: i64, taps: &'static [(isize, i64)], denominator: i64, edge: Edge) -> Step {
    Step { first, own, taps, denominator, edge }
}

fn steps(psi: Psi) -> Vec<Step> {
    use Edge::{Reflected, SameKind, Zero};
    match psi {
        Psi::H => vec![step(1, -1, &[(-1, 1)], 1, SameKind), step(0, 1, &[(1, -1)], 2, Zero)],
        Psi::Q => vec![
            step(0, 1, &[(-1, -1)], 3, SameKind),
            step(1, -1, &[(-1, 9), (1, 3)], 8, SameKind),
            step(0, 1, &[(1, -4)], 9, Zero),
        ],
        Psi::D => vec![
            step(0, 1, &[(-1, -1)], 3, SameKind),
            step(1, -1, &[(-1, 9), (1, 3)], 8, SameKind),
            step(0, 1, &[(-1, -4), (1, -12), (3, 4)], 27, Zero),
        ],
        Psi::One => {
            vec![step(1, 1, &[(-1, -1), (1, -1)], 2, Reflected), step(0, 1, &[(-1, 1), (1, 1)], 4, Reflected)]
        }
        Psi::Three => vec![
            step(0, 1, &[(-1, -1), (1, -1)], 4, Reflected),
            step(1, 1, &[(-1, -1), (1, -1)], 1, Reflected),
            step(0, 1, &[(-1, 3), (1, 3)], 16, Reflected),
        ],
        Psi::Five => vec![
            step(1, 1, &[(-1, -1), (1, -1)], 6, Reflected),
            step(0, 1, &[(-1, -9), (1, -9)], 16, Reflected),
            step(1, 1, &[(-1, -4), (1, -4)], 3, Reflected),
            step(0, 1, &[(-1, 5), (1, 5)], 32, Reflected),
        ],
    }
}

/// The last steps s-lift(3/8, 2) and s-lift(5/8, 4) of Diss Table 3.3, which §3.4.3 scales by 1/2 and 1/4.
fn unscaled_steps(psi: Psi) -> Vec<Step> {
    let mut steps = steps(psi);
    steps.pop();
    steps.push(match psi {
        Psi::Three => step(0, 2, &[(-1, 3), (1, 3)], 8, Edge::Reflected),
        _ => step(0, 4, &[(-1, 5), (1, 5)], 8, Edge::Reflected),
    });
    steps
}

fn even_quotient(numerator: i64, denominator: i64) -> i64 {
    assert_eq!(numerator % denominator, 0, "{numerator} / {denominator} leaves a remainder");
    numerator / denominator
}

/// The weighted neighbours of `x[at]`, without the denominator.
fn bracket(step: &Step, x: &[i64], at: usize) -> i64 {
    let last = x.len() as isize - 1;
    let read = |k: isize| {
        let mirrored = match step.edge {
            _ if (0..=last).contains(&k) => k,
            Edge::Zero => return 0,
            Edge::Reflected => {
                if k < 0 {
                    -k
                } else {
                    2 * last - k
                }
            }
            Edge::SameKind => {
                if k < 0 {
                    k + 2
                } else {
                    k - 2
                }
            }
        };
        x[mirrored as usize]
    };
    step.taps.iter().map(|&(offset, weight)| weight * read(at as isize + offset)).sum()
}

fn decompose(steps: &[Step], x: &mut [i64]) {
    for step in steps {
        for at in (step.first..x.len()).step_by(2) {
            x[at] = step.own * x[at] + even_quotient(bracket(step, x, at), step.denominator);
        }
    }
}

fn reconstruct(steps: &[Step], x: &mut [i64]) {
    for step in steps.iter().rev() {
        for at in (step.first..x.len()).step_by(2) {
            let own = x[at] - even_quotient(bracket(step, x, at), step.denominator);
            x[at] = even_quotient(own, step.own);
        }
    }
}

/// A filter as the tables give it: the index of the first tap, the taps' numerators, their common denominator.
type Filter = (isize, &'static [i64], i64);

/// h, l, h~ and l~. Tables 3.2 and 3.4 index them differently: in 3.2 all four start from x[2i] (and c_i, d_i stand at
/// x[2i]); in 3.4 h and h~ are centred on the d, x[2i+1]. Here every index counts from x[2i].
struct Filters {
    high: Filter,
    low: Filter,
    high_reconstruction: Filter,
    low_reconstruction: Filter,
}

fn table(psi: Psi) -> Filters {
    let filters = |high, low, high_reconstruction, low_reconstruction| Filters {
        high,
        low,
        high_reconstruction,
        low_reconstruction,
    };
    match psi {
        // Table 3.2
        Psi::H => filters((0, &[1, -1], 1), (0, &[1, 1], 2), (0, &[1, -1], 2), (0, &[1, 1], 1)),
        Psi::Q => filters(
            (-1, &[-1, 3, -3, 1], 4),
            (-1, &[-1, 3, 3, -1], 4),
            (-1, &[1, 3, -3, -1], 4),
            (-1, &[1, 3, 3, 1], 4),
        ),
        Psi::D => filters(
            (-1, &[-1, 3, -3, 1], 4),
            (-3, &[1, -3, 0, 8, 8, 0, -3, 1], 12),
            (-3, &[-1, -3, 0, 8, -8, 0, 3, 1], 12),
            (-1, &[1, 3, 3, 1], 4),
        ),
        // Table 3.4
        Psi::One => filters(
            (0, &[-1, 2, -1], 2),
            (-2, &[-1, 2, 6, 2, -1], 8),
            (-1, &[-1, -2, 6, -2, -1], 8),
            (-1, &[1, 2, 1], 2),
        ),
        Psi::Three => filters(
            (-1, &[1, -4, 6, -4, 1], 4),
            (-3, &[3, -12, 5, 40, 5, -12, 3], 32),
            (-2, &[-3, -12, -5, 40, -5, -12, -3], 64),
            (-2, &[1, 4, 6, 4, 1], 8),
        ),
        Psi::Five => filters(
            (-2, &[-1, 6, -15, 20, -15, 6, -1], 8),
            (-4, &[-5, 30, -56, -14, 154, -14, -56, 30, -5], 64),
            (-3, &[-5, -30, -56, 14, 154, 14, -56, -30, -5], 256),
            (-3, &[1, 6, 15, 20, 15, 6, 1], 32),
        ),
    }
}

/// By which fraction the lifting steps scale (c, d) against the tables. Diss (3.42) scales the rows of d by 3/2 and of c
/// by 2/3 so that every step keeps its own coefficient whole; ψ_D shares them. Diss §3.4.3 scales the last step of ψ_3
/// and ψ_5, and with it c, by 1/2 and 1/4. A row of the decomposition scaled by s is a column of the reconstruction
/// scaled by 1/s.
const fn row_scales(psi: Psi) -> [(i64, i64); 2] {
    match psi {
        Psi::H | Psi::One => [(1, 1), (1, 1)],
        Psi::Q | Psi::D => [(2, 3), (3, 2)],
        Psi::Three => [(1, 2), (1, 1)],
        Psi::Five => [(1, 4), (1, 1)],
    }
}

const LENGTH: usize = 64;
/// The position of a c far from both ends; its d follows it.
const MIDDLE: usize = 32;

/// All samples zero but `x[at]`, which is [`UNIT`].
fn impulse(at: usize) -> Vec<i64> {
    let mut x = vec![0; LENGTH];
    x[at] = UNIT;
    x
}

/// `response[k]` must be `scale` times the filter's tap at k - MIDDLE, and zero where the filter has none.
fn assert_filter(response: &[i64], (first, taps, denominator): Filter, scale: (i64, i64), what: &str) {
    for (k, &found) in response.iter().enumerate() {
        let tap = usize::try_from(k as isize - MIDDLE as isize - first).ok().and_then(|t| taps.get(t));
        let expected = even_quotient(tap.unwrap_or(&0) * UNIT * scale.0, denominator * scale.1);
        assert_eq!(found, expected, "{what}, tap {}", k as isize - MIDDLE as isize);
    }
}

fn assert_filters(psi: Psi, steps: &[Step], scales: [(i64, i64); 2]) {
    let row = |position: usize| -> Vec<i64> {
        let response_of = |at| {
            let mut x = impulse(at);
            decompose(steps, &mut x);
            x[position]
        };
        (0..LENGTH).map(response_of).collect()
    };
    let column = |position: usize| {
        let mut x = impulse(position);
        reconstruct(steps, &mut x);
        x
    };
    let inverted = |(numerator, denominator)| (denominator, numerator);
    let [low, high] = scales;
    let filters = table(psi);
    assert_filter(&row(MIDDLE), filters.low, low, &format!("{psi:?} l"));
    assert_filter(&row(MIDDLE + 1), filters.high, high, &format!("{psi:?} h"));
    assert_filter(&column(MIDDLE), filters.low_reconstruction, inverted(low), &format!("{psi:?} l~"));
    assert_filter(&column(MIDDLE + 1), filters.high_reconstruction, inverted(high), &format!("{psi:?} h~"));
}

#[test]
fn steps_give_the_filters_of_the_text() {
    for psi in Psi::ALL {
        assert_filters(psi, &steps(psi), row_scales(psi));
    }
}

#[test]
fn unscaled_last_steps_give_the_filters_without_any_factor() {
    for psi in [Psi::Three, Psi::Five] {
        assert_filters(psi, &unscaled_steps(psi), [(1, 1), (1, 1)]);
    }
}

/// Bounds on what rounding adds to (c, d), times [`UNIT`]. A step rounds by at most 1/2 where its denominator is even and
/// (q - 1) / 2q where it is odd, and carries on what its neighbours' errors contribute.
fn rounding_slack(steps: &[Step]) -> [i64; 2] {
    let mut slack = [0; 2];
    for step in steps {
        let q = step.denominator;
        let own_error = if q % 2 == 0 { UNIT / 2 } else { even_quotient(UNIT * (q - 1), 2 * q) };
        let weights: i64 = step.taps.iter().map(|&(_, weight)| weight.abs()).sum();
        slack[step.first] += even_quotient(weights * slack[1 - step.first], q) + own_error;
    }
    slack
}

/// Growth of one level on a line: the rounding slack of (c, d) and the largest |c| and |d| that samples within ±1 give
/// without rounding, over every length and boundary row.
const fn growth(psi: Psi) -> [[(i64, i64); 2]; 2] {
    match psi {
        Psi::H => [[(1, 2), (0, 1)], [(1, 1), (2, 1)]],
        Psi::Q => [[(11, 9), (1, 1)], [(4, 3), (3, 1)]],
        Psi::D => [[(14, 9), (1, 1)], [(4, 3), (3, 1)]],
        Psi::One => [[(3, 4), (1, 2)], [(3, 2), (2, 1)]],
        Psi::Three => [[(11, 8), (1, 1)], [(5, 4), (4, 1)]],
        Psi::Five => [[(65, 24), (11, 3)], [(91, 64), (8, 1)]],
    }
}

fn scaled(fractions: [(i64, i64); 2]) -> [i64; 2] {
    fractions.map(|(numerator, denominator)| even_quotient(numerator * UNIT, denominator))
}

#[test]
fn growth_of_one_level_is_what_the_table_says() {
    for psi in Psi::ALL {
        let steps = steps(psi);
        let [slack, extremes] = growth(psi);
        assert_eq!(rounding_slack(&steps), scaled(slack), "{psi:?} slack");
        let mut largest = [0; 2];
        for n in 2..=40 {
            let mut absolute_sums = vec![0; n];
            for at in 0..n {
                let mut x = vec![0; n];
                x[at] = UNIT;
                decompose(&steps, &mut x);
                absolute_sums.iter_mut().zip(&x).for_each(|(sum, weight)| *sum += weight.abs());
            }
            absolute_sums.iter().enumerate().for_each(|(k, &sum)| largest[k % 2] = largest[k % 2].max(sum));
        }
        assert_eq!(largest, scaled(extremes), "{psi:?} growth");
    }
}

#[test]
fn a_constant_leaves_no_details_and_the_gain_of_the_low_pass() {
    for psi in Psi::ALL {
        let (numerator, denominator) = match psi {
            Psi::H | Psi::One => (1, 1),
            Psi::Q | Psi::D => (2, 3),
            Psi::Three => (1, 2),
            Psi::Five => (1, 4),
        };
        for n in 2..=40 {
            let mut x = vec![UNIT; n];
            decompose(&steps(psi), &mut x);
            for (k, &value) in x.iter().enumerate() {
                let expected = if k % 2 == 0 { even_quotient(numerator * UNIT, denominator) } else { 0 };
                assert_eq!(value, expected, "{psi:?}, n = {n}, position {k}");
            }
        }
    }
}

#[test]
fn integer_reference_stays_within_the_slack_of_the_filters() {
    let mut noise = Noise::new(1);
    for psi in Psi::ALL {
        let steps = steps(psi);
        let slack = rounding_slack(&steps);
        for n in (2..=40).cycle().take(2000) {
            let mut integers = noise.within(255, n);
            let mut reals: Vec<i64> = integers.iter().map(|&value| i64::from(value) * UNIT).collect();
            lift_line(psi, &mut integers);
            decompose(&steps, &mut reals);
            for (k, (&integer, &real)) in integers.iter().zip(&reals).enumerate() {
                let error = (i64::from(integer) * UNIT - real).abs();
                assert!(error <= slack[k % 2], "{psi:?}, n = {n}, position {k}: error {error} / {UNIT}");
            }
        }
    }
}

/// The reversible 5/3 transform of JPEG 2000 (ITU-T T.800, Annex F), as that standard writes it.
fn reversible_5_3(x: &[i32]) -> Vec<i32> {
    if x.len() == 1 {
        return x.to_vec();
    }
    let n = x.len() as i32;
    let extended = |signal: &[i32], k: i32| {
        let period = 2 * (n - 1);
        let folded = k.rem_euclid(period);
        signal[folded.min(period - folded) as usize]
    };
    let mut y = x.to_vec();
    for k in (1..n).step_by(2) {
        y[k as usize] = x[k as usize] - (extended(x, k - 1) + extended(x, k + 1)).div_euclid(2);
    }
    let high = y.clone();
    for k in (0..n).step_by(2) {
        y[k as usize] = x[k as usize] + (extended(&high, k - 1) + extended(&high, k + 1) + 2).div_euclid(4);
    }
    y
}

#[test]
fn linear_wavelet_is_the_reversible_5_3_of_jpeg_2000() {
    let mut noise = Noise::new(2);
    for n in 1..=40 {
        for limit in [1, 7, 255, 65_535, 1 << 28] {
            let x = noise.within(limit, n);
            let mut lifted = x.clone();
            lift_line(Psi::One, &mut lifted);
            assert_eq!(lifted, reversible_5_3(&x), "{x:?}");
        }
    }
}
