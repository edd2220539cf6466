//! What the records of a container say.

use serde::{Deserialize, Serialize};
use wavelift_kernel::Wavelet;

use super::choice::Transform;
use super::{ContainerError, Effort, Form, Grid, Statistics};
use crate::bound::Bound;
use crate::volume::{ElementType, Header, Metadata};

/// What is the same for every time step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// The version of the program that began the file.
    pub program: String,
    /// Samples along x, y, z.
    pub extent: [u64; 3],
    /// Values of a sample.
    pub components: u32,
    /// Type of a value.
    pub element: ElementType,
    /// Names of the components, where they have some.
    pub names: Vec<String>,
}

impl Head {
    /// Whether a head that was read makes sense.
    pub(super) fn is_sound(&self) -> bool {
        let values = self.header(1, Metadata::plain(3, crate::volume::FileFormat::Raw)).bytes();
        let has_names = self.names.is_empty() || self.names.len() as u64 == u64::from(self.components);
        self.components > 0 && !self.extent.contains(&0) && values.is_some() && has_names
    }

    /// The header of a file of so many time steps.
    pub const fn header(&self, steps: u64, metadata: Metadata) -> Header {
        let Self { extent, components, element, .. } = *self;
        Header { extent, components, steps, element, metadata }
    }
}

/// How the bricks of a time step are coded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Its number, from 0.
    pub number: u64,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Its time, in whatever unit, if that is known.
    pub time: Option<f64>,
    /// Samples of a brick along x, y, z.
    pub sides: [u32; 3],
    /// One for each component.
    pub channels: Vec<Channel>,
}

/// How the bricks of one component of a time step are coded: a volume of single values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// The effort of the encoder; a reader has no use for it.
    pub effort: Effort,
    /// The wavelet, or none.
    pub wavelet: Option<Wavelet>,
    /// Levels of the transform of a whole brick.
    pub levels: u8,
    /// The coarsest level that can be read; 0 is full resolution.
    pub readable_levels: u8,
    /// What its integers stand for.
    pub form: Form,
    /// The bound that samples were kept to; `None` for every bit.
    pub bound: Option<Bound>,
}

impl Channel {
    /// Whether a level is made of a part of a brick's bytes: bricks without a transform are decoded whole for any, so
    /// that a level takes as long as full resolution does.
    pub const fn has_quick_levels(&self) -> bool {
        self.readable_levels > 0 && (self.wavelet.is_some() || self.form.slack().is_some())
    }

    /// The transform of the bricks.
    pub(super) const fn transform(&self) -> Transform {
        Transform { wavelet: self.wavelet, levels: self.levels }
    }
}

impl Step {
    /// How the volume is cut into bricks.
    pub const fn grid(&self, head: &Head) -> Grid {
        Grid { extent: head.extent, sides: self.sides }
    }

    /// The coarsest level that all components can be read at.
    pub fn readable_levels(&self) -> u8 {
        self.channels.iter().map(|channel| channel.readable_levels).min().unwrap_or(0)
    }

    /// Checks a step against itself and the head.
    pub(super) fn check(&self, head: &Head) -> Result<(), &'static str> {
        if !self.grid(head).is_sound() || self.channels.len() as u64 != u64::from(head.components) {
            return Err("its bricks or components are not those of the extent");
        }
        self.channels.iter().try_for_each(|channel| check(channel, &self.grid(head), head.element))
    }
}

fn check(channel: &Channel, grid: &Grid, element: ElementType) -> Result<(), &'static str> {
    let Channel { wavelet, levels, readable_levels, ref form, bound, .. } = *channel;
    let deepest = grid.max_levels();
    let transformed = if wavelet.is_some() { levels } else { deepest };
    if levels > deepest
        || readable_levels > transformed.min(grid.aligned_levels())
        || readable_levels > 0 && !form.has_levels(element)
        || (levels > 0) != wavelet.is_some()
        || (form.values().is_some() || form.slack().is_some()) && wavelet.is_some()
    {
        return Err("what it says of levels and form is contradictory");
    }
    if !form.suits(element) || !bound.is_none_or(Bound::is_sound) {
        return Err("what it says of bound and scale is contradictory");
    }
    Ok(())
}

/// Which brick something is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Place {
    /// Number of the time step, from 0.
    pub step: u64,
    /// Number of the brick in the [`Grid`] of the step.
    pub brick: u64,
    /// Number of the component, from 0.
    pub component: u32,
}

/// The record of a brick: what follows it, and how to tell whether that is whole.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrickLabel {
    /// Which one it is.
    pub place: Place,
    /// Bytes of each of its codestreams.
    pub lengths: Vec<u32>,
    /// What follows them in a volume on a scale; `None` for a brick that is coded exactly, without a transform.
    pub exceptions: Option<Kept>,
    /// CRC-32 of its codestreams and exceptions.
    #[serde(with = "postcard::fixint::le")]
    pub stored_crc: u32,
    /// CRC-32 of its samples as they are decoded, little-endian in their own type, x fastest.
    #[serde(with = "postcard::fixint::le")]
    pub samples_crc: u32,
    /// The low two bytes of the CRC-32 of what makes level 1, 2, …, the beginning of its codestream and its exceptions;
    /// none where levels are made of the whole.
    pub level_checks: Vec<[u8; 2]>,
}

impl BrickLabel {
    /// Bytes of its codestreams together, and of its exceptions: what follows the record.
    pub fn bytes(&self) -> u64 {
        let exceptions = self.exceptions.map(|kept| kept.bytes);
        self.lengths.iter().copied().chain(exceptions).map(u64::from).sum()
    }
}

/// The samples of a brick whose bits are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kept {
    /// How many there are.
    pub samples: u32,
    /// Bytes that their [`Exceptions`](crate::bound::Exceptions) take, 0 if there are none.
    pub bytes: u32,
}

/// What the samples of one component of a time step are like.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// Samples whose bits are kept beside a scale.
    pub exceptions: u64,
    /// Bricks that are coded exactly, though the volume is on a scale.
    pub exact_bricks: u64,
    /// One for each brick; `None` where no sample is finite.
    pub bricks: Vec<Option<Statistics>>,
}

impl Summary {
    /// Adds the next brick of a volume, which is on a scale or not.
    pub(super) fn add(&mut self, form: &Form, kept: Option<Kept>, statistics: Option<Statistics>) {
        if form.scale().is_some() {
            self.exceptions += kept.map_or(0, |kept| kept.samples.into());
            self.exact_bricks += u64::from(kept.is_none());
        }
        self.bricks.push(statistics);
    }

    /// The ends of the finite samples of all bricks. `None` if there are none.
    pub fn range(&self, element: ElementType) -> Option<[f64; 2]> {
        let ends = self.bricks.iter().flatten().map(|brick| [brick.min(element), brick.max(element)]);
        ends.reduce(|[min, max], [low, high]| [min.min(low), max.max(high)])
    }
}

/// The last record: the bytes of every other, from which their places follow, as there are no gaps.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Index {
    pub(super) head: u32,
    pub(super) metadata: u32,
    pub(super) steps: Vec<StepEntry>,
    pub(super) statistics: u32,
}

/// The bytes of the record of a step; of each of its bricks with what follows it, all components of the first, then of
/// the second, and so on, 0 for one that is lost; and of the copies behind them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct StepEntry {
    pub(super) record: u32,
    pub(super) bricks: Vec<u32>,
    pub(super) copies: u32,
}

/// What is wrong with the file outside the bricks.
pub(super) const fn damaged(what: &'static str) -> ContainerError {
    ContainerError::Damaged(what)
}
