//! The fields of NIfTI headers that say neither extent nor type: where they are, and their values as text.
//!
//! Source: `nifti1.h` (348 bytes) and `nifti2.h` (540 bytes) of the NIfTI Data Format Working Group.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::volume::{ByteOrder, Metadata};

/// What stands before the names of fields in keys of metadata.
pub(super) const PREFIX: &str = "nifti.";

/// Before the value of a text that is no UTF-8.
const BYTES: &str = "base64:";

/// The two layouts of headers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    One,
    Two,
}

impl Version {
    /// Bytes of a header.
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::One => 348,
            Self::Two => 540,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    U8,
    I16,
    I32,
    I64,
    F32,
    F64,
    Text(usize),
}

impl Kind {
    const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::I16 => 2,
            Self::I32 | Self::F32 => 4,
            Self::I64 | Self::F64 => 8,
            Self::Text(bytes) => bytes,
        }
    }
}

/// One field: its name, how many values it has, and where it is in the header of each version.
struct Field {
    name: &'static str,
    count: usize,
    one: Option<(usize, Kind)>,
    two: Option<(usize, Kind)>,
}

impl Field {
    const fn place(&self, version: Version) -> Option<(usize, Kind)> {
        match version {
            Version::One => self.one,
            Version::Two => self.two,
        }
    }
}

const fn both(name: &'static str, count: usize, one: (usize, Kind), two: (usize, Kind)) -> Field {
    Field { name, count, one: Some(one), two: Some(two) }
}

const fn first(name: &'static str, place: usize, kind: Kind) -> Field {
    Field { name, count: 1, one: Some((place, kind)), two: None }
}

use Kind::{F32, F64, I16, I32, I64, Text, U8};

static FIELDS: [Field; 31] = [
    first("data_type", 4, Text(10)),
    first("db_name", 14, Text(18)),
    first("extents", 32, I32),
    first("session_error", 36, I16),
    first("regular", 38, Text(1)),
    both("dim_info", 1, (39, U8), (524, U8)),
    both("intent_p", 3, (56, F32), (80, F64)),
    both("intent_code", 1, (68, I16), (504, I32)),
    both("slice_start", 1, (74, I16), (224, I64)),
    both("pixdim", 8, (76, F32), (104, F64)),
    both("scl_slope", 1, (112, F32), (176, F64)),
    both("scl_inter", 1, (116, F32), (184, F64)),
    both("slice_end", 1, (120, I16), (232, I64)),
    both("slice_code", 1, (122, U8), (496, I32)),
    both("xyzt_units", 1, (123, U8), (500, I32)),
    both("cal_max", 1, (124, F32), (192, F64)),
    both("cal_min", 1, (128, F32), (200, F64)),
    both("slice_duration", 1, (132, F32), (208, F64)),
    both("toffset", 1, (136, F32), (216, F64)),
    first("glmax", 140, I32),
    first("glmin", 144, I32),
    both("descrip", 1, (148, Text(80)), (240, Text(80))),
    both("aux_file", 1, (228, Text(24)), (320, Text(24))),
    both("qform_code", 1, (252, I16), (344, I32)),
    both("sform_code", 1, (254, I16), (348, I32)),
    both("quatern", 3, (256, F32), (352, F64)),
    both("qoffset", 3, (268, F32), (376, F64)),
    both("srow_x", 4, (280, F32), (400, F64)),
    both("srow_y", 4, (296, F32), (432, F64)),
    both("srow_z", 4, (312, F32), (464, F64)),
    both("intent_name", 1, (328, Text(16)), (508, Text(16))),
];

/// Values of fields by name, as text: numbers in the shortest decimals that give them again. What is all zero is
/// left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fields {
    values: Vec<(&'static str, String)>,
}

impl Fields {
    /// Reads the fields of a header, which has the bytes that its version needs.
    pub(super) fn of_bytes(header: &[u8], version: Version, order: ByteOrder) -> Self {
        let mut values = Vec::new();
        for field in &FIELDS {
            let Some((place, kind)) = field.place(version) else { continue };
            let bytes = &header[place..place + field.count * kind.bytes()];
            if bytes.iter().any(|byte| *byte != 0) {
                let words = bytes.chunks(kind.bytes()).map(|bytes| text_of(bytes, kind, order));
                values.push((field.name, words.collect::<Vec<_>>().join(" ")));
            }
        }
        Self { values }
    }

    /// The fields that pairs of metadata give.
    pub(super) fn of_metadata(metadata: &Metadata) -> Self {
        let value = |field: &Field| {
            let value = metadata.key_value(&format!("{PREFIX}{}", field.name))?;
            Some((field.name, value.to_owned()))
        };
        Self { values: FIELDS.iter().filter_map(value).collect() }
    }

    /// Whether a header has a field of this name.
    pub(super) fn is_name(name: &str) -> bool {
        FIELDS.iter().any(|field| field.name == name)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.values.iter().map(|(name, value)| (*name, value.as_str()))
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        self.iter().find(|(found, _)| *found == name).map(|(_, value)| value)
    }

    /// The numbers of a field, zeros where it is left out.
    pub(super) fn numbers<const COUNT: usize>(&self, name: &str) -> [f64; COUNT] {
        let mut words =
            self.text(name).unwrap_or_default().split(' ').map(|word| word.parse().unwrap_or(0.0));
        std::array::from_fn(|_| words.next().unwrap_or(0.0))
    }

    pub(super) fn set(&mut self, name: &'static str, value: String) {
        self.values.retain(|(found, _)| *found != name);
        self.values.push((name, value));
    }

