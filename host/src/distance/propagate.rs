//! Closest points go from node to node.
//!
//! Sources: Dataflow §3 (queue, 26 neighbours, blocks with messages for the nodes on their faces), Distance §4.1. A node
//! hands its point on to neighbours that are nearer to it than to their own, and these will hand it on in the next round. All
//! of a round works with the points that nodes had when it began, and of several points offered to a node the nearest
//! stays, the one of lower order among equally near ones; so it does not matter which block works when.
//!
//! A node looks only at neighbours that are not nearer to its point than it is itself along any axis: those on the other
//! side have had it already, or one that is nearer. A node within half a cell of its point along an axis looks both ways
//! along it.

use rayon::prelude::*;

use super::DistanceError;
use super::block::{Block, Layout, NONE, SEED, SITE, WAITS};
use super::seed::{Seeding, Site};

/// Nodes with their closest points.
#[derive(Debug)]
pub(super) struct Propagation {
    pub(super) layout: Layout,
    pub(super) blocks: Vec<Block>,
    pub(super) sites: Vec<Site>,
    pub(super) updates: u64,
    pub(super) rounds: usize,
}

/// A node, by its place in a block, and the point that it hands on or is offered.
type Entry = (u32, u32);

/// What a block sends: for each of its 27 neighbours (itself in the middle), nodes by their place there.
type Outbox = Vec<Vec<Entry>>;

/// A block at work.
#[derive(Debug)]
struct Worker<'a> {
    block: Block,
    layout: &'a Layout,
    sites: &'a [Site],
    /// Nodes that hand on in this round.
    queue: Vec<Entry>,
    /// Nodes that got another point in this round.
    changed: Vec<u32>,
    /// Border nodes that did.
    outgoing: Vec<u32>,
    updates: u64,
}

impl Propagation {
    /// Seeds and propagates.
    pub(super) fn run(seeding: &Seeding<'_>, limit: f64) -> Result<Self, DistanceError> {
        let layout = seeding.layout.clone();
        // Points may come from a little beyond the limit, as the slide brings them nearer.
        let reach = (limit + seeding.grid.spacing.length()) as f32;
        let mut blocks: Vec<Block> =
            (0..layout.len()).into_par_iter().map(|number| layout.block(number, reach * reach)).collect();
        let sites = seeding.run(&mut blocks);
        if sites.is_empty() {
            return Err(DistanceError::NoSurface);
        }
        if sites.len() >= NONE as usize {
            return Err(DistanceError::Grid("2^30 nodes or more near the surface"));
        }
        let mut workers: Vec<Worker> =
            blocks.into_par_iter().map(|block| Worker::new(block, &layout, &sites)).collect();
        let mut rounds = 0;
        while workers.iter().any(|worker| !worker.queue.is_empty()) {
            rounds += 1;
            let outboxes: Vec<Outbox> = workers.par_iter_mut().map(Worker::hand_on).collect();
            workers.par_iter_mut().for_each(|worker| worker.receive(&outboxes));
        }
        let updates = workers.iter().map(|worker| worker.updates).sum();
        let blocks = workers.into_iter().map(|worker| worker.block).collect();
        Ok(Self { blocks, updates, rounds, sites, layout })
    }

    /// The word of a node's site.
    pub(super) fn word(&self, node: [usize; 3]) -> u32 {
        let side = self.layout.side;
        let place = std::array::from_fn(|axis| node[axis] / side[axis]);
        let at = std::array::from_fn(|axis| node[axis] % side[axis] + 1);
        self.blocks[self.layout.number(place)].sites[self.layout.index(at)]
    }

    /// Number of the site in a node's word.
    pub(super) fn site(word: u32) -> usize {
        (word & SITE) as usize
    }

    /// The triangle of a node's point, `None` if the node got none within the limit.
    pub(super) fn triangle(&self, word: u32) -> Option<u32> {
        self.sites.get(Self::site(word)).map(|site| site.triangle)
    }
}

impl<'a> Worker<'a> {
    /// Queues the seeds.
    fn new(block: Block, layout: &'a Layout, sites: &'a [Site]) -> Self {
        let seeds = block.sites.iter().enumerate().filter(|(_, site)| *site & SEED != 0);
        let queue: Vec<Entry> = seeds.map(|(at, site)| (at as u32, site & SITE)).collect();
        let updates = queue.len() as u64;
        Self { block, layout, sites, queue, changed: Vec::new(), outgoing: Vec::new(), updates }
    }

    /// Hands on the points of all queued nodes; returns what concerns other blocks.
    fn hand_on(&mut self) -> Outbox {
        let queue = std::mem::take(&mut self.queue);
        for &(at, site) in &queue {
            self.hand_on_from(at as usize, site);
        }
        self.queue = queue;
        self.queue.clear();
        self.outbox()
    }

