//! A brick coded in two passes: predictions with weights that the codestream brings, then residuals under tables of
//! frequencies that it brings too, by interleaved asymmetric numeral systems. Nothing adapts, so nothing waits: the
//! quickest both ways.
//!
//! Both passes work in place. The encoder makes residuals of samples from the last row to the first, so that each row still
//! has samples before it to be predicted from; the decoder reads all residuals, and makes samples of them from the first
//! row to the last.
//!
//! The format is in `docs/tabled.md`. Sources: Duda, *Asymmetric numeral systems*, 2013; Giesen, *Interleaved entropy
//! coders*, 2014, for states that take turns.

mod bits;
mod cells;
mod class;
mod counts;
mod energies;
mod narrow;
mod neighbours;
mod numerals;
mod own;
mod sets;
#[cfg_attr(not(feature = "vectors"), path = "no_short_rows.rs")]
mod short_rows;
mod tables;
mod token;
mod train;
mod wide;

use core::ops::Range;

use self::bits::{BitReader, BitWriter};
use self::cells::OwnLabels;
use self::counts::Counts;
use self::energies::Steps;
use self::narrow::Narrow;
use self::neighbours::row_at;
use self::numerals::{NumeralReader, NumeralWriter};
use self::short_rows::ShortRows;
use self::tables::Layout;
pub(super) use self::tables::Tables;
pub(super) use self::train::Lessons;
use self::wide::Wide;
use super::{Memory, Training, range};
use crate::extent::to_usize;
use crate::memory::copy;
use crate::{Extent, Feature};

/// Bits that samples may span.
const MOST_SPAN_BITS: u32 = 19;

/// Samples that a brick has at least: fewer are not worth tables.
const FEWEST: usize = 1 << 14;

/// Where the lowest sample, the span, and the length of the extra bits are.
const LOWEST: Range<usize> = 0..4;
/// As [`LOWEST`].
const SPAN: Range<usize> = 4..8;
/// As [`LOWEST`].
const EXTRA_LEN: Range<usize> = 8..12;

/// The lowest of samples and how much more the highest is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    lowest: i32,
    span: i32,
}

/// What an encoder predicts from.
#[derive(Debug)]
pub(crate) enum Means<'a> {
    /// The nearest samples.
    Narrow,
    /// All that trained predictors look at.
    Wide(&'a mut Training),
}

impl Means<'_> {
    /// The span of samples which are worth coding so: of a slice or a brick large enough, and not too far apart.
    pub(crate) fn suit(&self, extent: Extent, samples: &[i32]) -> Option<Span> {
        let [width, ..] = extent.sides();
        if samples.len() < FEWEST || samples.len() <= width {
            return None;
        }
        let most_bits = self.form().most_span_bits();
        let (lowest, highest) = range(samples);
        let span = highest.wrapping_sub(lowest);
        (span.cast_unsigned() >> most_bits == 0).then_some(Span { lowest, span })
    }

    /// The form that an encoder writes.
    pub(crate) const fn form(&self) -> Form {
        match self {
            Self::Narrow => Form::Narrow,
            Self::Wide(_) => Form::Celled,
        }
    }
}

/// What a decoder has to know of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum Form {
    /// The nearest samples, and the nearest ranks.
    Narrow,
    /// All samples that trained predictors look at, and the nearest ranks: no encoder writes it any more.
    Wide,
    /// Those samples by the weights of each cell, and more ranks.
    Celled,
}

impl Form {
    /// Bits that samples may span.
    const fn most_span_bits(self) -> u32 {
        match self {
            Self::Narrow => MOST_SPAN_BITS,
            Self::Wide | Self::Celled => wide::MOST_SPAN_BITS,
        }
    }

    /// Whether only builds that train know of it.
    pub(crate) const fn is_trained(self) -> bool {
        !matches!(self, Self::Narrow)
    }
}

