//! The header of a file; the format is in `docs/surface.md`.

use super::error::DecodeError;
use crate::surface_wavelet::Basis;

/// The version of the format that is written, and the only one read.
pub(super) const VERSION: u8 = 1;

const MAGIC: [u8; 4] = *b"wLsf";

/// The most levels there may be.
pub(super) const MOST_LEVELS: u32 = 16;

const LOSSLESS: u8 = 4;
const FEATURES: u8 = 8;
const REGIONS: u8 = 16;

/// A run of bytes and its checksum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Segment {
    pub(super) len: u32,
    pub(super) crc: u32,
}

impl Segment {
    pub(super) fn of(bytes: &[u8]) -> Self {
        Self { len: bytes.len() as u32, crc: crc32fast::hash(bytes) }
    }

    /// Whether these are its bytes, all of them.
    pub(super) fn holds(self, bytes: &[u8]) -> bool {
        bytes.len() == self.len as usize && crc32fast::hash(bytes) == self.crc
    }
}

/// What a file says of itself.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) basis: Basis,
    pub(super) lossless: bool,
    pub(super) has_features: bool,
    pub(super) levels: u32,
    /// Tangential parts are coded in steps 2 to this power as coarse.
    pub(super) tangential: u8,
    /// The step of quantization, or the unit of integer coordinates.
    pub(super) step: f64,
    /// Vertices, faces and corners of the base mesh.
    pub(super) numbers: [u32; 3],
    /// If there are regions, how many faces of the base mesh make up each.
    pub(super) faces_per_region: Option<u32>,
    pub(super) base: Segment,
    /// What all regions share, or everything; then one a region.
    pub(super) parts: Vec<Segment>,
}

/// Reads fields one after another.
struct Fields<'a> {
    bytes: &'a [u8],
    taken: usize,
}

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let needed = self.taken + N;
        let field = self.bytes.get(self.taken..needed).and_then(|field| field.try_into().ok());
        self.taken = needed;
        field.ok_or(DecodeError::Truncated { needed })
    }

    /// Seven bits a byte, low ones first; the highest bit says that more follow.
    fn number(&mut self) -> Result<u32, DecodeError> {
        let mut number = 0_u32;
        for place in 0..5 {
            let [byte] = self.take()?;
            let part = u32::from(byte & 0x7F);
            if place == 4 && byte > 0x0F {
                break;
            }
            number |= part << (7 * place);
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(DecodeError::Malformed { what: "a number of its header is too long" })
    }

    fn segment(&mut self) -> Result<Segment, DecodeError> {
        Ok(Segment { len: self.number()?, crc: u32::from_le_bytes(self.take()?) })
    }
}

fn push_number(bytes: &mut Vec<u8>, mut number: u32) {
    while number > 0x7F {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

impl Header {
    /// Number of regions.
    pub(super) fn regions(&self) -> usize {
        self.faces_per_region.map_or(0, |faces| self.numbers[1].div_ceil(faces) as usize)
    }

    /// Its bytes, a checksum at the end.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let basis = Basis::ALL.iter().position(|basis| *basis == self.basis).unwrap_or(0) as u8;
        let flag = |set: bool, flag: u8| if set { flag } else { 0 };
        let regions = self.faces_per_region.is_some();
        let flags = basis
            | flag(self.lossless, LOSSLESS)
            | flag(self.has_features, FEATURES)
            | flag(regions, REGIONS);
        let mut bytes = MAGIC.to_vec();
        bytes.extend([VERSION, flags, self.levels as u8, self.tangential]);
        bytes.extend(self.step.to_le_bytes());
        self.numbers.iter().chain(&self.faces_per_region).for_each(|&number| push_number(&mut bytes, number));
        for segment in std::iter::once(&self.base).chain(&self.parts) {
            push_number(&mut bytes, segment.len);
            bytes.extend(segment.crc.to_le_bytes());
        }
        let crc = crc32fast::hash(&bytes);
        bytes.extend(crc.to_le_bytes());
        bytes
    }

    /// Reads and checks a header, and tells its length.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, usize), DecodeError> {
        let mut fields = Fields { bytes, taken: 0 };
        let magic: [u8; 4] = fields.take()?;
        if magic != MAGIC {
            return Err(DecodeError::Magic);
        }
        let [version, flags, levels, tangential] = fields.take()?;
        if version != VERSION {
            return Err(DecodeError::Version { version });
        }
        let malformed = |what| DecodeError::Malformed { what };
        let basis = Basis::ALL.get(usize::from(flags & 3)).copied();
        let basis = basis.filter(|_| flags < 32).ok_or(malformed("its basis or flags are unknown"))?;
        let step = f64::from_le_bytes(fields.take()?);
        let numbers = [fields.number()?, fields.number()?, fields.number()?];
        let faces_per_region = if flags & REGIONS != 0 { Some(fields.number()?) } else { None };
        if faces_per_region == Some(0) || numbers.contains(&0) {
            return Err(malformed("its base mesh or its regions are empty"));
        }
        let base = fields.segment()?;
        let mut header = Self {
            basis,
            lossless: flags & LOSSLESS != 0,
            has_features: flags & FEATURES != 0,
            levels: levels.into(),
            tangential,
            step,
            numbers,
            faces_per_region,
            base,
            parts: Vec::new(),
        };
        for _ in 0..=header.regions() {
            header.parts.push(fields.segment()?);
        }
        let crc = crc32fast::hash(&bytes[..fields.taken]);
        if u32::from_le_bytes(fields.take()?) != crc {
            return Err(DecodeError::Checksum { part: "header" });
        }
        let is_step = step.is_finite() && step > 0.0;
        if !is_step || header.levels > MOST_LEVELS || tangential > 16 {
            return Err(malformed("its step, levels or tangential steps are out of range"));
        }
        Ok((header, fields.taken))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        Header {
            basis: Basis::Bicubic,
            lossless: false,
            has_features: true,
            levels: 5,
            tangential: 2,
            step: 0.25,
            numbers: [200, 198, 800],
            faces_per_region: Some(100),
            base: Segment { len: 300, crc: 7 },
            parts: vec![Segment { len: 1 << 20, crc: 1 }, Segment::default(), Segment { len: 5, crc: 9 }],
        }
    }

    #[test]
    fn headers_are_restored() {
        let bytes = header().to_bytes();
        assert_eq!(Header::parse(&bytes), Ok((header(), bytes.len())));
        assert_eq!(Header::parse(&[&bytes[..], &[1; 9]].concat()), Ok((header(), bytes.len())));
    }

    #[test]
    fn damage_is_noticed() {
        let bytes = header().to_bytes();
        for place in 0..bytes.len() {
            assert!(matches!(Header::parse(&bytes[..place]), Err(DecodeError::Truncated { .. })));
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[place] ^= 1 << bit;
                assert!(Header::parse(&damaged).is_err());
            }
        }
    }
}
