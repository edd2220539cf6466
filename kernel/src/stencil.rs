//! Generalized integer lifting on meshes of any valence, over index lists lent by the caller.
//!
//! A mesh refined once has vertices v (old ones), e (one in each edge) and f (one in each face). Both lifts have the same
//! form, with the roles of v and f changed over:
//!
//! ```text
//! corner <- b² corner + [4a² centre average + 4ab edge average]
//! edge   <- b  edge   + [2a  centre average]
//! ```
//!
//! | lift | corners | centres | Diss |
//! | --- | --- | --- | --- |
//! | s-lift(a, b) | v | f | eq. (4.16), inverse (4.18) |
//! | w-lift(a, b) | f | v | eq. (4.17), inverse (4.19) |
//!
//! Corners read the edges as they were before the lift. Each bracket is formed exactly and rounded once,
//! \[r\] = floor(r + 1/2). The average over an empty list is zero; a neighbour listed twice counts twice, which is how a
//! boundary is mirrored. Coordinates are lifted one at a time.
//!
//! As in [`lifting::generalized`](crate::lifting::generalized) nothing wraps, so what was accepted is restored bit for
//! bit; the arithmetic is of 128 bits and made for hosts.
//!
//! Source: M. Bertram, *Multiresolution Modeling for Scientific Visualization*, dissertation, UC Davis 2000,
//! eq. (4.16)–(4.19).

use core::num::NonZeroI32;

pub use fixed::types::I16F16;

use crate::error::exactly;
use crate::extent::to_usize;
use crate::lifting::generalized::{scaled_down, scaled_up, update};
use crate::{AdjacencyError, LengthError, LiftError, Slice};

/// For each of a number of vertices, a list of neighbours: compressed rows.
///
/// The neighbours of vertex i are `indices[offsets[i]..offsets[i + 1]]`. Checked once, when made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Adjacency<'a> {
    offsets: &'a [u32],
    indices: &'a [u32],
    neighbours: usize,
}

impl<'a> Adjacency<'a> {
    /// Lists for `offsets.len() - 1` vertices, whose indices name some of `neighbours` others.
    ///
    /// # Errors
    /// [`AdjacencyError::Offset`] unless `offsets` begins with 0, never decreases, and ends with `indices.len()`;
    /// [`AdjacencyError::Index`] if an index is not below `neighbours`.
    pub fn new(offsets: &'a [u32], indices: &'a [u32], neighbours: usize) -> Result<Self, AdjacencyError> {
        if offsets.first() != Some(&0) {
            return Err(AdjacencyError::Offset { position: 0 });
        }
        if let Some(before) = offsets.array_windows().position(|[start, end]| start > end) {
            return Err(AdjacencyError::Offset { position: before.saturating_add(1) });
        }
        if offsets.last().is_none_or(|&end| to_usize(end) != indices.len()) {
            return Err(AdjacencyError::Offset { position: offsets.len().saturating_sub(1) });
        }
        if let Some(position) = indices.iter().position(|&index| to_usize(index) >= neighbours) {
            return Err(AdjacencyError::Index { position });
        }
        Ok(Self { offsets, indices, neighbours })
    }

    /// How many vertices have a list, empty or not.
    #[must_use]
    pub const fn vertices(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// How many neighbours the indices may name.
    #[must_use]
    pub const fn neighbours(&self) -> usize {
        self.neighbours
    }

    /// For each vertex the average of `values` over its neighbours.
    fn averages(self, values: &[i32]) -> impl Iterator<Item = Average> + Clone {
        self.offsets.array_windows().map(move |&[start, end]| {
            let list = self.indices.get(to_usize(start)..to_usize(end)).unwrap_or(&[]);
            let listed = list.iter().filter_map(|&index| values.get(to_usize(index)));
            Average {
                sum: listed.fold(0, |sum, &value| sum.wrapping_add(value.into())),
                count: end.wrapping_sub(start).max(1).into(),
            }
        })
    }
}

/// `sum / count`, where |sum| <= 2^31 count and 0 < count < 2^32.
#[derive(Clone, Copy, Debug)]
struct Average {
    sum: i128,
    count: i128,
}

/// Whose averages a lift takes.
///
/// The forward and the inverse lift need the same lists, the same a and the same b.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Neighbours<'a> {
    centres_of_corners: Adjacency<'a>,
    edges_of_corners: Adjacency<'a>,
    centres_of_edges: Adjacency<'a>,
}

