//! Plans of C, and the lengths of what must be lent for them.

use wavelift_kernel::{Dense, Extent, Plan, SampleType, Wavelet};

use crate::WaveliftError;
use crate::error::code;
use crate::lent::Loan;

/// What a codestream holds: `wavelift_plan`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct WaveliftPlan {
    /// Samples along x, y and z; x varies fastest.
    pub extent: [u32; 3],
    /// 1 to 6 in the order of [`Wavelet::ALL`]; 0 for none, with 0 levels.
    pub wavelet: u8,
    /// Levels of the transform.
    pub levels: u8,
    /// 0 to 5 in the order of [`SampleType::ALL`].
    pub sample_type: u8,
}

impl WaveliftPlan {
    /// The plan of a codestream; `wavelet` is `None` if it has none.
    pub(crate) fn new(plan: Plan, wavelet: Option<Wavelet>, sample_type: SampleType) -> Self {
        Self {
            extent: plan.extent().axes(),
            wavelet: wavelet_number(wavelet),
            levels: plan.levels(),
            sample_type: sample_type_number(sample_type),
        }
    }

    pub(crate) fn sample_type(&self) -> Result<SampleType, WaveliftError> {
        sample_type(self.sample_type)
    }

    pub(crate) fn extent(&self) -> Result<Extent, WaveliftError> {
        Ok(Extent::new(self.extent)?)
    }

    /// The plan as the kernel checks it.
    pub(crate) fn check(&self) -> Result<Plan, WaveliftError> {
        let extent = self.extent()?;
        self.sample_type()?;
        Ok(Plan::new(wavelet(self.wavelet, self.levels)?, extent, self.levels)?)
    }
}

/// The type of a number.
pub(crate) fn sample_type(number: u8) -> Result<SampleType, WaveliftError> {
    SampleType::ALL.get(usize::from(number)).copied().ok_or(WaveliftError::UnknownSampleType)
}

/// The wavelet of a number; any without levels.
pub(crate) fn wavelet(number: u8, levels: u8) -> Result<Wavelet, WaveliftError> {
    let wavelet = match number {
        0 if levels == 0 => Some(Wavelet::Haar),
        number => usize::from(number).checked_sub(1).and_then(|index| Wavelet::ALL.get(index).copied()),
    };
    wavelet.ok_or(WaveliftError::UnknownWavelet)
}

/// The number of a wavelet; 0 for none.
pub(crate) fn wavelet_number(wavelet: Option<Wavelet>) -> u8 {
    number(&Wavelet::ALL, wavelet, 1)
}

/// The number of a type.
pub(crate) fn sample_type_number(sample_type: SampleType) -> u8 {
    number(&SampleType::ALL, Some(sample_type), 0)
}

/// The place of `one` in `all`, counted from `first`; 0 for none.
fn number<T: PartialEq>(all: &[T], one: Option<T>, first: u8) -> u8 {
    let mut numbers = (first..).zip(all);
    numbers.find(|(_, each)| Some(*each) == one.as_ref()).map_or(0, |(number, _)| number)
}

/// A length of the plan, or 0 if there is no such plan.
///
/// # Safety
/// `plan` is NULL or points to a plan.
pub(crate) unsafe fn length(
    plan: *const WaveliftPlan,
    of: impl FnOnce(WaveliftPlan) -> Result<usize, WaveliftError>,
) -> usize {
    // SAFETY: `plan` is the only pointer, and readable.
    let loan = unsafe { Loan::new() };
    loan.copy(plan).and_then(of).unwrap_or(0)
}

/// Says whether there is such a plan.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_plan_check(plan: *const WaveliftPlan) -> WaveliftError {
    // SAFETY: `plan` is the only pointer, and readable.
    let loan = unsafe { Loan::new() };
    code(loan.copy(plan).and_then(|plan| plan.check()).map(|_| ()))
}

/// The most levels of an extent.
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_max_levels(x: u32, y: u32, z: u32) -> u8 {
    Extent::new([x, y, z]).map_or(0, Extent::max_levels)
}

/// Samples of a plan.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_samples_len(plan: *const WaveliftPlan) -> usize {
    // SAFETY: the same promise.
    unsafe { length(plan, |plan| Ok(plan.extent()?.samples())) }
}

/// Elements of scratch that `wavelift_encode` and `wavelift_decode` take.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_scratch_len(plan: *const WaveliftPlan) -> usize {
    // SAFETY: the same promise.
    unsafe { length(plan, |plan| Ok(plan.check()?.scratch_len())) }
}

/// Elements of scratch that `wavelift_encode_dense` and `wavelift_decode_dense` take.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_dense_scratch_len(plan: *const WaveliftPlan) -> usize {
    // SAFETY: the same promise.
    unsafe { length(plan, |plan| Ok(Dense::scratch_len(&plan.check()?))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: WaveliftPlan = WaveliftPlan { extent: [16, 8, 1], wavelet: 4, levels: 2, sample_type: 0 };

    #[test]
    fn numbers_stand_for_wavelets_and_types() {
        let plan = PLAN.check().unwrap();
        assert_eq!(plan.wavelet(), Wavelet::Linear);
        assert_eq!(PLAN.sample_type(), Ok(SampleType::U8));
        assert_eq!(WaveliftPlan::new(plan, Some(plan.wavelet()), SampleType::U8), PLAN);
        let none = WaveliftPlan { wavelet: 0, levels: 0, ..PLAN };
        assert_eq!(WaveliftPlan::new(none.check().unwrap(), None, SampleType::U8), none);
    }

    #[test]
    fn what_is_wrong_with_a_plan_is_told() {
        let fault = |plan: WaveliftPlan| plan.check().unwrap_err();
        assert_eq!(fault(WaveliftPlan { wavelet: 7, ..PLAN }), WaveliftError::UnknownWavelet);
        assert_eq!(fault(WaveliftPlan { wavelet: 0, ..PLAN }), WaveliftError::UnknownWavelet);
        assert_eq!(fault(WaveliftPlan { sample_type: 6, ..PLAN }), WaveliftError::UnknownSampleType);
        assert_eq!(fault(WaveliftPlan { levels: 5, ..PLAN }), WaveliftError::TooManyLevels);
        assert_eq!(fault(WaveliftPlan { extent: [1, 0, 1], ..PLAN }), WaveliftError::ZeroExtent);
        assert_eq!(fault(WaveliftPlan { extent: [1 << 16; 3], ..PLAN }), WaveliftError::ExtentTooLarge);
    }

    #[test]
    fn lengths_are_the_kernels_and_0_for_no_plan() {
        let lengths = |plan: *const WaveliftPlan| {
            // SAFETY: NULL, or a plan.
            [wavelift_samples_len, wavelift_scratch_len].map(|of| unsafe { of(plan) })
        };
        assert_eq!(lengths(&PLAN), [128, PLAN.check().unwrap().scratch_len()]);
        assert_eq!(lengths(&WaveliftPlan { extent: [0; 3], ..PLAN }), [0; 2]);
        assert_eq!(lengths(core::ptr::null()), [0; 2]);
    }
}
