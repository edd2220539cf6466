//! A damaged or truncated container, opened for what is left of it.

use std::ops::Range;

use super::container::StepRecords;
use super::patched::Patched;
use super::remains::Remains;
use super::repair::places;
use super::{Container, Grid, Place, ReadAt, Region, RepairError};

/// What is left of a damaged file.
#[derive(Debug)]
pub struct Salvaged {
    /// All that can be read; reading a brick that is lost is an error.
    pub container: Container,
    /// What was wrong with it.
    pub damage: Damage,
}

/// What is wrong with a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Damage {
    /// Places of single wrong bytes that were put right.
    pub mended: Vec<u64>,
    /// Bytes that are no whole record.
    pub gaps: Vec<Range<u64>>,
    /// Whether what the source said beside extent and type is lost.
    pub lost_metadata: bool,
    /// Time steps whose description is lost, and with it all their bricks.
    pub lost_steps: Vec<u64>,
    /// Bricks that are lost, in the order of the file.
    pub lost: Vec<Lost>,
}

/// A brick that is not in the file any more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost {
    /// Which one it is.
    pub place: Place,
    /// The samples it held.
    pub region: Region,
}

impl Lost {
    pub(super) fn new(place: Place, grid: &Grid) -> Self {
        let brick = grid.brick(place.brick);
        let to = std::array::from_fn(|axis| brick.origin[axis] + u64::from(brick.sides[axis]));
        Self { place, region: Region { from: brick.origin, to } }
    }
}

impl Container {
    /// Opens what is left of a damaged or truncated container. Neither its index nor its footer are needed, nor its
    /// beginning where copies of that are left.
    ///
    /// Where one byte of a record or a brick is wrong, its checksums tell which, and it is read as it was; so nothing at
    /// all is lost of a file with one wrong byte. What is damaged further is listed. A brick may be lost that is not in
    /// the list, as none is decoded here: [`Container::decompress_with`] and [`repair`](super::repair()) find out.
    ///
    /// # Errors
    /// [`RepairError`]: nothing says what the samples are, or the file cannot be read.
    ///
    /// Cost: reading the file once, or up to three times where it is damaged. Memory: the largest brick, and some ten
    /// bytes for each.
    pub fn salvage(source: Box<dyn ReadAt>) -> Result<Salvaged, RepairError> {
        let mut source = Patched::new(source);
        let mut remains = Remains::of(&mut source).map_err(RepairError::Read)?;
        let head = remains.head.take().ok_or(RepairError::NoHead)?;
        let (steps, lost_steps) = remains.steps(&head, &source)?;
        let mut damage = Damage {
            mended: source.places(),
            gaps: std::mem::take(&mut remains.gaps),
            lost_metadata: remains.metadata.is_none(),
            lost_steps,
            lost: Vec::new(),
        };
        let mut records = Vec::new();
        for step in steps {
            let is_known = remains.steps.contains_key(&step.number);
            let bytes_of = |place: Place| {
                let found = remains.bricks.get(&place).filter(|_| is_known).cloned();
                found.unwrap_or_else(|| {
                    damage.lost.push(Lost::new(place, &step.grid(&head)));
                    0..0
                })
            };
            let bricks = places(&head, &step).map(bytes_of).collect();
            records.push(StepRecords::found(step, bricks));
        }
        let metadata = remains.metadata.unwrap_or_default();
        let rest = (metadata, remains.statistics);
        Ok(Salvaged { container: Self::found(Box::new(source), head, records, rest), damage })
    }
}
