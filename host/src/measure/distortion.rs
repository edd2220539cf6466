//! How evenly the quads of a mesh are stretched over their surface.
//!
//! Each quad is the bilinear image of the unit square. Its Jacobian at a corner has the two sides there as columns; the
//! singular values of it tell everything about lengths, angles and areas at that corner.
//!
//! Sources: Sander, Snyder, Gortler, Hoppe, *Texture Mapping Progressive Meshes*, 2001, §3 (stretch: root of half the sum
//! of the squared singular values); Hormann, Greiner, *MIPS: An Efficient Global Parametrization Method*, 2000 (conformal
//! energy: sum of their ratios); Knupp, *Algebraic mesh quality metrics for unstructured initial meshes*, 2003 (scaled
//! Jacobian).

use crate::mesh::{Point, PolygonMesh};

/// Shape of one quad. The unit square has the values 0, 1, 1, 1, its side as stretch, and its area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadShape {
    /// Largest difference of a corner's angle from a right one, in degrees.
    pub angle: f64,
    /// Longest side by shortest; infinite if one has no length.
    pub aspect: f64,
    /// Mean over the corners of half the sum of both ratios of singular values, 1 where angles are kept; infinite where
    /// a corner is flat.
    pub conformal: f64,
    /// Smallest sine of a corner's angle, negative where the corner is turned over against the normal of the quad.
    pub scaled_jacobian: f64,
    /// Root mean square over the corners of the stretch.
    pub stretch: f64,
    /// Half the length of the cross product of the diagonals.
    pub area: f64,
}

/// Smallest, mean and largest of the values of all quads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Smallest value.
    pub min: f64,
    /// Mean of the values.
    pub mean: f64,
    /// Largest value.
    pub max: f64,
}

/// Shapes of the quads of a mesh, summed up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion {
    /// Quads that were measured.
    pub quads: usize,
    /// Quads with a corner that is turned over or flat.
    pub inverted: usize,
    /// Difference from right angles, in degrees.
    pub angle: Spread,
    /// Longest side by shortest.
    pub aspect: Spread,
    /// Conformal energy.
    pub conformal: Spread,
    /// Scaled Jacobian.
    pub scaled_jacobian: Spread,
    /// Area by mean area: 1 where all quads are as large.
    pub area: Spread,
    /// Stretch by that of a square of the mean area: the mean square of it is 1 if all quads are squares as large.
    pub stretch: Spread,
}

impl QuadShape {
    /// Measures the quad with these corners in order.
    pub fn new(corners: [Point; 4]) -> Self {
        let [a, b, c, d] = corners;
        let area_vector = (c - a).cross(d - b) * 0.5;
        let normal = area_vector.normalize_or_zero();
        let sides = [b - a, c - b, d - c, a - d];
        let lengths = sides.map(Point::length);
        let bends = [0, 1, 2, 3].map(|corner| Bend::new(sides[corner], -sides[(corner + 3) % 4], normal));
        let [shortest, longest] = [
            lengths.iter().copied().fold(f64::INFINITY, f64::min),
            lengths.iter().copied().fold(0.0, f64::max),
        ];
        Self {
            angle: bends.iter().map(|bend| bend.angle).fold(0.0, f64::max),
            aspect: if shortest > 0.0 { longest / shortest } else { f64::INFINITY },
            conformal: bends.iter().map(|bend| bend.conformal).sum::<f64>() / 4.0,
            scaled_jacobian: bends.iter().map(|bend| bend.sine).fold(f64::INFINITY, f64::min),
            stretch: (bends.iter().map(|bend| bend.squares).sum::<f64>() / 8.0).sqrt(),
            area: area_vector.length(),
        }
    }
}

/// A corner of a quad.
struct Bend {
    angle: f64,
    conformal: f64,
    sine: f64,
    /// Sum of the squared singular values.
    squares: f64,
}

impl Bend {
    /// Sides `u`, `v` leave the corner; `v` lies to the left of `u` seen from where `normal` points.
    fn new(u: Point, v: Point, normal: Point) -> Self {
        let (cross, dot) = (u.cross(v), u.dot(v));
        let (squares, product) = (u.length_squared() + v.length_squared(), cross.length());
        let lengths = u.length() * v.length();
        let signed = if cross.dot(normal) < 0.0 { -product } else { product };
        // Seen from the normal, a corner that is turned over has an angle beyond 180 degrees.
        let angle = signed.atan2(dot).to_degrees().rem_euclid(360.0);
        Self {
            angle: (angle - 90.0).abs(),
            conformal: if product > 0.0 { squares / (2.0 * product) } else { f64::INFINITY },
            sine: if lengths > 0.0 { signed / lengths } else { 0.0 },
            squares,
        }
    }
}

