//! The arithmetic coder for decisions in quick succession: its interval is held beside it, in registers.

use crate::coder::encoder::MIN_RANGE;
use crate::coder::{Coder, Decoder, Encoder, low_bits};

/// The part of an interval that stands for true under `chance`: neither nothing nor all of it.
#[inline(always)]
const fn share(range: u32, chance: u32) -> u32 {
    (range >> 16).wrapping_mul(chance)
}

/// The interval of a coder: where it begins, or how far into it the codeword points, and how long it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Registers {
    pub(crate) point: u32,
    pub(crate) range: u32,
}

/// A coder that can do without its interval for a while.
pub(crate) trait Quick: Coder {
    /// Its interval.
    fn registers(&self) -> Registers;

    /// Gives it back.
    fn set_registers(&mut self, registers: Registers);

    /// What is known now: what an encoder was given, or a decoder has read.
    fn known(given: u32, read: u32) -> u32;

    /// As [`Coder::decide`].
    fn decide_quickly(&mut self, registers: &mut Registers, decision: bool, chance: u32) -> bool;

    /// As [`Coder::raw`], of at most [`RAW_BITS`] bits.
    fn raw_quickly(&mut self, registers: &mut Registers, bits: u32, count: u32) -> u32;
}

impl Quick for Encoder<'_> {
    #[inline(always)]
    fn registers(&self) -> Registers {
        Registers { point: self.low, range: self.range }
    }

    #[inline(always)]
    fn set_registers(&mut self, registers: Registers) {
        (self.low, self.range) = (registers.point, registers.range);
    }

    #[inline(always)]
    fn known(given: u32, _: u32) -> u32 {
        given
    }

    #[inline(always)]
    fn decide_quickly(&mut self, registers: &mut Registers, decision: bool, chance: u32) -> bool {
        let share = share(registers.range, chance);
        if decision {
            registers.range = share;
        } else {
            self.move_up(registers, share);
            registers.range = registers.range.wrapping_sub(share);
        }
        self.renormalize_quickly(registers);
        decision
    }

    #[inline(always)]
    fn raw_quickly(&mut self, registers: &mut Registers, bits: u32, count: u32) -> u32 {
        let largest = low_bits(count);
        let part = bits & largest;
        let unit = registers.range >> count;
        let below = unit.wrapping_mul(part);
        self.move_up(registers, below);
        registers.range = unit;
        self.renormalize_quickly(registers);
        part
    }
}

impl Encoder<'_> {
    #[inline(always)]
    fn move_up(&mut self, registers: &mut Registers, offset: u32) {
        let (low, carry) = registers.point.overflowing_add(offset);
        registers.point = low;
        if carry {
            self.carry();
        }
    }

    #[inline(always)]
    fn renormalize_quickly(&mut self, registers: &mut Registers) {
        if registers.range < MIN_RANGE {
            *registers = self.shifted_out(*registers);
        }
    }

    #[inline(never)]
    fn shifted_out(&mut self, Registers { mut point, mut range }: Registers) -> Registers {
        while range < MIN_RANGE {
            let [byte, ..] = point.to_be_bytes();
            self.shift_out(byte);
            point <<= 8;
            range <<= 8;
        }
        Registers { point, range }
    }
}

impl Quick for Decoder<'_> {
    #[inline(always)]
    fn registers(&self) -> Registers {
        Registers { point: self.code, range: self.range }
    }

    #[inline(always)]
    fn set_registers(&mut self, registers: Registers) {
        (self.code, self.range) = (registers.point, registers.range);
    }

    #[inline(always)]
    fn known(_: u32, read: u32) -> u32 {
        read
    }

    #[inline(always)]
    fn decide_quickly(&mut self, registers: &mut Registers, _: bool, chance: u32) -> bool {
        let share = share(registers.range, chance);
        let decision = registers.point < share;
        if decision {
            registers.range = share;
        } else {
            registers.point = registers.point.wrapping_sub(share);
            registers.range = registers.range.wrapping_sub(share);
        }
        self.renormalize_quickly(registers);
        decision
    }

    #[inline(always)]
    fn raw_quickly(&mut self, registers: &mut Registers, _: u32, count: u32) -> u32 {
        let largest = low_bits(count);
        let unit = registers.range >> count;
        let part = registers.point.checked_div(unit).unwrap_or(0) & largest;
        let below = unit.wrapping_mul(part);
        registers.point = registers.point.wrapping_sub(below);
        registers.range = unit;
        self.renormalize_quickly(registers);
        part
    }
}

impl Decoder<'_> {
    #[inline(always)]
    fn renormalize_quickly(&mut self, registers: &mut Registers) {
        while registers.range < MIN_RANGE {
            let byte = self.bytes.get(self.taken).copied().unwrap_or(0);
            self.taken = self.taken.wrapping_add(1);
            registers.point = (registers.point << 8) | u32::from(byte);
            registers.range <<= 8;
        }
    }
}
