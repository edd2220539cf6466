//! From numbers back to points.

use super::error::EncodeError;
use super::frames::{frames, local, world};
use super::header::Header;
use super::planes::Triple;
use super::quantizer::{Quantizer, middle, quantized, value};
use crate::mesh::Point;
use crate::subdivision::Hierarchy;
use crate::surface_wavelet::{inverse_step, lossless};

/// How many low bits of a component of a vertex are unknown.
pub(super) type Unknown<'a> = &'a dyn Fn(usize, usize) -> u32;

/// Points of the finest mesh from numbers as far as they are known.
pub(super) fn points(
    header: &Header,
    hierarchy: &Hierarchy,
    numbers: &[Triple],
    unknown: Unknown<'_>,
) -> Vec<Point> {
    if header.lossless {
        return integers(header, hierarchy, numbers, unknown);
    }
    let quantizer = Quantizer::new(header.basis, hierarchy.steps().len(), header.step, header.tangential);
    let mut points = base_points(&quantizer, hierarchy, numbers, unknown);
    for (step, each) in hierarchy.steps().iter().enumerate() {
        let first = points.len();
        for (place, frame) in frames(each, &points).iter().enumerate() {
            let steps = quantizer.steps(hierarchy, step, place);
            let numbers = numbers[first + place];
            let detail =
                std::array::from_fn(|axis| value(numbers[axis], unknown(first + place, axis)) * steps[axis]);
            points.push(world(frame, detail));
        }
        inverse_step(header.basis, each, &mut points);
    }
    points
}

/// Quantizes coefficients level by level, each in frames from what a decoder knows by then. Returns the numbers and the
/// points that a decoder comes to.
///
/// # Errors
/// [`EncodeError::Range`] if a number is too large.
pub(super) fn quantize(
    header: &Header,
    hierarchy: &Hierarchy,
    coefficients: &[Point],
) -> Result<(Vec<Triple>, Vec<Point>), EncodeError> {
    let range = EncodeError::Range { step: header.step };
    let quantizer = Quantizer::new(header.basis, hierarchy.steps().len(), header.step, header.tangential);
    let mut numbers = Vec::with_capacity(coefficients.len());
    for point in &coefficients[..hierarchy.vertices(0)] {
        let rounded = point.to_array().map(|value| (value / quantizer.base).round());
        numbers.push(quantized(rounded, [1.0; 3]).ok_or(range.clone())?);
    }
    let mut points = base_points(&quantizer, hierarchy, &numbers, &|_, _| 0);
    for (step, each) in hierarchy.steps().iter().enumerate() {
        let first = points.len();
        for (place, frame) in frames(each, &points).iter().enumerate() {
            let steps = quantizer.steps(hierarchy, step, place);
            let number = quantized(local(frame, coefficients[first + place]), steps).ok_or(range.clone())?;
            numbers.push(number);
            let detail = std::array::from_fn(|axis| value(number[axis], 0) * steps[axis]);
            points.push(world(frame, detail));
        }
        inverse_step(header.basis, each, &mut points);
    }
    Ok((numbers, points))
}

fn base_points(
    quantizer: &Quantizer,
    hierarchy: &Hierarchy,
    numbers: &[Triple],
    unknown: Unknown<'_>,
) -> Vec<Point> {
    let mut points = Vec::with_capacity(hierarchy.finest_vertices());
    for (vertex, number) in numbers[..hierarchy.vertices(0)].iter().enumerate() {
        let coordinate = |axis: usize| middle(number[axis], unknown(vertex, axis)) * quantizer.base;
        points.push(Point::new(coordinate(0), coordinate(1), coordinate(2)));
    }
    points
}

/// Points from integer coefficients; those not wholly known are taken for their middle.
fn integers(header: &Header, hierarchy: &Hierarchy, numbers: &[Triple], unknown: Unknown<'_>) -> Vec<Point> {
    let base = hierarchy.vertices(0);
    let mut whole: Vec<Triple> = numbers.to_vec();
    for (vertex, numbers) in whole.iter_mut().enumerate() {
        for (axis, number) in numbers.iter_mut().enumerate() {
            let half = 1 << unknown(vertex, axis).min(30) >> 1;
            if vertex < base {
                *number = number.wrapping_add(half);
            } else {
                *number = number.wrapping_add(number.signum() * half);
            }
        }
    }
    lossless::inverse(header.basis, hierarchy, &mut whole);
    whole
        .iter()
        .map(|numbers| Point::from_array(numbers.map(|number| f64::from(number) * header.step)))
        .collect()
}
