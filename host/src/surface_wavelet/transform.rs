//! The transforms over all levels.
//!
//! Points are `f64`: encoder and decoder must come to the same bits, and 53 bits leave room for the factor 4 by which each
//! level of decomposition widens errors of rounding; speed is that of memory either way. Only `+ - * /` are used, each
//! rounded once as IEEE 754 says, in one order, so that every machine comes to the same bits.

use super::basis::Basis;
use super::lift::{lift, unlift};
use crate::mesh::Point;
use crate::subdivision::{Hierarchy, Step};

/// Turns the points of the finest mesh into control points of the base mesh and, at all later vertices, details.
///
/// Cost: 20 to 60 ns a vertex for the bicubic basis.
///
/// # Panics
/// If there is not one point a vertex of the finest mesh.
pub fn forward(basis: Basis, hierarchy: &Hierarchy, points: &mut [Point]) {
    assert_eq!(points.len(), hierarchy.finest_vertices(), "one point a vertex of the finest mesh");
    for step in hierarchy.steps().iter().rev() {
        forward_step(basis, step, &mut points[..step.split.finer_vertices()]);
    }
}

/// Undoes [`forward`].
///
/// # Panics
/// If there is not one point a vertex of the finest mesh.
pub fn inverse(basis: Basis, hierarchy: &Hierarchy, points: &mut [Point]) {
    assert_eq!(points.len(), hierarchy.finest_vertices(), "one point a vertex of the finest mesh");
    inverse_to_level(basis, hierarchy, hierarchy.steps().len(), points);
}

/// Turns coefficients into the control points of a level, the base mesh being level 0; only the vertices of that level are
/// looked at.
///
/// # Panics
/// If there are fewer points than the level has vertices, or fewer levels.
pub fn inverse_to_level(basis: Basis, hierarchy: &Hierarchy, level: usize, points: &mut [Point]) {
    for step in &hierarchy.steps()[..level] {
        inverse_step(basis, step, &mut points[..step.split.finer_vertices()]);
    }
}

/// Decomposes the points of a finer mesh: the operators F and C of Vis2000 eq. (3.11).
///
/// # Panics
/// If there is not one point a vertex of the finer mesh.
pub fn forward_step(basis: Basis, step: &Step, points: &mut [Point]) {
    basis.lifts().iter().rev().for_each(|&each| unlift(step, points, each));
}

/// Reconstructs the points of a finer mesh: the operators S and E of Vis2000 eq. (3.9).
///
/// # Panics
/// If there is not one point a vertex of the finer mesh.
pub fn inverse_step(basis: Basis, step: &Step, points: &mut [Point]) {
    basis.lifts().iter().for_each(|&each| lift(step, points, each));
}
