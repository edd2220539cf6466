//! Packing of histograms: a volume with few distinct values, or with gaps between them, as numbers of values.
//!
//! Twelve-bit samples shifted to sixteen, a handful of labels, counts times a gain: predictors and models work on
//! the distance between *values that occur*, not between numbers that never do.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use wavelift_kernel::SampleType;

use super::planes;
use crate::volume::{ElementType, Volume};

/// The most values that are packed: their numbers take 16 bits.
const MOST: usize = 1 << 16;

/// The values that occur in a volume, ascending, as the first and the steps to each next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Values {
    first: i32,
    steps: Vec<u32>,
}

impl Values {
    /// The values of a volume, if there are few enough of them and gaps between them.
    pub(super) fn of(volume: &Volume) -> Option<Vec<i32>> {
        let [_] = planes::sample_types(volume.element) else { return None };
        let values = match volume.element.bytes() {
            1 | 2 => by_marking(volume),
            _ => by_collecting(volume)?,
        };
        let range = i64::from(*values.last()?) - i64::from(*values.first()?);
        (range + 1 > values.len() as i64).then_some(values)
    }

    /// What goes into the index.
    pub(super) fn new(values: &[i32]) -> Option<Self> {
        let steps = values.windows(2).map(|pair| pair[1].wrapping_sub(pair[0]).cast_unsigned());
        Some(Self { first: *values.first()?, steps: steps.collect() })
    }

    /// The values again; `None` for what no volume packs to.
    pub(super) fn table(&self) -> Option<Vec<i32>> {
        let mut values = vec![self.first];
        for &step in &self.steps {
            let next = i32::try_from(i64::from(*values.last()?) + i64::from(step)).ok()?;
            values.push(next);
        }
        (values.len() <= MOST && !self.steps.contains(&0)).then_some(values)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.steps.len() + 1
    }
}

/// The type of the numbers of `values`.
pub(super) const fn sample_type(values: &[i32]) -> SampleType {
    if values.len() <= 1 << 8 { SampleType::U8 } else { SampleType::U16 }
}

/// Replaces samples by the numbers of their values.
pub(super) fn pack(values: &[i32], samples: &mut [i32]) {
    for sample in samples {
        *sample = values.partition_point(|value| value < sample) as i32;
    }
}

/// Undoes [`pack`]; `None` for a number without a value.
pub(super) fn unpack(values: &[i32], samples: &mut [i32]) -> Option<()> {
    for sample in samples {
        *sample = *values.get(usize::try_from(*sample).ok()?)?;
    }
    Some(())
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

/// The types of the planes of an element whose samples may be packed.
pub(super) fn sample_types(element: ElementType, values: Option<&[i32]>) -> Vec<SampleType> {
    values.map_or_else(|| planes::sample_types(element).to_vec(), |values| vec![sample_type(values)])
}

#[cfg(test)]
mod tests {
    use super::*;
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
            assert_eq!(values, [-32_768, -5, 12, 300]);
            assert_eq!(Values::new(&values).unwrap().table().unwrap(), values);
            let mut packed = samples;
            pack(&values, &mut packed);
            assert_eq!(packed, [3, 1, 3, 2, 0, 2]);
            unpack(&values, &mut packed).unwrap();
            assert_eq!(packed, samples);
            assert_eq!(unpack(&values, &mut [4]), None);
            assert_eq!(unpack(&values, &mut [-1]), None);
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
        let extremes = [i32::MIN, 0, i32::MAX];
        assert_eq!(Values::new(&extremes).unwrap().table().unwrap(), extremes);
        assert_eq!(Values { first: i32::MAX, steps: vec![1] }.table(), None);
        assert_eq!(Values { first: 0, steps: vec![0] }.table(), None);
        assert_eq!(Values { first: 0, steps: vec![1; MOST] }.table(), None);
    }
}
