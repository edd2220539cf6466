//! Residual <-> decisions, and the chances of each.
//!
//! A residual is zero or not, negative or not, and has a magnitude: its octave in unary, two bits below its leading
//! one, the others as they are. Where residuals are large their lowest bits are split off first. Each decision has a
//! counter in every one of five contexts, and a mixer.

use super::neighbours::BRICK;
use crate::coder::mixing::{Counter, Mixer};
use crate::coder::{Coder, low_bits};
use crate::extent::to_usize;

/// Fraction bits of predictions and of errors.
pub(super) const FRACTION_BITS: u32 = 4;

/// Classes of energies, four an octave from the first four on; those beyond the last share the last octave.
const CLASSES: usize = 40;

/// Distances of a prediction from the nearest integer, in 1/16: the last also for 8.
const FRACTIONS: usize = 8;

/// Classes of how far neighbours are from the prediction, four an octave.
const TEXTURES: usize = 40;

/// Classes of three errors by their sign: negative, about zero, positive.
const SIGNS: usize = 27;

/// Classes of energies that signs are told apart by, an octave each.
const SIGN_CLASSES: usize = 9;

/// Classes of three errors by sign and magnitude.
const STEPS: usize = 7 * 7 * 7;

/// Parts of the range of the samples that a prediction may fall into.
const LEVELS: usize = 64;

/// Classes of energies that levels are told apart by, two octaves each.
const LEVEL_CLASSES: usize = 4;

/// Classes of energies with mixers of their own, two octaves each.
const MIXER_CLASSES: usize = 5;

/// Classes of energies with mantissas of their own, an octave each.
const MANTISSA_CLASSES: usize = 10;

/// Octaves of magnitudes that mantissas are told apart by.
const OCTAVES: usize = 8;

/// Numbers of low bits that are told apart.
const LOW_BITS: usize = 16;

/// Decisions with counters of their own: whether zero, whether negative, and octaves, the last for all larger ones.
const NODES: usize = 8;

/// The node of the first octave.
const OCTAVE_NODE: usize = 2;

/// Decisions with mixers of their own.
const MIXED_NODES: usize = 16;

/// Contexts of a decision.
const CONTEXTS: usize = 5;

/// What every mixer is given beside the odds of the counters.
const BIAS: i32 = 64;

/// The weights that mixers start from, in 1/65536.
const FIRST_WEIGHT: i32 = 19_000;

/// Energy bits above which low bits of residuals are split off.
const WHOLE_BITS: u32 = 6;

type Nodes = [Counter; NODES];
type Mixers = [Mixer<{ CONTEXTS + 1 }>; MIXED_NODES];

/// All that is learnt about residuals.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Models {
    energies: [[Nodes; FRACTIONS]; CLASSES],
    signs: [[Nodes; SIGN_CLASSES]; SIGNS],
    textures: [[Nodes; FRACTIONS]; TEXTURES],
    steps: [Nodes; STEPS],
    levels: [[Nodes; LEVEL_CLASSES]; LEVELS],
    mixers: [Mixers; MIXER_CLASSES],
    /// The highest bit below the leading one, and the next, after 0 and after 1.
    mantissas: [[[Counter; 4]; OCTAVES]; MANTISSA_CLASSES],
    /// The highest low bit, by the magnitude above it.
    lows: [[Counter; 4]; LOW_BITS],
}

/// A counter of memory that is not in use.
const BLANK: Counter = Counter::expecting(0, 0);

impl Models {
    /// Memory that can be the value of a `static`; [`Models::reset`] comes first.
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(super) const BLANK: Self = Self {
        energies: [[[BLANK; NODES]; FRACTIONS]; CLASSES],
        signs: [[[BLANK; NODES]; SIGN_CLASSES]; SIGNS],
        textures: [[[BLANK; NODES]; FRACTIONS]; TEXTURES],
        steps: [[BLANK; NODES]; STEPS],
        levels: [[[BLANK; NODES]; LEVEL_CLASSES]; LEVELS],
        mixers: [[Mixer::new(0); MIXED_NODES]; MIXER_CLASSES],
        mantissas: [[[BLANK; 4]; OCTAVES]; MANTISSA_CLASSES],
        lows: [[BLANK; 4]; LOW_BITS],
    };

