//! The ways to code a volume: one for each effort.

use std::num::NonZeroUsize;

use wavelift_host::codec::CompressOptions;

/// One way to code a volume.
pub(crate) struct Way {
    /// The codec's name in the record.
    pub(crate) codec: &'static str,
    pub(crate) options: CompressOptions,
}

/// Every way, each on one thread.
pub(crate) fn all() -> Vec<Way> {
    let options = CompressOptions { threads: NonZeroUsize::new(1), ..CompressOptions::default() };
    vec![Way { codec: "wavelift default", options }]
}
