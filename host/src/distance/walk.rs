//! Walks over neighbouring triangles to the nearest points of a row of nodes.

use wide::f32x8;

use super::lanes::LANES;
use super::rows::{Row, load, nodes, points, squared};
use super::surface::{Facet, NONE};

/// Most triangles of a walk. Most walks end after two or three, as they start near their end; around a vertex that is nearest in
/// itself there is no end.
const STEPS: usize = 6;

/// Squared distance, in squares of cells' edges, beyond which points may lie on different parts of the surface.
const APART: f32 = 0.25;

/// How far beside the point nearest to a node its own point may lie, squared, in squares of the greatest distance between
/// nodes.
const BESIDE: f32 = 1.4;

/// Squared distance that no node has from a point.
const NOWHERE: f32 = 1e30;

/// A node on its way.
#[derive(Clone, Copy, Debug)]
struct Step {
    node: u32,
    triangle: u32,
    /// Where it came from.
    from: u32,
    /// Squared distance there.
    squared: f32,
}

/// The nodes of a row, and their nearest points so far.
#[derive(Debug)]
pub(super) struct Walk<'a> {
    facets: &'a [Facet],
    /// Distance between nodes along the row.
    step: f32,
    /// Nearest that a point may be without being exact: the least distance between nodes, squared.
    near: f32,
    /// How much nearer than the point itself the surface around a node's point may be, squared.
    slack: f32,
    /// The other coordinates of the row.
    others: [f32; 2],
    /// Squared distance of each node, and of some beyond the last.
    pub(super) squared: Vec<f32>,
    /// The triangle of each node.
    pub(super) triangles: Vec<u32>,
    queue: Vec<Step>,
    next: Vec<Step>,
}

impl<'a> Walk<'a> {
    /// A walk in a grid whose nodes are `spacing` apart.
    pub(super) fn new(facets: &'a [Facet], spacing: [f32; 3]) -> Self {
        let near = spacing[0].min(spacing[1]).min(spacing[2]);
        let near = near * near;
        let far = spacing[0].max(spacing[1]).max(spacing[2]);
        let (squared, triangles) = (Vec::new(), Vec::new());
        Self {
            facets,
            step: spacing[0],
            near,
            slack: BESIDE * far * far,
            others: [0.0; 2],
            squared,
            triangles,
            queue: Vec::new(),
            next: Vec::new(),
        }
    }

    /// Finds the nearest points of a row of nodes, from those that were handed on to them.
    ///
    /// The walk starts from a node's own point. Where two parts of the surface are about equally near, the point of the
    /// nearer one may have lost to one that happens to lie better; so the points of neighbours have another chance if they
    /// are almost as near, and elsewhere.
    pub(super) fn run(&mut self, row: Row<'_>, count: usize, others: [f32; 2], neighbours: &[Row<'_>]) {
        self.others = others;
        self.triangles.clear();
        self.triangles.extend(row.triangles(count));
        self.squared.clear();
        for first in (0..count).step_by(LANES) {
            let squared = squared(&nodes(first, self.step, others), &points(row.window(first), 1));
            self.squared.extend_from_slice(squared.as_array());
        }
        for node in 0..count {
            if self.squared[node] > self.near && self.triangles[node] != NONE {
                self.start(node, self.triangles[node]);
            }
        }
        self.go();
        for first in (0..count).step_by(LANES) {
            self.chances(row, first, count, neighbours);
        }
        self.go();
    }

    fn start(&mut self, node: usize, triangle: u32) {
        self.queue.push(Step { node: node as u32, triangle, from: NONE, squared: f32::INFINITY });
    }

    /// Starts walks from those neighbours' points that may be nearer than a node's own, and are nearer than those looked at
    /// before.
    fn chances(&mut self, row: Row<'_>, first: usize, count: usize, neighbours: &[Row<'_>]) {
        let window = row.window(first);
        let places = nodes(first, self.step, self.others);
        let (own, best) = (points(window, 1), load(&self.squared, first));
        let may = best.simd_gt(f32x8::splat(self.near)) & best.simd_lt(f32x8::splat(NOWHERE));
        if may.none() {
            return;
        }
        let apart = f32x8::splat(APART);
        let mut least = best + self.slack;
        let sides = [(window, 0), (window, 2)].into_iter();
        for (window, shift) in sides.chain(neighbours.iter().map(|row| (row.window(first), 1))) {
            let theirs = points(window, shift);
            let offered = squared(&places, &theirs);
            let better = may & offered.simd_lt(least) & squared(&own, &theirs).simd_gt(apart);
            least = better.select(offered, least);
            let mut chances = better.to_bitmask();
            while chances != 0 {
                let lane = chances.trailing_zeros() as usize;
                chances &= chances - 1;
                if first + lane < count {
                    self.start(first + lane, window[3][lane + shift].to_bits());
                }
            }
        }
    }

    /// Lets all walks come to their end.
    fn go(&mut self) {
        for _ in 0..STEPS {
            let queue = std::mem::take(&mut self.queue);
            for steps in queue.chunks(LANES) {
                self.step(steps);
            }
            self.queue = std::mem::replace(&mut self.next, queue);
            self.next.clear();
            if self.queue.is_empty() {
                break;
            }
        }
        self.queue.clear();
    }

    /// Looks at a triangle for each of up to eight nodes.
    fn step(&mut self, steps: &[Step]) {
        let lane = |lane: usize| steps[lane.min(steps.len() - 1)];
        let facets = std::array::from_fn(|at| &self.facets[lane(at).triangle as usize]);
        let places = f32x8::new(std::array::from_fn(|at| lane(at).node as f32)) * self.step;
        let from = [places, f32x8::splat(self.others[0]), f32x8::splat(self.others[1])];
        let (triangles, across) = Facet::gather(facets);
        let feet = triangles.feet(&from);
        let found = feet.squared.to_array();
        let from = f32x8::new(std::array::from_fn(|at| f32::from_bits(lane(at).from)));
        let next = feet.across(across, from).to_array();
        for (at, step) in steps.iter().enumerate() {
            // Selections instead of branches, which nobody could foretell.
            let (squared, node) = (found[at], step.node as usize);
            let (nearest, triangle) = (&mut self.squared[node], &mut self.triangles[node]);
            let nearer = squared < *nearest;
            *triangle = if nearer { step.triangle } else { *triangle };
            *nearest = if nearer { squared } else { *nearest };
            let goes_on = !next[at].is_nan() & (squared <= step.squared);
            self.next.push(Step { triangle: next[at].to_bits(), from: step.triangle, squared, ..*step });
            self.next.truncate(self.next.len() - usize::from(!goes_on));
        }
    }
}
