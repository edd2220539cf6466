//! What the rounds came to in which base meshes are made finer.

use std::fmt::{self, Display, Formatter};

use super::fit::Fit;

/// A surface that was made, over one base mesh of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Vertices of the base mesh.
    pub base: usize,
    /// How often it was split.
    pub levels: u32,
    /// Vertices of the finest mesh.
    pub vertices: usize,
    /// The larger root mean square distance of surface and target from each other, in cells' edges.
    pub rms: f64,
    /// How far the target is from the surface at most, in cells' edges.
    pub most: f64,
}

impl Round {
    pub(super) const fn new([base, vertices]: [usize; 2], levels: u32, fit: &Fit) -> Self {
        Self { base, levels, vertices, rms: fit.rms(), most: fit.backward.most }
    }
}

impl Display for Round {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let Self { base, levels, vertices, rms, most } = self;
        let (rms, most) = (100.0 * rms, 100.0 * most);
        let times = match levels {
            0 => "not split,".to_owned(),
            1 => format!("split once to {vertices}:"),
            2 => format!("split twice to {vertices}:"),
            _ => format!("split {levels} times to {vertices}:"),
        };
        write!(formatter, "base of {base} vertices, {times} {rms:.2} % rms, {most:.0} % at most")
    }
}

/// All surfaces that were made, and why there are no more.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounds {
    /// Each with a finer base mesh than the one before. The surface is the one that fits best.
    pub made: Vec<Round>,
    /// Why there are no more.
    pub end: End,
}

/// Why the base mesh was made no finer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The surface fits.
    Fits,
    /// As many rounds as were asked for are done.
    Asked,
    /// The last round gained too little for another one to be worth its time.
    NoGain,
    /// Where the surface does not fit, the base mesh is as fine as the target already.
    Finest,
}

impl Display for End {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Fits => "the surface fits",
            Self::Asked => "no more rounds were asked for",
            Self::NoGain => "the last round gained too little",
            Self::Finest => "where the surface does not fit, the base mesh is as fine as can be",
        })
    }
}
