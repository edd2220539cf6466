//! Streams of rows: what lasts from call to call lies in memory that the caller lends until the last one.

use wavelift_kernel::stream::{RowDecoder, RowEncoder, RowPlan, Status, Step};

use crate::error::code;
use crate::lent::Loan;
use crate::plan::{sample_type, sample_type_number, wavelet, wavelet_number};
use crate::{WaveliftError, WaveliftRowCodec, WaveliftRowDecoder, WaveliftRowEncoder};

/// What a stream of rows holds: `wavelift_row_plan`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct WaveliftRowPlan {
    /// Samples of a row.
    pub width: u32,
    /// Rows of a strip; 0 for as many as suit the width.
    pub strip: u16,
    /// As in a plan.
    pub wavelet: u8,
    /// Levels of the transform.
    pub levels: u8,
    /// As in a plan.
    pub sample_type: u8,
}

/// What a step did: `wavelift_step`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct WaveliftStep {
    /// Elements of the input that were taken.
    pub consumed: usize,
    /// Elements of the output that were written.
    pub produced: usize,
    /// What is needed to go on.
    pub status: WaveliftStatus,
}

/// What is needed to go on: `wavelift_status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum WaveliftStatus {
    /// More input.
    NeedInput = 0,
    /// More room for output.
    NeedOutput = 1,
    /// Nothing: the stream is complete.
    Done = 2,
}

impl WaveliftRowPlan {
    fn new(plan: &RowPlan) -> Self {
        Self {
            width: plan.width(),
            strip: u16::try_from(plan.strip()).unwrap_or(u16::MAX),
            wavelet: wavelet_number((plan.levels() > 0).then(|| plan.wavelet())),
            levels: plan.levels(),
            sample_type: sample_type_number(plan.sample_type()),
        }
    }

    fn check(self) -> Result<RowPlan, WaveliftError> {
        let (wavelet, sample_type) = (wavelet(self.wavelet, self.levels)?, sample_type(self.sample_type)?);
        let plan = RowPlan::new(wavelet, self.width, self.levels, sample_type)?;
        Ok(if self.strip == 0 { plan } else { plan.with_strip(self.strip) })
    }
}

impl From<Step> for WaveliftStep {
    fn from(step: Step) -> Self {
        let status = match step.status {
            Status::NeedInput => WaveliftStatus::NeedInput,
            Status::NeedOutput => WaveliftStatus::NeedOutput,
            Status::Done => WaveliftStatus::Done,
        };
        Self { consumed: step.consumed, produced: step.produced, status }
    }
}

/// Elements of memory that an encoder of rows takes.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_encoder_memory_len(plan: *const WaveliftRowPlan) -> usize {
    // SAFETY: `plan` is the only pointer, and readable.
    let loan = unsafe { Loan::new() };
    loan.copy(plan).and_then(WaveliftRowPlan::check).map_or(0, |plan| plan.encoder_memory_len())
}

/// Elements of memory that a decoder of rows takes.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_decoder_memory_len(plan: *const WaveliftRowPlan) -> usize {
    // SAFETY: `plan` is the only pointer, and readable.
    let loan = unsafe { Loan::new() };
    loan.copy(plan).and_then(WaveliftRowPlan::check).map_or(0, |plan| plan.decoder_memory_len())
}

/// Elements of memory in which a decoder of rows is faster.
///
/// # Safety
/// `plan` is NULL or points to a plan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_decoder_fast_memory_len(plan: *const WaveliftRowPlan) -> usize {
    // SAFETY: `plan` is the only pointer, and readable.
    let loan = unsafe { Loan::new() };
    loan.copy(plan).and_then(WaveliftRowPlan::check).map_or(0, |plan| plan.fast_decoder_memory_len())
}

/// Reads the header of a stream of rows.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, `bytes` of `bytes_len`, that nobody else writes to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_header_parse(
    bytes: *const u8,
    bytes_len: usize,
    plan: *mut WaveliftRowPlan,
    header_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut parse = || {
        let (plan, header_len) = (loan.place(plan)?, loan.place(header_len)?);
        let (parsed, taken) = RowPlan::parse(loan.read(bytes, bytes_len)?)?;
        plan.put(WaveliftRowPlan::new(&parsed));
        header_len.put(taken);
        Ok(())
    };
    code(parse())
}

/// Begins to encode rows.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, `memory` of `memory_len`, that nobody else writes to until the last
/// call for `encoder`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_encoder_begin(
    encoder: *mut WaveliftRowEncoder,
    codec: *mut WaveliftRowCodec,
    plan: *const WaveliftRowPlan,
    memory: *mut i32,
    memory_len: usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let loan = unsafe { Loan::new() };
    code(loan.begin(encoder, |loan| {
        let plan = loan.copy(plan)?.check()?;
        Ok(RowEncoder::new(&plan, loan.state(codec)?, loan.write(memory, memory_len)?)?)
    }))
}

/// Takes samples and gives bytes.
///
/// # Safety
/// As [`wavelift_decode`](crate::wavelift_decode); what was lent when `encoder` began is untouched since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_encoder_step(
    encoder: *mut WaveliftRowEncoder,
    samples: *const i32,
    samples_len: usize,
    out: *mut u8,
    out_len: usize,
    step: *mut WaveliftStep,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut proceed = || {
        let encoder = loan.resume(encoder)?;
        let (samples, out) = (loan.read(samples, samples_len)?, loan.write(out, out_len)?);
        let step = loan.place(step)?;
        step.put(encoder.step(samples, out)?.into());
        Ok(())
    };
    code(proceed())
}

/// Says that no more rows follow.
///
/// # Safety
/// What was lent when `encoder` began is untouched since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_encoder_finish(encoder: *mut WaveliftRowEncoder) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    code(loan.resume(encoder).and_then(|encoder| Ok(encoder.finish()?)))
}

/// Begins to decode rows.
///
/// # Safety
/// As [`wavelift_row_encoder_begin`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_decoder_begin(
    decoder: *mut WaveliftRowDecoder,
    codec: *mut WaveliftRowCodec,
    plan: *const WaveliftRowPlan,
    memory: *mut i32,
    memory_len: usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let loan = unsafe { Loan::new() };
    code(loan.begin(decoder, |loan| {
        let plan = loan.copy(plan)?.check()?;
        Ok(RowDecoder::new(&plan, loan.state(codec)?, loan.write(memory, memory_len)?)?)
    }))
}

/// Takes bytes and gives samples.
///
/// # Safety
/// As [`wavelift_row_encoder_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_row_decoder_step(
    decoder: *mut WaveliftRowDecoder,
    bytes: *const u8,
    bytes_len: usize,
    samples: *mut i32,
    samples_len: usize,
    step: *mut WaveliftStep,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut proceed = || {
        let decoder = loan.resume(decoder)?;
        let (bytes, samples) = (loan.read(bytes, bytes_len)?, loan.write(samples, samples_len)?);
        let step = loan.place(step)?;
        step.put(decoder.step(bytes, samples)?.into());
        Ok(())
    };
    code(proceed())
}
