//! The six integer lifting wavelets, one coefficient at a time.
//!
//! Source: Bertram, *Multiresolution Modeling for Scientific Visualization*, 2000, §3.3.4–3.4 (cited as Diss).
//! A line x of length n stays interleaved while it is lifted: `x[2i]` holds c_i, `x[2i+1]` holds d_i.
//! All arithmetic is in `i64`. Where a sum leaves the range of `i32`, exactly two places fold it back modulo 2^32: the
//! numerator inside a bracket before it is rounded, its sign included (`[-(c_i + c_{i+1}) / 2]` folds
//! `-(c_i + c_{i+1})`), and the sample that a step writes.

/// The wavelets under their symbols in the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Psi {
    /// ψ_H, the Haar wavelet (Diss 3.37).
    H,
    /// ψ_Q, quadratic B-spline (Diss 3.42).
    Q,
    /// ψ_D, Duchaineau's wavelet (Diss §3.3.4).
    D,
    /// ψ_1, linear B-spline (Diss Table 3.3).
    One,
    /// ψ_3, cubic B-spline with the last step scaled by 1/2 (Diss §3.4.3).
    Three,
    /// ψ_5, quintic B-spline with the last step scaled by 1/4 (Diss §3.4.3).
    Five,
}

impl Psi {
    /// Every wavelet, in the order of the text.
    pub const ALL: [Self; 6] = [Self::H, Self::Q, Self::D, Self::One, Self::Three, Self::Five];

    const fn step_count(self) -> usize {
        match self {
            Self::H | Self::One => 2,
            Self::Q | Self::D | Self::Three => 3,
            Self::Five => 4,
        }
    }

    /// First position that a step writes, 0 for the c and 1 for the d: steps alternate and the last one writes the c.
    const fn first_written(self, step: usize) -> usize {
        (self.step_count() - 1 - step) % 2
    }

    /// The factor of the sample itself: ψ_H, ψ_Q and ψ_D turn the sign of d.
    const fn own_factor(self, step: usize) -> i64 {
        match self {
            Self::H | Self::Q | Self::D if self.first_written(step) == 1 => -1,
            _ => 1,
        }
    }
}

/// What a line offers in place of a sample that it lacks.
#[derive(Debug, Clone, Copy)]
enum Missing {
    /// `x[-k]` is `x[k]` and `x[n-1+k]` is `x[n-1-k]`.
    Reflected,
    /// The nearest sample of the same kind (c or d).
    Nearest,
    /// Nothing: it counts as zero.
    Zero,
}

/// The position whose sample stands in for position `k` of a line of `n` samples, if any does.
fn stand_in(missing: Missing, k: isize, n: usize) -> Option<usize> {
    let n = n as isize;
    let inside = if (0..n).contains(&k) {
        k
    } else {
        match missing {
            Missing::Reflected if k < 0 => -k,
            Missing::Reflected => 2 * (n - 1) - k,
            Missing::Nearest if k < 0 => k + 2,
            Missing::Nearest => k - 2,
            Missing::Zero => return None,
        }
    };
    Some(usize::try_from(inside).expect("a step looks at most one sample of a kind past the end"))
}

/// `[r]` = floor(r + 1/2) of the fraction `numerator / denominator`, the numerator folded to 32 bits first.
fn round(numerator: i64, denominator: i64) -> i64 {
    let folded = i64::from(numerator as i32);
    (2 * folded + denominator).div_euclid(2 * denominator)
}

/// What step `step` of `psi` adds to the sample at position `at` of the line `x`.
fn added(psi: Psi, step: usize, x: &[i32], at: usize) -> i64 {
    let sample = |missing, offset: isize| {
        stand_in(missing, at as isize + offset, x.len()).map_or(0, |position| i64::from(x[position]))
    };
    let near = |offset| sample(Missing::Nearest, offset);
    let zero = |offset| sample(Missing::Zero, offset);
    let both = sample(Missing::Reflected, -1) + sample(Missing::Reflected, 1);
    match (psi, step) {
        // d_i <- c_i - d_i
        (Psi::H, 0) => round(near(-1), 1),
        // c_i <- c_i - [d_i / 2]
        (Psi::H, _) => -round(zero(1), 2),
        // c_i <- c_i - [d_{i-1} / 3]
        (Psi::Q | Psi::D, 0) => -round(near(-1), 3),
        // d_i <- -d_i + [(9 c_i + 3 c_{i+1}) / 8]
        (Psi::Q | Psi::D, 1) => round(9 * near(-1) + 3 * near(1), 8),
        // c_i <- c_i - [4 d_i / 9]
        (Psi::Q, _) => -round(4 * zero(1), 9),
        // c_i <- c_i - [(12 d_i - 4 (d_{i+1} - d_{i-1})) / 27]
        (Psi::D, _) => -round(12 * zero(1) - 4 * (zero(3) - zero(-1)), 27),
        // w-lift(-1/2, 1), s-lift(1/4, 1)
        (Psi::One, 0) => round(-both, 2),
        (Psi::One, _) => round(both, 4),
        // s-lift(-1/4, 1), w-lift(-1, 1), s-lift(3/16, 1)
        (Psi::Three, 0) => round(-both, 4),
        (Psi::Three, 1) => round(-both, 1),
        (Psi::Three, _) => round(3 * both, 16),
        // w-lift(-1/6, 1), s-lift(-9/16, 1), w-lift(-4/3, 1), s-lift(5/32, 1)
        (Psi::Five, 0) => round(-both, 6),
        (Psi::Five, 1) => round(-9 * both, 16),
        (Psi::Five, 2) => round(-4 * both, 3),
        (Psi::Five, _) => round(5 * both, 32),
    }
}