    /// Makes everything what a brick starts from.
    pub(super) fn reset(&mut self) {
        for (class, all) in self.energies.iter_mut().enumerate() {
            all.fill(expected(class, 8));
        }
        for all in &mut self.signs {
            for (octave, nodes) in all.iter_mut().enumerate() {
                *nodes = expected(octave.wrapping_mul(4).wrapping_add(2), 2);
            }
        }
        for (class, all) in self.textures.iter_mut().enumerate() {
            all.fill(expected(class, 3));
        }
        self.steps.as_flattened_mut().fill(Counter::NEW);
        self.levels.as_flattened_mut().as_flattened_mut().fill(Counter::NEW);
        self.mixers.as_flattened_mut().fill(Mixer::new(FIRST_WEIGHT));
        self.mantissas.as_flattened_mut().as_flattened_mut().fill(Counter::NEW);
        self.lows.as_flattened_mut().fill(Counter::NEW);
    }

    /// What is known of a residual: what is `known` before its row, the prediction in 1/16 of a span that begins at 0,
    /// the samples `nearest` and the errors around. `None` never happens: every class is in its range.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn expect(
        &mut self,
        (known, level_bits): (u8, u32),
        prediction: i32,
        nearest: [i32; 4],
        errors: &Errors,
    ) -> Option<Expected<'_>> {
        let energy = errors.energy(known);
        let class = energy_class(energy);
        let rounded = prediction.wrapping_add(1 << (FRACTION_BITS - 1));
        let value = rounded >> FRACTION_BITS;
        let offset = (rounded & 0xF).wrapping_sub(1 << (FRACTION_BITS - 1));
        let leans_down = offset < 0;
        let fraction = to_usize(offset.unsigned_abs().min(7));
        let far = nearest.iter().map(|near| (near << FRACTION_BITS).abs_diff(prediction));
        let texture = quarter_octave(far.fold(0, u32::wrapping_add) >> 3).min(TEXTURES - 1);
        let last = if known == BRICK { errors.up } else { errors.north_east };
        let three = [errors.west, errors.north, last]
            .map(|error| if leans_down { error.wrapping_neg() } else { error });
        let level = to_usize((value >> level_bits).clamp(0, LARGEST_LEVEL).cast_unsigned());
        let nodes = [
            self.energies.get_mut(class)?.get_mut(fraction)?,
            self.signs.get_mut(joined(three.map(sign), 3))?.get_mut((class >> 2).min(SIGN_CLASSES - 1))?,
            self.textures.get_mut(texture)?.get_mut(fraction)?,
            self.steps.get_mut(joined(three.map(step), 7))?,
            self.levels.get_mut(level)?.get_mut((class >> 3).min(LEVEL_CLASSES - 1))?,
        ];
        let low_bits = energy.checked_ilog2().unwrap_or(0).saturating_sub(WHOLE_BITS);
        Some(Expected {
            value,
            leans_down,
            low_bits,
            nodes,
            mixers: self.mixers.get_mut(class >> 3)?,
            mantissas: self.mantissas.get_mut(class >> 2)?,
            lows: self.lows.get_mut(to_usize(low_bits).min(LOW_BITS - 1))?,
        })
    }
}

/// [`LEVELS`] - 1.
const LARGEST_LEVEL: i32 = 63;
const _: () = assert!(to_usize(LARGEST_LEVEL.cast_unsigned()) == LEVELS - 1);

/// Errors of predictions around a sample, in 1/16.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    pub(super) west: i32,
    pub(super) north: i32,
    pub(super) up: i32,
    pub(super) north_east: i32,
    /// North-west, east and south of up, and the second to the west.
    pub(super) others: [i32; 4],
}

impl Errors {
    /// About the size of the next error, in 1/16, times 1.03 or so.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn energy(&self, known: u8) -> u32 {
        let size = |error: &i32| error.unsigned_abs();
        let near = [self.west, self.north, self.up].iter().map(size).fold(0, u32::wrapping_add);
        let others = self.others.iter().map(size).fold(size(&self.north_east), u32::wrapping_add);
        let sum = u64::from(near.wrapping_mul(4).wrapping_add(others.wrapping_mul(2)));
        let [a, b, c, d, ..] = (sum.wrapping_mul(if known == BRICK { 47 } else { 73 }) >> 10).to_le_bytes();
        u32::from_le_bytes([a, b, c, d])
    }
}

