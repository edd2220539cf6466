#![doc = include_str!("../README.md")]
#![no_std]
#![deny(
    missing_docs,
    clippy::alloc_instead_of_core,
    clippy::arithmetic_side_effects,
    clippy::as_conversions,
    clippy::expect_used,
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::missing_panics_doc,
    clippy::missing_safety_doc,
    clippy::panic,
    clippy::std_instead_of_core,
    clippy::unreachable,
    clippy::unwrap_used
)]
#![cfg_attr(test, expect(clippy::unwrap_used, reason = "a test may fail by panicking"))]

// What a static library for a system with threads and unwinding must have; nothing of it is called.
#[cfg(not(all(feature = "panic-handler", any(target_os = "none", target_os = "unknown"))))]
extern crate std;

mod decode;
#[cfg(feature = "encode")]
mod encode;
mod error;
mod header;
mod lent;
mod plan;
#[cfg(feature = "rows")]
mod rows;
#[cfg(feature = "rows")]
mod slabs;
mod state;

pub use decode::{wavelift_decode, wavelift_decode_dense, wavelift_decode_near};
#[cfg(feature = "encode")]
pub use encode::{
    wavelift_encode, wavelift_encode_dense, wavelift_encode_light, wavelift_encode_near,
    wavelift_encode_tabled, wavelift_max_encoded_len, wavelift_near_scratch_len,
};
pub use error::{WaveliftError, wavelift_error_name};
pub use header::{
    WAVELIFT_MAX_HEADER_BYTES, WaveliftHeader, WaveliftLevel, WaveliftStorage, wavelift_header_level,
    wavelift_header_parse,
};
pub use lent::WaveliftLent;
pub use plan::{
    WaveliftPlan, wavelift_dense_scratch_len, wavelift_max_levels, wavelift_plan_check, wavelift_samples_len,
    wavelift_scratch_len,
};
#[cfg(feature = "rows")]
pub use rows::{
    WaveliftRowPlan, WaveliftStatus, WaveliftStep, wavelift_row_decoder_begin,
    wavelift_row_decoder_fast_memory_len, wavelift_row_decoder_memory_len, wavelift_row_decoder_step,
    wavelift_row_encoder_begin, wavelift_row_encoder_finish, wavelift_row_encoder_memory_len,
    wavelift_row_encoder_step, wavelift_row_header_parse,
};
#[cfg(feature = "rows")]
pub use slabs::{
    wavelift_slab_decoder_begin, wavelift_slab_decoder_step, wavelift_slab_encoder_begin,
    wavelift_slab_encoder_begin_light, wavelift_slab_encoder_begin_tabled, wavelift_slab_encoder_finish,
    wavelift_slab_encoder_step, wavelift_slab_header_parse,
};
pub use state::{
    WaveliftCodec, WaveliftDense, WaveliftLattice, WaveliftTraining, wavelift_codec_size,
    wavelift_dense_size, wavelift_lattice_size, wavelift_training_size,
};
#[cfg(feature = "rows")]
pub use state::{
    WaveliftRowCodec, WaveliftRowDecoder, WaveliftRowEncoder, WaveliftSlabDecoder, WaveliftSlabEncoder,
    wavelift_row_codec_size, wavelift_row_decoder_size, wavelift_row_encoder_size,
    wavelift_slab_decoder_size, wavelift_slab_encoder_size,
};

/// Never called by the kernel; a program of Rust brings its own.
#[cfg(all(feature = "panic-handler", any(target_os = "none", target_os = "unknown")))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
