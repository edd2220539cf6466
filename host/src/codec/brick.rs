//! One brick, from the samples of a volume to codestreams and back.

use wavelift_kernel::{Codec, DecodeError, Extent, Header, Plan, SampleType, max_encoded_len};

use super::choice::Transform;
use super::grid::per_axis;
use super::{Brick, packing, planes};
use crate::volume::Volume;

/// How the bricks of a volume are coded.
#[derive(Clone, Debug)]
pub(super) struct Coding {
    pub(super) transform: Transform,
    /// The values that samples are packed to the numbers of.
    pub(super) values: Option<Vec<i32>>,
}

/// The codestreams of a brick, one after another.
#[derive(Debug)]
pub(super) struct Encoded {
    pub(super) codestreams: Vec<u8>,
    /// Bytes of each.
    pub(super) lengths: Vec<u32>,
    /// Checksum of the samples, little-endian in their own type, x fastest.
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

/// The memory that is kept from brick to brick.
#[derive(Debug)]
pub(super) struct Worker {
    codec: Box<Codec>,
    bytes: Vec<u8>,
    samples: Vec<i32>,
    scratch: Vec<i32>,
    out: Vec<u8>,
}

impl Worker {
    pub(super) fn new() -> Self {
        let [samples, scratch] = [Vec::new(), Vec::new()];
        Self { codec: Box::new(Codec::NEW), bytes: Vec::new(), samples, scratch, out: Vec::new() }
    }

    /// Encodes `brick` of a volume.
    pub(super) fn encode(&mut self, volume: &Volume, brick: Brick, coding: &Coding) -> Encoded {
        let element = volume.element;
        let values = coding.values.as_deref();
        self.bytes.clear();
        for row in volume.rows(brick.origin, brick.sides) {
            self.bytes.extend_from_slice(row);
        }
        let sides = Extent::new(brick.sides).expect("a grid has bricks of at most 2^27 samples");
        let plan = coding.transform.plan(sides);
        self.scratch.resize(plan.scratch_len().max(self.scratch.len()), 0);
        let mut encoded = Encoded {
            codestreams: Vec::new(),
            lengths: Vec::new(),
            samples_crc: crc32fast::hash(&self.bytes),
        };
        for (plane, sample_type) in packing::sample_types(element, values).into_iter().enumerate() {
            self.samples.resize(sides.samples(), 0);
            planes::split(element, plane, &self.bytes, &mut self.samples);
            if let Some(values) = values {
                packing::pack(values, &mut self.samples);
            }
            let most = max_encoded_len(sides, sample_type).expect("2^27 samples of 4 bytes fit into memory");
            self.out.resize(most.max(self.out.len()), 0);
            let len = self
                .codec
                .encode(&plan, sample_type, &mut self.samples, &mut self.scratch, &mut self.out)
                .expect("the memory lent has the lengths that the kernel asks for");
            encoded.codestreams.extend_from_slice(&self.out[..len]);
            encoded.lengths.push(u32::try_from(len).expect("at most max_encoded_len"));
        }
        encoded
    }

    /// Decodes the codestreams of a brick down to `level`, or to its coarsest if it has fewer levels because it is
    /// small. `plan` and `types` are what the brick must be; anything else is an error, before memory is taken.
    pub(super) fn decode(
        &mut self,
        codestreams: &[u8],
        lengths: &[u32],
        types: &[SampleType],
        plan: &Plan,
        level: u8,
    ) -> Result<Decoded, String> {
        if lengths.len() != types.len() {
            return Err("it has another number of codestreams than its type".into());
        }
        let mut rest = codestreams;
        let mut planes = Vec::new();
        let mut first = None;
        for (&sample_type, &len) in types.iter().zip(lengths) {
            let (codestream, after) =
                rest.split_at_checked(len as usize).ok_or("it is shorter than its codestreams")?;
            rest = after;
            let header = Header::parse(codestream).map_err(text)?;
            if header.sample_type() != sample_type || header.plan() != *plan {
                return Err("its codestream is of another extent, type or transform".into());
            }
            planes.push(self.decode_plane(codestream, &header, level.min(header.plan().levels()))?);
            first.get_or_insert(header);
        }
        let header = first.ok_or("it has no codestream")?;
        Ok(Decoded { planes, header })
    }

    fn decode_plane(&mut self, codestream: &[u8], header: &Header, level: u8) -> Result<Vec<i32>, String> {
        self.scratch.resize(header.plan().scratch_len().max(self.scratch.len()), 0);
        let mut samples = vec![0; header.samples_len(level)];
        self.codec.decode_to_level(codestream, level, &mut samples, &mut self.scratch).map_err(text)?;
        samples.truncate(header.extent_at(level).samples());
        Ok(samples)
    }
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
