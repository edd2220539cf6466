//! An index of codestreams as a postcard record (feature `serde`).
//!
//! A device that stores or sends many codestreams can keep beside them what a reader needs to find one: where in the
//! volume each brick lies, what it holds, how long it is, and a checksum. The record is never part of a codestream.

use heapless::Vec;
pub use postcard;
use serde::{Deserialize, Serialize};

use crate::{Header, SampleType, Wavelet};

/// What one codestream holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Entry {
    /// Position of the first sample in the volume, `[x, y, z]`.
    pub position: [u32; 3],
    /// Samples per axis, `[x, y, z]`.
    pub extent: [u32; 3],
    /// The type of the samples.
    pub sample_type: SampleType,
    /// The wavelet; of no meaning with 0 levels.
    pub wavelet: Wavelet,
    /// Levels of the transform.
    pub levels: u8,
    /// Bytes of the codestream.
    pub bytes: u64,
    /// Checksum of the codestream's bytes, by a rule that writer and reader agree on.
    pub checksum: u32,
}

impl Entry {
    /// The entry for a codestream with this header, of the brick at `position`.
    #[must_use]
    pub fn new(position: [u32; 3], header: &Header, checksum: u32) -> Self {
        let plan = header.plan();
        Self {
            position,
            extent: plan.extent().axes(),
            sample_type: header.sample_type(),
            wavelet: plan.wavelet(),
            levels: plan.levels(),
            bytes: header.encoded_bytes(),
            checksum,
        }
    }
}

/// The entries of up to `N` codestreams, in the order in which these follow each other.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct IndexRecord<const N: usize> {
    /// One per codestream.
    pub entries: Vec<Entry, N>,
}

impl<const N: usize> IndexRecord<N> {
    /// Bytes that always suffice for the record: a count, and 48 per entry.
    pub const MAX_BYTES: usize = N.saturating_mul(48).saturating_add(10);

    /// Writes the record to the beginning of `out` and returns it.
    ///
    /// # Errors
    /// [`postcard::Error::SerializeBufferFull`] if `out` is too short ([`Self::MAX_BYTES`] never is);
    /// its contents are meaningless then.
    pub fn to_slice<'o>(&self, out: &'o mut [u8]) -> Result<&'o mut [u8], postcard::Error> {
        postcard::to_slice(self, out)
    }

    /// Reads the record at the beginning of `bytes`, and returns it with the bytes after it.
    ///
    /// What the entries say is not compared with any codestream: trust the [`Header`] more.
    ///
    /// # Errors
    /// Any [`postcard::Error`] if `bytes` is not a record of at most `N` entries.
    pub fn from_bytes(bytes: &[u8]) -> Result<(Self, &[u8]), postcard::Error> {
        postcard::take_from_bytes(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Codec, Effort, Extent, Plan};

    const ENTRY: Entry = Entry {
        position: [0, 64, 300],
        extent: [64, 64, 17],
        sample_type: SampleType::U16,
        wavelet: Wavelet::Cubic,
        levels: 4,
        bytes: 70_000,
        checksum: 0xCBF4_3926,
    };

    const LARGEST: Entry = Entry {
        position: [u32::MAX; 3],
        extent: [u32::MAX; 3],
        sample_type: SampleType::I32,
        wavelet: Wavelet::Quintic,
        levels: u8::MAX,
        bytes: u64::MAX,
        checksum: u32::MAX,
    };

    /// Numbers take seven bits to a byte, enumerators and `u8` one byte.
    #[test]
    fn bytes_by_hand() {
        let record = IndexRecord::<1> { entries: [ENTRY].into_iter().collect() };
        let mut out = [0; IndexRecord::<1>::MAX_BYTES];
        #[rustfmt::skip]
        let expected = [
            1, // entry
            0, 64, 0xAC, 2, // position: 300 = 2 * 128 + 0x2C
            64, 64, 17, // extent
            2, 4, 4, // u16, psi_3, levels
            0xF0, 0xA2, 4, // bytes: 70,000 = (4 * 128 + 0x22) * 128 + 0x70
            0xA6, 0xF2, 0xD0, 0xDF, 0x0C, // checksum
        ];
        assert_eq!(record.to_slice(&mut out).unwrap(), expected);
        assert_eq!(IndexRecord::from_bytes(&expected), Ok((record, &[][..])));
    }

    #[test]
    fn the_largest_record_fits() {
        let record = IndexRecord::<3> { entries: [LARGEST; 3].into_iter().collect() };
        let mut out = [0; IndexRecord::<3>::MAX_BYTES];
        let len = record.to_slice(&mut out).unwrap().len();
        assert_eq!(len, 1 + 3 * 48);
        assert_eq!(IndexRecord::from_bytes(&out), Ok((record.clone(), &out[len..])));
        for room in 0..len {
            let error = postcard::Error::SerializeBufferFull;
            assert_eq!(record.to_slice(&mut out[..room]), Err(error));
        }
    }

    #[test]
    fn hostile_bytes_are_errors() {
        let record = IndexRecord::<2> { entries: [ENTRY, LARGEST].into_iter().collect() };
        let mut out = [0; IndexRecord::<2>::MAX_BYTES];
        let bytes = record.to_slice(&mut out).unwrap();
        assert!((0..bytes.len()).all(|end| IndexRecord::<2>::from_bytes(&bytes[..end]).is_err()));
        assert!(IndexRecord::<1>::from_bytes(bytes).is_err(), "two entries do not fit one");
        for position in 0..bytes.len() {
            for byte in 0..=u8::MAX {
                let before = core::mem::replace(&mut bytes[position], byte);
                let _ = IndexRecord::<2>::from_bytes(bytes);
                bytes[position] = before;
            }
        }
        bytes[8] = 6;
        assert!(IndexRecord::<2>::from_bytes(bytes).is_err(), "there is no sample type 6");
        assert!(IndexRecord::<2>::from_bytes(&[0xFF; 10]).is_err());
    }

    #[test]
    fn an_entry_says_what_the_header_says() {
        let plan = Plan::new(Wavelet::Haar, Extent::slice(8, 4).unwrap(), 2).unwrap();
        let (mut samples, mut scratch, mut out) = ([0; 32], [0; 256], [0; 64]);
        let mut codec = Codec::NEW;
        let len =
            codec.encode(Effort::Fast, &plan, SampleType::I8, &mut samples, &mut scratch, &mut out).unwrap();
        let entry = Entry::new([8, 0, 0], &Header::parse(&out).unwrap(), 7);
        let expected = Entry {
            position: [8, 0, 0],
            extent: [8, 4, 1],
            sample_type: SampleType::I8,
            wavelet: Wavelet::Haar,
            levels: 2,
            bytes: len.try_into().unwrap(),
            checksum: 7,
        };
        assert_eq!(entry, expected);
    }
}
