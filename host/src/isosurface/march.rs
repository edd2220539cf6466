//! The passes over rows of nodes and layers of cells.
//!
//! Vertices are numbered plane by plane: first those of each row of nodes (edges along x, then y, then z that start in the
//! row), then the middles of the layer of cells above the plane. So the number of a vertex follows from how many edges of
//! its kind cross the surface before it in its row, which is counted along the way.

use rayon::prelude::*;

use super::ContourError;
use super::case::{Cases, PLACES, Pattern};
use super::cell::{self, CORNERS};
use super::inside::{Inside, ones, shifted};
use crate::field::ScalarField;
use crate::mesh::{Point, TriangleMesh};

/// Least share of an edge between a vertex and an end.
const MARGIN: f64 = 1.0 / 1024.0;

/// See [`super::contour`].
pub(super) fn march(field: &ScalarField, isovalue: f32) -> Result<TriangleMesh, ContourError> {
    let [width, height, depth] = field.grid().extent;
    if width.min(height).min(depth) < 2 {
        return Ok(TriangleMesh::default());
    }
    let inside = Inside::new(field, isovalue);
    let layers = Layers { field, isovalue, inside: &inside, cases: Cases::get() };
    let mut rows = vec![[0; 3]; height * depth];
    let mut planes: Vec<Plane> = rows
        .par_chunks_mut(height)
        .enumerate()
        .map(|(k, rows)| {
            rows.iter_mut().enumerate().for_each(|(j, row)| *row = layers.count_vertices(j, k));
            layers.count_layer(k)
        })
        .collect();
    let vertices = number(&mut rows, &mut planes, height);
    if u32::try_from(vertices).is_err() {
        return Err(ContourError::TooManyVertices { vertices });
    }
    Ok(layers.write(&rows, &planes))
}

/// What a plane of nodes and the layer of cells above it hold.
#[derive(Clone, Debug, Default)]
struct Plane {
    vertices: usize,
    triangles: usize,
    /// How many middles there are; then the number of the first.
    middles: u64,
    /// The triangles of those cells whose inside corners alone do not decide, in the order in which cells are visited.
    decided: Vec<&'static Pattern>,
}

/// Turns the numbers of vertices of rows along each axis, and of middles, into the numbers of their first ones. Returns how
/// many there are.
fn number(rows: &mut [[u64; 3]], planes: &mut [Plane], height: usize) -> u64 {
    let mut next = 0;
    for (plane, rows) in planes.iter_mut().zip(rows.chunks_mut(height)) {
        let start = next;
        for count in rows.iter_mut().flatten().chain([&mut plane.middles]) {
            next += std::mem::replace(count, next);
        }
        plane.vertices = (next - start) as usize;
    }
    next
}

/// What all passes look at.
#[derive(Clone, Copy, Debug)]
struct Layers<'a> {
    field: &'a ScalarField,
    isovalue: f32,
    inside: &'a Inside,
    cases: &'static Cases,
}

impl<'a> Layers<'a> {
    /// Rows of nodes that start the rows of nodes at (j, k), (j + 1, k), (j, k + 1) and (j + 1, k + 1); outside the grid,
    /// the nearest one.
    fn four(&self, j: usize, k: usize) -> [&'a [u64]; 4] {
        let [_, height, depth] = self.field.grid().extent;
        [0, 1, 2, 3].map(|n| {
            let (j, k) = ((j + (n & 1)).min(height - 1), (k + (n >> 1)).min(depth - 1));
            self.inside.row(k * height + j)
        })
    }

