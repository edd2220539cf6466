//! The order of the values, their classes, and the prediction of the low-pass part.

use super::header::{Choices, Storage, Weights, ceil_shift};
use super::value::Context;

/// A place in a subband, counted from the subband's origin; it may lie beyond the borders.
type Place = [isize; 3];

/// Where a subband lies among the coefficients in Mallat order.
#[derive(Debug, Clone, Copy)]
struct Subband {
    origin: [usize; 3],
    extent: [usize; 3],
}

/// The coefficients of a codestream on their way through the coder.
#[derive(Debug)]
pub(super) struct Scan {
    extent: [usize; 3],
    levels: usize,
    storage: Storage,
    /// In Mallat order.
    coefficients: Vec<i32>,
    /// The value coded for each coefficient, 0 before it is.
    values: Vec<i32>,
}

impl Scan {
    pub(super) fn new(choices: &Choices, coefficients: Vec<i32>) -> Self {
        let &Choices { extent, levels, storage, .. } = choices;
        Self { extent, levels, storage, values: vec![0; coefficients.len()], coefficients }
    }

    pub(super) fn into_coefficients(self) -> Vec<i32> {
        self.coefficients
    }

    /// Hands the context and value of everything in segment `resolution` to `code`, which returns the value: the one
    /// it was given when encoding, the one it has read when decoding.
    pub(super) fn resolution(&mut self, resolution: usize, mut code: impl FnMut(Context, i32) -> i32) {
        if resolution == 0 {
            let low_pass = self.low_pass();
            for place in places(low_pass) {
                let prediction = self.prediction(place);
                let at = self.index(low_pass, place).expect("a place of the subband");
                let residual = self.coefficients[at].wrapping_sub(prediction);
                self.values[at] = code(self.context(low_pass, place, 0), residual);
                self.coefficients[at] = prediction.wrapping_add(self.values[at]);
            }
            return;
        }
        let level = self.levels - resolution;
        for orientation in 1..8 {
            let subband = self.subband(level, orientation);
            for place in places(subband) {
                let hint = self.hint(level, orientation, place);
                let at = self.index(subband, place).expect("a place of the subband");
                self.values[at] = code(self.context(subband, place, hint), self.coefficients[at]);
                self.coefficients[at] = self.values[at];
            }
        }
    }

    fn low_pass(&self) -> Subband {
        Subband { origin: [0; 3], extent: ceil_shift(self.extent, self.levels) }
    }

    fn subband(&self, level: usize, orientation: usize) -> Subband {
        let (all, low) = (ceil_shift(self.extent, level), ceil_shift(self.extent, level + 1));
        let high = |axis: usize| orientation >> axis & 1 == 1;
        Subband {
            origin: [0, 1, 2].map(|axis| if high(axis) { low[axis] } else { 0 }),
            extent: [0, 1, 2].map(|axis| if high(axis) { all[axis] - low[axis] } else { low[axis] }),
        }
    }

    /// Index of the coefficient at a place of a subband, if the subband has that place.
    fn index(&self, subband: Subband, place: Place) -> Option<usize> {
        let mut at = [0; 3];
        for axis in 0..3 {
            let inside = usize::try_from(place[axis]).ok().filter(|&k| k < subband.extent[axis])?;
            at[axis] = subband.origin[axis] + inside;
        }
        Some(at[0] + self.extent[0] * (at[1] + self.extent[1] * at[2]))
    }

    /// The value at a place of a subband, 0 beyond its borders.
    fn value(&self, subband: Subband, place: Place) -> i32 {
        self.index(subband, place).map_or(0, |at| self.values[at])
    }

    /// Remembered magnitude of the value at a place of a subband.
    fn magnitude(&self, subband: Subband, place: Place) -> u64 {
        u64::from(self.value(subband, place).unsigned_abs()).min(1 << 16)
    }

    fn context(&self, subband: Subband, place: Place, hint: u64) -> Context {
        let [x, y, z] = place;
        let sigma = |place| 1 + self.value(subband, place).signum();
        let signs = 9 * sigma([x - 1, y, z]) + 3 * sigma([x, y - 1, z]) + sigma([x, y, z - 1]);
        Context { class: class(self.nearby(subband, place) + hint), signs: signs as usize }
    }

    /// The sum s without the hint.
    fn nearby(&self, subband: Subband, [x, y, z]: Place) -> u64 {
        let at = |dx, dy, dz| self.magnitude(subband, [x + dx, y + dy, z + dz]);
        let (w, n, u) = (at(-1, 0, 0), at(0, -1, 0), at(0, 0, -1));
        let (nw, ne) = (at(-1, -1, 0), at(1, -1, 0));
        let (ue, us) = (at(1, 0, -1), at(0, 1, -1));
        let (ww, nn) = (at(-2, 0, 0), at(0, -2, 0));
        4 * (w + n + u) + 2 * (nw + ne + ue + us) + ww + nn
    }

