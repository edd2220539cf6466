//! Nodes and the meshes that they place.

use std::borrow::Cow;

use glam::{DMat4, DQuat, DVec3};

use super::accessor;
use super::document::{Document, Node, Primitive};
use crate::mesh::builder::Builder;
use crate::mesh::{MeshFault, PolygonMesh};

/// Corners that one byte of a file may stand for at most. One mesh can be placed many times, and a small file so become
/// a mesh without measure.
const CORNERS_PER_BYTE: usize = 64;

/// Modes of primitives that are surfaces.
const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// All surfaces of a scene in one mesh.
pub(super) fn assemble(
    document: &Document,
    buffers: &[Cow<[u8]>],
    file_bytes: usize,
) -> Result<PolygonMesh, MeshFault> {
    let bytes = buffers.iter().map(|buffer| buffer.len()).sum::<usize>() + file_bytes;
    let most = bytes.saturating_mul(CORNERS_PER_BYTE);
    let mut mesh = Builder::welding();
    let mut visited = vec![false; document.nodes.len()];
    let mut pending: Vec<(usize, DMat4)> =
        roots(document).into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((index, outer)) = pending.pop() {
        let node = document.nodes.get(index);
        let node = node.ok_or_else(|| MeshFault::header(format!("there is no node {index}")))?;
        if std::mem::replace(&mut visited[index], true) {
            return Err(MeshFault::header(format!("node {index} has more than one parent")));
        }
        let place = outer * local(node);
        pending.extend(node.children.iter().rev().map(|&child| (child, place)));
        let Some(index) = node.mesh else { continue };
        let found = document.meshes.get(index);
        let found = found.ok_or_else(|| MeshFault::header(format!("there is no mesh {index}")))?;
        for primitive in &found.primitives {
            append(&mut mesh, document, buffers, (primitive, &place), most)?;
        }
    }
    mesh.finish()
}

/// Nodes without parents: those of the default scene, or of the first one, or else all.
fn roots(document: &Document) -> Vec<usize> {
    match document.scenes.get(document.scene.unwrap_or(0)) {
        Some(scene) => scene.nodes.clone(),
        None => {
            let mut is_root = vec![true; document.nodes.len()];
            let children = document.nodes.iter().flat_map(|node| &node.children);
            children
                .filter(|&&child| child < is_root.len())
                .copied()
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|child| is_root[child] = false);
            (0..is_root.len()).filter(|&node| is_root[node]).collect()
        }
    }
}

fn local(node: &Node) -> DMat4 {
    match node.matrix {
        Some(matrix) => DMat4::from_cols_array(&matrix),
        None => DMat4::from_scale_rotation_translation(
            DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
            DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0])),
            DVec3::from_array(node.translation.unwrap_or([0.0; 3])),
        ),
    }
}

/// Appends the triangles of a primitive at the place of its node; mirrored ones are turned round.
fn append(
    mesh: &mut Builder,
    document: &Document,
    buffers: &[Cow<[u8]>],
    (primitive, place): (&Primitive, &DMat4),
    most: usize,
) -> Result<(), MeshFault> {
    let Some(position) = primitive.attributes.position else { return Ok(()) };
    if !matches!(primitive.mode, TRIANGLES | STRIP | FAN) {
        return Ok(());
    }
    let positions = accessor::positions(document, buffers, position)?;
    let indices = match primitive.indices {
        Some(indices) => accessor::indices(document, buffers, indices)?,
        None => (0..positions.len() as u32).collect(),
    };
    if mesh.corners() + 3 * indices.len() + positions.len() > most {
        return Err(MeshFault::header("the same meshes are placed too often for a file of this length"));
    }
    let vertices: Result<Vec<u32>, MeshFault> = positions
        .into_iter()
        .map(|position| mesh.vertex(place.transform_point3(DVec3::from_array(position)).to_array()))
        .collect();
    let vertices = vertices?;
    let mirrored = place.determinant() < 0.0;
    for corners in triangles(primitive.mode, &indices) {
        let [a, b, c] = if mirrored { [corners[0], corners[2], corners[1]] } else { corners };
        let vertex = |index: u32| {
            vertices.get(index as usize).copied().map_or_else(|| mesh.index(-1 - i64::from(index)), Ok)
        };
        let triangle = [vertex(a)?, vertex(b)?, vertex(c)?];
        mesh.face(&triangle)?;
    }
    Ok(())
}

/// Triangles of a list, strip or fan of vertices.
fn triangles(mode: u32, indices: &[u32]) -> Vec<[u32; 3]> {
    let every_other_turned = |(index, &[a, b, c]): (usize, &[u32; 3])| {
        if index % 2 == 0 { [a, b, c] } else { [b, a, c] }
    };
    match mode {
        STRIP => indices.array_windows().enumerate().map(every_other_turned).collect(),
        FAN => indices.array_windows().skip(1).map(|&[b, c]| [indices[0], b, c]).collect(),
        _ => indices.as_chunks().0.to_vec(),
    }
}
