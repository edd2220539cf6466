//! A brick coded sample by sample under what was learnt from all before: predictions by weights that are solved for as
//! coding goes, residuals under mixed chances. The smallest codestreams, and the slowest.
//!
//! The format is in `docs/dense.md`. Sources: Li and Orchard, Edge-directed prediction for lossless compression of
//! natural images, 2001, for weights that follow the samples; Mahoney, 2005, for the mixing of chances.

mod equations;
mod neighbours;
mod residual;
mod row;

pub(super) use self::equations::{CHUNK, Chunk, Sums, WEIGHT_BITS as SOLUTION_BITS, Weights as Solution};
use self::equations::{TAPS, Weights};
use self::neighbours::{ANY, BRICK, LINE, PLANE, Surroundings, known_at, taps};
use self::residual::Models;
use self::row::{Row, Scale};
use super::{Coder, range};
use crate::{Extent, Plan, SampleType};

/// Parts of a row with equations of their own, at most.
const COLUMNS: usize = 8;

/// Groups of rows of the plane before whose products are remembered, of all columns.
const GROUPS: usize = 16;

/// What a chunk makes the equations forget, in 1/256: those that follow quickly, and those that follow slowly.
const FAST_DECAY: i32 = 128;
/// As [`FAST_DECAY`].
const SLOW_DECAY: i32 = 2;

/// The weight of the plane before in the fast equations, in quarters.
const QUARTERS_BEFORE: i32 = 3;

/// Solutions that follow row after row, and all equations; later whole chunks, and slow ones every few times.
const EARLY: u32 = 16;
/// As [`EARLY`].
const SLOW_EVERY: u32 = 4;

/// The memory of [`Effort::Dense`](crate::Effort::Dense) and of decoding what it encoded, of fixed size, about 74 KiB.
///
/// Every call starts afresh, so one `Dense` serves any number of codestreams.
#[derive(Debug, PartialEq, Eq)]
pub struct Dense {
    models: Models,
    columns: [Column; COLUMNS],
    /// Sums of products of the row group that is coded, by column.
    group: [Sums; COLUMNS],
    /// Those of the groups of the plane before, group by group.
    before: [Sums; GROUPS],
    chunk: Chunk,
}

/// The equations of one part of a row.
#[derive(Debug, PartialEq, Eq)]
struct Column {
    fast: Sums,
    slow: Sums,
    fast_weights: Weights,
    slow_weights: Weights,
    solved: u32,
}

impl Column {
    const BLANK: Self = Self {
        fast: Sums::ZERO,
        slow: Sums::ZERO,
        fast_weights: [0; TAPS],
        slow_weights: [0; TAPS],
        solved: 0,
    };

    /// Starts with the weights of a plane, W + N - NW, or of a brick, W + 3/4 (N + U - NW - UW).
    fn reset(&mut self, known: u8) {
        const ONE: i16 = 1 << SOLUTION_BITS;
        const PART: i16 = ONE / 4 * 3;
        self.fast.clear();
        self.slow.clear();
        let first = match known {
            LINE => [0; 4],
            PLANE => [ONE, -ONE, 0, 0],
            _ => [PART, PART, -PART, -PART],
        };
        self.fast_weights.fill(0);
        crate::memory::copy(&first, &mut self.fast_weights);
        self.slow_weights = self.fast_weights;
        self.solved = 0;
    }
}

/// The sides of a brick without its axes of length 1, and how its rows are divided.
#[derive(Clone, Copy, Debug)]
struct Layout {
    width: usize,
    height: usize,
    depth: usize,
    /// Samples of a chunk, but of the last of a row.
    chunk: usize,
    chunks: usize,
    columns: usize,
    /// Groups of rows of a plane, at most, and the rows of each.
    groups: usize,
    group: usize,
}

impl Layout {
    const fn of(extent: Extent) -> Self {
        let (width, height, depth) = match extent.sides() {
            [1, 1, n] | [1, n, 1] => (n, 1, 1),
            [1, n, m] | [n, 1, m] => (n, m, 1),
            [x, y, z] => (x, y, z),
        };
        let chunks = width.div_ceil(CHUNK);
        let columns = if chunks < COLUMNS { chunks } else { COLUMNS };
        let groups = quotient(GROUPS, columns);
        Self {
            width,
            height,
            depth,
            chunk: quotient(width.wrapping_add(chunks).wrapping_sub(1), chunks),
            chunks,
            columns,
            groups,
            group: quotient(height.wrapping_add(groups).wrapping_sub(1), groups),
        }
    }
}

