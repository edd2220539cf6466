//! Damage to every golden codestream, and to streams of rows and slabs made of their samples.

use std::collections::BTreeMap;
use std::fmt;
use std::time::{Duration, Instant};

use wavelift_kernel::stream::{RowPlan, SlabPlan};
use wavelift_kernel::{Extent, Header, SampleType, Wavelet};

use crate::corrupt::Damage;
use crate::effort::Effort;
use crate::lent::decode_any;
use crate::oracle::noise::Noise;
use crate::slabs;
use crate::streams::{self, Pieces};
use crate::vectors::{Expect, Manifest, decode};

/// Samples for which memory is taken when damage asks for it: more than any golden codestream has, of which those with
/// tables begin at 2^14.
const MOST_SAMPLES: usize = 1 << 15;

/// Samples of golden codestreams that are made into streams too.
const MOST_ARRIVING: usize = 1 << 10;

/// Samples that are taken of a stream, which does not say how many it has.
const MOST_GIVEN: usize = 1 << 12;

/// Elements of memory that are lent to a decoder of rows.
const MOST_MEMORY: usize = 1 << 14;

/// How a golden stream holds its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// As an adaptive coder leaves them.
    Coded,
    /// The same, in few decisions each.
    Light,
    /// The same, densely.
    Dense,
    /// Within a distance.
    Lattice,
    /// Under tables, from few neighbours.
    Tabled,
    /// Under tables, from many.
    Wide,
    /// The same, by sets of weights for cells.
    Celled,
    /// As they are.
    Stored,
    /// Row by row.
    Rows,
    /// Slab by slab.
    Slabs,
    /// Not at all: golden data to be refused at the beginning.
    None,
}

impl Kind {
    fn of(bytes: &[u8]) -> Self {
        match bytes {
            [b'w', b'S', 2, 0, ..] => Self::Rows,
            [b'w', b'S', 2, 1, ..] => Self::Slabs,
            [b'w', b'L', 2, 0, ..] => Self::Coded,
            [b'w', b'L', 2, 5, ..] => Self::Light,
            [b'w', b'L', 2, 1, ..] => Self::Dense,
            [b'w', b'L', 2, 2, ..] => Self::Lattice,
            [b'w', b'L', 2, 3, ..] => Self::Tabled,
            [b'w', b'L', 2, 4, ..] => Self::Wide,
            [b'w', b'L', 2, 6, ..] => Self::Celled,
            [b'w', b'L', 2, 0x80, ..] => Self::Stored,
            _ => Self::None,
        }
    }
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Damaged codestreams and streams.
    pub cases: usize,
    /// Those of which a decoder said that something is wrong.
    pub noticed: usize,
    /// How long the one took that took longest.
    pub longest: Duration,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.cases += other.cases;
        self.noticed += other.noticed;
        self.longest = self.longest.max(other.longest);
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cases, noticed, longest } = self;
        write!(f, "{cases} damaged streams, {noticed} noticed, the longest took {} ms", longest.as_millis())
    }
}

/// What came of each kind.
#[derive(Clone, Debug, Default)]
pub struct Tallies(pub BTreeMap<Kind, Tally>);

impl Tallies {
    /// Of all kinds together.
    pub fn total(&self) -> Tally {
        self.0.values().fold(Tally::default(), |mut total, tally| {
            total.add(tally);
            total
        })
    }
}

impl fmt::Display for Tallies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (kind, tally) in &self.0 {
            writeln!(f, "{kind:?}: {tally}")?;
        }
        write!(f, "{}", self.total())
    }
}

/// Damages `count` streams, golden ones in turn, each in one way, every fourth in two.
///
/// # Errors
///
/// If the golden data cannot be read.
///
/// # Panics
///
/// If a decoder panics, writes outside of what it was lent, gives a sample outside its type, or says other things of a
/// stream that comes in pieces.
pub fn run(seed: u64, count: usize) -> Result<Tallies, String> {
    let streams = golden()?;
    let mut noise = Noise::new(seed);
    let mut tallies = Tallies::default();
    for case in 0..count {
        let mut bytes = streams[case % streams.len()].clone();
        let kind = Kind::of(&bytes);
        let other = &streams[(noise.bits() % streams.len() as u64) as usize];
        for _ in 0..=usize::from(case.is_multiple_of(4)) {
            let way = (noise.bits() % Damage::ALL.len() as u64) as usize;
            if !bytes.is_empty() {
                Damage::ALL[way].inflict(&mut bytes, other, &mut noise);
            }
        }
        let begin = Instant::now();
        let noticed = usize::from(is_refused(&bytes));
        tallies.0.entry(kind).or_default().add(&Tally { cases: 1, noticed, longest: begin.elapsed() });
    }
    Ok(tallies)
}

