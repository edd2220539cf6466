//! Volumes to containers and back: bricks, coded on all cores, with checksums.
//!
//! A volume is cut into bricks ([`Grid`]); each becomes one or two codestreams of the kernel, which this crate
//! never looks into. The file around them is described in `docs/container.md`.

mod ahead;
mod brick;
mod choice;
mod compare;
mod compress;
mod container;
mod content;
mod decode;
mod decompress;
mod effort;
mod encode;
mod error;
mod file;
mod fill;
mod form;
mod grid;
mod level;
mod memory;
mod packing;
mod patched;
pub(crate) mod planes;
mod pool;
mod read;
mod read_at;
mod record;
mod region;
mod remains;
mod repair;
mod salvage;
mod scaled;
mod scan;
mod statistics;
mod step_writer;
mod steps;
mod supply;
mod survey;
#[cfg(test)]
mod tests;
mod trial;
mod units;
mod writer;
mod wrong_byte;

pub(crate) use choice::Transform;
pub use choice::{Choice, UnknownChoice};
pub use compare::{Comparison, Difference};
pub use compress::{CompressOptions, Label, Report, append, compress, compress_stream};
pub use container::Container;
pub use content::{BrickLabel, Channel, Head, Kept, Place, Step, Summary};
pub use decompress::DecompressOptions;
pub use effort::{Effort, UnknownEffort};
pub use error::{CompressError, ContainerError};
pub use file::{append_file, compress_file};
pub use fill::{Fill, NoSuchValue};
pub use form::Form;
pub use grid::{Brick, Grid};
pub use packing::Values;
pub use read_at::{Count, Counted, FileAt, ReadAt};
pub use record::Kind;
pub use region::{Part, Region, RegionError};
pub use repair::{RepairError, Repaired, repair};
pub use salvage::{Damage, Lost, Salvaged};
pub use scan::{Content, Found, Scanner};
pub use statistics::Statistics;
pub use step_writer::StepWriter;

use self::pool::Pool;
use crate::progress::Progress;