impl<'a> Neighbours<'a> {
    /// Lists that belong to one mesh: for an s-lift f̄_v, ē_v and f̄_e, for a w-lift v̄_f, ē_f and v̄_e.
    ///
    /// # Errors
    /// [`LengthError`] naming [`Slice::Corners`] if the first two are not for equally many corners,
    /// [`Slice::Edges`] if the second is not over the edges that the third is for, [`Slice::Centres`] if the
    /// first and the third are not over equally many centres.
    pub fn new(
        centres_of_corners: Adjacency<'a>,
        edges_of_corners: Adjacency<'a>,
        centres_of_edges: Adjacency<'a>,
    ) -> Result<Self, LengthError> {
        exactly(Slice::Corners, centres_of_corners.vertices(), edges_of_corners.vertices())?;
        exactly(Slice::Edges, edges_of_corners.neighbours, centres_of_edges.vertices())?;
        exactly(Slice::Centres, centres_of_corners.neighbours, centres_of_edges.neighbours)?;
        Ok(Self { centres_of_corners, edges_of_corners, centres_of_edges })
    }

    /// Lifts `corners` and `edges`, one value per vertex, from each other and from `centres`.
    ///
    /// For an s-lift these are v, e, f; for a w-lift f, e, v. Two passes over the lists.
    ///
    /// # Errors
    /// [`LiftError::Length`] if the values are not as many as the lists are for, [`LiftError::Overflow`] if a result is
    /// not an `i32`; nothing has changed then.
    pub fn lift(
        &self,
        corners: &mut [i32],
        edges: &mut [i32],
        centres: &[i32],
        a: I16F16,
        b: NonZeroI32,
    ) -> Result<(), LiftError> {
        self.check(corners, edges, centres)?;
        let b = i128::from(b.get());
        let up = scaled_up(square(b));
        update(corners, Slice::Corners, self.corner_terms(edges, centres, a, b), up)?;
        update(edges, Slice::Edges, self.edge_terms(centres, a), scaled_up(b)).or_else(|error| {
            let down = scaled_down(square(b));
            update(corners, Slice::Corners, self.corner_terms(edges, centres, a, b), down)?;
            Err(error)
        })
    }

    /// Undoes [`Neighbours::lift`] with the same a and b.
    ///
    /// # Errors
    /// As [`Neighbours::lift`], and [`LiftError::NotDivisible`] if a division by b or b² leaves a remainder, as it does
    /// for no result of that lift; nothing has changed then.
    pub fn inverse_lift(
        &self,
        corners: &mut [i32],
        edges: &mut [i32],
        centres: &[i32],
        a: I16F16,
        b: NonZeroI32,
    ) -> Result<(), LiftError> {
        self.check(corners, edges, centres)?;
        let b = i128::from(b.get());
        update(edges, Slice::Edges, self.edge_terms(centres, a), scaled_down(b))?;
        let down = scaled_down(square(b));
        update(corners, Slice::Corners, self.corner_terms(edges, centres, a, b), down).or_else(|error| {
            update(edges, Slice::Edges, self.edge_terms(centres, a), scaled_up(b))?;
            Err(error)
        })
    }

    fn check(&self, corners: &[i32], edges: &[i32], centres: &[i32]) -> Result<(), LengthError> {
        exactly(Slice::Corners, self.centres_of_corners.vertices(), corners.len())?;
        exactly(Slice::Edges, self.centres_of_edges.vertices(), edges.len())?;
        exactly(Slice::Centres, self.centres_of_corners.neighbours, centres.len())
    }

    /// \[4a² centre average + 4ab edge average\] of every corner.
    fn corner_terms(
        &self,
        edges: &[i32],
        centres: &[i32],
        a: I16F16,
        b: i128,
    ) -> impl Iterator<Item = i128> + Clone {
        // a is bits / 2^16, so 4a² = bits² / 2^30 and 4ab = bits b / 2^14.
        let bits = i128::from(a.to_bits());
        let averages = self.centres_of_corners.averages(centres).zip(self.edges_of_corners.averages(edges));
        averages.map(move |(centre, edge)| {
            let (centre_whole, centre_rest, centre_parts) = centre.times(square(bits), 30);
            let (edge_whole, edge_rest, edge_parts) = edge.times(bits.wrapping_mul(b), 14);
            let rest =
                centre_rest.wrapping_mul(edge_parts).wrapping_add(edge_rest.wrapping_mul(centre_parts));
            let rest = nearest(rest, centre_parts.wrapping_mul(edge_parts));
            centre_whole.wrapping_add(edge_whole).wrapping_add(rest)
        })
    }

