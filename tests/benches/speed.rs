//! Speed of the kernel on one thread, on the built-in data: `cargo xtask bench`.
//!
//! Times are the least of several runs, because whatever else the machine does only adds to them. Lifting is
//! set beside a copy of the same memory, timed in turn with it, so that the ratio means the same on every
//! machine. Every run checks its answer: what comes back equals what went in.

use std::time::{Duration, Instant};

use conformance::vectors::Manifest;
use wavelift_kernel::{Codec, Extent, Plan, SampleType, Wavelet, max_encoded_len};

const RUNS: usize = 15;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let manifest = Manifest::read()?;
    let (brick_extent, brick) = manifest.data_samples("rt_brick64")?;
    let (slice_extent, slice) = manifest.data_samples("rt_slice512")?;

    println!("Lifting, {:?} i32 samples, all levels, beside memcpy\n", brick_extent.axes());
    println!(
        "{:<12} {:>10} {:>10} {:>10} {:>9} {:>9}",
        "", "memcpy", "forward", "inverse", "forward", "inverse"
    );
    println!("{:<12} {:>10} {:>10} {:>10} {:>9} {:>9}", "wavelet", "ms", "ms", "ms", "/memcpy", "/memcpy");
    for wavelet in Wavelet::ALL {
        lifting(wavelet, brick_extent, &brick)?;
    }
    for (name, extent, samples) in
        [("rt_brick64", brick_extent, &brick), ("rt_slice512", slice_extent, &slice)]
    {
        println!("\nCoding, {name}, {:?} u8 samples\n", extent.axes());
        println!("{:<24} {:>10} {:>10} {:>12} {:>12}", "", "bytes", "bits/", "encode", "decode");
        println!("{:<24} {:>10} {:>10} {:>12} {:>12}", "codec", "", "sample", "MB/s", "MB/s");
        coding("wavelift, no levels", Plan::new(Wavelet::Haar, extent, 0)?, samples)?;
        for wavelet in Wavelet::ALL {
            let plan = Plan::new(wavelet, extent, extent.max_levels())?;
            coding(&format!("wavelift, {}", wavelet.name()), plan, samples)?;
        }
    }
    Ok(())
}

/// Prints the row of a wavelet: a copy, forward and inverse in turn, `RUNS` times.
fn lifting(wavelet: Wavelet, extent: Extent, original: &[i32]) -> Result<(), Box<dyn std::error::Error>> {
    let plan = Plan::new(wavelet, extent, extent.max_levels())?;
    let mut samples = original.to_vec();
    let mut scratch = vec![0; plan.scratch_len()];
    let [mut copy, mut forward, mut inverse] = [Duration::MAX; 3];
    for _ in 0..RUNS {
        copy = copy.min(time(|| std::hint::black_box(&mut samples).copy_from_slice(original)));
        let mut result = Ok(());
        forward = forward.min(time(|| result = plan.forward(&mut samples, &mut scratch)));
        result?;
        inverse = inverse.min(time(|| result = plan.inverse(&mut samples, &mut scratch)));
        result?;
        assert_eq!(samples, original, "{}: the inverse does not restore", wavelet.name());
    }
    let [copy, forward, inverse] = [copy, forward, inverse].map(|time| time.as_secs_f64() * 1e3);
    println!(
        "{:<12} {copy:>10.3} {forward:>10.3} {inverse:>10.3} {:>9.1} {:>9.1}",
        wavelet.name(),
        forward / copy,
        inverse / copy
    );
    Ok(())
}

/// Prints the row of a plan: length and speed. A megabyte is 10^6 bytes of samples, one byte each.
fn coding(name: &str, plan: Plan, original: &[i32]) -> Result<(), Box<dyn std::error::Error>> {
    let sample_type = SampleType::U8;
    let bound = max_encoded_len(plan.extent(), sample_type).ok_or("no bound on the length")?;
    let (mut samples, mut scratch) = (original.to_vec(), vec![0; plan.scratch_len()]);
    let (mut out, mut codec) = (vec![0; bound], Box::new(Codec::NEW));
    let [mut encode, mut decode] = [Duration::MAX; 2];
    let mut bytes = 0;
    for _ in 0..RUNS {
        samples.copy_from_slice(original);
        let mut result = Ok(0);
        encode = encode.min(time(|| {
            result = codec.encode(&plan, sample_type, &mut samples, &mut scratch, &mut out);
        }));
        bytes = result?;
        samples.fill(0);
        let stream = out.get(..bytes).ok_or("longer than the output")?;
        let mut header = None;
        decode = decode.min(time(|| header = Some(codec.decode(stream, &mut samples, &mut scratch))));
        header.transpose()?;
        assert_eq!(samples, original, "{name}: decoding does not restore");
    }
    let count = original.len() as f64;
    let speed = |time: Duration| count / time.as_secs_f64() / 1e6;
    let bits = 8.0 * bytes as f64 / count;
    println!("{name:<24} {bytes:>10} {bits:>10.3} {:>12.1} {:>12.1}", speed(encode), speed(decode));
    Ok(())
}

fn time(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}
