//! The faces between solid and void leaves of an octree, as a base mesh.
//!
//! Source: Dataflow §3: faces of leaves, each edge refined where a neighbour is finer, so that they have four to eight sides.

use std::collections::HashMap;

use super::octree::{Octree, OctreeOptions, steps};
use super::separate::separate;
use crate::field::ScalarField;
use crate::mesh::{Faces, Point, PolygonMesh};

/// A base mesh of simplified topology: the boundary between solid and void of an octree of a signed distance (negative inside).
///
/// Faces have four to eight sides, rarely nine, and nearly all vertices three to six edges; the mesh is an oriented manifold, whose boundary lies on
/// the border of the grid. Leaves that touch only in an edge or a vertex are not joined: that edge or vertex is there
/// twice, in the same place; where both ends of such an edge are joined elsewhere, it has a
/// vertex of two edges in its middle.
///
/// What becomes of the topology of the surface: with [`super::Solid::Minimum`] components nearer than a leaf grow together, and
/// tunnels and cavities narrower than a leaf close; with [`super::Solid::Mean`] parts thinner than about half a leaf vanish
/// or break apart too. Nothing wider than two leaves of the size at its place is lost or made.
///
/// A grid of fewer than two nodes along an axis has no cells, and gives an empty mesh.
///
/// Cost: a pass over the distances for each level where the surface is, and a hash table of the base mesh's vertices.
pub fn octree_mesh(distance: &ScalarField, options: &OctreeOptions) -> PolygonMesh {
    let tree = Octree::new(distance, options);
    let mut outline = Outline::default();
    for level in 0..=options.coarsest.min(16).max(options.finest.min(16)) {
        for cell in steps(tree.cells, level) {
            if tree.level(cell) == level {
                outline.add_leaf(&tree, cell, level);
            }
        }
    }
    let (faces, owners) = outline.refined();
    let positions: Vec<Point> = outline.nodes.iter().map(|&node| distance.grid().position(node)).collect();
    without_idle_vertices(&separate(&positions, &faces, &owners))
}

/// A square between two leaves.
struct Square {
    /// Corners, as nodes of the grid, counter-clockwise seen from the void side.
    nodes: [[usize; 3]; 4],
    /// The solid leaf: place of its first cell.
    owner: usize,
    /// Its width, but for what the border of the grid cuts off.
    width: usize,
}

/// The squares so far, and names of their corners.
#[derive(Default)]
struct Outline {
    squares: Vec<Square>,
    names: HashMap<[usize; 3], u32>,
    nodes: Vec<[usize; 3]>,
}

impl Outline {
    /// Adds the faces of a leaf towards leaves that are not finer; those of equal size once, from the solid side.
    fn add_leaf(&mut self, tree: &Octree, cell: [usize; 3], level: u32) {
        let width = 1 << level;
        for axis in 0..3 {
            for up in [false, true] {
                let mut beside = cell;
                beside[axis] = if up { cell[axis] + width } else { cell[axis].wrapping_sub(1) };
                if beside[axis] >= tree.cells[axis] {
                    continue;
                }
                let solid = tree.is_solid(cell);
                let other = tree.level(beside);
                if tree.is_solid(beside) == solid || other < level || other == level && !solid {
                    continue;
                }
                let inner = if solid { cell } else { beside.map(|at| at >> other << other) };
                self.add_square(tree, [cell, inner], axis, level, [up, up == solid]);
            }
        }
    }

