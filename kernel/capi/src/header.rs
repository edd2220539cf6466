//! What a codestream holds, before any memory is taken for it.

use wavelift_kernel::{Header, Lattice};

use crate::error::code;
use crate::lent::Loan;
use crate::{WaveliftError, WaveliftPlan};

/// What a codestream holds: `wavelift_header`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct WaveliftHeader {
    /// Extent, wavelet (0 if there is none), levels and type.
    pub plan: WaveliftPlan,
    /// Which decoder takes it.
    pub storage: WaveliftStorage,
    /// How far a sample may be off, of a lattice; else 0.
    pub slack: u32,
    /// Bytes of the whole codestream.
    pub encoded_bytes: u64,
}

/// How a codestream holds its samples: `wavelift_storage`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum WaveliftStorage {
    /// As coefficients.
    Coded = 0,
    /// Under what is learnt from all samples before.
    Dense = 1,
    /// Near-losslessly.
    Lattice = 2,
    /// As they are.
    Stored = 3,
}

/// A level of a codestream, and what must be lent to decode it: `wavelift_level`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct WaveliftLevel {
    /// Samples along x, y and z.
    pub extent: [u32; 3],
    /// Elements of `samples`, exactly; the level's are the first of them.
    pub samples_len: usize,
    /// Elements of `scratch`, at least.
    pub scratch_len: usize,
    /// Bytes of the codestream, from its beginning, that suffice.
    pub bytes: u64,
}

/// Bytes of the longest header.
pub const WAVELIFT_MAX_HEADER_BYTES: usize = 187;

const _: () = assert!(WAVELIFT_MAX_HEADER_BYTES == Header::MAX_BYTES);

impl WaveliftHeader {
    fn new(header: &Header) -> Self {
        let (plan, slack) = (header.plan(), header.slack());
        let storage = match slack {
            Some(_) => WaveliftStorage::Lattice,
            None if header.is_dense() => WaveliftStorage::Dense,
            None if header.is_stored() => WaveliftStorage::Stored,
            None => WaveliftStorage::Coded,
        };
        let wavelet = (plan.levels() > 0 && slack.is_none()).then(|| plan.wavelet());
        Self {
            plan: WaveliftPlan::new(plan, wavelet, header.sample_type()),
            storage,
            slack: slack.unwrap_or(0),
            encoded_bytes: header.encoded_bytes(),
        }
    }
}

impl WaveliftLevel {
    fn new(header: &Header, level: u8) -> Result<Self, WaveliftError> {
        if level > header.plan().levels() {
            return Err(WaveliftError::LevelOutOfRange);
        }
        let extent = header.extent_at(level);
        let scratch_len = match header.slack() {
            Some(_) => Lattice::decoding_scratch_len(extent),
            None => header.scratch_len(),
        };
        Ok(Self {
            extent: extent.axes(),
            samples_len: header.samples_len(level),
            scratch_len,
            bytes: header.bytes_to_level(level),
        })
    }
}

/// Reads the header at the beginning of some bytes.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, `bytes` of `bytes_len`, that nobody else writes to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_header_parse(
    bytes: *const u8,
    bytes_len: usize,
    header: *mut WaveliftHeader,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut parse = || {
        let header = loan.place(header)?;
        header.put(WaveliftHeader::new(&Header::parse(loan.read(bytes, bytes_len)?)?));
        Ok(())
    };
    code(parse())
}

/// Reads the header at the beginning of some bytes, and says what a level of the codestream takes.
///
/// # Safety
/// As [`wavelift_header_parse`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_header_level(
    bytes: *const u8,
    bytes_len: usize,
    level: u8,
    found: *mut WaveliftLevel,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut parse = || {
        let found = loan.place(found)?;
        found.put(WaveliftLevel::new(&Header::parse(loan.read(bytes, bytes_len)?)?, level)?);
        Ok(())
    };
    code(parse())
}
