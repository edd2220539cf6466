//! Streams: what comes out does not depend on how input and output are cut into pieces, whatever the samples are, or
//! the bytes.

use arbitrary::{Result, Unstructured};
use conformance::effort::Effort;
use conformance::oracle::coder::rows;
use conformance::oracle::noise::Noise;
use conformance::slabs;
use conformance::streams::{Pieces, agree, decode, decode_fast, encode};
use wavelift_kernel::stream::{RowPlan, SlabPlan};
use wavelift_kernel::{Extent, SampleType, Wavelet};

/// Samples that are taken from a stream.
const MOST_SAMPLES: usize = 1 << 12;

/// Elements of memory that are lent to a decoder.
const MOST_MEMORY: usize = 1 << 16;

/// Decodes a stream, which begins with `wS`, or makes one of the case that any other bytes are.
pub fn check(bytes: &[u8]) {
    if bytes.starts_with(b"wS") {
        arrive_as_rows(bytes);
        arrive_as_slabs(bytes);
    } else {
        let data = &mut Unstructured::new(bytes);
        // Too few bytes make no case.
        let _ = if bytes.len().is_multiple_of(4) { leave_as_slabs(data) } else { leave_as_rows(data) };
    }
}

fn arrive_as_rows(bytes: &[u8]) {
    let plan = RowPlan::parse(bytes).ok().map(|(plan, _)| plan);
    if plan.is_some_and(|plan| plan.fast_decoder_memory_len() > MOST_MEMORY) {
        return;
    }
    let whole = decode(bytes, MOST_SAMPLES, Pieces::Whole);
    for pieces in [Pieces::Of(1), Pieces::UpTo(9, Noise::new(bytes.len() as u64))] {
        let cut = decode(bytes, MOST_SAMPLES, pieces);
        if whole.0.len() > MOST_SAMPLES {
            let common = cut.0.len().min(whole.0.len());
            assert_eq!(cut.0[..common], whole.0[..common], "pieces of an endless stream");
        } else {
            assert_eq!(cut, whole, "the pieces matter");
        }
    }
    let fast = decode_fast(bytes, MOST_SAMPLES, Pieces::Whole);
    if whole.0.len() <= MOST_SAMPLES && fast.0.len() <= MOST_SAMPLES {
        assert!(agree(&whole, &fast), "the least memory: {:?}, more: {:?}", whole.1, fast.1);
        // The kernel stops at the first wrong sample, the oracle at the end of a strip.
        let are_strips_short =
            plan.is_none_or(|plan| plan.width() as usize * plan.strip() as usize <= MOST_MEMORY);
        if whole.1.is_ok() || are_strips_short {
            let oracle = rows::decode(bytes).ok().map(|(slice, rest)| (slice.samples, rest.len()));
            let kernel = whole.1.ok().map(|left| (whole.0, left));
            assert_eq!(kernel, oracle, "the kernel, and the oracle");
        }
    }
}

fn arrive_as_slabs(bytes: &[u8]) {
    // A few bytes make as many samples as a slab has.
    if SlabPlan::parse(bytes).is_ok_and(|(plan, _)| plan.samples_len() > MOST_SAMPLES) {
        return;
    }
    let whole = slabs::decode(bytes, MOST_MEMORY);
    for piece in [1, 7] {
        assert_eq!(slabs::decode(bytes, piece), whole, "pieces of {piece}");
    }
}

fn leave_as_rows(data: &mut Unstructured<'_>) -> Result<()> {
    let (wavelet, sample_type) = (*data.choose(&Wavelet::ALL)?, *data.choose(&SampleType::ALL)?);
    let (width, levels) = (data.int_in_range(1..=40)?, data.int_in_range(0..=8)?);
    let plan = RowPlan::new(wavelet, width, levels, sample_type).expect("a plan of rows");
    let plan = plan.with_strip(data.int_in_range(1..=40)?);
    let rows = data.int_in_range(0..=40)?;
    let (most, seed) = (data.int_in_range(1..=80)?, data.arbitrary()?);
    let samples = crate::samples::fill(data, sample_type, width as usize * rows)?;
    let stream = encode(&plan, &samples, Pieces::Whole);
    let cut = encode(&plan, &samples, Pieces::UpTo(most, Noise::new(seed)));
    assert_eq!(cut, stream, "the pieces matter");
    let decoded = decode(&stream, MOST_SAMPLES, Pieces::UpTo(most, Noise::new(seed)));
    assert_eq!(decoded, (samples.clone(), Ok(0)), "there and back");
    let decoded = decode_fast(&stream, MOST_SAMPLES, Pieces::UpTo(most, Noise::new(seed)));
    assert_eq!(decoded, (samples, Ok(0)), "there and back in more memory");
    Ok(())
}

fn leave_as_slabs(data: &mut Unstructured<'_>) -> Result<()> {
    let (wavelet, sample_type) = (*data.choose(&Wavelet::ALL)?, *data.choose(&SampleType::ALL)?);
    let axes = [data.int_in_range(1..=9)?, data.int_in_range(1..=9)?, data.int_in_range(1..=5)?];
    let extent = Extent::new(axes).expect("a small extent");
    let levels = data.int_in_range(0..=extent.max_levels())?;
    let plan = SlabPlan::new(wavelet, extent, levels, sample_type).expect("a plan of slabs");
    let (slices, piece) = (data.int_in_range(0..=12)?, data.int_in_range(1..=80)?);
    let effort = *data.choose(&Effort::ALL)?;
    let samples = crate::samples::fill(data, sample_type, (axes[0] * axes[1]) as usize * slices)?;
    let made = |piece| slabs::encode(&plan, effort, &samples, piece);
    let stream = made(MOST_MEMORY);
    assert_eq!(made(piece), stream, "pieces of {piece}");
    assert_eq!(slabs::decode(&stream, piece), (samples, Ok(0)), "there and back");
    Ok(())
}