/// Every codestream of the golden data, those to be refused too, and two streams of its smallest slice.
fn golden() -> Result<Vec<Vec<u8>>, String> {
    let manifest = Manifest::read()?;
    let mut streams = Vec::new();
    for vector in &manifest.vectors {
        let bytes = vector.read()?;
        if let Expect::Crc32(_) = vector.expect
            && let (Ok(header), Ok(samples)) = (Header::parse(&bytes), decode(&bytes))
        {
            streams.extend(arriving(&header, &samples));
        }
        streams.push(bytes);
    }
    streams.retain(|bytes| !bytes.is_empty());
    Ok(streams)
}

/// A stream of rows and two of slabs of the same samples, if they are few.
fn arriving(header: &Header, samples: &[i32]) -> Vec<Vec<u8>> {
    let (extent, sample_type): (Extent, SampleType) = (header.plan().extent(), header.sample_type());
    let [width, height, depth] = extent.axes();
    let (levels, wavelet): (u8, Wavelet) = (header.plan().levels(), header.plan().wavelet());
    if samples.len() > MOST_ARRIVING {
        return Vec::new();
    }
    let rows = RowPlan::new(wavelet, width, levels, sample_type).map(|plan| plan.with_strip(7));
    let slab = Extent::new([width, height, depth.div_ceil(2)]).ok();
    let slabs =
        slab.and_then(|slab| SlabPlan::new(wavelet, slab, levels.min(slab.max_levels()), sample_type).ok());
    let rows = rows.ok().map(|plan| streams::encode(&plan, samples, Pieces::Whole));
    let slabs = slabs.into_iter().flat_map(|plan| {
        [Effort::Fast, Effort::Light].map(|effort| slabs::encode(&plan, effort, samples, samples.len()))
    });
    rows.into_iter().chain(slabs).collect()
}

/// Whether any decoder refuses the bytes.
fn is_refused(bytes: &[u8]) -> bool {
    if bytes.starts_with(b"wS") { is_refused_arriving(bytes) } else { is_refused_whole(bytes) }
}

fn is_refused_whole(bytes: &[u8]) -> bool {
    let Ok(header) = Header::parse(bytes) else { return true };
    if header.samples_len(0) > MOST_SAMPLES {
        return true;
    }
    let refused = |level| match decode_any(bytes, level, &header) {
        Ok(samples) => {
            let range = header.sample_type().range();
            assert!(level > 0 || samples.iter().all(|sample| range.contains(sample)), "outside its type");
            false
        }
        Err(_) => true,
    };
    // The finest level last, as it is what counts.
    (0..=header.plan().levels()).rev().map(refused).fold(false, |_, last| last)
}

fn is_refused_arriving(bytes: &[u8]) -> bool {
    if let Ok((plan, _)) = RowPlan::parse(bytes) {
        if plan.fast_decoder_memory_len() > MOST_MEMORY {
            return true;
        }
        let whole = streams::decode(bytes, MOST_GIVEN, Pieces::Whole);
        let cut = streams::decode(bytes, MOST_GIVEN, Pieces::Of(3));
        assert!(whole.0.len() > MOST_GIVEN || whole == cut, "the pieces matter");
        let fast = streams::decode_fast(bytes, MOST_GIVEN, Pieces::Whole);
        let is_long = [&whole, &fast].iter().any(|decoded| decoded.0.len() > MOST_GIVEN);
        assert!(is_long || streams::agree(&whole, &fast), "the memory matters");
        return whole.1.is_err();
    }
    if SlabPlan::parse(bytes).is_ok_and(|(plan, _)| plan.samples_len() > MOST_GIVEN) {
        return true;
    }
    let whole = slabs::decode(bytes, MOST_GIVEN);
    assert_eq!(slabs::decode(bytes, 3), whole, "the pieces matter");
    whole.1.is_err()
}
