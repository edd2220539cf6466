//! The rows of one level in the memory of a decoder: those that the inverse transform works on, and details that wait.
//!
//! All take the bits that they need and no more. A row of details stays where it was decoded until the inverse transform
//! along y is done with it. What was decoded of the two pairs before is there still, where the next one's energies look
//! for it, but on the coarsest level, where pairs hardly wait, and with psi_H, where they leave together.

use super::fronts::inverse_rows;
use super::plan::RowPlan;
use super::spread;
use crate::Wavelet;
use crate::coder::{Above, Row};
use crate::extent::to_usize;
use crate::packed::Packed;

/// Where the rows of one level are: in turn rows c, rows d, the parts of rows c that are high along x, of pairs that
/// wait, and what is kept of rows above.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shelf {
    rows: Packed,
    width: usize,
    /// How many rows c there are, rows d, and parts of rows c that wait.
    slots: [usize; 3],
    above: Option<usize>,
}

impl Shelf {
    /// The shelf of a level that begins at `start`, and how many words it takes.
    pub(super) const fn new(plan: &RowPlan, level: u8, start: usize) -> (Self, usize) {
        let (width, held) = (plan.width_at(level), plan.held(level));
        let [c, d] = inverse_rows(plan.wavelet());
        // Of the rows d that are worked on the newest waited before; its place is free again when the next pair comes.
        let slots = [c, held.saturating_add(d.saturating_sub(1)), held];
        let bits = spread::bits(plan.wavelet(), plan.sample_type(), level);
        let numbers = width.saturating_mul(slots[0].saturating_add(slots[1]));
        let numbers = numbers.saturating_add((width / 2).saturating_mul(held));
        let len = Packed::len(numbers, bits);
        let keeps = matches!(plan.wavelet(), Wavelet::Haar) || level.wrapping_add(1) == plan.levels();
        let above = if keeps { Some(start.saturating_add(len)) } else { None };
        let kept = if keeps { width.saturating_add(width / 2) } else { 0 };
        (Self { rows: Packed::new(start, bits), width, slots, above }, len.saturating_add(kept))
    }

    /// Columns that are low along x.
    const fn low(&self) -> usize {
        self.width.div_ceil(2)
    }

    /// Columns that are high along x.
    const fn high(&self) -> usize {
        self.width / 2
    }

    pub(super) const fn width(&self) -> usize {
        self.width
    }

    /// Where row c of that number is, in the order of their arrival.
    pub(super) fn c(&self, number: usize) -> Packed {
        let [count, _, _] = self.slots;
        self.row(number.checked_rem(count).unwrap_or(0))
    }

    /// The row d that lies `back` before a place; places beyond the last begin again.
    pub(super) fn d(&self, place: u32, back: usize) -> Packed {
        let [c, count, _] = self.slots;
        self.row(c.saturating_add(turn(count, place, back)))
    }

    /// The details of an orientation, 1 to 3, of the pair that lies `back` before the one in these places.
    #[cfg_attr(feature = "small", inline(never))]
    fn details(&self, [d, high_of_c]: [u32; 2], orientation: u8, back: usize) -> Packed {
        let [c, ds, count] = self.slots;
        match orientation {
            1 => {
                self.row(c.saturating_add(ds)).skip(turn(count, high_of_c, back).saturating_mul(self.high()))
            }
            2 => self.d(d, back),
            _ => self.d(d, back).skip(self.low()),
        }
    }

    fn row(&self, slot: usize) -> Packed {
        self.rows.skip(slot.saturating_mul(self.width))
    }

    /// The places after these, of a row d and of a part of a row c.
    pub(super) fn next(&self, [d, high]: [u32; 2]) -> [u32; 2] {
        let [_, ds, highs] = self.slots;
        let next = |count, place: u32| {
            let next = place.wrapping_add(1);
            if to_usize(next) < count { next } else { 0 }
        };
        [next(ds, d), next(highs, high)]
    }

    /// The row of an orientation, 1 to 3, to be decoded, of the pair in these places.
    pub(super) fn band(&self, places: [u32; 2], orientation: u8) -> Row {
        let (low, high) = (self.low(), self.high());
        let (width, before, siblings) = match orientation {
            1 => (high, 0, [0, 0]),
            2 => (low, high, [high, 0]),
            _ => (high, self.width, [high, low]),
        };
        let row = |orientation, back| self.details(places, orientation, back);
        let above = match self.above {
            Some(above) => Above::Kept(above.saturating_add(before)),
            None => Above::Rows([row(orientation, 1), row(orientation, 2)]),
        };
        let [first, second] = siblings;
        let siblings = [(row(1, 0), first), (row(2, 0), second)];
        Row { values: row(orientation, 0), width, above, siblings, north: None, is_first: false }
    }

    /// Moves the part that is high along x, of the pair in these places, into row c of that number, and returns where that begins.
    pub(super) fn assemble(&self, places: [u32; 2], number: usize, memory: &mut [i32]) -> Option<Packed> {
        let c = self.c(number);
        self.details(places, 1, 0).copy_to(c.skip(self.low()), self.high(), memory)?;
        Some(c)
    }
}

/// The place `back` before another of so many, which may be counted on beyond the last.
fn turn(count: usize, place: u32, back: usize) -> usize {
    let place = to_usize(place).wrapping_add(count).wrapping_sub(back);
    place.checked_rem(count).unwrap_or(0)
}
