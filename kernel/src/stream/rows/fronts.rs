//! How far each lifting step has come along y, where rows arrive one after another.
//!
//! Row 2i is c_i, row 2i + 1 is d_i. A step changes the rows of one kind, in order, each as soon as the rows that it
//! reads have been through all steps before, and no step before still has to read the row.

use crate::Wavelet;
use crate::lifting::Direction;

/// Lifting steps of a wavelet, at most.
const MAX_STEPS: usize = 4;

/// Counts beyond twice this are brought down by it: a multiple of two, and of every number of rows that are kept.
const TURN: i16 = 840;

/// What a lifting step reads: rows, by how far they lie below the one that it changes.
#[derive(Clone, Copy, Debug)]
struct Step {
    reads: &'static [i16],
    /// Whether rows beyond the ends are zeros, not the nearest of their kind.
    zero_ended: bool,
}

/// A step that reads one row above.
const ABOVE: Step = Step { reads: &[-1], zero_ended: false };

/// A step that reads the rows on either side.
const BESIDE: Step = Step { reads: &[-1, 1], zero_ended: false };

/// A last step that reads one row below, or also another on either side.
const BELOW: Step = Step { reads: &[1], zero_ended: true };
const AROUND: Step = Step { reads: &[-1, 1, 3], zero_ended: true };

/// The steps of a wavelet, in the order of the forward transform; steps alternate, and the last changes the c.
const fn steps(wavelet: Wavelet) -> &'static [Step] {
    match wavelet {
        Wavelet::Haar => &[ABOVE, BELOW],
        Wavelet::Quadratic => &[ABOVE, BESIDE, BELOW],
        Wavelet::Duchaineau => &[ABOVE, BESIDE, AROUND],
        Wavelet::Linear => &[BESIDE; 2],
        Wavelet::Cubic => &[BESIDE; 3],
        Wavelet::Quintic => &[BESIDE; 4],
    }
}

/// Rows that the forward transform along y works on at a time.
pub(super) const fn forward_rows(wavelet: Wavelet) -> usize {
    match wavelet {
        Wavelet::Haar => 2,
        Wavelet::Quadratic => 3,
        Wavelet::Linear => 4,
        Wavelet::Cubic => 5,
        Wavelet::Duchaineau | Wavelet::Quintic => 6,
    }
}

/// Rows c and rows d that the inverse transform along y works on at a time.
pub(super) const fn inverse_rows(wavelet: Wavelet) -> [usize; 2] {
    match wavelet {
        Wavelet::Haar => [1, 1],
        Wavelet::Linear => [2, 2],
        Wavelet::Quadratic | Wavelet::Cubic => [2, 3],
        Wavelet::Quintic => [3, 3],
        Wavelet::Duchaineau => [3, 4],
    }
}

/// Rows by which a row that comes back through one level lags behind the one that goes in.
pub(super) const fn lag(wavelet: Wavelet) -> usize {
    match wavelet {
        Wavelet::Haar => 1,
        Wavelet::Linear => 3,
        Wavelet::Quadratic => 4,
        Wavelet::Cubic => 5,
        Wavelet::Quintic => 7,
        Wavelet::Duchaineau => 8,
    }
}

/// One row to be changed by one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) step: usize,
    pub(super) row: i16,
    /// The rows one above, one below and three below, or those that stand for them; none is zeros, or not read.
    pub(super) beside: [Option<i16>; 3],
}

/// The rows of one level so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fronts {
    received: i16,
    /// Rows handed on, all of them through all steps.
    taken: i16,
    /// For each step, in the order of the direction, the next row that it changes.
    next: [i16; MAX_STEPS],
    ended: bool,
}

/// A direction of the transform of one wavelet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passes {
    steps: &'static [Step],
    direction: Direction,
}

impl Passes {
    pub(super) const fn new(wavelet: Wavelet, direction: Direction) -> Self {
        Self { steps: steps(wavelet), direction }
    }

    /// The number of the step that comes `pass`-th.
    const fn number(self, pass: usize) -> usize {
        match self.direction {
            Direction::Forward => pass,
            Direction::Inverse => self.steps.len().wrapping_sub(1).wrapping_sub(pass),
        }
    }

    fn step(self, pass: usize) -> Step {
        self.steps.get(self.number(pass)).copied().unwrap_or(BESIDE)
    }
}

