//! Rows of subbands of a slice that are coded one after another, each in pieces, with what is kept of the rows above.

use super::Coder;
use super::context::magnitude;
use super::history::Last;
use super::row_models::RowModels;
use super::scan::SIBLING;
use super::weightless::Corner;
use crate::packed::Packed;

/// Bytes that coding one coefficient takes, at most: two symbols, and 62 raw bits.
pub(crate) const MOST_BYTES: usize = 13;

/// Magnitudes of rows above are kept up to this.
const LARGEST_KEPT: i32 = 0xFFFF;

/// Where the magnitudes of the residuals of the row above are, and of the one above that.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Above {
    /// As pairs of 16 bits, one a column, from this word on; those of this row take their place.
    Kept(usize),
    /// In the rows themselves, of details, whose residuals are they themselves; zeros where there is no row.
    Rows([Packed; 2]),
}

impl Above {
    /// The magnitudes to the north, the north-north and, if it is asked for, the north-east.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn look(self, x: usize, east: bool, memory: &[i32]) -> Option<[i32; 3]> {
        let east = east.then(|| x.wrapping_add(1));
        match self {
            Self::Kept(first) => {
                let kept = |x: usize| memory.get(first.wrapping_add(x)).copied();
                let (here, east) = (kept(x)?, east.map_or(Some(0), kept)?);
                Some([here & LARGEST_KEPT, (here >> 16) & LARGEST_KEPT, east & LARGEST_KEPT])
            }
            Self::Rows([north, north_north]) => {
                let kept = |row: Packed, x| row.get(memory, x).map(|v| magnitude(v).min(LARGEST_KEPT));
                let east = east.map_or(Some(0), |x| kept(north, x))?;
                Some([kept(north, x)?, kept(north_north, x)?, east])
            }
        }
    }
}

/// Where a row of a subband lies in memory, and what belongs to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// The coefficients.
    pub(crate) values: Packed,
    pub(crate) width: usize,
    pub(crate) above: Above,
    /// The same row in subbands of lower orientations: the coefficients, and how many.
    pub(crate) siblings: [(Packed, usize); 2],
    /// In the low-pass part the coefficients of the row above, which may be where those of this row come.
    pub(crate) north: Option<usize>,
    /// Whether there is no row above.
    pub(crate) is_first: bool,
}

impl Row {
    /// A row of the low-pass part: its coefficients, kept magnitudes, and the coefficients of the row above, if it has one.
    pub(crate) fn of_low_pass(
        (values, width): (usize, usize),
        above: usize,
        north: usize,
        is_first: bool,
    ) -> Self {
        let (values, above, none) = (Packed::words(values), Above::Kept(above), (Packed::default(), 0));
        Self { values, width, above, siblings: [none; 2], north: Some(north), is_first }
    }
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

    /// Codes coefficients for as long as `go_on` says so; whether the row is done. `None` if it is not all in memory, or
    /// a coefficient takes more bits than there are for it.
    pub(crate) fn code<C: Coder>(
        &mut self,
        coder: &mut C,
        models: &mut RowModels,
        row: &Row,
        memory: &mut [i32],
        go_on: impl Fn(&C) -> bool,
    ) -> Option<bool> {
        while self.x < row.width {
            if !go_on(coder) {
                return Some(false);
            }
            self.code_next(coder, models, row, memory)?;
            self.x = self.x.wrapping_add(1);
        }
        Some(true)
    }

    /// Codes the coefficient at the cursor.
    #[inline(always)]
    fn code_next<C: Coder>(
        &mut self,
        coder: &mut C,
        models: &mut RowModels,
        row: &Row,
        memory: &mut [i32],
    ) -> Option<()> {
        let is_last = self.x.wrapping_add(1) == row.width;
        let [north, north_north, north_east] = row.above.look(self.x, !is_last, memory)?;
        let mut energy = self.last.energy().wrapping_add(north.wrapping_mul(4)).wrapping_add(north_north);
        energy = energy.wrapping_add(self.north_west.wrapping_add(north_east).wrapping_mul(2));
        for (sibling, width) in row.siblings {
            if self.x < width {
                energy = energy.wrapping_add(magnitude(sibling.get(memory, self.x)?).wrapping_mul(SIBLING));
            }
        }
        let beside = row.north.and_then(|first| memory.get(first.wrapping_add(self.x)).copied());
        let expected = self.expected(row, beside);
        let known = row.values.get(memory, self.x)?;
        let residual = models.code(coder, energy, known.wrapping_sub(expected));
        let value = expected.wrapping_add(residual);
        row.values.set(memory, self.x, value)?;
        if let Some((first, north_west)) = row.north.zip(beside) {
            *memory.get_mut(first.wrapping_add(self.x))? = value;
            self.values = Some([value, north_west]);
        }
        let remembered = self.last.push(residual).min(LARGEST_KEPT);
        if let Above::Kept(first) = row.above {
            *memory.get_mut(first.wrapping_add(self.x))? = north << 16 | remembered;
        }
        self.north_west = north;
        Some(())
    }

    /// The prediction: of details 0, in the low-pass part from the nearest coefficients, of which one is that to the
    /// north.
    #[inline(always)]
    fn expected(&self, row: &Row, north: Option<i32>) -> i32 {
        if row.north.is_none() {
            return 0;
        }
        let west = self.values.map(|[west, _]| west);
        if row.is_first {
            return Corner::new(west, None, None, 0).median();
        }
        Corner::new(west, north, self.values.map(|[_, north_west]| north_west), 0).median()
    }
}
