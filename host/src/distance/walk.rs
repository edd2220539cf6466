//! Walks over neighbouring triangles to the nearest points of a row of nodes.

use wide::{f32x8, i32x8, u32x8};

use super::lanes::{LANES, Points, dot, minus, ones};
use super::rows::{Eight, Ruler, load, nodes, squared};
use super::surface::{Facet, NONE};

/// Most triangles of a walk are as many as lie on a way of this length, in cells' edges, but at least and at most so many. Most
/// walks end after two or three, as they start near their end; around a vertex that is nearest in itself there is no end.
const WAY: f32 = 2.5;
const STEPS: [usize; 2] = [4, 16];

/// How many triangles tell about how large all are.
const SAMPLE: usize = 4096;

/// Squared distance, in squares of cells' edges, beyond which points may lie on different parts of the surface.
const APART: f32 = 0.25;

/// How much farther than nodes their points may be apart, squared, in squares of cells' edges, and still lie beside each other
/// on a part of the surface that is about flat.
const ALONG: f32 = 0.03;

/// How far beside the point nearest to a node its own point may lie, squared, in squares of the greatest distance between
/// nodes.
const BESIDE: f32 = 1.4;

/// How much farther than the nearest point so far a walk on another part of the surface may lead at least, squared, in squares of the
/// greatest distance between nodes: there it may be on its way to a nearer one.
const DETOUR: f32 = 0.5;

/// How much shorter the greatest detour, which is [`BESIDE`], may be with the length of triangles' sides: the first triangle
/// of a walk is nearer to its end if it is large.
const SHORTER: f32 = 1.2;

/// Squared distance that no node has from a point.
const NOWHERE: f32 = 1e30;

/// The nodes of a row, and their nearest points so far.
#[derive(Debug)]
pub(super) struct Walk<'a> {
    facets: &'a [Facet],
    /// Most triangles of a walk.
    steps: usize,
    /// Distance between nodes.
    spacing: [f32; 3],
    ruler: Ruler,
    /// Nearest that a point may be without being exact: the least distance between nodes, squared.
    near: f32,
    /// How much nearer than the point itself the surface around a node's point may be, squared.
    slack: f32,
    /// How much farther, squared, walks on other parts of the surface may lead.
    detour: f32,
    /// The row's y and z, in nodes.
    at: [usize; 2],
    /// Squared distance of each node, and of some beyond the last.
    pub(super) squared: Vec<f32>,
    /// The triangle of each node, and of some beyond the last.
    pub(super) triangles: Vec<u32>,
    queue: Queue,
    next: Queue,
}

/// Nodes on their way, in vectors side by side, so that those of eight that go on are put in together.
#[derive(Debug, Default)]
struct Queue {
    nodes: Vec<u32>,
    /// What they look at next.
    triangles: Vec<u32>,
    /// Where they come from.
    from: Vec<u32>,
    /// Squared distances to the nearest points so far.
    best: Vec<f32>,
    /// How many there are; beyond, vectors hold what is left over.
    length: usize,
}

/// Eight nodes on their way, as a queue has them.
#[derive(Clone, Copy)]
struct Steps {
    nodes: u32x8,
    triangles: u32x8,
    from: u32x8,
    best: f32x8,
}

impl<'a> Walk<'a> {
    /// A walk over triangles whose sides are about as long as `side`, in a grid whose nodes are `spacing` apart.
    pub(super) fn new(facets: &'a [Facet], side: f32, spacing: [f32; 3], ruler: Ruler) -> Self {
        let near = spacing[0].min(spacing[1]).min(spacing[2]);
        let far = spacing[0].max(spacing[1]).max(spacing[2]);
        Self {
            facets,
            steps: ((WAY / side).ceil() as usize).clamp(STEPS[0], STEPS[1]),
            spacing,
            ruler,
            near: near * near,
            slack: BESIDE * far * far,
            detour: (BESIDE - SHORTER * side).clamp(DETOUR, BESIDE) * far * far,
            at: [0; 2],
            squared: Vec::new(),
            triangles: Vec::new(),
            queue: Queue::default(),
            next: Queue::default(),
        }
    }

    /// Finds the nearest points of the row of nodes at some y and z, from those that were handed on to them.
    ///
    /// The walk starts from a node's own point. Where two parts of the surface are about equally near, the point of the
    /// nearer one may have lost to one that happens to lie better; so the points of neighbours have another chance if they
    /// are almost as near, and elsewhere.
    pub(super) fn run(&mut self, row: &[Eight], at: [usize; 2], neighbours: &[(&[Eight], usize, f32)]) {
        self.at = at;
        self.triangles.clear();
        self.triangles.extend(row.iter().flat_map(|eight| eight.triangles));
        self.squared.clear();
        for (number, eight) in row.iter().enumerate() {
            self.start(number * LANES, eight);
        }
        self.go(self.steps - 1, 0.0);
        for number in 0..row.len() {
            self.chances(row, number, neighbours);
        }
        self.go(self.steps, self.detour);
    }

