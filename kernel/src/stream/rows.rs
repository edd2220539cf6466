//! Slices whose rows arrive one after another.

use super::{RowError, Status, Step, header};

mod bands;
mod chunks;
mod codec;
mod decoder;
mod encoder;
mod fronts;
mod inverse;
mod outgoing;
mod plan;
mod schedule;
mod shelf;
mod spread;

pub use codec::RowCodec;
pub use decoder::RowDecoder;
pub use encoder::RowEncoder;
pub use plan::RowPlan;

/// The chance that another row follows, in 1/65536.
const MORE: u32 = 0xFFFF;
