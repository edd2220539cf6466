//! Closest points for the nodes of all cells that triangles meet.

use rayon::prelude::*;
use wide::f32x8;

use super::lanes::{Feet, LANES, Triangles};
use super::rows::{self, Rows, set};
use super::surface::Surface;
use crate::field::Grid;
use crate::mesh::Point;

/// Nodes from the first to the last along each axis.
#[derive(Clone, Copy, Debug)]
struct Nodes {
    first: [usize; 3],
    last: [usize; 3],
}

/// Triangles by slab.
#[derive(Debug)]
struct Bins {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

/// How nodes are seeded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seeding<'a> {
    pub(super) surface: &'a Surface<'a>,
    pub(super) grid: &'a Grid,
    /// Planes of nodes in a slab.
    pub(super) slab: usize,
    /// How far beyond a triangle, in cells, cells are taken to be met by it.
    pub(super) margin: f64,
}

/// A slab at work: planes of rows along y, x after x.
struct Slab<'a> {
    rows: &'a mut [Vec<f32>],
    /// Squared distance to the nearest point so far.
    squared: Vec<f32>,
    /// The first plane, and one beyond the last.
    planes: [usize; 2],
    /// Nodes along x and y, and the numbers of a row.
    sides: [usize; 2],
    width: usize,
    /// A node near the triangle, the same in every slab.
    base: [usize; 3],
}

impl Seeding<'_> {
    /// The closest points of the nodes of all cells that triangles meet, in rows along y.
    pub(super) fn run(&self) -> Rows {
        let [width, height, depth] = self.grid.extent;
        let mut rows = Rows::new(depth, width, height);
        let bins = self.bins();
        rows.chunks_mut(self.slab).enumerate().for_each(|(number, planes_of)| {
            let planes = [number * self.slab, ((number + 1) * self.slab).min(depth)];
            let [start, end] = [0, 1].map(|next| bins.starts[number + next] as usize);
            if start < end {
                let squared = vec![self.cap(); (planes[1] - planes[0]) * width * height];
                let sides = [width, height];
                let mut slab = Slab {
                    rows: planes_of,
                    squared,
                    planes,
                    sides,
                    width: rows::width(height),
                    base: [0; 3],
                };
                for &triangle in &bins.triangles[start..end] {
                    self.seed(triangle, &mut slab);
                }
            }
        });
        rows
    }

    /// Nodes of a cell are not farther from a triangle in it than this, squared.
    fn cap(&self) -> f32 {
        self.surface.spacing.length_squared() as f32 * 1.0001
    }

    /// The nodes of the cells that the bounding box of a triangle meets, `None` if none is in the grid.
    fn nodes(&self, triangle: u32) -> Option<Nodes> {
        let [a, b, c] = self.surface.corners(triangle).map(|corner| corner / self.surface.spacing);
        let least = (a.min(b).min(c) - self.margin).floor().to_array();
        let most = (a.max(b).max(c) + self.margin).ceil().to_array();
        let extent = self.grid.extent;
        let meets = (0..3).all(|axis| most[axis] >= 0.0 && least[axis] <= extent[axis] as f64 - 1.0);
        meets.then(|| Nodes {
            first: least.map(|at| at.max(0.0) as usize),
            last: std::array::from_fn(|axis| (most[axis] as usize).min(extent[axis] - 1)),
        })
    }

    /// Sorts triangles by the slabs that their nodes belong to.
    fn bins(&self) -> Bins {
        let count = self.surface.triangles.len() as u32;
        let slabs = |triangle: u32| {
            let nodes = self.nodes(triangle);
            nodes.map_or(1..1, |nodes| nodes.first[2] / self.slab..nodes.last[2] / self.slab + 1)
        };
        let slabs: Vec<_> = (0..count).into_par_iter().with_min_len(4096).map(slabs).collect();
        let mut starts = vec![0_u32; self.grid.extent[2].div_ceil(self.slab) + 1];
        slabs.iter().cloned().flatten().for_each(|slab| starts[slab] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut triangles = vec![0; sum as usize];
        for (triangle, slabs) in slabs.into_iter().enumerate().rev() {
            for slab in slabs {
                starts[slab] -= 1;
                triangles[starts[slab] as usize] = triangle as u32;
            }
        }
        Bins { starts, triangles }
    }

    /// Gives the nodes of a slab that are near a triangle their closest points on it.
    fn seed(&self, triangle: u32, slab: &mut Slab<'_>) {
        let Some(mut nodes) = self.nodes(triangle) else { return };
        slab.base = nodes.first;
        nodes.first[2] = nodes.first[2].max(slab.planes[0]);
        nodes.last[2] = nodes.last[2].min(slab.planes[1] - 1);
        if nodes.last == nodes.first.map(|at| at + 1) && slab.base == nodes.first {
            self.offer_cell(triangle, nodes.first, slab);
            return;
        }
        self.visit(triangle, nodes, slab);
    }

    /// Looks at some nodes, at fewer of them where the triangle is far from most.
    fn visit(&self, triangle: u32, nodes: Nodes, slab: &mut Slab<'_>) {
        let sides: [usize; 3] = std::array::from_fn(|axis| nodes.last[axis] + 1 - nodes.first[axis]);
        if sides.iter().product::<usize>() <= 8 * LANES {
            self.offer(triangle, nodes, slab);
            return;
        }
        let (low, high) = (self.surface.node(nodes.first), self.surface.node(nodes.last));
        let reach = 0.5 * low.distance(high) + 1.01 * self.surface.spacing.length();
        let corners = self.surface.corners(triangle);
        let middle = 0.5 * (low + high);
        let nearest = crate::measure::Triangle(corners).nearest(middle).point;
        if nearest.distance_squared(middle) > reach * reach {
            return;
        }
        let axis = (0..3).max_by_key(|&axis| sides[axis]).unwrap_or(0);
        let (mut lower, mut upper) = (nodes, nodes);
        lower.last[axis] = nodes.first[axis] + sides[axis] / 2 - 1;
        upper.first[axis] = nodes.first[axis] + sides[axis] / 2;
        self.visit(triangle, lower, slab);
        self.visit(triangle, upper, slab);
    }

    /// Offers nodes their closest points on a triangle, as many as there are lanes at a time.
    fn offer(&self, triangle: u32, nodes: Nodes, slab: &mut Slab<'_>) {
        let triangles = self.triangles(triangle, slab.base);
        let spacing = self.surface.spacing.as_vec3().to_array();
        let mut next = Some(nodes.first);
        while let Some(first) = next {
            let (mut places, mut from) = ([first; LANES], [[0.0; LANES]; 3]);
            let mut count = 0;
            while let (Some(node), true) = (next, count < LANES) {
                places[count] = node;
                for axis in 0..3 {
                    from[axis][count] = (node[axis] - slab.base[axis]) as f32 * spacing[axis];
                }
                count += 1;
                next = nodes.after(node);
            }
            slab.offer(triangle, &places[..count], &triangles.feet(&from.map(f32x8::new)), spacing);
        }
    }

    /// Offers the corners of a cell their closest points on a triangle in it.
    fn offer_cell(&self, triangle: u32, first: [usize; 3], slab: &mut Slab<'_>) {
        let spacing = self.surface.spacing.as_vec3().to_array();
        let from = std::array::from_fn(|axis| f32x8::new(CELL.map(|lane| lane[axis] as f32 * spacing[axis])));
        let places = CELL.map(|lane| std::array::from_fn(|axis| first[axis] + lane[axis]));
        let feet = self.triangles(triangle, slab.base).feet(&from);
        slab.offer(triangle, &places, &feet, spacing);
    }

    /// A triangle for all lanes. Near the triangle numbers are small, and differences exact.
    fn triangles(&self, triangle: u32, base: [usize; 3]) -> Triangles {
        let origin = self.surface.node(base);
        let [a, b, c] = self.surface.corners(triangle);
        let wide = |point: Point| point.as_vec3().to_array().map(f32x8::splat);
        Triangles { corner: wide(a - origin), sides: [wide(b - a), wide(c - a)] }
    }
}

