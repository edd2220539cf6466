//! Copies that cannot panic, whatever the lengths.

use core::cell::Cell;
use core::ops::Range;

/// Copies as many elements as both have.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(crate) fn copy<T: Copy>(from: &[T], to: &mut [T]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = from;
    }
}

/// Moves the elements of `range` to begin at `to`; nothing happens if either place is not all inside.
pub(crate) fn move_within<T: Copy>(elements: &mut [T], range: Range<usize>, to: usize) {
    let cells = Cell::from_mut(elements).as_slice_of_cells();
    let end = to.wrapping_add(range.len());
    let (Some(from), Some(into)) = (cells.get(range.clone()), cells.get(to..end)) else { return };
    let pairs = into.iter().zip(from);
    let copy = |(into, from): (&Cell<T>, &Cell<T>)| into.set(from.get());
    if to <= range.start { pairs.for_each(copy) } else { pairs.rev().for_each(copy) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlapping_moves() {
        let moved = |range, to| {
            let mut elements = [0, 1, 2, 3, 4];
            move_within(&mut elements, range, to);
            elements
        };
        assert_eq!(moved(1..4, 0), [1, 2, 3, 3, 4]);
        assert_eq!(moved(1..4, 2), [0, 1, 1, 2, 3]);
        assert_eq!(moved(1..4, 3), [0, 1, 2, 3, 4]);
        assert_eq!(moved(3..9, 0), [0, 1, 2, 3, 4]);
    }
}
