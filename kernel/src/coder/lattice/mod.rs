//! Near-lossless coding: samples are predicted from a coarser lattice of decoded samples, pass by pass, and their
//! residuals coded in steps. The format is in `docs/lattice.md`.

mod context;
mod equations;
mod pass;
mod quantizer;
mod residual;
mod train;
mod weights;
mod window;

use super::Coder;
use crate::Extent;
use context::{Surroundings, remembered};
use equations::Equations;
use pass::Pass;
use quantizer::Quantizer;
pub(crate) use quantizer::{LARGEST_SLACK, Precision, SHRINKING};
use residual::{Models, band};
use weights::{Kernels, MEAN, SLOTS, Weights, centre};
use window::{Window, pitch};

/// Passes of fewer samples are predicted by [`Weights::CUBIC`].
const TRAINED_FROM: usize = 300;

/// Bits a sample, in 1/256, below which steps shrink by the second rule.
const SHRINKING_BELOW: u64 = 70;

/// Rows of scratch: the window, sums, what surrounds a row.
const ROWS: usize = SLOTS + 1 + context::ROWS;

/// The memory of the near-lossless codec, of fixed size (22,928 bytes), for the caller to keep where there is room.
///
/// Every call starts from the same models, so one `Lattice` serves any number of codestreams.
#[derive(Debug, PartialEq, Eq)]
pub struct Lattice {
    models: Models,
    equations: Equations,
}

/// A lattice on its way from coarse to fine.
#[derive(Debug)]
pub(crate) struct Grid<'a> {
    /// Samples per axis in the end, after level `finest`.
    extent: Extent,
    finest: u8,
    pub(crate) precision: Precision,
    /// The samples; of an encoder only.
    originals: Option<&'a [i32]>,
    /// The decoded samples of the lattice, without gaps.
    lattice: &'a mut [i32],
    /// Their residuals in steps.
    residuals: &'a mut [i32],
    rows: &'a mut [i32],
    /// Points for training; of an encoder only.
    points: &'a mut [i32],
}

impl<'a> Grid<'a> {
    /// `i32`s of scratch that decoding takes for a lattice of `extent`: a residual per sample, and rows.
    pub(crate) const fn decoding_scratch_len(extent: Extent) -> usize {
        let [width, ..] = extent.sides();
        extent.samples().saturating_add(pitch(width).saturating_mul(ROWS))
    }

    /// `i32`s of scratch that encoding takes: besides, the decoded samples, and points to train with.
    pub(crate) fn encoding_scratch_len(extent: Extent) -> usize {
        let samples = extent.samples();
        Self::decoding_scratch_len(extent).saturating_add(samples).saturating_add(train::scratch_len(samples))
    }

    /// For encoding; `None` if the scratch is too short.
    pub(crate) fn of_samples(
        extent: Extent,
        precision: Precision,
        samples: &'a [i32],
        scratch: &'a mut [i32],
    ) -> Option<Self> {
        let (lattice, scratch) = scratch.split_at_mut_checked(extent.samples())?;
        let (points, scratch) = scratch.split_at_mut_checked(train::scratch_len(extent.samples()))?;
        let grid = Self::of_nothing(extent, precision, 0, lattice, scratch)?;
        Some(Self { originals: Some(samples), points, ..grid })
    }

    /// For decoding into `lattice`, of `extent`, down to level `finest`; `None` if the scratch is too short.
    pub(crate) fn of_nothing(
        extent: Extent,
        precision: Precision,
        finest: u8,
        lattice: &'a mut [i32],
        scratch: &'a mut [i32],
    ) -> Option<Self> {
        let (residuals, rows) = scratch.split_at_mut_checked(lattice.len())?;
        Some(Self { extent, finest, precision, originals: None, lattice, residuals, rows, points: &mut [] })
    }
}

impl Lattice {
    /// A codec that can be the value of a `static`.
    pub const NEW: Self = Self { models: Models::NEW, equations: Equations::NEW };

    /// Makes `self` equal to [`Lattice::NEW`].
    pub fn reset(&mut self) {
        self.models.reset();
        self.equations = Equations::NEW;
    }

    /// Decides how the steps of an encoder shrink: the more, the fewer bits a sample takes.
    pub(crate) fn choose_shrinking(&mut self, grid: &mut Grid<'_>) {
        let step = grid.precision.slack.wrapping_mul(2).wrapping_add(1);
        let memory = [&mut *grid.rows, &mut *grid.points];
        let samples = grid.originals.unwrap_or(&[]);
        let bits = train::estimate(&mut self.equations, grid.extent, samples, memory, step);
        grid.precision.shrinking = u8::from(bits < SHRINKING_BELOW);
    }