/// The corners of a cell.
const CELL: [[usize; 3]; LANES] =
    [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1], [0, 1, 1], [1, 0, 1], [1, 1, 1]];

impl Slab<'_> {
    /// Offers nodes the points of a triangle that are nearest to them.
    #[inline(always)]
    fn offer(&mut self, triangle: u32, places: &[[usize; 3]], feet: &Feet, spacing: [f32; 3]) {
        let (found, offsets) = (feet.squared().to_array(), feet.offsets.map(f32x8::to_array));
        let [width, height] = self.sides;
        for (lane, &[x, y, z]) in places.iter().enumerate() {
            let plane = z - self.planes[0];
            let squared = &mut self.squared[(plane * width + x) * height + y];
            if found[lane] < *squared {
                *squared = found[lane];
                let at = |axis: usize| [x, y, z][axis] as f32 * spacing[axis] - offsets[axis][lane];
                let row = &mut self.rows[plane][x * self.width..][..self.width];
                set(row, y, [at(1), at(0), at(2)], triangle);
            }
        }
    }
}

impl Nodes {
    /// The node after another: y first, then x.
    fn after(&self, [x, y, z]: [usize; 3]) -> Option<[usize; 3]> {
        let [left, low, _] = self.first;
        let [right, high, deep] = self.last;
        if y < high {
            Some([x, y + 1, z])
        } else if x < right {
            Some([x + 1, low, z])
        } else if z < deep {
            Some([left, low, z + 1])
        } else {
            None
        }
    }
}