/// `a / b` of lengths above 0.
const fn quotient(a: usize, b: usize) -> usize {
    match a.checked_div(b) {
        Some(quotient) => quotient,
        None => 0,
    }
}

impl Dense {
    /// Memory that can be the value of a `static`.
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub const NEW: Self = Self {
        models: Models::BLANK,
        columns: [const { Column::BLANK }; COLUMNS],
        group: [const { Sums::ZERO }; COLUMNS],
        before: [const { Sums::ZERO }; GROUPS],
        chunk: Chunk::NEW,
    };

    /// `i32`s of scratch that encoding with [`Effort::Dense`](crate::Effort::Dense) needs for `plan`, and decoding what
    /// it encoded: eight rows and two planes, or what [`Plan::scratch_len`] says if that is more.
    #[must_use]
    pub const fn scratch_len(plan: &Plan) -> usize {
        let Layout { width, height, .. } = Layout::of(plan.extent());
        let (least, dense) = (plan.scratch_len(), Surroundings::scratch_len(width, height));
        if plan.levels() > 0 || least > dense { least } else { dense }
    }

    /// Whether samples as these can be coded: they span few enough bits.
    pub(crate) fn suits(samples: &[i32]) -> bool {
        let (lowest, highest) = range(samples);
        Scale::new(highest.wrapping_sub(lowest).cast_unsigned()).is_some()
    }

