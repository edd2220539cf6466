//! Closest points go from node to node.
//!
//! Sources: Dataflow §3 (queue, 26 neighbours, blocks with messages for the nodes on their faces), Distance §4.1. A node
//! hands its point on to neighbours that are nearer to it than to their own, and these will hand it on in the next round. All
//! of a round works with the points that nodes had when it began, and of several points offered to a node the nearest
//! stays, the one of lower order among equally near ones; so it does not matter which block works when.
//!
//! In round n only nodes nearer than about 0.6 n edges of a cell hand on; others wait in the queue. So most nodes have their
//! last point when they hand on, and fewer do so twice than in a plain queue.
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

/// How much farther from the surface nodes hand on in each round than in the one before, in edges of a cell.
const WIDTH: f32 = 0.6;

/// A node, by its place in a block, and the point that it hands on or is offered.
type Entry = (u32, u32);

/// What a block sends to its neighbours, which are numbered from 0 to 26 with the block itself in the middle.
#[derive(Debug, Default)]
struct Outbox {
    /// Neighbour by neighbour; nodes by their place there.
    entries: Vec<Entry>,
    /// Where the entries for each neighbour end, if there are any.
    ends: [u32; 27],
}

impl Outbox {
    fn new(mut letters: Vec<(u8, Entry)>) -> Self {
        letters.sort_unstable_by_key(|&(way, _)| way);
        let mut ends = [0; 27];
        letters.iter().for_each(|&(way, _)| ends[usize::from(way)] += 1);
        let mut sum = 0;
        ends.iter_mut().for_each(|end| {
            sum += *end;
            *end = sum;
        });
        Self { entries: letters.into_iter().map(|(_, entry)| entry).collect(), ends }
    }

    fn to(&self, way: usize) -> &[Entry] {
        let start = if way == 0 { 0 } else { self.ends[way - 1] };
        &self.entries[start as usize..self.ends[way] as usize]
    }
}

/// A block at work.
#[derive(Debug)]
struct Worker<'a> {
    block: Block,
    layout: &'a Layout,
    sites: &'a [Site],
    /// Nodes that hand on in this round.
    queue: Vec<Entry>,
    /// Nodes that got another point and have not handed it on yet.
    waiting: Vec<u32>,
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
        let step = WIDTH * seeding.grid.spacing.min_element() as f32;
        while workers.iter().any(|worker| !worker.waiting.is_empty() || !worker.queue.is_empty()) {
            rounds += 1;
            let outboxes: Vec<Outbox> = workers.par_iter_mut().map(Worker::hand_on).collect();
            let due = step * rounds as f32;
            workers.par_iter_mut().for_each(|worker| worker.receive(&outboxes, due * due));
        }
        let updates = workers.iter().map(|worker| worker.updates).sum();
        let blocks = workers.into_iter().map(|worker| worker.block).collect();
        Ok(Self { blocks, updates, rounds, sites, layout })
    }

    /// The words of the sites of all nodes, x fastest.
    pub(super) fn words(&self) -> Vec<u32> {
        let [width, height, depth] = self.layout.extent;
        let mut words = vec![0; width * height * depth];
        words.par_chunks_mut(width).enumerate().for_each(|(row, words)| {
            words.iter_mut().zip(self.row(row % height, row / height)).for_each(|(word, site)| *word = site);
        });
        words
    }

    /// The words of the sites of a row of nodes along x.
    fn row(&self, y: usize, z: usize) -> impl Iterator<Item = u32> {
        let layout = &self.layout;
        let [side, y_side, z_side] = layout.side;
        let start = layout.index([1, y % y_side + 1, z % z_side + 1]);
        let first = layout.number([0, y / y_side, z / z_side]);
        let blocks = self.blocks[first..first + layout.blocks[0]].iter();
        blocks.flat_map(move |block| block.sites[start..start + side].iter().copied()).take(layout.extent[0])
    }
}

impl<'a> Worker<'a> {
    /// Queues the seeds.
    fn new(mut block: Block, layout: &'a Layout, sites: &'a [Site]) -> Self {
        let seeds = block.sites.iter().enumerate().filter(|(_, site)| *site & SEED != 0);
        let waiting: Vec<u32> = seeds.map(|(at, _)| at as u32).collect();
        waiting.iter().for_each(|&at| block.sites[at as usize] |= WAITS);
        Self { block, layout, sites, queue: Vec::new(), waiting, outgoing: Vec::new(), updates: 0 }
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
        let [_, stride, plane] = self.layout.strides();
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
            if on_border { &mut self.outgoing } else { &mut self.waiting }.push(at as u32);
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
        let side = self.layout.side;
        let letters = self.outgoing.drain(..).map(|at| {
            let coordinates = self.layout.coordinates(at as usize);
            let ways: [usize; 3] = std::array::from_fn(|axis| {
                usize::from(coordinates[axis] > 0) + usize::from(coordinates[axis] > side[axis])
            });
            let there = std::array::from_fn(|axis| coordinates[axis] + side[axis] - ways[axis] * side[axis]);
            let site = &mut self.block.sites[at as usize];
            *site &= !WAITS;
            let way = (ways[2] * 3 + ways[1]) * 3 + ways[0];
            (way as u8, (self.layout.index(there) as u32, *site & SITE))
        });
        Outbox::new(letters.collect())
    }

    /// Takes what other blocks sent, and queues all nodes that wait and are less than a squared distance away.
    fn receive(&mut self, outboxes: &[Outbox], due: f32) {
        let place = self.block.place;
        for way in 0..27 {
            let ways = [way % 3, way / 3 % 3, way / 9];
            let sender = std::array::from_fn(|axis| (place[axis] + 1).wrapping_sub(ways[axis]));
            if (0..3).any(|axis| sender[axis] >= self.layout.blocks[axis]) {
                continue;
            }
            for &(at, site) in outboxes[self.layout.number(sender)].to(way) {
                let squared = self.squared(at as usize, site);
                if squared <= self.block.squared[at as usize] && self.take(at as usize, site, squared) {
                    self.waiting.push(at);
                }
            }
        }
        let (block, queue) = (&mut self.block, &mut self.queue);
        self.waiting.retain(|&at| {
            let is_due = block.squared[at as usize] < due;
            if is_due {
                block.sites[at as usize] &= !WAITS;
                queue.push((at, block.sites[at as usize] & SITE));
            }
            !is_due
        });
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
