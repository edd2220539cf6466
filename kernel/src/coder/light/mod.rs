//! Residuals in a few decisions each, for processors to which every instruction counts: how many steps from zero, where
//! the residuals around tell how wide a step is, and the place within the step.
//!
//! All is in place: an encoder makes ranks of all residuals, and codes them afterwards; a decoder reads the ranks of a
//! resolution, and makes coefficients of them. So what is known around a rank is other ranks where they lie, and takes no
//! memory.
//!
//! The format is in `docs/light.md`. Sources: Golomb, *Run-length encodings*, 1966, and Rice, *Some practical universal
//! noiseless coding techniques*, 1979, for steps; Marpe, Schwarz and Wiegand, *Context-based adaptive binary arithmetic
//! coding in the H.264/AVC video compression standard*, 2003, for decisions under chances that adapt.

mod around;
mod chances;
mod registers;

use self::around::Around;
pub(crate) use self::chances::Chances;
use self::registers::Quick;
use super::forecast::{Forecast, Zero};
use super::rank::{of_rank, rank};
use super::weightless::{Fixed, FixedRow, RowsBefore};
use crate::lifting::Direction;
use crate::transform::{Plan, Subband};

/// One subband: its coefficients, or the ranks of their residuals.
#[derive(Debug)]
pub(crate) struct Band<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) subband: Subband,
    /// Those of all subbands.
    pub(crate) values: &'a mut [i32],
}

impl Band<'_> {
    /// Makes ranks of coefficients; `fixed` predicts the low-pass part.
    pub(crate) fn make_ranks(&mut self, fixed: Fixed) {
        // The last row first: what the others are predicted from is still there.
        for place in self.subband.rows().rev() {
            self.change_row(place, fixed, Direction::Forward);
        }
    }

    /// Undoes [`Band::make_ranks`].
    pub(crate) fn make_coefficients(&mut self, fixed: Fixed) {
        for place in self.subband.rows() {
            self.change_row(place, fixed, Direction::Inverse);
        }
    }

    fn change_row(&mut self, place: [usize; 2], fixed: Fixed, direction: Direction) {
        let (plan, subband) = (self.plan, self.subband);
        let Some((before, row)) = self.split_at_row(place) else { return };
        if subband.orientation == 0 {
            let before = RowsBefore::new(plan, subband, place, before);
            change(row, FixedRow::new(fixed, before), direction);
        } else {
            change(row, Zero, direction);
        }
    }

    /// Runs either direction of the coder over the ranks.
    pub(crate) fn code<C: Quick>(&mut self, coder: &mut C, chances: &mut Chances, scratch: &mut [i32]) {
        let (plan, subband) = (self.plan, self.subband);
        for place in subband.rows() {
            let Some((before, row)) = self.split_at_row(place) else { return };
            let around = Around::new(plan, subband, place, before);
            let Some(energies) = scratch.get_mut(..row.len()) else { return };
            around.energies(energies);
            chances.code_row(coder, energies, around.share_of_west(), row);
        }
    }

    /// Row `y` of plane `z`, and all that lies before it.
    fn split_at_row(&mut self, [y, z]: [usize; 2]) -> Option<(&[i32], &mut [i32])> {
        let [width, _, _] = self.subband.sides;
        let (before, row) = self.values.split_at_mut_checked(self.subband.row(self.plan, y, z))?;
        Some((before, row.get_mut(..width)?))
    }
}

/// Makes ranks of the coefficients of a row, or coefficients of ranks.
fn change(row: &mut [i32], mut forecast: impl Forecast, direction: Direction) {
    for (x, value) in row.iter_mut().enumerate() {
        let expected = forecast.expected(x).value;
        let (coefficient, changed) = match direction {
            Direction::Forward => (*value, rank(value.wrapping_sub(expected))),
            Direction::Inverse => {
                let coefficient = expected.wrapping_add(of_rank(*value));
                (coefficient, coefficient)
            }
        };
        forecast.push(coefficient);
        *value = changed;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Decoder, Encoder};
    use super::*;
    use crate::{Extent, Wavelet};

    /// Coefficients of every size, in every place.
    fn coefficients(count: usize) -> impl Iterator<Item = i32> {
        (0..count).map(|i| {
            let noise = u32::try_from(i).unwrap().wrapping_mul(0x9E37_79B1);
            let value = (noise ^ noise >> 15).wrapping_mul(0x2C1B_3C6D).cast_signed();
            value >> (noise >> 27)
        })
    }

    #[test]
    fn every_coefficient_comes_back() {
        for (axes, levels) in [([7, 1, 1], 0), ([5, 4, 1], 1), ([4, 3, 5], 0), ([6, 5, 4], 2)] {
            let plan = Plan::new(Wavelet::Linear, Extent::new(axes).unwrap(), levels).unwrap();
            let len = plan.extent().samples();
            for fixed in Fixed::ALL {
                let mut values = [0; 128];
                values.iter_mut().zip(coefficients(len)).for_each(|(value, noise)| *value = noise);
                let original = values;
                let subbands = || (0..=levels).flat_map(|resolution| plan.subbands(resolution));
                let mut bytes = [0; 1024];
                let mut encoder = Encoder::new(&mut bytes);
                let mut chances = Chances::NEW;
                for subband in subbands() {
                    let mut band = Band { plan: &plan, subband, values: &mut values };
                    band.make_ranks(fixed);
                    band.code(&mut encoder, &mut chances, &mut [0; 8]);
                }
                let written = encoder.finish().unwrap();
                values.fill(0);
                let mut decoder = Decoder::new(&bytes[..written]).unwrap();
                chances = Chances::NEW;
                for subband in subbands() {
                    let mut band = Band { plan: &plan, subband, values: &mut values };
                    band.code(&mut decoder, &mut chances, &mut [0; 8]);
                    band.make_coefficients(fixed);
                }
                assert!(decoder.is_consumed());
                assert_eq!(values, original);
            }
        }
    }
}
