//! What is left of a container that is damaged or cut short.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;

use super::brick::Worker;
use super::container::{FOOTER_BYTES, START_BYTES, read, read_index};
use super::content::{BrickLabel, Head, Place, Step};
use super::decode::decode_found;
use super::patched::Patched;
use super::record::{self, Frame, Kind, MOST_BRICK_BYTES};
use super::wrong_byte::{changes, changes_of_record};
use super::{Content, Found, ReadAt, RepairError, Scanner};
use crate::volume::Metadata;

/// Bricks that a file of few bytes may have had at most: it may be cut short.
const FEW_BRICKS: u64 = 1 << 20;

/// Gaps that are looked at for single wrong bytes; a file with more has suffered otherwise.
const MOST_GAPS: usize = 1 << 10;

/// Bytes that are looked at for wrong ones, for each byte of the file, and at least.
const PATIENCE: (u64, u64) = (8, 1 << 26);

/// Bytes of the longest record but a brick's in which a wrong byte is looked for.
const MOST_RECORD_BYTES: u64 = 1 << 24;

/// Bytes of the shortest record.
const LEAST_RECORD_BYTES: usize = 7;

/// What a scan found of one container.
#[derive(Default)]
pub(super) struct Remains {
    pub(super) head: Option<Head>,
    pub(super) metadata: Option<Metadata>,
    pub(super) steps: BTreeMap<u64, Step>,
    pub(super) bricks: BTreeMap<Place, Range<u64>>,
    /// The last record of statistics.
    pub(super) statistics: Range<u64>,
    /// What is no whole record.
    pub(super) gaps: Vec<Range<u64>>,
}

impl Remains {
    /// Scans a damaged file, after single wrong bytes in it were put right.
    pub(super) fn of(source: &mut Patched) -> io::Result<Self> {
        let mut remains = Self::find(source)?;
        let mut patience = source.bytes().saturating_mul(PATIENCE.0).saturating_add(PATIENCE.1);
        // What a brick is compared with may have to be mended first.
        for _ in 0..2 {
            let before = source.places().len();
            for gap in remains.gaps.iter().take(MOST_GAPS) {
                Mending { source, remains: &remains, patience: &mut patience }.gap(gap.clone())?;
            }
            if source.places().len() == before {
                break;
            }
            remains = Self::find(source)?;
        }
        Ok(remains)
    }

    fn find(source: &dyn ReadAt) -> io::Result<Self> {
        let mut remains = Self::default();
        // Another container may follow, or lie in a gap.
        let mut is_own = true;
        for found in Scanner::new(source) {
            let Found { bytes, content } = found?;
            match content {
                None => remains.gaps.push(bytes),
                Some(Content::Head(head)) => {
                    is_own = *remains.head.get_or_insert_with(|| head.clone()) == head
                }
                Some(_) if !is_own => {}
                Some(Content::Metadata(metadata)) => {
                    remains.metadata.get_or_insert(metadata);
                }
                Some(Content::Step(step)) => {
                    remains.steps.entry(step.number).or_insert(step);
                }
                Some(Content::Brick { label, .. }) => {
                    remains.bricks.entry(label.place).or_insert(bytes);
                }
                Some(Content::Other(Kind::Statistics)) => remains.statistics = bytes,
                Some(Content::Other(_)) => {}
            }
        }
        // A whole footer is no record, and no gap either.
        if let Some(gap) =
            remains.gaps.last_mut().filter(|gap| gap.end == source.bytes() && read_index(source).is_ok())
        {
            gap.end -= FOOTER_BYTES as u64;
        }
        remains.gaps.retain(|gap| !gap.is_empty());
        Ok(remains)
    }

    /// Every time step, and the numbers of those whose description is lost: another's stands for it.
    pub(super) fn steps(
        &self,
        head: &Head,
        source: &dyn ReadAt,
    ) -> Result<(Vec<Step>, Vec<u64>), RepairError> {
        let sound: BTreeMap<u64, &Step> = self
            .steps
            .iter()
            .filter(|(_, step)| step.check(head).is_ok())
            .map(|(number, step)| (*number, step))
            .collect();
        let (last, example) = sound.last_key_value().ok_or(RepairError::NoStep)?;
        let most = source.bytes().max(FEW_BRICKS);
        let in_index = read_index(source).map_or(0, |(index, _)| index.steps.len() as u64);
        let count = last.saturating_add(1).max(in_index);
        if count > most {
            return Err(RepairError::TooManyBricks);
        }
        let mut bricks = 0_u64;
        let (mut steps, mut lost) = (Vec::new(), Vec::new());
        for number in 0..count {
            let step = sound.get(&number).map_or_else(
                || {
                    lost.push(number);
                    Step { number, name: None, time: None, ..(*example).clone() }
                },
                |step| (*step).clone(),
            );
            let here = step.grid(head).bricks().saturating_mul(head.components.into());
            bricks = bricks.saturating_add(here);
            if bricks > most {
                return Err(RepairError::TooManyBricks);
            }
            steps.push(step);
        }
        Ok((steps, lost))
    }

