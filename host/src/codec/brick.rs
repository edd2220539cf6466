//! One brick, from the samples of a volume to codestreams and back.

use wavelift_kernel::{
    Codec, DecodeError, Dense, EncodeError, Extent, Header, Lattice, Near, Plan, SampleType, Training,
    max_encoded_len,
};

use super::choice::Transform;
use super::content::{BrickLabel, Kept, Place};
use super::effort::Way;
use super::grid::per_axis;
use super::{Effort, Form, Statistics, scaled};
use crate::bound::{Deviation, Exceptions, Scale};
use crate::volume::ElementType;

/// How the bricks of a volume are coded.
#[derive(Clone, Debug)]
pub(super) struct Coding {
    pub(super) effort: Effort,
    pub(super) transform: Transform,
    pub(super) form: Form,
    /// How far a sample may move.
    pub(super) error: f64,
}

/// The samples of a brick: single values, little-endian, x fastest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Samples<'a> {
    pub(super) element: ElementType,
    pub(super) sides: [u32; 3],
    pub(super) bytes: &'a [u8],
}

impl Samples<'_> {
    fn extent(&self) -> Extent {
        Extent::new(self.sides).expect("a grid has bricks of at most 2^27 samples")
    }
}

/// A brick in the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Encoded {
    /// Its codestreams, one after another, then its exceptions.
    pub(super) bytes: Vec<u8>,
    /// Bytes of each codestream.
    pub(super) lengths: Vec<u32>,
    /// Its exceptions, if it is on a scale.
    pub(super) exceptions: Option<Kept>,
    /// Checksum of the samples as they will be decoded, little-endian in their own type, x fastest.
    pub(super) samples_crc: u32,
    /// What these samples are like.
    pub(super) statistics: Option<Statistics>,
}

impl Encoded {
    /// The record before it, of a volume that can be read down to level `readable_levels`.
    pub(super) fn label(&self, place: Place, readable_levels: u8) -> BrickLabel {
        BrickLabel {
            place,
            lengths: self.lengths.clone(),
            exceptions: self.exceptions,
            stored_crc: crc32fast::hash(&self.bytes),
            samples_crc: self.samples_crc,
            level_checks: self.level_checks(readable_levels),
        }
    }

    /// Takes note of the samples that a reader will get.
    fn note(&mut self, element: ElementType, restored: &[u8]) {
        self.samples_crc = crc32fast::hash(restored);
        self.statistics = Statistics::of(element, restored);
    }

    /// Takes note of the samples that a reader will get, and looks whether they are within the bound.
    fn confirm(&mut self, samples: Samples<'_>, restored: &[u8], error: f64) -> Result<(), Unencodable> {
        self.note(samples.element, restored);
        let deviation = Deviation::of(samples.element, samples.bytes, restored, error);
        if deviation.beyond.is_some() { Err(Unencodable::Unfaithful) } else { Ok(()) }
    }

    /// The checks of the beginnings that make levels, where those are shorter than the whole.
    fn level_checks(&self, readable_levels: u8) -> Vec<[u8; 2]> {
        let (len, header) = match (&self.lengths[..], Header::parse(&self.bytes)) {
            ([len], Ok(header)) if !header.is_stored() => (*len as usize, header),
            _ => return Vec::new(),
        };
        let levels = 1..=readable_levels.min(header.plan().levels());
        let prefix = |level| &self.bytes[..header.bytes_to_level(level) as usize];
        levels.map(|level| check(prefix(level), &self.bytes[len..])).collect()
    }
}

/// The check of what makes a level: the beginning of a codestream, and all exceptions.
pub(super) fn check(beginning: &[u8], exceptions: &[u8]) -> [u8; 2] {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(beginning);
    hasher.update(exceptions);
    let [low, high, ..] = hasher.finalize().to_le_bytes();
    [low, high]
}

/// A decoded brick, whole or at a level.
#[derive(Debug)]
pub(super) struct Decoded {
    /// One plane, or high and low halves.
    pub(super) planes: Vec<Vec<i32>>,
    /// Header of the first plane.
    pub(super) header: Header,
}

/// What the codestreams of a brick must be.
#[derive(Debug)]
pub(super) struct Expected {
    types: Vec<SampleType>,
    plan: Plan,
    slack: Option<u32>,
}

impl Expected {
    pub(super) fn new(element: ElementType, form: &Form, transform: Transform, extent: Extent) -> Self {
        Self { types: form.sample_types(element), plan: transform.plan(extent), slack: form.slack() }
    }

    /// Whether a codestream is so; lattices choose their levels.
    fn is_met(&self, header: &Header, sample_type: SampleType) -> bool {
        let is_planned = match header.slack() {
            Some(slack) => self.slack == Some(slack) && header.plan().extent() == self.plan.extent(),
            None => header.plan() == self.plan && (self.slack.is_none() || header.is_stored()),
        };
        is_planned && header.sample_type() == sample_type
    }
}

