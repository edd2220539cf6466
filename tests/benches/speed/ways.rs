//! The ways to code a volume: at each effort, without loss and within each error bound.

use std::num::NonZeroUsize;

use wavelift_host::bound::{BoundError, Tolerance};
use wavelift_host::codec::{CompressOptions, Effort};

use crate::list::{Bound, Listed};

/// One way to code a volume.
pub(crate) struct Way<'a> {
    pub(crate) effort: Effort,
    /// How far a sample may move; nowhere if there is none.
    pub(crate) bound: Option<&'a Bound>,
}

impl Way<'_> {
    /// The codec's name in the record.
    pub(crate) fn codec(&self) -> String {
        format!("wavelift {}", self.effort)
    }

    /// What asks for this way, on one thread.
    pub(crate) fn options(&self) -> Result<CompressOptions, BoundError> {
        let tolerance = self.bound.map(|bound| Tolerance::absolute(bound.absolute)).transpose()?;
        let threads = NonZeroUsize::new(1);
        Ok(CompressOptions { effort: self.effort, tolerance, threads, ..CompressOptions::default() })
    }
}

/// Every way that applies to a volume.
pub(crate) fn of(volume: &Listed) -> impl Iterator<Item = Way<'_>> {
    let bounds = std::iter::once(None).chain(volume.bounds.iter().map(Some));
    bounds.flat_map(|bound| Effort::ALL.map(|effort| Way { effort, bound }))
}
