//! What the fuzz targets assert. Each module takes any bytes and panics where a promise is broken; the programs in
//! `targets/` hand them over.

#[cfg(feature = "container")]
pub mod container;
pub mod decode;
pub mod header;
pub mod roundtrip;
pub mod samples;
pub mod step;
