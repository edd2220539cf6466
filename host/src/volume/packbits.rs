//! Runs of bytes as Apple's PackBits codes them; TIFF and DICOM both use it.
//!
//! Source: *TIFF Revision 6.0*, section 9; DICOM PS3.5, annex G.3.

/// Exactly `bytes` bytes; `None` if there are fewer. What follows them does not count.
///
/// Each byte of `stored` stands for 64 at most, which bounds the memory.
pub(super) fn unpack_bits(stored: &[u8], bytes: usize) -> Option<Vec<u8>> {
    if bytes as u64 > (stored.len() as u64).saturating_mul(64) {
        return None;
    }
    let mut out = Vec::with_capacity(bytes);
    let mut rest = stored;
    while out.len() < bytes {
        let (&head, tail) = rest.split_first()?;
        rest = match head {
            0..=127 => {
                let (run, tail) = tail.split_at_checked(usize::from(head) + 1)?;
                out.extend_from_slice(run);
                tail
            }
            128 => tail,
            129..=255 => {
                let (&value, tail) = tail.split_first()?;
                out.resize(out.len() + 257 - usize::from(head), value);
                tail
            }
        };
    }
    out.truncate(bytes);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_literals_are_read() {
        // The example of section 9.
        let stored =
            [0xFE, 0xAA, 0x02, 0x80, 0x00, 0x2A, 0xFD, 0xAA, 0x03, 0x80, 0x00, 0x2A, 0x22, 0xF7, 0xAA];
        let expected = [
            0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0xAA, 0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0x22, 0xAA, 0xAA,
            0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA,
        ];
        assert_eq!(unpack_bits(&stored, 24).unwrap(), expected);
        assert_eq!(unpack_bits(&stored, 5).unwrap(), expected[..5]);
        assert_eq!(unpack_bits(&stored, 25), None);
        assert_eq!(unpack_bits(&[128, 0, 7], 1).unwrap(), [7]);
        for stored in [&[5, 1][..], &[200], &[]] {
            assert_eq!(unpack_bits(stored, 1), None);
        }
    }
}
