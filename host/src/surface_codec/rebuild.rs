//! From numbers back to points.

use super::error::EncodeError;
use super::frames::{Frame, frames, local, world};
use super::header::Header;
use super::planes::Triple;
use super::quantizer::{Quantizer, middle, quantized, value};
use crate::mesh::Point;
use crate::subdivision::Hierarchy;
use crate::surface_wavelet::{inverse_step, lossless};

/// How many low bits of a component of a vertex are unknown.
pub(super) type Unknown<'a> = &'a dyn Fn(usize, usize) -> u32;

/// What points are rebuilt on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape<'a> {
    pub(super) header: &'a Header,
    pub(super) hierarchy: &'a Hierarchy,
    /// The level whose points are rebuilt.
    pub(super) level: usize,
}

impl Shape<'_> {
    /// Points of the level from numbers as far as they are known.
    pub(super) fn points(&self, numbers: &[Triple], unknown: Unknown<'_>) -> Vec<Point> {
        if self.header.lossless {
            return self.integers(numbers, unknown);
        }
        let base = self.base_points(numbers, unknown);
        let detail = |vertex: usize, _: &Frame, steps: [f64; 3]| {
            Some(std::array::from_fn(|axis| {
                value(numbers[vertex][axis], unknown(vertex, axis)) * steps[axis]
            }))
        };
        self.refined(base, detail).unwrap_or_default()
    }

    /// Quantizes coefficients level by level, each in frames from what a decoder knows by then. Returns the numbers and the
    /// points that a decoder comes to.
    ///
    /// # Errors
    /// [`EncodeError::Range`] if a number is too large.
    pub(super) fn quantize(&self, coefficients: &[Point]) -> Result<(Vec<Triple>, Vec<Point>), EncodeError> {
        let range = EncodeError::Range { step: self.header.step };
        let step = Quantizer::new(self.header).base;
        let mut base = Vec::with_capacity(coefficients.len());
        for point in &coefficients[..self.hierarchy.vertices(0)] {
            let rounded = point.to_array().map(|value| (value / step).round());
            base.push(quantized(rounded, [1.0; 3]).ok_or(range.clone())?);
        }
        let mut numbers = base.clone();
        let quantize = |vertex: usize, frame: &Frame, steps: [f64; 3]| {
            let number = quantized(local(frame, coefficients[vertex]), steps)?;
            numbers.push(number);
            Some(std::array::from_fn(|axis| value(number[axis], 0) * steps[axis]))
        };
        let points = self.refined(self.base_points(&base, &|_, _| 0), quantize).ok_or(range)?;
        Ok((numbers, points))
    }

    /// Refines points of the base mesh by details in local frames; `None` if one is told to be none.
    fn refined(
        &self,
        base: Vec<Point>,
        mut detail: impl FnMut(usize, &Frame, [f64; 3]) -> Option<[f64; 3]>,
    ) -> Option<Vec<Point>> {
        let quantizer = Quantizer::new(self.header);
        let mut points = base;
        for (step, each) in self.hierarchy.steps()[..self.level].iter().enumerate() {
            let first = points.len();
            for (place, frame) in frames(each, &points).iter().enumerate() {
                let steps = quantizer.steps(self.hierarchy, step, place);
                points.push(world(frame, detail(first + place, frame, steps)?));
            }
            inverse_step(self.header.basis, each, &mut points);
        }
        Some(points)
    }

    fn base_points(&self, numbers: &[Triple], unknown: Unknown<'_>) -> Vec<Point> {
        let step = Quantizer::new(self.header).base;
        let mut points = Vec::with_capacity(self.hierarchy.vertices(self.level));
        for (vertex, number) in numbers[..self.hierarchy.vertices(0)].iter().enumerate() {
            let coordinate = |axis: usize| middle(number[axis], unknown(vertex, axis)) * step;
            points.push(Point::new(coordinate(0), coordinate(1), coordinate(2)));
        }
        points
    }

    /// Points from integer coefficients; those not wholly known are taken for their middle.
    fn integers(&self, numbers: &[Triple], unknown: Unknown<'_>) -> Vec<Point> {
        let base = self.hierarchy.vertices(0);
        let mut whole: Vec<Triple> = numbers[..self.hierarchy.vertices(self.level)].to_vec();
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
        let Self { header, hierarchy, level } = *self;
        lossless::inverse_to_level(header.basis, hierarchy, level, &mut whole);
        let point = |(vertex, numbers): (usize, &Triple)| {
            let power = lossless::unit_of(header.basis, hierarchy, level, vertex);
            let unit = header.step * 2_f64.powi(power as i32);
            Point::from_array(numbers.map(|number| f64::from(number) * unit))
        };
        whole.iter().enumerate().map(point).collect()
    }
}