/// 0 to 3, then four classes an octave.
#[cfg_attr(not(feature = "small"), inline(always))]
fn quarter_octave(size: u32) -> usize {
    let octave = 29_u32.wrapping_sub(size.max(4).leading_zeros());
    to_usize(octave.wrapping_mul(4).wrapping_add(size >> octave))
}

/// The class of an energy.
#[cfg_attr(not(feature = "small"), inline(always))]
fn energy_class(energy: u32) -> usize {
    let class = quarter_octave(energy);
    if class < CLASSES { class } else { (class & 3) | (CLASSES - 4) }
}

/// 0 for a negative error, 2 for a positive one, 1 for one of about zero.
#[cfg_attr(not(feature = "small"), inline(always))]
fn sign(error: i32) -> usize {
    usize::from(error >= -8).wrapping_add(usize::from(error >= 8))
}

/// Seven classes of errors, from negative to positive.
#[cfg_attr(not(feature = "small"), inline(always))]
fn step(error: i32) -> usize {
    let size = error.unsigned_abs();
    let size =
        usize::from(size >= 5).wrapping_add(usize::from(size >= 12)).wrapping_add(usize::from(size >= 32));
    if error < 0 { 3_usize.wrapping_sub(size) } else { size.wrapping_add(3) }
}

/// Three digits of a base as one number.
#[cfg_attr(not(feature = "small"), inline(always))]
const fn joined([a, b, c]: [usize; 3], base: usize) -> usize {
    a.wrapping_mul(base).wrapping_add(b).wrapping_mul(base).wrapping_add(c)
}

/// What is known of a residual before it is coded.
#[derive(Debug)]
pub(super) struct Expected<'a> {
    /// The nearest integer to the prediction.
    pub(super) value: i32,
    /// Whether the prediction is below that.
    leans_down: bool,
    /// Lowest bits that are split off.
    low_bits: u32,
    nodes: [&'a mut Nodes; CONTEXTS],
    mixers: &'a mut Mixers,
    mantissas: &'a mut [[Counter; 4]; OCTAVES],
    lows: &'a mut [Counter; 4],
}

impl Expected<'_> {
    /// Codes a sample.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn code<C: Coder>(mut self, coder: &mut C, sample: i32) -> i32 {
        let leans_down = self.leans_down;
        let leaning = |residual: i32| if leans_down { residual.wrapping_neg() } else { residual };
        let residual = leaning(sample.wrapping_sub(self.value));
        let residual = if self.low_bits == 0 {
            self.code_whole(coder, residual)
        } else {
            self.code_split(coder, residual)
        };
        self.value.wrapping_add(leaning(residual))
    }

    /// A residual as it is.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn code_whole<C: Coder>(&mut self, coder: &mut C, residual: i32) -> i32 {
        if !self.decide(coder, 0, residual != 0) {
            return 0;
        }
        let negative = self.decide(coder, 1, residual < 0);
        let magnitude = self.code_magnitude(coder, residual.unsigned_abs()).cast_signed();
        if negative { magnitude.wrapping_neg() } else { magnitude }
    }

    /// A residual whose sign comes first, then the magnitude above its low bits, then these. -1 - n has the magnitude
    /// of n.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn code_split<C: Coder>(&mut self, coder: &mut C, residual: i32) -> i32 {
        let negative = self.decide(coder, 1, residual < 0);
        let size = (if residual < 0 { !residual } else { residual }).cast_unsigned();
        let top = self.code_magnitude(coder, (size >> self.low_bits).wrapping_add(1)).wrapping_sub(1);
        let rest = self.low_bits.wrapping_sub(1);
        let Some(counter) = self.lows.get_mut(to_usize(top.min(3))) else { return 0 };
        let first = decide_alone(coder, counter, size >> rest & 1 == 1);
        let low = first << rest | coder.raw(size & low_bits(rest), rest);
        let size = (top << self.low_bits | low).cast_signed();
        if negative { !size } else { size }
    }

    /// A number above 0.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn code_magnitude<C: Coder>(&mut self, coder: &mut C, magnitude: u32) -> u32 {
        let octave = magnitude.checked_ilog2().unwrap_or(0);
        let mut reached = 0;
        while reached < 31 {
            let node = to_usize(reached).min(MIXED_NODES - 1 - OCTAVE_NODE).wrapping_add(OCTAVE_NODE);
            if !self.decide(coder, node, octave > reached) {
                break;
            }
            reached = reached.wrapping_add(1);
        }
        let Some(below) = reached.checked_sub(1) else { return 1 };
        let Some(counters) = self.mantissas.get_mut(to_usize(reached).min(OCTAVES - 1)) else { return 1 };
        let [first, after_zero, after_one, _] = counters;
        let bit = decide_alone(coder, first, magnitude >> below & 1 == 1);
        let leading = 2 | bit;
        let Some(below) = below.checked_sub(1) else { return leading };
        let next =
            decide_alone(coder, if bit == 1 { after_one } else { after_zero }, magnitude >> below & 1 == 1);
        (leading << 1 | next) << below | coder.raw(magnitude & low_bits(below), below)
    }

    /// One decision under the mixed chances of its contexts.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn decide<C: Coder>(&mut self, coder: &mut C, node: usize, bit: bool) -> bool {
        let slot = node.min(NODES - 1);
        let mut odds = [BIAS; CONTEXTS + 1];
        for (odds, nodes) in odds.iter_mut().zip(&self.nodes) {
            *odds = nodes.get(slot).map_or(0, |counter| counter.odds());
        }
        let Some(mixer) = self.mixers.get_mut(node) else { return false };
        let chance = mixer.chance(&odds);
        let bit = coder.decide(bit, chance);
        mixer.learn(&odds, chance, bit);
        for nodes in &mut self.nodes {
            if let Some(counter) = nodes.get_mut(slot) {
                counter.learn(bit);
            }
        }
        bit
    }
}

