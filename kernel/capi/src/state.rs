//! States of fixed size as C sees them: memory without a meaning, as large and as aligned as the kernel's.

use core::mem::{MaybeUninit, zeroed};

use wavelift_kernel::{Codec, Dense, Lattice, Training};

/// Memory for a state of the kernel.
pub(crate) trait State: Sized {
    /// The state.
    type Of;

    /// A value of the state. Which one does not matter, since every call starts its state afresh; one of zeros takes no
    /// room in a program, as [`Codec::NEW`] does.
    const ZERO: Self::Of;
}

macro_rules! state {
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
            let spare = size_of::<$name>().saturating_sub(size_of::<$kernel>());
            assert!(usize::BITS < 64 || spare < size_of::<u64>(), "the state has shrunk: change the header");
        };

        impl State for $name {
            type Of = $kernel;
            // SAFETY: zeros are a value of the type: the compiler evaluates the constant, and refuses it if not.
            const ZERO: Self::Of = unsafe { zeroed() };
        }
    };
}

state! {
    /// Memory of [`Codec`]: `wavelift_codec`.
    WaveliftCodec(353) of Codec
}
state! {
    /// Memory of [`Training`]: `wavelift_training`.
    WaveliftTraining(1341) of Training
}
state! {
    /// Memory of [`Dense`]: `wavelift_dense`.
    WaveliftDense(9432) of Dense
}
state! {
    /// Memory of [`Lattice`]: `wavelift_lattice`.
    WaveliftLattice(2866) of Lattice
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
