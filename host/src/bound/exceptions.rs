//! Samples whose bits are kept.

use serde::{Deserialize, Serialize};

use super::Real;

/// Consecutive samples of the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Run {
    /// Samples between the end of the run before, or the first sample, and this run.
    pub gap: u32,
    /// Samples in the run.
    pub count: u32,
    /// The bits of each.
    pub bits: u64,
}

/// The samples of a brick that are not what the scale makes of the integers, in order. A mask of NaNs is a few runs.
///
/// Stored, each run has the difference (exclusive or) of its bits to those of the run before, 0 at first: equal ones
/// take one byte.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<Run>", into = "Vec<Run>")]
pub struct Exceptions {
    runs: Vec<Run>,
}

impl From<Exceptions> for Vec<Run> {
    fn from(exceptions: Exceptions) -> Self {
        let mut before = 0;
        let difference = |run: Run| Run { bits: run.bits ^ std::mem::replace(&mut before, run.bits), ..run };
        exceptions.runs.into_iter().map(difference).collect()
    }
}

impl From<Vec<Run>> for Exceptions {
    fn from(mut runs: Vec<Run>) -> Self {
        let mut before = 0;
        for run in &mut runs {
            run.bits ^= before;
            before = run.bits;
        }
        Self { runs }
    }
}

impl Exceptions {
    /// The runs of those (position, sample) pairs, whose positions ascend and stay below 2^32.
    pub(super) fn collect<R: Real>(samples: impl Iterator<Item = (usize, R)>) -> Self {
        let mut runs: Vec<Run> = Vec::new();
        let mut end = 0;
        for (position, sample) in samples {
            let bits = sample.bits();
            match runs.last_mut() {
                Some(run) if position == end && run.bits == bits => run.count += 1,
                _ => runs.push(Run { gap: (position - end) as u32, count: 1, bits }),
            }
            end = position + 1;
        }
        Self { runs }
    }

    /// The runs.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Whether every sample is what the scale makes of it.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Samples in all runs.
    pub fn samples(&self) -> u64 {
        self.runs.iter().map(|run| u64::from(run.count)).sum()
    }

    /// Calls `keep` with the position and the bits of each sample, in order. Returns whether all runs lie within the
    /// `samples` there are; those that do not are left out.
    #[must_use]
    pub fn each(&self, samples: u64, mut keep: impl FnMut(u64, u64)) -> bool {
        let mut end = 0;
        for run in &self.runs {
            let start = end + u64::from(run.gap);
            end = start + u64::from(run.count);
            if end > samples {
                return false;
            }
            (start..end).for_each(|position| keep(position, run.bits));
        }
        true
    }

    /// Puts the kept bits in their places. Returns whether all runs lie within `samples`; those that do not are left
    /// out.
    #[must_use]
    pub fn apply<R: Real>(&self, samples: &mut [R]) -> bool {
        self.each(samples.len() as u64, |position, bits| samples[position as usize] = R::of_bits(bits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_are_one_run() {
        let samples = [0.0, f32::NAN, f32::NAN, 1.0, -0.0, f32::INFINITY];
        let kept = [1, 2, 4, 5].map(|position| (position, samples[position]));
        let exceptions = Exceptions::collect(kept.into_iter());
        let runs: Vec<_> = exceptions.runs().iter().map(|run| (run.gap, run.count)).collect();
        assert_eq!(runs, [(1, 2), (1, 1), (0, 1)]);
        assert_eq!(exceptions.samples(), 4);
        let stored = postcard::to_allocvec(&exceptions).unwrap();
        assert_eq!(postcard::from_bytes(&stored), Ok(exceptions.clone()));
        let mut back = [0.0, 9.0, 9.0, 1.0, 9.0, 9.0];
        assert!(exceptions.apply(&mut back));
        assert_eq!(back.map(f32::to_bits), samples.map(f32::to_bits));
    }

    #[test]
    fn runs_outside_are_told() {
        let run = |gap, count| Exceptions { runs: vec![Run { gap, count, bits: 0 }] };
        let mut samples = [1.0_f64; 3];
        assert!(!run(4, 0).apply(&mut samples) && !run(2, 2).apply(&mut samples));
        assert!(!run(u32::MAX, u32::MAX).apply(&mut samples));
        assert_eq!(samples, [1.0; 3]);
        assert!(run(2, 1).apply(&mut samples) && Exceptions::default().apply(&mut samples));
        assert_eq!(samples, [1.0, 1.0, 0.0]);
    }
}