    /// Runs either direction of the coder over a brick that [`Dense::suits`]. `None` if `scratch` is shorter than
    /// [`Dense::scratch_len`], or the codestream says what no encoder does.
    pub(crate) fn code<C: Coder>(
        &mut self,
        coder: &mut C,
        extent: Extent,
        sample_type: SampleType,
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Option<()> {
        let (lowest, highest) = range(samples);
        let (bits, least) = (sample_type.bits(), *sample_type.range().start());
        let lowest =
            coder.raw(lowest.wrapping_sub(least).cast_unsigned(), bits).cast_signed().wrapping_add(least);
        let span = coder.raw(highest.wrapping_sub(lowest).cast_unsigned(), bits);
        if span == 0 {
            samples.fill(lowest);
            return Some(());
        }
        let scale = Scale::new(span)?;
        for sample in &mut *samples {
            *sample = sample.wrapping_sub(lowest);
        }
        let coded = self.code_rows(coder, &Layout::of(extent), &scale, samples, scratch);
        for sample in samples {
            *sample = sample.wrapping_add(lowest);
        }
        coded
    }

    /// Codes samples that begin at 0, row after row.
    fn code_rows<C: Coder>(
        &mut self,
        coder: &mut C,
        layout: &Layout,
        scale: &Scale,
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Option<()> {
        let &Layout { width, height, depth, .. } = layout;
        let mut surroundings = Surroundings::new(width, height, scratch)?;
        self.models.reset();
        self.before.iter_mut().for_each(Sums::clear);
        self.chunk.clear();
        for [y, z] in (0..depth).flat_map(|z| (0..height).map(move |y| [y, z])) {
            let known = known_at([y, z]);
            if y.wrapping_add(z) <= 1 {
                // The first row of its kind.
                self.columns.iter_mut().for_each(|column| column.reset(known));
                self.group.iter_mut().for_each(Sums::clear);
                self.chunk.clear();
            }
            let first = surroundings.fill(samples, [y, z], scale.middle())?;
            let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width);
            let values = samples.get_mut(start..start.wrapping_add(width))?;
            let mut row = Row { known, around: surroundings.around(y)?, wests: [first; 3], scale };
            for (number, from) in (0..width).step_by(layout.chunk.max(1)).enumerate() {
                let number = quotient(number.wrapping_mul(layout.columns), layout.chunks);
                let column = self.columns.get(number)?;
                let range = from..width.min(from.wrapping_add(layout.chunk));
                let state = (&mut self.models, column, &mut self.chunk);
                match known {
                    _ if cfg!(feature = "small") => row.code::<C, ANY>(coder, values, range, state),
                    LINE => row.code::<C, LINE>(coder, values, range, state),
                    PLANE => row.code::<C, PLANE>(coder, values, range, state),
                    _ => row.code::<C, BRICK>(coder, values, range, state),
                }?;
                self.learn(layout, [y, z], number)?;
            }
            let next = y.wrapping_add(1);
            if known == BRICK && (next == height || next.checked_rem(layout.group) == Some(0)) {
                self.remember_group(layout, quotient(y, layout.group))?;
            }
        }
        Some(())
    }

    /// Solves the equations of a column for what was learnt from the chunk, if it is time to.
    fn learn(&mut self, layout: &Layout, [y, z]: [usize; 2], number: usize) -> Option<()> {
        let (known, next) = (known_at([y, z]), y.wrapping_add(1));
        let column = self.columns.get_mut(number)?;
        let room = CHUNK.saturating_sub(self.chunk.len());
        if room >= layout.chunk && next < layout.height && column.solved >= EARLY {
            return Some(());
        }
        // The first rows of planes know the plane before only, and would mislead those that follow.
        if (known == BRICK && y == 0) || !self.chunk.tells() {
            self.chunk.clear();
            return Some(());
        }
        let taps = taps(known);
        let products = self.chunk.products(taps);
        column.slow.renew(&products, SLOW_DECAY);
        column.fast.renew(&products, FAST_DECAY);
        if column.solved < EARLY || column.solved % SLOW_EVERY == 0 {
            column.slow.solve(taps, &mut column.slow_weights)?;
        }
        column.solved = column.solved.wrapping_add(1);
        let mut fast = column.fast.clone();
        if known == BRICK {
            let group = quotient(next, layout.group);
            if z > 1 && group < layout.groups {
                let before = group.wrapping_mul(layout.columns).wrapping_add(number);
                fast.add(self.before.get(before)?, QUARTERS_BEFORE);
            }
            self.group.get_mut(number)?.renew(&products, 0);
        }
        fast.solve(taps, &mut column.fast_weights)
    }

    /// Keeps the sums of a group of rows for the next plane.
    fn remember_group(&mut self, layout: &Layout, group: usize) -> Option<()> {
        let before = self.before.get_mut(group.wrapping_mul(layout.columns)..)?;
        for (before, sums) in before.iter_mut().zip(&mut self.group).take(layout.columns) {
            before.clone_from(sums);
            sums.clear();
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Codec, DecodeError, Effort, Header, Training, Wavelet, max_encoded_len};

    extern crate std;
    use std::{boxed::Box, vec, vec::Vec};

    struct Bench {
        codec: Box<Codec>,
        dense: Box<Dense>,
        training: Box<Training>,
    }

    impl Bench {
        fn new() -> Self {
            Self {
                codec: Box::new(Codec::NEW),
                dense: Box::new(Dense::NEW),
                training: Box::new(Training::NEW),
            }
        }

        fn encode(&mut self, axes: [u32; 3], sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
            let extent = Extent::new(axes).unwrap();
            let plan = Plan::new(Wavelet::Haar, extent, 0).unwrap();
            let mut out = vec![0; max_encoded_len(extent, sample_type).unwrap()];
            let mut scratch = vec![-1; Dense::scratch_len(&plan)];
            let effort = Effort::Dense(&mut self.dense, &mut self.training);
            let mut samples = samples.to_vec();
            let len =
                self.codec.encode(effort, &plan, sample_type, &mut samples, &mut scratch, &mut out).unwrap();
            out.truncate(len);
            out
        }

        fn decode(&mut self, bytes: &[u8]) -> Result<Vec<i32>, DecodeError> {
            let header = Header::parse(bytes)?;
            let mut samples = vec![7; header.samples_len(0)];
            let mut scratch = vec![-1; header.scratch_len()];
            self.codec.decode_dense(&mut self.dense, bytes, 0, &mut samples, &mut scratch)?;
            Ok(samples)
        }

        fn round_trip(&mut self, axes: [u32; 3], sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
            let bytes = self.encode(axes, sample_type, samples);
            assert!(self.decode(&bytes).as_deref() == Ok(samples), "{axes:?} {sample_type}");
            bytes
        }
    }

    fn noise() -> impl FnMut() -> u32 {
        let mut seed = 1_u32;
        move || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 4
        }
    }

    /// Where each memory access is looked at, a sample takes a tenth of a second.
    const EXTENTS: &[[u32; 3]] = if cfg!(miri) {
        &[[3, 2, 2]]
    } else {
        &[
            [1, 1, 1],
            [2, 1, 1],
            [1000, 1, 1],
            [1, 77, 1],
            [5, 1, 9],
            [65, 3, 1],
            [700, 5, 1],
            [17, 19, 2],
            [3, 2, 70],
            [1, 1, 130],
            [130, 4, 4],
            [64, 18, 3],
            [16, 16, 16],
        ]
    };

    /// All of them, or some where each memory access is looked at, and one takes seconds.
    fn some<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
        all.into_iter().step_by(if cfg!(miri) { every } else { 1 })
    }

