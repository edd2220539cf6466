//! Orders of axes as people write them: `zyx`, `xyzc`, the axis that varies fastest first.

use std::fmt;
use std::str::FromStr;

use super::Axis;

/// Letters of the axes in the order of [`Header`](super::Header): components, x, y, z, time.
const LETTERS: [char; 5] = ['c', 'x', 'y', 'z', 't'];

/// Which axis varies fastest in a file, and which follow it.
///
/// ```
/// use wavelift_host::volume::AxisOrder;
///
/// let order: AxisOrder = "zyx".parse()?;
/// assert_eq!(order.to_string(), "czyxt");
/// assert_eq!(AxisOrder::default().to_string(), "cxyzt");
/// # Ok::<(), wavelift_host::volume::OrderError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisOrder([u8; 5]);

impl Default for AxisOrder {
    fn default() -> Self {
        Self([0, 1, 2, 3, 4])
    }
}

impl AxisOrder {
    /// The order of the axes of a file; those that it does not have stand where they would by default. Of several axes
    /// of components, or of time, only the first is counted.
    pub fn of(axes: &[Axis]) -> Self {
        let mut places: Vec<u8> = Vec::new();
        for place in axes.iter().map(|axis| axis.place()) {
            if !places.contains(&place) {
                places.push(place);
            }
        }
        Self::completed(&places)
    }

    /// Components come first if they are missing, all others last.
    fn completed(places: &[u8]) -> Self {
        let is_missing = |place: &u8| !places.contains(place);
        let before = (0..1).filter(is_missing);
        let mut all = before.chain(places.iter().copied()).chain((1..5).filter(is_missing));
        Self([(); 5].map(|()| all.next().unwrap_or_default()))
    }

    /// The axes of a file of so many axes of space, 1 to 3; those of one component or one step are left out.
    pub(super) fn axes(self, rank: u8, components: u32, steps: u64) -> Vec<Axis> {
        let all = [Axis::Component(components), Axis::X, Axis::Y, Axis::Z, Axis::Time(steps)];
        let is_there = |axis: &Axis| match *axis {
            Axis::Component(count) => count != 1,
            Axis::Time(count) => count != 1,
            space => space.place() <= rank,
        };
        self.0.map(|place| all[usize::from(place)]).into_iter().filter(is_there).collect()
    }
}

impl fmt::Display for AxisOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|place| write!(f, "{}", LETTERS[usize::from(*place)]))
    }
}

impl FromStr for AxisOrder {
    type Err = OrderError;

    /// Reads letters of c, x, y, z, t in any order, each once at most; without c components vary fastest, and what else
    /// is missing follows in its usual order.
    fn from_str(text: &str) -> Result<Self, OrderError> {
        let wrong = || OrderError { text: text.chars().take(32).collect() };
        let mut places = Vec::new();
        for letter in text.chars() {
            let place = LETTERS.iter().position(|known| *known == letter.to_ascii_lowercase());
            let place = place.ok_or_else(wrong)? as u8;
            if places.contains(&place) {
                return Err(wrong());
            }
            places.push(place);
        }
        if places.is_empty() { Err(wrong()) } else { Ok(Self::completed(&places)) }
    }
}

/// What is no order of axes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{text:?} is no order of axes: write x, y, z, c (components), t (time), each once, the fastest first, as in zyx or xyzc"
)]
pub struct OrderError {
    /// What was given, at most 32 characters of it.
    text: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_and_completed() {
        let order = |text: &str| text.parse().map(|order: AxisOrder| order.to_string());
        for (text, expected) in [
            ("xyz", "cxyzt"),
            ("zyx", "czyxt"),
            ("XYZC", "xyzct"),
            ("txyz", "ctxyz"),
            ("y", "cyxzt"),
            ("xyczt", "xyczt"),
        ] {
            assert_eq!(order(text).unwrap(), expected, "{text}");
        }
        for wrong in ["", "xx", "xyw", "x,y", "xyzctx"] {
            assert!(order(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn axes_are_those_that_a_file_has() {
        let order: AxisOrder = "ztycx".parse().unwrap();
        assert_eq!(order.axes(3, 2, 5), [Axis::Z, Axis::Time(5), Axis::Y, Axis::Component(2), Axis::X]);
        assert_eq!(order.axes(2, 1, 1), [Axis::Y, Axis::X]);
        assert_eq!(AxisOrder::of(&order.axes(3, 2, 5)), order);
        assert_eq!(AxisOrder::of(&[Axis::X, Axis::Y]).to_string(), "cxyzt");
    }
}
