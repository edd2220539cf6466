//! Rank <-> decisions.
//!
//! A step is about as wide as the ranks around are large, so that most ranks are within the first.

use super::registers::{Quick, Registers};
use crate::coder::encoder::RAW_BITS;
use crate::extent::to_usize;

/// Classes of energies: 0, 1, and two an octave.
const CLASSES: usize = 64;

/// Steps that have a decision in each class; what is beyond has an exponent.
const STEPS: usize = 4;

/// Exponents but the largest: a decision each.
const EXPONENTS: usize = 31;

/// An energy is so many times as large as a step, as a power of 2.
const STEPS_OF_ENERGY: u32 = 3;

/// How slowly chances follow.
const RATE: u32 = 5;

/// All of a chance.
const SURE: u32 = 1 << 16;

/// The chance of true, 1 to 65535 in 1/65536, before anything is known.
const EVEN: u16 = 1 << 15;

/// The chances of a codestream: the state of the coder beside the interval.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Chances {
    steps: [[u16; STEPS]; CLASSES],
    exponents: [u16; EXPONENTS],
}

impl Chances {
    #[cfg_attr(
        not(any(feature = "light", test)),
        expect(dead_code, reason = "no build without asks for them")
    )]
    pub(crate) const NEW: Self = Self { steps: [[EVEN; STEPS]; CLASSES], exponents: [EVEN; EXPONENTS] };

    /// Codes a row of ranks, by their energies but for `share` times the rank before.
    pub(super) fn code_row<C: Quick>(
        &mut self,
        coder: &mut C,
        energies: &[i32],
        share: u32,
        row: &mut [i32],
    ) {
        let (mut registers, mut rank) = (coder.registers(), 0_u32);
        for (slot, energy) in row.iter_mut().zip(energies) {
            let energy = energy.cast_unsigned().wrapping_add(rank.wrapping_mul(share));
            rank = self.code(coder, &mut registers, energy, slot.cast_unsigned());
            *slot = rank.cast_signed();
        }
        coder.set_registers(registers);
    }

    /// Codes a rank.
    #[inline(always)]
    fn code<C: Quick>(&mut self, coder: &mut C, registers: &mut Registers, energy: u32, rank: u32) -> u32 {
        let (class, step_bits) = class(energy);
        let Some(chances) = self.steps.get_mut(class) else { return 0 };
        let steps = rank >> step_bits;
        let mut told = 0;
        for chance in chances {
            let before = u32::from(*chance);
            let decision = coder.decide_quickly(registers, steps == told, before);
            *chance = followed(before, decision);
            if decision {
                if step_bits == 0 {
                    return C::known(rank, told);
                }
                if step_bits <= RAW_BITS {
                    let place = coder.raw_quickly(registers, rank, step_bits);
                    return C::known(rank, (told << step_bits) | place);
                }
                break;
            }
            told = told.wrapping_add(1);
        }
        coder.set_registers(*registers);
        let rank = self.code_far(coder, told, step_bits, rank);
        *registers = coder.registers();
        rank
    }

    /// Codes a rank that has so many steps or more, or wide ones.
    #[cold]
    #[inline(never)]
    fn code_far<C: Quick>(&mut self, coder: &mut C, told: u32, step_bits: u32, rank: u32) -> u32 {
        let mut registers = coder.registers();
        let mut steps = told;
        if to_usize(told) == STEPS {
            let number = (rank >> step_bits).wrapping_sub(told).wrapping_add(1);
            let number = self.code_number(coder, &mut registers, number);
            steps = number.wrapping_add(told).wrapping_sub(1);
        }
        let place = bits(coder, &mut registers, rank, step_bits);
        coder.set_registers(registers);
        (steps << step_bits) | place
    }

    /// Codes a number above 0.
    fn code_number<C: Quick>(&mut self, coder: &mut C, registers: &mut Registers, number: u32) -> u32 {
        let exponent = number.checked_ilog2().unwrap_or(0);
        let mut told = 0;
        for chance in &mut self.exponents {
            let before = u32::from(*chance);
            let decision = coder.decide_quickly(registers, exponent == told, before);
            *chance = followed(before, decision);
            if decision {
                break;
            }
            told = told.wrapping_add(1);
        }
        (1 << told) | bits(coder, registers, number, told)
    }
}

/// Codes the `count` low bits of `bits`, of which there may be many.
fn bits<C: Quick>(coder: &mut C, registers: &mut Registers, bits: u32, count: u32) -> u32 {
    let (mut read, mut left) = (0, count);
    while left > 0 {
        let now = left.min(RAW_BITS);
        left = left.wrapping_sub(now);
        read = (read << now) | coder.raw_quickly(registers, bits >> left, now);
    }
    read
}

/// A chance after a decision, which it follows.
#[inline(always)]
fn followed(chance: u32, decision: bool) -> u16 {
    let chance = if decision {
        chance.wrapping_add(SURE.wrapping_sub(chance) >> RATE)
    } else {
        chance.wrapping_sub(chance >> RATE)
    };
    let [low, high, ..] = chance.to_le_bytes();
    u16::from_le_bytes([low, high])
}

/// The class of an energy, and the bits of its steps.
#[inline(always)]
fn class(energy: u32) -> (usize, u32) {
    if energy < 2 {
        return (to_usize(energy), 0);
    }
    let octave = energy.ilog2();
    let upper_half = (energy >> octave.wrapping_sub(1)) & 1;
    (to_usize(octave.wrapping_mul(2) | upper_half), octave.saturating_sub(STEPS_OF_ENERGY))
}

#[cfg(test)]
mod tests {
    use core::array;

    use super::*;
    use crate::coder::{Decoder, Encoder};

    #[test]
    fn two_classes_an_octave() {
        let classes = [0, 1, 2, 3, 4, 5, 6, 15, 16, 23, 24, u32::MAX].map(class);
        let expected =
            [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 0), (5, 0), (7, 0), (8, 1), (8, 1), (9, 1)];
        assert_eq!(classes[..11], expected);
        assert_eq!(classes[11], (CLASSES - 1, 28));
    }

    #[test]
    fn every_rank_comes_back_under_every_energy() {
        const RANKS: usize = 96;
        let ranks = || array::from_fn::<_, RANKS, _>(|i| (1_i32 << (i / 3)).wrapping_sub([0, 1, 2][i % 3]));
        let mut bytes = [0; 1024];
        for energy in ranks().map(i32::cast_unsigned) {
            let energies = [energy.cast_signed(); RANKS];
            let (mut chances, mut encoder) = (Chances::NEW, Encoder::new(&mut bytes));
            let mut row = ranks();
            chances.code_row(&mut encoder, &energies, 0, &mut row);
            assert_eq!(row, ranks());
            let len = encoder.finish().unwrap();
            let after = core::mem::replace(&mut chances, Chances::NEW);
            let mut decoder = Decoder::new(&bytes[..len]).unwrap();
            row.fill(0);
            chances.code_row(&mut decoder, &energies, 0, &mut row);
            assert_eq!(row, ranks());
            assert!(decoder.is_consumed());
            assert_eq!(chances, after);
        }
    }

    #[test]
    fn chances_stay_within_their_range() {
        for decision in [false, true] {
            let chance = (0..1000).fold(EVEN, |chance, _| followed(chance.into(), decision));
            assert_eq!(chance, if decision { 65_505 } else { 31 });
        }
    }
}
