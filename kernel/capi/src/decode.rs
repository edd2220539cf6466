//! Decoding, of any bytes.

use crate::error::code;
use crate::lent::Loan;
use crate::{WaveliftCodec, WaveliftDense, WaveliftError, WaveliftLattice, WaveliftLent};

/// Decodes coefficients and stored samples.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, as long as the length beside it says, that nobody else writes to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_decode(
    codec: *mut WaveliftCodec,
    bytes: *const u8,
    bytes_len: usize,
    level: u8,
    lent: *const WaveliftLent,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut decode = || {
        let (bytes, (samples, scratch)) = (loan.read(bytes, bytes_len)?, loan.lent(lent)?);
        loan.state(codec)?.decode_to_level(bytes, level, samples, scratch)?;
        Ok(())
    };
    code(decode())
}

/// As [`wavelift_decode`], dense codestreams too.
///
/// # Safety
/// As [`wavelift_decode`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_decode_dense(
    codec: *mut WaveliftCodec,
    dense: *mut WaveliftDense,
    bytes: *const u8,
    bytes_len: usize,
    level: u8,
    lent: *const WaveliftLent,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut decode = || {
        let (bytes, (samples, scratch)) = (loan.read(bytes, bytes_len)?, loan.lent(lent)?);
        let dense = loan.state(dense)?;
        loan.state(codec)?.decode_dense(dense, bytes, level, samples, scratch)?;
        Ok(())
    };
    code(decode())
}

/// Decodes near-lossless codestreams.
///
/// # Safety
/// As [`wavelift_decode`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_decode_near(
    lattice: *mut WaveliftLattice,
    bytes: *const u8,
    bytes_len: usize,
    level: u8,
    lent: *const WaveliftLent,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut decode = || {
        let (bytes, (samples, scratch)) = (loan.read(bytes, bytes_len)?, loan.lent(lent)?);
        loan.state(lattice)?.decode_to_level(bytes, level, samples, scratch)?;
        Ok(())
    };
    code(decode())
}