/// Why a brick cannot be coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unencodable {
    /// It decodes to other samples than it may.
    Unfaithful,
    /// It has values that the volume did not have when it was looked through.
    Unknown,
}

/// The memory that is kept from brick to brick.
#[derive(Debug)]
pub(super) struct Worker {
    codec: Box<Codec>,
    training: Box<Training>,
    dense: Box<Dense>,
    lattice: Box<Lattice>,
    integers: Vec<i32>,
    scratch: Vec<i32>,
    out: Vec<u8>,
}

impl Worker {
    pub(super) fn new() -> Self {
        let [integers, scratch] = [Vec::new(), Vec::new()];
        let (codec, training, dense) = (Box::new(Codec::NEW), Box::new(Training::NEW), Box::new(Dense::NEW));
        let (lattice, out) = (Box::new(Lattice::NEW), Vec::new());
        Self { codec, training, dense, lattice, integers, scratch, out }
    }

    /// Encodes a brick. What is not coded exactly is compared with what a reader will get.
    pub(super) fn encode(&mut self, samples: Samples<'_>, coding: &Coding) -> Result<Encoded, Unencodable> {
        match coding.form {
            Form::Exact | Form::Packed(_) => self.encode_exactly(samples, coding),
            Form::Steps(_) | Form::Near(_) => self.encode_integers(samples, coding),
            Form::Scaled { scale, .. } => self.encode_scaled(samples, coding, scale),
        }
    }

    /// Encodes samples of which every bit is kept.
    fn encode_exactly(&mut self, samples: Samples<'_>, coding: &Coding) -> Result<Encoded, Unencodable> {
        let mut encoded = self.encode_planes(samples, coding)?;
        encoded.note(samples.element, samples.bytes);
        Ok(encoded)
    }

    /// Encodes integers, within the bound.
    fn encode_integers(&mut self, samples: Samples<'_>, coding: &Coding) -> Result<Encoded, Unencodable> {
        let (mut encoded, planes) = self.encode_moved(samples, coding)?;
        let restored = coding.form.join(samples.element, &planes);
        encoded.confirm(samples, &restored, coding.error)?;
        Ok(encoded)
    }

    /// Encodes samples on a scale, with the bits of those that are not on it; or exactly, where that is shorter.
    fn encode_scaled(
        &mut self,
        samples: Samples<'_>,
        coding: &Coding,
        scale: Scale,
    ) -> Result<Encoded, Unencodable> {
        let element = samples.element;
        let (mut encoded, planes) = self.encode_moved(samples, coding)?;
        let [integers] = &planes[..] else { return Err(Unencodable::Unfaithful) };
        let exceptions = scaled::exceptions(element, scale, samples.bytes, integers, coding.error);
        let mut restored = coding.form.join(element, &planes);
        let mut kept = Kept::default();
        if !exceptions.is_empty() {
            let stored = postcard::to_allocvec(&exceptions).expect("runs are written to memory");
            kept = Kept { samples: exceptions.samples() as u32, bytes: stored.len() as u32 };
            if stored.len() > encoded.bytes.len() {
                let exactly = Coding { transform: Transform::NONE, form: Form::Exact, ..*coding };
                let exact = self.encode_exactly(samples, &exactly)?;
                if exact.bytes.len() < encoded.bytes.len() + stored.len() {
                    return Ok(exact);
                }
            }
            encoded.bytes.extend_from_slice(&stored);
            if !scaled::apply(&exceptions, element, (samples.sides, 0), &mut restored) {
                return Err(Unencodable::Unfaithful);
            }
        }
        encoded.exceptions = Some(kept);
        encoded.confirm(samples, &restored, coding.error)?;
        Ok(encoded)
    }

    /// Encodes the planes of samples that may move; returns also the planes that a reader will get: the same, or what a
    /// lattice leaves of them.
    fn encode_moved(
        &mut self,
        samples: Samples<'_>,
        coding: &Coding,
    ) -> Result<(Encoded, Vec<Vec<i32>>), Unencodable> {
        let encoded = self.encode_planes(samples, coding)?;
        let len = samples.extent().samples();
        if coding.form.slack().is_some() {
            // There is one plane of it, and what the kernel makes of that stands there.
            return Ok((encoded, vec![self.scratch[..len].to_vec()]));
        }
        let planes = (0..encoded.lengths.len()).map(|plane| {
            let mut integers = vec![0; len];
            let split = coding.form.split(samples.element, plane, samples.bytes, &mut integers);
            split.map(|()| integers).ok_or(Unencodable::Unknown)
        });
        let planes = planes.collect::<Result<_, _>>()?;
        Ok((encoded, planes))
    }

