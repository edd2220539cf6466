//! A surface with its base mesh in another order.

use super::connectivity::Order;
use crate::mesh::{Faces, Features};
use crate::subdivision::{Split, SubdivisionSurface};

/// The surface whose base mesh is `faces`, which are those of `surface` in an order; vertices of finer levels go along.
pub(super) fn reordered(surface: &SubdivisionSurface, faces: Faces, order: &Order) -> SubdivisionSurface {
    let mut vertices = order.vertices.clone();
    // For each side, in file order, which it was.
    let mut sides = old_sides(&surface.base, order);
    let mut levels = surface.splits();
    let mut split = Split::new(vertices.len(), &faces);
    for old in levels.by_ref() {
        let mut edges = vec![0; split.edges.len()];
        for (&edge, &side) in split.side_edges.iter().zip(&sides) {
            edges[edge as usize] = old.edge_vertex(old.side_edges[side as usize] as usize);
        }
        vertices.extend(edges);
        let middles = split.quads.chunk_by(|one, next| one[2] == next[2]);
        vertices.extend(middles.scan(0, |first, quads| {
            let side = sides[*first];
            *first += quads.len();
            Some(old.quads[side as usize][2])
        }));
        sides = sides.iter().flat_map(|side| (0..4).map(move |corner| 4 * side + corner)).collect();
        split = split.finer();
    }
    SubdivisionSurface {
        features: renamed(&surface.features, &faces, order),
        base: faces,
        levels: surface.levels,
        positions: vertices.iter().map(|&vertex| surface.positions[vertex as usize]).collect(),
    }
}

fn old_sides(base: &Faces, order: &Order) -> Vec<u32> {
    let mut starts = Vec::with_capacity(base.len());
    base.iter().fold(0, |start, face| {
        starts.push(start);
        start + face.len() as u32
    });
    let turned = |&(face, first): &(u32, u32)| {
        let (start, count) = (starts[face as usize], base.get(face as usize).len() as u32);
        (0..count).map(move |side| start + (side + first) % count)
    };
    order.faces.iter().flat_map(turned).collect()
}

/// Features under the new numbers; edges that the mesh does not have are left out.
fn renamed(features: &Features, faces: &Faces, order: &Order) -> Features {
    let mut names = vec![0; order.vertices.len()];
    for (name, &old) in order.vertices.iter().enumerate() {
        names[old as usize] = name as u32;
    }
    let split = Split::new(names.len(), faces);
    let has: std::collections::HashSet<_> =
        split.edges.iter().map(|&[from, to]| [from.min(to), from.max(to)]).collect();
    let rename = |edge: &[u32; 2]| {
        let [from, to] = edge.map(|end| names[end as usize]);
        [from.min(to), from.max(to)]
    };
    let mut edges: Vec<_> = features.edges.iter().map(rename).filter(|edge| has.contains(edge)).collect();
    let mut vertices: Vec<_> = features.vertices.iter().map(|&vertex| names[vertex as usize]).collect();
    edges.sort_unstable();
    edges.dedup();
    vertices.sort_unstable();
    vertices.dedup();
    Features { edges, vertices }
}
