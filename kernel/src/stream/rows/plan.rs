//! What a stream of rows is made of, and the memory that it takes.

use super::bands::Place;
use super::fronts::lag;
use super::header::{Bytes, Fields, MAX_BYTES, MAX_LEVELS, ROWS, Reader};
use super::shelf::Shelf;
use crate::extent::to_usize;
use crate::transform::row_scratch_len;
use crate::{DecodeError, Extent, Feature, Malformed, PlanError, SampleType, Wavelet};

/// Samples in a strip, unless something else is asked for.
const STRIP_SAMPLES: u32 = 1 << 13;

/// Rows in a strip, at least, unless something else is asked for.
const LEAST_STRIP: u32 = 8;

/// Wavelet, width, levels and type of the samples of a slice whose rows come one after another, their number not known
/// before.
///
/// A level splits each axis that is longer than one sample, so where the height turns out small, or the width is, the
/// last levels may change nothing; the coefficients are those of a [`Plan`](crate::Plan) with as many levels as the
/// extent has, if it has fewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RowPlan {
    wavelet: Wavelet,
    width: u32,
    levels: u8,
    sample_type: SampleType,
    strip: u32,
}

impl RowPlan {
    /// Rows of `width` samples, under `levels` levels of `wavelet`; 0 levels mean no transform.
    ///
    /// # Errors
    /// [`PlanError::ZeroExtent`] or [`PlanError::ExtentTooLarge`] for a width without samples, or of 2^31 or more;
    /// [`PlanError::TooManyLevels`] for more than 31 levels; [`PlanError::NotBuilt`] if this build lacks the wavelet.
    pub const fn new(
        wavelet: Wavelet,
        width: u32,
        levels: u8,
        sample_type: SampleType,
    ) -> Result<Self, PlanError> {
        if let Err(error) = Extent::line(width) {
            return Err(error);
        }
        if levels > MAX_LEVELS {
            return Err(PlanError::TooManyLevels { max: MAX_LEVELS });
        }
        if levels > 0 && !Feature::Wavelet(wavelet).is_built() {
            return Err(PlanError::NotBuilt(Feature::Wavelet(wavelet)));
        }
        let wavelet = if levels == 0 { Wavelet::Haar } else { wavelet };
        let strip = STRIP_SAMPLES.div_ceil(width);
        let strip = if strip < LEAST_STRIP { LEAST_STRIP } else { strip };
        Ok(Self { wavelet, width, levels, sample_type, strip })
    }

    /// The same in strips of `rows` rows, at least one and at most 65,535.
    ///
    /// All bytes of a strip leave with its last row, the first long before. A strip takes about three bytes more than
    /// its coefficients. Without this, strips have 8,192 samples or more.
    #[must_use]
    pub const fn with_strip(self, rows: u16) -> Self {
        #[expect(clippy::as_conversions, reason = "lossless; From is not const")]
        let strip = if rows == 0 { 1 } else { rows as u32 };
        Self { strip, ..self }
    }

    /// The wavelet; with 0 levels always psi_H, whatever was asked for.
    #[must_use]
    pub const fn wavelet(&self) -> Wavelet {
        self.wavelet
    }

    /// Samples of a row.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// How often the low-pass part is transformed again.
    #[must_use]
    pub const fn levels(&self) -> u8 {
        self.levels
    }

    /// The type of the samples.
    #[must_use]
    pub const fn sample_type(&self) -> SampleType {
        self.sample_type
    }

    /// Rows of a strip.
    #[must_use]
    pub const fn strip(&self) -> u32 {
        self.strip
    }

    /// Bytes that any stream of rows begins with, at most.
    pub const MAX_HEADER_BYTES: usize = MAX_BYTES;

    /// Reads the header of a stream of rows at the beginning of `bytes`; returns what it says and how long it is, at
    /// most [`RowPlan::MAX_HEADER_BYTES`]. What follows it is not looked at.
    ///
    /// # Errors
    /// [`DecodeError::Truncated`] if `bytes` ends first, [`DecodeError::OtherCodec`] if it is the header of a stream
    /// of slabs, [`DecodeError::NotBuilt`] if this build lacks its wavelet; otherwise what is wrong with it.
    pub fn parse(bytes: &[u8]) -> Result<(Self, usize), DecodeError> {
        let mut reader = Reader::new(bytes);
        let Fields { sample_type, wavelet, levels } = reader.fields(ROWS)?;
        let (width, strip) = (reader.number()?, reader.number()?);
        let wavelet = wavelet.unwrap_or(Wavelet::Haar);
        let plan = Self::new(wavelet, width, levels, sample_type).map_err(PlanError::in_header)?;
        match u16::try_from(strip) {
            Ok(strip) if strip > 0 => Ok((plan.with_strip(strip), reader.taken())),
            _ => Err(Malformed::Reserved.into()),
        }
    }

    /// The header of a stream of such rows.
    pub(in crate::stream) fn header(&self) -> Bytes {
        let wavelet = (self.levels() > 0).then(|| self.wavelet());
        let fields = Fields { sample_type: self.sample_type(), wavelet, levels: self.levels() };
        fields.write(ROWS, &[self.width(), self.strip()])
    }

