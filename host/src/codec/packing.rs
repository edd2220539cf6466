//! Packing of histograms: a volume with few distinct values, or with gaps between them, as numbers of values.
//!
//! Twelve-bit samples shifted to sixteen, a handful of labels, counts times a gain: predictors and models work on
//! the distance between *values that occur*, not between numbers that never do.

use serde::{Deserialize, Serialize};
use wavelift_kernel::SampleType;

use super::survey::MOST_VALUES;

/// How far the first value may be from the last for a table of all integers between.
const MOST_RANGE: usize = 1 << 16;

/// The values that occur in a volume, ascending; stored as the first and the steps to each next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "(i32, Vec<u32>)", into = "(i32, Vec<u32>)")]
pub struct Values {
    table: Vec<i32>,
}

impl From<Values> for (i32, Vec<u32>) {
    fn from(values: Values) -> Self {
        let steps = values.table.array_windows().map(|&[a, b]| b.wrapping_sub(a).cast_unsigned());
        (values.table[0], steps.collect())
    }
}

impl TryFrom<(i32, Vec<u32>)> for Values {
    type Error = &'static str;

    fn try_from((first, steps): (i32, Vec<u32>)) -> Result<Self, Self::Error> {
        const WRONG: &str = "values that do not ascend, or too many";
        if steps.len() >= MOST_VALUES || steps.contains(&0) {
            return Err(WRONG);
        }
        let mut table = vec![first];
        for step in steps {
            let last = table.last().copied().unwrap_or(first);
            table.push(i32::try_from(i64::from(last) + i64::from(step)).map_err(|_| WRONG)?);
        }
        Ok(Self { table })
    }
}

impl Values {
    /// Those values, which ascend and are at most 2^16. `None` if there are no gaps between them.
    pub(super) fn of(ascending: Vec<i32>) -> Option<Self> {
        let range = i64::from(*ascending.last()?) - i64::from(*ascending.first()?);
        (range + 1 > ascending.len() as i64).then_some(Self { table: ascending })
    }

    /// How many there are.
    pub const fn count(&self) -> usize {
        self.table.len()
    }

    /// The type of their numbers.
    pub(super) const fn sample_type(&self) -> SampleType {
        if self.table.len() <= 1 << 8 { SampleType::U8 } else { SampleType::U16 }
    }

    /// Replaces samples by the numbers of their values; `None` for a sample that is no value.
    ///
    /// Cost: a look into a table for each sample, where the values are within [`MOST_RANGE`] and the samples worth setting
    /// it up; else a search.
    pub(super) fn pack(&self, samples: &mut [i32]) -> Option<()> {
        if let Some(numbers) = self.numbers(samples.len()) {
            let first = *self.table.first()?;
            for sample in samples {
                let number = *numbers.get(sample.wrapping_sub(first).cast_unsigned() as usize)?;
                *sample = number.checked_sub(1)?.into();
            }
        } else {
            for sample in samples {
                *sample = self.table.binary_search(sample).ok()? as i32;
            }
        }
        Some(())
    }

    /// For each integer from the first value to the last one more than its number, or 0 where it is no value.
    fn numbers(&self, samples: usize) -> Option<Vec<u16>> {
        let (first, last) = (*self.table.first()?, *self.table.last()?);
        let range = usize::try_from(i64::from(last) - i64::from(first)).ok()?;
        if range > MOST_RANGE.min(samples) || self.count() > usize::from(u16::MAX) {
            return None;
        }
        let mut numbers = vec![0; range + 1];
        for (number, value) in (1..).zip(&self.table) {
            numbers[(value - first) as usize] = number;
        }
        Some(numbers)
    }

    /// Undoes [`Values::pack`]; `None` for a number without a value.
    pub(super) fn unpack(&self, samples: &mut [i32]) -> Option<()> {
        for sample in samples {
            *sample = *self.table.get(usize::try_from(*sample).ok()?)?;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back() {
        let values = Values::of(vec![-32_768, -5, 12, 300]).unwrap();
        assert_eq!(<(i32, Vec<u32>)>::from(values.clone()).try_into(), Ok(values.clone()));
        let samples = [300, -5, 300, 12, -32_768, 12];
        let mut packed = samples;
        values.pack(&mut packed).unwrap();
        assert_eq!(packed, [3, 1, 3, 2, 0, 2]);
        values.unpack(&mut packed).unwrap();
        assert_eq!(packed, samples);
        assert_eq!(
            (values.unpack(&mut [4]), values.unpack(&mut [-1]), values.pack(&mut [11])),
            (None, None, None)
        );
        assert_eq!(Values::of(vec![3, 4, 5]), None);
    }

    #[test]
    fn tables_and_searches_find_the_same() {
        let values = Values::of((-3000..3000).filter(|value| value % 7 != 3).collect()).unwrap();
        for samples in [vec![-3000, 2998, 5], (-3000..3000).filter(|value| value % 7 != 3).rev().collect()] {
            let mut packed = samples.clone();
            values.pack(&mut packed).unwrap();
            values.unpack(&mut packed).unwrap();
            assert_eq!(packed, samples);
        }
        for wrong in [-3001, 3000, 3, i32::MIN, i32::MAX] {
            assert_eq!(values.pack(&mut [wrong; 8000]), None, "{wrong}");
            assert_eq!(values.pack(&mut [wrong]), None, "{wrong}");
        }
    }

    #[test]
    fn extremes_and_nonsense() {
        let extremes = Values { table: vec![i32::MIN, 0, i32::MAX] };
        assert_eq!(<(i32, Vec<u32>)>::from(extremes.clone()).try_into(), Ok(extremes));
        for (first, steps) in [(i32::MAX, vec![1]), (0, vec![0]), (0, vec![1; MOST_VALUES])] {
            Values::try_from((first, steps)).unwrap_err();
        }
        assert_eq!(Values::try_from((0, vec![1; MOST_VALUES - 1])).unwrap().count(), MOST_VALUES);
    }
}