    /// Codes the coarsest lattice, of stride 2^`level`: each sample is predicted by the one before in its row, or its
    /// column, or its pile.
    pub(crate) fn code_coarsest<C: Coder>(
        &mut self,
        coder: &mut C,
        grid: &mut Grid<'_>,
        level: u8,
    ) -> Option<()> {
        self.models.reset();
        let quantizer = Quantizer::new(&grid.precision, level);
        let [width, height, depth] = grid.extent.coarsened(level.wrapping_sub(grid.finest)).sides();
        let [full_width, full_height, _] = grid.extent.sides();
        let plane = width.wrapping_mul(height);
        let places =
            (0..depth).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| [x, y, z])));
        for (index, [x, y, z]) in places.enumerate() {
            let back = if x > 0 {
                1
            } else if y > 0 {
                width
            } else {
                plane
            };
            let before = index.checked_sub(back).and_then(|before| grid.lattice.get(before));
            let predicted = before.copied().unwrap_or(0);
            let row = (z << level).wrapping_mul(full_height).wrapping_add(y << level);
            let original = row.wrapping_mul(full_width).wrapping_add(x << level);
            let sample = grid.originals.and_then(|all| all.get(original)).copied().unwrap_or(0);
            let residual = self.models.code_coarsest(coder, quantizer.index(sample, predicted));
            *grid.lattice.get_mut(index)? = quantizer.sample(predicted, residual);
            *grid.residuals.get_mut(index)? = remembered(residual);
        }
        Some(())
    }

    /// Makes the lattice of stride 2^`level` of that of twice the stride.
    pub(crate) fn code_level<C: Coder>(
        &mut self,
        coder: &mut C,
        grid: &mut Grid<'_>,
        level: u8,
    ) -> Option<()> {
        for pass in Pass::all(grid.extent, grid.finest, level) {
            self.code_pass(coder, grid, pass)?;
        }
        Some(())
    }

    fn code_pass<C: Coder>(&mut self, coder: &mut C, grid: &mut Grid<'_>, pass: Pass) -> Option<()> {
        let quantizer = Quantizer::new(&grid.precision, pass.level);
        pass.spread(grid.lattice);
        pass.spread(grid.residuals);
        let pitch = pitch(pass.new_sides().into_iter().next()?);
        let (window, rest) = grid.rows.split_at_mut_checked(pitch.wrapping_mul(SLOTS))?;
        let mut window = Window::new(pass, window);
        let (sums, rest) = rest.split_at_mut_checked(pitch)?;
        let mut surroundings = Surroundings::new(&pass, pitch, rest)?;
        let sums = sums.get_mut(..window.width)?;
        let mut weights = Weights::CUBIC;
        if let Some(originals) = grid.originals {
            pass.fill(grid.extent, originals, grid.lattice);
            if pass.count() >= TRAINED_FROM {
                let step = quantizer.step();
                weights =
                    train::train(&mut self.equations, &pass, grid.lattice, &mut window, grid.points, step);
            }
        }
        let mut is_trained = weights != Weights::CUBIC;
        if pass.count() >= TRAINED_FROM {
            is_trained = coder.raw(u32::from(is_trained), 1) == 1;
            if is_trained {
                weights.code(coder, &mut self.models.tap);
            }
        }
        let kernels = weights.kernels(pass.axis);
        for place in pass.rows() {
            window.fill(grid.lattice, place, is_trained);
            window.sum(&kernels, sums);
            surroundings.fill(&pass, grid.residuals, place)?;
            let row = Row {
                sums,
                window: &window,
                surroundings: &surroundings,
                samples: grid.lattice.get_mut(pass.new_row(place)?)?,
                residuals: grid.residuals.get_mut(pass.new_row(place)?)?,
            };
            row.code(coder, &mut self.models, &kernels, &quantizer, &pass);
        }
        pass.interleave(grid.lattice, grid.rows);
        pass.interleave(grid.residuals, grid.rows);
        Some(())
    }
}

/// A row of new samples, and what is known around it.
#[derive(Debug)]
struct Row<'a> {
    sums: &'a [i32],
    window: &'a Window<'a>,
    surroundings: &'a Surroundings<'a>,
    /// The samples to be encoded, if any; in the end the decoded ones.
    samples: &'a mut [i32],
    residuals: &'a mut [i32],
}

impl Row<'_> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn code<C: Coder>(
        self,
        coder: &mut C,
        models: &mut Models,
        kernels: &Kernels,
        quantizer: &Quantizer,
        pass: &Pass,
    ) {
        let band = band(pass.level, pass.axis);
        let near = self.window.row(centre(pass.axis), 0);
        let mean = self.window.row(MEAN, 0).first().copied().unwrap_or(0);
        let (mut west, mut west_west) = (mean, mean);
        let (mut residual, mut residual_before) = (0_i32, 0_i32);
        let known = near.iter().zip(self.sums).zip(self.surroundings.iter());
        for ((sample, to), ((&near, &sum), surrounding)) in
            self.samples.iter_mut().zip(self.residuals).zip(known)
        {
            let sum = sum.wrapping_add(kernels.west.wrapping_mul(west));
            let sum = sum.wrapping_add(kernels.west_west.wrapping_mul(west_west));
            let predicted = near.wrapping_add(sum >> weights::WEIGHT_BITS);
            let context = surrounding.after(residual, residual_before);
            let coded = models.code(coder, quantizer.index(*sample, predicted), context, band);
            *sample = quantizer.sample(predicted, coded);
            (west, west_west) = (*sample, west);
            (residual, residual_before) = (remembered(coded), residual);
            *to = residual;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_is_of_known_size() {
        assert_eq!(size_of::<Lattice>(), 22_928);
    }
}
