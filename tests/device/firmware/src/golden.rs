//! Golden vectors: decoded, compared, encoded again, compared.

use fixture::{Recipe, VECTORS, Vector, crc32_of_samples};
use wavelift_kernel::{DecodeError, EncodeError, Extent, Header, Near, Plan};

use crate::memory::{Efforts, Parts};

/// What became of a vector.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    Passed,
    /// Decoded as it should, but there is no memory to encode it again.
    Decoded,
    /// This build of the kernel lacks what it takes, and says so.
    Refused,
    /// It takes more memory than there is.
    TooLarge,
    Failed,
}

/// Checks every vector; whether none failed.
pub(crate) fn run(parts: &mut Parts<'_>) -> bool {
    let mut counts = [0_u32; 5];
    for vector in VECTORS {
        let outcome = check(vector, parts);
        counts[outcome as usize] += 1;
        match outcome {
            Outcome::Failed => defmt::error!("vector {=str} failed", vector.id),
            Outcome::TooLarge => defmt::debug!("vector {=str} is too large", vector.id),
            _ => {}
        }
    }
    let [passed, decoded, refused, too_large, failed] = counts;
    defmt::println!(
        "vectors passed={=u32} decoded={=u32} refused={=u32} too_large={=u32} failed={=u32}",
        passed,
        decoded,
        refused,
        too_large,
        failed
    );
    failed == 0
}

fn check(vector: &Vector, parts: &mut Parts<'_>) -> Outcome {
    if vector.bytes.starts_with(b"wS") {
        #[cfg(feature = "slabs")]
        return crate::streams::check(vector, parts);
        #[cfg(not(feature = "slabs"))]
        return Outcome::Refused;
    }
    let decoded = match Header::parse(vector.bytes) {
        Ok(header) if !fits(&header, parts) => return Outcome::TooLarge,
        Ok(header) => decode(vector.bytes, &header, parts),
        Err(error) => Err(error),
    };
    match decoded {
        Err(DecodeError::NotBuilt(feature)) if !feature.is_built() => Outcome::Refused,
        decoded if decoded != vector.expected => Outcome::Failed,
        Err(_) => Outcome::Passed,
        Ok(_) => vector.recipe.map_or(Outcome::Passed, |recipe| encode(vector.bytes, recipe, parts)),
    }
}

fn fits(header: &Header, parts: &Parts<'_>) -> bool {
    header.samples_len(0) <= parts.samples.len() && header.scratch_len() <= parts.scratch.len()
}

/// The checksum of the decoded samples.
fn decode(bytes: &[u8], header: &Header, parts: &mut Parts<'_>) -> Result<u32, DecodeError> {
    let Parts { codec, samples, scratch, efforts, .. } = parts;
    let samples = &mut samples[..header.samples_len(0)];
    match efforts {
        Some(Efforts { lattice, .. }) if header.slack().is_some() => {
            lattice.decode(bytes, samples, scratch)?
        }
        Some(Efforts { dense, .. }) if header.is_dense() => {
            codec.decode_dense(dense, bytes, 0, samples, scratch)?
        }
        _ => codec.decode(bytes, samples, scratch)?,
    };
    Ok(crc32_of_samples(samples))
}

/// Whether the samples, just decoded, become the same bytes again.
fn encode(expected: &[u8], recipe: Recipe, parts: &mut Parts<'_>) -> Outcome {
    match encoded_len(recipe, parts) {
        Some(Ok(len)) if parts.bytes.get(..len) == Some(expected) => Outcome::Passed,
        Some(Err(EncodeError::NotBuilt(feature))) if !feature.is_built() => Outcome::Refused,
        Some(_) => Outcome::Failed,
        None => Outcome::Decoded,
    }
}

/// The length of the codestream; `None` if there is no memory to encode it in.
fn encoded_len(recipe: Recipe, parts: &mut Parts<'_>) -> Option<Result<usize, EncodeError>> {
    let Parts { codec, samples, scratch, bytes, efforts, .. } = parts;
    match recipe {
        Recipe::Coded { effort, wavelet, extent, levels, sample_type } => {
            let plan = Plan::new(wavelet, Extent::new(extent).ok()?, levels).ok()?;
            let effort = Efforts::lend(efforts.as_deref_mut(), effort)?;
            let samples = &mut samples[..plan.extent().samples()];
            Some(codec.encode(effort, &plan, sample_type, samples, scratch, bytes))
        }
        Recipe::Lattice { slack, extent, sample_type, original } => {
            let near = Near { extent: Extent::new(extent).ok()?, sample_type, slack };
            let samples = &mut samples[..near.extent.samples()];
            for (sample, bytes) in samples.iter_mut().zip(original.as_chunks().0) {
                *sample = i32::from_le_bytes(*bytes);
            }
            Some(efforts.as_mut()?.lattice.encode(near, samples, scratch, bytes))
        }
        Recipe::Rows { .. } | Recipe::Slabs { .. } => None,
    }
}
