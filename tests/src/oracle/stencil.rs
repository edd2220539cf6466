//! The generalized integer lifting operations, on lines and on meshes, over exact fractions.
//!
//! Source: Bertram, *Multiresolution Modeling for Scientific Visualization*, 2000, eq. (3.45), (3.46) and
//! (4.16)–(4.19). An argument `a` stands for the fraction `a / ONE`; b is an integer other than zero.
//! Nothing wraps: the reference says what must come out wherever every value of the implementation under test stays in
//! its range.

/// The fixed point one of the parameter a.
pub const ONE: i64 = 1 << 16;

/// `[r]` = floor(r + 1/2) of the fraction `numerator / denominator`.
fn round(numerator: i128, denominator: i128) -> i64 {
    let nearest = (2 * numerator + denominator).div_euclid(2 * denominator);
    i64::try_from(nearest).expect("a rounded term fits 64 bits")
}

/// `value / divisor`, which must come out even.
fn quotient(value: i64, divisor: i64) -> i64 {
    assert_eq!(value % divisor, 0, "{value} is not a multiple of {divisor}");
    value / divisor
}

/// `c_i <- b c_i + [a (d_{i-1} + d_i)]` on an interleaved line, reflected about its first and last sample.
/// A single sample stays as it is.
pub fn s_lift(line: &mut [i64], a: i64, b: i64) {
    change_line(line, 0, a, |own, term| b * own + term);
}

/// `d_i <- b d_i + [a (c_i + c_{i+1})]` on an interleaved line, reflected about its first and last sample.
pub fn w_lift(line: &mut [i64], a: i64, b: i64) {
    change_line(line, 1, a, |own, term| b * own + term);
}

/// Undoes [`s_lift`]. Panics where a sample cannot have come from it.
pub fn inverse_s_lift(line: &mut [i64], a: i64, b: i64) {
    change_line(line, 0, a, |own, term| quotient(own - term, b));
}

/// Undoes [`w_lift`]. Panics where a sample cannot have come from it.
pub fn inverse_w_lift(line: &mut [i64], a: i64, b: i64) {
    change_line(line, 1, a, |own, term| quotient(own - term, b));
}

/// Replaces every second sample from `first` on by `change(sample, [a (left + right)])`.
fn change_line(line: &mut [i64], first: usize, a: i64, change: impl Fn(i64, i64) -> i64) {
    if line.len() == 1 {
        return;
    }
    for at in (first..line.len()).step_by(2) {
        let left = if at == 0 { line[1] } else { line[at - 1] };
        let right = if at + 1 == line.len() { line[at - 1] } else { line[at + 1] };
        line[at] = change(line[at], round(i128::from(a) * i128::from(left + right), i128::from(ONE)));
    }
}

/// Who is averaged on a mesh. An operation changes the *corners* (v for an s-lift, f for a w-lift) and the edges; it
/// reads the *centres* (f for an s-lift, v for a w-lift). A neighbour may be listed more than once; the average over an
/// empty list is zero.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Neighbours {
    /// For each corner, the centres of its stencil: f̄_v or v̄_f.
    pub centres_of_corner: Vec<Vec<usize>>,
    /// For each corner, the edges of its stencil: ē_v or ē_f.
    pub edges_of_corner: Vec<Vec<usize>>,
    /// For each edge, the centres of its stencil: f̄_e or v̄_e.
    pub centres_of_edge: Vec<Vec<usize>>,
}

/// Diss (4.16) with corners v and centres f, (4.17) with corners f and centres v:
/// `corner <- b² corner + [4a² centres + 4ab edges]`, from the old edges, then `edge <- b edge + [2a centres]`, where
/// the plural stands for the average over a stencil.
pub fn mesh_lift(
    corners: &mut [i64],
    edges: &mut [i64],
    centres: &[i64],
    neighbours: &Neighbours,
    (a, b): (i64, i64),
) {
    for (index, corner) in corners.iter_mut().enumerate() {
        *corner = b * b * *corner + corner_term(index, edges, centres, neighbours, (a, b));
    }
    for (index, edge) in edges.iter_mut().enumerate() {
        *edge = b * *edge + edge_term(index, centres, neighbours, a);
    }
}

/// Diss (4.18) and (4.19): undoes [`mesh_lift`]. Panics where a value cannot have come from it.
pub fn inverse_mesh_lift(
    corners: &mut [i64],
    edges: &mut [i64],
    centres: &[i64],
    neighbours: &Neighbours,
    (a, b): (i64, i64),
) {
    for (index, edge) in edges.iter_mut().enumerate() {
        *edge = quotient(*edge - edge_term(index, centres, neighbours, a), b);
    }
    for (index, corner) in corners.iter_mut().enumerate() {
        *corner = quotient(*corner - corner_term(index, edges, centres, neighbours, (a, b)), b * b);
    }
}

/// `[4a² x̄ + 4ab ē]` of one corner, rounded once.
fn corner_term(
    index: usize,
    edges: &[i64],
    centres: &[i64],
    neighbours: &Neighbours,
    (a, b): (i64, i64),
) -> i64 {
    let (centre_sum, centre_count) = total(centres, &neighbours.centres_of_corner[index]);
    let (edge_sum, edge_count) = total(edges, &neighbours.edges_of_corner[index]);
    let (a, b, one) = (i128::from(a), i128::from(b), i128::from(ONE));
    let numerator = 4 * a * a * centre_sum * edge_count + 4 * a * b * one * edge_sum * centre_count;
    round(numerator, one * one * centre_count * edge_count)
}

/// `[2a x̄]` of one edge.
fn edge_term(index: usize, centres: &[i64], neighbours: &Neighbours, a: i64) -> i64 {
    let (sum, count) = total(centres, &neighbours.centres_of_edge[index]);
    round(2 * i128::from(a) * sum, i128::from(ONE) * count)
}

/// Sum and number of the listed values; an average is their quotient, zero for an empty list.
fn total(values: &[i64], list: &[usize]) -> (i128, i128) {
    let sum = list.iter().map(|&index| i128::from(values[index])).sum();
    (sum, list.len().max(1) as i128)
}
