//! The triangles around an edge that stay when it is collapsed.

use super::corners::{NONE, next, previous};
use super::legality::MOST;
use super::surface::Surface;

/// A triangle that keeps two vertices and gets the merged vertex for its third.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wing {
    /// The two vertices that stay, counter-clockwise.
    pub(super) rim: [u32; 2],
}

/// The wings of an edge, those of its first end first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Star {
    wings: [Wing; MOST as usize],
    count: usize,
    /// How many belong to the first end.
    pub(super) split: usize,
    /// Vertices across from the edge, [`NONE`] on the boundary.
    pub(super) across: [u32; 2],
}

impl Star {
    /// Gathers the star of a side's edge, or nothing where it has more wings than a vertex may have.
    #[inline]
    pub(super) fn new(surface: &Surface, side: u32) -> Option<Self> {
        let corners = &surface.corners;
        let twin = corners.twin(side);
        let apex = |side: u32| if side == NONE { NONE } else { corners.from(previous(side)) };
        let wing = Wing { rim: [NONE; 2] };
        let mut star =
            Self { wings: [wing; MOST as usize], count: 0, split: 0, across: [apex(side), apex(twin)] };
        star.gather(surface, [side, twin])?;
        star.split = star.count;
        star.gather(surface, [twin, side])?;
        Some(star)
    }

    /// Gathers at the end where `out` begins and `back` ends: counter-clockwise from `out` round to `back` or up to the
    /// boundary, and from there clockwise on from `back`.
    fn gather(&mut self, surface: &Surface, [out, back]: [u32; 2]) -> Option<()> {
        let corners = &surface.corners;
        let stop = if back == NONE { NONE } else { next(back) };
        if out != NONE {
            let mut side = corners.left(out);
            while side != stop && side != NONE {
                self.add(surface, side)?;
                side = corners.left(side);
            }
            if side != NONE {
                return Some(());
            }
        }
        let mut side = if stop == NONE { NONE } else { corners.right(stop) };
        while side != NONE {
            self.add(surface, side)?;
            side = corners.right(side);
        }
        Some(())
    }

    fn add(&mut self, surface: &Surface, side: u32) -> Option<()> {
        let corners = &surface.corners;
        let rim = [corners.to(side), corners.from(previous(side))];
        *self.wings.get_mut(self.count)? = Wing { rim };
        self.count += 1;
        Some(())
    }

    pub(super) fn wings(&self) -> &[Wing] {
        &self.wings[..self.count]
    }

    /// Whether the ends have no neighbour in common but those across from the edge: the link condition, under which a
    /// collapse keeps the topology.
    pub(super) fn is_simple(&self) -> bool {
        let (first, second) = self.wings().split_at(self.split);
        let shared = |vertex: u32| vertex != self.across[0] && vertex != self.across[1];
        let apart = |one: &Wing, two: &Wing| {
            let [from, to] = one.rim;
            from != two.rim[0]
                && to != two.rim[1]
                && (to != two.rim[0] || !shared(to))
                && (from != two.rim[1] || !shared(from))
        };
        self.across[0] != self.across[1] && first.iter().all(|one| second.iter().all(|two| apart(one, two)))
    }
}
