//! Near-lossless encoding and decoding: the codestreams of [`Lattice`].

use super::header::{Header, Storage};
use super::segments::SegmentWriter;
use super::stored::{Stored, restore};
use crate::coder::{Coder, Grid, LARGEST_SLACK, Precision};
use crate::error::{at_least, exactly};
use crate::memory::copy;
use crate::{
    DecodeError, EncodeError, Extent, Feature, Lattice, Malformed, Plan, SampleType, Slice, Wavelet,
};

/// Levels that an encoder gives a lattice, at most.
const MOST_LEVELS: u8 = 6;

/// The coarsest lattice has at most this many samples along each axis, if [`MOST_LEVELS`] suffice.
const COARSEST_SIDE: u32 = 4;

/// What to encode near-losslessly, and how near.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Near {
    /// Samples per axis.
    pub extent: Extent,
    /// The type of the samples.
    pub sample_type: SampleType,
    /// How far a decoded sample may be from its original; above 2^30 - 1 it counts as that.
    pub slack: u32,
}

impl Lattice {
    /// `i32`s of scratch that encoding takes for samples of `extent`: about two per sample, and up to 144,000.
    #[must_use]
    pub fn encoding_scratch_len(extent: Extent) -> usize {
        Grid::encoding_scratch_len(extent)
    }

    /// `i32`s of scratch that decoding takes for samples of `extent`, those of the level asked for: about one per
    /// sample.
    #[must_use]
    pub const fn decoding_scratch_len(extent: Extent) -> usize {
        Grid::decoding_scratch_len(extent)
    }

    /// Encodes `samples` (x fastest) into the beginning of `out` and returns the length of the codestream. No decoded
    /// sample is further than the slack from its original; with a slack of 0 they are the same.
    ///
    /// An `out` of [`max_encoded_len`](crate::max_encoded_len) bytes always suffices; a shorter one does if the
    /// codestream happens to fit. `samples` are what they were afterwards, and as many at the beginning of `scratch` what
    /// a decoder makes of the codestream.
    ///
    /// # Errors
    /// [`EncodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Lattice::encoding_scratch_len`]; [`EncodeError::SampleOutOfRange`] if a sample is outside `sample_type`;
    /// [`EncodeError::OutputFull`] if `out` is too short; [`EncodeError::NotBuilt`] without the feature `lattice`.
    pub fn encode(
        &mut self,
        near: Near,
        samples: &mut [i32],
        scratch: &mut [i32],
        out: &mut [u8],
    ) -> Result<usize, EncodeError> {
        if !Feature::Lattice.is_built() {
            return Err(EncodeError::NotBuilt(Feature::Lattice));
        }
        let Near { extent, sample_type, .. } = near;
        exactly(Slice::Samples, extent.samples(), samples.len())?;
        at_least(Slice::Scratch, Self::encoding_scratch_len(extent), scratch.len())?;
        if let Some(index) = sample_type.first_outside(samples) {
            return Err(EncodeError::SampleOutOfRange { index });
        }
        let unlevelled = Plan::new(Wavelet::Haar, extent, 0).map_err(|_| EncodeError::OutputFull)?;
        let stored = Stored::new(&unlevelled, sample_type);
        order(sample_type, samples);
        let coded = self.encode_levels(near, samples, scratch, stored.room(out));
        order(sample_type, samples);
        let decoded = scratch.get_mut(..samples.len()).unwrap_or(&mut []);
        if coded.is_some() {
            order(sample_type, decoded);
        } else {
            copy(samples, decoded);
        }
        coded.map_or_else(|| stored.write(samples, out), Ok)
    }

    /// Codes every lattice into `out`; `None` if they do not fit. `samples` are in order.
    fn encode_levels(
        &mut self,
        near: Near,
        samples: &[i32],
        scratch: &mut [i32],
        out: &mut [u8],
    ) -> Option<usize> {
        let Near { extent, sample_type, slack } = near;
        let slack = slack.min(LARGEST_SLACK);
        let levels = levels(extent);
        let plan = Plan::without_wavelet(extent, levels)?;
        let mut grid = Grid::of_samples(extent, precision(sample_type, slack, 0), samples, scratch)?;
        self.choose_shrinking(&mut grid);
        let storage = Storage::Lattice { slack, shrinking: grid.precision.shrinking };
        let mut writer = SegmentWriter::new(sample_type, plan, storage, out);
        for level in (0..=levels).rev() {
            writer.push(|encoder| self.code(encoder, &mut grid, level, levels))?;
        }
        writer.finish()
    }

