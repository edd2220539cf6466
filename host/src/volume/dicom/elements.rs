//! Data elements to be written: implicit representation, little-endian.
//!
//! Source: DICOM PS3.5, sections 6.2 (padding), 7.1.3 (implicit representation), 7.5 (sequences) and B.2 (identifiers made
//! of numbers of 128 bits); PS3.10, section 7.1 (the first group). Of a text without its representation nobody needs to know
//! which kind it is, so that elements go on that this program has never heard of.

use std::collections::BTreeMap;

use hmac_sha256::Hash;

use super::dataset::{ITEM, SEQUENCE_END, Tag, UNDEFINED};

/// The transfer syntax.
const IMPLICIT: &str = "1.2.840.10008.1.2";

/// This program.
const PROGRAM: &str = "2.25.319104367093820187450934510823715026483";

/// Elements with their values, in the order of their tags.
#[derive(Clone, Debug, Default)]
pub(super) struct Elements(BTreeMap<Tag, Value>);

/// A value, or the items of a sequence.
#[derive(Clone, Debug)]
enum Value {
    Plain(Vec<u8>),
    Items(Vec<u8>),
}

impl Elements {
    /// Sets a text. What looks like an identifier is made even with a zero, all else with a blank.
    pub(super) fn text(&mut self, tag: Tag, value: &str) {
        let mut bytes = value.as_bytes().to_vec();
        if bytes.len() % 2 == 1 {
            bytes.push(if is_uid(value) { 0 } else { b' ' });
        }
        self.bytes(tag, bytes);
    }

    /// Whether there is such an element.
    pub(super) fn has(&self, tag: Tag) -> bool {
        self.0.contains_key(&tag)
    }

    /// Sets a text, unless there is one.
    pub(super) fn supply(&mut self, tag: Tag, value: &str) {
        if !self.has(tag) {
            self.text(tag, value);
        }
    }

    /// Sets numbers of 16 bits.
    pub(super) fn numbers(&mut self, tag: Tag, values: &[u16]) {
        self.bytes(tag, values.iter().flat_map(|value| value.to_le_bytes()).collect());
    }

    /// Sets a value as it is.
    pub(super) fn bytes(&mut self, tag: Tag, value: Vec<u8>) {
        self.0.insert(tag, Value::Plain(value));
    }

    /// Sets a sequence.
    pub(super) fn sequence(&mut self, tag: Tag, items: &[Self]) {
        let mut bytes = Vec::new();
        for item in items {
            let item = item.encoded();
            head(&mut bytes, ITEM, item.len() as u32);
            bytes.extend(item);
        }
        self.0.insert(tag, Value::Items(bytes));
    }

    /// All of them, one after another.
    pub(super) fn encoded(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (tag, value) in &self.0 {
            match value {
                Value::Plain(value) => {
                    head(&mut bytes, *tag, value.len() as u32);
                    bytes.extend(value);
                }
                // Without a length, so that it can be told from a value.
                Value::Items(items) => {
                    head(&mut bytes, *tag, UNDEFINED);
                    bytes.extend(items);
                    head(&mut bytes, SEQUENCE_END, 0);
                }
            }
        }
        bytes
    }

    /// Takes others in.
    pub(super) fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    /// Whether a text has other letters than ASCII's.
    pub(super) fn has_letters_beyond_ascii(&self) -> bool {
        self.0.values().any(|value| matches!(value, Value::Plain(value) if !value.is_ascii() && str::from_utf8(value).is_ok()))
    }
}

/// A number of digits and dots.
fn is_uid(value: &str) -> bool {
    value.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.') && value.matches('.').count() > 1
}

/// Tag and length of an element whose value follows.
pub(super) fn head(out: &mut Vec<u8>, tag: Tag, length: u32) {
    out.extend([(tag >> 16) as u16, tag as u16].into_iter().flat_map(u16::to_le_bytes));
    out.extend(length.to_le_bytes());
}

/// What a file of an object of that class begins with.
pub(super) fn beginning(class: &str, instance: &str) -> Vec<u8> {
    let mut group = Vec::new();
    let explicit = |out: &mut Vec<u8>, element: u16, vr: &[u8; 2], length: &[u8], value: &[u8]| {
        out.extend([2, element].into_iter().flat_map(u16::to_le_bytes));
        out.extend(vr);
        out.extend(length);
        out.extend(value);
    };
    explicit(&mut group, 1, b"OB", &[0, 0, 2, 0, 0, 0], &[0, 1]);
    for (tag, uid) in [(2, class), (3, instance), (0x10, IMPLICIT), (0x12, PROGRAM)] {
        let mut value = uid.as_bytes().to_vec();
        value.resize(value.len().next_multiple_of(2), 0);
        explicit(&mut group, tag, b"UI", &(value.len() as u16).to_le_bytes(), &value);
    }
    let mut bytes = vec![0; 128];
    bytes.extend(b"DICM");
    explicit(&mut bytes, 0, b"UL", &[4, 0], &(group.len() as u32).to_le_bytes());
    bytes.extend(group);
    bytes
}

/// An identifier made of what it stands for, so that equal contents have equal ones and others have others. All have the
/// same length.
pub(super) fn uid_of(parts: &[&[u8]]) -> String {
    let mut hash = Hash::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    let digest = hash.finalize();
    let number = digest[..16].iter().fold(0, |number: u128, byte| number << 8 | u128::from(*byte));
    // Version and variant of a UUID of one's own making (RFC 9562, 5.8), and as many digits for each.
    let number = number & !(0xF << 76 | 0x3 << 62) | 8 << 76 | 2 << 62 | 1 << 127;
    format!("2.25.{number}")
}

/// A number in at most sixteen letters, as decimal texts are.
pub(super) fn decimal(value: f64) -> String {
    let value = value + 0.0;
    let shortest = value.to_string();
    let mut rounded = (0..=15).rev().flat_map(|places| {
        let fixed = format!("{value:.places$}");
        [fixed, format!("{value:.places$e}")]
    });
    if shortest.len() <= 16 {
        return shortest;
    }
    let is_close = |text: &String| {
        let found: f64 = text.parse().unwrap_or(f64::NAN);
        text.len() <= 16 && (found - value).abs() <= value.abs() * 1e-8
    };
    rounded.find(is_close).unwrap_or_else(|| format!("{value:.8e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_short_and_close() {
        for value in
            [0.0, -0.0, 1.5, -123.0, 0.1 + 0.2, 1e-300, -1.234_567_890_123_456e200, 1e15 + 0.3, f64::MAX]
        {
            let text = decimal(value);
            assert!(text.len() <= 16, "{text}");
            let found: f64 = text.parse().unwrap();
            assert!((found - value).abs() <= value.abs() * 1e-8, "{value} {text}");
        }
        assert_eq!(decimal(0.5), "0.5");
    }

    #[test]
    fn identifiers_follow_from_what_they_stand_for() {
        let [one, again, other] = [uid_of(&[b"ab", b"c"]), uid_of(&[b"ab", b"c"]), uid_of(&[b"a", b"bc"])];
        assert!(one == again && one != other && is_uid(&one) && one.len() == 44, "{one} {other}");
        let number: u128 = one.strip_prefix("2.25.").unwrap().parse().unwrap();
        assert_eq!((number >> 76 & 0xF, number >> 62 & 3), (8, 2));
    }
}
