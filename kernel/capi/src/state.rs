//! States of fixed size as C sees them: memory without a meaning, as large and as aligned as the kernel's.

use core::mem::MaybeUninit;

use wavelift_kernel::{Codec, Dense, Lattice, Training};

/// Memory for a state of the kernel.
pub(crate) trait State: Sized {
    /// The state.
    type Of;

    /// What every call begins with.
    const NEW: Self::Of;
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

            /// Memory full of `word`.
            #[cfg(test)]
            #[allow(dead_code, reason = "tests take the state that shows most")]
            pub(crate) const fn filled(word: u64) -> Self {
                Self { opaque: [MaybeUninit::new(word); $words] }
            }
        }

        const _: () = {
            assert!(size_of::<$kernel>() <= size_of::<$name>(), "the state has grown: change the header");
            assert!(align_of::<$kernel>() <= align_of::<$name>());
            let spare = size_of::<$name>().saturating_sub(size_of::<$kernel>());
            assert!(usize::BITS < 64 || spare < size_of::<u64>(), "the state has shrunk: change the header");
        };

        impl State for $name {
            type Of = $kernel;
            const NEW: Self::Of = <$kernel>::NEW;
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
