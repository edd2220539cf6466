//! Streams of rows, read the plain way, from `kernel/docs/stream.md` alone: all coefficients are kept, and the inverse
//! transform is that of the whole slice.

use super::super::lifting::{self, Psi, max_levels};
use super::arithmetic::Decoder;
use super::distribution::Models;
use super::header::{Fields, Reject, SampleType, ceil_shift, type_and_wavelet};
use super::value::Context;

/// The slice that a stream holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slice {
    /// Samples of a row.
    pub width: usize,
    /// The samples, x fastest.
    pub samples: Vec<i32>,
}

/// What the header says.
#[derive(Debug)]
struct Header {
    sample_type: SampleType,
    psi: Option<Psi>,
    levels: usize,
    width: usize,
    strip: usize,
    bytes: usize,
}

fn header(bytes: &[u8]) -> Result<Header, Reject> {
    let mut fields = Fields { bytes, read: 0 };
    for expected in [0x77, 0x53] {
        if fields.byte()? != expected {
            return Err(Reject::NotACodestream);
        }
    }
    match fields.byte()? {
        2 => {}
        found => return Err(Reject::UnsupportedVersion { found }),
    }
    if fields.byte()? != 0 {
        return Err(Reject::Reserved);
    }
    let (sample_type, psi) = type_and_wavelet(fields.byte()?)?;
    let levels = usize::from(fields.byte()?);
    if levels > 31 || (levels > 0) != psi.is_some() {
        return Err(Reject::Levels);
    }
    let (width, strip) = (fields.number()?, fields.number()?);
    if !(1..1 << 31).contains(&width) {
        return Err(Reject::Extent);
    }
    if !(1..1 << 16).contains(&strip) {
        return Err(Reject::Reserved);
    }
    Ok(Header { sample_type, psi, levels, width, strip, bytes: fields.read })
}

/// Takes a codeword from the beginning of `bytes`: what its chunks hold.
fn codeword(bytes: &mut &[u8]) -> Result<Vec<u8>, Reject> {
    let mut word = Vec::new();
    loop {
        let (&length, rest) = bytes.split_first().ok_or(Reject::Truncated)?;
        let (chunk, rest) = rest.split_at_checked(length.into()).ok_or(Reject::Truncated)?;
        word.extend_from_slice(chunk);
        *bytes = rest;
        if length < 255 {
            return Ok(word);
        }
    }
}

/// Rows of one subband so far, and their residuals.
#[derive(Debug, Default)]
struct Band {
    rows: Vec<Vec<i32>>,
    residuals: Vec<Vec<i32>>,
}

/// What is known of a level.
#[derive(Debug, Default)]
struct Level {
    /// Rows that have arrived at it.
    arrived: usize,
    /// Pairs of rows whose details are read.
    pairs: usize,
    /// By orientation, from 1.
    details: [Band; 3],
}

/// What is known of a stream.
#[derive(Debug)]
struct Known {
    /// Of level 0 for orientation 3, and for its others; for all else.
    models: [Models; 3],
    levels: Vec<Level>,
    low: Band,
}

#[derive(Debug)]
struct Reader<'a> {
    header: &'a Header,
    from: Decoder<'a>,
    known: &'a mut Known,
}

/// How many rows beyond c_i a level waits for before it hands on c_i and d_i.
const fn wait(psi: Psi) -> usize {
    match psi {
        Psi::H => 1,
        Psi::Q | Psi::One => 2,
        Psi::Three => 3,
        Psi::D | Psi::Five => 4,
    }
}

/// Decodes a stream of rows; bytes that follow it are returned.
pub fn decode(bytes: &[u8]) -> Result<(Slice, &[u8]), Reject> {
    let header = header(bytes)?;
    let mut rest = &bytes[header.bytes..];
    let mut known = Known {
        models: [Models::new(), Models::new(), Models::new()],
        levels: (0..header.levels).map(|_| Level::default()).collect(),
        low: Band::default(),
    };
    let mut goes_on = true;
    while goes_on {
        let word = codeword(&mut rest)?;
        let mut reader = Reader { header: &header, from: Decoder::new(&word)?, known: &mut known };
        goes_on = (0..header.strip).all(|_| reader.row());
        if !goes_on {
            (0..header.levels).for_each(|level| reader.end(level));
        }
        reader.from.finish()?;
    }
    let samples = join(&header, &known);
    let fits = samples.iter().all(|&sample| header.sample_type.holds(sample));
    if fits { Ok((Slice { width: header.width, samples }, rest)) } else { Err(Reject::Sample) }
}

