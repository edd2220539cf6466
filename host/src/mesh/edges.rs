//! The edges of a mesh, each with all sides of faces that run along it.

use rayon::prelude::*;

use super::Surface;

/// A side of a face. Corners are numbered through all faces in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The smaller vertex first.
    pub(super) ends: [u32; 2],
    pub(super) face: u32,
    /// Corners at `ends`.
    pub(super) corners: [u32; 2],
    /// Whether the face runs from the smaller vertex to the larger one.
    pub(super) forward: bool,
}

/// All sides, those of an edge one after another.
#[derive(Debug)]
pub(super) struct Edges {
    sides: Vec<Side>,
}

impl Edges {
    /// Sorts the sides of all faces; those from a vertex to itself are left out.
    pub(super) fn new(surface: &impl Surface) -> Self {
        let mut sides = Vec::new();
        let mut first = 0;
        for (face, corners) in surface.polygons().enumerate() {
            for (place, &from) in corners.iter().enumerate() {
                let next = (place + 1) % corners.len();
                let (to, forward) = (corners[next], from < corners[next]);
                let places = [first + place as u32, first + next as u32];
                let (ends, corners) =
                    if forward { ([from, to], places) } else { ([to, from], [places[1], places[0]]) };
                if from != to {
                    sides.push(Side { ends, face: face as u32, corners, forward });
                }
            }
            first += corners.len() as u32;
        }
        sides.par_sort_unstable();
        Self { sides }
    }

    /// The sides of each edge, in order of the ends.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.ends == b.ends)
    }
}

/// Sets that grow together, of numbers from 0.
#[derive(Clone, Debug)]
pub(crate) struct Sets {
    parents: Vec<u32>,
}

impl Sets {
    pub(crate) fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// The smallest number of the set of `of`.
    pub(crate) fn root(&mut self, of: u32) -> u32 {
        let mut at = of as usize;
        while self.parents[at] as usize != at {
            self.parents[at] = self.parents[self.parents[at] as usize];
            at = self.parents[at] as usize;
        }
        at as u32
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The set of each number, and how many sets there are; sets are counted in the order of their smallest numbers.
    pub(crate) fn counted(mut self) -> (Vec<u32>, usize) {
        let (mut set_of, mut count) = (Vec::with_capacity(self.parents.len()), 0);
        for number in 0..self.parents.len() as u32 {
            let root = self.root(number);
            set_of.push(if root == number { count } else { set_of[root as usize] });
            count += u32::from(root == number);
        }
        (set_of, count as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_counted_by_their_smallest_numbers() {
        let mut sets = Sets::new(7);
        [[5, 3], [6, 1], [3, 1], [4, 2]].into_iter().for_each(|[a, b]| sets.join(a, b));
        assert_eq!(sets.counted(), (vec![0, 1, 2, 1, 2, 1, 1], 3));
    }
}
