//! Rows of subbands of a slice that are coded one after another, each in pieces, with what is kept of the rows above.

use super::Coder;
use super::context::magnitude;
use super::history::Last;
use super::row_models::RowModels;
use super::scan::SIBLING;
use super::weightless::Corner;

/// Bytes that coding one coefficient takes, at most: two symbols, and 62 raw bits.
pub(crate) const MOST_BYTES: usize = 13;

/// Magnitudes of rows above are kept up to this.
const LARGEST_KEPT: i32 = 0xFFFF;

/// Where a row of a subband lies in memory, and what belongs to it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row {
    /// The first coefficient.
    pub(crate) values: usize,
    pub(crate) width: usize,
    /// The first of as many pairs of magnitudes of residuals: those of the row above, and the one above that.
    pub(crate) above: usize,
    /// The same row in subbands of lower orientations: the first coefficients, and how many.
    pub(crate) siblings: [(usize, usize); 2],
    /// In the low-pass part the coefficients of the row above.
    pub(crate) north: Option<usize>,
    /// Whether there is no row above.
    pub(crate) is_first: bool,
}

/// A place in a row, and what is known of those to its west.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cursor {
    x: usize,
    last: Last,
    /// The magnitude to the north-west.
    north_west: i32,
    /// In the low-pass part the coefficients to the west and the north-west.
    values: Option<[i32; 2]>,
}

impl Cursor {
    /// Whether no coefficient of the row is coded yet.
    #[cfg(test)]
    pub(crate) const fn is_first(&self) -> bool {
        self.x == 0
    }

    /// Codes coefficients for as long as `go_on` says so; whether the row is done.
    pub(crate) fn code<C: Coder>(
        &mut self,
        coder: &mut C,
        models: &mut RowModels,
        row: &Row,
        memory: &mut [i32],
        go_on: impl Fn(&C) -> bool,
    ) -> bool {
        while self.x < row.width {
            if !go_on(coder) {
                return false;
            }
            // All of a row is in memory, so there is a next coefficient.
            let Some(()) = self.code_next(coder, models, row, memory) else { return true };
            self.x = self.x.wrapping_add(1);
        }
        true
    }

    /// Codes the coefficient at the cursor. `None` if the row is not all in memory.
    #[inline(always)]
    fn code_next<C: Coder>(
        &mut self,
        coder: &mut C,
        models: &mut RowModels,
        row: &Row,
        memory: &mut [i32],
    ) -> Option<()> {
        let here = |first: usize| first.wrapping_add(self.x);
        let kept = *memory.get(here(row.above))?;
        let is_last = self.x.wrapping_add(1) == row.width;
        let north_east =
            if is_last { 0 } else { *memory.get(here(row.above).wrapping_add(1))? & LARGEST_KEPT };
        let (north, north_north) = (kept & LARGEST_KEPT, (kept >> 16) & LARGEST_KEPT);
        let mut energy = self.last.energy().wrapping_add(north.wrapping_mul(4)).wrapping_add(north_north);
        energy = energy.wrapping_add(self.north_west.wrapping_add(north_east).wrapping_mul(2));
        for (sibling, width) in row.siblings {
            if self.x < width {
                energy = energy.wrapping_add(magnitude(*memory.get(here(sibling))?).wrapping_mul(SIBLING));
            }
        }
        let expected = self.expected(row, memory);
        let value = memory.get_mut(here(row.values))?;
        let residual = models.code(coder, energy, value.wrapping_sub(expected));
        *value = expected.wrapping_add(residual);
        let value = *value;
        if let Some(above) = row.north {
            let north_west = core::mem::replace(memory.get_mut(here(above))?, value);
            self.values = Some([value, north_west]);
        }
        let remembered = self.last.push(residual).min(LARGEST_KEPT);
        *memory.get_mut(here(row.above))? = north << 16 | remembered;
        self.north_west = north;
        Some(())
    }

    /// The prediction: of details 0, in the low-pass part from the nearest coefficients.
    #[inline(always)]
    fn expected(&self, row: &Row, memory: &[i32]) -> i32 {
        let Some(above) = row.north else { return 0 };
        let north = if row.is_first { None } else { memory.get(above.wrapping_add(self.x)).copied() };
        let west = self.values.map(|[west, _]| west);
        let north_west = if row.is_first { None } else { self.values.map(|[_, north_west]| north_west) };
        Corner::new(west, north, north_west, 0).median()
    }
}
