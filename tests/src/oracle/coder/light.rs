//! Light codestreams, from `kernel/docs/light.md`: every rank looks for those around it anew.

use super::arithmetic::{Decoder, Encoder};
use super::array::{Array, Place};
use super::header::Reject;
use super::predict::{Predictor, Scene};
use super::value::{rank, unrank};

/// Where decisions and runs of bits go to, or come from.
pub(super) trait Decisions {
    /// A decision, `known` if it is known.
    fn decide(&mut self, chance: u64, known: bool) -> bool;

    /// A run of `count` bits, the low ones of `known` if they are known.
    fn run(&mut self, count: u32, known: u32) -> u32;
}

impl Decisions for Encoder {
    fn decide(&mut self, chance: u64, known: bool) -> bool {
        self.light_decision(chance, known);
        known
    }

    fn run(&mut self, count: u32, known: u32) -> u32 {
        self.light_run(count, known.into());
        known & low_bits(count)
    }
}

impl Decisions for Decoder<'_> {
    fn decide(&mut self, chance: u64, _: bool) -> bool {
        self.light_decision(chance)
    }

    fn run(&mut self, count: u32, _: u32) -> u32 {
        self.light_run(count) as u32
    }
}

fn low_bits(count: u32) -> u32 {
    ((1_u64 << count) - 1) as u32
}

/// All chances of a codestream.
#[derive(Debug)]
pub(super) struct Chances {
    steps: [[u64; 4]; 64],
    exponents: [u64; 31],
}

impl Chances {
    pub(super) const fn new() -> Self {
        Self { steps: [[1 << 15; 4]; 64], exponents: [1 << 15; 31] }
    }

    fn code(&mut self, coder: &mut impl Decisions, energy: u32, r: u32) -> u32 {
        let (class, k) = match energy {
            0 | 1 => (energy, 0),
            _ => {
                let o = energy.ilog2();
                (2 * o + (energy >> (o - 1) & 1), o.saturating_sub(3))
            }
        };
        let q = r >> k;
        let chances = &mut self.steps[class as usize];
        let told = (0..4).find(|&i| decision(coder, &mut chances[i as usize], q == i));
        let q = told.unwrap_or_else(|| {
            let n = q.wrapping_sub(3);
            let known = n.checked_ilog2().unwrap_or(0);
            let exponents = &mut self.exponents;
            let f = (0..31).find(|&i| decision(coder, &mut exponents[i as usize], known == i)).unwrap_or(31);
            ((1 << f) | coder.run(f, n)).wrapping_add(3)
        });
        ((u64::from(q) << k) as u32) | coder.run(k, r)
    }
}

/// The predictor of the low-pass part.
pub(super) fn predictor(from: &mut Decoder<'_>) -> Result<Predictor, Reject> {
    match from.raw(3) {
        number @ 0..=4 => Ok(Predictor::Fixed(number as u8)),
        _ => Err(Reject::Segment),
    }
}

fn decision(coder: &mut impl Decisions, c: &mut u64, known: bool) -> bool {
    let is_true = coder.decide(*c, known);
    *c = if is_true { *c + ((65536 - *c) >> 5) } else { *c - (*c >> 5) };
    is_true
}

/// Codes one subband of a level; coefficients that are not known become what the segment says.
pub(super) fn subband(
    coder: &mut impl Decisions,
    chances: &mut Chances,
    level: &mut [Array],
    orientation: usize,
    predictor: &Predictor,
) {
    if level[orientation].is_empty() {
        return;
    }
    let places = level[orientation].places();
    let prediction =
        |level: &[Array], place| Scene { level, orientation, narrow: true }.predict(predictor, place).p;
    let mut ranks = Array::zeros(level[orientation].extent);
    for &place in &places {
        let residual = level[orientation].at(place).wrapping_sub(prediction(level, place));
        ranks.set(place, rank(residual) as i32);
    }
    for &place in &places {
        let known = ranks.at(place) as u32;
        ranks.set(place, chances.code(coder, energy(&ranks, place), known) as i32);
    }
    for &place in &places {
        let value = prediction(level, place).wrapping_add(unrank(ranks.at(place) as u32));
        level[orientation].set(place, value);
    }
}

fn energy(ranks: &Array, [x, y, z]: Place) -> u32 {
    let at = |x, y, z| ranks.get([x, y, z]).map(|rank| rank as u32);
    let w = at(x - 1, y, z).unwrap_or(0);
    if y == 0 && z == 0 {
        return w.wrapping_mul(8);
    }
    let n = |x| at(x, y - 1, z).or(at(x, y, z - 1)).expect("a row is known");
    let u = |x| at(x, y, z - 1).or(at(x, y - 1, z)).expect("a row is known");
    let last = ranks.extent[0].cast_signed() - 1;
    let s = |x: isize| n(x.clamp(0, last)).wrapping_add(u(x.clamp(0, last)));
    let south = at(x, y + 1, z - 1).unwrap_or_else(|| u(x));
    let terms = [s(x - 1), s(x), s(x), s(x + 1), south, w, w];
    terms.into_iter().fold(0, u32::wrapping_add)
}