    /// Bits of the edges that start in a row of nodes and cross the surface, along each axis, by word.
    fn crossings(&self, j: usize, k: usize) -> impl Iterator<Item = [u64; 3]> + 'a {
        let [row, next, above, _] = self.four(j, k);
        let last = self.field.grid().extent[0] - 1;
        (0..row.len()).map(move |at| {
            let along_x = (row[at] ^ shifted(row, at)) & below(last, at);
            [along_x, row[at] ^ next[at], row[at] ^ above[at]]
        })
    }

    /// Vertices on the edges that start in a row of nodes, along each axis.
    fn count_vertices(&self, j: usize, k: usize) -> [u64; 3] {
        let counts = self.crossings(j, k).map(|words| words.map(|word| u64::from(word.count_ones())));
        counts.fold([0; 3], |sum, count| std::array::from_fn(|axis| sum[axis] + count[axis]))
    }

    /// Calls a function for each cell of row j of layer k that the surface meets, with its first node and inside corners.
    fn cells(&self, j: usize, k: usize, mut visit: impl FnMut(usize, u8)) {
        let rows = self.four(j, k);
        let last = self.field.grid().extent[0] - 1;
        for at in 0..rows[0].len() {
            let (low, high) = (rows.map(|row| row[at]), rows.map(|row| shifted(row, at)));
            let any = low.iter().chain(&high).fold(0, |any, word| any | word);
            let all = low.iter().chain(&high).fold(u64::MAX, |all, word| all & word);
            for place in ones(any & !all & below(last, at)) {
                let pairs = (0..4).map(|n| (low[n] >> place & 1 | (high[n] >> place & 1) << 1) << (2 * n));
                visit(64 * at + place, pairs.fold(0, |inside, pair| inside | pair) as u8);
            }
        }
    }

    /// The triangles of a cell whose inside corners alone do not decide.
    fn decide(&self, [i, j, k]: [usize; 3], inside: u8) -> &'static Pattern {
        let values: [f64; CORNERS] = std::array::from_fn(|corner| {
            let node = [i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)];
            f64::from(self.field.at(node)) - f64::from(self.isovalue)
        });
        self.cases.decide(inside, &values)
    }

    /// Triangles and middles of layer k.
    fn count_layer(&self, k: usize) -> Plane {
        let mut plane = Plane::default();
        let [_, height, depth] = self.field.grid().extent;
        if k + 1 < depth {
            for j in 0..height - 1 {
                self.cells(j, k, |i, inside| {
                    let pattern = self.cases.certain(inside).unwrap_or_else(|| {
                        let pattern = self.decide([i, j, k], inside);
                        plane.decided.push(pattern);
                        pattern
                    });
                    plane.triangles += pattern.triangles.len();
                    plane.middles += pattern.middles.len() as u64;
                });
            }
        }
        plane
    }

    /// Writes everything that was counted.
    fn write(&self, rows: &[[u64; 3]], planes: &[Plane]) -> TriangleMesh {
        let vertices = planes.iter().map(|plane| plane.vertices).sum();
        let triangles = planes.iter().map(|plane| plane.triangles).sum();
        let mut mesh =
            TriangleMesh { positions: vec![Point::ZERO; vertices], triangles: vec![[0; 3]; triangles] };
        let (mut positions, mut triangles) = (&mut mesh.positions[..], &mut mesh.triangles[..]);
        let mut tasks = Vec::with_capacity(planes.len());
        for plane in planes {
            let (these, others) = positions.split_at_mut(plane.vertices);
            let (those, rest) = triangles.split_at_mut(plane.triangles);
            tasks.push((plane, these, those));
            (positions, triangles) = (others, rest);
        }
        tasks.into_par_iter().enumerate().for_each(|(k, (plane, positions, triangles))| {
            let middles = self.write_edges(k, positions);
            self.write_layer(k, rows, plane, &mut positions[middles..], triangles);
        });
        mesh
    }

    /// Writes the vertices on the edges that start in a plane of nodes; returns how many there are.
    fn write_edges(&self, k: usize, positions: &mut [Point]) -> usize {
        let mut next = 0;
        for j in 0..self.field.grid().extent[1] {
            for axis in 0..3 {
                for (at, words) in self.crossings(j, k).enumerate() {
                    for place in ones(words[axis]) {
                        positions[next] = self.vertex([64 * at + place, j, k], axis);
                        next += 1;
                    }
                }
            }
        }
        next
    }

    /// Where the surface crosses the edge along an axis that starts at a node.
    fn vertex(&self, node: [usize; 3], axis: usize) -> Point {
        let grid = self.field.grid();
        let stride = [1, grid.extent[0], grid.extent[0] * grid.extent[1]][axis];
        let start = grid.index(node);
        let values = self.field.values();
        let (low, high) = (f64::from(values[start]), f64::from(values[start + stride]));
        let fraction = (f64::from(self.isovalue) - low) / (high - low);
        // What is not a number is not greater.
        let fraction = if fraction > MARGIN { fraction.min(1.0 - MARGIN) } else { MARGIN };
        let local = Point::from_array(node.map(|index| index as f64)) + fraction * Point::AXES[axis];
        grid.origin + grid.spacing * local
    }

    /// Writes the triangles and middles of layer k.
    fn write_layer(
        &self,
        k: usize,
        rows: &[[u64; 3]],
        plane: &Plane,
        middles: &mut [Point],
        triangles: &mut [[u32; 3]],
    ) {
        let height = self.field.grid().extent[1];
        let (mut written, mut middle) = (0, 0);
        let mut decided = plane.decided.iter().copied();
        if triangles.is_empty() {
            return;
        }
        for j in 0..height - 1 {
            let mut cursor = Cursor::new(rows, height, j, k);
            self.cells(j, k, |i, inside| {
                let pattern =
                    self.cases.certain(inside).or_else(|| decided.next()).expect("decided when counted");
                let vertices = cursor.pass(inside, plane.middles as u32 + middle as u32);
                let count = pattern.triangles.len();
                for (triangle, corners) in triangles[written..][..count].iter_mut().zip(&pattern.triangles) {
                    *triangle = corners.map(|corner| vertices[usize::from(corner) % PLACES]);
                }
                written += count;
                for edges in &pattern.middles {
                    middles[middle] = self.middle([i, j, k], edges);
                    middle += 1;
                }
            });
        }
    }

    /// The mean of the vertices of a loop.
    fn middle(&self, node: [usize; 3], edges: &[u8]) -> Point {
        let vertices = edges.iter().map(|&edge| {
            let [low, _] = cell::ends(usize::from(edge));
            let start = std::array::from_fn(|axis| node[axis] + (low >> axis & 1));
            self.vertex(start, usize::from(edge) / 4)
        });
        vertices.sum::<Point>() / edges.len() as f64
    }
}

