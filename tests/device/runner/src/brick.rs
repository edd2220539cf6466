//! The bricks that the firmware encoded: the host's codestreams have the same bytes.

use std::collections::BTreeMap;

use fixture::{crc32, fill_part};
use wavelift_kernel::{Codec, Effort, Extent, Plan, SampleType, Training, Wavelet, max_encoded_len};

use crate::log::Log;

/// Compares every brick of the log, and says how many there are.
pub(crate) fn compare(log: &Log) -> Result<usize, String> {
    let mut count = 0;
    for brick in log.records("brick").filter(|brick| brick.contains_key("side")) {
        let (len, checksum) = (number(&brick, "bytes")?, number(&brick, "crc32")?);
        let codestream = encode(&brick)?;
        if (len as usize, checksum) != (codestream.len(), crc32(codestream.iter().copied())) {
            return Err(format!(
                "the host encodes this brick in {} other bytes: {brick:?}",
                codestream.len()
            ));
        }
        count += 1;
    }
    if count == 0 { Err("no brick was encoded".to_owned()) } else { Ok(count) }
}

fn encode(brick: &BTreeMap<&str, &str>) -> Result<Vec<u8>, String> {
    let extent = Extent::new([number(brick, "side")?; 3]).map_err(|error| error.to_string())?;
    let wavelet = wavelet(brick)?;
    let levels = number(brick, "levels")?.try_into().map_err(|_| "too many levels")?;
    let plan = Plan::new(wavelet, extent, levels).map_err(|error| error.to_string())?;
    let mut samples = vec![0; extent.samples()];
    fill_part([0; 3], extent.axes(), &mut samples);
    let mut training = Box::new(Training::NEW);
    let effort = match brick.get("effort").copied() {
        Some("light") => Effort::Light,
        Some("tabled") => Effort::Tabled,
        Some("wide") => Effort::Wide(&mut training),
        Some("fast") => Effort::Fast,
        Some("default") => Effort::Default(&mut training),
        _ => return Err(format!("a brick of no effort: {brick:?}")),
    };
    encode_samples(effort, &plan, &mut samples)
}

/// The codestream of 16-bit samples.
pub(crate) fn encode_samples(
    effort: Effort<'_>,
    plan: &Plan,
    samples: &mut [i32],
) -> Result<Vec<u8>, String> {
    let room = max_encoded_len(plan.extent(), SampleType::U16).ok_or("too many samples")?;
    let (mut scratch, mut bytes) = (vec![0; plan.scratch_len()], vec![0; room]);
    let mut codec = Box::new(Codec::NEW);
    let len = codec.encode(effort, plan, SampleType::U16, samples, &mut scratch, &mut bytes);
    bytes.truncate(len.map_err(|error| error.to_string())?);
    Ok(bytes)
}

/// The wavelet that a record names.
pub(crate) fn wavelet(brick: &BTreeMap<&str, &str>) -> Result<Wavelet, String> {
    let wavelet = Wavelet::ALL.into_iter().find(|wavelet| brick.get("wavelet") == Some(&wavelet.name()));
    wavelet.ok_or_else(|| format!("no wavelet: {brick:?}"))
}

/// A number of a record.
pub(crate) fn number(brick: &BTreeMap<&str, &str>, key: &str) -> Result<u32, String> {
    let value = brick.get(key).and_then(|value| value.parse().ok());
    value.ok_or_else(|| format!("no {key}: {brick:?}"))
}
