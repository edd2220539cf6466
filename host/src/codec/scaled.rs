//! Floating-point volumes on a scale: little-endian bytes to integers and back, for either type.

use wavelift_kernel::SampleType;

use super::Form;
use crate::bound::{Exceptions, Profile, Real, Scale, extend_bytes, samples_of};
use crate::volume::ElementType;

/// Calls a function for `f32` or `f64`, by a type that is one of them.
macro_rules! of_type {
    ($element:expr, $function:ident($($argument:expr),*)) => {
        if $element == ElementType::F32 { $function::<f32>($($argument),*) } else { $function::<f64>($($argument),*) }
    };
}

/// The form for a volume of floating-point samples: on a scale for `error`, or, for 0, on the one that nearly all lie on
/// already. `None` if there is no such scale.
///
/// `most_slack` is how far coding may move an integer: 0, or more for a lattice.
pub(super) fn form(profile: &Profile, error: f64, most_slack: u32) -> Option<Form> {
    let scale = match error {
        0.0 => Scale::natural(profile, error, 0),
        _ => Scale::choose(profile, error, most_slack),
    }?;
    let largest = scale.largest_integer(profile);
    let types = [SampleType::I8, SampleType::I16, SampleType::I32];
    // Symmetric, and wider by one for what rounding may do.
    let integers = types.into_iter().find(|narrow| largest < *narrow.range().end());
    Some(Form::Scaled { scale, integers: integers.unwrap_or(SampleType::I32) })
}

/// Writes samples as integers, as many as `integers` has room for.
pub(super) fn quantize(element: ElementType, scale: Scale, bytes: &[u8], integers: &mut [i32]) {
    of_type!(element, typed_quantize(scale, bytes, integers));
}

fn typed_quantize<R: Real>(scale: Scale, bytes: &[u8], integers: &mut [i32]) {
    scale.quantize(samples_of::<R>(bytes), integers);
}

/// What a decoder makes of integers, little-endian, before exceptions.
pub(super) fn restore(element: ElementType, scale: Scale, integers: &[i32]) -> Vec<u8> {
    of_type!(element, typed_restore(scale, integers))
}

fn typed_restore<R: Real>(scale: Scale, integers: &[i32]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of::<R>() * integers.len());
    extend_bytes(&mut bytes, integers.iter().map(|&integer| scale.restore::<R>(integer)));
    bytes
}

/// The samples that `integers`, as decoded, do not bring back within `error`.
pub(super) fn exceptions(
    element: ElementType,
    scale: Scale,
    bytes: &[u8],
    integers: &[i32],
    error: f64,
) -> Exceptions {
    of_type!(element, typed_exceptions(scale, bytes, integers, error))
}

fn typed_exceptions<R: Real>(scale: Scale, bytes: &[u8], integers: &[i32], error: f64) -> Exceptions {
    scale.exceptions(samples_of::<R>(bytes), integers, error)
}

/// Puts what was kept of a brick of `sides` into its samples at `level`: sample i of a level is at i 2^level. Returns
/// whether every exception is in the brick; samples have no meaning if not.
pub(super) fn apply(
    exceptions: &Exceptions,
    element: ElementType,
    (sides, level): ([u32; 3], u8),
    bytes: &mut [u8],
) -> bool {
    let [width, height, depth] = sides.map(u64::from);
    let coarse = |axis: u64| ((axis - 1) >> level) + 1;
    let mask = (1_u64 << level.min(63)) - 1;
    let size = element.bytes();
    exceptions.each(width * height * depth, |position, bits| {
        let [x, y, z] = [position % width, position / width % height, position / width / height];
        if (x | y | z) & mask == 0 {
            let place = ((z >> level) * coarse(height) + (y >> level)) * coarse(width) + (x >> level);
            bytes[place as usize * size..][..size].copy_from_slice(&bits.to_le_bytes()[..size]);
        }
    })
}

/// Keeps the samples of a box of `sides` that `level` has: every 2^level-th along each axis.
pub(super) fn thin(element: ElementType, sides: [u32; 3], level: u8, bytes: &[u8]) -> Vec<u8> {
    let ([width, height, depth], size) = (sides.map(|side| side as usize), element.bytes());
    let every = 1_usize << level.min(31);
    let mut kept = Vec::new();
    for (z, y) in (0..depth).step_by(every).flat_map(|z| (0..height).step_by(every).map(move |y| (z, y))) {
        let row = &bytes[(z * height + y) * width * size..][..width * size];
        row.chunks_exact(size).step_by(every).for_each(|sample| kept.extend_from_slice(sample));
    }
    kept
}