    /// Runs either direction of the coder over the lattice of `level`; `None` for what no encoder writes.
    fn code<C: Coder>(&mut self, coder: &mut C, grid: &mut Grid<'_>, level: u8, coarsest: u8) -> Option<()> {
        if level == coarsest {
            self.code_coarsest(coder, grid, level)
        } else {
            self.code_level(coder, grid, level)
        }
    }

    /// Decodes a whole codestream into `samples`, x fastest.
    ///
    /// # Errors
    /// As [`Lattice::decode_to_level`].
    pub fn decode(
        &mut self,
        bytes: &[u8],
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Result<Header, DecodeError> {
        self.decode_to_level(bytes, 0, samples, scratch)
    }

    /// Decodes the part of a codestream that makes `level`: 0 is full resolution, level L every 2^L-th sample along
    /// each axis, ceil(n / 2^L) in all, no further from its original than [`Header::slack`].
    ///
    /// `bytes` may end after the segment of that level ([`Header::bytes_to_level`]).
    ///
    /// # Errors
    /// [`DecodeError::OtherCodec`] if the codestream holds coefficients; [`DecodeError::LevelOutOfRange`] for a level
    /// that it does not hold; [`DecodeError::Length`] if `samples` is not exactly [`Header::samples_len`] or `scratch`
    /// is shorter than [`Lattice::decoding_scratch_len`] of [`Header::extent_at`]; otherwise what is wrong with
    /// `bytes`. After an error `samples` and `scratch` are meaningless.
    pub fn decode_to_level(
        &mut self,
        bytes: &[u8],
        level: u8,
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Result<Header, DecodeError> {
        let header = Header::parse(bytes)?;
        let levels = header.plan().levels();
        if header.storage == Storage::Coded || (header.is_stored() && levels > 0) {
            return Err(DecodeError::OtherCodec);
        }
        if level > levels {
            return Err(DecodeError::LevelOutOfRange { max: levels });
        }
        let extent = header.extent_at(level);
        let payload = header.payload(bytes, level, samples, (Self::decoding_scratch_len(extent), scratch))?;
        match header.storage {
            Storage::Lattice { slack, shrinking } => {
                let precision = precision(header.sample_type(), slack, shrinking);
                let mut grid =
                    Grid::of_nothing(extent, precision, level, samples, scratch).ok_or(Malformed::Extent)?;
                let count = levels.saturating_sub(level).saturating_add(1);
                header.each_segment(payload, count, |number, decoder| {
                    let coded = self.code(decoder, &mut grid, levels.saturating_sub(number), levels);
                    Ok(coded.ok_or(Malformed::Segment)?)
                })?;
                order(header.sample_type(), samples);
            }
            _ => restore(header.sample_type(), payload, samples),
        }
        match header.sample_type().first_outside(samples) {
            Some(_) => Err(Malformed::Sample.into()),
            None => Ok(header),
        }
    }
}

/// Levels that an encoder gives a lattice of `extent`.
fn levels(extent: Extent) -> u8 {
    let [x, y, z] = extent.axes();
    let longest = x.max(y).max(z);
    (0..MOST_LEVELS).find(|&level| COARSEST_SIDE << level >= longest).unwrap_or(MOST_LEVELS)
}

/// The precision of samples that are in order.
fn precision(sample_type: SampleType, slack: u32, shrinking: u8) -> Precision {
    Precision { range: sample_type.range(), slack, shrinking }
}

/// Brings samples that travel as other bits into the order of their values, and back.
fn order(sample_type: SampleType, samples: &mut [i32]) {
    if sample_type == SampleType::U32 {
        samples.iter_mut().for_each(|sample| *sample ^= i32::MIN);
    }
}
