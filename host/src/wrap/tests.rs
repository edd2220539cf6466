//! Whole surfaces, wrapped around functions whose zeros are known.

use super::*;
use crate::field::Grid;
use crate::mesh::{Faces, Point};
use crate::subdivision::Split;

/// Cubes of `cube` cells each in the box of a field, those with their centre inside taken as one body, whose surface is the
/// base mesh. Cubes are added where that surface would not be a manifold.
pub(super) fn cubes(field: &ScalarField, cube: usize) -> PolygonMesh {
    let grid = field.grid();
    let counts = grid.extent.map(|nodes| (nodes - 1) / cube);
    let spot = |cell: [usize; 3], half: f64| {
        let local = cell.map(|index| (index as f64 + half) * cube as f64);
        grid.origin + grid.spacing * Point::from_array(local)
    };
    let mut body = Body { counts, inside: Vec::new() };
    let cells: Vec<[usize; 3]> = body.cells(counts).collect();
    body.inside = cells.iter().map(|&cell| field.sample_clamped(spot(cell, 0.5)) < 0.0).collect();
    while body.fill_once() {}
    let corners = counts.map(|count| count + 1);
    let number = |[i, j, k]: [usize; 3]| (k * corners[1] + j) * corners[0] + i;
    let quads: Vec<[usize; 4]> = body.sides().map(|quad| quad.map(number)).collect();
    let mut numbers = vec![None; corners.iter().product()];
    let all: Vec<[usize; 3]> = body.cells(corners).collect();
    let (mut positions, mut faces) = (Vec::new(), Faces::default());
    for quad in quads {
        let quad = quad.map(|corner| {
            *numbers[corner].get_or_insert_with(|| {
                positions.push(spot(all[corner], 0.0));
                positions.len() as u32 - 1
            })
        });
        faces.push(&quad);
    }
    PolygonMesh::new(positions, faces)
}

struct Body {
    counts: [usize; 3],
    inside: Vec<bool>,
}

impl Body {
    fn cells(&self, [width, height, depth]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
        (0..depth).flat_map(move |k| (0..height).flat_map(move |j| (0..width).map(move |i| [i, j, k])))
    }

    fn place(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// Adds cubes around one corner after the other, where those inside or those outside do not hang together by their
    /// faces; whether any was added.
    fn fill_once(&mut self) -> bool {
        let mut filled = false;
        for corner in self.cells(self.counts.map(|count| count + 1)) {
            let around: Vec<[usize; 3]> = (0..8_usize)
                .map(|bits| [0, 1, 2].map(|axis| (corner[axis] + (bits >> axis & 1)).wrapping_sub(1)))
                .filter(|cell| (0..3).all(|axis| cell[axis] < self.counts[axis]))
                .collect();
            for inside in [true, false] {
                let alike: Vec<_> =
                    around.iter().copied().filter(|&cell| self.inside[self.place(cell)] == inside).collect();
                if !hang_together(&alike) {
                    around.iter().for_each(|&cell| {
                        let place = self.place(cell);
                        self.inside[place] = true;
                    });
                    filled = true;
                }
            }
        }
        filled
    }

    /// Quads between cubes inside and outside, as corners of cubes, counter-clockwise seen from outside.
    fn sides(&self) -> impl Iterator<Item = [[usize; 3]; 4]> {
        let beside = |cell: [usize; 3], axis: usize| {
            let mut next = cell;
            next[axis] += 1;
            (next[axis] < self.counts[axis]).then_some(next)
        };
        let axes = move |cell| (0..3).filter_map(move |axis| Some((cell, axis, beside(cell, axis)?)));
        self.cells(self.counts).flat_map(axes).filter_map(move |(cell, axis, next)| {
            let [here, there] = [cell, next].map(|cell| self.inside[self.place(cell)]);
            let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |a: usize, b: usize| {
                let mut corner = next;
                corner[one] += a;
                corner[other] += b;
                corner
            };
            let mut quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if there {
                quad.reverse();
            }
            (here != there).then_some(quad)
        })
    }
}

/// Whether cubes are connected by their faces.
fn hang_together(cells: &[[usize; 3]]) -> bool {
    let beside =
        |a: &[usize; 3], b: &[usize; 3]| (0..3).map(|axis| a[axis].abs_diff(b[axis])).sum::<usize>() == 1;
    let mut met: Vec<[usize; 3]> = cells.first().copied().into_iter().collect();
    let mut next = 0;
    while next < met.len() {
        let here = met[next];
        met.extend(
            cells
                .iter()
                .filter(|cell| beside(cell, &here) && !met.contains(cell))
                .copied()
                .collect::<Vec<_>>(),
        );
        next += 1;
    }
    met.len() == cells.len()
}

fn sphere(extent: usize, radius: f64) -> ScalarField {
    let middle = Point::splat((extent - 1) as f64 / 2.0);
    ScalarField::from_function(Grid::unit([extent; 3]), |point| point.distance(middle) - radius)
}

#[test]
fn cubes_make_a_manifold() {
    let mesh = cubes(&sphere(33, 11.0), 8);
    let split = Split::new(mesh.positions.len(), mesh.faces());
    assert_eq!(mesh.positions.len() + mesh.faces().len(), split.edges.len() + 2);
}

#[test]
fn a_sphere_is_wrapped() {
    let field = sphere(33, 11.0);
    let wrapped = wrap(&cubes(&field, 8), &field, &WrapOptions::default()).unwrap();
    for level in &wrapped.report.levels {
        println!("{level:?}");
    }
    let last = wrapped.report.levels.last().unwrap();
    assert!(last.at_vertices.most < 1e-4 && last.at_faces.rms < 0.05, "{last:?}");
    assert_eq!(last.inverted, Inverted::default());
}

/// Waves in all directions, over the length of their gradient.
fn waves(extent: usize, length: f64) -> ScalarField {
    let scale = std::f64::consts::TAU / length;
    let wave = |point: Point| {
        let terms = (0..24_u32).map(|term| {
            let angle = |salt: u32| f64::from((term * 7 + salt).wrapping_mul(2_654_435_761) >> 8) * 1e-3;
            let direction = Point::new(angle(1).cos(), angle(2).cos(), angle(3).cos()) * scale;
            (direction.dot(point) + angle(4)).sin()
        });
        terms.sum::<f64>()
    };
    ScalarField::from_function(Grid::unit([extent; 3]), |point| {
        let slope = |axis: Point| (wave(point + axis * 0.01) - wave(point - axis * 0.01)) / 0.02;
        let gradient = Point::new(slope(Point::X), slope(Point::Y), slope(Point::Z));
        (wave(point) / gradient.length().max(1e-9)).clamp(-4.0, 4.0)
    })
}

#[test]
fn waves_are_wrapped() {
    let field = waves(65, 40.0);
    let wrapped = wrap(&cubes(&field, 4), &field, &WrapOptions::default()).unwrap();
    for level in &wrapped.report.levels {
        println!("{level:?}");
    }
}
