//! Lifting by each wavelet beside a copy of the same memory, timed in turn with it, so that the ratio means the same
//! on every machine.

use std::error::Error;
use std::hint::black_box;
use std::time::Duration;

use conformance::vectors::Manifest;
use serde_json::json;
use wavelift_kernel::{Extent, Plan, Wavelet};

use crate::stopwatch::time;

const RUNS: usize = 15;

/// Prints a row for each wavelet, on the built-in brick, at all levels.
pub(crate) fn measure() -> Result<(), Box<dyn Error>> {
    let (extent, samples) = Manifest::read()?.data_samples("rt_brick64")?;
    Wavelet::ALL.into_iter().try_for_each(|wavelet| measure_one(wavelet, extent, &samples))
}

fn measure_one(wavelet: Wavelet, extent: Extent, original: &[i32]) -> Result<(), Box<dyn Error>> {
    let plan = Plan::new(wavelet, extent, extent.max_levels())?;
    let mut samples = original.to_vec();
    let mut scratch = vec![0; plan.scratch_len()];
    let [mut copy, mut forward, mut inverse] = [Duration::MAX; 3];
    for _ in 0..RUNS {
        copy = copy.min(time(|| black_box(&mut samples).copy_from_slice(original)));
        let mut result = Ok(());
        forward = forward.min(time(|| result = plan.forward(&mut samples, &mut scratch)));
        result?;
        inverse = inverse.min(time(|| result = plan.inverse(&mut samples, &mut scratch)));
        result?;
        assert_eq!(samples, original, "{}: the inverse does not restore", wavelet.name());
    }
    let row = json!({
        "measure": "lifting",
        "wavelet": wavelet.name(),
        "extent": extent.axes(),
        "copy_seconds": copy.as_secs_f64(),
        "forward_seconds": forward.as_secs_f64(),
        "inverse_seconds": inverse.as_secs_f64(),
    });
    println!("{row}");
    Ok(())
}
