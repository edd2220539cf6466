//! Plain, slow references, written from the text alone: they share no code with the kernel and no idea of how to
//! make a transform fast, so that agreement with them means something.

pub mod coder;
pub mod dense;
pub mod lifting;
pub mod noise;
pub mod stencil;
pub mod tabled;