impl Fronts {
    /// Before the first row.
    pub(super) fn new(passes: Passes) -> Self {
        let mut next = [0; MAX_STEPS];
        for (pass, row) in next.iter_mut().enumerate() {
            // The last step changes even rows, the one before odd ones.
            let after = passes.steps.len().wrapping_sub(1).wrapping_sub(passes.number(pass));
            *row = i16::from(after % 2 == 1);
        }
        Self { received: 0, taken: 0, next, ended: false }
    }

    /// Takes a row, and returns its number.
    pub(super) fn receive(&mut self) -> i16 {
        if self.taken >= 2 * TURN {
            let counts = [&mut self.received, &mut self.taken].into_iter().chain(&mut self.next);
            counts.for_each(|count| *count = count.wrapping_sub(TURN));
        }
        let row = self.received;
        self.received = row.wrapping_add(1);
        row
    }

    /// Rows so far: the number of the next.
    pub(super) const fn received(&self) -> i16 {
        self.received
    }

    /// Rows that are in and not yet handed on.
    #[cfg(test)]
    pub(super) const fn inside(&self) -> i16 {
        self.received.wrapping_sub(self.taken)
    }

    /// There are no more rows.
    pub(super) const fn end(&mut self) {
        self.ended = true;
    }

    pub(super) const fn is_ended(&self) -> bool {
        self.ended
    }

    /// Whether all rows are in, and handed on.
    pub(super) const fn is_exhausted(&self) -> bool {
        self.ended && self.taken == self.received
    }

    /// The next change that can be made, which is from then on taken as made.
    pub(super) fn advance(&mut self, passes: Passes) -> Option<Change> {
        // A line of one sample is left alone.
        if self.received < 2 {
            return None;
        }
        let found = (0..passes.steps.len()).find_map(|pass| Some((pass, self.change(passes, pass)?)));
        let (pass, change) = found?;
        let next = self.next.get_mut(pass)?;
        *next = next.wrapping_add(2);
        Some(change)
    }

    /// What `pass` does next, if it can.
    fn change(&self, passes: Passes, pass: usize) -> Option<Change> {
        let row = self.next.get(pass).copied()?;
        let before = pass.checked_sub(1);
        // Rows of the other kind that are through all steps before, and rows of the own kind.
        let others = self.through(before);
        if row >= self.through(before.and_then(|before| before.checked_sub(1))) {
            return None;
        }
        if let Some(before) = before {
            let mut readers = passes.step(before).reads.iter().map(|away| row.wrapping_sub(*away));
            let is_done = |reader| reader < others || (self.ended && reader >= self.received);
            if !readers.all(is_done) {
                return None;
            }
        }
        let Step { reads, zero_ended } = passes.step(pass);
        let mut beside = [None; 3];
        for &away in reads {
            let place = usize::from(away.unsigned_abs()).wrapping_add(usize::from(away > 0)) / 2;
            let read = self.nearest(row.wrapping_add(away), zero_ended);
            if read.is_some_and(|read| read >= others) {
                return None;
            }
            *beside.get_mut(place)? = read;
        }
        Some(Change { step: passes.number(pass), row, beside })
    }

    /// The row that stands for `row` if that is beyond an end; none if zeros do.
    const fn nearest(&self, row: i16, zero_ended: bool) -> Option<i16> {
        let inside = if row < 0 {
            row.wrapping_add(2)
        } else if self.ended && row >= self.received {
            row.wrapping_sub(2)
        } else {
            return Some(row);
        };
        if zero_ended { None } else { Some(inside) }
    }

    /// The first row of its kind that has not been through `pass`; of both kinds, that has not arrived.
    fn through(&self, pass: Option<usize>) -> i16 {
        pass.map_or(self.received, |pass| self.next.get(pass).copied().unwrap_or(0))
    }

    /// Rows from the first on that are through all steps.
    fn complete(&self, passes: Passes) -> i16 {
        if self.received < 2 {
            return if self.ended { self.received } else { 0 };
        }
        let last = passes.steps.len().wrapping_sub(1);
        self.through(Some(last)).min(self.through(last.checked_sub(1)))
    }

    /// Hands on one row, if it is complete.
    pub(super) fn take(&mut self, passes: Passes) -> Option<i16> {
        let row = self.taken;
        (self.complete(passes) > row).then(|| {
            self.taken = row.wrapping_add(1);
            row
        })
    }

