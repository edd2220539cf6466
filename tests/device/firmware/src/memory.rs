//! The memory that the kernel is lent.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

use fixture::Effort;
#[cfg(feature = "streams")]
use wavelift_kernel::stream::RowCodec;
use wavelift_kernel::{Codec, Dense, Effort as Lent, Lattice, Training};

/// Samples of the largest brick or vector.
pub(crate) const SAMPLES: usize = if cfg!(feature = "roomy") { fixture::VOLUME } else { 8 * 8 * 8 };
const SCRATCH: usize = if cfg!(feature = "roomy") { 200_000 } else { 512 };
const BYTES: usize = 2 * SAMPLES + 64;

/// All of it.
pub(crate) struct Memory {
    codec: Codec,
    samples: [i32; SAMPLES],
    scratch: [i32; SCRATCH],
    bytes: [u8; BYTES],
    #[cfg(feature = "roomy")]
    efforts: Efforts,
    #[cfg(feature = "streams")]
    rows: RowCodec,
}

/// What efforts beyond fast take.
pub(crate) struct Efforts {
    pub(crate) training: Training,
    pub(crate) dense: Dense,
    pub(crate) lattice: Lattice,
}

impl Efforts {
    /// An effort with what it takes; `None` if there is no memory for it.
    pub(crate) fn lend(efforts: Option<&mut Self>, effort: Effort) -> Option<Lent<'_>> {
        Some(match (effort, efforts) {
            (Effort::Light, _) => Lent::Light,
            (Effort::Tabled, _) => Lent::Tabled,
            (Effort::Fast, _) => Lent::Fast,
            (Effort::Wide, Some(efforts)) => Lent::Wide(&mut efforts.training),
            (Effort::Default, Some(efforts)) => Lent::Default(&mut efforts.training),
            (Effort::Dense, Some(efforts)) => Lent::Dense(&mut efforts.dense, &mut efforts.training),
            (_, None) => return None,
        })
    }
}

/// Its parts.
pub(crate) struct Parts<'a> {
    pub(crate) codec: &'a mut Codec,
    pub(crate) samples: &'a mut [i32],
    pub(crate) scratch: &'a mut [i32],
    pub(crate) bytes: &'a mut [u8],
    /// Where there is room.
    pub(crate) efforts: Option<&'a mut Efforts>,
    #[cfg(feature = "streams")]
    pub(crate) rows: &'a mut RowCodec,
}

impl Memory {
    pub(crate) fn parts(&mut self) -> Parts<'_> {
        Parts {
            codec: &mut self.codec,
            samples: &mut self.samples,
            scratch: &mut self.scratch,
            bytes: &mut self.bytes,
            #[cfg(feature = "roomy")]
            efforts: Some(&mut self.efforts),
            #[cfg(not(feature = "roomy"))]
            efforts: None,
            #[cfg(feature = "streams")]
            rows: &mut self.rows,
        }
    }
}

struct Lender {
    memory: UnsafeCell<Memory>,
    is_lent: AtomicBool,
}

// SAFETY: the memory is lent once, before there could be a second thread.
unsafe impl Sync for Lender {}

static LENDER: Lender = Lender {
    memory: UnsafeCell::new(Memory {
        codec: Codec::NEW,
        samples: [0; SAMPLES],
        scratch: [0; SCRATCH],
        bytes: [0; BYTES],
        #[cfg(feature = "roomy")]
        efforts: Efforts { training: Training::NEW, dense: Dense::NEW, lattice: Lattice::NEW },
        #[cfg(feature = "streams")]
        rows: RowCodec::NEW,
    }),
    is_lent: AtomicBool::new(false),
};

/// The memory, the first time.
pub(crate) fn lend() -> Option<&'static mut Memory> {
    if LENDER.is_lent.load(Ordering::Relaxed) {
        return None;
    }
    LENDER.is_lent.store(true, Ordering::Relaxed);
    // SAFETY: nobody else has it, and nobody else will get it.
    Some(unsafe { &mut *LENDER.memory.get() })
}
