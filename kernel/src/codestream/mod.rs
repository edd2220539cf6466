//! The bytes that hold one line, slice or brick.
mod codec;
mod header;
mod light;
mod near;
mod segments;
mod stored;
#[cfg(test)]
mod total;

pub use codec::{Codec, Effort, max_encoded_len};
pub use header::Header;
pub use near::Near;
