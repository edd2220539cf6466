//! Parts of a data set, as they are asked for.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use super::grid::per_axis;
use super::{Brick, Container, ContainerError, Grid};

/// A box of samples: `from` up to but without `to`, along x, y, z of the volume at full resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The first sample.
    pub from: [u64; 3],
    /// One beyond the last; `u64::MAX` for the end of the axis.
    pub to: [u64; 3],
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = per_axis(|axis| format!("{}:{}", self.from[axis], self.to[axis]));
        write!(f, "{x},{y},{z}")
    }
}

/// From where to where along x, y and z.
impl From<[Range<u64>; 3]> for Region {
    fn from(ranges: [Range<u64>; 3]) -> Self {
        Self { from: per_axis(|axis| ranges[axis].start), to: per_axis(|axis| ranges[axis].end) }
    }
}

/// The samples of a brick.
impl From<Brick> for Region {
    fn from(Brick { origin, sides }: Brick) -> Self {
        Self { from: origin, to: per_axis(|axis| origin[axis] + u64::from(sides[axis])) }
    }
}

impl Region {
    /// The same with ends in place of `u64::MAX`; `None` if it is empty, or not inside a volume of `extent`.
    pub(super) fn within(self, extent: [u64; 3]) -> Option<Self> {
        let region = self.ending(extent);
        let is_inside =
            (0..3).all(|axis| region.from[axis] < region.to[axis] && region.to[axis] <= extent[axis]);
        is_inside.then_some(region)
    }

    fn ending(self, extent: [u64; 3]) -> Self {
        let end = |axis: usize| if self.to[axis] == u64::MAX { extent[axis] } else { self.to[axis] };
        Self { to: per_axis(end), ..self }
    }

    /// Samples along each axis.
    pub(super) fn sides(&self) -> [u64; 3] {
        per_axis(|axis| self.to[axis] - self.from[axis])
    }

    /// Whether there are samples in both.
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.from[axis] < other.to[axis] && other.from[axis] < self.to[axis])
    }
}

/// A text that is not of the form `X0:X1,Y0:Y1,Z0:Z1`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is not a region: write X0:X1,Y0:Y1,Z0:Z1, each end beyond its beginning")]
pub struct RegionError(String);

impl FromStr for Region {
    type Err = RegionError;

    fn from_str(text: &str) -> Result<Self, RegionError> {
        let range = |text: &str| -> Option<[u64; 2]> {
            let (from, to) = text.split_once(':')?;
            Some([from.trim().parse().ok()?, to.trim().parse().ok()?]).filter(|[from, to]| from < to)
        };
        let ranges: Option<Vec<[u64; 2]>> = text.split(',').map(range).collect();
        let mut ranges =
            ranges.filter(|ranges| ranges.len() <= 3).ok_or_else(|| RegionError(text.to_owned()))?;
        ranges.resize(3, [0, u64::MAX]);
        Ok(Self { from: per_axis(|axis| ranges[axis][0]), to: per_axis(|axis| ranges[axis][1]) })
    }
}

/// Which samples of a data set are wanted. The default is all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// 0 for full resolution; level L keeps every 2^L-th position along each axis, from the volume's first on.
    pub level: u8,
    /// The box, at full resolution; `None` for the whole volume.
    pub region: Option<Region>,
    /// The time step; `None` for all.
    pub step: Option<u64>,
    /// The component; `None` for all.
    pub component: Option<u32>,
}

impl Part {
    /// A region at full resolution, of all steps and components: `Part::region([10..60, 20..40, 3..5])`, x, y and z.
    pub fn region(region: impl Into<Region>) -> Self {
        Self { region: Some(region.into()), ..Self::default() }
    }

    /// The whole at a level.
    pub fn level(level: u8) -> Self {
        Self { level, ..Self::default() }
    }
}

/// A [`Part`] that is known to exist: samples `from .. to` of the level.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) level: u8,
    pub(super) from: [u64; 3],
    pub(super) to: [u64; 3],
    pub(super) steps: Range<u64>,
    pub(super) components: Range<u32>,
}

impl Wanted {
    pub(super) fn extent(&self) -> [u64; 3] {
        per_axis(|axis| self.to[axis] - self.from[axis])
    }

