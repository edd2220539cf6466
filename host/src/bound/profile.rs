//! What is to be known of floating-point samples to choose a scale for them: gathered in one pass, in parts of any size.

use super::scale::{DECIMALS, Scale};
use super::{FiniteRange, Real};

/// Exponents that a number in double precision may have, zero and all that is not finite included.
const EXPONENTS: usize = 1 << 11;

/// One in so many samples may be off a scale.
const FEW: u64 = 256;

/// Samples of equal bits, one after another but for others between them, count once: fill values in a mask cost little,
/// however many they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Changes {
    count: u64,
    /// The bits of the first sample, and of the last.
    ends: Option<[u64; 2]>,
}

impl Changes {
    fn add(&mut self, bits: u64) {
        match &mut self.ends {
            Some([_, last]) if *last == bits => {}
            Some([_, last]) => {
                *last = bits;
                self.count += 1;
            }
            None => (self.count, self.ends) = (1, Some([bits; 2])),
        }
    }

    fn append(&mut self, later: &Self) {
        match (&mut self.ends, later.ends) {
            (_, None) => {}
            (None, Some(_)) => *self = *later,
            (Some([_, last]), Some([first, end])) => {
                self.count += later.count - u64::from(*last == first);
                *last = end;
            }
        }
    }
}

/// Samples of one exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Class {
    changes: Changes,
    /// The largest magnitude, or infinity for what is not finite.
    largest: f64,
}

/// What is to be known of the samples of a volume to choose a [`Scale`]. It does not matter in which parts they come, if
/// only in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Samples so far, and in the whole volume.
    seen: u64,
    total: u64,
    /// Half the distance of 1 to the next larger number of their type.
    rounding: f64,
    range: Option<FiniteRange>,
    /// The exponent of the lowest bit that is set in any finite sample.
    lowest_bit: Option<i32>,
    classes: Vec<Class>,
    /// For each decimal scale, the samples that are not on it; `None` once they are too many.
    off_decimals: [Option<Changes>; DECIMALS.len()],
}

impl Profile {
    /// The profile of no sample yet, of a volume of `total` of type `R`.
    pub fn new<R: Real>(total: u64) -> Self {
        Self {
            seen: 0,
            total,
            rounding: R::ROUNDING,
            range: None,
            lowest_bit: None,
            classes: vec![Class::default(); EXPONENTS],
            off_decimals: [Some(Changes::default()); DECIMALS.len()],
        }
    }

    /// The profile of all samples of a volume.
    pub fn of<R: Real>(samples: impl ExactSizeIterator<Item = R>) -> Self {
        let mut profile = Self::new::<R>(samples.len() as u64);
        profile.add(samples);
        profile
    }

    /// As [`Profile::new`], for samples that follow those of this profile: what is settled already is left out.
    #[must_use]
    pub fn next(&self) -> Self {
        Self {
            seen: 0,
            range: None,
            lowest_bit: None,
            classes: vec![Class::default(); EXPONENTS],
            off_decimals: self.off_decimals.map(|off| off.map(|_| Changes::default())),
            ..*self
        }
    }

    /// Adds the samples that come next.
    pub fn add<R: Real>(&mut self, samples: impl Iterator<Item = R>) {
        let most = self.most();
        let mut tried: Vec<_> =
            self.off_decimals.iter_mut().zip(DECIMALS).filter(|(off, _)| off.is_some()).collect();
        let (mut range, mut lowest_bit) = (self.range, self.lowest_bit);
        for sample in samples {
            self.seen += 1;
            let (value, bits) = (sample.to_f64(), sample.bits());
            let class = &mut self.classes[(value.to_bits() >> 52) as usize % EXPONENTS];
            class.changes.add(bits);
            if value.is_finite() {
                class.largest = class.largest.max(value.abs());
                range = Some(widened(range, FiniteRange { min: value, max: value }));
                if value != 0.0 {
                    let lowest = lowest_bit_of(value);
                    lowest_bit = Some(lowest_bit.map_or(lowest, |known: i32| known.min(lowest)));
                }
            } else {
                class.largest = f64::INFINITY;
            }
            tried.retain_mut(|(off, density)| {
                if let Some(changes) = off
                    && !Scale::exact(*density).holds(sample)
                {
                    changes.add(bits);
                    **off = Some(*changes).filter(|changes| changes.count <= most);
                }
                off.is_some()
            });
        }
        (self.range, self.lowest_bit) = (range, lowest_bit);
    }

    /// Adds the profile of the samples that come next.
    pub fn append(&mut self, later: &Self) {
        self.seen += later.seen;
        if let Some(range) = later.range {
            self.range = Some(widened(self.range, range));
        }
        self.lowest_bit = [self.lowest_bit, later.lowest_bit].into_iter().flatten().min();
        for (class, later) in self.classes.iter_mut().zip(&later.classes) {
            class.changes.append(&later.changes);
            class.largest = class.largest.max(later.largest);
        }
        for (off, later) in self.off_decimals.iter_mut().zip(&later.off_decimals) {
            *off = off.zip(*later).map(|(mut changes, later)| {
                changes.append(&later);
                changes
            });
        }
        self.settle();
    }

