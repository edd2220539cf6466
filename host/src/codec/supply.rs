//! The values of one time step, from wherever they come, in any order and as often as needed.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::Range;

use super::CompressError;
use crate::volume::{Header, Source};

/// Bytes that are copied at a time.
const PIECE_BYTES: u64 = 1 << 22;

/// How the values of a time step lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) extent: [u64; 3],
    pub(super) components: u32,
    /// Bytes of one value.
    pub(super) size: usize,
}

impl Layout {
    pub(super) const fn of(header: &Header) -> Self {
        Self { extent: header.extent, components: header.components, size: header.element.bytes() }
    }

    /// Bytes of a sample, all components.
    pub(super) const fn sample(&self) -> u64 {
        self.components as u64 * self.size as u64
    }

    /// The bytes of a box of `sides` samples from `origin` on: in as few stretches as can be.
    pub(super) fn stretches(&self, origin: [u64; 3], sides: [u64; 3]) -> Vec<Range<u64>> {
        let ([width, height, _], [x, y, z]) = (self.extent, origin);
        let first = |y: u64, z: u64| ((z * height + y) * width + x) * self.sample();
        let row = sides[0] * self.sample();
        let starts: (Vec<u64>, u64) = match sides {
            [w, h, d] if (w, h) == (width, height) => (vec![first(y, z)], h * d),
            [w, h, d] if w == width => ((z..z + d).map(|z| first(y, z)).collect(), h),
            [_, h, d] => ((z..z + d).flat_map(|z| (y..y + h).map(move |y| first(y, z))).collect(), 1),
        };
        let (starts, rows) = starts;
        starts.into_iter().map(|start| start..start + rows * row).collect()
    }
}

/// Values of several components, in a box of samples: component fastest, then x, y, z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<'a> {
    pub(super) values: &'a [u8],
    pub(super) layout: Layout,
    /// Of the first sample.
    pub(super) origin: [u64; 3],
    pub(super) sides: [u64; 3],
}

impl Block<'_> {
    /// The values of one component in a box that lies within.
    pub(super) fn cut(&self, origin: [u64; 3], sides: [u32; 3], component: u32) -> Vec<u8> {
        let size = self.layout.size;
        let sample = self.layout.sample() as usize;
        let [x, y, z] = [0, 1, 2].map(|axis| (origin[axis] - self.origin[axis]) as usize);
        let ([width, height, _], [w, h, d]) =
            (self.sides.map(|side| side as usize), sides.map(|side| side as usize));
        let mut cut = Vec::with_capacity(w * h * d * size);
        for (z, y) in (z..z + d).flat_map(|z| (y..y + h).map(move |y| (z, y))) {
            let row = &self.values[((z * height + y) * width + x) * sample..][..w * sample];
            if sample == size {
                cut.extend_from_slice(row);
            } else {
                let values = row.chunks_exact(sample);
                values.for_each(|values| cut.extend_from_slice(&values[component as usize * size..][..size]));
            }
        }
        cut
    }
}

/// The values of one time step.
pub(super) enum Supply<'a> {
    /// A source that goes to any place at little cost, and where the step begins in it.
    Source(&'a mut dyn Source, u64),
    /// What a source gave that does not.
    Memory(Vec<u8>),
    /// The same, where it was too much: a nameless temporary file.
    Spool(File),
}

impl<'a> Supply<'a> {
    /// Step number `step` of a source; if that does not go to any place at little cost, it is copied, to memory if it is
    /// at most `most` bytes.
    pub(super) fn new(source: &'a mut dyn Source, step: u64, most: u64) -> Result<Self, CompressError> {
        let bytes = source.header().step_bytes().unwrap_or(u64::MAX);
        let start = bytes.saturating_mul(step);
        if source.is_random() {
            return Ok(Self::Source(source, start));
        }
        source.seek(start)?;
        let mut gathered = Gathered::new(bytes, most)?;
        let mut piece = Vec::new();
        while gathered.missing() > 0 {
            piece.resize(gathered.missing().min(PIECE_BYTES) as usize, 0);
            source.read(&mut piece)?;
            gathered.push(&piece)?;
        }
        Ok(gathered.into_supply())
    }

