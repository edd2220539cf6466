//! Encoding.

use wavelift_kernel::{Codec, Effort, Lattice, Near, max_encoded_len};

use crate::error::code;
use crate::lent::Loan;
use crate::plan::length;
use crate::{
    WaveliftCodec, WaveliftDense, WaveliftError, WaveliftLattice, WaveliftLent, WaveliftPlan,
    WaveliftTraining,
};

/// Bytes that suffice for any codestream of a plan.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_max_encoded_len(plan: *const WaveliftPlan) -> usize {
    // SAFETY: the same promise.
    unsafe { length(plan, |plan| Ok(max_encoded_len(plan.extent()?, plan.sample_type()?).unwrap_or(0))) }
}

/// Elements of scratch that `wavelift_encode_near` takes.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_near_scratch_len(plan: *const WaveliftPlan) -> usize {
    // SAFETY: the same promise.
    unsafe { length(plan, |plan| Ok(Lattice::encoding_scratch_len(plan.extent()?))) }
}

/// What every encoder is lent.
struct Lent<'a> {
    plan: WaveliftPlan,
    samples: &'a mut [i32],
    scratch: &'a mut [i32],
    out: &'a mut [u8],
    /// The length of `out`, and in the end that of the codestream.
    len: &'a mut usize,
}

impl<'a> Lent<'a> {
    fn new(
        loan: &mut Loan<'a>,
        plan: *const WaveliftPlan,
        lent: *const WaveliftLent,
        (out, len): (*mut u8, *mut usize),
    ) -> Result<Self, WaveliftError> {
        let plan = loan.copy(plan)?;
        let (samples, scratch) = loan.lent(lent)?;
        let len = loan.write_one(len)?;
        Ok(Self { plan, samples, scratch, out: loan.write(out, *len)?, len })
    }

    fn encode(self, codec: &mut Codec, effort: Effort<'_>) -> Result<(), WaveliftError> {
        let Self { plan, samples, scratch, out, len } = self;
        *len = codec.encode(effort, &plan.check()?, plan.sample_type()?, samples, scratch, out)?;
        Ok(())
    }
}

/// Encodes with an effort whose memory is borrowed last.
///
/// # Safety
/// As [`wavelift_encode`].
unsafe fn encode<'a>(
    codec: *mut WaveliftCodec,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    out: (*mut u8, *mut usize),
    effort: impl FnOnce(&mut Loan<'a>) -> Result<Effort<'a>, WaveliftError>,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let encoded = || {
        let lent = Lent::new(&mut loan, plan, lent, out)?;
        let codec = loan.state(codec)?;
        lent.encode(codec, effort(&mut loan)?)
    };
    code(encoded())
}

/// Encodes with [`Effort::Default`], or [`Effort::Fast`] if `training` is NULL.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, as long as the length beside it says, that nobody else writes to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_encode(
    codec: *mut WaveliftCodec,
    training: *mut WaveliftTraining,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    out: *mut u8,
    out_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe {
        encode(codec, plan, lent, (out, out_len), |loan| {
            Ok(if training.is_null() { Effort::Fast } else { Effort::Default(loan.state(training)?) })
        })
    }
}

/// Encodes with [`Effort::Light`].
///
/// # Safety
/// As [`wavelift_encode`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_encode_light(
    codec: *mut WaveliftCodec,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    out: *mut u8,
    out_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe { encode(codec, plan, lent, (out, out_len), |_| Ok(Effort::Light)) }
}

/// Encodes with [`Effort::Wide`], or [`Effort::Tabled`] if `training` is NULL.
///
/// # Safety
/// As [`wavelift_encode`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_encode_tabled(
    codec: *mut WaveliftCodec,
    training: *mut WaveliftTraining,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    out: *mut u8,
    out_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe {
        encode(codec, plan, lent, (out, out_len), |loan| {
            Ok(if training.is_null() { Effort::Tabled } else { Effort::Wide(loan.state(training)?) })
        })
    }
}

/// Encodes with [`Effort::Dense`].
///
/// # Safety
/// As [`wavelift_encode`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_encode_dense(
    codec: *mut WaveliftCodec,
    training: *mut WaveliftTraining,
    dense: *mut WaveliftDense,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    out: *mut u8,
    out_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe {
        encode(codec, plan, lent, (out, out_len), |loan| {
            Ok(Effort::Dense(loan.state(dense)?, loan.state(training)?))
        })
    }
}

/// Encodes near-losslessly; the wavelet and the levels of the plan do not matter.
///
/// # Safety
/// As [`wavelift_encode`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_encode_near(
    lattice: *mut WaveliftLattice,
    plan: *const WaveliftPlan,
    slack: u32,
    lent: *const WaveliftLent,
    out: *mut u8,
    out_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut encode = || {
        let Lent { plan, samples, scratch, out, len } = Lent::new(&mut loan, plan, lent, (out, out_len))?;
        let near = Near { extent: plan.extent()?, sample_type: plan.sample_type()?, slack };
        *len = loan.state(lattice)?.encode(near, samples, scratch, out)?;
        Ok(())
    };
    code(encode())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_the_kernels_and_0_for_no_plan() {
        let plan = WaveliftPlan { extent: [16, 8, 1], wavelet: 4, levels: 2, sample_type: 0 };
        let lengths = |plan: *const WaveliftPlan| {
            // SAFETY: NULL, or a plan.
            [wavelift_max_encoded_len, wavelift_near_scratch_len].map(|of| unsafe { of(plan) })
        };
        let near = Lattice::encoding_scratch_len(plan.extent().unwrap());
        assert_eq!(lengths(&plan), [128 + 26, near]);
        assert_eq!(lengths(&WaveliftPlan { extent: [0; 3], ..plan }), [0; 2]);
        assert_eq!(lengths(core::ptr::null()), [0; 2]);
    }
}
