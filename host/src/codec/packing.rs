//! Packing of histograms: a volume with few distinct values, or with gaps between them, as numbers of values.
//!
//! Twelve-bit samples shifted to sixteen, a handful of labels, counts times a gain: predictors and models work on
//! the distance between *values that occur*, not between numbers that never do.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use wavelift_kernel::SampleType;

use super::planes;
use crate::volume::Volume;

/// The most values that are packed: their numbers take 16 bits.
const MOST: usize = 1 << 16;

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
        if steps.len() >= MOST || steps.contains(&0) {
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
    /// The values of a volume, if there are few enough of them and gaps between them.
    pub(super) fn of(volume: &Volume) -> Option<Self> {
        let [_] = planes::sample_types(volume.element) else { return None };
        let values = match volume.element.bytes() {
            1 | 2 => by_marking(volume),
            _ => by_collecting(volume)?,
        };
        let range = i64::from(*values.last()?) - i64::from(*values.first()?);
        (range + 1 > values.len() as i64).then_some(Self { table: values })
    }

    /// How many there are.
    pub const fn count(&self) -> usize {
        self.table.len()
    }

    /// The type of their numbers.
    pub(super) const fn sample_type(&self) -> SampleType {
        if self.table.len() <= 1 << 8 { SampleType::U8 } else { SampleType::U16 }
    }

    /// Replaces samples by the numbers of their values.
    pub(super) fn pack(&self, samples: &mut [i32]) {
        for sample in samples {
            *sample = self.table.partition_point(|value| value < sample) as i32;
        }
    }

    /// Undoes [`Values::pack`]; `None` for a number without a value.
    pub(super) fn unpack(&self, samples: &mut [i32]) -> Option<()> {
        for sample in samples {
            *sample = *self.table.get(usize::try_from(*sample).ok()?)?;
        }
        Some(())
    }
}

/// The distinct values of a type of at most 16 bits.
fn by_marking(volume: &Volume) -> Vec<i32> {
    const OFFSET: i32 = 1 << 15;
    let mut seen = vec![false; 3 << 15];
    each_sample(volume, |sample| {
        seen[(sample + OFFSET) as usize] = true;
        true
    });
    let values = (-OFFSET..).zip(seen).filter(|&(_, seen)| seen);
    values.map(|(value, _)| value).collect()
}

/// The distinct values of any type, unless they are too many.
fn by_collecting(volume: &Volume) -> Option<Vec<i32>> {
    let mut seen = BTreeSet::new();
    each_sample(volume, |sample| {
        seen.insert(sample);
        seen.len() <= MOST
    });
    (seen.len() <= MOST).then(|| seen.into_iter().collect())
}

/// Calls `look` with every sample, as the first plane holds it, until it wants no more.
fn each_sample(volume: &Volume, mut look: impl FnMut(i32) -> bool) {
    const BATCH: usize = 1 << 12;
    let mut samples = vec![0; BATCH];
    for bytes in volume.samples.chunks(BATCH * volume.element.bytes()) {
        planes::split(volume.element, 0, bytes, &mut samples);
        if !samples[..bytes.len() / volume.element.bytes()].iter().all(|&sample| look(sample)) {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::ElementType;
    use crate::volume::synthetic::{Kind, generate};

    fn volume(element: ElementType, samples: &[i32]) -> Volume {
        let bytes = samples.iter().flat_map(|sample| sample.to_le_bytes()[..element.bytes()].to_vec());
        let mut volume = generate(Kind::Constant, [samples.len() as u64, 1, 1], element, 1);
        volume.samples = bytes.collect();
        volume
    }

    #[test]
    fn values_are_found_and_come_back() {
        for element in [ElementType::I16, ElementType::I32] {
            let samples = [300, -5, 300, 12, -32_768, 12];
            let values = Values::of(&volume(element, &samples)).unwrap();
            assert_eq!(values.table, [-32_768, -5, 12, 300]);
            assert_eq!(<(i32, Vec<u32>)>::from(values.clone()).try_into(), Ok(values.clone()));
            let mut packed = samples;
            values.pack(&mut packed);
            assert_eq!(packed, [3, 1, 3, 2, 0, 2]);
            values.unpack(&mut packed).unwrap();
            assert_eq!(packed, samples);
            assert_eq!(values.unpack(&mut [4]), None);
            assert_eq!(values.unpack(&mut [-1]), None);
        }
    }

    #[test]
    fn histograms_without_gaps_are_left_alone() {
        assert_eq!(Values::of(&volume(ElementType::U8, &[3, 4, 5, 4])), None);
        assert_eq!(Values::of(&volume(ElementType::U16, &[7, 7])), None);
        let many: Vec<i32> = (0..70_000).map(|i| 3 * i).collect();
        assert_eq!(Values::of(&volume(ElementType::I32, &many)), None);
    }

    #[test]
    fn extremes_and_nonsense() {
        let extremes = Values { table: vec![i32::MIN, 0, i32::MAX] };
        assert_eq!(<(i32, Vec<u32>)>::from(extremes.clone()).try_into(), Ok(extremes));
        for (first, steps) in [(i32::MAX, vec![1]), (0, vec![0]), (0, vec![1; MOST])] {
            Values::try_from((first, steps)).unwrap_err();
        }
        assert_eq!(Values::try_from((0, vec![1; MOST - 1])).unwrap().count(), MOST);
    }
}