    fn hint(&self, level: usize, orientation: usize, place: Place) -> u64 {
        let lower = (1..orientation).map(|lower| 3 * self.magnitude(self.subband(level, lower), place));
        let coarser = if level + 1 < self.levels {
            2 * self.magnitude(self.subband(level + 1, orientation), place.map(|k| k / 2))
        } else {
            0
        };
        lower.sum::<u64>() + coarser
    }

    /// The prediction p of the coefficient at a place of the low-pass part.
    fn prediction(&self, place: Place) -> i32 {
        match self.storage {
            Storage::Coded { predictor } => self.simple(predictor, place),
            Storage::Trained { weights } => self.trained(&weights, place),
            Storage::Stored => unreachable!("what is stored is not predicted"),
        }
    }

    /// The predictors 0 to 4.
    fn simple(&self, predictor: u8, [x, y, z]: Place) -> i32 {
        let u = if z == 0 { 0 } else { self.coefficient([x, y, z - 1]) };
        let [w, n, nw] = self.neighbours([x, y, z], u);
        if z == 0 {
            return median(w, n, plane(w, n, nw));
        }
        let [uw, un, unw] = self.neighbours([x, y, z - 1], u);
        match predictor {
            0 => median(w, n, plane(w, n, nw)),
            1 => u,
            2 => median(plane(w, n, nw), plane(w, u, uw), plane(u, n, un)),
            3 => {
                let (w, n, nw) = (w.wrapping_sub(uw), n.wrapping_sub(un), nw.wrapping_sub(unw));
                u.wrapping_add(median(w, n, plane(w, n, nw)))
            }
            4 => w.wrapping_add(n).wrapping_add(u).div_euclid(3),
            _ => unreachable!("without weights a header announces the predictors 0 to 4 alone"),
        }
    }

    /// w, n and nw of a place in its plane, replaced where they do not exist.
    fn neighbours(&self, [x, y, z]: Place, fallback: i32) -> [i32; 3] {
        let w = match (x > 0, y > 0) {
            (true, _) => self.coefficient([x - 1, y, z]),
            (false, true) => self.coefficient([x, y - 1, z]),
            (false, false) => fallback,
        };
        let n = if y > 0 { self.coefficient([x, y - 1, z]) } else { w };
        let nw = match (x > 0, y > 0) {
            (true, true) => self.coefficient([x - 1, y - 1, z]),
            (false, true) => n,
            (_, false) => w,
        };
        [w, n, nw]
    }

    /// The predictor 5.
    fn trained(&self, weights: &Weights, [x, y, z]: Place) -> i32 {
        let reference = match (x > 0, y > 0, z > 0) {
            (true, _, _) => self.coefficient([x - 1, y, z]),
            (_, true, _) => self.coefficient([x, y - 1, z]),
            (_, _, true) => self.coefficient([x, y, z - 1]),
            _ => 0,
        };
        let [width, height, _] = self.low_pass().extent.map(usize::cast_signed);
        let difference = |[x, y, z]: Place| {
            i64::from(self.coefficient([x.clamp(0, width - 1), y, z]).wrapping_sub(reference))
        };
        let row = |y, z, reach| (x - reach..=x + reach).map(move |x| [x, y, z]);
        let mut differences = vec![if x < 2 { 0 } else { difference([x - 2, y, z]) }];
        if y == 0 {
            differences.extend([0; 8]);
        } else {
            differences.extend(row(y - 1, z, 2).chain(row((y - 2).max(0), z, 1)).map(difference));
        }
        if z > 0 {
            let before = [y, (y - 1).max(0), (y + 1).min(height - 1)].map(|y| row(y, z - 1, 1));
            differences.extend(before.into_iter().flatten().map(difference));
            differences.push(difference([x, y, (z - 2).max(0)]));
        }
        let weights = if z == 0 { &weights.first[..] } else { &weights.others[..] };
        assert_eq!(weights.len(), differences.len());
        let sum: i64 = weights.iter().zip(differences).map(|(&weight, d)| i64::from(weight) * d).sum();
        reference.wrapping_add(((sum + 128) >> 8) as i32)
    }

    fn coefficient(&self, place: Place) -> i32 {
        self.coefficients[self.index(self.low_pass(), place).expect("a place of the low-pass part")]
    }
}

/// All places of a subband, x fastest, then y, then z.
fn places(subband: Subband) -> Vec<Place> {
    let [width, height, depth] = subband.extent.map(usize::cast_signed);
    let rows = (0..depth).flat_map(|z| (0..height).map(move |y| (y, z)));
    rows.flat_map(|(y, z)| (0..width).map(move |x| [x, y, z])).collect()
}

fn class(s: u64) -> usize {
    if s < 4 {
        return s as usize;
    }
    let o = s.ilog2();
    let h = s >> (o - 1) & 1;
    (2 * u64::from(o) + h).min(31) as usize
}

const fn plane(a: i32, b: i32, c: i32) -> i32 {
    a.wrapping_add(b).wrapping_sub(c)
}

fn median(a: i32, b: i32, c: i32) -> i32 {
    let mut three = [a, b, c];
    three.sort_unstable();
    three[1]
}
