//! Instructions and stack of encoding and decoding a brick, and sizes of state.

use fixture::{crc32, crc32_of_samples, fill_part};
use wavelift_kernel::{Codec, Dense, Effort, Extent, Feature, Lattice, Plan, SampleType, Training, Wavelet};

use crate::memory::Parts;
use crate::meter::Meter;

/// Samples along each axis of the brick.
const SIDE: u32 = if cfg!(feature = "roomy") { fixture::SIDE } else { 8 };

/// Wavelet, levels, and whether predictors are trained.
const CASES: [(Wavelet, u8, bool); 8] = [
    (Wavelet::Haar, 0, false),
    (Wavelet::Haar, 3, false),
    (Wavelet::Linear, 1, false),
    (Wavelet::Linear, 3, false),
    (Wavelet::Quadratic, 3, false),
    (Wavelet::Quintic, 3, false),
    (Wavelet::Haar, 0, true),
    (Wavelet::Linear, 3, true),
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
    (wavelet, levels, trained): (Wavelet, u8, bool),
    meter: &Meter,
    parts: &mut Parts<'_>,
) -> Option<bool> {
    let extent = Extent::new([SIDE; 3]).ok()?;
    let plan = Plan::new(wavelet, extent, levels).ok()?;
    let Parts { codec, samples, scratch, bytes, efforts } = parts;
    let effort = match (trained, efforts) {
        (false, _) => Effort::Fast,
        (true, Some(efforts)) if Feature::Trained.is_built() => Effort::Default(&mut efforts.training),
        (true, _) => return None,
    };
    let samples = &mut samples[..extent.samples()];
    let scratch = &mut scratch[..plan.scratch_len()];
    fill_part([0; 3], extent.axes(), samples);
    let original = crc32_of_samples(samples);
    let (encoded, encoding) =
        meter.measure(|| codec.encode(effort, &plan, SampleType::U16, samples, scratch, bytes));
    let Ok(len) = encoded else { return Some(false) };
    samples.fill(0);
    let (decoded, decoding) = meter.measure(|| codec.decode(&bytes[..len], samples, scratch));
    defmt::println!(
        "brick side={=u32} wavelet={=str} levels={=u8} trained={=u8} bytes={=u32} crc32={=u32} scratch={=u32} \
         encode={=u32} encode_stack={=u32} decode={=u32} decode_stack={=u32}",
        SIDE,
        wavelet.name(),
        levels,
        u8::from(trained),
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
