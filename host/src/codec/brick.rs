//! One brick, from the samples of a volume to codestreams and back.

use wavelift_kernel::{
    Codec, DecodeError, Dense, EncodeError, Extent, Header, Lattice, Near, Plan, SampleType, Training,
    max_encoded_len,
};

use super::choice::Transform;
use super::container::Kept;
use super::grid::per_axis;
use super::{Brick, Effort, Form, scaled};
use crate::bound::{Deviation, Exceptions, Scale};
use crate::volume::{ElementType, Volume};

/// How the bricks of a volume are coded.
#[derive(Clone, Debug)]
pub(super) struct Coding {
    pub(super) effort: Effort,
    pub(super) transform: Transform,
    pub(super) form: Form,
    /// How far a sample may move.
    pub(super) error: f64,
}

impl Coding {
    /// The efforts that each brick is encoded with, of which the shortest codestream is kept.
    const fn tried(&self) -> &'static [Effort] {
        match self.effort {
            _ if self.form.slack().is_some() => &[Effort::Default],
            Effort::Fast => &[Effort::Fast],
            Effort::Default => &[Effort::Default],
            Effort::Dense => &Effort::ALL,
        }
    }
}

/// A brick in the file.
#[derive(Debug)]
pub(super) struct Encoded {
    /// Its codestreams, one after another, then its exceptions.
    pub(super) bytes: Vec<u8>,
    /// Bytes of each codestream.
    pub(super) lengths: Vec<u32>,
    /// Its exceptions, if it is on a scale.
    pub(super) exceptions: Option<Kept>,
    /// Checksum of the samples as they will be decoded, little-endian in their own type, x fastest.
    pub(super) samples_crc: u32,
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

/// A brick that decodes to other samples than it may.
#[derive(Debug)]
pub(super) struct Unfaithful;

/// The memory that is kept from brick to brick.
#[derive(Debug)]
pub(super) struct Worker {
    codec: Box<Codec>,
    training: Box<Training>,
    dense: Box<Dense>,
    lattice: Box<Lattice>,
    /// The samples of the brick.
    bytes: Vec<u8>,
    integers: Vec<i32>,
    scratch: Vec<i32>,
    out: Vec<u8>,
}

impl Worker {
    pub(super) fn new() -> Self {
        let [integers, scratch] = [Vec::new(), Vec::new()];
        let (codec, training, dense) = (Box::new(Codec::NEW), Box::new(Training::NEW), Box::new(Dense::NEW));
        let (lattice, bytes, out) = (Box::new(Lattice::NEW), Vec::new(), Vec::new());
        Self { codec, training, dense, lattice, bytes, integers, scratch, out }
    }

    /// Encodes `brick` of a volume. What is not coded exactly is decoded again, to know what a reader will get.
    pub(super) fn encode(
        &mut self,
        volume: &Volume,
        brick: Brick,
        coding: &Coding,
    ) -> Result<Encoded, Unfaithful> {
        self.bytes.clear();
        for row in volume.rows(brick.origin, brick.sides) {
            self.bytes.extend_from_slice(row);
        }
        let (element, extent) = (volume.element, extent(brick));
        match coding.form {
            Form::Exact | Form::Packed(_) => Ok(self.encode_planes(element, extent, coding)),
            Form::Steps(_) | Form::Near(_) => self.encode_integers(element, extent, coding),
            Form::Scaled { scale, .. } => self.encode_scaled(element, brick, coding, scale),
        }
    }

    /// Encodes the integers of `self.bytes`, within the bound.
    fn encode_integers(
        &mut self,
        element: ElementType,
        extent: Extent,
        coding: &Coding,
    ) -> Result<Encoded, Unfaithful> {
        let mut encoded = self.encode_planes(element, extent, coding);
        let planes = self.decode_again(element, extent, coding, &encoded)?;
        let restored = coding.form.join(element, &planes);
        encoded.samples_crc = crc32fast::hash(&restored);
        let deviation = Deviation::of(element, &self.bytes, &restored, coding.error);
        if deviation.beyond.is_some() { Err(Unfaithful) } else { Ok(encoded) }
    }