impl Spread {
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        Self {
            min: values.clone().fold(f64::INFINITY, f64::min),
            mean: values.clone().sum::<f64>() / count,
            max: values.fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

impl Distortion {
    /// Measures all faces of four sides; none if there are none.
    ///
    /// Cost: one pass, 48 bytes a quad.
    pub fn of(mesh: &PolygonMesh) -> Option<Self> {
        let quads = mesh.faces().iter().filter_map(|face| <[u32; 4]>::try_from(face).ok());
        let shapes: Vec<QuadShape> =
            quads.map(|quad| QuadShape::new(quad.map(|corner| mesh.positions[corner as usize]))).collect();
        if shapes.is_empty() {
            return None;
        }
        let spread = |value: fn(&QuadShape) -> f64| Spread::of(shapes.iter().map(value));
        let scaled = |spread: Spread, unit: f64| Spread {
            min: spread.min / unit,
            mean: spread.mean / unit,
            max: spread.max / unit,
        };
        let area = spread(|shape| shape.area);
        Some(Self {
            quads: shapes.len(),
            inverted: shapes.iter().filter(|shape| shape.scaled_jacobian <= 0.0).count(),
            angle: spread(|shape| shape.angle),
            aspect: spread(|shape| shape.aspect),
            conformal: spread(|shape| shape.conformal),
            scaled_jacobian: spread(|shape| shape.scaled_jacobian),
            area: scaled(area, area.mean),
            stretch: scaled(spread(|shape| shape.stretch), area.mean.sqrt()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Faces;

    fn flat(corners: [(f64, f64); 4]) -> [Point; 4] {
        corners.map(|(x, y)| Point::new(x, y, 7.0))
    }

    #[test]
    fn a_square_is_not_distorted() {
        let shape = QuadShape::new(flat([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]));
        let expected = QuadShape {
            angle: 0.0,
            aspect: 1.0,
            conformal: 1.0,
            scaled_jacobian: 1.0,
            stretch: 2.0,
            area: 4.0,
        };
        assert_eq!(shape, expected);
    }

    #[test]
    fn rectangles_keep_angles_and_rhombs_lengths() {
        let rectangle = QuadShape::new(flat([(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)]));
        assert_eq!((rectangle.angle, rectangle.aspect, rectangle.scaled_jacobian), (0.0, 3.0, 1.0));
        assert!((rectangle.conformal - 10.0 / 6.0).abs() < 1e-12);
        assert!((rectangle.stretch - 5.0_f64.sqrt()).abs() < 1e-12);
        let height = 0.75_f64.sqrt();
        let rhomb = QuadShape::new(flat([(0.0, 0.0), (1.0, 0.0), (1.5, height), (0.5, height)]));
        assert!((rhomb.angle - 30.0).abs() < 1e-9 && (rhomb.aspect - 1.0).abs() < 1e-12);
        assert!((rhomb.scaled_jacobian - height).abs() < 1e-12);
    }

    #[test]
    fn corners_that_are_turned_over_are_negative() {
        let arrow = QuadShape::new(flat([(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)]));
        assert!((arrow.scaled_jacobian + 1.0).abs() < 1e-12);
        assert!((arrow.angle - 180.0).abs() < 1e-9);
        let dot = QuadShape::new([Point::ONE; 4]);
        assert_eq!((dot.aspect, dot.scaled_jacobian, dot.area), (f64::INFINITY, 0.0, 0.0));
    }

    #[test]
    fn a_mesh_is_measured_by_its_quads() {
        let at = |x, y| Point::new(x, y, 0.0);
        let mut positions = flat([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]).to_vec();
        positions.extend([at(5.0, 0.0), at(8.0, 0.0), at(8.0, 1.0), at(5.0, 1.0)]);
        let faces: [&[u32]; 3] = [&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 2]];
        let found = Distortion::of(&PolygonMesh::new(positions, Faces::from_iter(faces))).unwrap();
        assert_eq!((found.quads, found.inverted), (2, 0));
        assert_eq!((found.area.min, found.area.mean, found.area.max), (0.5, 1.0, 1.5));
        assert_eq!((found.aspect.min, found.aspect.mean, found.aspect.max), (1.0, 2.0, 3.0));
        assert_eq!(Distortion::of(&PolygonMesh::default()), None);
    }
}
