//! Where NIfTI's samples lie: rows of a matrix (`sform`), a quaternion (`qform`), or spacings alone.
//!
//! Source: `nifti1.h`, "3D image (volume) orientation and location in space", methods 1 to 3; the way back from a
//! rotation to a quaternion is the usual one, from the largest of its four parts.

use super::fields::Fields;
use crate::volume::{Geometry, Space};

/// Code of positions in the scanner, for positions whose space has a name.
const SCANNER: &str = "1";

/// Code of positions that fit those of some other data.
const ALIGNED: &str = "2";

/// Cosine of the angle between axes that count as orthogonal: in 32 bits none are exactly.
const ORTHOGONAL: f64 = 1e-5;

/// What a header says of positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Placement {
    /// Directions in space.
    Oriented(Geometry),
    /// Spacings alone.
    Spaced([f64; 3]),
}

/// What the fields say; `None` where that is nothing, or no numbers.
pub(super) fn placement(fields: &Fields) -> Option<Placement> {
    let code = |name| fields.numbers::<1>(name)[0] > 0.0;
    let geometry = if code("sform_code") {
        sform(fields)
    } else if code("qform_code") {
        qform(fields)
    } else {
        let [_, x, y, z, ..] = fields.numbers::<8>("pixdim");
        let spacing = [x, y, z].map(f64::abs);
        return spacing
            .iter()
            .all(|step| *step > 0.0 && step.is_finite())
            .then_some(Placement::Spaced(spacing));
    };
    let is_finite =
        geometry.directions.iter().chain([&geometry.origin]).flatten().all(|part| part.is_finite());
    is_finite.then_some(Placement::Oriented(geometry))
}

/// Method 3.
fn sform(fields: &Fields) -> Geometry {
    let rows: [[f64; 4]; 3] = ["srow_x", "srow_y", "srow_z"].map(|row| fields.numbers(row));
    let column = |axis: usize| rows.map(|row| row[axis]);
    Geometry { space: Space::RightAnteriorSuperior, directions: [0, 1, 2].map(column), origin: column(3) }
}

