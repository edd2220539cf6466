//! The segments of a codestream: written one after another behind a header that is written last, and read in turn.

use super::header::{Header, Segments, Storage};
use crate::coder::{Decoder, Encoder};
use crate::error::{at_least, exactly};
use crate::extent::to_usize;
use crate::memory::move_within;
use crate::{DecodeError, Malformed, Plan, SampleType, Slice};

/// A codestream that is being written.
///
/// The header holds the lengths of the segments: they go where they begin if every length takes one byte, and are
/// moved up at the end.
pub(super) struct SegmentWriter<'a> {
    header: (SampleType, Plan, Storage),
    segments: Segments,
    gap: usize,
    end: usize,
    out: &'a mut [u8],
}

impl<'a> SegmentWriter<'a> {
    /// For one segment more than the plan has levels, in `out`.
    pub(super) fn new(sample_type: SampleType, plan: Plan, storage: Storage, out: &'a mut [u8]) -> Self {
        let mut none = Segments::new();
        let _ = none.resize(usize::from(plan.levels()).wrapping_add(1), 0);
        let gap = Header::new(sample_type, plan, storage, none).header_len();
        Self { header: (sample_type, plan, storage), segments: Segments::new(), gap, end: gap, out }
    }

    /// Writes the next segment; `None` if it does not fit, or `code` gives up.
    pub(super) fn push(&mut self, code: impl FnOnce(&mut Encoder<'_>) -> Option<()>) -> Option<()> {
        let mut encoder = Encoder::new(self.out.get_mut(self.end..)?);
        code(&mut encoder)?;
        let len = encoder.finish()?;
        self.add(len)
    }

    /// Writes the only segment, of which `write` returns the length; `None` if it does not fit. Where this succeeds, so
    /// does [`SegmentWriter::finish`].
    pub(super) fn push_only(&mut self, write: impl FnOnce(&mut [u8]) -> Option<usize>) -> Option<()> {
        let room = self.out.get_mut(self.end..)?;
        let len = write(room.get_mut(..longest(room.len()))?)?;
        self.add(len)
    }

    fn add(&mut self, len: usize) -> Option<()> {
        self.end = self.end.saturating_add(len);
        self.segments.push(u32::try_from(len).ok()?).ok()
    }

    /// Writes the header and returns the length of the codestream; `None` if it does not fit.
    pub(super) fn finish(self) -> Option<usize> {
        let (sample_type, plan, storage) = self.header;
        let header = Header::new(sample_type, plan, storage, self.segments);
        let total = header.total_len();
        self.out.get(..total)?;
        move_within(self.out, self.gap..self.end, header.header_len());
        header.write(self.out);
        Some(total)
    }
}

/// The longest segment that fits into `room` bytes with all bytes of its length but the first, which has room already.
fn longest(room: usize) -> usize {
    let with = |more: u32| {
        let bound = 1_usize.checked_shl(more.wrapping_add(1).wrapping_mul(7));
        room.saturating_sub(to_usize(more)).min(bound.unwrap_or(0).wrapping_sub(1))
    };
    (0..5).map(with).max().unwrap_or(0)
}

impl Header {
    /// What follows this header in `bytes`, if these and the memory lent to decode to `level` have the right lengths.
    pub(super) fn payload<'a>(
        &self,
        bytes: &'a [u8],
        level: u8,
        samples: &[i32],
        (scratch_len, scratch): (usize, &[i32]),
    ) -> Result<&'a [u8], DecodeError> {
        exactly(Slice::Samples, self.samples_len(level), samples.len())?;
        at_least(Slice::Scratch, scratch_len, scratch.len())?;
        if bytes.len() < self.len_to_level(level) {
            return Err(DecodeError::Truncated);
        }
        if bytes.len() > self.total_len() {
            return Err(DecodeError::TrailingBytes);
        }
        Ok(bytes.get(self.header_len()..).unwrap_or(&[]))
    }

    /// Calls `decode` with the number and a decoder of each of the first `count` segments of `payload`.
    pub(super) fn each_segment(
        &self,
        mut payload: &[u8],
        count: u8,
        mut decode: impl FnMut(u8, &mut Decoder<'_>) -> Result<(), DecodeError>,
    ) -> Result<(), DecodeError> {
        for (number, &bytes) in (0..count).zip(&self.segments) {
            let (segment, rest) = payload.split_at_checked(to_usize(bytes)).ok_or(DecodeError::Truncated)?;
            let mut decoder = Decoder::new(segment).ok_or(Malformed::Segment)?;
            decode(number, &mut decoder)?;
            if !decoder.is_consumed() {
                return Err(Malformed::Segment.into());
            }
            payload = rest;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::longest;

    #[test]
    fn a_length_takes_room() {
        assert_eq!([0, 1, 127, 128, 129, 130].map(longest), [0, 1, 127, 127, 128, 129]);
        assert_eq!([16_384, 16_385, 16_386].map(longest), [16_383, 16_383, 16_384]);
    }
}