    /// Hands on the point of one node.
    fn hand_on_from(&mut self, at: usize, site: u32) {
        let (stride, plane) = (self.layout.across(0), self.layout.across(0) * self.layout.across(1));
        let coordinates = self.layout.coordinates(at);
        let point = self.sites[site as usize].point;
        let mut steps = [[0, 2]; 3];
        let mut squares = [[0.0; 3]; 3];
        for axis in 0..3 {
            let offsets = [0, 1, 2].map(|step| {
                let at = coordinates[axis] + step - 1;
                self.layout.coordinate(axis, self.block.place[axis], at) - point[axis]
            });
            squares[axis] = offsets.map(|offset| offset * offset);
            let half = 0.5 * self.layout.spacing[axis];
            steps[axis] = [usize::from(offsets[1] > half), 2 - usize::from(offsets[1] < -half)];
        }
        let [x, y, z] = steps;
        for dz in z[0]..=z[1] {
            for dy in y[0]..=y[1] {
                let row = at + dz * plane + dy * stride - plane - stride - 1;
                for dx in x[0]..=x[1] {
                    let squared = squares[0][dx] + squares[1][dy] + squares[2][dz];
                    self.offer(row + dx, site, squared, [dx, dy, dz], coordinates);
                }
            }
        }
    }

    /// Offers a point to the neighbour `step` - 1 away from a node.
    #[inline]
    fn offer(&mut self, at: usize, site: u32, squared: f32, step: [usize; 3], from: [usize; 3]) {
        if squared <= self.block.squared[at] && self.take(at, site, squared) {
            let on_border = (0..3).any(|axis| {
                let coordinate = from[axis] + step[axis] - 1;
                coordinate == 0 || coordinate == self.layout.side[axis] + 1
            });
            if on_border { &mut self.outgoing } else { &mut self.changed }.push(at as u32);
        }
    }

    /// Gives a node a point unless its own is nearer or of lower order. Returns whether it begins to wait.
    fn take(&mut self, at: usize, site: u32, squared: f32) -> bool {
        let word = self.block.sites[at];
        if squared == self.block.squared[at] {
            let own = word & SITE;
            if own == site || own == NONE || self.sites[own as usize] <= self.sites[site as usize] {
                return false;
            }
        }
        self.block.squared[at] = squared;
        self.block.sites[at] = word & SEED | WAITS | site;
        word & WAITS == 0
    }

    /// What border nodes were offered, for the blocks that they belong to.
    fn outbox(&mut self) -> Outbox {
        let mut outbox = Outbox::new();
        let side = self.layout.side;
        for at in self.outgoing.drain(..) {
            outbox.resize(27, Vec::new());
            let coordinates = self.layout.coordinates(at as usize);
            let ways: [usize; 3] = std::array::from_fn(|axis| {
                usize::from(coordinates[axis] > 0) + usize::from(coordinates[axis] > side[axis])
            });
            let there = std::array::from_fn(|axis| coordinates[axis] + side[axis] - ways[axis] * side[axis]);
            let site = &mut self.block.sites[at as usize];
            *site &= !WAITS;
            let entry = (self.layout.index(there) as u32, *site & SITE);
            outbox[(ways[2] * 3 + ways[1]) * 3 + ways[0]].push(entry);
        }
        outbox
    }

    /// Takes what other blocks sent, and queues all nodes that got another point in this round.
    fn receive(&mut self, outboxes: &[Outbox]) {
        let place = self.block.place;
        for way in 0..27 {
            let ways = [way % 3, way / 3 % 3, way / 9];
            let sender = std::array::from_fn(|axis| (place[axis] + 1).wrapping_sub(ways[axis]));
            if (0..3).any(|axis| sender[axis] >= self.layout.blocks[axis]) {
                continue;
            }
            for &(at, site) in outboxes[self.layout.number(sender)].get(way).into_iter().flatten() {
                let squared = self.squared(at as usize, site);
                if squared <= self.block.squared[at as usize] && self.take(at as usize, site, squared) {
                    self.changed.push(at);
                }
            }
        }
        for at in self.changed.drain(..) {
            let site = &mut self.block.sites[at as usize];
            *site &= !WAITS;
            self.queue.push((at, *site & SITE));
        }
        self.updates += self.queue.len() as u64;
    }

    /// Squared distance of a node from a point, summed as in [`Worker::hand_on_from`].
    fn squared(&self, at: usize, site: u32) -> f32 {
        let coordinates = self.layout.coordinates(at);
        let point = self.sites[site as usize].point;
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let offset =
                self.layout.coordinate(axis, self.block.place[axis], coordinates[axis]) - point[axis];
            offset * offset
        });
        x + y + z
    }
}