    /// Encodes the planes of samples.
    fn encode_planes(&mut self, samples: Samples<'_>, coding: &Coding) -> Result<Encoded, Unencodable> {
        let (element, extent) = (samples.element, samples.extent());
        let mut encoded = Encoded::default();
        for (plane, sample_type) in coding.form.sample_types(element).into_iter().enumerate() {
            let most = max_encoded_len(extent, sample_type).expect("2^27 samples of 4 bytes fit into memory");
            self.out.resize(most.max(self.out.len()), 0);
            let start = encoded.bytes.len();
            // A lattice is coded one way only.
            let ways = coding.form.slack().map_or(usize::MAX, |_| 1);
            for &way in coding.effort.ways().iter().take(ways) {
                self.integers.resize(extent.samples(), 0);
                let split = coding.form.split(element, plane, samples.bytes, &mut self.integers);
                split.ok_or(Unencodable::Unknown)?;
                let len = match coding.form.slack() {
                    Some(slack) => self.encode_lattice(Near { extent, sample_type, slack }),
                    None => {
                        let way = way.of_samples(&self.integers);
                        self.encode_plane(&coding.transform.plan(extent), sample_type, way)
                    }
                };
                let len = len.expect("the memory lent has the lengths that the kernel asks for");
                if encoded.bytes.len() == start || len < encoded.bytes.len() - start {
                    encoded.bytes.truncate(start);
                    encoded.bytes.extend_from_slice(&self.out[..len]);
                }
            }
            let len = encoded.bytes.len() - start;
            encoded.lengths.push(u32::try_from(len).expect("at most max_encoded_len"));
        }
        Ok(encoded)
    }

    /// Encodes `self.integers` into `self.out`; returns the length.
    fn encode_plane(&mut self, plan: &Plan, sample_type: SampleType, way: Way) -> Result<usize, EncodeError> {
        let effort = way.of_kernel(&mut self.training, &mut self.dense);
        self.scratch.resize(effort.scratch_len(plan).max(self.scratch.len()), 0);
        self.codec.encode(effort, plan, sample_type, &mut self.integers, &mut self.scratch, &mut self.out)
    }

    /// As [`Worker::encode_plane`], as a lattice.
    fn encode_lattice(&mut self, near: Near) -> Result<usize, EncodeError> {
        self.scratch.resize(Lattice::encoding_scratch_len(near.extent).max(self.scratch.len()), 0);
        self.lattice.encode(near, &mut self.integers, &mut self.scratch, &mut self.out)
    }

    /// Decodes the codestreams of a brick down to `level`, or to its coarsest if it has fewer levels because it is
    /// small. What is not as `expected` is an error, before memory is taken.
    pub(super) fn decode(
        &mut self,
        codestreams: &[u8],
        lengths: &[u32],
        expected: &Expected,
        level: u8,
    ) -> Result<Decoded, String> {
        if lengths.len() != expected.types.len() {
            return Err("it has another number of codestreams than its type".into());
        }
        let mut rest = codestreams;
        let mut planes = Vec::new();
        let mut first = None;
        for (&sample_type, &len) in expected.types.iter().zip(lengths) {
            // Of a level there may be the beginning only, and the kernel knows how much it needs.
            let (codestream, after) = rest.split_at(rest.len().min(len as usize));
            rest = after;
            let header = Header::parse(codestream).map_err(text)?;
            if !expected.is_met(&header, sample_type) {
                return Err("its codestream is of another extent, type, transform or slack".into());
            }
            planes.push(self.decode_plane(codestream, &header, level.min(header.plan().levels()))?);
            first.get_or_insert(header);
        }
        let header = first.ok_or("it has no codestream")?;
        Ok(Decoded { planes, header })
    }

    fn decode_plane(&mut self, codestream: &[u8], header: &Header, level: u8) -> Result<Vec<i32>, String> {
        self.scratch.resize(header.scratch_len().max(self.scratch.len()), 0);
        let mut samples = vec![0; header.samples_len(level)];
        let (samples_out, scratch) = (&mut samples[..], &mut self.scratch[..]);
        match header.slack() {
            Some(_) => self.lattice.decode_to_level(codestream, level, samples_out, scratch),
            None => self.codec.decode_dense(&mut self.dense, codestream, level, samples_out, scratch),
        }
        .map_err(text)?;
        samples.truncate(header.extent_at(level).samples());
        Ok(samples)
    }
}

/// The samples whose bits are kept, which are all that follows the codestreams of a brick.
pub(super) fn read_exceptions(bytes: &[u8], kept: Kept) -> Option<Exceptions> {
    if bytes.is_empty() {
        return (kept == Kept::default()).then(Exceptions::default);
    }
    match postcard::take_from_bytes::<Exceptions>(bytes) {
        Ok((exceptions, [])) => Some(exceptions).filter(|found| found.samples() == u64::from(kept.samples)),
        _ => None,
    }
}

fn text(error: DecodeError) -> String {
    error.to_string()
}

/// The sides of a brick of `sides` samples at `level`.
pub(super) fn coarsened(sides: [u32; 3], level: u8) -> [usize; 3] {
    per_axis(|axis| (((u64::from(sides[axis]) - 1) >> level.min(63)) + 1) as usize)
}
