//! Polygons that meet in more than a manifold may, taken apart.

use std::collections::HashMap;

use super::corners::NONE;
use crate::mesh::{Faces, Point, PolygonMesh};

/// A mesh of the same faces that is a manifold: faces stay together only across edges, two at an edge.
///
/// Where more than two faces share an edge, those of the same `owner` (a number for each face) stay together, the first two
/// that run opposite ways; where faces share no more than a vertex, each fan gets a vertex of its own in the same place.
/// Sides that find no partner become boundary.
///
/// Cost: one pass with a hash table of edges.
pub(super) fn separate(positions: &[Point], faces: &Faces, owners: &[usize]) -> PolygonMesh {
    let mut fans = Fans((0..faces.corners().len() as u32).collect());
    // Sides without a partner: first corner, corner after it, and owner.
    let mut open: HashMap<[u32; 2], Vec<(usize, [u32; 2])>> = HashMap::new();
    let mut first = 0;
    for (face, &owner) in faces.iter().zip(owners) {
        let count = face.len() as u32;
        for side in 0..count {
            let after = (side + 1) % count;
            let ends = [face[side as usize], face[after as usize]];
            let corners = [first + side, first + after];
            let partners = open.entry([ends[1], ends[0]]).or_default();
            match partners.iter().position(|&(other, _)| other == owner) {
                Some(place) => fans.join(corners, partners.remove(place).1),
                None => open.entry(ends).or_default().push((owner, corners)),
            }
        }
        first += count;
    }
    join_rest(&mut fans, open, faces.corners());
    rebuild(positions, faces, &mut fans)
}

/// Joins sides of different owners, in the order of their corners.
fn join_rest(fans: &mut Fans, mut open: HashMap<[u32; 2], Vec<(usize, [u32; 2])>>, vertices: &[u32]) {
    let mut sides: Vec<[u32; 2]> = open.values().flatten().map(|&(_, corners)| corners).collect();
    sides.sort_unstable();
    for corners in sides {
        let [from, to] = corners.map(|corner| vertices[corner as usize]);
        let waits = |side: &(usize, [u32; 2])| side.1 == corners;
        let Some(own) = open.get(&[from, to]).and_then(|own| own.iter().position(waits)) else { continue };
        let partner = open.get_mut(&[to, from]).filter(|partners| !partners.is_empty());
        if let Some(partners) = partner {
            fans.join(corners, partners.remove(0).1);
            open.entry([from, to]).or_default().remove(own);
        }
    }
}

/// Names a vertex for each fan, in the order in which faces meet them.
fn rebuild(positions: &[Point], faces: &Faces, fans: &mut Fans) -> PolygonMesh {
    let mut names = vec![NONE; faces.corners().len()];
    let mut places = Vec::new();
    let mut separated = Faces::default();
    let mut corner = 0;
    for face in faces.iter() {
        let renamed: Vec<u32> = face
            .iter()
            .map(|&vertex| {
                let name = &mut names[fans.find(corner) as usize];
                corner += 1;
                if *name == NONE {
                    *name = places.len() as u32;
                    places.push(positions[vertex as usize]);
                }
                *name
            })
            .collect();
        separated.push(&renamed);
    }
    PolygonMesh::new(places, separated)
}

/// Corners that belong to the same vertex, as a forest.
struct Fans(Vec<u32>);

impl Fans {
    fn find(&mut self, corner: u32) -> u32 {
        let mut root = corner;
        while self.0[root as usize] != root {
            let above = self.0[root as usize];
            self.0[root as usize] = self.0[above as usize];
            root = above;
        }
        root
    }

    /// Sews a side to one that runs the other way.
    fn join(&mut self, side: [u32; 2], other: [u32; 2]) {
        for (one, two) in [(side[0], other[1]), (side[1], other[0])] {
            let [one, two] = [self.find(one), self.find(two)];
            self.0[one.max(two) as usize] = one.min(two);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_of_four_faces_comes_apart_by_owners() {
        let positions = vec![Point::ZERO; 6];
        let faces: Faces =
            [[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]].iter().map(<[u32; 3]>::as_slice).collect();
        let mesh = separate(&positions, &faces, &[7, 8, 8, 7]);
        let corners: Vec<_> = mesh.faces().iter().collect();
        assert_eq!(mesh.positions.len(), 8);
        assert_eq!(corners, [[0, 1, 2], [3, 4, 5], [4, 3, 6], [1, 0, 7]]);
    }

    #[test]
    fn a_pinched_vertex_is_doubled() {
        let faces: Faces = [[0, 1, 2], [0, 3, 4]].iter().map(<[u32; 3]>::as_slice).collect();
        assert_eq!(separate(&[Point::ZERO; 5], &faces, &[0, 1]).positions.len(), 6);
    }
}