    /// Hands on c_i and d_i, or the last c without a d, if they are complete.
    pub(super) fn take_pair(&mut self, passes: Passes) -> Option<(i16, Option<i16>)> {
        let (c, complete) = (self.taken, self.complete(passes));
        let d = c.wrapping_add(1);
        let is_last = self.ended && d == self.received;
        if complete <= c || (complete <= d && !is_last) {
            return None;
        }
        self.taken = if is_last { d } else { d.wrapping_add(1) };
        Some((c, (!is_last).then_some(d)))
    }

    /// Whether c_i came last, without d_i: of the pair handed on last.
    pub(super) const fn is_odd(&self) -> bool {
        self.ended && self.received % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The most rows between the oldest that a step, or the one who takes them, still needs and the newest: all rows,
    /// rows c and rows d.
    fn spans(wavelet: Wavelet, direction: Direction, rows: i16) -> [usize; 3] {
        let passes = Passes::new(wavelet, direction);
        let (mut fronts, mut widest) = (Fronts::new(passes), [0; 3]);
        let mut see = |newest: i16, row: i16| {
            let pairs = usize::try_from(newest / 2 - row / 2 + 1).unwrap();
            let kind = if row % 2 == 0 { 1 } else { 2 };
            widest[kind] = pairs.max(widest[kind]);
            widest[0] = usize::try_from(newest - row + 1).unwrap().max(widest[0]);
        };
        loop {
            let (mut newest, at_once) =
                (fronts.received() - 1, if let Direction::Forward = direction { 1 } else { 2 });
            for _ in 0..at_once {
                if fronts.received() < rows {
                    newest = fronts.receive();
                } else {
                    fronts.end();
                }
            }
            // A last row c alone is no pair that a row d came with.
            while let Some(Change { row, beside, .. }) = fronts.advance(passes) {
                beside.into_iter().flatten().chain([row]).for_each(|row| see(newest, row));
            }
            match direction {
                Direction::Forward => {
                    while let Some((c, d)) = fronts.take_pair(passes) {
                        [Some(c), d].into_iter().flatten().for_each(|row| see(newest, row));
                    }
                }
                Direction::Inverse => {
                    while let Some(row) = fronts.take(passes) {
                        see(newest, row);
                    }
                }
            }
            if fronts.is_exhausted() {
                return widest;
            }
        }
    }

    #[test]
    fn rows_worked_on_at_a_time() {
        for wavelet in Wavelet::ALL {
            let most = |direction| {
                let spans = (1..60).map(|rows| spans(wavelet, direction, rows));
                spans.fold([0; 3], |most, spans| core::array::from_fn(|kind| most[kind].max(spans[kind])))
            };
            let [all, ..] = most(Direction::Forward);
            assert_eq!(all, forward_rows(wavelet), "{wavelet}");
            let [_, c, d] = most(Direction::Inverse);
            assert_eq!([c, d], inverse_rows(wavelet), "{wavelet}");
        }
    }

    #[test]
    fn counts_are_brought_down_in_step() {
        let passes = Passes::new(Wavelet::Cubic, Direction::Forward);
        let mut fronts = Fronts::new(passes);
        let (mut pairs, rows) = (0, if cfg!(miri) { 2_000 } else { 10_000 });
        for _ in 0..rows {
            assert!(fronts.receive() < 2 * TURN + 10);
            while fronts.advance(passes).is_some() {}
            pairs += usize::from(fronts.take_pair(passes).is_some());
        }
        // Two rows wait for the one that the last step of the first looks at.
        assert_eq!(pairs, rows / 2 - 1);
    }

    #[test]
    fn the_quadratic_line_of_three() {
        let passes = Passes::new(Wavelet::Quadratic, Direction::Forward);
        let mut fronts = Fronts::new(passes);
        let changes = |fronts: &mut Fronts| {
            let changes = core::iter::from_fn(|| fronts.advance(passes));
            changes.map(|change| (change.step, change.row)).collect::<heapless::Vec<_, 4>>()
        };
        fronts.receive();
        assert_eq!(changes(&mut fronts), []);
        fronts.receive();
        assert_eq!(changes(&mut fronts), [(0, 0)]);
        fronts.receive();
        assert_eq!(changes(&mut fronts), [(0, 2), (1, 1), (2, 0)]);
        fronts.end();
        assert_eq!(changes(&mut fronts), [(2, 2)]);
        assert_eq!(fronts.take_pair(passes), Some((0, Some(1))));
        assert_eq!(fronts.take_pair(passes), Some((2, None)));
        assert!(fronts.is_exhausted() && fronts.is_odd());
    }
}
