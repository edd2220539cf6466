//! Whole volumes through the host library, as the program `wavelift` does it, from memory to a file and back.

use std::error::Error;
use std::path::Path;

use serde::Serialize;
use wavelift_host::bound::Deviation;
use wavelift_host::codec::{CompressError, CompressOptions, Container, ContainerError, Part, compress};
use wavelift_host::progress::ignore;
use wavelift_host::volume::Volume;

use crate::ALLOCATOR;
use crate::list::{Bound, Listed};
use crate::stopwatch::least;
use crate::ways;

/// A row of the record.
#[derive(Serialize)]
struct Row<'a> {
    measure: &'static str,
    volume: &'a str,
    task: &'a str,
    codec: &'a str,
    bytes: u64,
    encode_seconds: f64,
    decode_seconds: f64,
    /// Most bytes allocated at once beside the samples that go in, what comes out included.
    encode_memory: usize,
    /// The same for what comes back.
    decode_memory: usize,
    right: bool,
}

/// Prints a row for each way to code a volume.
pub(crate) fn measure(listed: &Listed) -> Result<(), Box<dyn Error>> {
    let original = listed.volume()?;
    let file = tempfile::NamedTempFile::new()?;
    let lossless = if original.element.is_float() { "lossless floats" } else { "lossless" };
    for way in ways::of(listed) {
        let options = way.options()?;
        let (encode_memory, encoded) = peak(|| encode(&original, &options));
        std::fs::write(file.path(), encoded?)?;
        let (decode_memory, decoded) = peak(|| decode(file.path()));
        let right = is_right(&original, &decoded?, way.bound);
        let (encode_time, encoded) = least(|| encode(&original, &options))?;
        let (decode_time, _) = least(|| decode(file.path()))?;
        let row = Row {
            measure: "coding",
            volume: &listed.name,
            task: way.bound.map_or(lossless, |bound| &bound.task),
            codec: &way.codec(),
            bytes: encoded.len() as u64,
            encode_seconds: encode_time.as_secs_f64(),
            decode_seconds: decode_time.as_secs_f64(),
            encode_memory,
            decode_memory,
            right,
        };
        println!("{}", serde_json::to_string(&row)?);
    }
    Ok(())
}

/// Encodes and decodes a volume so often without loss, in the way of `codec`.
pub(crate) fn repeat(
    listed: &Listed,
    codec: &str,
    encodings: u32,
    decodings: u32,
) -> Result<(), Box<dyn Error>> {
    let original = listed.volume()?;
    let way = ways::of(listed).find(|way| way.bound.is_none() && way.codec() == codec);
    let options = way.ok_or_else(|| format!("no codec {codec}"))?.options()?;
    let file = tempfile::NamedTempFile::new()?;
    for _ in 0..encodings {
        std::fs::write(file.path(), encode(&original, &options)?)?;
    }
    for _ in 0..decodings {
        assert_eq!(decode(file.path())?.samples, original.samples, "decoding does not restore");
    }
    Ok(())
}

fn encode(volume: &Volume, options: &CompressOptions) -> Result<Vec<u8>, CompressError> {
    let mut out = Vec::new();
    compress(volume, options, &mut out, &ignore)?;
    Ok(out)
}

fn decode(path: &Path) -> Result<Volume, ContainerError> {
    Container::open(path)?.read(&Part::default(), std::num::NonZeroUsize::new(1), &ignore)
}

/// Most bytes that `work` had allocated at once.
fn peak<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let result = work();
    (ALLOCATOR.peak_usage().saturating_sub(before), result)
}

/// Whether every sample is as it was, or within the bound.
fn is_right(original: &Volume, decoded: &Volume, bound: Option<&Bound>) -> bool {
    let Some(bound) = bound else { return original.samples == decoded.samples };
    original.samples.len() == decoded.samples.len()
        && Deviation::of(original.element, &original.samples, &decoded.samples, bound.absolute)
            .beyond
            .is_none()
}
