//! Instructions and stack of encoding and decoding streams of slabs and of rows.

#[cfg(feature = "streams")]
use fixture::SLICE;
use fixture::{Effort, SLABS, SLABS_OF_ROWS, VOLUME, crc32, crc32_of_samples, fill_part};
#[cfg(feature = "streams")]
use wavelift_kernel::stream::{RowDecoder, RowEncoder, RowPlan};
use wavelift_kernel::stream::{SlabDecoder, SlabEncoder, SlabMemory, SlabPlan, Status, Step};
use wavelift_kernel::{DecodeError, EncodeError, Extent, SampleType, Wavelet};

use crate::memory::{Efforts, Parts};
use crate::meter::{Meter, Taken};
use crate::streams::Encoder;

const WAVELET: Wavelet = Wavelet::Linear;
const LEVELS: u8 = 3;

/// Measures every stream that this build can make; whether all came back.
pub(crate) fn run(meter: &Meter, parts: &mut Parts<'_>) -> bool {
    let cases = [
        ("slabs", SLABS, Effort::Light),
        ("slabs", SLABS, Effort::Fast),
        ("slabs_of_rows", SLABS_OF_ROWS, Effort::Light),
    ];
    let mut passed = true;
    for case in cases {
        // What cannot be measured here has not failed.
        passed &= slabs(case, meter, parts).unwrap_or(true);
    }
    #[cfg(feature = "streams")]
    {
        passed &= rows(meter, parts).unwrap_or(true);
    }
    passed
}

/// Measures a volume in slabs, of such extents; `None` if this build cannot make them.
fn slabs(
    (kind, [volume, slab], effort): (&str, [[u32; 3]; 2], Effort),
    meter: &Meter,
    parts: &mut Parts<'_>,
) -> Option<bool> {
    let plan = SlabPlan::new(WAVELET, Extent::new(slab).ok()?, LEVELS, SampleType::U16).ok()?;
    let Parts { codec, samples, scratch, bytes, efforts, .. } = parts;
    let (samples, name) = (&mut samples[..VOLUME], effort.name());
    let (slab, scratch) = scratch.split_at_mut(plan.samples_len());
    let (room, bytes) = bytes.split_at_mut(plan.bytes_len());
    let memory = 4 * (plan.samples_len() + plan.scratch_len()) + plan.bytes_len();
    fill_part([0; 3], volume, samples);
    let original = crc32_of_samples(samples);

    let lent = SlabMemory { samples: &mut *slab, scratch: &mut *scratch, bytes: &mut *room };
    let effort = Efforts::lend(efforts.as_deref_mut(), effort)?;
    let encoder = match SlabEncoder::new(&plan, codec, effort, lent) {
        Err(EncodeError::NotBuilt(_)) => return None,
        encoder => encoder.ok(),
    };
    let Some(encoder) = encoder else { return Some(false) };
    let (encoded, encoding) = meter.measure(|| encode(encoder, samples, bytes));
    let Some(len) = encoded else { return Some(false) };

    samples.fill(0);
    let lent = SlabMemory { samples: slab, scratch, bytes: room };
    let Ok((parsed, header)) = SlabPlan::parse(&bytes[..len]) else { return Some(false) };
    let Ok(mut decoder) = SlabDecoder::new(&parsed, codec, lent) else { return Some(false) };
    let (decoded, decoding) =
        meter.measure(|| decode(&bytes[header..len], samples, |input, output| decoder.step(input, output)));
    print(kind, name, memory, &bytes[..len], [encoding, decoding]);
    Some(decoded && crc32_of_samples(samples) == original)
}

/// Measures rows; `None` if this build cannot make them.
#[cfg(feature = "streams")]
fn rows(meter: &Meter, parts: &mut Parts<'_>) -> Option<bool> {
    let [width, height] = SLICE;
    let plan = RowPlan::new(WAVELET, width, LEVELS, SampleType::U16).ok()?;
    let Parts { rows, samples, scratch, bytes, .. } = parts;
    let (samples, memory) = (&mut samples[..VOLUME], 4 * plan.decoder_memory_len());
    fill_part([0; 3], [width, height, 1], samples);
    let original = crc32_of_samples(samples);

    let lent = &mut scratch[..plan.encoder_memory_len()];
    let Ok(encoder) = RowEncoder::new(&plan, rows, lent) else { return Some(false) };
    let (encoded, encoding) = meter.measure(|| encode(encoder, samples, bytes));
    let Some(len) = encoded else { return Some(false) };

    samples.fill(0);
    let Ok((parsed, header)) = RowPlan::parse(&bytes[..len]) else { return Some(false) };
    let lent = &mut scratch[..parsed.decoder_memory_len()];
    let Ok(mut decoder) = RowDecoder::new(&parsed, rows, lent) else { return Some(false) };
    let (decoded, decoding) =
        meter.measure(|| decode(&bytes[header..len], samples, |input, output| decoder.step(input, output)));
    print("rows", Effort::Fast.name(), memory, &bytes[..len], [encoding, decoding]);
    Some(decoded && crc32_of_samples(samples) == original)
}

/// The length of the stream of all samples; `None` if it does not fit.
fn encode(mut encoder: impl Encoder, mut samples: &[i32], bytes: &mut [u8]) -> Option<usize> {
    let mut len = 0;
    loop {
        let step = encoder.step(samples, &mut bytes[len..]).ok()?;
        (samples, len) = (&samples[step.consumed..], len + step.produced);
        match step.status {
            Status::NeedInput => encoder.finish().ok()?,
            Status::NeedOutput => return None,
            Status::Done => return Some(len),
        }
    }
}

/// Whether a stream holds as many samples as there is room for.
fn decode(
    mut bytes: &[u8],
    samples: &mut [i32],
    mut step: impl FnMut(&[u8], &mut [i32]) -> Result<Step, DecodeError>,
) -> bool {
    let mut count = 0;
    loop {
        let Ok(step) = step(bytes, &mut samples[count..]) else { return false };
        (bytes, count) = (&bytes[step.consumed..], count + step.produced);
        match step.status {
            Status::Done => return count == samples.len(),
            _ if step.consumed + step.produced == 0 => return false,
            _ => {}
        }
    }
}

/// `memory` is what is lent beside the codec, in bytes.
fn print(kind: &str, effort: &str, memory: usize, stream: &[u8], [encoding, decoding]: [Taken; 2]) {
    defmt::println!(
        "stream kind={=str} wavelet={=str} levels={=u8} effort={=str} samples={=u32} memory={=u32} bytes={=u32} \
         crc32={=u32} encode={=u32} encode_stack={=u32} decode={=u32} decode_stack={=u32}",
        kind,
        WAVELET.name(),
        LEVELS,
        effort,
        VOLUME as u32,
        memory as u32,
        stream.len() as u32,
        crc32(stream.iter().copied()),
        encoding.instructions,
        encoding.stack,
        decoding.instructions,
        decoding.stack
    );
}
