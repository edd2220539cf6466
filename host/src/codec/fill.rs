//! What stands for the samples of bricks that are lost.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use super::{Grid, Lost, Place};
use crate::volume::{ElementType, value_of_text};

/// One value, in the type of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fill {
    bytes: [u8; 8],
    len: usize,
}

/// A text that is no value of a type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{text}' is no value of {element}")]
pub struct NoSuchValue {
    text: String,
    element: ElementType,
}

impl Fill {
    /// What no sample is, where the type has such a thing: NaN; 0 for integers.
    pub fn usual(element: ElementType) -> Self {
        let zero = Self { bytes: [0; 8], len: element.bytes() };
        if element.is_float() { Self::of_text(element, "NaN").unwrap_or(zero) } else { zero }
    }

    /// A value that is written as text, exactly for integers, and to the nearest for floats.
    ///
    /// # Errors
    /// [`NoSuchValue`].
    pub fn of_text(element: ElementType, text: &str) -> Result<Self, NoSuchValue> {
        let bytes = value_of_text(element, text.trim());
        let len = element.bytes();
        bytes.map(|bytes| Self { bytes, len }).ok_or_else(|| NoSuchValue { text: text.to_owned(), element })
    }

    /// So many samples, little-endian.
    fn samples(&self, count: usize) -> Vec<u8> {
        self.bytes[..self.len].repeat(count)
    }
}

/// Lost bricks, as they are met while a part is read.
#[derive(Debug)]
pub(super) struct Holes {
    fill: Fill,
    lost: Mutex<BTreeMap<Place, Lost>>,
}

impl Holes {
    pub(super) const fn new(fill: Fill) -> Self {
        Self { fill, lost: Mutex::new(BTreeMap::new()) }
    }

    /// Takes note of a brick, and gives so many samples in its place.
    pub(super) fn stand_in(&self, place: Place, grid: &Grid, count: usize) -> Vec<u8> {
        let mut lost = self.lost.lock().unwrap_or_else(PoisonError::into_inner);
        lost.entry(place).or_insert_with(|| Lost::new(place, grid));
        self.fill.samples(count)
    }

    /// All that were met, in the order of the file.
    pub(super) fn into_lost(self) -> Vec<Lost> {
        self.lost.into_inner().unwrap_or_else(PoisonError::into_inner).into_values().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_their_type() {
        let samples = |element, text: &str| Fill::of_text(element, text).map(|fill| fill.samples(2));
        assert_eq!(samples(ElementType::I16, "-2").unwrap(), [0xFE, 0xFF, 0xFE, 0xFF]);
        assert_eq!(samples(ElementType::U64, "18446744073709551615").unwrap(), [0xFF; 16]);
        assert_eq!(samples(ElementType::F32, "1e0").unwrap(), [0, 0, 0x80, 0x3F, 0, 0, 0x80, 0x3F]);
        for (element, text) in [(ElementType::U8, "-1"), (ElementType::I32, "1.5"), (ElementType::F64, "x")] {
            let error = Fill::of_text(element, text).unwrap_err().to_string();
            assert!(error.contains(text) && error.ends_with(element.name()), "{error}");
        }
    }

    #[test]
    fn every_type_has_a_usual_value() {
        for element in ElementType::ALL {
            let samples = Fill::usual(element).samples(3);
            assert_eq!(samples.len(), 3 * element.bytes());
            assert_eq!(samples.iter().all(|byte| *byte == 0), !element.is_float());
        }
    }
}