    /// The same, of planes `from .. to` of the level only.
    pub(super) fn planes(&self, from: u64, to: u64) -> Self {
        let [[x0, y0, _], [x1, y1, _]] = [self.from, self.to];
        Self { from: [x0, y0, from], to: [x1, y1, to], ..self.clone() }
    }

    /// The same, of rows `from .. to` of the level only.
    pub(super) fn rows(&self, from: u64, to: u64) -> Self {
        let [[x0, _, z0], [x1, _, z1]] = [self.from, self.to];
        Self { from: [x0, from, z0], to: [x1, to, z1], ..self.clone() }
    }

    /// The bricks that hold what is wanted.
    pub(super) fn bricks_of(&self, grid: &Grid) -> impl Iterator<Item = u64> + use<> {
        let position = |sample: u64| sample << self.level;
        let last = self.to.map(|end| position(end - 1) + 1);
        grid.bricks_in(self.from.map(position), last)
    }

    /// The samples of a decoded brick that are wanted, and where they come in what is wanted.
    pub(super) fn within(&self, brick: &Brick) -> Option<([Range<usize>; 3], [usize; 3])> {
        let origin = brick.origin.map(|first| first >> self.level);
        let sides = super::brick::coarsened(brick.sides, self.level);
        let start = per_axis(|axis| origin[axis].max(self.from[axis]));
        let end = per_axis(|axis| (origin[axis] + sides[axis] as u64).min(self.to[axis]));
        let is_met = (0..3).all(|axis| start[axis] < end[axis]);
        is_met.then(|| {
            let range =
                |axis: usize| (start[axis] - origin[axis]) as usize..(end[axis] - origin[axis]) as usize;
            (per_axis(range), per_axis(|axis| (start[axis] - self.from[axis]) as usize))
        })
    }
}

impl Container {
    /// Finds out whether a part exists, and which samples it has.
    pub(super) fn check(&self, part: &Part) -> Result<Wanted, ContainerError> {
        let steps = range(part.step, self.steps())
            .ok_or(ContainerError::NoSuchStep { asked: part.step.unwrap_or(0), steps: self.steps() })?;
        let components = self.head().components;
        let asked = part.component.unwrap_or(0);
        let chosen = range(part.component.map(u64::from), components.into())
            .ok_or(ContainerError::NoSuchComponent { asked, components })?;
        let chosen = chosen.start as u32..chosen.end as u32;
        let mut readable = u8::MAX;
        for step in steps.clone() {
            let channels = &self.step(step)?.channels[chosen.start as usize..chosen.end as usize];
            readable = channels.iter().map(|channel| channel.readable_levels).fold(readable, u8::min);
        }
        if part.level > readable {
            return Err(no_such_level(part.level, readable));
        }
        self.check_region(part, steps, chosen)
    }

    fn check_region(
        &self,
        part: &Part,
        steps: Range<u64>,
        components: Range<u32>,
    ) -> Result<Wanted, ContainerError> {
        let (level, extent) = (part.level, self.head().extent);
        let asked = part.region.unwrap_or(Region { from: [0; 3], to: [u64::MAX; 3] });
        let region = asked.within(extent);
        let region = region.ok_or(ContainerError::NoSuchRegion { region: asked.ending(extent), extent })?;
        let first = |position: u64| position.div_ceil(1 << level);
        let (from, to) = (region.from.map(first), region.to.map(first));
        if (0..3).any(|axis| from[axis] >= to[axis]) {
            return Err(ContainerError::NoSampleInRegion { region, level });
        }
        Ok(Wanted { level, from, to, steps, components })
    }
}

/// One of so many, or all.
fn range(one: Option<u64>, count: u64) -> Option<Range<u64>> {
    match one {
        Some(one) => (one < count).then(|| one..one + 1),
        None => Some(0..count),
    }
}

fn no_such_level(asked: u8, coarsest: u8) -> ContainerError {
    let why = match coarsest {
        0 => "the type of its samples or the sides of its bricks allow full resolution only".to_owned(),
        coarsest => format!("its coarsest is {coarsest}"),
    };
    ContainerError::NoSuchLevel { asked, why }
}