    /// `i32`s of memory that a [`RowEncoder`](super::RowEncoder) takes.
    ///
    /// With n rows that the wavelet works on at a time (2 for psi_H, 3 for psi_Q, 4 for psi_1, 5 for psi_3, 6 for psi_D
    /// and psi_5), about n + 1 1/2 per column on the first level, half of it on the second and so on, and one more:
    /// for three levels at most 14 1/8, and 30 more.
    #[must_use]
    pub const fn encoder_memory_len(&self) -> usize {
        self.memory_len(Role::Encoder)
    }

    /// `i32`s of memory that a [`RowDecoder`](super::RowDecoder) takes.
    ///
    /// A row comes back when the last one that its coefficients depend on has gone in; until then those of the finer
    /// levels wait, on the first of L levels for a (2^(L-1) - 1) pairs of rows, a being 1 for psi_H, 3 for psi_1, 4 for
    /// psi_Q, 5 for psi_3, 7 for psi_5 and 8 for psi_D. They wait in as many bits as they can need: for three levels and
    /// samples of 16 bits in 9 1/2 elements a column for psi_H, 15 1/8 for psi_1 and at most 36 1/2; `docs/stream.md` has
    /// the table.
    #[must_use]
    pub const fn decoder_memory_len(&self) -> usize {
        self.memory_len(Role::Decoder)
    }

    /// `i32`s of memory in which a [`RowDecoder`](super::RowDecoder) is faster: one for each number that it keeps.
    ///
    /// For three levels 13 1/2 a column for psi_H, 25 1/4 for psi_1 and at most 56 3/4. With the feature `small` no
    /// decoder is faster, and these are as many as [`RowPlan::decoder_memory_len`] says.
    #[must_use]
    pub const fn fast_decoder_memory_len(&self) -> usize {
        self.memory_len(Role::FastDecoder)
    }

    /// Columns on a level: ceil(width / 2^level).
    pub(super) const fn width_at(&self, level: u8) -> usize {
        match self.width.wrapping_sub(1).checked_shr(level_bits(level)) {
            Some(rest) => to_usize(rest.wrapping_add(1)),
            None => 1,
        }
    }

    /// Where things lie in the memory of an encoder or a decoder.
    pub(super) const fn layout(&self, role: Role) -> Layout {
        let columns = to_usize(self.width);
        let low = self.width_at(self.levels);
        let scratch = if self.levels == 0 { 0 } else { row_scratch_len(columns) };
        let north = scratch;
        let above = north.saturating_add(low);
        let end = above.saturating_add(low);
        // A decoder has no coefficient before it is decoded, so a row can take the place of the one above.
        let (low_row, first_level) = match role {
            Role::Encoder => (end, end.saturating_add(low)),
            Role::Decoder | Role::FastDecoder => (north, end),
        };
        Layout { role, scratch, north, above, low_row, first_level }
    }

    /// Length of the memory.
    const fn memory_len(&self, role: Role) -> usize {
        self.level_start(role, self.levels, self.layout(role).first_level)
    }

    /// Where a level begins in memory, if the first begins at `start`; after the last level, where memory ends.
    const fn level_start(&self, role: Role, level: u8, mut start: usize) -> usize {
        let mut finer = 0;
        while finer < level {
            let len = match role {
                Role::Encoder => Place::new(self, finer, start).len(),
                Role::Decoder | Role::FastDecoder => {
                    let (_, len) = Shelf::new(self, role, (finer, start));
                    len
                }
            };
            start = start.saturating_add(len);
            finer = finer.wrapping_add(1);
        }
        start
    }

    /// The rows of a level in the memory of an encoder.
    pub(super) const fn rows_at(&self, level: u8) -> Place {
        let first = self.layout(Role::Encoder).first_level;
        Place::new(self, level, self.level_start(Role::Encoder, level, first))
    }

    /// The rows of a level in the memory of a decoder.
    pub(super) const fn shelf_at(&self, layout: Layout, level: u8) -> Shelf {
        let start = self.level_start(layout.role, level, layout.first_level);
        let (shelf, _) = Shelf::new(self, layout.role, (level, start));
        shelf
    }

    /// The decoder that there is room for, if it is built.
    pub(super) const fn decoder_in(&self, memory_len: usize) -> Role {
        if memory_len >= self.fast_decoder_memory_len() { Role::FastDecoder } else { Role::Decoder }
    }

    /// Pairs of rows of details that may wait on a level of a decoder.
    pub(super) const fn held(&self, level: u8) -> usize {
        let coarser = self.levels.saturating_sub(level).saturating_sub(1);
        let rows = match 1_usize.checked_shl(level_bits(coarser)) {
            Some(rows) => rows.saturating_sub(1),
            None => usize::MAX,
        };
        rows.saturating_mul(lag(self.wavelet)).saturating_add(1)
    }
}

#[expect(clippy::as_conversions, reason = "lossless; From is not const")]
const fn level_bits(level: u8) -> u32 {
    level as u32
}

/// Whose memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Encoder,
    /// Of a decoder, in which numbers take the bits that they need.
    Decoder,
    /// Of a decoder, in which they take a word each.
    FastDecoder,
}

/// Where things begin in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    role: Role,
    /// Length of the scratch that it begins with.
    pub(super) scratch: usize,
    /// The row above of the low-pass part.
    pub(super) north: usize,
    /// What is kept of the rows above of the low-pass part.
    pub(super) above: usize,
    /// A row of the low-pass part.
    pub(super) low_row: usize,
    pub(super) first_level: usize,
}
