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
/// Cost: 0.1 µs a vertex for the bicubic basis.
///
/// # Panics
/// If there is not one point a vertex of the finest mesh.
pub fn forward(basis: Basis, hierarchy: &Hierarchy, points: &mut [Point]) {
    assert_eq!(points.len(), hierarchy.finest_vertices(), "one point a vertex of the finest mesh");
    for step in hierarchy.steps().iter().rev() {
        forward_step(basis, step, &mut points[..step.split.finer_vertices()]);
    }
}

/// Undoes [`forward`]. With fewer levels in the hierarchy it makes the points of a coarser mesh.
///
/// # Panics
/// If there is not one point a vertex of the finest mesh.
pub fn inverse(basis: Basis, hierarchy: &Hierarchy, points: &mut [Point]) {
    assert_eq!(points.len(), hierarchy.finest_vertices(), "one point a vertex of the finest mesh");
    for step in hierarchy.steps() {
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