/// Bits of word `at` that belong to places before `end`.
fn below(end: usize, at: usize) -> u64 {
    let bits = end.saturating_sub(64 * at).min(64) as u32;
    u64::MAX.checked_shr(64 - bits).unwrap_or(0)
}

/// Numbers of the next vertices on the edges of a row of cells.
#[derive(Clone, Copy, Debug)]
struct Cursor {
    /// On edges along x, in the four rows of nodes.
    along_x: [u32; 4],
    /// On edges along y, of this plane and the next.
    along_y: [u32; 2],
    /// On edges along z, of this row and the next.
    along_z: [u32; 2],
}

impl Cursor {
    fn new(rows: &[[u64; 3]], height: usize, j: usize, k: usize) -> Self {
        let at = |dj: usize, dk: usize, axis: usize| rows[(k + dk) * height + j + dj][axis] as u32;
        Self {
            along_x: [at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(1, 1, 0)],
            along_y: [at(0, 0, 1), at(0, 1, 1)],
            along_z: [at(0, 0, 2), at(1, 0, 2)],
        }
    }

    /// Numbers of the vertices on the edges of the next cell that the surface meets, and of its middles from a first one on;
    /// those of other edges mean nothing.
    fn pass(&mut self, inside: u8, middle: u32) -> [u32; PLACES] {
        let crosses = |edge: usize| {
            let [low, high] = cell::ends(edge);
            u32::from((inside >> low ^ inside >> high) & 1)
        };
        let ([a, b, c, d], [e, f], [g, h]) = (self.along_x, self.along_y, self.along_z);
        let [left_e, left_f, left_g, left_h] = [crosses(4), crosses(6), crosses(8), crosses(10)];
        self.along_x = [a + crosses(0), b + crosses(1), c + crosses(2), d + crosses(3)];
        self.along_y = [e + left_e, f + left_f];
        self.along_z = [g + left_g, h + left_h];
        let [m, n, o, p] = [0, 1, 2, 3].map(|next| middle + next);
        [a, b, c, d, e, e + left_e, f, f + left_f, g, g + left_g, h, h + left_h, m, n, o, p]
    }
}
