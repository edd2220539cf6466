//! How well a surface fits what it was made from, looked at from both sides: what is lost is seen from the target only.

use crate::field::ScalarField;
use crate::measure::{Bounds, Bvh, Closest};
use crate::mesh::{Point, PolygonMesh, Sets, TriangleMesh};
use crate::simplify::History;
use crate::wrap::{Draw, Misfit, ways};

/// A surface fits whose distance from the target is at most this, root mean square, in cells' edges, and of which nothing is
/// missed.
pub(super) const RMS: f64 = 0.05;

/// Vertices of the target that are farther than this from the surface are missed by it, in cells' edges.
pub const MISSED: f64 = 1.0;

/// Places of the surface that are not farther than this from the target are on it, in cells' edges.
pub(super) const ON: f64 = 0.1;

/// No part of a surface.
pub(super) const NONE: u32 = u32::MAX;

/// How far a surface and its target are from each other, in cells' edges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fit {
    /// The surface from its target.
    pub forward: Misfit,
    /// The target from the surface.
    pub backward: Misfit,
    /// Components of the target that the surface misses in part or whole, the farthest first.
    pub missed: Vec<Missed>,
}

/// A component of the target that the surface misses in part or whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// Where the surface is farthest.
    pub place: Point,
    /// How far, in cells' edges.
    pub most: f64,
    /// Vertices that are farther than [`MISSED`].
    pub missed: usize,
    /// All of its vertices.
    pub vertices: usize,
    /// Diagonal of the box around it, in cells' edges.
    pub diagonal: f64,
}

impl Fit {
    /// The larger root mean square of both ways.
    pub const fn rms(&self) -> f64 {
        self.forward.rms.max(self.backward.rms)
    }

    /// The largest distance either way.
    pub const fn most(&self) -> f64 {
        self.forward.most.max(self.backward.most)
    }
}

/// What surfaces are to fit, ready to be measured against.
pub(super) struct Aim<'a> {
    pub(super) mesh: &'a TriangleMesh,
    /// The field of which that is an isosurface, and the isovalue: the triangles themselves are off by a tenth of a cell's
    /// edge where the field is rough, but not at their vertices.
    field: Option<(&'a ScalarField, f32)>,
    pub(super) tree: Bvh,
    pub(super) cell: f64,
    /// The component of each vertex.
    pub(super) components: Vec<u32>,
    pub(super) component_count: usize,
}

/// A fit, and how far each vertex is off, in cells' edges.
pub(super) struct Measured {
    pub(super) fit: Fit,
    /// The vertices of the target.
    pub(super) of_target: Vec<f64>,
    /// The vertices of the surface, and the middles of its faces.
    pub(super) of_surface: Vec<f64>,
    /// Those of these that are farther off than [`ON`], and the triangle of the target that is closest to each.
    pub(super) off: Vec<(f64, u32)>,
    /// The vertex of the surface that is near each vertex of the target: of the place that is closest.
    pub(super) nearest: Vec<u32>,
}

