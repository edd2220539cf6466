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
    let count = faces.corners().len();
    let mut fans = Fans { above: (0..count as u32).collect(), partners: vec![NONE; count] };
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

/// Names a vertex for each fan, in the order in which faces meet them. Edges with the same ends as another get a vertex in
/// their middle.
fn rebuild(positions: &[Point], faces: &Faces, fans: &mut Fans) -> PolygonMesh {
    let mut names = vec![NONE; faces.corners().len()];
    let mut places = Vec::new();
    for (corner, &vertex) in faces.corners().iter().enumerate() {
        let root = fans.find(corner as u32) as usize;
        if names[root] == NONE {
            names[root] = places.len() as u32;
            places.push(positions[vertex as usize]);
        }
        names[corner] = names[root];
    }
    let mut sides = Vec::with_capacity(names.len());
    for face in faces.iter() {
        let face = &names[sides.len()..sides.len() + face.len()];
        sides.extend((0..face.len()).map(|side| [face[side], face[(side + 1) % face.len()]]));
    }
    let mut uses: HashMap<[u32; 2], u32> = HashMap::with_capacity(sides.len());
    sides.iter().for_each(|&side| *uses.entry(side).or_default() += 1);
    let mut middles = HashMap::new();
    let mut separated = Faces::default();
    let mut first = 0;
    for face in faces.iter() {
        let mut corners = Vec::with_capacity(face.len());
        for (corner, &[from, to]) in sides.iter().enumerate().skip(first).take(face.len()) {
            corners.push(from);
            if uses[&[from, to]] > 1 || uses.get(&[to, from]).is_some_and(|&uses| uses > 1) {
                corners.push(*middles.entry(fans.partners[corner].min(corner as u32)).or_insert_with(|| {
                    places.push(places[from as usize].midpoint(places[to as usize]));
                    places.len() as u32 - 1
                }));
            }
        }
        first += face.len();
        separated.push(&corners);
    }
    PolygonMesh::new(places, separated)
}

/// Corners that belong to the same vertex, as a forest, and the side that each side is sewn to, by their first corners.
struct Fans {
    above: Vec<u32>,
    partners: Vec<u32>,
}

impl Fans {
    fn find(&mut self, corner: u32) -> u32 {
        let mut root = corner;
        while self.above[root as usize] != root {
            let above = self.above[root as usize];
            self.above[root as usize] = self.above[above as usize];
            root = above;
        }
        root
    }

    /// Sews a side to one that runs the other way.
    fn join(&mut self, side: [u32; 2], other: [u32; 2]) {
        self.partners[side[0] as usize] = other[0];
        self.partners[other[0] as usize] = side[0];
        for (one, two) in [(side[0], other[1]), (side[1], other[0])] {
            let [one, two] = [self.find(one), self.find(two)];
            self.above[one.max(two) as usize] = one.min(two);
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
