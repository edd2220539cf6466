//! An image in several pieces, each a box of it: in one file, or in files of their own that a `.pvti` lists.
//!
//! Source: *VTK File Formats* (Kitware), part "Parallel XML File Formats". Of pieces that are neighbours both have the
//! points between them; with ghosts a file has more points than it is listed with.

use std::path::{Path, PathBuf};

use super::VtkError;
use super::grid::Grid;
use super::xml::{Layout, Values, open_part};
use crate::volume::input::Input;
use crate::volume::pieces::Pieces;
use crate::volume::{FileFormat, Header, ReadError, Source};

/// Bytes of samples that are put together at a time, unless a row has more, or less is asked for.
const SLAB_BYTES: u64 = 1 << 24;

/// Bytes of samples that are put together at a time at least.
const LEAST_SLAB_BYTES: u64 = 1 << 12;

/// Files that are open at once.
const MOST_OPEN: usize = 64;

/// Where the samples of a part are.
#[derive(Debug)]
pub(super) enum Store {
    /// In the file of the whole.
    Here(Values),
    /// In a file of their own.
    File(PathBuf),
}

/// Samples of an image, counted from its first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    from: [u64; 3],
    to: [u64; 3],
}

impl Part {
    /// The samples of a grid of points within that of the whole.
    fn of(grid: &Grid, whole: &Grid) -> Option<Self> {
        let (sides, all) = (grid.samples(), whole.samples());
        let (mut from, mut to) = ([0_u64; 3], [0; 3]);
        for axis in 0..3 {
            from[axis] = grid.start[axis].checked_sub(whole.start[axis])?.try_into().ok()?;
            to[axis] = from[axis].checked_add(sides[axis]).filter(|&end| end <= all[axis])?;
        }
        Some(Self { from, to })
    }

    /// The samples that are in both.
    fn common(&self, other: &Self) -> Option<Self> {
        let from = std::array::from_fn(|axis| self.from[axis].max(other.from[axis]));
        let to = std::array::from_fn(|axis| self.to[axis].min(other.to[axis]));
        (0..3).all(|axis| from[axis] < to[axis]).then_some(Self { from, to })
    }

    fn sides(&self) -> [u64; 3] {
        std::array::from_fn(|axis| self.to[axis] - self.from[axis])
    }

    /// Number of the sample at a place among all of these.
    fn index(&self, [x, y, z]: [u64; 3]) -> u64 {
        let ([x0, y0, z0], [width, height, _]) = (self.from, self.sides());
        ((z - z0) * height + (y - y0)) * width + (x - x0)
    }
}

/// An image in several pieces.
pub(super) struct Parts {
    path: PathBuf,
    header: Header,
    /// The points of all, and the name of the array.
    grid: Grid,
    name: String,
    layout: Layout,
    parts: Vec<(Part, Grid, Store)>,
    /// Those that are open, by their numbers, and the samples that they have.
    open: Vec<(usize, Part, Box<dyn Source>)>,
    /// Bytes of samples that are put together at a time.
    slab_bytes: u64,
}

impl Parts {
    /// An image of `header` on `grid`, of which each piece has the points of a grid; pieces without points are none.
    pub(super) fn new(
        path: &Path,
        (header, grid, name): (Header, Grid, String),
        layout: Layout,
        pieces: Vec<(Grid, Store)>,
    ) -> Result<Self, VtkError> {
        let mut parts = Vec::new();
        for (piece, store) in pieces {
            let part = Part::of(&piece, &grid).ok_or(VtkError::Outside)?;
            parts.push((part, piece, store));
        }
        let path = path.to_owned();
        Ok(Self { path, header, grid, name, layout, parts, open: Vec::new(), slab_bytes: SLAB_BYTES })
    }

    fn fault(&self, cause: VtkError) -> ReadError {
        ReadError::Format { path: self.path.clone(), format: FileFormat::VtkXml, cause: Box::new(cause) }
    }

    /// The whole planes, or the rows of one, that a byte lies in.
    fn slab(&self, position: u64) -> Part {
        let [width, height, depth] = self.header.extent;
        let row = width * self.sample_bytes();
        let (y, z) = (position / row % height, position / row / height);
        let rows = (self.slab_bytes / row).max(1);
        if rows < height {
            let first = y - y % rows;
            return Part { from: [0, first, z], to: [width, (first + rows).min(height), z + 1] };
        }
        let planes = rows / height;
        let first = z - z % planes;
        Part { from: [0, 0, first], to: [width, height, (first + planes).min(depth)] }
    }

    fn sample_bytes(&self) -> u64 {
        u64::from(self.header.components) * self.header.element.bytes() as u64
    }