    /// Adds a face of a leaf: on its upper side or not, and looking up or not.
    fn add_square(
        &mut self,
        tree: &Octree,
        [cell, inner]: [[usize; 3]; 2],
        axis: usize,
        level: u32,
        [upper, up]: [bool; 2],
    ) {
        let width = 1 << level;
        let [one, two] = [(axis + 1) % 3, (axis + 2) % 3];
        let corner = |first: bool, second: bool| {
            let mut node = cell;
            node[axis] += usize::from(upper) * width;
            node[one] = tree.cells[one].min(cell[one] + usize::from(first) * width);
            node[two] = tree.cells[two].min(cell[two] + usize::from(second) * width);
            node
        };
        let mut nodes = [corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
        if !up {
            nodes.reverse();
        }
        for node in nodes {
            self.names.entry(node).or_insert_with(|| {
                self.nodes.push(node);
                self.nodes.len() as u32 - 1
            });
        }
        let owner = (inner[2] * tree.cells[1] + inner[1]) * tree.cells[0] + inner[0];
        self.squares.push(Square { nodes, owner, width });
    }

    /// Faces with the corners of finer faces in their edges, and the owners.
    fn refined(&self) -> (Faces, Vec<usize>) {
        let mut faces = Faces::default();
        for square in &self.squares {
            let mut corners = Vec::with_capacity(8);
            for side in 0..4 {
                let [from, to] = [square.nodes[side], square.nodes[(side + 1) % 4]];
                corners.push(self.names[&from]);
                corners.extend(middle(from, to, square.width).and_then(|node| self.names.get(&node)));
            }
            faces.push(&corners);
        }
        (faces, self.squares.iter().map(|square| square.owner).collect())
    }
}

/// The node where leaves half as wide have corners in an edge, if there is one.
fn middle(from: [usize; 3], to: [usize; 3], width: usize) -> Option<[usize; 3]> {
    let axis = (0..3).find(|&axis| from[axis] != to[axis])?;
    let [low, high] = [from[axis].min(to[axis]), from[axis].max(to[axis])];
    let mut node = from;
    node[axis] = low + width / 2;
    (low < node[axis] && node[axis] < high).then_some(node)
}

/// Leaves out the vertices of two edges between the same two faces: corners of finer leaves that only touched there.
fn without_idle_vertices(mesh: &PolygonMesh) -> PolygonMesh {
    let neighbours = |face: &[u32], place: usize| {
        [face[(place + face.len() - 1) % face.len()], face[(place + 1) % face.len()]]
    };
    let mut around: Vec<Vec<[u32; 2]>> = vec![Vec::new(); mesh.positions.len()];
    for face in mesh.faces().iter() {
        for (place, &vertex) in face.iter().enumerate() {
            around[vertex as usize].push(neighbours(face, place));
        }
    }
    let idle = |around: &[[u32; 2]]| match *around {
        [[a, b], [c, d]] if a == d && b == c => Some([a.min(b), a.max(b)]),
        _ => None,
    };
    // Ways between two vertices along an edge or two: one is left out only if it is the only one.
    let mut ways: HashMap<[u32; 2], usize> = HashMap::new();
    for (vertex, around) in (0..).zip(&around) {
        idle(around).into_iter().for_each(|ends| *ways.entry(ends).or_default() += 1);
        around
            .iter()
            .for_each(|&[_, next]| *ways.entry([next.min(vertex), next.max(vertex)]).or_default() += 1);
    }
    let mut names = Vec::with_capacity(around.len());
    let mut positions = Vec::new();
    for (around, &position) in around.iter().zip(&mesh.positions) {
        let goes = idle(around).is_some_and(|ends| ways[&ends] == 1);
        names.push((!goes).then(|| {
            positions.push(position);
            positions.len() as u32 - 1
        }));
    }
    let mut faces = Faces::default();
    for face in mesh.faces().iter() {
        let corners: Vec<u32> = face.iter().filter_map(|&vertex| names[vertex as usize]).collect();
        faces.push(&corners);
    }
    PolygonMesh::new(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::super::Solid;
    use super::*;
    use crate::field::Grid;
    use crate::mesh::Report;

    /// A large ball and a small one that sticks out of it.
    fn balls() -> ScalarField {
        let [large, small] = [Point::splat(32.3), Point::new(32.3, 32.3, 48.0)];
        ScalarField::from_function(Grid::unit([65; 3]), |at| {
            (at.distance(large) - 15.0).min(at.distance(small) - 3.0)
        })
    }

    #[test]
    fn a_ball_becomes_a_sphere_of_polygons() {
        for solid in [Solid::Minimum, Solid::Mean] {
            let options = OctreeOptions { solid, deviation: 0.05, finest: 0, coarsest: 3 };
            let mesh = octree_mesh(&balls(), &options);
            let report = Report::of(&mesh);
            assert!(
                report.is_closed() && report.genus() == Some(0) && report.components.len() == 1,
                "{report:?}"
            );
            assert!(mesh.faces().iter().all(|face| (4..=8).contains(&face.len())));
            assert!(report.volume() > 0.0 && report.inconsistent_edges == 0);
        }
    }
}
