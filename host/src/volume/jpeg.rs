//! JPEG inside of other files: baseline, extended and progressive with 8 bits, and lossless with 2 to 16.
//!
//! Source: ITU-T T.81, as the crate jpeg-decoder reads it.

use std::io::Cursor;

use jpeg_decoder::{ColorTransform, Decoder, PixelFormat};

use super::element::reorder;
use super::raster::Raster;
use super::{ByteOrder, ElementType};

/// The values of a picture, little-endian, those of a sample side by side; or what is wrong with it.
///
/// Of three components `is_rgb` tells whether colours are stored as they are, rather than as brightness and two
/// differences; `None` takes the picture's word.
///
/// Memory: that of the picture as it has to be; a larger one is refused before it is decoded.
pub(super) fn decode(picture: &[u8], expected: Raster, is_rgb: Option<bool>) -> Result<Vec<u8>, String> {
    let Raster { width, height, components, bytes } = expected;
    let samples = width.saturating_mul(height).saturating_mul(components.into());
    let mut decoder = Decoder::new(Cursor::new(picture));
    decoder.set_max_decoding_buffer_size(usize::try_from(samples.saturating_mul(2)).unwrap_or(usize::MAX));
    if let Some(is_rgb) = is_rgb.filter(|_| components == 3) {
        decoder.set_color_transform(if is_rgb { ColorTransform::RGB } else { ColorTransform::YCbCr });
    }
    decoder.read_info().map_err(|cause| cause.to_string())?;
    let info = decoder.info().ok_or("it has no head")?;
    let found = match info.pixel_format {
        PixelFormat::L8 => (1, 1),
        PixelFormat::L16 => (1, 2),
        PixelFormat::RGB24 => (3, 1),
        PixelFormat::CMYK32 => (4, 1),
    };
    let size = [u64::from(info.width), u64::from(info.height)];
    if size != [width, height] || found.0 != components || found.1 > bytes {
        let [x, y] = size;
        let (values, bits) = (found.0, found.1 * 8);
        return Err(format!("it has {x}x{y} samples of {values} values of {bits} bits"));
    }
    let mut values = decoder.decode().map_err(|cause| cause.to_string())?;
    if values.len() as u64 != samples.saturating_mul(found.1 as u64) {
        return Err("it ends early".to_owned());
    }
    if found.1 == 2 && cfg!(target_endian = "big") {
        reorder(&mut values, ElementType::U16, ByteOrder::Big);
    }
    if found.1 == bytes {
        return Ok(values);
    }
    Ok(values.iter().flat_map(|value| [*value, 0]).collect())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// 1, 2048, 4095, 100, 3000, 7 in two rows, without loss; made by imagecodecs 2025 (`ljpeg_encode`).
    pub(in crate::volume) const LOSSLESS: [u8; 63] = [
        0xFF, 0xD8, 0xFF, 0xC4, 0x00, 0x17, 0x00, 0x01, 0x01, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x0B, 0x0A, 0x07, 0x0D, 0xFF, 0xC3, 0x00, 0x0B, 0x0C, 0x00, 0x02,
        0x00, 0x03, 0x01, 0x00, 0x11, 0x00, 0xFF, 0xDA, 0x00, 0x08, 0x01, 0x00, 0x00, 0x06, 0x00, 0x00, 0x00,
        0x07, 0xFF, 0x00, 0x7F, 0xFD, 0x8E, 0xE1, 0xF9, 0xC5, 0x60, 0xFF, 0xD9,
    ];

    const EXPECTED: Raster = Raster { width: 3, height: 2, components: 1, bytes: 2 };

    #[test]
    fn twelve_bits_come_back_without_loss() {
        let values = [1_u16, 2048, 4095, 100, 3000, 7].map(u16::to_le_bytes).concat();
        assert_eq!(decode(&LOSSLESS, EXPECTED, None), Ok(values));
    }

    #[test]
    fn other_pictures_are_refused() {
        for expected in [
            Raster { width: 4, ..EXPECTED },
            Raster { height: 1, ..EXPECTED },
            Raster { components: 3, ..EXPECTED },
            Raster { bytes: 1, ..EXPECTED },
        ] {
            let told = decode(&LOSSLESS, expected, None).unwrap_err();
            assert!(told.starts_with("it has 3x2 samples of 1 values of 16 bits"), "{told}");
        }
        for end in 0..LOSSLESS.len() {
            let _either = decode(&LOSSLESS[..end], EXPECTED, None);
        }
        for at in 0..LOSSLESS.len() {
            for by in 1..=255 {
                let mut changed = LOSSLESS;
                changed[at] ^= by;
                let _either = decode(&changed, EXPECTED, None);
            }
        }
    }
}
