//! Walks over neighbouring triangles to the nearest points of a row of nodes.

use wide::{f32x8, i32x8};

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

/// A node on its way.
struct Step {
    node: u32,
    /// What it looks at next.
    triangle: u32,
    /// Where it comes from.
    from: u32,
    /// Squared distance to the nearest point so far.
    best: f32,
}

/// Eight nodes on their way; triangles that they come from as bits.
#[derive(Debug, Default)]
struct Steps {
    nodes: [i32; LANES],
    triangles: [u32; LANES],
    from: [f32; LANES],
    best: [f32; LANES],
}

/// Nodes on their way; those beyond the length are left over.
#[derive(Debug, Default)]
struct Queue {
    steps: Vec<Steps>,
    length: usize,
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
        self.queue.push(ones(on.to_bitmask()).map(|lane| Step {
            node: (first + lane) as u32,
            triangle: next.as_array()[lane].to_bits(),
            from: triangles[lane],
            best: found.as_array()[lane],
        }));
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
            let triangles = &self.triangles[first..][..LANES];
            let news = |&lane: &usize| ![NONE, triangles[lane]].contains(&eight.triangles[lane]);
            self.queue.push(ones(better.to_bitmask()).filter(news).map(|lane| Step {
                node: (first + lane) as u32,
                triangle: eight.triangles[lane],
                from: NONE,
                best: best.as_array()[lane],
            }));
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
                self.step(&queue.steps[first / LANES], queue.length - first, detour);
            }
            self.queue = std::mem::replace(&mut self.next, queue);
            self.next.length = 0;
        }
        self.queue.length = 0;
    }

    /// Looks at a triangle for each of up to eight nodes.
    fn step(&mut self, steps: &Steps, count: usize, detour: f32) {
        let mut from = self.places(0);
        from[0] = f32x8::from_i32x8(i32x8::new(steps.nodes)) * self.spacing[0];
        let before = f32x8::new(steps.best);
        let (found, next) = self.look(&steps.triangles, &from, f32x8::new(steps.from));
        let all = if count < LANES { (1 << count) - 1 } else { u32::MAX };
        for lane in ones(found.simd_lt(before).to_bitmask() & all) {
            let (node, found) = (steps.nodes[lane] as usize, found.as_array()[lane]);
            // Another walk of the node may have been nearer.
            if found < self.squared[node] {
                self.squared[node] = found;
                self.triangles[node] = steps.triangles[lane];
            }
        }
        let on = found.simd_le(before + detour) & next.simd_eq(next);
        let best = found.fast_min(before);
        self.next.push(ones(on.to_bitmask() & all).map(|lane| Step {
            node: steps.nodes[lane] as u32,
            triangle: next.as_array()[lane].to_bits(),
            from: steps.triangles[lane],
            best: best.as_array()[lane],
        }));
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
    /// Up to eight steps more.
    #[inline(always)]
    fn push(&mut self, steps: impl Iterator<Item = Step>) {
        let mut length = self.length;
        if length / LANES + 1 >= self.steps.len() {
            self.steps.resize_with(2 * self.steps.len() + 2, Steps::default);
        }
        for step in steps {
            let (lane, steps) = (length % LANES, &mut self.steps[length / LANES]);
            steps.nodes[lane] = step.node as i32;
            steps.triangles[lane] = step.triangle;
            steps.from[lane] = f32::from_bits(step.from);
            steps.best[lane] = step.best;
            length += 1;
        }
        self.length = length;
    }
}
