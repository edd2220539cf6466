//! What is to be known of a volume before its bricks are coded: gathered in one pass, in parts of any size.

use super::{Values, planes};
use crate::bound::{FiniteRange, Profile, samples_of};
use crate::volume::ElementType;

/// The most values that are packed: their numbers take 16 bits.
pub(super) const MOST_VALUES: usize = 1 << 16;

/// What is to be known of the values of a volume. It does not matter in which parts they come, if only in their order.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    element: ElementType,
    /// The smallest and the largest of integers of more than 16 bits.
    ends: Option<[i128; 2]>,
    /// Those that occur, of a type of one plane, unless they are too many.
    distinct: Distinct,
    /// Of floats.
    profile: Option<Profile>,
}

/// The values that occur, as the first plane holds them.
#[derive(Clone, Debug)]
enum Distinct {
    /// Of at most 16 bits: which there are, from the smallest that there may be on.
    Marked {
        smallest: i32,
        marks: Vec<bool>,
    },
    /// Ascending.
    Collected(Vec<i32>),
    TooMany,
}

impl Survey {
    /// Of no value yet, of a volume of `total`.
    pub(super) fn new(element: ElementType, total: u64) -> Self {
        let distinct = match (planes::sample_types(element), element.bytes()) {
            ([_], bytes @ (1 | 2)) => {
                let half = if element.is_signed_integer() { 1 << (8 * bytes - 1) } else { 0 };
                Distinct::Marked { smallest: -half, marks: vec![false; 1 << (8 * bytes)] }
            }
            ([_], _) => Distinct::Collected(Vec::new()),
            _ => Distinct::TooMany,
        };
        let profile = match element {
            ElementType::F32 => Some(Profile::new::<f32>(total)),
            ElementType::F64 => Some(Profile::new::<f64>(total)),
            _ => None,
        };
        Self { element, ends: None, distinct, profile }
    }

    /// A survey of values that follow these: what is settled already is left out.
    pub(super) fn next(&self) -> Self {
        let distinct = match &self.distinct {
            Distinct::Marked { smallest, marks } => {
                Distinct::Marked { smallest: *smallest, marks: vec![false; marks.len()] }
            }
            Distinct::Collected(_) => Distinct::Collected(Vec::new()),
            Distinct::TooMany => Distinct::TooMany,
        };
        Self {
            element: self.element,
            ends: None,
            distinct,
            profile: self.profile.as_ref().map(Profile::next),
        }
    }

    /// Adds little-endian values that come next.
    pub(super) fn add(&mut self, bytes: &[u8]) {
        match (&mut self.profile, self.element) {
            (Some(profile), ElementType::F32) => profile.add(samples_of::<f32>(bytes)),
            (Some(profile), _) => profile.add(samples_of::<f64>(bytes)),
            (None, _) if matches!(self.distinct, Distinct::Marked { .. }) => {}
            (None, _) => {
                if let Some(ends) = ends(self.element, bytes) {
                    self.widen(ends);
                }
            }
        }
        self.distinct.add(self.element, bytes);
    }

    /// Adds the survey of values that come next.
    pub(super) fn append(&mut self, later: &Self) {
        if let Some(ends) = later.ends {
            self.widen(ends);
        }
        if let (Some(profile), Some(later)) = (&mut self.profile, &later.profile) {
            profile.append(later);
        }
        self.distinct.append(&later.distinct);
    }

    fn widen(&mut self, [low, high]: [i128; 2]) {
        let [min, max] = self.ends.unwrap_or([low, high]);
        self.ends = Some([min.min(low), max.max(high)]);
    }

    /// The range of the finite values. Of integers, its width is exact but for one rounding, and its place is not told:
    /// it begins at 0.
    pub(super) fn range(&self) -> FiniteRange {
        match (&self.profile, self.ends()) {
            (Some(profile), _) => profile.range(),
            (None, ends) => FiniteRange { min: 0.0, max: ends.map_or(0.0, |[min, max]| (max - min) as f64) },
        }
    }

    /// The largest integer.
    pub(super) fn largest(&self) -> i128 {
        self.ends().map_or(0, |[_, max]| max)
    }

    /// The smallest and the largest integer.
    fn ends(&self) -> Option<[i128; 2]> {
        let Distinct::Marked { smallest, marks } = &self.distinct else { return self.ends };
        let ends = [marks.iter().position(|mark| *mark)?, marks.iter().rposition(|mark| *mark)?];
        Some(ends.map(|place| i128::from(*smallest) + place as i128))
    }

    /// What is to be known of floats.
    pub(super) const fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref()
    }

    /// The values that occur, if there are few enough of them and gaps between them.
    pub(super) fn values(&self) -> Option<Values> {
        Values::of(self.distinct.ascending()?)
    }
}

impl Distinct {
    fn add(&mut self, element: ElementType, bytes: &[u8]) {
        let samples = || {
            let mut samples = vec![0; bytes.len() / element.bytes()];
            planes::split(element, 0, bytes, &mut samples);
            samples
        };
        match self {
            Self::Marked { smallest, marks } => {
                // The bits of the smallest, which turn the order of bits into that of values.
                let smallest = smallest.unsigned_abs() as usize;
                match element.bytes() {
                    1 => bytes.iter().for_each(|&byte| marks[usize::from(byte) ^ smallest] = true),
                    _ => {
                        let values = bytes.as_chunks().0.iter().map(|&bytes| u16::from_le_bytes(bytes));
                        values.for_each(|value| marks[usize::from(value) ^ smallest] = true);
                    }
                }
            }
            Self::Collected(values) => {
                let mut samples = samples();
                if are_many(&samples) {
                    *self = Self::TooMany;
                    return;
                }
                samples.sort_unstable();
                samples.dedup();
                merge(values, &samples);
                self.settle();
            }
            Self::TooMany => {}
        }
    }

