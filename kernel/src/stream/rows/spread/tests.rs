//! The sums of factors, found by transforming lines that are zero but in one place, and what follows from them.

extern crate std;

use std::vec;
use std::vec::Vec;

use super::*;
use crate::lifting::Direction;
use crate::stream::rows::fronts::{Fronts, Passes};

/// What stands for one in the lines, so that what is rounded does not matter.
const ONE: i32 = 1 << 20;

/// How coefficients of one kind depend on the samples of a line: the largest sum of magnitudes of factors, and the largest
/// magnitude of a sum of factors, which is what becomes of a constant.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    magnitudes: f64,
    constant: f64,
}

impl Sums {
    fn of(factors: &[i32]) -> Self {
        let sum =
            |numbers: &mut dyn Iterator<Item = i32>| numbers.map(f64::from).sum::<f64>() / f64::from(ONE);
        let magnitudes = sum(&mut factors.iter().map(|factor| factor.abs()));
        Self { magnitudes, constant: sum(&mut factors.iter().copied()).abs() }
    }

    fn or(self, other: Self) -> Self {
        let magnitudes = self.magnitudes.max(other.magnitudes);
        Self { magnitudes, constant: self.constant.max(other.constant) }
    }
}

/// A level: rows c and d as they arrive, as each step leaves them, the last of them as they are coded.
type Steps = Vec<[Sums; 2]>;

/// One level of lines whose factors these are; what is left are those of the rows c.
fn level(wavelet: Wavelet, rows: &mut Vec<Vec<i32>>, found: &mut Steps) {
    let passes = Passes::new(wavelet, Direction::Forward);
    let mut fronts = Fronts::new(passes);
    let mut see = |stage: usize, row: usize, factors: &[i32]| {
        found.resize(found.len().max(stage + 1), Default::default());
        found[stage][row % 2] = found[stage][row % 2].or(Sums::of(factors));
    };
    for (row, factors) in rows.iter().enumerate() {
        fronts.receive();
        see(0, row, factors);
    }
    fronts.end();
    while let Some(change) = fronts.advance(passes) {
        let zeros = vec![0; rows[0].len()];
        let beside =
            change.beside.map(|row| row.map_or(&zeros, |row| &rows[usize::try_from(row).unwrap()]).clone());
        let row = usize::try_from(change.row).unwrap();
        let [left, here, right] = &beside;
        wavelet.lift_row(change.step, Direction::Forward, &mut rows[row], [left, here, right]);
        see(change.step + 1, row, &rows[row]);
    }
    *rows = rows.iter().step_by(2).cloned().collect();
}

/// The same of [`LEVELS`] levels, for all lengths up to where the ends of a line do not see each other.
fn levels(wavelet: Wavelet) -> Vec<Steps> {
    let mut found = vec![Steps::new(); usize::from(LEVELS)];
    for n in (2..=if cfg!(miri) { 4 } else { 40 }).chain([64, 65]) {
        let mut rows: Vec<Vec<i32>> =
            (0..n).map(|row| (0..n).map(|place| if place == row { ONE } else { 0 }).collect()).collect();
        for found in &mut found {
            if rows.len() > 1 {
                level(wavelet, &mut rows, found);
            }
        }
    }
    found
}

/// What rounding adds at most to c and to d, of one level along one axis; steps only add to it (docs/lifting.md).
fn rounding(wavelet: Wavelet) -> [f64; 2] {
    match wavelet {
        Wavelet::Haar => [0.5, 0.0],
        Wavelet::Quadratic => [14.0 / 9.0, 1.25],
        Wavelet::Duchaineau => [52.0 / 27.0, 1.25],
        Wavelet::Linear => [0.75, 0.5],
        Wavelet::Cubic => [1.375, 1.0],
        Wavelet::Quintic => [265.0 / 96.0, 23.0 / 6.0],
    }
}

/// The last sums of rows c and of rows d.
fn last(steps: &Steps) -> [Sums; 2] {
    [0, 1].map(|kind| steps.iter().map(|step| step[kind]).rfind(|sums| sums.magnitudes > 0.0).unwrap())
}

/// The largest number on each level, for samples as far as `reach` from `middle`.
fn largest(wavelet: Wavelet, reach: f64, middle: f64) -> Vec<f64> {
    let (found, rounded) = (levels(wavelet), rounding(wavelet));
    let one_level = &found[0];
    let mut arriving = 0.0;
    found
        .iter()
        .map(|steps| {
            let mut largest = 0.0_f64;
            for (x, along_x) in last(steps).into_iter().enumerate() {
                let once_x = last(one_level)[x].magnitudes;
                for (stage, (step, once)) in steps.iter().zip(one_level).enumerate() {
                    for (y, (along_y, once_y)) in step.iter().zip(once).enumerate() {
                        let (own, once_y) = (if stage == 0 { 0.0 } else { rounded[y] }, once_y.magnitudes);
                        let error = arriving * once_x * once_y + rounded[x] * once_y + own;
                        let far = reach * along_x.magnitudes * along_y.magnitudes + error;
                        largest = largest.max(middle * along_x.constant * along_y.constant + far);
                    }
                }
            }
            let once_c = last(one_level)[0].magnitudes;
            arriving = arriving * once_c * once_c + rounded[0] * once_c + rounded[0];
            largest
        })
        .collect()
}

#[test]
fn every_coefficient_has_the_bits_that_it_takes() {
    for wavelet in Wavelet::ALL {
        for sample_type in [SampleType::U8, SampleType::I8, SampleType::U16, SampleType::I16] {
            let (low, high) = sample_type.range().into_inner();
            let (reach, middle) = (f64::from(high - low) / 2.0, f64::from(high + low) / 2.0);
            let largest = largest(wavelet, reach, middle.abs());
            std::println!("{wavelet} {sample_type}: {largest:?}");
            for (level, &largest) in (0..).zip(&largest) {
                let bits = bits(wavelet, sample_type, level);
                let limit = f64::from(1 << (bits - 1));
                assert!(largest < limit, "{wavelet} {sample_type} {level}: {largest} in {bits} bits");
                assert!(level > 0 || 2.0 * largest >= limit, "{wavelet} {sample_type}: fewer bits suffice");
            }
        }
    }
}

/// The magnitudes of two siblings are added before they are capped at 2^25.
#[test]
fn what_takes_less_than_a_word_is_far_from_the_cap_of_magnitudes() {
    for (wavelet, sample_type) in
        Wavelet::ALL.into_iter().flat_map(|wavelet| SampleType::ALL.map(|sample_type| (wavelet, sample_type)))
    {
        for level in 0..LEVELS {
            let bits = bits(wavelet, sample_type, level);
            assert!(bits == 32 || bits <= 25, "{wavelet} {sample_type} {level}: {bits} bits");
        }
    }
}

#[test]
fn deep_levels_and_wide_types_have_words() {
    for wavelet in Wavelet::ALL {
        assert_eq!(bits(wavelet, SampleType::U8, LEVELS), 32);
        assert_eq!([0, 1].map(|level| bits(wavelet, SampleType::I32, level)), [32; 2]);
    }
}
