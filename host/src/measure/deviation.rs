//! How far one surface is from another.
//!
//! Source: Cignoni, Rocchini, Scopigno, *Metro: Measuring Error on Simplified Surfaces*, Computer Graphics Forum 17(2),
//! 1998: the distance of a point from a surface is that of its closest point; the mean and root mean square of it are
//! integrals over the other surface, divided by its area; a pair of surfaces is as far apart as the worse of both
//! directions says.

use rayon::prelude::*;

use super::{Bvh, Closest};
use crate::mesh::{Point, PolygonMesh, TriangleMesh};

/// Samples that are summed up by one thread, in order.
const RUN: usize = 1 << 14;

/// Distances of the points of one surface from another one, in the units of the positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Mean distance over the area.
    pub mean: f64,
    /// Root of the mean of squared distances over the area.
    pub rms: f64,
    /// Largest distance of a sample or vertex.
    pub max: f64,
    /// Samples over the area; the vertices come on top, for the largest distance only.
    pub samples: usize,
}

/// Distances between two surfaces, both ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDistance {
    /// From the first surface to the second.
    pub forward: Deviation,
    /// From the second surface to the first.
    pub backward: Deviation,
    /// Diagonal of the box around the first surface, the unit of relative errors.
    pub diagonal: f64,
}

impl SurfaceDistance {
    /// Distances between two triangle meshes, with about `samples` samples on each.
    ///
    /// Returns nothing if one of them has no triangles.
    pub fn between(first: &TriangleMesh, second: &TriangleMesh, samples: usize) -> Option<Self> {
        let trees = rayon::join(|| Bvh::new(first), || Bvh::new(second));
        Some(Self {
            forward: Deviation::from(first, &trees.1, samples)?,
            backward: Deviation::from(second, &trees.0, samples)?,
            diagonal: trees.0.bounds().diagonal(),
        })
    }

    /// Distances between two meshes of polygons, cut into triangles as [`PolygonMesh::triangulated`] does.
    pub fn between_polygons(first: &PolygonMesh, second: &PolygonMesh, samples: usize) -> Option<Self> {
        Self::between(&first.triangulated(), &second.triangulated(), samples)
    }

    /// The larger of both means, in units of `unit`: a length such as the [`diagonal`](Self::diagonal) or a cell's edge.
    pub fn mean(&self, unit: f64) -> f64 {
        self.forward.mean.max(self.backward.mean) / unit
    }

    /// The larger of both root mean squares, in units of `unit`.
    pub fn rms(&self, unit: f64) -> f64 {
        self.forward.rms.max(self.backward.rms) / unit
    }

    /// The larger of both maxima (the Hausdorff distance, as far as the samples tell), in units of `unit`.
    pub fn max(&self, unit: f64) -> f64 {
        self.forward.max.max(self.backward.max) / unit
    }
}

/// Sums over samples.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    distances: f64,
    squares: f64,
    largest_square: f64,
}

impl Sums {
    fn of(found: &[Option<Closest>]) -> Self {
        found.iter().flatten().fold(Self::default(), |sums, closest| Self {
            distances: sums.distances + closest.distance_squared.sqrt(),
            squares: sums.squares + closest.distance_squared,
            largest_square: sums.largest_square.max(closest.distance_squared),
        })
    }

    fn plus(self, other: Self) -> Self {
        Self {
            distances: self.distances + other.distances,
            squares: self.squares + other.squares,
            largest_square: self.largest_square.max(other.largest_square),
        }
    }
}

impl Deviation {
    /// Distances of the points of `from` to the mesh of a tree, with `samples` samples in proportion to area and
    /// the vertices of the triangles.
    ///
    /// Returns nothing if one of the meshes has no triangles or `from` has no area.
    ///
    /// Cost: as many closest points, in parallel; the result does not depend on the number of threads.
    pub fn from(from: &TriangleMesh, to: &Bvh, samples: usize) -> Option<Self> {
        let samples = samples.max(1);
        let spread = Spread::new(from, samples)?;
        to.closest(spread.point(0))?;
        let starts: Vec<usize> = (0..samples).step_by(RUN).collect();
        let runs: Vec<Sums> = starts
            .par_iter()
            .map(|&start| {
                let points: Vec<Point> =
                    (start..samples.min(start + RUN)).map(|sample| spread.point(sample)).collect();
                Sums::of(&to.closest_all(&points))
            })
            .collect();
        let sums = runs.into_iter().fold(Sums::default(), Sums::plus);
        let at_vertices = Sums::of(&to.closest_all(&used_vertices(from)));
        let count = samples as f64;
        Some(Self {
            mean: sums.distances / count,
            rms: (sums.squares / count).sqrt(),
            max: sums.largest_square.max(at_vertices.largest_square).sqrt(),
            samples,
        })
    }
}

fn used_vertices(mesh: &TriangleMesh) -> Vec<Point> {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&corner| used[corner as usize] = true);
    mesh.positions.iter().zip(used).filter_map(|(&point, used)| used.then_some(point)).collect()
}

