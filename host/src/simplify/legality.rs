//! Which edges may be collapsed, as far as connectivity and features say.
//!
//! Source: Vis2000 §4.1: the rules of Hoppe, *Progressive meshes* (1996), with bounds on valences. The text never
//! collapses an edge between two sharp vertices. Here it may go where it is sharp itself and one end at least lies on the
//! curve between others: without that a curve would keep every vertex that a contour or a scan gave it. Curves are never
//! joined, shortened at their ends or closed up, so that each one is still there, as it is for the boundary.

use super::corners::{NONE, next, previous};
use super::surface::{Kind, Surface, Vertex};

/// Most edges of a vertex that a collapse makes.
pub(super) const MOST: u16 = 8;

/// Where the merged vertex goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// To the end of that number, which stays where it is.
    End(usize),
    /// Between the ends.
    Between,
}

/// Fewest edges of a vertex.
const fn fewest(boundary: bool) -> u16 {
    if boundary { 2 } else { 3 }
}

/// Where the edge of a side may be collapsed to, if it may; the link condition is left to
/// [`super::star::Star::is_simple`].
pub(super) fn place(surface: &Surface, side: u32) -> Option<Place> {
    let ends = surface.corners.ends(side).map(|vertex| surface.vertex(vertex));
    if !numbers_allow(ends) || !valences_allow(surface, side, ends) {
        return None;
    }
    match ends.map(|end| end.kind) {
        [Kind::Smooth, Kind::Smooth] => Some(Place::Between),
        [_, Kind::Smooth] => Some(Place::End(0)),
        [Kind::Smooth, _] => Some(Place::End(1)),
        [Kind::Corner, Kind::Corner] => None,
        kinds => {
            let twin = surface.corners.twin(side);
            let along =
                surface.is_curve(side) && !joins_curves(surface, side) && !joins_curves(surface, twin);
            along.then(|| place_on_curve(ends, kinds)).flatten()
        }
    }
}

/// Whether the merged vertex may stand for all that its ends do.
fn numbers_allow([first, second]: [&Vertex; 2]) -> bool {
    first.stands_for + second.stands_for <= first.most.min(second.most)
}

/// Valences after the collapse: N_i + N_j - 4 for the merged vertex (one less is lost at the boundary), one less across.
fn valences_allow(surface: &Surface, side: u32, [first, second]: [&Vertex; 2]) -> bool {
    let sides = [side, surface.corners.twin(side)];
    let inside = sides[1] != NONE;
    let lost = if inside { 4 } else { 3 };
    let merged = first.valence.saturating_add(second.valence) - lost;
    (fewest(first.boundary || second.boundary)..=MOST).contains(&merged)
        && sides.into_iter().filter(|&side| side != NONE).all(|side| {
            let apex = surface.vertex(surface.corners.from(previous(side)));
            apex.valence > fewest(apex.boundary)
        })
}

/// Whether the two other edges of a side's triangle, which become one, both belong to curves.
fn joins_curves(surface: &Surface, side: u32) -> bool {
    side != NONE && surface.is_curve(next(side)) && surface.is_curve(previous(side))
}

/// Corners stay, and no vertex leaves a border plane of the volume.
fn place_on_curve([first, second]: [&Vertex; 2], kinds: [Kind; 2]) -> Option<Place> {
    // The end that goes must not be a corner nor lie in a plane that the other one does not.
    let goes = |end: &Vertex, kind, other: &Vertex| kind != Kind::Corner && end.planes & !other.planes == 0;
    match [goes(first, kinds[0], second), goes(second, kinds[1], first)] {
        [true, true] => Some(Place::Between),
        [false, true] => Some(Place::End(0)),
        [true, false] => Some(Place::End(1)),
        [false, false] => None,
    }
}
