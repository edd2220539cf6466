//! Coarse levels as samples: the low-pass part of a transform, brought back to the scale of the samples.

use wavelift_kernel::{Extent, Plan, SampleType, Wavelet};

/// Scales the low-pass part that `level` levels of `plan` made back to the samples' own scale, in place: rounded to
/// the nearest (ties upwards) and kept within the type.
///
/// Every level multiplies a constant by the wavelet's gain once per axis that it splits.
/// Samples of u32 are taken to be below 2^31 here; volumes with larger ones offer no levels.
pub(super) fn rescale(plan: &Plan, level: u8, sample_type: SampleType, samples: &mut [i32]) {
    let (numerator, denominator) = plan.wavelet().low_pass_gain();
    let splits = |level| plan.extent().coarsened(level).axes().into_iter().filter(|&n| n > 1).count() as u32;
    let times: u32 = (0..level.min(plan.levels())).map(splits).sum();
    // A brick of 2^27 samples is split 29 times at most, so that 4^times and 3^times times a sample fit.
    let (up, down) = (i128::from(denominator).pow(times), i128::from(numerator).pow(times));
    let range = match sample_type {
        SampleType::U32 => 0..=i32::MAX,
        other => other.range(),
    };
    for sample in samples {
        let scaled = (2 * i128::from(*sample) * up + down).div_euclid(2 * down);
        *sample = scaled.clamp((*range.start()).into(), (*range.end()).into()) as i32;
    }
}

/// Makes `level` of decoded samples of `extent`: their low-pass part under psi_1, whose gain is one.
pub(super) fn coarsen(extent: Extent, level: u8, sample_type: SampleType, samples: &mut Vec<i32>) {
    let levels = level.min(extent.max_levels());
    let plan = Plan::new(Wavelet::Linear, extent, levels).expect("no more levels than the extent allows");
    let mut scratch = vec![0; plan.scratch_len()];
    plan.low_pass(samples, &mut scratch).expect("the lengths are those that the plan asks for");
    samples.truncate(extent.coarsened(levels).samples());
    rescale(&plan, levels, sample_type, samples);
}
