//! Edge collapse: a triangle mesh of few vertices with the topology and the features of one of many.
//!
//! Source: Vis2000 §4.1, Diss §4.1.5.
//!
//! Edges wait in the bucket queue with the error that they had when they were last looked at. An edge that comes out is
//! looked at again: it goes back in if its error has grown, and out if it may not be collapsed; the edges around a collapse
//! that are not in the queue are looked at then. Edges of too large an error wait too, so that they are not looked at after
//! each collapse nearby.
//!
//! One queue over a large mesh jumps about in memory. While the mesh is much larger than the target, it is therefore taken
//! in *windows*, runs of triangles as they come, and in each of them the edges of small error are collapsed in order.

use std::ops::Range;

use super::corners::{NONE, next, previous};
use super::deviation::{Candidate, candidate};
use super::history::{History, Names};
use super::legality::{Place, place};
use super::parts::Parts;
use super::priority::{BucketQueue, rank};
use super::star::Star;
use super::surface::{Surface, Vertex};
use super::{Constraints, SimplifyError, Target};
use crate::mesh::{Features, TriangleMesh};

/// Sides in a window: what is at them fits the second cache.
const WINDOW: u32 = 3 << 14;
/// The share of the vertices that must be left after the windows, one in so many.
const SHARE: usize = 4;
/// How many times the target must be left then.
const MARGIN: usize = 2;
/// Vertices that one queue is quick with.
const LARGE: usize = 1 << 11;
/// One edge in so many is looked at for the median.
const SAMPLE: usize = 31;
/// Error up to which windows collapse edges, in median errors of the edges before.
const EASY: f64 = 2.0;

/// A round that takes away less than one vertex in so many is the last.
const LAST: usize = 64;

/// What collapsing edges left.
#[derive(Clone, Debug)]
pub struct Collapsed {
    /// The smaller mesh.
    pub mesh: TriangleMesh,
    /// Its features.
    pub features: Features,
    /// The largest error that a collapse was taken for, in units of the positions.
    pub error: f64,
    /// How it came about, if that was to be recorded.
    pub history: Option<History>,
}

/// Collapses edges of a manifold, the least harmful first, until `target` is met or no edge may be collapsed.
///
/// Topology, features and boundary stay as the rules of [`super`] say, and a component keeps some vertices. The result
/// depends on nothing but the arguments.
///
/// A target may be out of reach: a closed component keeps four vertices at least, and one of Euler characteristic χ < 0 at
/// least 3 |χ|, as a vertex has at most eight edges; what is left of such components in practice is 5.3 to 5.7 |χ|.
///
/// # Errors
/// [`SimplifyError`], where the mesh is no oriented manifold, or features are not of it.
///
/// Cost: about 1.4 microseconds a triangle; 60 bytes a triangle, and 250 a vertex if collapses are recorded.
pub fn collapse_edges(
    mesh: &TriangleMesh,
    constraints: &Constraints,
    target: Target,
) -> Result<Collapsed, SimplifyError> {
    let mut surface = Surface::new(mesh, constraints)?;
    let per_unit = 1.0 / surface.mean_edge().max(f64::MIN_POSITIVE);
    for (vertex, &most) in surface.vertices.iter_mut().zip(&constraints.most) {
        vertex.most = most;
    }
    let limit = target.error * per_unit;
    let parts = Parts::new(&surface.vertices, &surface.corners);
    let mut collapse = Collapse::new(surface, parts, per_unit, limit);
    collapse.history = constraints.recorded.then(History::default);
    while collapse.vertices / (SHARE * MARGIN) >= target.vertices.max(LARGE) && collapse.windows(limit) {
        let Collapse { surface, mut parts, mut names, history, error, .. } = collapse;
        parts.compact(&surface.vertices);
        names.compact(&surface);
        collapse =
            Collapse { names, history, error, ..Collapse::new(surface.compact(), parts, per_unit, limit) };
    }
    collapse.window = 0..collapse.surface.corners.len();
    collapse.rounds(target.vertices);
    let Collapse { surface, mut names, mut history, error, .. } = collapse;
    names.compact(&surface);
    let (mesh, features) = surface.into_mesh();
    if let Some(history) = &mut history {
        history.end(names, &mesh.triangles);
    }
    Ok(Collapsed { mesh, features, error: error / per_unit, history })
}

struct Collapse {
    surface: Surface,
    parts: Parts,
    queue: BucketQueue,
    names: Names,
    history: Option<History>,
    /// One over the unit of errors.
    per_unit: f64,
    /// Sides that may go into the queue, and the largest error.
    window: Range<u32>,
    limit: f64,
    /// Number of vertices that are left.
    vertices: usize,
    /// Largest error so far.
    error: f64,
}

impl Collapse {
    fn new(surface: Surface, parts: Parts, per_unit: f64, limit: f64) -> Self {
        let queue = BucketQueue::new(surface.corners.len());
        let vertices = surface.vertices.iter().filter(|vertex| vertex.leaving != NONE).count();
        let names = Names::new(surface.vertices.len(), surface.corners.len() as usize / 3);
        let (history, window) = (None, 0..0);
        Self { surface, parts, queue, names, history, per_unit, window, limit, vertices, error: 0.0 }
    }