    /// Looks at the triangles of the points of eight nodes.
    fn start(&mut self, first: usize, eight: &Eight) {
        let going = eight.triangles.map(|triangle| triangle != NONE);
        let Some(any) = going.iter().position(|&goes| goes) else {
            self.squared.extend_from_slice(&[f32::INFINITY; LANES]);
            return;
        };
        // Nodes without a triangle look at that of another node.
        let triangles = std::array::from_fn(|lane| eight.triangles[if going[lane] { lane } else { any }]);
        let (found, next) = self.look(&triangles, &self.places(first), f32x8::splat(f32::from_bits(NONE)));
        let found = found + f32x8::new(going.map(|goes| if goes { 0.0 } else { f32::INFINITY }));
        self.squared.extend_from_slice(found.as_array());
        let on = self.may_go(found) & next.simd_eq(next);
        let nodes = numbers(first);
        let steps = Steps { nodes, triangles: bits(next), from: u32x8::new(triangles), best: found };
        self.queue.push(on.to_bitmask(), steps);
    }

    /// Where eight nodes lie.
    #[inline(always)]
    fn places(&self, first: usize) -> Points {
        let [y, z] = [1, 2].map(|axis: usize| self.at[axis - 1] as f32 * self.spacing[axis]);
        nodes(first, self.spacing[0], [y, z])
    }

    /// Nodes that have a point, and not an exact one.
    #[inline(always)]
    fn may_go(&self, squared: f32x8) -> f32x8 {
        squared.simd_gt(f32x8::splat(self.near)) & squared.simd_lt(f32x8::splat(NOWHERE))
    }

    /// Starts walks from those neighbours' points that may be nearer than a node's own, and are nearer than those looked at
    /// before.
    fn chances(&mut self, row: &[Eight], number: usize, neighbours: &[(&[Eight], usize, f32)]) {
        let first = number * LANES;
        let best = load(&self.squared, first);
        let may = self.may_go(best);
        if may.none() {
            return;
        }
        let ruler = self.ruler;
        let [y, z] = [1, 2].map(|axis: usize| f32x8::splat(ruler.node(axis, self.at[axis - 1])));
        let (places, own) = ([ruler.nodes(0, first), y, z], row[number].all());
        let square = ruler.marks * ruler.marks;
        let (apart, along) = (f32x8::splat(APART * square), f32x8::splat(ALONG * square));
        let mut least = (best + self.slack) * square;
        let [looked_at, none] = [eight_of(&self.triangles, first), u32x8::splat(NONE)];
        let mut look = |eight: &Eight, axis: usize, step: f32| {
            let theirs = eight.all();
            let offered = squared(&places, &theirs);
            // How much farther points are apart than their nodes.
            let mut aside = minus(&theirs, &own);
            let far = dot(&aside, &aside);
            aside[axis] -= f32x8::splat(step);
            let differs = far.simd_gt(apart) & dot(&aside, &aside).simd_gt(along);
            let better = may & offered.simd_lt(least) & differs;
            least = better.select(offered, least);
            let triangles = u32x8::new(eight.triangles);
            let known = triangles.simd_eq(looked_at) | triangles.simd_eq(none);
            let steps = Steps { nodes: numbers(first), triangles, from: none, best };
            self.queue.push(better.to_bitmask() & !known.to_bitmask(), steps);
        };
        let before = number.checked_sub(1).map_or(&Eight::NONE, |before| &row[before]);
        look(&row[number].after(before), 0, -ruler.step[0]);
        look(&row.get(number + 1).unwrap_or(&Eight::NONE).before(&row[number]), 0, ruler.step[0]);
        for (neighbour, axis, step) in neighbours {
            look(&neighbour[number], *axis, *step * ruler.step[*axis]);
        }
    }

    /// Lets all walks come to their end, but for what is more than some steps away. A walk goes on while it is at most by
    /// `detour` farther than the nearest point so far, squared.
    fn go(&mut self, steps: usize, detour: f32) {
        for _ in 0..steps {
            if self.queue.length == 0 {
                break;
            }
            let queue = std::mem::take(&mut self.queue);
            for first in (0..queue.length).step_by(LANES) {
                self.step(&queue.steps(first), queue.length - first, detour);
            }
            self.queue = std::mem::replace(&mut self.next, queue);
            self.next.length = 0;
        }
        self.queue.length = 0;
    }

