//! The rows of one level in the memory of a decoder: those that the inverse transform works on, and details that wait.
//!
//! All take the bits that they need and no more. A row of details stays where it was decoded until the inverse transform
//! along y is done with it. What was decoded of the two pairs before is there still, where the next one's energies look
//! for it, but on the coarsest level, where pairs hardly wait, and with psi_H, where they leave together.

use super::fronts::inverse_rows;
use super::plan::{Role, RowPlan};
use super::spread;
use crate::Wavelet;
use crate::coder::{Above, Row};
use crate::extent::to_usize;
use crate::packed::{Packed, QUICK, ROUND};

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
    /// The shelf of a level that begins at `start`, in a decoder's memory, and how many words it takes.
    pub(super) const fn new(plan: &RowPlan, role: Role, (level, start): (u8, usize)) -> (Self, usize) {
        let (width, held) = (plan.width_at(level), plan.held(level));
        let [c, d] = inverse_rows(plan.wavelet());
        // Of the rows d that are worked on the newest waited before; its place is free again when the next pair comes.
        let slots = [c, held.saturating_add(d.saturating_sub(1)), held];
        let bits = match role {
            Role::FastDecoder if QUICK => u32::BITS,
            _ => spread::bits(plan.wavelet(), plan.sample_type(), level),
        };
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

    /// Columns of an orientation, 1 to 3.
    const fn columns(&self, orientation: u8) -> usize {
        if orientation == 2 { self.low() } else { self.high() }
    }

    /// Whether rows are unpacked to be decoded: if numbers take less than a word.
    const fn unpacks(&self) -> bool {
        QUICK && !self.rows.are_words()
    }

    /// The row of an orientation, 1 to 3, to be decoded, of the pair in these places: where [`Shelf::unpack`] put it, or
    /// where it waits.
    #[inline(always)]
    pub(super) fn band(&self, places: [u32; 2], orientation: u8) -> Row {
        let (high, width) = (self.high(), self.columns(orientation));
        let row = |orientation, back| self.details(places, orientation, back);
        let (values, north, siblings) = if self.unpacks() {
            let [values, north] = [0, width].map(Packed::words);
            (values, north, [(values, width), (values, 0)])
        } else {
            // No row of lower orientation has more columns than there are on the high side.
            let known = |lower| (row(lower, 0), if lower < orientation { high } else { 0 });
            (row(orientation, 0), row(orientation, 1), [known(1), known(2)])
        };
        let kept_before = match orientation {
            1 => 0,
            2 => high,
            _ => self.width,
        };
        let above = match self.above {
            Some(above) => Above::Kept(above.saturating_add(kept_before)),
            None => Above::Rows([north, row(orientation, 2)]),
        };
        Row { values, width, above, siblings, north: None, is_first: false }
    }

    /// Prepares the row of an orientation to be decoded where it is unpacked: a word a number in `scratch`, which precedes
    /// the `rest` of memory.
    ///
    /// First come sums of the magnitudes in the same columns of lower orientations, each where its coefficient will be, then
    /// the row above.
    pub(super) fn unpack(&self, places: [u32; 2], orientation: u8, (scratch, rest): (&mut [i32], &[i32])) {
        if !self.unpacks() {
            return;
        }
        let (start, width) = (scratch.len(), self.columns(orientation));
        let Some((sums, north)) = scratch.split_at_mut_checked(width) else { return };
        sums.fill(0);
        let (sums, _) = sums.split_at_mut_checked(self.high()).unwrap_or_default();
        for lower in 1..orientation {
            let known = self.details(places, lower, 0).after(start);
            for (x, sums) in (0..).step_by(ROUND).zip(sums.chunks_mut(ROUND)) {
                let mut numbers = [0; ROUND];
                known.skip(x).load(rest, &mut numbers);
                // Such numbers are so small that no sum of two reaches where magnitudes are capped.
                sums.iter_mut()
                    .zip(numbers)
                    .for_each(|(sum, number)| *sum = sum.wrapping_add(number.wrapping_abs()));
            }
        }
        if self.above.is_none() {
            self.details(places, orientation, 1)
                .after(start)
                .load(rest, north.get_mut(..width).unwrap_or_default());
        }
    }

    /// Puts the row of an orientation, decoded where [`Shelf::unpack`] prepared it, where it waits; `None` if a number takes
    /// more bits than there are for it.
    pub(super) fn pack(
        &self,
        places: [u32; 2],
        orientation: u8,
        (scratch, rest): (&[i32], &mut [i32]),
    ) -> Option<()> {
        if !self.unpacks() {
            return Some(());
        }
        let row = scratch.get(..self.columns(orientation))?;
        self.details(places, orientation, 0).after(scratch.len()).store(rest, row)
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
