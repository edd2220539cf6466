//! Instructions and stack of encoding and decoding a brick, and sizes of state.

use fixture::{Effort, crc32, crc32_of_samples, fill_part};
use wavelift_kernel::{Codec, Dense, EncodeError, Extent, Lattice, Plan, SampleType, Training, Wavelet};

use crate::memory::{Efforts, Parts};
use crate::meter::Meter;

/// Samples along each axis of the brick.
const SIDE: u32 = if cfg!(feature = "roomy") { fixture::SIDE } else { 8 };

/// Wavelet, levels and effort.
const CASES: [(Wavelet, u8, Effort); 12] = [
    (Wavelet::Haar, 0, Effort::Light),
    (Wavelet::Linear, 3, Effort::Light),
    (Wavelet::Haar, 0, Effort::Tabled),
    (Wavelet::Haar, 0, Effort::Wide),
    (Wavelet::Haar, 0, Effort::Fast),
    (Wavelet::Haar, 3, Effort::Fast),
    (Wavelet::Linear, 1, Effort::Fast),
    (Wavelet::Linear, 3, Effort::Fast),
    (Wavelet::Quadratic, 3, Effort::Fast),
    (Wavelet::Quintic, 3, Effort::Fast),
    (Wavelet::Haar, 0, Effort::Default),
    (Wavelet::Linear, 3, Effort::Default),
];

/// Measures every case that this build can do; whether all came back.
pub(crate) fn run(meter: &Meter, parts: &mut Parts<'_>) -> bool {
    defmt::println!(
        "state codec={=u32} training={=u32} dense={=u32} lattice={=u32}",
        size_of::<Codec>() as u32,
        size_of::<Training>() as u32,
        size_of::<Dense>() as u32,
        size_of::<Lattice>() as u32
    );
    // What cannot be measured here has not failed.
    CASES.iter().all(|&case| measure(case, meter, parts).unwrap_or(true))
}

/// Measures one case; `None` if this build or this board cannot do it.
fn measure(
    (wavelet, levels, effort): (Wavelet, u8, Effort),
    meter: &Meter,
    parts: &mut Parts<'_>,
) -> Option<bool> {
    let extent = Extent::new([SIDE; 3]).ok()?;
    let plan = Plan::new(wavelet, extent, levels).ok()?;
    let Parts { codec, samples, scratch, bytes, efforts, .. } = parts;
    let lent = Efforts::lend(efforts.as_deref_mut(), effort)?;
    let samples = &mut samples[..extent.samples()];
    let scratch = &mut scratch[..plan.scratch_len()];
    fill_part([0; 3], extent.axes(), samples);
    let original = crc32_of_samples(samples);
    let (encoded, encoding) =
        meter.measure(|| codec.encode(lent, &plan, SampleType::U16, samples, scratch, bytes));
    let len = match encoded {
        Err(EncodeError::NotBuilt(_)) => return None,
        encoded => encoded.ok(),
    };
    let Some(len) = len else { return Some(false) };
    samples.fill(0);
    let (decoded, decoding) = meter.measure(|| codec.decode(&bytes[..len], samples, scratch));
    defmt::println!(
        "brick side={=u32} wavelet={=str} levels={=u8} effort={=str} bytes={=u32} crc32={=u32} scratch={=u32} \
         encode={=u32} encode_stack={=u32} decode={=u32} decode_stack={=u32}",
        SIDE,
        wavelet.name(),
        levels,
        effort.name(),
        len as u32,
        crc32(bytes[..len].iter().copied()),
        (4 * scratch.len()) as u32,
        encoding.instructions,
        encoding.stack,
        decoding.instructions,
        decoding.stack
    );
    Some(decoded.is_ok() && crc32_of_samples(samples) == original)
}
