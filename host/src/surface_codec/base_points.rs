//! Points of the base mesh, on a grid, each predicted from those before it.

use wavelift_kernel::bits::BitCoder;

use super::connectivity::{Connectivity, Origin};
use super::number::Number;

/// Where a vertex is expected, from vertices met before it: across a gate the two faces make a parallelogram
/// (Touma & Gotsman, *Triangle Mesh Compression*, 1998).
fn predicted(mesh: &Connectivity, points: &[[i32; 3]], vertex: usize) -> [i32; 3] {
    let at = |vertex: u32, axis: usize| i64::from(points[vertex as usize][axis]);
    std::array::from_fn(|axis| {
        let value = match mesh.origins[vertex] {
            Origin::After(None) => vertex.checked_sub(1).map_or(0, |before| at(before as u32, axis)),
            Origin::After(Some(before)) => at(before, axis),
            Origin::Across { from, to, corner } => at(from, axis) + at(corner, axis) - at(to, axis),
            Origin::Beside { behind, from, to, triangle } => {
                let face = mesh.faces.get(behind as usize);
                let others = face.iter().filter(|&&other| other != from && other != to);
                let count = others.clone().count().max(1) as i64;
                let middle = others.map(|&other| at(other, axis)).sum::<i64>().div_euclid(count);
                let ends = at(from, axis) + at(to, axis);
                if triangle { ends - middle } else { at(to, axis) + ends.div_euclid(2) - middle }
            }
        };
        value.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    })
}

/// Codes all points, which the decoder fills in.
pub(super) fn code(coder: &mut impl BitCoder, mesh: &Connectivity, points: &mut [[i32; 3]]) {
    let mut models = [Number::NEW, Number::NEW, Number::NEW];
    for vertex in 0..points.len() {
        let expected = predicted(mesh, points, vertex);
        for (axis, model) in models.iter_mut().enumerate() {
            let residual = points[vertex][axis].wrapping_sub(expected[axis]);
            points[vertex][axis] = expected[axis].wrapping_add(model.code_signed(coder, residual));
        }
    }
}
