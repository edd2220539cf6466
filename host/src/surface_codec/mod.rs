//! Files of surfaces: a base mesh, then wavelet coefficients bit plane by bit plane, so that every beginning of a file is a
//! surface, and a better one with every byte.
//!
//! The format is in `docs/surface.md`. Coding is that of the kernel. Coefficients are in local frames, the normal and two
//! tangents of the coarser level, as in Khodakovsky, Schröder & Sweldens, *Progressive Geometry Compression*, SIGGRAPH
//! 2000; instead of their zerotrees, each bit is coded under what its neighbours, parents and siblings say, mixed.

mod base_points;
mod base_segment;
mod connectivity;
mod contexts;
mod decode;
mod deviation;
mod encode;
mod error;
mod frames;
mod header;
mod number;
mod order;
mod planes;
mod quantizer;
mod rebuild;
mod regions;
#[cfg(test)]
mod tests;

use std::num::NonZeroU32;

pub use decode::{Limits, decode, decode_level, decode_region, levels, regions};
pub use deviation::Deviation;
pub use encode::{Encoded, arranged, encode};
pub use error::{DecodeError, EncodeError};

use crate::subdivision::Hierarchy;
use crate::surface_wavelet::Basis;
use planes::Part;
use regions::Regions;

/// How precise a file is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Precision {
    /// Steps of quantization of this size, in world units, for a coefficient that moves one vertex by one.
    Step(f64),
    /// A root mean square deviation along normals of at most this, in world units; see [`Deviation`].
    Rms(f64),
    /// As good as so many bytes allow, but never less than the base mesh.
    Bytes(usize),
    /// Points rounded to multiples of `unit`, and then without loss.
    Lossless {
        /// Of coordinates, in world units; no coordinate may be 2^26 units or more.
        unit: f64,
    },
}

/// How a surface is encoded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Wavelets. [`Basis::Bicubic`] makes the smallest files, without loss too; but beginnings of lossless files are better
    /// with [`Basis::Bilinear`], which keeps the precision of coarse levels.
    pub basis: Basis,
    /// How precise the file is to be.
    pub precision: Precision,
    /// Tangential parts of coefficients are quantized 2 to this power as coarsely, at most 16.
    pub tangential: u8,
    /// If given, runs of so many faces of the base mesh are coded on their own.
    pub faces_per_region: Option<NonZeroU32>,
}

impl Settings {
    /// What is best for most surfaces.
    pub const fn new(precision: Precision) -> Self {
        Self { basis: Basis::Bicubic, precision, tangential: 2, faces_per_region: None }
    }
}

/// The parts of a file, in order.
fn parts<'a>(hierarchy: &Hierarchy, regions: Option<&'a Regions>) -> impl Iterator<Item = Part<'a>> {
    let steps = hierarchy.steps().len();
    let shared = if regions.is_some() { Regions::shared_steps(hierarchy) } else { steps };
    let first = Part { base: true, steps: 0..shared, region: None, until: steps };
    let rest = regions.into_iter().flat_map(move |regions| {
        (0..regions.len() as u32).map(move |region| Part {
            base: false,
            steps: shared..steps,
            region: Some((regions, region)),
            until: steps,
        })
    });
    std::iter::once(first).chain(rest)
}
