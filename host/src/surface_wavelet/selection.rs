//! Surfaces from a share of their coefficients.

use super::Norms;
use crate::mesh::Point;
use crate::subdivision::Hierarchy;

/// Sets to zero all details but the largest, so that `count` coefficients are left, control points of the base mesh, all of
/// which stay, among them. A detail counts by its length times the norm of its wavelet, so that what is left is, but for
/// overlaps, as close as can be in the mean square. Returns how many are left: fewer if there were fewer but zeros.
///
/// This is how Table 1 of Vis2000 is made: [`forward`](super::forward), this, [`inverse`](super::inverse).
///
/// Cost: linear, by selection.
///
/// # Panics
/// If there is not one coefficient a vertex of the finest mesh.
pub fn keep_largest(norms: &Norms, hierarchy: &Hierarchy, coefficients: &mut [Point], count: usize) -> usize {
    assert_eq!(
        coefficients.len(),
        hierarchy.finest_vertices(),
        "one coefficient a vertex of the finest mesh"
    );
    let base = hierarchy.vertices(0);
    let mut weights = Vec::with_capacity(coefficients.len() - base);
    for (step, each) in hierarchy.steps().iter().enumerate() {
        let [first, middle] =
            [each.split.edge_vertex(0), each.split.face_vertex(0)].map(|vertex| vertex as usize);
        let end = each.split.finer_vertices();
        weights.extend(coefficients[first..middle].iter().map(|detail| detail.length() * norms.edges(step)));
        weights.extend(coefficients[middle..end].iter().map(|detail| detail.length() * norms.faces(step)));
    }
    let details = count.saturating_sub(base).min(weights.len());
    let mut order: Vec<u32> = (0..weights.len() as u32).collect();
    if details < order.len() {
        // Ties by place, so that the choice is always the same.
        order.select_nth_unstable_by(details, |&one, &other| {
            weights[other as usize].total_cmp(&weights[one as usize]).then(one.cmp(&other))
        });
    }
    for &dropped in &order[details..] {
        coefficients[base + dropped as usize] = Point::ZERO;
    }
    base + coefficients[base..].iter().filter(|detail| **detail != Point::ZERO).count()
}
