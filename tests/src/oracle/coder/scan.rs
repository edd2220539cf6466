//! The order of the values, their classes, and the prediction of the low-pass part.

use super::header::{Choices, ceil_shift};

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
    predictor: u8,
    /// In Mallat order.
    coefficients: Vec<i32>,
    /// Remembered magnitude of the value coded for each coefficient.
    remembered: Vec<u64>,
}

impl Scan {
    pub(super) fn new(choices: &Choices, predictor: u8, coefficients: Vec<i32>) -> Self {
        let &Choices { extent, levels, .. } = choices;
        Self { extent, levels, predictor, remembered: vec![0; coefficients.len()], coefficients }
    }

    pub(super) fn into_coefficients(self) -> Vec<i32> {
        self.coefficients
    }

    /// Hands the class and value of everything in segment `resolution` to `code`, which returns the value: the one it
    /// was given when encoding, the one it has read when decoding.
    pub(super) fn resolution(&mut self, resolution: usize, mut code: impl FnMut(usize, i32) -> i32) {
        if resolution == 0 {
            let low_pass = Subband { origin: [0; 3], extent: ceil_shift(self.extent, self.levels) };
            for place in places(low_pass) {
                let prediction = self.prediction(place);
                let at = self.index(low_pass, place).expect("a place of the subband");
                let residual = self.coefficients[at].wrapping_sub(prediction);
                let residual = code(class(self.nearby(low_pass, place)), residual);
                self.coefficients[at] = prediction.wrapping_add(residual);
                self.remembered[at] = remembered_magnitude(residual);
            }
            return;
        }
        let level = self.levels - resolution;
        for orientation in 1..8 {
            let subband = self.subband(level, orientation);
            for place in places(subband) {
                let s = self.nearby(subband, place) + self.hint(level, orientation, place);
                let at = self.index(subband, place).expect("a place of the subband");
                self.coefficients[at] = code(class(s), self.coefficients[at]);
                self.remembered[at] = remembered_magnitude(self.coefficients[at]);
            }
        }
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

    /// Remembered magnitude at a place of a subband, 0 beyond its borders.
    fn magnitude(&self, subband: Subband, place: Place) -> u64 {
        self.index(subband, place).map_or(0, |at| self.remembered[at])
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
    fn prediction(&self, [x, y, z]: Place) -> i32 {
        let u = if z == 0 { 0 } else { self.low_pass([x, y, z - 1]) };
        let [w, n, nw] = self.neighbours([x, y, z], u);
        if z == 0 {
            return median(w, n, plane(w, n, nw));
        }
        let [uw, un, unw] = self.neighbours([x, y, z - 1], u);
        match self.predictor {
            0 => median(w, n, plane(w, n, nw)),
            1 => u,
            2 => median(plane(w, n, nw), plane(w, u, uw), plane(u, n, un)),
            3 => {
                let (w, n, nw) = (w.wrapping_sub(uw), n.wrapping_sub(un), nw.wrapping_sub(unw));
                u.wrapping_add(median(w, n, plane(w, n, nw)))
            }
            4 => w.wrapping_add(n).wrapping_add(u).div_euclid(3),
            _ => unreachable!("a header announces the predictors 0 to 4 alone"),
        }
    }

    /// w, n and nw of a place in its plane, replaced where they do not exist.
    fn neighbours(&self, [x, y, z]: Place, fallback: i32) -> [i32; 3] {
        let w = match (x > 0, y > 0) {
            (true, _) => self.low_pass([x - 1, y, z]),
            (false, true) => self.low_pass([x, y - 1, z]),
            (false, false) => fallback,
        };
        let n = if y > 0 { self.low_pass([x, y - 1, z]) } else { w };
        let nw = match (x > 0, y > 0) {
            (true, true) => self.low_pass([x - 1, y - 1, z]),
            (false, true) => n,
            (_, false) => w,
        };
        [w, n, nw]
    }

    fn low_pass(&self, place: Place) -> i32 {
        let whole = Subband { origin: [0; 3], extent: self.extent };
        self.coefficients[self.index(whole, place).expect("a place of the low-pass part")]
    }
}

/// All places of a subband, x fastest, then y, then z.
fn places(subband: Subband) -> Vec<Place> {
    let [width, height, depth] = subband.extent.map(usize::cast_signed);
    let rows = (0..depth).flat_map(|z| (0..height).map(move |y| (y, z)));
    rows.flat_map(|(y, z)| (0..width).map(move |x| [x, y, z])).collect()
}

fn remembered_magnitude(value: i32) -> u64 {
    u64::from(value.unsigned_abs()).min(1 << 22)
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