/// Encodes samples of a span that is suitable into the beginning of `out`, and returns the length of the segment.
///
/// `None` if it does not fit, with `samples` as they were; otherwise they are used up. `scratch` is that of a
/// plan without levels.
// Apart from its caller, which is small enough then to be built for the efforts alone that a program asks for.
#[cfg_attr(not(feature = "small"), inline(never))]
pub(crate) fn encode(
    memory: &mut Memory,
    means: Means<'_>,
    (extent, span): (Extent, Span),
    samples: &mut [i32],
    scratch: &mut [i32],
    out: &mut [u8],
) -> Option<usize> {
    copy(&span.lowest.to_le_bytes(), out.get_mut(LOWEST)?);
    copy(&span.span.to_le_bytes(), out.get_mut(SPAN)?);
    if span.span == 0 {
        return Some(SPAN.end);
    }
    let _ = out.get(EXTRA_LEN)?;
    let mut brick = Brick { sides: extent.sides(), values: samples, scratch };
    let mut labels = OwnLabels::NEW;
    let predictor = match means {
        Means::Wide(training) if Feature::Trained.is_built() => {
            Predictor::Wide(Wide::train(training, extent, span, brick.values, &mut labels)?)
        }
        _ => Predictor::Narrow(Narrow::train(memory.lessons()?, brick.sides, span, brick.values)),
    };
    let tables = memory.tables()?;
    brick.make_residuals(&predictor);
    let len = brick.write(tables, &predictor, out);
    if len.is_none() {
        brick.values.iter_mut().for_each(|value| *value &= class::RANKS);
        brick.make_samples(&predictor);
    }
    len
}

/// Decodes a segment that holds all of `samples`. `None` if the segment is what no encoder writes.
#[cfg_attr(not(feature = "small"), inline(never))]
pub(crate) fn decode(
    memory: &mut Memory,
    (extent, form): (Extent, Form),
    bytes: &[u8],
    samples: &mut [i32],
    scratch: &mut [i32],
) -> Option<()> {
    let field = |range| bytes.get(range).and_then(|bytes: &[u8]| bytes.first_chunk().copied());
    let lowest = i32::from_le_bytes(field(LOWEST)?);
    let span = i32::from_le_bytes(field(SPAN)?);
    if span == 0 {
        samples.fill(lowest);
        return (bytes.len() == SPAN.end).then_some(());
    }
    let [width, ..] = extent.sides();
    if span.cast_unsigned() >> form.most_span_bits() != 0 || samples.len() <= width {
        return None;
    }
    let extra_len = to_usize(u32::from_le_bytes(field(EXTRA_LEN)?));
    let (extra, rest) = bytes.get(EXTRA_LEN.end..)?.split_at_checked(extra_len)?;
    let span = Span { lowest, span };
    let mut head = BitReader::new(rest);
    let classes = match form {
        Form::Celled if Feature::Trained.is_built() => Classes::Scaled(Steps::read(&mut head)?),
        _ => Classes::Nearest,
    };
    let predictor = match form {
        Form::Wide | Form::Celled if Feature::Trained.is_built() => {
            Predictor::Wide(Wide::read(extent, span, form, &mut head)?)
        }
        _ => Predictor::Narrow(Narrow::read(extent.sides(), span, &mut head)?),
    };
    let mut brick = Brick { sides: extent.sides(), values: samples, scratch };
    let tables = memory.tables()?;
    tables.read(classes.layout(), &mut head)?;
    brick.read(&classes, tables, extra, rest.get(head.finish()?..)?)?;
    brick.make_samples(&predictor)
}

/// What the rows of a brick are predicted by; the wide one only in builds that train.
#[expect(clippy::large_enum_variant, reason = "there is one at a time, and nothing to put it in")]
enum Predictor<'a> {
    Narrow(Narrow),
    Wide(Wide<'a>),
}

/// What the classes of ranks are made of; more than the nearest only in builds that train.
enum Classes {
    Nearest,
    Scaled(Steps),
}