    pub(super) fn set_numbers(&mut self, name: &'static str, numbers: &[f64]) {
        let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
        self.set(name, words.join(" "));
    }

    /// Writes the fields into a header; the names of those that do not fit.
    pub(super) fn write(&self, header: &mut [u8], version: Version, order: ByteOrder) -> Vec<&'static str> {
        let mut losses = Vec::new();
        for (name, value) in &self.values {
            let field = FIELDS.iter().find(|field| field.name == *name);
            let Some((field, (place, kind))) = field.and_then(|field| Some((field, field.place(version)?)))
            else {
                losses.push(*name);
                continue;
            };
            match bytes_of(value, field.count, kind, order) {
                Some(bytes) => header[place..place + bytes.len()].copy_from_slice(&bytes),
                None => losses.push(*name),
            }
        }
        losses
    }
}

fn text_of(bytes: &[u8], kind: Kind, order: ByteOrder) -> String {
    let number = number_bytes(bytes, order);
    match kind {
        U8 => bytes[0].to_string(),
        I16 => i16::from_le_bytes([number[0], number[1]]).to_string(),
        I32 => i32::from_le_bytes(*number.first_chunk().expect("eight bytes")).to_string(),
        I64 => i64::from_le_bytes(number).to_string(),
        F32 => f32::from_le_bytes(*number.first_chunk().expect("eight bytes")).to_string(),
        F64 => f64::from_le_bytes(number).to_string(),
        Text(_) => {
            let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
            match str::from_utf8(&bytes[..end]) {
                Ok(text) if !text.starts_with(BYTES) && !text.contains('\r') => text.to_owned(),
                _ => format!("{BYTES}{}", STANDARD.encode(&bytes[..end])),
            }
        }
    }
}

/// The bytes of one number, little-endian, zeros behind them.
fn number_bytes(bytes: &[u8], order: ByteOrder) -> [u8; 8] {
    let mut number = [0; 8];
    for (to, from) in number.iter_mut().zip(bytes) {
        *to = *from;
    }
    if order == ByteOrder::Big && bytes.len() <= 8 {
        number[..bytes.len()].reverse();
    }
    number
}

/// The bytes of `count` values; `None` if the text is none of this kind, or too long.
fn bytes_of(text: &str, count: usize, kind: Kind, order: ByteOrder) -> Option<Vec<u8>> {
    if let Text(most) = kind {
        let mut bytes = match text.strip_prefix(BYTES) {
            Some(encoded) => STANDARD.decode(encoded).ok()?,
            None => text.as_bytes().to_vec(),
        };
        let fits = bytes.len() <= most;
        bytes.resize(most, 0);
        return fits.then_some(bytes);
    }
    let mut bytes = Vec::new();
    for word in text.split(' ') {
        let mut number = match kind {
            U8 => vec![word.parse().ok()?],
            I16 => word.parse::<i16>().ok()?.to_le_bytes().to_vec(),
            I32 => word.parse::<i32>().ok()?.to_le_bytes().to_vec(),
            I64 => word.parse::<i64>().ok()?.to_le_bytes().to_vec(),
            F32 => word.parse::<f32>().ok()?.to_le_bytes().to_vec(),
            F64 | Text(_) => word.parse::<f64>().ok()?.to_le_bytes().to_vec(),
        };
        if order == ByteOrder::Big {
            number.reverse();
        }
        bytes.extend(number);
    }
    (bytes.len() == count * kind.bytes()).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_lie_beside_each_other_and_within_the_header() {
        for version in [Version::One, Version::Two] {
            let mut ends = 4;
            let mut places: Vec<_> =
                FIELDS.iter().filter_map(|field| Some((field, field.place(version)?))).collect();
            places.sort_by_key(|(_, (place, _))| *place);
            for (field, (place, kind)) in places {
                assert!(place >= ends, "{}", field.name);
                ends = place + field.count * kind.bytes();
            }
            assert!(ends <= version.bytes());
        }
    }

    #[test]
    fn every_bit_of_every_field_comes_back() {
        for version in [Version::One, Version::Two] {
            for order in [ByteOrder::Little, ByteOrder::Big] {
                let mut header = vec![0; version.bytes()];
                for (index, field) in FIELDS.iter().enumerate() {
                    let Some((place, kind)) = field.place(version) else { continue };
                    for (at, byte) in header[place..place + field.count * kind.bytes()].iter_mut().enumerate()
                    {
                        *byte = (7 * index + 13 * at + 1) as u8 & 0x7f | 1;
                    }
                }
                let fields = Fields::of_bytes(&header, version, order);
                let mut again = vec![0; version.bytes()];
                assert!(fields.write(&mut again, version, order).is_empty());
                assert_eq!(again, header);
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let mut fields = Fields::default();
        fields.set("slice_start", "40000".to_owned());
        fields.set("descrip", "x".repeat(81));
        fields.set("pixdim", "1 2 3".to_owned());
        fields.set("cal_max", "many".to_owned());
        fields.set("glmax", "3".to_owned());
        fields.set("aux_file", "base64:!".to_owned());
        let mut header = vec![0; 540];
        let told = fields.write(&mut header[..348], Version::One, ByteOrder::Big);
        assert_eq!(told, ["slice_start", "descrip", "pixdim", "cal_max", "aux_file"]);
        let told = fields.write(&mut header, Version::Two, ByteOrder::Big);
        assert_eq!(told, ["descrip", "pixdim", "cal_max", "glmax", "aux_file"]);
    }
}
