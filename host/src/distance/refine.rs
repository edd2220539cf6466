//! The nearest point of each node, once points have been handed on.

use super::block::SITE;
use super::seed::{Seeding, Site};
use super::slide::Neighbours;
use super::surface::Foot;
use crate::mesh::Point;

/// Points farther apart than this, in edges of a cell, may lie on different parts of the surface.
const APART: f64 = 0.75;

/// How much nearer than the point itself, in edges of a cell, the surface around a neighbour's point may be.
const SLACK: f64 = 0.2;

/// What nearest points are found from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refined<'a> {
    pub(super) seeding: &'a Seeding<'a>,
    pub(super) neighbours: &'a Neighbours,
    pub(super) sites: &'a [Site],
    /// The word of each node's site, x fastest.
    pub(super) words: &'a [u32],
}

impl Refined<'_> {
    /// The nearest point of a node, by its number; `None` if no point reached it.
    ///
    /// The walk starts from the node's own point. Where two parts of the surface are about equally near, the point of the
    /// nearer one may have lost to one that happens to lie better; so the points of the six neighbours have another chance
    /// if they are almost as near, and elsewhere.
    pub(super) fn foot(&self, node: usize) -> Option<Foot> {
        let grid = self.seeding.grid;
        let from = self.seeding.position(grid.node(node));
        let own = self.site(node)?;
        let mut foot = self.neighbours.slide(self.seeding.surface, from, own.triangle);
        let apart = (APART * grid.spacing.min_element()).powi(2);
        let slack = SLACK * grid.spacing.max_element();
        for other in grid.neighbours(node).filter_map(|next| self.site(next)) {
            let point = Point::from_array(other.point.map(f64::from));
            let reach = foot.squared.sqrt() + slack;
            if from.distance_squared(point) < reach * reach && foot.point.distance_squared(point) > apart {
                let chance = self.neighbours.slide(self.seeding.surface, from, other.triangle);
                if chance.squared < foot.squared {
                    foot = chance;
                }
            }
        }
        Some(foot)
    }

    fn site(&self, node: usize) -> Option<&Site> {
        self.sites.get((self.words[node] & SITE) as usize)
    }
}
