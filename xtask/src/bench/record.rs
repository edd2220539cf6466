//! What was measured, as it is kept.

use serde::{Deserialize, Serialize};

use super::machine::Machine;
use super::volumes::Listed;

/// All of one run of `cargo xtask bench`.
#[derive(Serialize)]
pub(super) struct Record {
    /// As `2026-11-22`.
    pub(super) date: String,
    pub(super) machine: Machine,
    /// What was left out, and why.
    pub(super) notes: Vec<String>,
    pub(super) volumes: Vec<Listed>,
    pub(super) coding: Vec<Coding>,
    pub(super) refused: Vec<Refused>,
    pub(super) lifting: Vec<Lifting>,
    pub(super) memory: Vec<Memory>,
    pub(super) instructions: Vec<Instructions>,
}

/// A row that a measuring program prints.
#[derive(Deserialize)]
#[serde(tag = "measure", rename_all = "snake_case")]
pub(super) enum Row {
    Coding(Coding),
    Refused(Refused),
    Lifting(Lifting),
    Memory(Memory),
}

/// What a task is called in words.
pub(super) fn title(task: &str) -> String {
    match task.strip_prefix("error ") {
        Some(bound) => format!("Error of at most {bound} of the range"),
        None if task == "lossless" => "Integers without loss".to_owned(),
        None => "Floating-point numbers without loss".to_owned(),
    }
}

/// One codec on one volume. Seconds are CPU time on one thread.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Coding {
    pub(super) volume: String,
    /// `lossless`, `lossless floats`, or the name of an error bound.
    pub(super) task: String,
    pub(super) codec: String,
    pub(super) bytes: u64,
    pub(super) encode_seconds: f64,
    pub(super) decode_seconds: f64,
    /// Most bytes allocated at once beside the samples; known of wavelift alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) encode_memory: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) decode_memory: Option<u64>,
    /// Whether the samples came back, within the bound if there is one.
    pub(super) right: bool,
}

impl Coding {
    /// Whether the codec is wavelift, at some effort.
    pub(super) fn is_ours(&self) -> bool {
        is_ours(&self.codec)
    }
}

/// Whether a codec's name is wavelift's, at some effort.
pub(super) fn is_ours(codec: &str) -> bool {
    codec.starts_with("wavelift")
}

/// A codec that does not take a volume.
#[derive(Serialize, Deserialize)]
pub(super) struct Refused {
    pub(super) volume: String,
    pub(super) codec: String,
    pub(super) why: String,
}

/// One wavelet, beside a copy of the same memory.
#[derive(Serialize, Deserialize)]
pub(super) struct Lifting {
    pub(super) wavelet: String,
    pub(super) extent: [u64; 3],
    pub(super) copy_seconds: f64,
    pub(super) forward_seconds: f64,
    pub(super) inverse_seconds: f64,
}

/// Bytes that the kernel borrows to code samples of an extent.
#[derive(Serialize, Deserialize)]
pub(super) struct Memory {
    pub(super) extent: [u64; 3],
    /// An effort, or `lattice` for near-lossless coding.
    pub(super) way: String,
    /// State of the encoder, whatever the extent.
    pub(super) encoder: u64,
    /// State of the decoder.
    pub(super) decoder: u64,
    /// Scratch of the encoder, no less than that of the decoder.
    pub(super) scratch: u64,
    pub(super) samples: u64,
    /// The longest codestream.
    pub(super) output: u64,
}

/// Instructions of coding one sample of a built-in volume.
#[derive(Serialize)]
pub(super) struct Instructions {
    pub(super) volume: String,
    pub(super) codec: String,
    pub(super) encode: f64,
    pub(super) decode: f64,
}