/// One decision under the chance of a single counter.
#[cfg_attr(not(feature = "small"), inline(always))]
fn decide_alone<C: Coder>(coder: &mut C, counter: &mut Counter, bit: bool) -> u32 {
    const LEAST: u32 = 64;
    let bit = coder.decide(bit, counter.chance().clamp(LEAST, (1 << 16) - LEAST));
    counter.learn(bit);
    u32::from(bit)
}

/// Counters that expect what residuals of a class of energy usually are.
fn expected(class: usize, seen: u8) -> Nodes {
    const ROWS: usize = PRIORS.len();
    let row = if class < ROWS { class } else { (class & 3) | (ROWS - 4) };
    let chances = PRIORS.get(row).copied().unwrap_or_default();
    chances.map(|chance| Counter::expecting(u16::from(chance) << 8 | 1 << 7, seen))
}

/// Chances of true in 1/256 that decisions start from, by class of energy and node; the last four stand for all larger.
#[rustfmt::skip]
static PRIORS: [[u8; NODES]; 28] = [
    [1, 26, 9, 119, 186, 198, 189, 167],
    [17, 20, 4, 14, 81, 96, 64, 128],
    [41, 24, 4, 19, 93, 111, 91, 43],
    [63, 30, 4, 9, 55, 90, 96, 64],
    [77, 36, 6, 7, 47, 77, 77, 64],
    [86, 41, 7, 5, 34, 60, 32, 128],
    [93, 47, 9, 7, 32, 43, 77, 64],
    [101, 53, 13, 7, 29, 58, 48, 64],
    [114, 61, 20, 8, 22, 52, 23, 64],
    [134, 76, 36, 11, 16, 52, 72, 48],
    [154, 89, 57, 15, 12, 35, 20, 64],
    [171, 98, 78, 21, 15, 30, 29, 77],
    [187, 105, 106, 30, 12, 23, 24, 21],
    [199, 111, 132, 44, 13, 22, 35, 53],
    [207, 113, 149, 59, 15, 19, 21, 30],
    [211, 115, 162, 73, 18, 16, 24, 36],
    [217, 117, 176, 94, 25, 17, 22, 18],
    [223, 119, 190, 118, 39, 21, 18, 29],
    [228, 121, 201, 139, 56, 26, 15, 33],
    [231, 122, 209, 157, 77, 33, 16, 16],
    [236, 123, 219, 177, 106, 45, 17, 12],
    [241, 124, 227, 196, 134, 58, 18, 12],
    [244, 125, 232, 205, 150, 70, 23, 11],
    [245, 125, 235, 211, 161, 81, 28, 11],
    [128, 124, 235, 213, 164, 82, 23, 13],
    [128, 125, 238, 219, 178, 104, 37, 15],
    [128, 125, 241, 226, 192, 129, 52, 17],
    [128, 126, 244, 231, 203, 146, 65, 20],
];
