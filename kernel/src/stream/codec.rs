//! The adaptive models of a stream of rows.

use crate::coder::Models;

/// The state of encoder and decoder of rows: the adaptive models, of fixed size, for the caller to keep where there is
/// room.
///
/// Every stream starts from the same models, so one `RowCodec` serves any number of streams, one after another.
#[derive(Debug, PartialEq, Eq)]
pub struct RowCodec {
    /// Of details high along both axes.
    diagonal: Models,
    /// Of all others. As rows of all subbands take turns, one set of models would have to fit both.
    others: Models,
}

impl RowCodec {
    /// A codec that can be the value of a `static`.
    pub const NEW: Self = Self { diagonal: Models::NEW, others: Models::NEW };

    /// Makes `self` equal to [`RowCodec::NEW`].
    pub fn reset(&mut self) {
        self.diagonal.reset();
        self.others.reset();
    }

    /// The models for rows of an orientation.
    pub(super) const fn models(&mut self, orientation: u8) -> &mut Models {
        if orientation == 3 { &mut self.diagonal } else { &mut self.others }
    }
}
