//! Sheets that touch, taken apart.
//!
//! Two triangles stay together at an edge if they are the only ones there, or if what lies between them, behind both, is
//! solid: so bodies that touch along an edge become bodies of their own. Sides that find no partner become boundary. Then
//! every fan of triangles gets a vertex of its own (cutting, as in Guéziec, Taubin, Lazarus, Horn, *Cutting and stitching:
//! converting sets of polygons to manifold surfaces*, 2001).

use std::collections::HashMap;

use super::TriangleMesh;
use super::edges::{Edges, Sets, Side};

/// How much was taken apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Taken {
    /// Edges of more than two triangles, or of two that cannot face the same way.
    pub(super) edges: usize,
    /// Vertices that were added for fans of their own, and in the middle of edges that have both ends in common.
    pub(super) vertices: usize,
}

impl TriangleMesh {
    /// Makes a manifold of triangles that are oriented as far as may be.
    ///
    /// Cost: two sortings of the sides.
    pub(super) fn take_apart(&mut self) -> Taken {
        let edges = Edges::new(self);
        let mut fans = Sets::new(3 * self.triangles.len());
        let mut pairs = Vec::new();
        let mut taken = Taken::default();
        for sides in edges.iter() {
            let before = pairs.len();
            self.pair(sides, &mut pairs);
            let crowded = sides.len() > 2 || matches!(sides, [one, other] if one.forward == other.forward);
            taken.edges += usize::from(crowded);
            for [one, other] in &pairs[before..] {
                fans.join(one.corners[0], other.corners[0]);
                fans.join(one.corners[1], other.corners[1]);
            }
        }
        taken.vertices = self.name_fans(&mut fans);
        taken.vertices += self.part_edges(&pairs);
        taken
    }