    /// Encodes the samples of `self.bytes` on a scale, with the bits of those that are not on it; or exactly, where
    /// that is shorter.
    fn encode_scaled(
        &mut self,
        element: ElementType,
        brick: Brick,
        coding: &Coding,
        scale: Scale,
    ) -> Result<Encoded, Unfaithful> {
        let extent = extent(brick);
        let mut encoded = self.encode_planes(element, extent, coding);
        let planes = self.decode_again(element, extent, coding, &encoded)?;
        let [integers] = &planes[..] else { return Err(Unfaithful) };
        let exceptions = scaled::exceptions(element, scale, &self.bytes, integers, coding.error);
        let mut restored = coding.form.join(element, &planes);
        let mut kept = Kept::default();
        if !exceptions.is_empty() {
            let stored = postcard::to_allocvec(&exceptions).expect("runs are written to memory");
            kept = Kept { samples: exceptions.samples() as u32, bytes: stored.len() as u32 };
            if stored.len() > encoded.bytes.len() {
                let exactly = Coding { transform: Transform::NONE, form: Form::Exact, ..*coding };
                let exact = self.encode_planes(element, extent, &exactly);
                if exact.bytes.len() < encoded.bytes.len() + stored.len() {
                    return Ok(exact);
                }
            }
            encoded.bytes.extend_from_slice(&stored);
            if !scaled::apply(&exceptions, element, (brick.sides, 0), &mut restored) {
                return Err(Unfaithful);
            }
        }
        let deviation = Deviation::of(element, &self.bytes, &restored, coding.error);
        encoded.exceptions = Some(kept);
        encoded.samples_crc = crc32fast::hash(&restored);
        if deviation.beyond.is_some() { Err(Unfaithful) } else { Ok(encoded) }
    }

    /// Encodes the planes of the samples of `self.bytes`.
    fn encode_planes(&mut self, element: ElementType, extent: Extent, coding: &Coding) -> Encoded {
        let samples_crc = crc32fast::hash(&self.bytes);
        let mut encoded = Encoded { bytes: Vec::new(), lengths: Vec::new(), exceptions: None, samples_crc };
        for (plane, sample_type) in coding.form.sample_types(element).into_iter().enumerate() {
            let most = max_encoded_len(extent, sample_type).expect("2^27 samples of 4 bytes fit into memory");
            self.out.resize(most.max(self.out.len()), 0);
            let start = encoded.bytes.len();
            for &effort in coding.tried() {
                self.integers.resize(extent.samples(), 0);
                coding.form.split(element, plane, &self.bytes, &mut self.integers);
                let len = match coding.form.slack() {
                    Some(slack) => self.encode_lattice(Near { extent, sample_type, slack }),
                    None => self.encode_plane(&coding.transform.plan(extent), sample_type, effort),
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
        encoded
    }

    /// Encodes `self.integers` into `self.out`; returns the length.
    fn encode_plane(
        &mut self,
        plan: &Plan,
        sample_type: SampleType,
        effort: Effort,
    ) -> Result<usize, EncodeError> {
        let effort = effort.of_kernel(&mut self.training, &mut self.dense);
        self.scratch.resize(effort.scratch_len(plan).max(self.scratch.len()), 0);
        self.codec.encode(effort, plan, sample_type, &mut self.integers, &mut self.scratch, &mut self.out)
    }

    /// As [`Worker::encode_plane`], as a lattice.
    fn encode_lattice(&mut self, near: Near) -> Result<usize, EncodeError> {
        self.scratch.resize(Lattice::encoding_scratch_len(near.extent).max(self.scratch.len()), 0);
        self.lattice.encode(near, &mut self.integers, &mut self.scratch, &mut self.out)
    }

    /// The planes of what was encoded, as a reader will get them.
    fn decode_again(
        &mut self,
        element: ElementType,
        extent: Extent,
        coding: &Coding,
        encoded: &Encoded,
    ) -> Result<Vec<Vec<i32>>, Unfaithful> {
        let expected = Expected::new(element, &coding.form, coding.transform, extent);
        let decoded = self.decode(&encoded.bytes, &encoded.lengths, &expected, 0);
        decoded.map(|decoded| decoded.planes).map_err(|_| Unfaithful)
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
            let (codestream, after) =
                rest.split_at_checked(len as usize).ok_or("it is shorter than its codestreams")?;
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

fn extent(brick: Brick) -> Extent {
    Extent::new(brick.sides).expect("a grid has bricks of at most 2^27 samples")
}

fn text(error: DecodeError) -> String {
    error.to_string()
}

/// Copies a decoded box of `sides` samples, of which those `from .. to` are wanted, to `place` in `part` of `extent`.
pub(super) fn scatter(
    bytes: &[u8],
    sides: [usize; 3],
    wanted: [std::ops::Range<usize>; 3],
    place: [usize; 3],
    (part, extent, sample): (&mut [u8], [usize; 3], usize),
) {
    let [x, y, z] = wanted;
    for (dz, z) in z.enumerate() {
        for (dy, y) in y.clone().enumerate() {
            let from = ((z * sides[1] + y) * sides[0] + x.start) * sample;
            let to = (((place[2] + dz) * extent[1] + place[1] + dy) * extent[0] + place[0]) * sample;
            let len = x.len() * sample;
            part[to..to + len].copy_from_slice(&bytes[from..from + len]);
        }
    }
}

/// The sides of a brick of `sides` samples at `level`.
pub(super) fn coarsened(sides: [u32; 3], level: u8) -> [usize; 3] {
    per_axis(|axis| (((u64::from(sides[axis]) - 1) >> level.min(63)) + 1) as usize)
}