    /// Looks at a triangle for each of up to eight nodes.
    fn step(&mut self, steps: &Steps, count: usize, detour: f32) {
        let mut from = self.places(0);
        let [nodes, triangles] = [steps.nodes, steps.triangles].map(u32x8::to_array);
        from[0] = f32x8::from_i32x8(i32x8::new(nodes.map(|node| node as i32))) * self.spacing[0];
        let before = steps.best;
        let (found, next) =
            self.look(&triangles, &from, f32x8::new(steps.from.to_array().map(f32::from_bits)));
        let all = if count < LANES { (1 << count) - 1 } else { u32::MAX };
        for lane in ones(found.simd_lt(before).to_bitmask() & all) {
            let (node, found) = (nodes[lane] as usize, found.as_array()[lane]);
            // Another walk of the node may have been nearer.
            if found < self.squared[node] {
                self.squared[node] = found;
                self.triangles[node] = triangles[lane];
            }
        }
        let on = found.simd_le(before + detour) & next.simd_eq(next);
        let steps =
            Steps { triangles: bits(next), from: steps.triangles, best: found.fast_min(before), ..*steps };
        self.next.push(on.to_bitmask() & all, steps);
    }

    /// Squared distances of eight points from a triangle each, and the triangles across the side that is nearest, as bits,
    /// but not those that are `not` wanted: no number where there is none.
    #[inline(always)]
    fn look(&self, triangles: &[u32; LANES], from: &Points, not: f32x8) -> (f32x8, f32x8) {
        let facets = std::array::from_fn(|lane| &self.facets[triangles[lane] as usize]);
        let (triangles, across) = Facet::gather(facets);
        let feet = triangles.feet(from);
        (feet.squared, feet.across(across, not))
    }
}

/// How long the first sides of triangles are.
pub(super) fn mean_side(facets: &[Facet]) -> f32 {
    let some = facets.iter().step_by(facets.len() / SAMPLE + 1);
    some.clone().map(Facet::side).sum::<f32>() / some.len() as f32
}

impl Queue {
    /// Adds some of eight steps.
    #[inline(always)]
    fn push(&mut self, some: u32, steps: Steps) {
        if self.length + LANES > self.nodes.len() {
            self.grow();
        }
        let (order, kept) = (u32x8::new(ORDERS[some as usize]), numbers(0).simd_lt(some.count_ones()));
        let put = |numbers: &mut [u32], eight: u32x8| {
            numbers[self.length..][..LANES].copy_from_slice(eight.as_array());
        };
        let [nodes, triangles, from, best] =
            [steps.nodes, steps.triangles, steps.from, bits(steps.best)].map(|eight| eight.shuffle(order));
        put(&mut self.nodes, nodes);
        // What is left over looks at some triangle.
        put(&mut self.triangles, triangles & kept);
        put(&mut self.from, from);
        put(bytemuck::cast_slice_mut(&mut self.best), best);
        self.length += some.count_ones() as usize;
    }

    #[cold]
    fn grow(&mut self) {
        let room = (2 * self.length + LANES).next_multiple_of(LANES);
        for numbers in [&mut self.nodes, &mut self.triangles, &mut self.from] {
            numbers.resize(room, 0);
        }
        self.best.resize(room, 0.0);
    }

    /// Eight steps, of which the last may be left over.
    #[inline(always)]
    fn steps(&self, first: usize) -> Steps {
        Steps {
            nodes: eight_of(&self.nodes, first),
            triangles: eight_of(&self.triangles, first),
            from: eight_of(&self.from, first),
            best: load(&self.best, first),
        }
    }
}

/// For each set of lanes, the lanes in an order in which those of the set come first.
static ORDERS: [[u32; LANES]; 1 << LANES] = {
    let mut orders = [[0; LANES]; 1 << LANES];
    let mut set = 0;
    while set < orders.len() {
        let (mut lane, mut place) = (0, 0);
        while lane < LANES {
            if set >> lane & 1 == 1 {
                orders[set][place] = lane as u32;
                place += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    orders
};

/// Eight numbers from one on.
#[inline(always)]
fn numbers(first: usize) -> u32x8 {
    u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]) + u32x8::splat(first as u32)
}

/// Eight numbers of many.
#[inline(always)]
fn eight_of(numbers: &[u32], first: usize) -> u32x8 {
    u32x8::new(*numbers[first..].first_chunk().expect("vectors end with room for eight"))
}

/// Numbers as bits.
#[inline(always)]
fn bits(numbers: f32x8) -> u32x8 {
    bytemuck::cast(numbers)
}
