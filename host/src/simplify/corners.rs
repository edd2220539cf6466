//! Which triangle lies across which edge: the connectivity of a triangle mesh as two numbers a corner.

use super::SimplifyError;

/// No corner: what lies across an edge of the boundary.
pub(super) const NONE: u32 = u32::MAX;

/// A corner of a triangle, which also names the side that runs from it to the next corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// The vertex at the corner, [`NONE`] once the triangle is gone.
    pub(super) vertex: u32,
    /// The same edge's side in the triangle across, or [`NONE`].
    pub(super) twin: u32,
}

/// A manifold of triangles. Corners 3t, 3t + 1, 3t + 2 are those of triangle t.
#[derive(Clone, Debug)]
pub(super) struct Corners {
    corners: Vec<Corner>,
}

/// The corner after `corner`, counter-clockwise in its triangle.
pub(super) const fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// The corner before `corner`.
pub(super) const fn previous(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

impl Corners {
    /// Connects triangles over `vertices` vertices across their edges.
    ///
    /// Cost: one pass with two words a vertex and one a corner, no hashing.
    ///
    /// # Errors
    /// The kinds of [`SimplifyError`] that name a triangle, an edge or a vertex.
    pub(super) fn new(vertices: usize, triangles: &[[u32; 3]]) -> Result<Self, SimplifyError> {
        if triangles.len() >= (NONE / 3) as usize || vertices >= NONE as usize {
            return Err(SimplifyError::TooLarge);
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
                return Err(SimplifyError::NoSuchVertex { triangle, vertex });
            }
            let [a, b, c] = *corners;
            if a == b || b == c || c == a {
                return Err(SimplifyError::DegenerateTriangle { triangle });
            }
        }
        let corners = triangles.as_flattened().iter().map(|&vertex| Corner { vertex, twin: NONE }).collect();
        let mut connected = Self { corners };
        connected.find_twins(vertices)?;
        Ok(connected)
    }

    /// Sides wait in a list of their edge's smaller vertex.
    fn find_twins(&mut self, vertices: usize) -> Result<(), SimplifyError> {
        let mut first = vec![NONE; vertices];
        let mut after = vec![NONE; self.corners.len()];
        for corner in 0..self.corners.len() as u32 {
            let [from, to] = self.ends(corner);
            let list = &mut first[from.min(to) as usize];
            let mut other = *list;
            while other != NONE && {
                let [start, end] = self.ends(other);
                [start.min(end), start.max(end)] != [from.min(to), from.max(to)]
            } {
                other = after[other as usize];
            }
            if other == NONE {
                after[corner as usize] = *list;
                *list = corner;
            } else if self.twin(other) != NONE {
                return Err(SimplifyError::CrowdedEdge { edge: [from, to] });
            } else if self.from(other) == from {
                return Err(SimplifyError::Orientation { edge: [from, to] });
            } else {
                self.corners[corner as usize].twin = other;
                self.corners[other as usize].twin = corner;
            }
        }
        Ok(())
    }

    /// Number of corners, those of triangles that are gone among them.
    pub(super) fn len(&self) -> u32 {
        self.corners.len() as u32
    }

    /// The vertex at a corner: where its side begins.
    pub(super) fn from(&self, corner: u32) -> u32 {
        self.corners[corner as usize].vertex
    }

    /// The vertex where the side of a corner ends.
    pub(super) fn to(&self, corner: u32) -> u32 {
        self.from(next(corner))
    }

    /// Both ends of a corner's side.
    pub(super) fn ends(&self, corner: u32) -> [u32; 2] {
        [self.from(corner), self.to(corner)]
    }

    /// The side across the edge, or [`NONE`].
    pub(super) fn twin(&self, corner: u32) -> u32 {
        self.corners[corner as usize].twin
    }

    /// Whether this side stands for its edge: the earlier one of the two, in a triangle that is there.
    pub(super) fn is_edge(&self, corner: u32) -> bool {
        let Corner { vertex, twin } = self.corners[corner as usize];
        vertex != NONE && twin > corner
    }

    /// The side that stands for the edge of this one.
    pub(super) fn edge(&self, corner: u32) -> u32 {
        corner.min(self.twin(corner))
    }

    /// The next side that leaves the same vertex counter-clockwise, or [`NONE`] past the boundary.
    pub(super) fn left(&self, corner: u32) -> u32 {
        self.twin(previous(corner))
    }

    /// The next side that leaves the same vertex clockwise, or [`NONE`] past the boundary.
    pub(super) fn right(&self, corner: u32) -> u32 {
        match self.twin(corner) {
            NONE => NONE,
            twin => next(twin),
        }
    }

    /// Sides that leave the vertex of `corner`, counter-clockwise from there to the boundary or all round.
    pub(super) fn around(&self, corner: u32) -> impl Iterator<Item = u32> {
        let mut side = corner;
        std::iter::from_fn(move || {
            let this = side;
            if this != NONE {
                side = self.left(this);
                if side == corner {
                    side = NONE;
                }
            }
            (this != NONE).then_some(this)
        })
    }

    /// Names another vertex at a corner.
    pub(super) fn set_vertex(&mut self, corner: u32, vertex: u32) {
        self.corners[corner as usize].vertex = vertex;
    }

    /// Takes the triangle of a side out and sews its other two sides' neighbours together; gives those neighbours.
    pub(super) fn close(&mut self, corner: u32) -> [u32; 2] {
        let sides = [corner, next(corner), previous(corner)];
        let outer = [self.twin(sides[1]), self.twin(sides[2])];
        for (side, across) in outer.into_iter().zip([outer[1], outer[0]]) {
            if side != NONE {
                self.corners[side as usize].twin = across;
            }
        }
        for side in sides {
            self.corners[side as usize] = Corner { vertex: NONE, twin: NONE };
        }
        outer
    }

    /// The triangles that are left, in order, with new names for their vertices; and the new name of each side.
    pub(super) fn compact(&self, names: &[u32]) -> (Self, Vec<u32>) {
        let mut sides = vec![NONE; self.corners.len()];
        let left = self.corners.iter().zip(&mut sides).filter(|(corner, _)| corner.vertex != NONE);
        for (name, (_, side)) in (0..).zip(left) {
            *side = name;
        }
        let there = self.corners.iter().filter(|corner| corner.vertex != NONE);
        let renamed = there.map(|corner| Corner {
            vertex: names[corner.vertex as usize],
            twin: sides.get(corner.twin as usize).copied().unwrap_or(NONE),
        });
        let corners = renamed.collect();
        (Self { corners }, sides)
    }

    /// The triangles, none of which may be gone.
    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        let (triangles, _) = self.corners.as_chunks::<3>();
        triangles.iter().map(|corners| corners.map(|corner| corner.vertex)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

    #[test]
    fn twins_run_the_other_way() {
        let corners = Corners::new(4, &TETRAHEDRON).unwrap();
        for corner in 0..12 {
            let [from, to] = corners.ends(corner);
            assert_eq!(corners.ends(corners.twin(corner)), [to, from]);
        }
        assert_eq!((0..12).filter(|&corner| corners.is_edge(corner)).count(), 6);
        assert_eq!(corners.around(0).map(|side| corners.to(side)).collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn a_boundary_has_nothing_across() {
        let corners = Corners::new(4, &TETRAHEDRON[..3]).unwrap();
        assert_eq!((0..9).filter(|&corner| corners.twin(corner) == NONE).count(), 3);
        assert_eq!(corners.around(0).count(), 1);
    }

    #[test]
    fn what_is_no_manifold_is_refused() {
        let refused = |vertices, triangles: &[[u32; 3]]| Corners::new(vertices, triangles).unwrap_err();
        let fan = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert_eq!(refused(5, &fan), SimplifyError::CrowdedEdge { edge: [0, 1] });
        assert_eq!(refused(4, &[[0, 1, 2], [0, 1, 3]]), SimplifyError::Orientation { edge: [0, 1] });
        assert_eq!(refused(3, &[[0, 1, 1]]), SimplifyError::DegenerateTriangle { triangle: 0 });
        assert_eq!(refused(3, &[[0, 1, 3]]), SimplifyError::NoSuchVertex { triangle: 0, vertex: 3 });
    }
}
