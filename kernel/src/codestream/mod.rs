//! The bytes that hold one line, slice or brick.
mod codec;
mod header;

pub use codec::{Codec, max_encoded_len};
pub use header::Header;
