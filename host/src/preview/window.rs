//! Which values are black, and which are white.

/// The values that the ends of the grey scale stand for; those between are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// From black to white.
    Values(f64, f64),
    /// So many percent of the finite values of the picture are black, and all but so many are white.
    Percentiles(f64, f64),
}

impl Default for Window {
    fn default() -> Self {
        Self::Percentiles(0.5, 99.5)
    }
}

/// A window that is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WindowError {
    /// Not two ascending numbers.
    #[error("give two finite numbers LOW:HIGH, the first below the second")]
    Values,
    /// Not two ascending percentages.
    #[error("give two numbers LOW:HIGH from 0 to 100, the first below the second")]
    Percentiles,
}

impl Window {
    /// Reads `LOW:HIGH` as values.
    ///
    /// # Errors
    /// [`WindowError::Values`].
    pub fn values(text: &str) -> Result<Self, WindowError> {
        let [low, high] = pair(text).ok_or(WindowError::Values)?;
        Ok(Self::Values(low, high))
    }

    /// Reads `LOW:HIGH` as percentiles.
    ///
    /// # Errors
    /// [`WindowError::Percentiles`].
    pub fn percentiles(text: &str) -> Result<Self, WindowError> {
        let [low, high] =
            pair(text).filter(|[low, high]| *low >= 0.0 && *high <= 100.0).ok_or(WindowError::Percentiles)?;
        Ok(Self::Percentiles(low, high))
    }

    /// The values of black and white for a picture of these values; equal ones if it has only one finite value, or none.
    pub fn ends(self, values: &[f64]) -> [f64; 2] {
        let (low, high) = match self {
            Self::Values(low, high) => return [low, high],
            Self::Percentiles(low, high) => (low, high),
        };
        let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        if finite.is_empty() {
            return [0.0; 2];
        }
        [low, high].map(|percent| {
            let rank = (percent / 100.0 * (finite.len() - 1) as f64).round() as usize;
            *finite.select_nth_unstable_by(rank, f64::total_cmp).1
        })
    }
}

fn pair(text: &str) -> Option<[f64; 2]> {
    let (low, high) = text.split_once(':')?;
    let pair = [low.trim().parse().ok()?, high.trim().parse().ok()?];
    (pair.iter().all(|end: &f64| end.is_finite()) && pair[0] < pair[1]).then_some(pair)
}
