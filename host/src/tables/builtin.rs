//! The slice and the brick that the program carries, so that its tables need no file.

use super::Reference;
use crate::volume::{ElementType, FileFormat, Metadata, Volume};

/// A volume that the program carries, and the text's figures for one of its kind.
#[derive(Clone, Debug)]
pub struct BuiltIn {
    /// What it is.
    pub title: &'static str,
    /// Samples of `u8`.
    pub volume: Volume,
    /// Code lengths in the text.
    pub reference: Reference,
}

/// A horizontal slice of 512x512 and a brick of 64^3 samples from a simulation of Rayleigh-Taylor mixing.
///
/// The simulation in the text (Lawrence Livermore National Laboratory, 512^3 samples) is not available; this is
/// another of the same kind, described in `vectors/MANIFEST.toml`, so the text's figures are of the same kind too.
pub fn built_in() -> [BuiltIn; 2] {
    [
        BuiltIn {
            title: "Slice of Rayleigh-Taylor mixing",
            volume: volume([512, 512, 1], include_bytes!("../../../vectors/rt_slice512_512x512x1_u8.raw")),
            reference: Reference { table: "Table 3.5", percents: [51.0, 35.6, 35.8, 39.5, 37.6, 52.6] },
        },
        BuiltIn {
            title: "Brick of Rayleigh-Taylor mixing",
            volume: volume([64, 64, 64], include_bytes!("../../../vectors/rt_brick64_64x64x64_u8.raw")),
            reference: Reference { table: "Table 3.6", percents: [34.5, 29.4, 29.0, 26.7, 35.0, 56.6] },
        },
    ]
}

fn volume(extent: [u64; 3], samples: &[u8; 1 << 18]) -> Volume {
    let rank = if extent[2] > 1 { 3 } else { 2 };
    Volume {
        extent,
        element: ElementType::U8,
        samples: samples.to_vec(),
        metadata: Metadata::plain(rank, FileFormat::Raw),
    }
}
