//! JPEG 2000 inside of other files, without loss or with.
//!
//! Source: ITU-T T.800, as the crate hayro-jpeg2000 reads it; A.5.1 for the head.

use hayro_jpeg2000::{DecodeSettings, DecoderContext, Image};

use super::guarded::guarded;
use super::raster::Raster;

/// What every codestream begins with: its start, and the mark of its sizes.
const START: [u8; 4] = [0xFF, 0x4F, 0xFF, 0x51];

/// Where its sizes tell the depth of the first component, from the start on.
const DEPTH: usize = 42;

/// The values of a picture, little-endian, those of a sample side by side; or what is wrong with it. Those of fewer
/// bits have their sign in front.
///
/// Memory: some bytes a value, and only for a picture that is as large as it has to be.
pub(super) fn decode(picture: &[u8], expected: Raster) -> Result<Vec<u8>, String> {
    // A damaged picture may lead to sums that overflow in the crate.
    guarded(|| decode_trusting(picture, expected))
}

fn decode_trusting(picture: &[u8], expected: Raster) -> Result<Vec<u8>, String> {
    let settings = DecodeSettings { resolve_palette_indices: false, strict: true, target_resolution: None };
    let image = Image::new(picture, &settings).map_err(|cause| cause.to_string())?;
    let [width, height] = [image.width(), image.height()].map(u64::from);
    let bits = u32::from(image.original_bit_depth());
    if [width, height] != [expected.width, expected.height] || bits as usize > expected.bytes * 8 {
        return Err(format!("it has {width}x{height} samples of {bits} bits"));
    }
    // The crate takes all values for unsigned ones, half of their range higher.
    let shift = if is_signed(picture) { 1 << (bits - 1) } else { 0 };
    let mut context = DecoderContext::default();
    let decoded = image.decode(&mut context).map_err(|cause| cause.to_string())?;
    let planes: Vec<&[f32]> = decoded.components().iter().map(|component| component.samples()).collect();
    let samples = (width * height) as usize;
    if planes.len() as u64 != u64::from(expected.components)
        || planes.iter().any(|plane| plane.len() != samples)
    {
        return Err(format!("it has {} components", planes.len()));
    }
    let mut values = Vec::with_capacity(samples * planes.len() * expected.bytes);
    for sample in 0..samples {
        for plane in &planes {
            let value = plane[sample].round() as i32 - shift;
            values.extend_from_slice(&value.to_le_bytes()[..expected.bytes]);
        }
    }
    Ok(values)
}

/// Whether the values of the first component have a sign.
fn is_signed(picture: &[u8]) -> bool {
    let start = picture.windows(START.len()).position(|bytes| bytes == START);
    start.and_then(|start| picture.get(start + DEPTH)).is_some_and(|depth| depth & 0x80 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, -2048, 2047, 100, -1000, 7 in two rows, with a sign and without loss; made by OpenJPEG 2.5.4.
    const SIGNED: [u8; 133] = [
        0xFF, 0x4F, 0xFF, 0x51, 0x00, 0x29, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x02, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x8B, 0x01, 0x01, 0xFF, 0x52, 0x00, 0x0C, 0x00, 0x00,
        0x00, 0x01, 0x00, 0x00, 0x04, 0x04, 0x00, 0x01, 0xFF, 0x5C, 0x00, 0x04, 0x40, 0x60, 0xFF, 0x64, 0x00,
        0x25, 0x00, 0x01, 0x43, 0x72, 0x65, 0x61, 0x74, 0x65, 0x64, 0x20, 0x62, 0x79, 0x20, 0x4F, 0x70, 0x65,
        0x6E, 0x4A, 0x50, 0x45, 0x47, 0x20, 0x76, 0x65, 0x72, 0x73, 0x69, 0x6F, 0x6E, 0x20, 0x32, 0x2E, 0x35,
        0x2E, 0x34, 0xFF, 0x90, 0x00, 0x0A, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1B, 0x00, 0x01, 0xFF, 0x93, 0xDF,
        0xE0, 0x28, 0x0E, 0x5C, 0x1B, 0x46, 0x12, 0x02, 0xE4, 0xE5, 0xC9, 0x8F, 0xFF, 0xD9,
    ];

    const SIX: Raster = Raster { width: 3, height: 2, components: 1, bytes: 2 };

    #[test]
    fn values_with_a_sign_and_without_are_read() {
        let expected = [1_i16, -2048, 2047, 100, -1000, 7];
        assert_eq!(decode(&SIGNED, SIX).unwrap(), expected.map(i16::to_le_bytes).concat());
        let mut unsigned = SIGNED;
        unsigned[DEPTH] &= 0x7F;
        let expected = expected.map(|value| (value + 2048).to_le_bytes()).concat();
        assert_eq!(decode(&unsigned, SIX).unwrap(), expected);
    }

    #[test]
    fn other_and_damaged_pictures_are_refused() {
        for other in [
            Raster { width: 2, ..SIX },
            Raster { height: 3, ..SIX },
            Raster { components: 3, ..SIX },
            Raster { bytes: 1, ..SIX },
        ] {
            decode(&SIGNED, other).unwrap_err();
        }
        for at in 0..SIGNED.len() {
            let _either = decode(&SIGNED[..at], SIX);
            for by in [1, 0x10, 0x80, 0xFF] {
                let mut changed = SIGNED;
                changed[at] ^= by;
                let _either = decode(&changed, SIX);
            }
        }
    }
}