/// Samples that lie evenly on a mesh: as many in each triangle as its area is worth, one more or less, at places of a
/// sequence that fills a square evenly.
struct Spread<'a> {
    mesh: &'a TriangleMesh,
    /// Area of all triangles up to each, that one included.
    areas: Vec<f64>,
    samples: usize,
}

impl<'a> Spread<'a> {
    fn new(mesh: &'a TriangleMesh, samples: usize) -> Option<Self> {
        let mut sum = 0.0;
        let areas = mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            sum += 0.5 * (b - a).cross(c - a).length();
            sum
        });
        let areas: Vec<f64> = areas.collect();
        (sum > 0.0).then_some(Self { mesh, areas, samples })
    }

    /// Where sample `sample` lies.
    ///
    /// The sequence is the additive recurrence with the inverse powers of the plastic number (Roberts, *The Unreasonable
    /// Effectiveness of Quasirandom Sequences*, 2018); the upper half of the square is turned over onto the triangle.
    fn point(&self, sample: usize) -> Point {
        const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
        let total = self.areas[self.areas.len() - 1];
        let area = total * ((sample as f64 + 0.5) / self.samples as f64);
        let triangle = self.areas.partition_point(|&sum| sum <= area).min(self.areas.len() - 1);
        let [a, b, c] = self.mesh.triangles[triangle].map(|corner| self.mesh.positions[corner as usize]);
        let [v, w] = STEPS.map(|step| (0.5 + step * (sample as f64 + 1.0)).fract());
        let [v, w] = if v + w > 1.0 { [1.0 - v, 1.0 - w] } else { [v, w] };
        a + (b - a) * v + (c - a) * w
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of `bands` bands of quads, cut into triangles.
    fn sphere(radius: f64, bands: u32) -> TriangleMesh {
        let around = 2 * bands;
        let mut mesh = TriangleMesh::default();
        for band in 0..=bands {
            for step in 0..around {
                let [polar, turn] =
                    [band, step].map(|part| f64::from(part) * std::f64::consts::PI / f64::from(bands));
                let ring = Point::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos());
                mesh.positions.push(ring * radius);
            }
        }
        for band in 0..bands {
            for step in 0..around {
                let [a, b] = [band * around + step, band * around + (step + 1) % around];
                mesh.triangles.extend([[a, a + around, b + around], [a, b + around, b]]);
            }
        }
        mesh
    }

    fn sheet(height: f64, side: f64) -> TriangleMesh {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        let positions = corners.map(|(x, y)| Point::new(x, y, height)).to_vec();
        TriangleMesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }
    }

    #[test]
    fn concentric_spheres_are_as_far_apart_as_their_radii() {
        let distance = SurfaceDistance::between(&sphere(1.0, 100), &sphere(1.1, 100), 20_000).unwrap();
        for found in [distance.mean(1.0), distance.rms(1.0), distance.max(1.0)] {
            assert!((found - 0.1).abs() < 2e-3, "{distance:?}");
        }
        assert!((distance.rms(distance.diagonal) - 0.1 / 12.0_f64.sqrt()).abs() < 1e-3);
    }

    #[test]
    fn sheets_have_the_distance_of_planes_and_of_what_sticks_out() {
        let same = SurfaceDistance::between(&sheet(0.0, 1.0), &sheet(0.25, 1.0), 1000).unwrap();
        assert_eq!((same.mean(0.5), same.rms(0.5), same.max(0.25)), (0.5, 0.5, 1.0));
        // From a sheet of side 2 to one of side 1: mean squared distance 2/3 (by integration), at most a diagonal.
        let larger = SurfaceDistance::between(&sheet(0.0, 2.0), &sheet(0.0, 1.0), 100_000).unwrap();
        assert!(larger.backward.max < 1e-12);
        assert!((larger.forward.rms - (1.0_f64 / 3.0).sqrt()).abs() < 1e-3, "{larger:?}");
        assert_eq!(larger.forward.max, 2.0_f64.sqrt());
    }

    #[test]
    fn samples_are_spread_in_proportion_to_area() {
        let mut mesh = sheet(0.0, 1.0);
        mesh.positions.extend([
            Point::new(9.0, 0.0, 0.0),
            Point::new(9.0, 2.0, 0.0),
            Point::new(8.0, 0.0, 0.0),
        ]);
        mesh.triangles.extend([[4, 5, 6], [4, 4, 5]]);
        let spread = Spread::new(&mesh, 1000).unwrap();
        let right = (0..1000).filter(|&sample| spread.point(sample).x > 2.0).count();
        assert_eq!(right, 500);
        let middle: Point = (0..500).map(|sample| spread.point(sample)).sum::<Point>() / 500.0;
        assert!(middle.distance(Point::new(0.5, 0.5, 0.0)) < 0.01, "{middle}");
    }

    #[test]
    fn nothing_is_no_distance_away() {
        let empty = TriangleMesh::default();
        assert_eq!(SurfaceDistance::between(&empty, &sheet(0.0, 1.0), 10), None);
        assert_eq!(SurfaceDistance::between(&sheet(0.0, 1.0), &empty, 10), None);
        let sheets = PolygonMesh::from(sheet(0.0, 1.0));
        assert!(SurfaceDistance::between_polygons(&sheets, &sheets, 10).unwrap().max(1.0) < 1e-12);
    }
}
