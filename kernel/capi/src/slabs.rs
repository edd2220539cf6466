//! Streams of slabs: as those of rows, in memory for the samples and the codestream of one slab.

use wavelift_kernel::Effort;
use wavelift_kernel::stream::{SlabDecoder, SlabEncoder, SlabMemory, SlabPlan};

use crate::error::code;
use crate::lent::Loan;
use crate::rows::WaveliftStep;
use crate::{
    WaveliftCodec, WaveliftError, WaveliftLent, WaveliftPlan, WaveliftSlabDecoder, WaveliftSlabEncoder,
    WaveliftTraining,
};

/// The plan of slabs, and the memory that is lent for them.
fn lend<'a>(
    loan: &mut Loan<'a>,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    (bytes, bytes_len): (*mut u8, usize),
) -> Result<(SlabPlan, SlabMemory<'a>), WaveliftError> {
    let plan = loan.copy(plan)?;
    let (whole, sample_type) = (plan.check()?, plan.sample_type()?);
    let plan = SlabPlan::new(whole.wavelet(), whole.extent(), whole.levels(), sample_type)?;
    let (samples, scratch) = loan.lent(lent)?;
    Ok((plan, SlabMemory { samples, scratch, bytes: loan.write(bytes, bytes_len)? }))
}

/// Reads the header of a stream of slabs.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, `bytes` of `bytes_len`, that nobody else writes to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_header_parse(
    bytes: *const u8,
    bytes_len: usize,
    plan: *mut WaveliftPlan,
    header_len: *mut usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    let mut parse = || {
        let (plan, header_len) = (loan.place(plan)?, loan.place(header_len)?);
        let (parsed, taken) = SlabPlan::parse(loan.read(bytes, bytes_len)?)?;
        let whole = parsed.plan();
        let wavelet = (whole.levels() > 0).then(|| whole.wavelet());
        plan.put(WaveliftPlan::new(whole, wavelet, parsed.sample_type()));
        header_len.put(taken);
        Ok(())
    };
    code(parse())
}

/// Begins with an effort whose memory is borrowed last.
///
/// # Safety
/// As [`wavelift_slab_encoder_begin`].
unsafe fn begin(
    encoder: *mut WaveliftSlabEncoder,
    codec: *mut WaveliftCodec,
    (plan, lent): (*const WaveliftPlan, *const WaveliftLent),
    bytes: (*mut u8, usize),
    effort: impl FnOnce(&mut Loan<'static>) -> Result<Effort<'static>, WaveliftError>,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let loan = unsafe { Loan::new() };
    code(loan.begin(encoder, |loan| {
        let (plan, memory) = lend(loan, plan, lent, bytes)?;
        let codec = loan.state(codec)?;
        Ok(SlabEncoder::new(&plan, codec, effort(loan)?, memory)?)
    }))
}

/// Begins to encode slabs with [`Effort::Default`], or [`Effort::Fast`] if `training` is NULL.
///
/// # Safety
/// Each pointer is NULL or to memory of its type, `bytes` of `bytes_len`, and those in `lent` of their lengths, that
/// nobody else writes to until the last call for `encoder`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_encoder_begin(
    encoder: *mut WaveliftSlabEncoder,
    codec: *mut WaveliftCodec,
    training: *mut WaveliftTraining,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    bytes: *mut u8,
    bytes_len: usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe {
        begin(encoder, codec, (plan, lent), (bytes, bytes_len), |loan| {
            Ok(if training.is_null() { Effort::Fast } else { Effort::Default(loan.state(training)?) })
        })
    }
}

/// Begins to encode slabs with [`Effort::Light`].
///
/// # Safety
/// As [`wavelift_slab_encoder_begin`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_encoder_begin_light(
    encoder: *mut WaveliftSlabEncoder,
    codec: *mut WaveliftCodec,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    bytes: *mut u8,
    bytes_len: usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe { begin(encoder, codec, (plan, lent), (bytes, bytes_len), |_| Ok(Effort::Light)) }
}

/// Begins to encode slabs with [`Effort::Wide`], or [`Effort::Tabled`] if `training` is NULL.
///
/// # Safety
/// As [`wavelift_slab_encoder_begin`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_encoder_begin_tabled(
    encoder: *mut WaveliftSlabEncoder,
    codec: *mut WaveliftCodec,
    training: *mut WaveliftTraining,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    bytes: *mut u8,
    bytes_len: usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    unsafe {
        begin(encoder, codec, (plan, lent), (bytes, bytes_len), |loan| {
            Ok(if training.is_null() { Effort::Tabled } else { Effort::Wide(loan.state(training)?) })
        })
    }
}

/// Takes samples and gives bytes.
///
/// # Safety
/// As [`wavelift_decode`](crate::wavelift_decode); what was lent when `encoder` began is untouched since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_encoder_step(
    encoder: *mut WaveliftSlabEncoder,
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

/// Says that no more slices follow.
///
/// # Safety
/// What was lent when `encoder` began is untouched since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_encoder_finish(encoder: *mut WaveliftSlabEncoder) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let mut loan = unsafe { Loan::new() };
    code(loan.resume(encoder).and_then(|encoder| Ok(encoder.finish()?)))
}

/// Begins to decode slabs.
///
/// # Safety
/// As [`wavelift_slab_encoder_begin`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_decoder_begin(
    decoder: *mut WaveliftSlabDecoder,
    codec: *mut WaveliftCodec,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    bytes: *mut u8,
    bytes_len: usize,
) -> WaveliftError {
    // SAFETY: the caller promises as much.
    let loan = unsafe { Loan::new() };
    code(loan.begin(decoder, |loan| {
        let (plan, memory) = lend(loan, plan, lent, (bytes, bytes_len))?;
        Ok(SlabDecoder::new(&plan, loan.state(codec)?, memory)?)
    }))
}

/// Takes bytes and gives samples.
///
/// # Safety
/// As [`wavelift_slab_encoder_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wavelift_slab_decoder_step(
    decoder: *mut WaveliftSlabDecoder,
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
