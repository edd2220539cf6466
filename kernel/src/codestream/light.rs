//! Light codestreams: coefficients as coded ones have them, in segments alike, but in few decisions each.

use super::codec::Codec;
use super::header::{Header, Storage};
use super::segments::SegmentWriter;
use crate::coder::{Band, Coefficients, Fixed};
use crate::{DecodeError, Malformed, Plan, SampleType};

impl Codec {
    /// Codes every resolution into `out`, and returns the length of the codestream. `None` if it does not fit; the
    /// coefficients are what they were then.
    pub(super) fn encode_light(
        &mut self,
        sample_type: SampleType,
        coefficients: &mut Coefficients<'_>,
        out: &mut [u8],
    ) -> Option<usize> {
        let fixed = coefficients.best_fixed()?;
        let chances = self.memory.chances()?;
        let Coefficients { plan, samples, scratch, .. } = coefficients;
        let resolutions = 0..=plan.levels();
        resolutions.clone().for_each(|r| each_band(plan, r, samples, |mut band| band.make_ranks(fixed)));
        let mut writer = SegmentWriter::new(sample_type, *plan, Storage::Light, out);
        let mut coded = resolutions.clone().map(|resolution| {
            writer.push(|encoder| {
                if resolution == 0 {
                    fixed.code(encoder);
                }
                each_band(plan, resolution, samples, |mut band| band.code(encoder, chances, scratch));
                Some(())
            })
        });
        let all_fit = coded.all(|fits| fits.is_some());
        let len = if all_fit { writer.finish() } else { None };
        if len.is_none() {
            resolutions.for_each(|r| each_band(plan, r, samples, |mut band| band.make_coefficients(fixed)));
        }
        len
    }

    /// Decodes the resolutions that `target` has, and undoes its transform.
    pub(super) fn decode_light(
        &mut self,
        header: &Header,
        payload: &[u8],
        mut target: Coefficients<'_>,
    ) -> Result<(), DecodeError> {
        let chances = self.memory.chances().ok_or(Malformed::Segment)?;
        let mut fixed = Fixed::InPlane;
        header.each_segment(payload, target.plan.levels().saturating_add(1), |resolution, decoder| {
            if resolution == 0 {
                fixed = fixed.code(decoder).ok_or(Malformed::Segment)?;
            }
            each_band(&target.plan, resolution, target.samples, |mut band| {
                band.code(decoder, chances, target.scratch);
                band.make_coefficients(fixed);
            });
            target.undo_resolution(resolution);
            Ok(())
        })
    }
}

/// Calls `work` with each subband of a resolution.
fn each_band(plan: &Plan, resolution: u8, values: &mut [i32], mut work: impl FnMut(Band<'_>)) {
    plan.subbands(resolution).for_each(|subband| work(Band { plan, subband, values }));
}
