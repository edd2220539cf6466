//! Whole numbers under adaptive chances.

use wavelift_kernel::bits::{BitCoder, Chance};

/// Bits of the largest number.
const BITS: usize = 32;

/// Chances of a kind of number: of its length in bits, one by one, and of the bit below the first.
#[derive(Clone, Debug)]
pub(super) struct Number {
    longer: [Chance; BITS + 1],
    second: [Chance; BITS + 1],
    sign: Chance,
}

impl Number {
    pub(super) const NEW: Self =
        Self { longer: [Chance::EVEN; BITS + 1], second: [Chance::EVEN; BITS + 1], sign: Chance::EVEN };

    /// Codes a number: the length of it plus one in unary, then its bits.
    pub(super) fn code(&mut self, coder: &mut impl BitCoder, number: u32) -> u32 {
        let given = u64::from(number) + 1;
        let given_length = given.ilog2() as usize;
        let mut length = 0;
        while length < BITS && coder.bit(length < given_length, &mut self.longer[length]) {
            length += 1;
        }
        let mut value = 1_u64;
        for place in (0..length).rev() {
            let bit = given >> place & 1 == 1;
            let bit = if place + 1 == length {
                coder.bit(bit, &mut self.second[length])
            } else {
                coder.decide(bit, 1 << 15)
            };
            value = value << 1 | u64::from(bit);
        }
        (value - 1).min(u64::from(u32::MAX)) as u32
    }

    /// Codes a number with a sign.
    pub(super) fn code_signed(&mut self, coder: &mut impl BitCoder, number: i32) -> i32 {
        let magnitude = self.code(coder, number.unsigned_abs()).min(i32::MAX as u32) as i32;
        if magnitude != 0 && coder.bit(number < 0, &mut self.sign) { -magnitude } else { magnitude }
    }
}

/// Codes the `count` low bits of a number as they are.
pub(super) fn code_plain(coder: &mut impl BitCoder, number: u32, count: u32) -> u32 {
    (0..count)
        .rev()
        .fold(0, |value, place| value << 1 | u32::from(coder.decide(number >> place & 1 == 1, 1 << 15)))
}

#[cfg(test)]
mod tests {
    use wavelift_kernel::bits::{BitDecoder, BitEncoder};

    use super::*;

    #[test]
    fn numbers_are_restored() {
        let numbers = [0, 1, 2, 3, 4, 100, -1, -7, 65_535, i32::MAX, -i32::MAX, 0];
        let mut bytes = [0; 128];
        let mut encoder = BitEncoder::new(&mut bytes);
        let mut model = Number::NEW;
        for number in numbers {
            model.code_signed(&mut encoder, number);
            code_plain(&mut encoder, number.cast_unsigned(), 20);
        }
        let len = encoder.finish().unwrap();
        let (mut decoder, mut model) = (BitDecoder::new(&bytes[..len]), Number::NEW);
        for number in numbers {
            assert_eq!(model.code_signed(&mut decoder, 0), number);
            assert_eq!(code_plain(&mut decoder, 0, 20), number.cast_unsigned() & 0xF_FFFF);
        }
    }
}
