//! States of fixed size as C sees them: memory without a meaning, as large and as aligned as the kernel's.

use core::mem::{MaybeUninit, zeroed};

#[cfg(feature = "rows")]
use wavelift_kernel::stream::{RowCodec, RowDecoder, RowEncoder, SlabDecoder, SlabEncoder};
use wavelift_kernel::{Codec, Dense, Lattice, Training};

#[cfg(feature = "rows")]
use crate::lent::Begun;

/// Memory for a state of the kernel.
pub(crate) trait State: Sized {
    /// The state.
    type Of;

    /// A value of the state. Which one does not matter, since every call starts its state afresh; one of zeros takes no
    /// room in a program, as [`Codec::NEW`] does.
    const ZERO: Self::Of;
}

/// Memory for what lasts from call to call.
#[cfg(feature = "rows")]
pub(crate) trait Session: Sized {
    /// What lasts.
    type Of;

    /// A number that memory does not hold by chance, and that tells which kind of session began there.
    const MARK: u64;
}

macro_rules! memory {
    ($(#[$doc:meta])* $name:ident($words:literal) of $kernel:ty) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        #[repr(C)]
        pub struct $name {
            /// For the kernel alone.
            pub opaque: [MaybeUninit<u64>; $words],
        }

        impl $name {
            /// 64-bit words of the state.
            pub const WORDS: usize = $words;
        }

        const _: () = {
            assert!(size_of::<$kernel>() <= size_of::<$name>(), "the state has grown: change the header");
            assert!(align_of::<$kernel>() <= align_of::<$name>());
            // An eighth is left for what is to come; where words are shorter, states are too.
            let spare = size_of::<$name>().saturating_sub(size_of::<$kernel>());
            let most = (size_of::<$kernel>() / 8).saturating_add(size_of::<u64>());
            assert!(usize::BITS < 64 || spare <= most, "the state has shrunk: change the header");
        };
    };
}

macro_rules! state {
    ($(#[$doc:meta])* $name:ident($words:literal) of $kernel:ty) => {
        memory! { $(#[$doc])* $name($words) of $kernel }

        impl State for $name {
            type Of = $kernel;
            // SAFETY: zeros are a value of the type: the compiler evaluates the constant, and refuses it if not.
            const ZERO: Self::Of = unsafe { zeroed() };
        }
    };
}

#[cfg(feature = "rows")]
macro_rules! session {
    ($(#[$doc:meta])* $name:ident($words:literal) of $kernel:ty, $mark:literal) => {
        memory! { $(#[$doc])* $name($words) of Begun<$kernel> }

        impl Session for $name {
            type Of = $kernel;
            const MARK: u64 = u64::from_le_bytes(*$mark);
        }
    };
}

state! {
    /// Memory of [`Codec`]: `wavelift_codec`.
    WaveliftCodec(428) of Codec
}
state! {
    /// Memory of [`Training`]: `wavelift_training`.
    WaveliftTraining(1342) of Training
}
state! {
    /// Memory of [`Dense`]: `wavelift_dense`.
    WaveliftDense(9432) of Dense
}
state! {
    /// Memory of [`Lattice`]: `wavelift_lattice`.
    WaveliftLattice(2866) of Lattice
}
#[cfg(feature = "rows")]
state! {
    /// Memory of [`RowCodec`]: `wavelift_row_codec`.
    WaveliftRowCodec(791) of RowCodec
}
#[cfg(feature = "rows")]
session! {
    /// Memory of [`RowEncoder`]: `wavelift_row_encoder`.
    WaveliftRowEncoder(160) of RowEncoder<'static>, b"wRowsEnc"
}
#[cfg(feature = "rows")]
session! {
    /// Memory of [`RowDecoder`]: `wavelift_row_decoder`.
    WaveliftRowDecoder(256) of RowDecoder<'static>, b"wRowsDec"
}
#[cfg(feature = "rows")]
session! {
    /// Memory of [`SlabEncoder`]: `wavelift_slab_encoder`.
    WaveliftSlabEncoder(44) of SlabEncoder<'static>, b"wSlabEnc"
}
#[cfg(feature = "rows")]
session! {
    /// Memory of [`SlabDecoder`]: `wavelift_slab_decoder`.
    WaveliftSlabDecoder(40) of SlabDecoder<'static>, b"wSlabDec"
}

/// Bytes of [`WaveliftCodec`], for callers that do not read the header.
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_codec_size() -> usize {
    size_of::<WaveliftCodec>()
}

/// Bytes of [`WaveliftTraining`].
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_training_size() -> usize {
    size_of::<WaveliftTraining>()
}

/// Bytes of [`WaveliftDense`].
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_dense_size() -> usize {
    size_of::<WaveliftDense>()
}

/// Bytes of [`WaveliftLattice`].
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_lattice_size() -> usize {
    size_of::<WaveliftLattice>()
}

/// Bytes of [`WaveliftRowCodec`].
#[cfg(feature = "rows")]
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_row_codec_size() -> usize {
    size_of::<WaveliftRowCodec>()
}

/// Bytes of [`WaveliftRowEncoder`].
#[cfg(feature = "rows")]
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_row_encoder_size() -> usize {
    size_of::<WaveliftRowEncoder>()
}

/// Bytes of [`WaveliftRowDecoder`].
#[cfg(feature = "rows")]
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_row_decoder_size() -> usize {
    size_of::<WaveliftRowDecoder>()
}

/// Bytes of [`WaveliftSlabEncoder`].
#[cfg(feature = "rows")]
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_slab_encoder_size() -> usize {
    size_of::<WaveliftSlabEncoder>()
}

/// Bytes of [`WaveliftSlabDecoder`].
#[cfg(feature = "rows")]
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_slab_decoder_size() -> usize {
    size_of::<WaveliftSlabDecoder>()
}
