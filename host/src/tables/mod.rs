//! The lossless tables: what each wavelet makes of a volume, and what the codec makes of that.
//!
//! A row has the columns of Tables 3.5 and 3.6 of the dissertation (time, code length of the histogram, compression
//! rate, zeros, range), and beside them the length of the codestream that the kernel really writes, decoded again
//! and compared before it is counted. A seventh row does without a transform.
//!
//! Source: M. Bertram, *Multiresolution Modeling for Scientific Visualization*, dissertation, UC Davis 2000, §3.5.2.

mod builtin;
mod chart;
mod json;
mod measure;
mod text;

use std::time::Duration;

pub use builtin::{BuiltIn, built_in};
pub use chart::svg;
pub use json::json;
pub use measure::{Progress, RUNS, TablesError, measure};
pub use text::text;
use wavelift_kernel::Wavelet;
use wavelift_kernel::metric::Measure;

use crate::volume::{ElementType, RankedExtent};

/// What the wavelets make of one volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What the volume is.
    pub title: String,
    /// Samples per axis.
    pub extent: RankedExtent,
    /// Type of a sample.
    pub element: ElementType,
    /// Samples along x, y, z of the bricks that were transformed and coded one by one.
    pub brick: [u32; 3],
    /// How many bricks there are.
    pub bricks: u64,
    /// One row a wavelet, in the order of [`Wavelet::ALL`], then one without a transform.
    pub rows: Vec<Row>,
    /// What the text has for a volume of this kind.
    pub reference: Option<Reference>,
}

/// What one wavelet makes of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The wavelet, `None` for no transform.
    pub wavelet: Option<Wavelet>,
    /// Levels of the largest brick; smaller ones have as many as they can.
    pub levels: u8,
    /// Time of the forward transform of all bricks on one core, the best of [`RUNS`] a brick.
    pub forward: Option<Duration>,
    /// Histogram of all coefficients of all bricks.
    pub measure: Measure,
    /// Bytes of all codestreams, headers included.
    pub stream_bytes: u64,
}

/// Code lengths from a table of the dissertation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The table's name.
    pub table: &'static str,
    /// Code length of the histogram in percent of the raw size, in the order of [`Wavelet::ALL`].
    pub percents: [f64; 6],
}

impl Table {
    /// Bytes of the samples.
    pub const fn raw_bytes(&self) -> u64 {
        self.extent.samples() * self.element.bytes() as u64
    }

    /// Bytes of the codestreams of a row in percent of the samples'.
    pub fn stream_percent(&self, row: &Row) -> f64 {
        100.0 * row.stream_bytes as f64 / self.raw_bytes() as f64
    }

    /// Bits of the codestreams of a row per sample.
    pub fn bits_per_sample(&self, row: &Row) -> f64 {
        8.0 * row.stream_bytes as f64 / self.extent.samples() as f64
    }

    /// The text's code length for the wavelet of a row, in percent.
    pub fn reference_percent(&self, row: &Row) -> Option<f64> {
        let position = Wavelet::ALL.iter().position(|wavelet| Some(*wavelet) == row.wavelet)?;
        Some(self.reference?.percents[position])
    }

    /// The row with the shortest codestreams.
    pub fn best(&self) -> Option<&Row> {
        self.rows.iter().min_by_key(|row| row.stream_bytes)
    }

    /// `512x512 samples of u8, 262144 bytes, in one brick`.
    fn description(&self) -> String {
        let bricks = match self.bricks {
            1 => "one brick".to_owned(),
            bricks => format!("{bricks} bricks of up to {}", self.brick_extent()),
        };
        format!("{} samples of {}, {} bytes, in {bricks}", self.extent, self.element, self.raw_bytes())
    }

    /// The extent of a brick with as many axes as that of the volume.
    fn brick_extent(&self) -> String {
        let axes: Vec<String> = self.brick.iter().map(u32::to_string).collect();
        axes[..self.extent.rank().into()].join("x")
    }
}

impl Row {
    /// Name on the command line: that of the wavelet, or `none`.
    pub const fn name(&self) -> &'static str {
        match self.wavelet {
            Some(wavelet) => wavelet.name(),
            None => "none",
        }
    }
}

/// A table with easy numbers.
#[cfg(test)]
fn example() -> Table {
    let rows = Wavelet::ALL.map(Some).into_iter().chain([None]).zip(1..).map(|(wavelet, number)| Row {
        wavelet,
        levels: if wavelet.is_some() { 3 } else { 0 },
        forward: wavelet.map(|_| Duration::from_micros(1250 * number)),
        measure: wavelift_kernel::metric::measure(&mut [-12, 0, 0, 0, 5, 5, 0, 1000]),
        stream_bytes: 2 * number,
    });
    Table {
        title: "a <line> & more".to_owned(),
        extent: "8".parse().expect("an extent"),
        element: ElementType::I16,
        brick: [8, 1, 1],
        bricks: 1,
        rows: rows.collect(),
        reference: Some(Reference { table: "Table 0.0", percents: [60.0, 50.0, 40.0, 30.0, 20.0, 10.5] }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_table() {
        let table = example();
        assert_eq!(table.description(), "8 samples of i16, 16 bytes, in one brick");
        assert_eq!(table.stream_percent(&table.rows[1]), 25.0);
        assert_eq!(table.bits_per_sample(&table.rows[1]), 4.0);
        assert_eq!(table.reference_percent(&table.rows[5]), Some(10.5));
        assert_eq!(table.reference_percent(&table.rows[6]), None);
        assert_eq!(table.best(), Some(&table.rows[0]));
        assert_eq!(table.rows[6].name(), "none");
    }
}
