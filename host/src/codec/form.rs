//! What the integers of codestreams stand for.

use serde::{Deserialize, Serialize};
use wavelift_kernel::SampleType;

use super::{Values, planes, scaled, steps};
use crate::bound::Scale;
use crate::volume::ElementType;

/// How the samples of a volume are written as integers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// Themselves, bit for bit: one plane of `i32`, or two for types of 64 bits.
    Exact,
    /// The number of a sample among the values that occur.
    Packed(Values),
    /// Integers in steps of this odd width: the nearest multiple, divided. None moves by more than half a step.
    Steps(u64),
    /// Floating-point numbers on a scale; each brick keeps the bits of those that the scale does not hold. With a
    /// slack, bricks are lattices.
    Scaled {
        /// The scale.
        scale: Scale,
        /// The type that its integers fit into, signed.
        integers: SampleType,
    },
    /// Integers of one plane, bricks of which are lattices: none moves by more than this slack.
    Near(u32),
}

impl Form {
    /// The name in reports.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Packed(_) => "packed",
            Self::Steps(_) => "steps",
            Self::Scaled { .. } => "scaled",
            Self::Near(_) => "near",
        }
    }

    /// The values that samples are packed to the numbers of.
    pub const fn values(&self) -> Option<&Values> {
        if let Self::Packed(values) = self { Some(values) } else { None }
    }

    /// The scale of floating-point samples.
    pub const fn scale(&self) -> Option<Scale> {
        if let Self::Scaled { scale, .. } = self { Some(*scale) } else { None }
    }

    /// The width of the steps of integers.
    pub const fn step(&self) -> Option<u64> {
        if let Self::Steps(step) = self { Some(*step) } else { None }
    }

    /// How far coding may move an integer, if it may: then bricks are lattices, which have no transform.
    pub const fn slack(&self) -> Option<u32> {
        match self {
            Self::Scaled { scale, .. } if scale.slack() > 0 => Some(scale.slack()),
            Self::Near(slack) => Some(*slack),
            _ => None,
        }
    }

    /// Whether samples of `element` can be written so.
    pub(super) const fn suits(&self, element: ElementType) -> bool {
        match self {
            Self::Exact => true,
            Self::Packed(_) => planes::sample_types(element).len() == 1,
            Self::Steps(step) => {
                !element.is_float() && *step >= 3 && *step % 2 == 1 && *step <= steps::WIDEST
            }
            Self::Scaled { integers, .. } => {
                let is_signed = matches!(integers, SampleType::I8 | SampleType::I16 | SampleType::I32);
                element.is_float() && is_signed
            }
            Self::Near(slack) => {
                !element.is_float() && element.bytes() <= 4 && *slack >= 1 && *slack <= steps::MOST_SLACK
            }
        }
    }

    /// Whether the low-pass part of the integers of `element` is in the scale of the samples, so that there can be
    /// coarse levels.
    pub(super) const fn has_levels(&self, element: ElementType) -> bool {
        let is_narrow_integer = !element.is_float() && element.bytes() <= 4;
        is_narrow_integer || matches!(self, Self::Scaled { .. })
    }

    /// The types of the planes of integers, high half first.
    pub(super) fn sample_types(&self, element: ElementType) -> Vec<SampleType> {
        match self {
            Self::Exact | Self::Steps(_) | Self::Near(_) => planes::sample_types(element).to_vec(),
            Self::Packed(values) => vec![values.sample_type()],
            Self::Scaled { integers, .. } => vec![*integers],
        }
    }

    /// Writes little-endian samples as plane number `plane`, as many as `integers` has room for. `None` for a sample that
    /// the form has no integer for.
    pub(super) fn split(
        &self,
        element: ElementType,
        plane: usize,
        bytes: &[u8],
        integers: &mut [i32],
    ) -> Option<()> {
        match self {
            Self::Exact | Self::Near(_) => planes::split(element, plane, bytes, integers),
            Self::Packed(values) => {
                planes::split(element, plane, bytes, integers);
                values.pack(integers)?;
            }
            Self::Steps(step) => {
                let mut bytes = bytes.to_vec();
                steps::divide(element, *step, &mut bytes);
                planes::split(element, plane, &bytes, integers);
            }
            Self::Scaled { scale, .. } => scaled::quantize(element, *scale, bytes, integers),
        }
        Some(())
    }

    /// Brings integers, at full resolution, to where levels can be made of them. `None` for those that stand for
    /// nothing.
    pub(super) fn unpack(&self, planes: &mut [Vec<i32>]) -> Option<()> {
        let Self::Packed(values) = self else { return Some(()) };
        planes.iter_mut().try_for_each(|plane| values.unpack(plane))
    }

    /// Little-endian samples again, of what [`Form::unpack`] left.
    pub(super) fn join(&self, element: ElementType, planes: &[Vec<i32>]) -> Vec<u8> {
        let mut bytes = Vec::new();
        match (self, planes) {
            (Self::Scaled { scale, .. }, [integers]) => return scaled::restore(element, *scale, integers),
            _ => planes::join(element, planes, &mut bytes),
        }
        if let Self::Steps(step) = self {
            steps::multiply(element, *step, &mut bytes);
        }
        bytes
    }
}
