//! One row: the prediction of each sample, and what is learnt from it.

use core::ops::Range;

use super::Column;
use super::equations::{Chunk, SCALED_BITS, TAPS, WEIGHT_BITS, Weights, predict};
use super::neighbours::{ANY, Neighbours, RowAround};
use super::residual::{Errors, FRACTION_BITS, Models};
use crate::coder::Coder;
use crate::coder::{low_half, low_word};

/// Bits that samples may span.
const MOST_SPAN_BITS: u32 = 25;

/// Small differences are scaled up by at most this many bits.
const MOST_UP: u32 = 10;

/// Errors are remembered up to this, in 1/16.
const LARGEST_ERROR: i32 = 1 << 24;

/// Losses are remembered up to this.
const LARGEST_LOSS: u32 = (1 << 12) - 1;

/// Bits of the share that the fast prediction has.
const SHARE_BITS: u32 = 6;

/// The range of the samples of a brick, from 0 on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    highest: i32,
    /// What is shifted out of samples for their level, and of errors for the loss.
    level_bits: u32,
    loss_bits: u32,
}

impl Scale {
    /// That of samples from 0 to `span`; `None` if it has more than 25 bits.
    pub(super) const fn new(span: u32) -> Option<Self> {
        let bits = u32::BITS.wrapping_sub(span.leading_zeros());
        if bits > MOST_SPAN_BITS {
            return None;
        }
        let (level_bits, loss_bits) = (bits.saturating_sub(6), bits.saturating_sub(12));
        Some(Self { highest: span.cast_signed(), level_bits, loss_bits })
    }

    /// What stands for the samples before the first.
    pub(super) const fn middle(&self) -> i32 {
        self.highest >> 1
    }

    /// What a prediction lost when `sample` was coded.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn loss(&self, sample: i32, prediction: i32) -> i32 {
        let error = (sample << FRACTION_BITS).wrapping_sub(prediction).unsigned_abs();
        (error >> self.loss_bits).min(LARGEST_LOSS).cast_signed()
    }
}

/// A row that is coded.
#[derive(Debug)]
pub(super) struct Row<'a> {
    /// What is known before it.
    pub(super) known: u8,
    pub(super) around: RowAround<'a>,
    /// The three samples before the next one, the nearest last.
    pub(super) wests: [i32; 3],
    pub(super) scale: &'a Scale,
}

impl Row<'_> {
    /// Codes the samples of `range`, and gathers in the chunk what they teach. One code for each `KNOWN`, or for all of
    /// them, which is [`ANY`].
    #[inline(never)]
    pub(super) fn code<C: Coder, const KNOWN: u8>(
        &mut self,
        coder: &mut C,
        samples: &mut [i32],
        range: Range<usize>,
        (models, column, chunk): (&mut Models, &Column, &mut Chunk),
    ) -> Option<()> {
        let known = if KNOWN == ANY { self.known } else { KNOWN };
        let (scale, rows) = (self.scale, &self.around.rows);
        let mut wests = self.wests;
        let [errors_north, errors, errors_south] = &mut self.around.errors;
        let [losses_north, losses] = &mut self.around.losses;
        for (x, sample) in range.clone().zip(samples.get_mut(range)?) {
            let neighbours = Neighbours::of(known, rows, wests, x)?;
            let scaled = Scaled::new(&neighbours.differences);
            let [_, second, west] = wests;
            let pair = scaled.predictions(west, column, scale);

            let losses = losses.get_mut(x..)?.first_chunk_mut::<3>()?;
            let [_, _, loss_north, loss_north_east] = losses_north.get(x..)?.first_chunk::<4>()?;
            let [loss_second, loss_west, loss] = losses;
            let near = loss_west.wrapping_add(*loss_north).wrapping_add(*loss);
            let local = near.wrapping_mul(2).wrapping_add(*loss_north_east).wrapping_add(*loss_second);
            let prediction = mixed(pair, local);

            let [_, north_west, north, north_east] = *errors_north.get(x..)?.first_chunk()?;
            let [error_second, error_west, error, up_east] = errors.get_mut(x..)?.first_chunk_mut()?;
            let up_south = *errors_south.get(x.wrapping_add(2))?;
            let others = [north_west, *up_east, up_south, *error_second];
            let around = Errors { west: *error_west, north, up: *error, north_east, others };
            let place = (known, scale.level_bits);
            let expected = models.expect(place, prediction, neighbours.nearest, &around)?;

            let value = expected.code(coder, *sample);
            *sample = value;
            wests = [second, west, value];
            let off = (value << FRACTION_BITS).wrapping_sub(prediction);
            *error = off.clamp(-LARGEST_ERROR, LARGEST_ERROR);
            let [fast, slow] = pair;
            *loss = scale.loss(value, fast) << 16 | scale.loss(value, slow);
            chunk.push(&scaled.differences, scaled.of(value.wrapping_sub(west)));
        }
        self.wests = wests;
        Some(())
    }
}

/// The differences of a sample, brought to [`SCALED_BITS`] bits together.
#[derive(Clone, Copy, Debug)]
struct Scaled {
    differences: [i16; TAPS],
    up: u32,
    down: u32,
    /// Whether no difference is left to predict from.
    flat: bool,
}

impl Scaled {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn new(differences: &[i32; TAPS]) -> Self {
        let all = differences.iter().fold(0, |all, difference| all | difference.unsigned_abs());
        let bits = u32::BITS.wrapping_sub(all.leading_zeros());
        let up = SCALED_BITS.saturating_sub(bits).min(MOST_UP);
        let mut scaled =
            Self { differences: [0; TAPS], up, down: bits.saturating_sub(SCALED_BITS), flat: all == 0 };
        let (up, down) = (scaled.up, scaled.down);
        for (scaled, difference) in scaled.differences.iter_mut().zip(differences) {
            *scaled = low_half(difference << up >> down);
        }
        scaled
    }

    /// A difference in the same scale.
    #[cfg_attr(not(feature = "small"), inline(always))]
    const fn of(&self, difference: i32) -> i32 {
        difference << self.up >> self.down
    }

    /// The fast and the slow prediction, in 1/16.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn predictions(&self, west: i32, column: &Column, scale: &Scale) -> [i32; 2] {
        let west = west << FRACTION_BITS;
        if self.flat {
            return [west; 2];
        }
        let prediction = |weights: &Weights| {
            let change = predict(weights, &self.differences) >> (WEIGHT_BITS - FRACTION_BITS);
            west.wrapping_add(change << self.down >> self.up).max(0).min(scale.highest << FRACTION_BITS)
        };
        [prediction(&column.fast_weights), prediction(&column.slow_weights)]
    }
}

/// The mean of the fast and the slow prediction, each weighted by the inverse square of what it lost around.
#[cfg_attr(not(feature = "small"), inline(always))]
fn mixed([fast, slow]: [i32; 2], losses: i32) -> i32 {
    let losses = losses.cast_unsigned();
    let [of_fast, of_slow] = [losses >> 16, losses & 0xFFFF].map(|loss| {
        let loss = (loss >> 3).wrapping_add(1);
        loss.wrapping_mul(loss)
    });
    let share = (of_slow << SHARE_BITS).checked_div(of_slow.wrapping_add(of_fast)).unwrap_or(0);
    let part = i64::from(fast.wrapping_sub(slow)).wrapping_mul(share.into()) >> SHARE_BITS;
    slow.wrapping_add(low_word(part))
}