    /// \[2a centre average\] of every edge.
    fn edge_terms(&self, centres: &[i32], a: I16F16) -> impl Iterator<Item = i128> + Clone {
        let bits = i128::from(a.to_bits());
        self.centres_of_edges.averages(centres).map(move |centre| {
            let (whole, rest, parts) = centre.times(bits, 15);
            whole.wrapping_add(nearest(rest, parts))
        })
    }
}

impl Average {
    /// The average times `factor / 2^shift`, as whole + rest / parts with 0 <= rest < parts < 2^(32 + shift);
    /// `factor` is at most 2^62 in magnitude.
    fn times(self, factor: i128, shift: u32) -> (i128, i128, i128) {
        let parts = self.count << shift;
        let numerator = self.sum.wrapping_mul(factor);
        let whole = floor(numerator, parts);
        (whole, numerator.wrapping_sub(whole.wrapping_mul(parts)), parts)
    }
}

/// \[numerator / denominator\] for 0 <= numerator < 2^112 and an even denominator below 2^112.
fn nearest(numerator: i128, denominator: i128) -> i128 {
    floor(numerator.wrapping_add(denominator >> 1), denominator)
}

/// The quotient rounded down; the denominator is positive.
fn floor(numerator: i128, denominator: i128) -> i128 {
    numerator.checked_div_euclid(denominator).unwrap_or(0)
}