/// Lifts one line in place and leaves it interleaved: c at even, d at odd positions. A single sample stays as it is.
pub fn lift_line(psi: Psi, x: &mut [i32]) {
    if x.len() == 1 {
        return;
    }
    for step in 0..psi.step_count() {
        for at in (psi.first_written(step)..x.len()).step_by(2) {
            x[at] = (psi.own_factor(step) * i64::from(x[at]) + added(psi, step, x, at)) as i32;
        }
    }
}

/// Undoes [`lift_line`].
pub fn unlift_line(psi: Psi, x: &mut [i32]) {
    if x.len() == 1 {
        return;
    }
    for step in (0..psi.step_count()).rev() {
        for at in (psi.first_written(step)..x.len()).step_by(2) {
            x[at] = (psi.own_factor(step) * (i64::from(x[at]) - added(psi, step, x, at))) as i32;
        }
    }
}

/// Levels that an array of this extent has: one as long as some axis is longer than 1; no axis is empty.
pub fn max_levels(extent: [usize; 3]) -> usize {
    if extent == [1; 3] { 0 } else { 1 + max_levels(low_part(extent)) }
}

/// Transforms an array, x fastest, by `levels` levels in place; the result is in Mallat order, low half first.
pub fn forward(psi: Psi, samples: &mut [i32], extent: [usize; 3], levels: usize) {
    let mut region = extent;
    for _ in 0..levels {
        for axis in [0, 1, 2] {
            for_each_line(samples, extent, region, axis, |line| {
                lift_line(psi, line);
                let (low, high) = (line.iter().step_by(2), line.iter().skip(1).step_by(2));
                low.chain(high).copied().collect()
            });
        }
        region = low_part(region);
    }
}

/// Undoes [`forward`] of the same arguments.
pub fn inverse(psi: Psi, samples: &mut [i32], extent: [usize; 3], levels: usize) {
    let regions: Vec<_> = std::iter::successors(Some(extent), |&e| Some(low_part(e))).take(levels).collect();
    for &region in regions.iter().rev() {
        for axis in [2, 1, 0] {
            for_each_line(samples, extent, region, axis, |line| {
                let low_count = line.len().div_ceil(2);
                let position = |k: usize| if k.is_multiple_of(2) { k / 2 } else { low_count + k / 2 };
                let mut interleaved: Vec<_> = (0..line.len()).map(|k| line[position(k)]).collect();
                unlift_line(psi, &mut interleaved);
                interleaved
            });
        }
    }
}

fn low_part(extent: [usize; 3]) -> [usize; 3] {
    extent.map(|n| n.div_ceil(2))
}

/// Replaces every line along `axis` of the corner `region` of an array by what `change` makes of it.
fn for_each_line(
    samples: &mut [i32],
    extent: [usize; 3],
    region: [usize; 3],
    axis: usize,
    change: impl Fn(&mut [i32]) -> Vec<i32>,
) {
    assert_eq!(samples.len(), extent.iter().product::<usize>(), "one sample a place");
    let stride = [1, extent[0], extent[0] * extent[1]];
    let mut starts = region;
    starts[axis] = 1;
    for z in 0..starts[2] {
        for y in 0..starts[1] {
            for x in 0..starts[0] {
                let place = |i: usize| x * stride[0] + y * stride[1] + z * stride[2] + i * stride[axis];
                let mut line: Vec<_> = (0..region[axis]).map(|i| samples[place(i)]).collect();
                for (i, value) in change(&mut line).into_iter().enumerate() {
                    samples[place(i)] = value;
                }
            }
        }
    }
}