/// Method 2.
fn qform(fields: &Fields) -> Geometry {
    let [b, c, d]: [f64; 3] = fields.numbers("quatern");
    let rest = 1.0 - (b * b + c * c + d * d);
    // A half turn: rounding has made the vector part longer than 1.
    let (a, scale) =
        if rest < 1e-7 { (0.0, (b * b + c * c + d * d).sqrt().recip()) } else { (rest.sqrt(), 1.0) };
    let [b, c, d] = [b, c, d].map(|part| part * scale);
    let columns = [
        [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
        [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
        [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c],
    ];
    let [handedness, x, y, z, ..] = fields.numbers::<8>("pixdim");
    let steps = [x, y, if handedness < 0.0 { -z } else { z }];
    let directions = std::array::from_fn(|axis| columns[axis].map(|part| part * steps[axis]));
    Geometry { space: Space::RightAnteriorSuperior, directions, origin: fields.numbers("qoffset") }
}

/// Whether two vectors are the same but for rounding: formats that keep lengths and unit vectors multiply them.
fn is_close(one: &[f64; 3], other: &[f64; 3]) -> bool {
    let largest = one.iter().chain(other).fold(0.0_f64, |largest, part| largest.max(part.abs()));
    one.iter().zip(other).all(|(one, other)| (one - other).abs() <= 1e-12 * largest)
}

/// Whether two say the same of the first `rank` axes.
pub(super) fn is_same(one: &Option<Placement>, other: &Option<Placement>, rank: usize) -> bool {
    match (one, other) {
        (Some(Placement::Oriented(one)), Some(Placement::Oriented(other))) => {
            let has_name = (other.space == Space::Unnamed) == (one.space == Space::Unnamed);
            let other = other.in_space(one.space);
            let pairs = one.directions[..rank].iter().zip(&other.directions[..rank]);
            has_name && pairs.chain([(&one.origin, &other.origin)]).all(|(one, other)| is_close(one, other))
        }
        (Some(Placement::Spaced(one)), Some(Placement::Spaced(other))) => {
            one[..rank].iter().zip(&other[..rank]).all(|(one, other)| (one - other).abs() <= 1e-12 * one)
        }
        (one, other) => one.is_none() && other.is_none(),
    }
}

/// Makes the fields say this, and nothing that they said before.
pub(super) fn set_placement(fields: &mut Fields, placement: Option<&Placement>) {
    let mut pixdim: [f64; 8] = fields.numbers("pixdim");
    pixdim[0] = 1.0;
    for name in ["qform_code", "sform_code", "quatern", "qoffset", "srow_x", "srow_y", "srow_z"] {
        fields.set_numbers(
            name,
            match name {
                "quatern" | "qoffset" => &[0.0; 3],
                "qform_code" | "sform_code" => &[0.0],
                _ => &[0.0; 4],
            },
        );
    }
    let spacing = match placement {
        None => [1.0; 3],
        Some(Placement::Spaced(spacing)) => *spacing,
        Some(Placement::Oriented(geometry)) => {
            let ras = geometry.in_space(Space::RightAnteriorSuperior);
            let code = if geometry.space == Space::Unnamed { ALIGNED } else { SCANNER };
            set_sform(fields, &ras, code);
            if let Some((quaternion, handedness)) = quaternion(&ras) {
                fields.set("qform_code", code.to_owned());
                fields.set_numbers("quatern", &quaternion);
                fields.set_numbers("qoffset", &ras.origin);
                pixdim[0] = handedness;
            }
            ras.spacing()
        }
    };
    pixdim[1..4].copy_from_slice(&spacing);
    fields.set_numbers("pixdim", &pixdim);
}

fn set_sform(fields: &mut Fields, geometry: &Geometry, code: &str) {
    fields.set("sform_code", code.to_owned());
    for (row, name) in ["srow_x", "srow_y", "srow_z"].into_iter().enumerate() {
        let [x, y, z] = geometry.directions.map(|direction| direction[row]);
        fields.set_numbers(name, &[x, y, z, geometry.origin[row]]);
    }
}

/// The rotation as a quaternion's last three parts, and -1 for axes of the left hand. `None` where axes are not
/// orthogonal, which no quaternion says.
fn quaternion(geometry: &Geometry) -> Option<([f64; 3], f64)> {
    let spacing = geometry.spacing();
    if !spacing.iter().all(|step| *step > 0.0 && step.is_finite()) {
        return None;
    }
    let mut columns: [[f64; 3]; 3] =
        std::array::from_fn(|axis| geometry.directions[axis].map(|part| part / spacing[axis]));
    let dot =
        |one: [f64; 3], other: [f64; 3]| one.iter().zip(other).map(|(one, other)| one * other).sum::<f64>();
    let [x, y, z] = columns;
    if [dot(x, y), dot(y, z), dot(z, x)].iter().any(|cosine| cosine.abs() > ORTHOGONAL) {
        return None;
    }
    let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    let handedness = if dot(cross, z) < 0.0 { -1.0 } else { 1.0 };
    columns[2] = z.map(|part| part * handedness);
    let [x, y, z] = columns;
    let squares = [
        1.0 + x[0] + y[1] + z[2],
        1.0 + x[0] - y[1] - z[2],
        1.0 - x[0] + y[1] - z[2],
        1.0 - x[0] - y[1] + z[2],
    ];
    let largest = (0..4).max_by(|&one, &other| squares[one].total_cmp(&squares[other])).unwrap_or(0);
    let part = squares[largest].sqrt() / 2.0;
    let other = |sum: f64| sum / (4.0 * part);
    let [a, b, c, d] = match largest {
        0 => [part, other(y[2] - z[1]), other(z[0] - x[2]), other(x[1] - y[0])],
        1 => [other(y[2] - z[1]), part, other(x[1] + y[0]), other(z[0] + x[2])],
        2 => [other(z[0] - x[2]), other(x[1] + y[0]), part, other(y[2] + z[1])],
        _ => [other(x[1] - y[0]), other(z[0] + x[2]), other(y[2] + z[1]), part],
    };
    // Of a quaternion and its negative, which are the same rotation, the format keeps the one whose first part is not negative.
    let sign = if a < 0.0 { -1.0 } else { 1.0 };
    Some(([b, c, d].map(|part| part * sign), handedness))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rotation by `angle` around the axis `around`, and steps along its columns.
    fn turned(around: [f64; 3], angle: f64, steps: [f64; 3]) -> Geometry {
        let length = around.iter().map(|part| part * part).sum::<f64>().sqrt();
        let [x, y, z] = around.map(|part| part / length);
        let (sine, cosine) = angle.sin_cos();
        let rest = 1.0 - cosine;
        let columns = [
            [cosine + x * x * rest, y * x * rest + z * sine, z * x * rest - y * sine],
            [x * y * rest - z * sine, cosine + y * y * rest, z * y * rest + x * sine],
            [x * z * rest + y * sine, y * z * rest - x * sine, cosine + z * z * rest],
        ];
        let directions = std::array::from_fn(|axis| columns[axis].map(|part| part * steps[axis]));
        Geometry { space: Space::RightAnteriorSuperior, directions, origin: [1.0, -2.5, 1e3] }
    }

    #[test]
    fn rotations_come_back_from_their_quaternions() {
        for around in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -2.0, 3.0], [-1.0, 0.1, 0.2]]
        {
            for turn in -12..=12 {
                for steps in [[1.0, 1.0, 1.0], [0.5, 0.25, -3.0]] {
                    let geometry = turned(around, f64::from(turn) * std::f64::consts::PI / 12.0, steps);
                    let mut fields = Fields::default();
                    set_placement(&mut fields, Some(&Placement::Oriented(geometry)));
                    fields.set("sform_code", "0".to_owned());
                    let Some(Placement::Oriented(found)) = placement(&fields) else { panic!("no placement") };
                    for (one, other) in
                        found.directions.iter().flatten().zip(geometry.directions.iter().flatten())
                    {
                        assert!((one - other).abs() < 1e-6, "{around:?} {turn} {steps:?}");
                    }
                    assert_eq!(found.origin, geometry.origin);
                }
            }
        }
    }

    #[test]
    fn sheared_axes_have_rows_only() {
        let mut geometry = turned([1.0, 0.0, 0.0], 0.5, [1.0; 3]);
        geometry.directions[1][0] = 0.1;
        let mut fields = Fields::default();
        set_placement(&mut fields, Some(&Placement::Oriented(geometry)));
        assert_eq!(fields.numbers("qform_code"), [0.0]);
        assert_eq!(placement(&fields), Some(Placement::Oriented(geometry)));
        set_placement(&mut fields, Some(&Placement::Spaced([1.0, 2.0, 0.5])));
        assert_eq!(placement(&fields), Some(Placement::Spaced([1.0, 2.0, 0.5])));
        set_placement(&mut fields, None);
        assert_eq!(placement(&fields), Some(Placement::Spaced([1.0; 3])));
        assert_eq!(placement(&Fields::default()), None);
    }
}