impl<'a> Aim<'a> {
    pub(super) fn new(mesh: &'a TriangleMesh, field: Option<(&'a ScalarField, f32)>, cell: f64) -> Self {
        let mut sets = Sets::new(mesh.positions.len());
        for &[a, b, c] in &mesh.triangles {
            sets.join(a, b);
            sets.join(b, c);
        }
        let (components, component_count) = sets.counted();
        Self { mesh, field, tree: Bvh::new(mesh), cell, components, component_count }
    }

    /// Measures a surface at its vertices and the middles of its faces, and at the vertices of the target, each for the area
    /// around it.
    ///
    /// Cost: a closest point for each vertex of the target and for what is off it, on all threads.
    pub(super) fn measure(&self, surface: &PolygonMesh) -> Measured {
        let (of_target, nearest) = {
            let triangles = surface.triangulated();
            let found = Bvh::new(&triangles).closest_all(&self.mesh.positions);
            let nearest = found
                .iter()
                .zip(&self.mesh.positions)
                .map(|(closest, &place)| nearest(&triangles, closest, place));
            let nearest = nearest.collect();
            (found.iter().map(|closest| self.in_cells(closest)).collect::<Vec<f64>>(), nearest)
        };
        let places = with_middles(surface);
        let (of_surface, off) = self.off(&places);
        let fit = Fit {
            forward: misfit(&places, fans(surface), &of_surface),
            backward: misfit(&self.mesh.positions, self.mesh.triangles.iter().copied(), &of_target),
            missed: self.missed(&of_target),
        };
        Measured { fit, of_target, of_surface, off, nearest }
    }

    /// How far places are from the target: those that are near an isosurface by the way down to it, which is known without
    /// a look at its triangles. And how far those are off, and from which triangle, that are not on it.
    fn off(&self, places: &[Point]) -> (Vec<f64>, Vec<(f64, u32)>) {
        let mut distances = match self.field {
            Some((field, isovalue)) => ways(field, isovalue.into(), places),
            None => vec![None; places.len()],
        };
        let is_off = |distance: &Option<f64>| distance.is_none_or(|distance| distance > ON);
        let off = distances.iter().zip(places).filter(|(distance, _)| is_off(distance));
        let off: Vec<Point> = off.map(|(_, &place)| place).collect();
        let closest = self.tree.closest_all(&off);
        let found = distances.iter_mut().filter(|distance| is_off(distance)).zip(closest);
        let off = found.filter_map(|(distance, closest)| {
            let distance = *distance.get_or_insert(self.in_cells(&closest));
            Some((distance, closest?.triangle)).filter(|_| distance > ON)
        });
        let off = off.collect();
        (distances.into_iter().map(|distance| distance.unwrap_or(f64::INFINITY)).collect(), off)
    }

    fn in_cells(&self, closest: &Option<Closest>) -> f64 {
        closest.map_or(f64::INFINITY, |closest| closest.distance_squared.sqrt() / self.cell)
    }

    /// What draws vertices of the surface: places of the target that it passes farther than `limit`, in cells' edges, but does
    /// not miss; of those near a vertex the farthest.
    pub(super) fn draws(&self, measured: &Measured, limit: f64) -> Vec<Draw> {
        let off = measured.of_target.iter().zip(&measured.nearest).zip(&self.mesh.positions);
        let mut draws: Vec<(u32, f64, Point)> = off
            .filter(|((distance, _), _)| (limit..=MISSED).contains(*distance))
            .map(|((&distance, &vertex), &place)| (vertex, distance, place))
            .collect();
        draws.sort_by(|one, other| one.0.cmp(&other.0).then(other.1.total_cmp(&one.1)));
        draws.dedup_by_key(|draw| draw.0);
        draws.into_iter().map(|(vertex, _, place)| Draw { vertex, place }).collect()
    }

    /// The component of the target that each vertex of a surface belongs to.
    pub(super) fn components_of(&self, surface: &PolygonMesh, history: &History) -> Vec<u32> {
        let mut sets = Sets::new(surface.positions.len());
        for face in surface.faces().iter() {
            face.iter().for_each(|&corner| sets.join(face[0], corner));
        }
        // The first vertex of a component is one of the base mesh.
        let of = |vertex| self.components[history.origin(sets.root(vertex)) as usize];
        (0..surface.positions.len() as u32).map(of).collect()
    }

    /// By how many times each of some parts is too far from the surface or the surface from it: 1 where the root mean squares
    /// are at most `rms` and all else `most`. `parts` are those of the vertices of the surface and of the target, [`NONE`] for
    /// what does not count.
    pub(super) fn excesses(
        parts: [&[u32]; 2],
        count: usize,
        measured: &Measured,
        [rms, most]: [f64; 2],
    ) -> Vec<f64> {
        let mut excesses = vec![[1.0_f64; 2]; count];
        for (parts, distances) in parts.into_iter().zip([&measured.of_surface, &measured.of_target]) {
            let mut tallies = vec![(0.0, 0.0); count];
            for (&part, &distance) in parts.iter().zip(distances).filter(|(part, _)| **part != NONE) {
                let (squares, count) = &mut tallies[part as usize];
                (*squares, *count) = (*squares + distance * distance, *count + 1.0);
                let [_, farthest] = &mut excesses[part as usize];
                *farthest = farthest.max(distance / most);
            }
            for ([mean, _], (squares, count)) in excesses.iter_mut().zip(tallies) {
                *mean = mean.max((squares / f64::max(count, 1.0)).sqrt() / rms);
            }
        }
        excesses.into_iter().map(|[mean, farthest]| mean * farthest).collect()
    }

    fn missed(&self, distances: &[f64]) -> Vec<Missed> {
        let none = Missed { place: Point::ZERO, most: 0.0, missed: 0, vertices: 0, diagonal: 0.0 };
        let mut tallies = vec![(none, Bounds::NONE); self.component_count];
        for ((&component, &place), &distance) in
            self.components.iter().zip(&self.mesh.positions).zip(distances)
        {
            let (tally, bounds) = &mut tallies[component as usize];
            tally.vertices += 1;
            tally.missed += usize::from(distance > MISSED);
            *bounds = bounds.joined(Bounds { low: place, high: place });
            if distance > tally.most {
                (tally.most, tally.place) = (distance, place);
            }
        }
        let missed = tallies.into_iter().filter(|(tally, _)| tally.missed > 0);
        let mut missed: Vec<Missed> = missed
            .map(|(tally, bounds)| Missed { diagonal: bounds.diagonal() / self.cell, ..tally })
            .collect();
        missed.sort_by(|one, other| other.most.total_cmp(&one.most));
        missed
    }
}

