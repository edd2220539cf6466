//! The adaptive models of a stream of rows.

use crate::coder::RowModels;

/// The state of encoder and decoder of rows: the adaptive models, of fixed size, for the caller to keep where there is
/// room.
///
/// Every stream starts from the same models, so one `RowCodec` serves any number of streams, one after another.
#[derive(Debug, PartialEq, Eq)]
pub struct RowCodec {
    /// Of details of the finest level that are high along both axes.
    diagonal: RowModels,
    /// Of its other details.
    finest: RowModels,
    /// Of all others. As rows of all subbands take turns, one set of models would have to fit them all.
    coarser: RowModels,
}

impl RowCodec {
    /// A codec that can be the value of a `static`.
    pub const NEW: Self = Self { diagonal: RowModels::NEW, finest: RowModels::NEW, coarser: RowModels::NEW };

    /// Makes `self` equal to [`RowCodec::NEW`].
    pub fn reset(&mut self) {
        self.diagonal.reset();
        self.finest.reset();
        self.coarser.reset();
    }

    /// The models for rows of an orientation of a level, if they are details of one.
    pub(super) const fn models(&mut self, level: Option<u8>, orientation: u8) -> &mut RowModels {
        match (level, orientation) {
            (Some(0), 3) => &mut self.diagonal,
            (Some(0), 1..) => &mut self.finest,
            _ => &mut self.coarser,
        }
    }
}