    /// Forgets decimal scales that too many samples are off.
    fn settle(&mut self) {
        let most = self.most();
        for off in &mut self.off_decimals {
            *off = off.filter(|changes| changes.count <= most);
        }
    }

    /// Samples that may be off a scale.
    const fn most(&self) -> u64 {
        self.total / FEW
    }

    /// The range of the finite samples.
    pub fn range(&self) -> FiniteRange {
        self.range.unwrap_or(FiniteRange { min: 0.0, max: 0.0 })
    }

    /// The density at which every finite sample in reach is an integer, if that is a normal number.
    pub(super) fn binary_density(&self) -> Option<f64> {
        self.lowest_bit.map(|exponent| 2.0_f64.powi(-exponent)).filter(|density| density.is_normal())
    }

    /// The first decimal scale that nearly all samples are on.
    pub(super) fn decimal_density(&self) -> Option<f64> {
        self.off_decimals.iter().zip(DECIMALS).find_map(|(off, density)| off.map(|_| density))
    }

    /// Half the distance of 1 to the next larger number of the type of the samples.
    pub(super) const fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Whether nearly all samples are in reach of a scale. Those of one exponent are, if all of them are.
    pub(super) fn is_reached(&self, scale: Scale) -> bool {
        let off = self.classes.iter().filter(|class| !scale.reaches(class.largest));
        off.map(|class| class.changes.count).sum::<u64>() <= self.most()
    }

    /// A bound of the magnitudes in reach of a scale: the largest, unless only some of its exponent are in reach.
    pub(super) fn largest_reached(&self, scale: Scale) -> f64 {
        let of_class = |(exponent, class): (usize, &Class)| {
            let smallest = f64::from_bits((exponent as u64) << 52);
            match class.largest {
                largest if scale.reaches(largest) => largest,
                _ if class.changes.count > 0 && scale.reaches(smallest) => scale.reach(),
                _ => 0.0,
            }
        };
        self.classes.iter().enumerate().map(of_class).fold(0.0, f64::max)
    }
}

fn widened(range: Option<FiniteRange>, other: FiniteRange) -> FiniteRange {
    let range = range.unwrap_or(other);
    FiniteRange { min: range.min.min(other.min), max: range.max.max(other.max) }
}

/// The exponent of the lowest set bit of a finite number other than zero.
fn lowest_bit_of(value: f64) -> i32 {
    const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    let bits = value.to_bits();
    let fraction = bits & ((1 << FRACTION_BITS) - 1);
    let exponent = ((bits >> FRACTION_BITS) & 0x7FF) as i32;
    let significand = if exponent == 0 { fraction } else { fraction | 1 << FRACTION_BITS };
    significand.trailing_zeros() as i32 + exponent.max(1) + f64::MIN_EXP - 1 - f64::MANTISSA_DIGITS as i32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn lowest_bits() {
        assert_eq!([1.0, 3.0, 0.75, -6.0, 1024.0].map(lowest_bit_of), [0, 0, -2, 1, 10]);
        assert_eq!([f64::from_bits(1), f64::MIN_POSITIVE].map(lowest_bit_of), [-1074, -1022]);
    }

    #[test]
    fn fill_values_count_once() {
        let samples: Vec<f32> = (0..4096).map(|i| [1.0, f32::NAN, 2.5, 1e30][i / 7 % 4]).collect();
        let profile = Profile::of(samples.iter().copied());
        assert!(profile.is_reached(Scale::exact(2.0)));
        assert_eq!((profile.binary_density(), profile.decimal_density()), (Some(2.0), None));
        assert_eq!(profile.largest_reached(Scale::exact(2.0)), 2.5);
        assert_eq!(profile.range(), FiniteRange { min: 1.0, max: f64::from(1e30_f32) });
    }

    proptest! {
        #[test]
        fn parts_make_the_whole(
            samples in prop::collection::vec(prop_oneof![prop::num::f32::ANY, Just(f32::NAN), Just(0.5), Just(7.0)], 0..600),
            cuts in prop::collection::vec(0_usize..600, 3),
        ) {
            let whole = Profile::of(samples.iter().copied());
            let mut parts = Profile::new::<f32>(samples.len() as u64);
            let mut cuts: Vec<usize> = cuts.into_iter().map(|cut| cut.min(samples.len())).collect();
            cuts.sort_unstable();
            for [from, to] in [[0, cuts[0]], [cuts[0], cuts[1]], [cuts[1], cuts[2]], [cuts[2], samples.len()]] {
                let mut part = parts.next();
                part.add(samples[from..to].iter().copied());
                parts.append(&part);
            }
            prop_assert_eq!(parts, whole);
        }
    }
}