    #[test]
    fn bricks_come_back() {
        let (mut bench, mut next) = (Bench::new(), noise());
        for &axes in EXTENTS {
            let len: u32 = axes.iter().product();
            let kinds =
                [(0, -3), (1, 0), (3, i32::MIN), (8, 5), (12, 0), (16, -40_000), (25, 1 << 25), (28, 0)];
            for (bits, offset) in some(kinds, 5) {
                let rough: Vec<_> =
                    (0..len).map(|_| (next() % (1 << bits)).cast_signed().wrapping_add(offset)).collect();
                bench.round_trip(axes, SampleType::I32, &rough);
                let mut walk = 0;
                let smooth = rough.iter().map(|value| {
                    walk = i32::wrapping_add(walk, value.wrapping_sub(offset) >> 4);
                    (walk & 0xFFFF) - 0x8000
                });
                bench.round_trip(axes, SampleType::I16, &smooth.collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn extremes_of_every_type_come_back() {
        let mut bench = Bench::new();
        for sample_type in some(SampleType::ALL, 3) {
            let (least, most) = (*sample_type.range().start(), *sample_type.range().end());
            for &axes in EXTENTS {
                let len = usize::try_from(axes.iter().product::<u32>()).unwrap();
                for samples in [vec![least; len], vec![most; len]] {
                    assert!(bench.round_trip(axes, sample_type, &samples).len() < 24);
                }
                let alternating: Vec<_> = (0..len).map(|n| if n % 3 == 0 { least } else { most }).collect();
                bench.round_trip(axes, sample_type, &alternating);
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn what_was_coded_before_does_not_show() {
        let (mut bench, mut next) = (Bench::new(), noise());
        let samples: Vec<_> = (0..16 * 16 * 16).map(|n| n / 7 + (next() % 9).cast_signed()).collect();
        let first = bench.encode([16; 3], SampleType::U16, &samples);
        let header = Header::parse(&first).unwrap();
        assert!(header.is_dense() && !header.is_stored());
        bench.encode([64, 64, 1], SampleType::U16, &samples);
        assert_eq!(bench.encode([16; 3], SampleType::U16, &samples), first);
        let mut scratch = vec![0; header.scratch_len()];
        let refused = bench.codec.decode(&first, &mut vec![0; 4096], &mut scratch);
        assert_eq!(refused.err(), Some(DecodeError::NeedsDense));
    }

    #[test]
    fn damage_never_panics() {
        let (mut bench, mut next) = (Bench::new(), noise());
        let kinds = [
            ([33, 1, 1], SampleType::I16, 14),
            ([9, 7, 5], SampleType::U8, 6),
            ([70, 3, 1], SampleType::I32, 25),
        ];
        for (axes, sample_type, bits) in some(kinds, 3) {
            let len: u32 = axes.iter().product();
            let samples: Vec<_> = (0..len).map(|_| (next() % (1 << bits)).cast_signed()).collect();
            let bytes = bench.encode(axes, sample_type, &samples);
            let start = bytes.len().min(20);
            for place in some(3..bytes.len(), 15) {
                for flip in some([1, 0x80, 0xFF], 3) {
                    let mut damaged = bytes.clone();
                    damaged[place] ^= flip;
                    if place >= start
                        || Header::parse(&damaged)
                            .is_ok_and(|header| header.samples_len(0) < if cfg!(miri) { 50 } else { 10_000 })
                    {
                        let _ = bench.decode(&damaged);
                    }
                }
                assert_eq!(bench.decode(&bytes[..place]), Err(DecodeError::Truncated));
            }
        }
    }
}