/// The corner of the triangle of a closest place that is nearest to a point.
fn nearest(mesh: &TriangleMesh, closest: &Option<Closest>, point: Point) -> u32 {
    let Some(closest) = closest else { return 0 };
    let away = |&corner: &u32| mesh.positions[corner as usize].distance_squared(point);
    let [a, b, c] = mesh.triangles[closest.triangle as usize];
    [b, c].into_iter().fold(a, |best, other| if away(&other) < away(&best) { other } else { best })
}

/// Root mean square over the area of triangles, and the largest, of distances at their corners.
fn misfit(places: &[Point], triangles: impl Iterator<Item = [u32; 3]>, distances: &[f64]) -> Misfit {
    let (mut squares, mut areas, mut most) = (0.0, 0.0, 0.0_f64);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| places[corner as usize]);
        let area = (b - a).cross(c - a).length();
        let of_corners = triangle.map(|corner| distances[corner as usize]);
        squares += area * of_corners.iter().map(|distance| distance * distance).sum::<f64>() / 3.0;
        areas += area;
        most = of_corners.into_iter().fold(most, f64::max);
    }
    Misfit { rms: if areas > 0.0 { (squares / areas).sqrt() } else { 0.0 }, most }
}

/// The vertices of a surface, and the middles of its faces.
fn with_middles(surface: &PolygonMesh) -> Vec<Point> {
    let middle = |face: &[u32]| {
        let sum: Point = face.iter().map(|&corner| surface.positions[corner as usize]).sum();
        sum / face.len() as f64
    };
    surface.positions.iter().copied().chain(surface.faces().iter().map(middle)).collect()
}

/// Every face as the triangles between its sides and its middle.
fn fans(surface: &PolygonMesh) -> impl Iterator<Item = [u32; 3]> {
    let middles = surface.positions.len() as u32..;
    surface.faces().iter().zip(middles).flat_map(|(face, middle)| {
        let next = face.iter().cycle().skip(1);
        face.iter().zip(next).map(move |(&from, &to)| [from, to, middle])
    })
}