    /// Whether a brick decodes to the samples that it should.
    fn is_right(&self, label: &BrickLabel, stored: &[u8]) -> bool {
        let (Some(head), Place { step, brick, component }) = (&self.head, label.place) else { return false };
        let step = self.steps.get(&step).filter(|step| step.check(head).is_ok());
        let Some((step, channel)) =
            step.and_then(|step| Some((step, step.channels.get(component as usize)?)))
        else {
            return false;
        };
        let grid = step.grid(head);
        let decode =
            |brick| decode_found(&mut Worker::new(), channel, (label, stored), (head.element, brick));
        brick < grid.bricks() && decode(grid.brick(brick)).is_ok()
    }
}

/// Looks for single wrong bytes in a gap.
struct Mending<'a> {
    source: &'a mut Patched,
    remains: &'a Remains,
    /// Bytes that may still be looked at.
    patience: &'a mut u64,
}

impl Mending<'_> {
    /// Puts right what can be, record after record, as long as it is clear where the next begins.
    fn gap(&mut self, gap: Range<u64>) -> io::Result<()> {
        let mut at = if gap.start == 0 { START_BYTES as u64 } else { gap.start };
        while let Some(next) = self.record(at, gap.end)? {
            at = next;
        }
        Ok(())
    }

    /// Puts the record at a place right; returns where the next begins, if that is known.
    fn record(&mut self, at: u64, end: u64) -> io::Result<Option<u64>> {
        if at >= end || *self.patience == 0 {
            return Ok(None);
        }
        if let Some(found) = Scanner::record_at(&*self.source, at)? {
            return Ok(Some(found.bytes.end));
        }
        let first = read(&*self.source, at, (end - at).min(MOST_BRICK_BYTES as u64) as u32)?;
        if let Some((label, len)) = record::from_bytes::<BrickLabel>(Kind::Brick, &first) {
            return self.stored(&label, at + len as u64, end);
        }
        // It is as long as it says, or as the gap is, or short.
        let said = Frame::parse(&first).map(|frame| frame.bytes() as u64);
        for len in said.into_iter().chain([end - at]).filter(|&len| len <= MOST_RECORD_BYTES.min(end - at)) {
            let bytes = read(&*self.source, at, len as u32)?;
            if let Some(next) = self.one_of(&bytes, at, end)? {
                return Ok(Some(next));
            }
        }
        for len in LEAST_RECORD_BYTES..first.len() {
            if let Some(next) = self.one_of(&first[..len], at, end)? {
                return Ok(Some(next));
            }
        }
        Ok(None)
    }

    /// The one change that makes a whole record of these bytes, with what is stored behind it.
    fn one_of(&mut self, bytes: &[u8], at: u64, end: u64) -> io::Result<Option<u64>> {
        *self.patience = self.patience.saturating_sub(bytes.len() as u64);
        let mut mended = None;
        for change in changes_of_record(bytes) {
            self.source.toggle(at, change);
            let found = Scanner::record_at(&*self.source, at)?;
            self.source.toggle(at, change);
            if let Some(found) = found.filter(|found| found.bytes.end <= end) {
                if mended.is_some() {
                    return Ok(None);
                }
                mended = Some((change, found.bytes.end));
            }
        }
        Ok(mended.map(|(change, next)| {
            self.source.toggle(at, change);
            next
        }))
    }

    /// What is stored of a brick whose record is whole: of the changes that suit one checksum, the one that suits the
    /// other, of the samples, as well.
    fn stored(&mut self, label: &BrickLabel, at: u64, end: u64) -> io::Result<Option<u64>> {
        let len = u32::try_from(label.bytes()).ok().filter(|&len| at + u64::from(len) <= end);
        let Some(len) = len else { return Ok(None) };
        let mut stored = read(&*self.source, at, len)?;
        for change in changes(&stored, label.stored_crc) {
            stored[change.at] ^= change.by;
            if self.remains.is_right(label, &stored) {
                self.source.toggle(at, change);
                break;
            }
            stored[change.at] ^= change.by;
        }
        Ok(Some(at + u64::from(len)))
    }
}