    /// Finds the sides of an edge that stay together; those that stay alone are paired with themselves.
    fn pair(&self, sides: &[Side], pairs: &mut Vec<[Side; 2]>) {
        if let [one, other] = sides {
            match one.forward == other.forward {
                true => pairs.extend([[*one; 2], [*other; 2]]),
                false => pairs.push([*one, *other]),
            }
            return;
        }
        if sides.len() < 2 {
            return;
        }
        let mut around: Vec<(f64, Side)> =
            sides.iter().map(|side| (self.turn(sides[0], *side), *side)).collect();
        around.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.forward.cmp(&other.1.forward)));
        // The solid lies before a forward side, and behind a backward one: the two match as brackets do.
        let mut open = Vec::new();
        let mut matched = vec![false; around.len()];
        for place in (0..around.len()).chain(0..around.len()) {
            if matched[place] {
                continue;
            }
            if !around[place].1.forward {
                if !open.contains(&place) {
                    open.push(place);
                }
            } else if let Some(start) = open.pop() {
                (matched[start], matched[place]) = (true, true);
                pairs.push([around[start].1, around[place].1]);
            }
        }
        let alone = around.iter().zip(&matched).filter(|(_, matched)| !**matched);
        pairs.extend(alone.map(|((_, side), _)| [*side; 2]));
    }

    /// How far around an edge the triangle of a side is turned from that of another.
    fn turn(&self, first: Side, side: Side) -> f64 {
        let [from, to] = first.ends.map(|end| self.positions[end as usize]);
        let axis = (to - from).normalize_or_zero();
        let across = |side: Side| {
            let apex =
                self.triangles[side.face as usize].into_iter().find(|corner| !side.ends.contains(corner));
            let spoke = self.positions[apex.unwrap_or(side.ends[0]) as usize] - from;
            spoke - axis * spoke.dot(axis)
        };
        let (start, end) = (across(first), across(side));
        let turn = axis.dot(start.cross(end)).atan2(start.dot(end));
        if turn < 0.0 { turn + std::f64::consts::TAU } else { turn }
    }

    /// Gives each fan of corners a vertex; how many are new.
    fn name_fans(&mut self, fans: &mut Sets) -> usize {
        let before = self.positions.len();
        let mut first_fan = vec![u32::MAX; before];
        let mut names: HashMap<u32, u32> = HashMap::new();
        for corner in 0..3 * self.triangles.len() {
            let vertex = &mut self.triangles[corner / 3][corner % 3];
            let fan = fans.root(corner as u32);
            let first = &mut first_fan[*vertex as usize];
            if *first == u32::MAX {
                *first = fan;
            }
            if *first != fan {
                let place = self.positions[*vertex as usize];
                *vertex = *names.entry(fan).or_insert_with(|| {
                    self.positions.push(place);
                    self.positions.len() as u32 - 1
                });
            }
        }
        self.positions.len() - before
    }

    /// Puts a vertex into the middle of edges that still have the same ends as another; how many.
    fn part_edges(&mut self, pairs: &[[Side; 2]]) -> usize {
        let ends_of = |mesh: &Self, side: &Side| {
            side.corners.map(|corner| mesh.triangles[corner as usize / 3][corner as usize % 3])
        };
        let mut uses: HashMap<[u32; 2], usize> = HashMap::new();
        for sides in Edges::new(self).iter().filter(|sides| sides.len() > 2) {
            uses.insert(sides[0].ends, 0);
        }
        if uses.is_empty() {
            return 0;
        }
        let before = self.positions.len();
        // The vertices in the sides of triangles, by the corner that a side begins with.
        let mut middles: HashMap<u32, u32> = HashMap::new();
        for pair in pairs {
            let mut ends = ends_of(self, &pair[0]);
            ends.sort_unstable();
            let Some(uses) = uses.get_mut(&ends) else { continue };
            *uses += 1;
            if *uses > 1 {
                let [from, to] = ends.map(|end| self.positions[end as usize]);
                let middle = self.positions.len() as u32;
                self.positions.push(from.midpoint(to));
                for side in pair {
                    middles.insert(side.corners[usize::from(!side.forward)], middle);
                }
            }
        }
        self.cut_triangles(&middles);
        self.positions.len() - before
    }

    /// Cuts triangles that have vertices in their sides.
    fn cut_triangles(&mut self, middles: &HashMap<u32, u32>) {
        let mut cut = Vec::with_capacity(self.triangles.len());
        for (triangle, corners) in (0..).zip(&self.triangles) {
            let mut around = Vec::new();
            let mut first = None;
            for (place, &corner) in (0..).zip(corners) {
                around.push(corner);
                if let Some(&middle) = middles.get(&(3 * triangle + place)) {
                    first.get_or_insert(around.len());
                    around.push(middle);
                }
            }
            around.rotate_left(first.unwrap_or(0));
            cut.extend(around[1..].array_windows().map(|&[from, to]| [around[0], from, to]));
        }
        self.triangles = cut;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Point, Report};

    /// Tetrahedra over points, each counter-clockwise seen from outside.
    fn tetrahedra(points: &[[f64; 3]], of: &[[u32; 4]]) -> TriangleMesh {
        let positions = points.iter().map(|&point| Point::from_array(point)).collect();
        let faces = |&[a, b, c, d]: &[u32; 4]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]];
        TriangleMesh { positions, triangles: of.iter().flat_map(faces).collect() }
    }

    #[test]
    fn bodies_that_touch_become_bodies_of_their_own() {
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, -1.0],
        ];
        for (second, edges) in [([0, 1, 4, 5], 1), ([0, 4, 5, 5], 0)] {
            let mut mesh = tetrahedra(&points, &[[0, 1, 2, 3], second]);
            if edges == 0 {
                // Only a vertex is shared.
                mesh = tetrahedra(&points, &[[0, 1, 2, 3]]);
                let more = tetrahedra(
                    &[[0.0; 3], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
                    &[[0, 2, 1, 3]],
                );
                let shift = mesh.positions.len() as u32;
                mesh.positions.extend(&more.positions);
                mesh.triangles.extend(
                    more.triangles
                        .iter()
                        .map(|corners| corners.map(|corner| if corner == 0 { 0 } else { corner + shift })),
                );
            }
            let taken = mesh.take_apart();
            assert_eq!(taken, Taken { edges, vertices: 1 + edges });
            let report = Report::of(&mesh);
            assert!(report.is_closed(), "{report}");
            assert_eq!((report.components.len(), report.genus()), (2, Some(0)));
            assert!(report.components.iter().all(|part| part.volume > 0.1));
        }
    }

    #[test]
    fn a_body_that_touches_itself_in_an_edge_keeps_its_topology() {
        // Two tetrahedra share the edge 0-1, and a bridge of a third one's sides joins them at both ends.
        let mut mesh = tetrahedra(
            &[
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [0.0, -1.0, 0.0],
                [0.0, 0.0, -1.0],
            ],
            &[[0, 1, 2, 3]],
        );
        let fin = mesh.triangles[1];
        mesh.triangles.extend([[fin[0], fin[1], 4], [fin[1], fin[0], 4]]);
        let taken = mesh.take_apart();
        assert_eq!(taken.edges, 1);
        let report = Report::of(&mesh);
        assert!(report.is_manifold() && report.inconsistent_edges == 0, "{report}");
    }

    #[test]
    fn what_cannot_face_the_same_way_is_cut() {
        let mut mesh = tetrahedra(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &[]);
        mesh.triangles = vec![[0, 1, 2], [0, 1, 3]];
        assert_eq!(mesh.take_apart(), Taken { edges: 1, vertices: 2 });
        assert!(Report::of(&mesh).is_manifold());
    }
}