    fn append(&mut self, later: &Self) {
        match (&mut *self, later) {
            (Self::Marked { marks, .. }, Self::Marked { marks: later, .. }) => {
                marks.iter_mut().zip(later).for_each(|(mark, later)| *mark |= later);
            }
            (Self::Collected(values), Self::Collected(later)) => merge(values, later),
            _ => *self = Self::TooMany,
        }
        self.settle();
    }

    fn settle(&mut self) {
        if matches!(self, Self::Collected(values) if values.len() > MOST_VALUES) {
            *self = Self::TooMany;
        }
    }

    fn ascending(&self) -> Option<Vec<i32>> {
        match self {
            Self::Marked { smallest, marks } => {
                let values = (*smallest..).zip(marks).filter(|&(_, &mark)| mark);
                Some(values.map(|(value, _)| value).collect())
            }
            Self::Collected(values) => Some(values.clone()),
            Self::TooMany => None,
        }
    }
}

/// Whether there are more than [`MOST_VALUES`] for certain: that many places of a table are met, where equal samples meet
/// the same. Far quicker than to sort them.
fn are_many(samples: &[i32]) -> bool {
    const PLACE_BITS: u32 = 20;
    // The golden section of 2^32, which spreads neighbours (Knuth, The Art of Computer Programming, 6.4).
    const SPREAD: u32 = 0x9E37_79B9;
    if samples.len() <= MOST_VALUES {
        return false;
    }
    let mut places = vec![false; 1 << PLACE_BITS];
    let mut met = 0;
    samples.iter().any(|sample| {
        let place = (sample.cast_unsigned().wrapping_mul(SPREAD) >> (u32::BITS - PLACE_BITS)) as usize;
        met += usize::from(!std::mem::replace(&mut places[place], true));
        met > MOST_VALUES
    })
}

/// Adds values to others, both ascending.
fn merge(values: &mut Vec<i32>, others: &[i32]) {
    values.extend(others);
    // Quick, as it finds both runs.
    values.sort();
    values.dedup();
}

/// The smallest and the largest of little-endian integers.
fn ends(element: ElementType, bytes: &[u8]) -> Option<[i128; 2]> {
    macro_rules! ends {
        ($($variant:ident => $type:ty),+) => {
            match element {
                $(ElementType::$variant => {
                    let samples = bytes.as_chunks().0.iter().map(|&sample| <$type>::from_le_bytes(sample));
                    let (min, max) = samples
                        .fold((<$type>::MAX, <$type>::MIN), |(min, max), sample| (sample.min(min), sample.max(max)));
                    [min.into(), max.into()]
                })+
                ElementType::F32 | ElementType::F64 => return None,
            }
        };
    }
    let ends: [i128; 2] =
        ends!(U8 => u8, I8 => i8, U16 => u16, I16 => i16, U32 => u32, I32 => i32, U64 => u64, I64 => i64);
    (bytes.len() >= element.bytes()).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(element: ElementType, samples: &[i64]) -> Survey {
        let bytes: Vec<u8> =
            samples.iter().flat_map(|sample| sample.to_le_bytes()[..element.bytes()].to_vec()).collect();
        let mut whole = Survey::new(element, samples.len() as u64);
        whole.add(&bytes);
        let mut parts = Survey::new(element, samples.len() as u64);
        for part in bytes.chunks(3 * element.bytes()) {
            let mut next = parts.next();
            next.add(part);
            parts.append(&next);
        }
        assert_eq!(parts.distinct.ascending(), whole.distinct.ascending());
        assert_eq!((parts.ends(), &parts.profile), (whole.ends(), &whole.profile));
        whole
    }

    #[test]
    fn values_are_found_where_they_are_few() {
        for element in [ElementType::I16, ElementType::I32] {
            let survey = whole(element, &[300, -5, 300, 12, -32_768, 12]);
            assert_eq!(survey.values().map(Into::into), Some((-32_768, vec![32_763_u32, 17, 288])));
            assert_eq!((survey.range().max, survey.largest()), (33_068.0, 300));
        }
        assert_eq!(whole(ElementType::U8, &[3, 4, 5, 4]).values(), None);
        assert_eq!(whole(ElementType::U16, &[7, 7]).values(), None);
        let many: Vec<i64> = (0..70_000).map(|i| 3 * i).collect();
        assert_eq!(whole(ElementType::I32, &many).values(), None);
        let few: Vec<i64> = (0..70_000).map(|i| 3 * (i % 65_536)).collect();
        assert_eq!(whole(ElementType::I32, &few).values().map(|values| values.count()), Some(65_536));
        assert_eq!(whole(ElementType::I64, &[3, 900]).values(), None);
    }

    #[test]
    fn ranges_are_those_of_the_type() {
        assert_eq!(whole(ElementType::I64, &[i64::MIN, i64::MAX]).range().max, u64::MAX as f64);
        assert_eq!(whole(ElementType::U64, &[-1, 0]).largest(), i128::from(u64::MAX));
        assert_eq!(whole(ElementType::I8, &[0x80, 0x7F]).range().max, 255.0);
        let floats =
            whole(ElementType::F32, &[1.5_f32, -2.0, f32::NAN].map(|value| i64::from(value.to_bits())));
        assert_eq!(floats.range(), FiniteRange { min: -2.0, max: 1.5 });
    }
}