    /// Bytes of memory that it takes for the values.
    pub(super) const fn held(&self) -> u64 {
        match self {
            Self::Memory(memory) => memory.len() as u64,
            Self::Source(..) | Self::Spool(_) => 0,
        }
    }

    /// Appends stretches of the bytes of the step to `out`.
    pub(super) fn read(&mut self, stretches: &[Range<u64>], out: &mut Vec<u8>) -> Result<(), CompressError> {
        for stretch in stretches {
            let start = out.len();
            out.resize(start + (stretch.end - stretch.start) as usize, 0);
            self.fill(stretch.start, &mut out[start..])?;
        }
        Ok(())
    }

    fn fill(&mut self, position: u64, out: &mut [u8]) -> Result<(), CompressError> {
        match self {
            Self::Source(source, start) => {
                source.seek(*start + position)?;
                source.read(out)?;
            }
            Self::Memory(memory) => out.copy_from_slice(&memory[position as usize..][..out.len()]),
            Self::Spool(file) => {
                let found = file.seek(SeekFrom::Start(position)).and_then(|_| file.read_exact(out));
                found.map_err(CompressError::Spool)?;
            }
        }
        Ok(())
    }
}

/// The values of a time step on their way to be a [`Supply`].
#[derive(Debug)]
pub(super) struct Gathered {
    place: Place,
    bytes: u64,
    found: u64,
}

#[derive(Debug)]
enum Place {
    Memory(Vec<u8>),
    File(File),
}

impl Gathered {
    /// Room for a step of `bytes`: in memory if that is at most `most`, else in a nameless temporary file.
    pub(super) fn new(bytes: u64, most: u64) -> Result<Self, CompressError> {
        let place = match bytes <= most {
            true => Place::Memory(Vec::new()),
            false => Place::File(tempfile::tempfile().map_err(CompressError::Spool)?),
        };
        Ok(Self { place, bytes, found: 0 })
    }

    /// Bytes that are there.
    pub(super) const fn found(&self) -> u64 {
        self.found
    }

    /// Bytes that are to come.
    pub(super) const fn missing(&self) -> u64 {
        self.bytes - self.found
    }

    /// Takes the next values, which are not more than are missing.
    pub(super) fn push(&mut self, values: &[u8]) -> Result<(), CompressError> {
        match &mut self.place {
            Place::Memory(memory) => memory.extend_from_slice(values),
            Place::File(file) => file.write_all(values).map_err(CompressError::Spool)?,
        }
        self.found += values.len() as u64;
        Ok(())
    }

    /// Takes the values of these stretches of the step, none of which was given before.
    pub(super) fn put(&mut self, stretches: &[Range<u64>], mut values: &[u8]) -> Result<(), CompressError> {
        for stretch in stretches {
            let (these, others) = values.split_at((stretch.end - stretch.start) as usize);
            match &mut self.place {
                Place::Memory(memory) => {
                    memory.resize(self.bytes as usize, 0);
                    memory[stretch.start as usize..][..these.len()].copy_from_slice(these);
                }
                Place::File(file) => {
                    let found = file.seek(SeekFrom::Start(stretch.start));
                    found.and_then(|_| file.write_all(these)).map_err(CompressError::Spool)?;
                }
            }
            self.found += these.len() as u64;
            values = others;
        }
        Ok(())
    }

    /// The values, all of which are there.
    pub(super) fn into_supply<'a>(self) -> Supply<'a> {
        match self.place {
            Place::Memory(memory) => Supply::Memory(memory),
            Place::File(file) => Supply::Spool(file),
        }
    }
}
