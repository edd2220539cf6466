//! Numbers of the corners, edges and faces of a cell.
//!
//! Corner `x + 2 y + 4 z` lies at (x, y, z). Edge `4 axis + s + 2 t` runs along the axis; s and t are its coordinates along
//! the other two axes, the lower one first. Face `2 axis + side` has that coordinate along the axis.

/// Edges of a cell.
pub(super) const EDGES: usize = 12;
/// Corners of a cell.
pub(super) const CORNERS: usize = 8;
/// Faces of a cell.
pub(super) const FACES: usize = 6;

/// The axes other than one, the lower first.
const fn others(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}

/// Both ends of an edge, the lower first.
pub(super) const fn ends(edge: usize) -> [usize; 2] {
    let (axis, [s, t]) = (edge / 4, others(edge / 4));
    let low = (edge & 1) << s | (edge >> 1 & 1) << t;
    [low, low | 1 << axis]
}

/// The edge between two corners that differ along one axis.
fn edge_between(a: usize, b: usize) -> usize {
    let axis = (a ^ b).trailing_zeros() as usize;
    let [s, t] = others(axis);
    4 * axis + (a >> s & 1) + 2 * (a >> t & 1)
}

/// Corners of a face, counter-clockwise seen from outside the cell.
pub(super) const fn face_corners(face: usize) -> [usize; 4] {
    let (axis, side) = (face / 2, face & 1);
    // The axis and these two, in this order, make a right-handed frame.
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let base = side << axis;
    if side == 1 {
        [base, base | u, base | u | v, base | v]
    } else {
        [base, base | v, base | u | v, base | u]
    }
}

/// Edges of a face: edge n is between corners n and n + 1 of [`face_corners`].
pub(super) fn face_edges(face: usize) -> [usize; 4] {
    let corners = face_corners(face);
    std::array::from_fn(|n| edge_between(corners[n], corners[(n + 1) % 4]))
}

/// Whether two edges lie on one face: their middles do.
pub(super) fn share_face(a: usize, b: usize) -> bool {
    middle(a).into_iter().zip(middle(b)).any(|(a, b)| a == b && a != 1)
}

/// Twice the coordinates of the middle of an edge.
pub(super) fn middle(edge: usize) -> [i32; 3] {
    let [low, high] = ends(edge);
    std::array::from_fn(|axis| ((low >> axis & 1) + (high >> axis & 1)) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_numbered_by_their_ends() {
        for edge in 0..EDGES {
            let [low, high] = ends(edge);
            assert_eq!((edge_between(low, high), edge_between(high, low)), (edge, edge));
            let faces = |edge| (0..FACES).filter(move |&face| face_edges(face).contains(&edge));
            assert_eq!(faces(edge).count(), 2);
            for other in 0..EDGES {
                let is_shared = faces(edge).any(|face| faces(other).any(|another| face == another));
                assert_eq!(share_face(edge, other), is_shared);
            }
        }
    }

    #[test]
    fn faces_turn_outwards() {
        for face in 0..FACES {
            let point = |corner: usize| {
                glam::IVec3::new((corner & 1) as i32, (corner >> 1 & 1) as i32, (corner >> 2) as i32)
            };
            let [a, b, _, d] = face_corners(face).map(point);
            let outwards = if face & 1 == 1 { 1 } else { -1 };
            assert_eq!((b - a).cross(d - a)[face / 2], outwards);
        }
    }
}
