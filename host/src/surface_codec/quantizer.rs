//! Between coefficients and whole numbers.

use super::header::Header;
use super::planes::Triple;
use crate::subdivision::{EdgeRule, Hierarchy};
use crate::surface_wavelet::Norms;

/// The largest magnitude of a number.
const LARGEST: f64 = (1_u32 << 30) as f64;

/// The steps in which coefficients are coded: the step of the file divided by the norm of what they stand for, so that each
/// has its share in the mean square error over the vertices. Tangential parts are coarser.
///
/// Weights by the area of each face of the base mesh, for an error over the area, were tried and made files no smaller.
#[derive(Clone, Debug)]
pub(super) struct Quantizer {
    /// Of points of the base mesh.
    pub(super) base: f64,
    /// Of the vertices of each step, in edges and in faces.
    details: Vec<[f64; 2]>,
    tangential: u8,
}

impl Quantizer {
    pub(super) fn new(header: &Header) -> Self {
        let steps = header.levels as usize;
        let norms = Norms::new(header.basis, steps);
        let details =
            (0..steps).map(|at| [header.step / norms.edges(at), header.step / norms.faces(at)]).collect();
        Self { base: header.step / norms.base(), details, tangential: header.tangential }
    }

    /// The steps of the components of a vertex, the `place`th that a step adds.
    ///
    /// What moves along the surface does not change it, but for the finer details that move with it. They are the flatter
    /// the finer they are, so that tangential parts are half as precise as normal ones at the first level, and each later
    /// one halves that again until it is as coarse as the file says. Along sharp edges all components count alike.
    pub(super) fn steps(&self, hierarchy: &Hierarchy, step: usize, place: usize) -> [f64; 3] {
        let [edges, faces] = self.details[step];
        let coarser = f64::from(1_u32 << usize::from(self.tangential).min(step + 1));
        match hierarchy.steps()[step].rules.edges.get(place) {
            Some(EdgeRule::Sharp) => [edges; 3],
            Some(_) => [edges, edges * coarser, edges * coarser],
            None => [faces, faces * coarser, faces * coarser],
        }
    }
}

/// Whole numbers below coefficients in magnitude; `None` if one is too large.
pub(super) fn quantized(coefficient: [f64; 3], steps: [f64; 3]) -> Option<Triple> {
    let mut numbers = [0; 3];
    for ((number, value), step) in numbers.iter_mut().zip(coefficient).zip(steps) {
        let scaled = value / step;
        *number = (scaled.abs() < LARGEST).then_some(scaled as i32)?;
    }
    Some(numbers)
}

/// The value that a number stands for, of which so many low bits are unknown: somewhat below the middle of all values it
/// may be, as small ones are more frequent, above all where the number has but one bit.
pub(super) fn value(number: i32, unknown: u32) -> f64 {
    if number == 0 {
        return 0.0;
    }
    let magnitude = number.unsigned_abs();
    let share = if magnitude >> unknown == 1 { 0.42 } else { 0.48 };
    let value = f64::from(magnitude) + share * f64::from(1_u32 << unknown.min(31));
    if number < 0 { -value } else { value }
}

/// The middle of all values that a point of the base mesh may have, of which so many low bits are unknown.
pub(super) fn middle(number: i32, unknown: u32) -> f64 {
    f64::from(number) + (f64::from(1_u32 << unknown.min(31)) - 1.0) / 2.0
}
