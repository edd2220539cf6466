//! Pictures inside of other files.

/// What such a picture has to be; any other is refused, before memory is taken for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Raster {
    pub(super) width: u64,
    pub(super) height: u64,
    /// Values of a sample.
    pub(super) components: u32,
    /// Bytes of a value, 1 or 2; one of fewer bits fills them.
    pub(super) bytes: usize,
}
