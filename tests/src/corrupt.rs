//! Damage to codestreams, repeatable: the same seed, the same damage.

use crate::oracle::noise::Noise;

/// A way to damage a codestream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Some bits are the other way round.
    Flip,
    /// Some bytes are others, mostly extreme ones.
    Set,
    /// The end is missing.
    Truncate,
    /// Bytes are put in between.
    Insert,
    /// Bytes are taken out.
    Remove,
    /// It goes on as another codestream does.
    Splice,
    /// The first bytes stay, all others are random.
    Randomize,
    /// More bytes follow.
    Extend,
    /// Two parts of it have changed places.
    Swap,
}

impl Damage {
    /// Every way.
    pub const ALL: [Self; 9] = [
        Self::Flip,
        Self::Set,
        Self::Truncate,
        Self::Insert,
        Self::Remove,
        Self::Splice,
        Self::Randomize,
        Self::Extend,
        Self::Swap,
    ];

    /// Damages `bytes`, which are not empty; `other` is where a splice goes on.
    pub fn inflict(self, bytes: &mut Vec<u8>, other: &[u8], noise: &mut Noise) {
        let at = below(noise, bytes.len());
        match self {
            Self::Flip => {
                for _ in 0..=below(noise, 3) {
                    let at = below(noise, bytes.len());
                    bytes[at] ^= 1 << below(noise, 8);
                }
            }
            Self::Set => {
                for _ in 0..=below(noise, 3) {
                    let at = below(noise, bytes.len());
                    bytes[at] = byte(noise);
                }
            }
            Self::Truncate => bytes.truncate(at),
            Self::Insert => {
                let inserted: Vec<u8> = (0..=below(noise, 4)).map(|_| byte(noise)).collect();
                bytes.splice(at..at, inserted);
            }
            Self::Remove => {
                let end = bytes.len().min(at + 1 + below(noise, 4));
                bytes.drain(at..end);
            }
            Self::Splice => {
                bytes.truncate(at);
                bytes.extend_from_slice(&other[below(noise, other.len())..]);
            }
            Self::Randomize => bytes[at..].fill_with(|| noise.bits() as u8),
            Self::Extend => bytes.extend((0..=below(noise, 40)).map(|_| byte(noise))),
            Self::Swap => {
                let middle = at + below(noise, bytes.len() - at);
                let end = middle + below(noise, bytes.len() - middle);
                bytes[at..end].rotate_left(middle - at);
            }
        }
    }
}

/// A number below `bound`.
fn below(noise: &mut Noise, bound: usize) -> usize {
    ((u128::from(noise.bits()) * bound as u128) >> 64) as usize
}

/// A byte, every second one at an end of what a byte, or seven bits of one, can be.
fn byte(noise: &mut Noise) -> u8 {
    match below(noise, 8) {
        0 => 0x00,
        1 => 0x7F,
        2 => 0x80,
        3 => 0xFF,
        _ => noise.bits() as u8,
    }
}