    /// Collapses edges of small error window by window; tells whether that was worth it.
    fn windows(&mut self, limit: f64) -> bool {
        let before = self.vertices;
        self.limit = self.easy().min(limit);
        let sides = self.surface.corners.len();
        for start in (0..sides).step_by(WINDOW as usize) {
            self.window = start..sides.min(start + WINDOW);
            // A window has its share of the vertices, so that none is emptied for the others.
            let own = before as f64 * self.window.len() as f64 / f64::from(sides);
            self.run(self.vertices.saturating_sub(own as usize / SHARE * (SHARE - 1)));
            self.queue.clear(self.window.clone());
        }
        self.limit = limit;
        self.vertices < before / 2
    }

    /// Collapses edges until so many vertices are left, or it is not worth going on. After each round edges are looked at
    /// again that wait because their error was too large once.
    fn rounds(&mut self, vertices: usize) {
        let mut worth = true;
        while worth && self.vertices > vertices {
            let before = self.vertices;
            self.run(vertices);
            self.queue.clear(self.window.clone());
            worth = (before - self.vertices) * LAST > before;
        }
    }

    /// The error up to which edges are collapsed in windows.
    fn easy(&self) -> f64 {
        let sides = (0..self.surface.corners.len()).step_by(SAMPLE);
        let mut errors: Vec<f64> = sides.filter_map(|side| Some(self.candidate(side)?.1.error)).collect();
        let middle = errors.len() / 2;
        if errors.is_empty() {
            return 0.0;
        }
        EASY * *errors.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Collapses edges of the window until so many vertices are left, or no edge of small enough error is.
    fn run(&mut self, vertices: usize) {
        for side in self.window.clone() {
            self.offer(side);
        }
        let limit = rank(self.limit);
        while self.vertices > vertices
            && let Some((side, expected)) = self.queue.pop()
            && expected <= limit
        {
            if let Some((place, candidate)) = self.candidate(side) {
                if rank(candidate.error) > expected {
                    self.queue.push(side, rank(candidate.error));
                } else if self.parts.spare(self.surface.corners.from(side)) {
                    self.collapse(side, place, candidate);
                }
            }
        }
    }

    /// What the edge of a side may be collapsed to, if the side stands for one.
    fn candidate(&self, side: u32) -> Option<(Place, Candidate)> {
        if !self.surface.corners.is_edge(side) {
            return None;
        }
        let place = place(&self.surface, side)?;
        let star = Star::new(&self.surface, side)?;
        if !star.is_simple() {
            return None;
        }
        Some((place, candidate(&self.surface, side, place, &star, self.per_unit)?))
    }

    /// Puts an edge of the window into the queue if it may be collapsed and does not wait already.
    fn offer(&mut self, side: u32) {
        if self.window.contains(&side)
            && !self.queue.contains(side)
            && let Some((_, candidate)) = self.candidate(side)
        {
            self.queue.push(side, rank(candidate.error));
        }
    }

    fn collapse(&mut self, side: u32, place: Place, candidate: Candidate) {
        let corners = &self.surface.corners;
        let sides = [side, corners.twin(side)];
        let across = sides.map(|side| if side == NONE { NONE } else { corners.from(previous(side)) });
        let ends = corners.ends(side).map(|vertex| *self.surface.vertex(vertex));
        let lost = if sides[1] == NONE { 3 } else { 4 };
        let merged = Vertex {
            position: candidate.position,
            accumulated: candidate.error as f32,
            stands_for: ends[0].stands_for + ends[1].stands_for,
            most: ends[0].most.min(ends[1].most),
            valence: ends[0].valence + ends[1].valence - lost,
            boundary: ends[0].boundary || ends[1].boundary,
            ..match place {
                Place::End(end) => ends[end],
                Place::Between => ends[0],
            }
        };
        if let Some(history) = &mut self.history {
            history.record(&self.surface, &self.names, side);
        }
        let merged = self.surface.collapse(side, merged);
        self.vertices -= 1;
        self.error = self.error.max(candidate.error);
        self.offer_around(merged, across);
    }

    /// Offers the edges that the text updates: at the merged vertex and at those across, and the rings around them.
    fn offer_around(&mut self, merged: u32, across: [u32; 2]) {
        for vertex in [merged, across[0], across[1]].into_iter().filter(|&vertex| vertex != NONE) {
            let start = self.surface.vertex(vertex).leaving;
            let mut side = start;
            while side != NONE {
                let into = previous(side);
                self.offer(self.surface.corners.edge(side));
                self.offer(self.surface.corners.edge(next(side)));
                side = self.surface.corners.twin(into);
                if side == NONE {
                    self.offer(into);
                }
                if side == start {
                    break;
                }
            }
        }
    }
}