/// x² for |x| <= 2^31.
const fn square(x: i128) -> i128 {
    x.wrapping_mul(x)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ONE: NonZeroI32 = NonZeroI32::new(1).unwrap();
    const TWO: NonZeroI32 = NonZeroI32::new(2).unwrap();

    /// A corner of valence three: it reads three faces and three edges, each edge two of the faces; the fourth edge and
    /// the second corner have no neighbours.
    fn valence_three() -> Neighbours<'static> {
        let centres_of_corners = Adjacency::new(&[0, 3, 3], &[0, 1, 2], 3).unwrap();
        let edges_of_corners = Adjacency::new(&[0, 3, 3], &[0, 1, 2], 4).unwrap();
        let centres_of_edges = Adjacency::new(&[0, 2, 4, 6, 6], &[0, 1, 1, 2, 2, 0], 3).unwrap();
        Neighbours::new(centres_of_corners, edges_of_corners, centres_of_edges).unwrap()
    }

    /// s-lift(1/4, 1): v + [f̄/4 + ē], e + [f̄/2].
    #[test]
    fn bilinear_by_hand() {
        let (mut v, mut e, f) = ([10, 20], [1, 5, 10, 3], [1, 2, 5]);
        let a = I16F16::lit("0.25");
        valence_three().lift(&mut v, &mut e, &f, a, ONE).unwrap();
        // v + [8/12 + 16/3], [0]; e + [3/4], [7/4], [6/4], [0]
        assert_eq!((v, e), ([16, 20], [2, 7, 12, 3]));
        valence_three().inverse_lift(&mut v, &mut e, &f, a, ONE).unwrap();
        assert_eq!((v, e), ([10, 20], [1, 5, 10, 3]));
    }

    /// The bracket is rounded once: [5/12 + 1/3] = 1, though [5/12] = [1/3] = 0.
    #[test]
    fn brackets_are_rounded_once() {
        let (mut v, mut e, f) = ([0, 0], [0, 1, 0, 0], [1, 2, 2]);
        valence_three().lift(&mut v, &mut e, &f, I16F16::lit("0.25"), ONE).unwrap();
        assert_eq!(v, [1, 0]);
    }

    /// s-lift(3/8, 2): 4 v + [9/16 f̄ + 3 ē], 2 e + [3/4 f̄].
    #[test]
    fn cubic_by_hand() {
        let a = I16F16::lit("0.375");
        let (mut v, mut e) = ([10, -20], [1, 5, 10, 3]);
        valence_three().lift(&mut v, &mut e, &[1, 2, 5], a, TWO).unwrap();
        // 4 v + [3/2 + 16], [0]; 2 e + [9/8], [21/8], [18/8], [0]
        assert_eq!((v, e), ([58, -80], [3, 13, 22, 6]));
        valence_three().inverse_lift(&mut v, &mut e, &[1, 2, 5], a, TWO).unwrap();
        assert_eq!((v, e), ([10, -20], [1, 5, 10, 3]));
    }

    #[test]
    fn terms_are_exact_at_the_ends_of_the_range() {
        let lists = valence_three();
        let mut terms = lists.corner_terms(&[i32::MIN; 4], &[i32::MIN; 3], I16F16::MIN, -(1 << 31));
        // 4a² = 2^32, 4ab = 2^48
        assert_eq!(terms.next(), Some(-(1 << 63) - (1 << 79)));
        assert_eq!(terms.next(), Some(0));
        assert_eq!(lists.edge_terms(&[i32::MIN; 3], I16F16::MIN).next(), Some(1 << 47));
    }

    #[test]
    fn nothing_changes_after_an_error() {
        let lists = valence_three();
        let (mut v, mut e, f) = ([1, 2], [3, 4, 5, i32::MAX], [6, 7, 8]);
        let error = LiftError::Overflow { slice: Slice::Edges, index: 3 };
        assert_eq!(lists.lift(&mut v, &mut e, &f, I16F16::ONE, TWO), Err(error));
        assert_eq!((v, e), ([1, 2], [3, 4, 5, i32::MAX]));

        e = [3, 4, 5, 6];
        lists.lift(&mut v, &mut e, &f, I16F16::ONE, TWO).unwrap();
        v[1] += 1;
        let before = (v, e);
        let error = LiftError::NotDivisible { slice: Slice::Corners, index: 1 };
        assert_eq!(lists.inverse_lift(&mut v, &mut e, &f, I16F16::ONE, TWO), Err(error));
        assert_eq!((v, e), before);

        let error = LengthError { slice: Slice::Centres, expected: 3, actual: 2 };
        assert_eq!(lists.lift(&mut v, &mut e, &f[..2], I16F16::ONE, TWO), Err(LiftError::Length(error)));
    }

    #[test]
    fn lists_are_checked() {
        let offset = |position| Err(AdjacencyError::Offset { position });
        assert_eq!(Adjacency::new(&[], &[], 1), offset(0));
        assert_eq!(Adjacency::new(&[1], &[], 1), offset(0));
        assert_eq!(Adjacency::new(&[0, 2, 1], &[0], 1), offset(2));
        assert_eq!(Adjacency::new(&[0, 1], &[0, 0], 1), offset(1));
        assert_eq!(Adjacency::new(&[0, 1, 2], &[0, 1], 1), Err(AdjacencyError::Index { position: 1 }));
        let none = Adjacency::new(&[0], &[], 0).unwrap();
        let one = Adjacency::new(&[0, 0], &[], 0).unwrap();
        let wrong = |slice, expected, actual| Err(LengthError { slice, expected, actual });
        assert_eq!(Neighbours::new(none, one, none), wrong(Slice::Corners, 0, 1));
        assert_eq!(Neighbours::new(none, none, one), wrong(Slice::Edges, 0, 1));
        let other = Adjacency::new(&[0], &[], 5).unwrap();
        assert_eq!(Neighbours::new(other, none, none), wrong(Slice::Centres, 5, 0));
    }

    proptest! {
        #[test]
        fn what_is_accepted_is_restored(
            v: [i32; 2], e: [i32; 4], f: [i32; 3], shift in 0_u32..32, a: i32, b in -6_i32..6,
        ) {
            let Some(b) = NonZeroI32::new(b) else { return Ok(()) };
            let a = I16F16::from_bits(a >> shift);
            let (v, e, f) = (v.map(|x| x >> shift), e.map(|x| x >> shift), f.map(|x| x >> shift));
            let (mut corners, mut edges) = (v, e);
            if valence_three().lift(&mut corners, &mut edges, &f, a, b).is_ok() {
                valence_three().inverse_lift(&mut corners, &mut edges, &f, a, b).unwrap();
            }
            prop_assert_eq!((corners, edges), (v, e));
        }
    }
}
