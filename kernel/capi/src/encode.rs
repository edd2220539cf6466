//! Encoding.

use wavelift_kernel::{Codec, Effort, Near};

use crate::error::code;
use crate::lent::Loan;
use crate::{
    WaveliftCodec, WaveliftDense, WaveliftError, WaveliftLattice, WaveliftLent, WaveliftPlan,
    WaveliftTraining,
};

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