    /// The source of a part, and the samples that it has.
    fn opened(&mut self, index: usize) -> Result<&mut (usize, Part, Box<dyn Source>), ReadError> {
        let place = self.open.iter().position(|(open, ..)| *open == index);
        let place = match place {
            Some(place) => place,
            None => {
                let (part, source) = self.open_part(index)?;
                if self.open.len() == MOST_OPEN {
                    self.open.remove(0);
                }
                self.open.push((index, part, source));
                self.open.len() - 1
            }
        };
        Ok(&mut self.open[place])
    }

    fn open_part(&self, index: usize) -> Result<(Part, Box<dyn Source>), ReadError> {
        let (part, grid, store) = &self.parts[index];
        let file = match store {
            Store::Here(values) => {
                let header = Header { extent: grid.samples(), ..self.header.clone() };
                let source = self.layout.open(Input::open(&self.path)?, *values, header)?;
                return Ok((*part, source));
            }
            Store::File(file) => file,
        };
        let (source, found) = open_part(file, &self.name)?;
        let (ours, theirs) = (&self.header, source.header());
        let is_alike = found.of_cells == self.grid.of_cells
            && (theirs.element, theirs.components) == (ours.element, ours.components);
        let has = Part::of(&found, &self.grid).filter(|has| is_alike && has.common(part) == Some(*part));
        let has = has.ok_or_else(|| ReadError::Format {
            path: file.clone(),
            format: FileFormat::VtkXml,
            cause: Box::new(VtkError::OtherPiece { list: self.path.display().to_string() }),
        })?;
        Ok((has, source))
    }

    /// Copies what a part has of a slab to its place there, and takes note of it.
    fn fill(
        &mut self,
        index: usize,
        slab: Part,
        (values, is_there): (&mut [u8], &mut [bool]),
    ) -> Result<(), ReadError> {
        let sample = self.sample_bytes();
        let Some(common) = self.parts[index].0.common(&slab) else { return Ok(()) };
        let (_, has, source) = self.opened(index)?;
        let ([width, ..], [count, rows, _]) = (has.sides(), common.sides());
        let [x, y, _] = common.from;
        let mut found = vec![0; (rows * width * sample) as usize];
        for z in common.from[2]..common.to[2] {
            source.seek(has.index([has.from[0], y, z]) * sample)?;
            source.read(&mut found)?;
            for (row, found) in found.chunks_exact((width * sample) as usize).enumerate() {
                let found = &found[((x - has.from[0]) * sample) as usize..][..(count * sample) as usize];
                let first = slab.index([x, y + row as u64, z]) as usize;
                values[first * sample as usize..][..found.len()].copy_from_slice(found);
                is_there[first..first + count as usize].fill(true);
            }
        }
        Ok(())
    }
}

impl Pieces for Parts {
    fn header(&self) -> &Header {
        &self.header
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn piece(&mut self, position: u64) -> Result<(Vec<u8>, u64), ReadError> {
        let slab = self.slab(position);
        let [width, height, depth] = slab.sides();
        let (samples, sample) = (width * height * depth, self.sample_bytes());
        let too_large = || ReadError::TooLarge { path: self.path.clone(), bytes: samples * sample };
        let len = usize::try_from(samples * sample).map_err(|_| too_large())?;
        Vec::<[u8; 3]>::new().try_reserve_exact(len).map_err(|_| too_large())?;
        // Zeros take no memory before they are written: what is not in the files fails before that.
        let (mut values, mut is_there) = (vec![0; len], vec![false; samples as usize]);
        for index in 0..self.parts.len() {
            self.fill(index, slab, (&mut values, &mut is_there))?;
        }
        if let Some(hole) = is_there.iter().position(|is_there| !is_there) {
            let (hole, [x, y, z]) = (hole as u64, slab.from);
            let place = [x + hole % width, y + hole / width % height, z + hole / width / height];
            return Err(self.fault(VtkError::Hole { place }));
        }
        let [all_width, all_height, _] = self.header.extent;
        let [_, y, z] = slab.from;
        Ok((values, (z * all_height + y) * all_width * sample))
    }

    fn hold_at_most(&mut self, bytes: u64) -> u64 {
        // As much again for what is copied.
        self.slab_bytes = (bytes / 2).clamp(LEAST_SLAB_BYTES, SLAB_BYTES);
        2 * self.slab_bytes
    }

    fn files(&self) -> Vec<PathBuf> {
        let files = self.parts.iter().filter_map(|(.., store)| match store {
            Store::Here(_) => None,
            Store::File(file) => Some(file.clone()),
        });
        std::iter::once(self.path.clone()).chain(files).collect()
    }
}