impl Reader<'_> {
    /// The next row of samples, if there is one.
    fn row(&mut self) -> bool {
        if !self.from.decision(65535) {
            return false;
        }
        if self.known.levels.is_empty() {
            self.low_row();
        } else {
            self.arrive(0);
        }
        true
    }

    /// A row arrives at a level.
    fn arrive(&mut self, level: usize) {
        let psi = self.header.psi.expect("levels have a wavelet");
        self.known.levels[level].arrived += 1;
        if 2 * self.known.levels[level].pairs + wait(psi) < self.known.levels[level].arrived {
            self.pair(level);
        }
    }

    /// No more rows arrive at a level.
    fn end(&mut self, level: usize) {
        while 2 * self.known.levels[level].pairs < self.known.levels[level].arrived {
            self.pair(level);
        }
    }

    /// Reads the details of a pair of rows; its low-pass part arrives at the next level.
    fn pair(&mut self, level: usize) {
        let width = ceil_shift([self.header.width, 1, 1], level)[0];
        let number = self.known.levels[level].pairs;
        self.known.levels[level].pairs += 1;
        let has_d = 2 * number + 1 < self.known.levels[level].arrived;
        let last = if has_d { 3 } else { 1 };
        for orientation in 1..=last {
            let band = std::mem::take(&mut self.known.levels[level].details[orientation - 1]);
            let columns = if orientation % 2 == 1 { width / 2 } else { width.div_ceil(2) };
            let lower = &self.known.levels[level].details[..orientation - 1];
            let hints: Vec<u64> = (0..columns)
                .map(|x| {
                    let beside = lower.iter().filter_map(|band| band.rows[number].get(x));
                    beside.map(|value| 3 * u64::from(value.unsigned_abs().min(1 << 25))).sum()
                })
                .collect();
            let models = match (level, orientation) {
                (0, 3) => 0,
                (0, _) => 1,
                _ => 2,
            };
            let band = band.read(&mut self.from, &mut self.known.models[models], &hints, |_, _| 0);
            self.known.levels[level].details[orientation - 1] = band;
        }
        if level + 1 == self.known.levels.len() { self.low_row() } else { self.arrive(level + 1) }
    }

    /// Reads a row of the low-pass part.
    fn low_row(&mut self) {
        let width = ceil_shift([self.header.width, 1, 1], self.known.levels.len())[0];
        let low = std::mem::take(&mut self.known.low);
        self.known.low = low.read(&mut self.from, &mut self.known.models[2], &vec![0; width], in_plane);
    }
}

/// The predictor 0 of the codestream, in the first plane.
fn in_plane(above: Option<&Vec<i32>>, row: &[i32]) -> i32 {
    let x = row.len();
    let w = row.last().copied().or_else(|| above.map(|above| above[0])).unwrap_or(0);
    let n = above.map_or(w, |above| above[x]);
    let nw = above.map_or(w, |above| above[x.saturating_sub(1)]);
    let nw = if x == 0 { w } else { nw };
    let mut three = [w, n, w.wrapping_add(n).wrapping_sub(nw)];
    three.sort_unstable();
    three[1]
}

impl Band {
    /// Reads one more row, with the hints of its places; `predict` looks at the row above and the row so far.
    fn read(
        mut self,
        from: &mut Decoder<'_>,
        models: &mut Models,
        hints: &[u64],
        predict: fn(Option<&Vec<i32>>, &[i32]) -> i32,
    ) -> Self {
        let (mut row, mut residuals) = (Vec::new(), Vec::new());
        for (x, hint) in hints.iter().enumerate() {
            let energy = self.energy(&residuals, x as isize) + hint;
            let residual = models.decode(from, Context { energy, offset: 0 });
            row.push(predict(self.rows.last(), &row).wrapping_add(residual));
            residuals.push(residual);
        }
        self.rows.push(row);
        self.residuals.push(residuals);
        self
    }

    /// The energy around a place but for the hint.
    fn energy(&self, row: &[i32], x: isize) -> u64 {
        let at = |row: Option<&[i32]>, dx: isize, most: u32| {
            let value = usize::try_from(x + dx).ok().and_then(|x| row?.get(x).copied());
            value.map_or(0, |value| u64::from(value.unsigned_abs().min(most)))
        };
        let mut above = self.residuals.iter().rev().map(Vec::as_slice);
        let (north, north_north) = (above.next(), above.next());
        let here = |dx| at(Some(row), dx, 1 << 25);
        let before = |row, dx| at(row, dx, 65535);
        4 * (here(-1) + before(north, 0))
            + 2 * (before(north, -1) + before(north, 1))
            + here(-2)
            + before(north_north, 0)
    }
}

/// The samples of all coefficients.
fn join(header: &Header, known: &Known) -> Vec<i32> {
    let Known { levels, low, .. } = known;
    let height = levels.first().map_or(low.rows.len(), |level| level.arrived);
    if height == 0 {
        return Vec::new();
    }
    let extent = [header.width, height, 1];
    let mut whole = vec![0; header.width * height];
    let mut place = |rows: &[Vec<i32>], left: usize, top: usize| {
        for (y, row) in rows.iter().enumerate() {
            let start = (top + y) * header.width + left;
            whole[start..start + row.len()].copy_from_slice(row);
        }
    };
    for (number, level) in levels.iter().enumerate() {
        let [left, top, _] = ceil_shift(extent, number + 1);
        let [first, second, third] = &level.details;
        place(&first.rows, left, 0);
        place(&second.rows, 0, top);
        place(&third.rows, left, top);
    }
    place(&low.rows, 0, 0);
    if let Some(psi) = header.psi {
        lifting::inverse(psi, &mut whole, extent, levels.len().min(max_levels(extent)));
    }
    whole
}