impl Classes {
    /// How tables for them stand in the codestream.
    const fn layout(&self) -> Layout {
        match self {
            Self::Nearest => Layout::NEAREST,
            Self::Scaled(_) => Layout::ROUNDED,
        }
    }

    /// The class of each place of row y of plane z, in the beginning of `scratch`, and the row.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn of_row<'a, 'b>(
        &self,
        values: &'a mut [i32],
        sides: [usize; 3],
        place: [usize; 2],
        scratch: &'b mut [i32],
    ) -> Option<(&'b mut [i32], &'a mut [i32])> {
        match self {
            Self::Scaled(steps) if Feature::Trained.is_built() => {
                steps.classes(values, sides, place, scratch)
            }
            _ => {
                let (around, row) = row_at(values, sides, place)?;
                let classes = scratch.get_mut(..row.len())?;
                class::classes(&around, classes);
                Some((classes, row))
            }
        }
    }
}

/// A brick of samples, or of the ranks of their residuals.
struct Brick<'a> {
    sides: [usize; 3],
    values: &'a mut [i32],
    scratch: &'a mut [i32],
}

impl Brick<'_> {
    /// Places of the rows, y and z, in the order of coding.
    fn rows(&self) -> impl DoubleEndedIterator<Item = [usize; 2]> + use<> {
        let [_, height, depth] = self.sides;
        (0..depth).flat_map(move |z| (0..height).map(move |y| [y, z]))
    }

    /// Makes ranks of residuals of samples.
    #[cfg_attr(feature = "small", inline(never))]
    fn make_residuals(&mut self, predictor: &Predictor<'_>) -> Option<()> {
        let mut rows = self.rows().rev();
        let Self { sides, values, scratch } = self;
        match predictor {
            Predictor::Narrow(narrow) => rows.try_for_each(|place| {
                let (own, mut before, row, sums) = narrow.row(values, *sides, place, scratch)?;
                own.forward(row, sums, &mut before);
                Some(())
            }),
            Predictor::Wide(_) if !Feature::Trained.is_built() => None,
            Predictor::Wide(wide) => {
                let mut short_rows = ShortRows::NEW;
                rows.try_for_each(|place| wide.forward(values, place, scratch, &mut short_rows))
            }
        }
    }

    /// Undoes [`Brick::make_residuals`].
    fn make_samples(&mut self, predictor: &Predictor<'_>) -> Option<()> {
        let mut rows = self.rows();
        let Self { sides, values, scratch } = self;
        match predictor {
            Predictor::Narrow(narrow) => rows.try_for_each(|place| {
                let (own, mut before, row, sums) = narrow.row(values, *sides, place, scratch)?;
                own.inverse(row, sums, &mut before);
                Some(())
            }),
            Predictor::Wide(_) if !Feature::Trained.is_built() => None,
            Predictor::Wide(wide) => {
                let mut short_rows = ShortRows::NEW;
                rows.try_for_each(|place| wide.inverse(values, place, scratch, &mut short_rows))
            }
        }
    }

    /// Writes the ranks behind the fixed fields; returns the length of the segment.
    ///
    /// The class of each rank stands above it from then on.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(
        not(feature = "small"),
        expect(
            clippy::large_stack_frames,
            reason = "the lint counts every copy of the counts; the frame is far smaller"
        )
    )]
    fn write(&mut self, tables: &mut Tables, predictor: &Predictor<'_>, out: &mut [u8]) -> Option<usize> {
        let (fixed, rest) = out.split_at_mut_checked(EXTRA_LEN.end)?;
        let classes = match predictor {
            Predictor::Wide(_) if Feature::Trained.is_built() => Classes::Scaled(Steps::of(self.values)),
            _ => Classes::Nearest,
        };
        let mut extra = BitWriter::new(rest);
        let mut counts = Counts::new(tables);
        let [width, ..] = self.sides;
        for place in self.rows() {
            let (of_row, row) = classes.of_row(self.values, self.sides, place, self.scratch)?;
            for (row, classes) in row.chunks_mut(counts::PIECE).zip(of_row.chunks(counts::PIECE)) {
                for (column, (value, &class)) in row.iter_mut().zip(classes).enumerate() {
                    let rank = value.cast_unsigned();
                    let (token, bits) = token::of_rank(rank);
                    counts.count(column, class, token);
                    if bits > 0 {
                        extra.put(rank, bits)?;
                    }
                    *value |= class << class::PLACE;
                }
                counts.carry(row.len());
            }
        }
        let tables = counts.finish();
        let extra_len = extra.finish()?;
        copy(&u32::try_from(extra_len).ok()?.to_le_bytes(), fixed.get_mut(EXTRA_LEN)?);
        let mut head = BitWriter::new(rest.get_mut(extra_len..)?);
        if Feature::Trained.is_built()
            && let Classes::Scaled(steps) = &classes
        {
            steps.write(&mut head)?;
        }
        match predictor {
            Predictor::Narrow(narrow) => narrow.write(self.sides, &mut head)?,
            Predictor::Wide(_) if !Feature::Trained.is_built() => return None,
            Predictor::Wide(wide) => wide.write(&mut head)?,
        }
        tables.normalise(classes.layout());
        tables.write(classes.layout(), &mut head)?;
        tables.share_out();
        let at = extra_len.wrapping_add(head.finish()?);
        let mut numerals = NumeralWriter::new(rest.get_mut(at..)?);
        for row in self.values.rchunks(width.max(1)) {
            numerals.write_row(tables, row)?;
        }
        Some(numerals.finish()?.wrapping_add(at).wrapping_add(EXTRA_LEN.end))
    }

    /// Reads the ranks: `extra` holds their extra bits, `numerals` all else.
    #[cfg_attr(feature = "small", inline(never))]
    fn read(&mut self, classes: &Classes, tables: &Tables, extra: &[u8], numerals: &[u8]) -> Option<()> {
        let mut numerals = NumeralReader::new(numerals)?;
        let mut extra = BitReader::new(extra);
        for place in self.rows() {
            let (of_row, row) = classes.of_row(self.values, self.sides, place, self.scratch)?;
            numerals.read_row(tables, of_row, row);
            for rank in row {
                if let Some((base, bits)) = token::octave(rank.cast_unsigned()) {
                    *rank = (base | extra.take(bits)).cast_signed();
                }
            }
        }
        (numerals.is_finished() && extra.is_finished()).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Codec, DecodeError, Effort, Header, Malformed, Plan, SampleType, Training, Wavelet, max_encoded_len,
    };

    extern crate std;
    use std::{boxed::Box, vec, vec::Vec};

    fn encode(axes: [u32; 3], sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
        encode_with(Effort::Tabled, axes, sample_type, samples)
    }

    fn encode_with(effort: Effort<'_>, axes: [u32; 3], sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
        let extent = Extent::new(axes).unwrap();
        let plan = Plan::new(Wavelet::Haar, extent, 0).unwrap();
        let mut out = vec![0; max_encoded_len(extent, sample_type).unwrap()];
        let mut scratch = vec![-1; effort.scratch_len(&plan)];
        let mut samples = samples.to_vec();
        let mut codec = Box::new(Codec::NEW);
        let len = codec.encode(effort, &plan, sample_type, &mut samples, &mut scratch, &mut out);
        out.truncate(len.unwrap());
        out
    }

    fn decode(bytes: &[u8]) -> Result<Vec<i32>, DecodeError> {
        let header = Header::parse(bytes)?;
        let mut samples = vec![7; header.samples_len(0)];
        let mut scratch = vec![-1; header.scratch_len()];
        { Codec::NEW }.decode(bytes, &mut samples, &mut scratch)?;
        Ok(samples)
    }

    /// Smooth waves and noise of `amplitude`.
    fn waves([width, height, depth]: [u32; 3], amplitude: u32) -> Vec<i32> {
        let mut seed = 3_u32;
        let mut sample = |[x, y, z]: [u32; 3]| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let wave = ((x * x + 3 * x * y) / 64 + y * z / 16 + 2 * z) % 200;
            (wave + (seed >> 16) % amplitude).cast_signed() - 100
        };
        let rows = (0..depth).flat_map(|z| (0..height).map(move |y| [y, z]));
        rows.flat_map(|[y, z]| (0..width).map(move |x| [x, y, z])).map(&mut sample).collect()
    }

    /// Where the storage field of the header is.
    const STORAGE: usize = 3;

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn slices_and_bricks_come_back() {
        for axes in [
            [128, 128, 1],
            [1, 128, 128],
            [127, 131, 1],
            [2, 4096, 3],
            [33, 31, 17],
            [5, 1, 4000],
            [3, 2, 4096],
        ] {
            for amplitude in [1, 7, 300] {
                let samples = waves(axes, amplitude);
                for (effort, storage) in [(Effort::Tabled, 3), (Effort::Wide(&mut { Training::NEW }), 6)] {
                    let bytes = encode_with(effort, axes, SampleType::I16, &samples);
                    assert_eq!(bytes[STORAGE], storage);
                    assert!(bytes.len() < samples.len() * 2, "{axes:?}");
                    assert_eq!(decode(&bytes).as_ref(), Ok(&samples), "{axes:?} {amplitude}");
                }
            }
        }
    }

    #[test]
    fn equal_samples_take_no_tables() {
        let samples = vec![-5; 128 * 128];
        let bytes = encode([128, 128, 1], SampleType::I32, &samples);
        assert_eq!(bytes[STORAGE], 3);
        assert!(bytes.len() < 24);
        assert_eq!(decode(&bytes).unwrap(), samples);
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn other_samples_are_coded_another_way() {
        let mut samples = waves([128, 128, 1], 9);
        samples[77] = 1 << 19;
        let bytes = encode([128, 128, 1], SampleType::I32, &samples);
        assert_eq!(bytes[STORAGE], 0);
        assert_eq!(decode(&bytes).unwrap(), samples);
        let bytes = encode([1 << 14, 1, 1], SampleType::I16, &waves([1 << 14, 1, 1], 9));
        assert_eq!(bytes[STORAGE], 0);
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn extremes_of_a_span_come_back() {
        for sample_type in [SampleType::U16, SampleType::I32] {
            let samples: Vec<i32> = (0..1 << 14).map(|i| if i * i % 5 < 2 { 65535 } else { 0 }).collect();
            let bytes = encode([16, 32, 32], sample_type, &samples);
            assert_eq!(decode(&bytes).unwrap(), samples);
        }
    }

    /// Of fewer samples than an encoder writes tables for.
    #[test]
    fn small_bricks_decode() {
        for bytes in [
            include_bytes!("../../../../vectors/handmade/tabled_small_brick.wlc").as_slice(),
            include_bytes!("../../../../vectors/handmade/wide_small_brick.wlc"),
        ] {
            assert_eq!(decode(bytes).unwrap().len(), 5 * 6 * 7);
            assert_eq!(decode(&bytes[..bytes.len() - 1]), Err(DecodeError::Truncated));
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn damage_is_told_or_harmless() {
        let samples = waves([16, 32, 32], 5);
        let bytes = encode([16, 32, 32], SampleType::I16, &samples);
        let segment = Header::parse(&bytes).unwrap().header_len();
        for at in segment..bytes.len() {
            for flip in [1, 0x80, 0xFF] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = decode(&damaged);
            }
        }
        let mut cut = bytes.clone();
        cut.pop();
        assert_eq!(decode(&cut), Err(DecodeError::Truncated));
        let mut spans = bytes;
        spans[segment + 7] = 1;
        assert_eq!(decode(&spans), Err(Malformed::Segment.into()));
    }
}
