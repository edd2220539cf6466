//! Closest points for the nodes of all cells that triangles meet.

use rayon::prelude::*;
use wide::f32x8;

use super::lanes::{LANES, Points, Triangles};
use super::rows::{self, Eight, Rows, Ruler};
use super::surface::{Facet, NONE, Surface};
use crate::field::Grid;
use crate::mesh::Point;

/// Nodes from the first on along each axis, up to but not with the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Nodes {
    first: [u32; 3],
    end: [u32; 3],
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
    pub(super) facets: &'a [Facet],
    pub(super) grid: &'a Grid,
    pub(super) ruler: Ruler,
    /// Planes of nodes in a slab.
    pub(super) slab: usize,
    /// How far beyond a triangle, in cells, cells are taken to be met by it.
    pub(super) margin: f64,
}

/// A slab at work: planes of rows along y, x after x.
struct Slab<'a> {
    rows: &'a mut [Vec<Eight>],
    ruler: Ruler,
    /// Squared distance to the nearest point so far.
    squared: &'a mut [f32],
    /// The first plane, and one beyond the last.
    planes: [u32; 2],
    /// Nodes along x and y, and the vectors of a row.
    sides: [usize; 2],
    width: usize,
}

/// The nearest points of eight nodes so far.
#[derive(Clone, Copy)]
struct Nearest {
    squared: f32x8,
    /// From these points to the nodes.
    offsets: Points,
    /// Their triangles, as bits.
    triangles: f32x8,
}

impl Seeding<'_> {
    /// The closest points of the nodes of all cells that triangles meet, in rows along y.
    pub(super) fn run(&self) -> Rows {
        let [width, height, depth] = self.grid.extent;
        let mut rows = Rows::new(depth, width, height);
        let nodes = self.nodes();
        let bins = self.bins(&nodes);
        rows.chunks_mut(self.slab).enumerate().for_each_init(Vec::new, |squared, (number, rows)| {
            let planes = [number * self.slab, ((number + 1) * self.slab).min(depth)];
            let [start, end] = [0, 1].map(|next| bins.starts[number + next] as usize);
            if start == end {
                return;
            }
            squared.clear();
            squared.resize((planes[1] - planes[0]) * width * height, self.cap());
            let mut slab = Slab {
                rows,
                ruler: self.ruler,
                squared,
                planes: planes.map(|plane| plane as u32),
                sides: [width, height],
                width: rows::width(height),
            };
            let alike = |&a: &u32, &b: &u32| nodes[a as usize] == nodes[b as usize];
            for triangles in bins.triangles[start..end].chunk_by(alike) {
                self.seed(triangles, nodes[triangles[0] as usize], &mut slab);
            }
        });
        rows
    }

    /// Nodes of a cell are not farther from a triangle in it than this, squared.
    fn cap(&self) -> f32 {
        self.surface.spacing.length_squared() as f32 * 1.0001
    }

    /// The nodes of the cells that the bounding box of each triangle meets; no nodes where none is in the grid.
    fn nodes(&self) -> Vec<Nodes> {
        let end = Point::from_array(self.grid.extent.map(|nodes| nodes as f64));
        let per_cell = self.surface.spacing.recip();
        let nodes = |triangle: u32| {
            let [a, b, c] = self.surface.corners(triangle);
            let least = (a.min(b).min(c) * per_cell - self.margin).floor();
            let most = (a.max(b).max(c) * per_cell + self.margin).ceil();
            let meets = most.cmpge(Point::ZERO).all() && least.cmplt(end).all();
            let most = if meets { (most + 1.0).min(end) } else { Point::ZERO };
            // Conversion cuts off what is less than zero.
            let [first, end] = [least, most].map(|point| point.to_array().map(|at| at as u32));
            Nodes { first, end }
        };
        let count = self.surface.triangles.len() as u32;
        (0..count).into_par_iter().with_min_len(4096).map(nodes).collect()
    }

    /// Sorts triangles by the slabs that their nodes belong to.
    fn bins(&self, nodes: &[Nodes]) -> Bins {
        let slab = self.slab as u32;
        let slabs = |nodes: &Nodes| nodes.first[2] / slab..nodes.end[2].div_ceil(slab);
        let mut starts = vec![0_u32; self.grid.extent[2].div_ceil(self.slab) + 1];
        nodes.iter().flat_map(slabs).for_each(|slab| starts[slab as usize] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut triangles = vec![0; sum as usize];
        for (triangle, nodes) in nodes.iter().enumerate().rev() {
            for slab in slabs(nodes) {
                let start = &mut starts[slab as usize];
                *start -= 1;
                triangles[*start as usize] = triangle as u32;
            }
        }
        Bins { starts, triangles }
    }

    /// Gives the nodes of a slab that are near triangles, all in the same cells, their closest points on them.
    fn seed(&self, triangles: &[u32], mut nodes: Nodes, slab: &mut Slab<'_>) {
        let base = nodes.first;
        if nodes.end == base.map(|at| at + 2) {
            self.offer_cell(triangles, base, slab);
        } else {
            nodes.first[2] = base[2].max(slab.planes[0]);
            nodes.end[2] = nodes.end[2].min(slab.planes[1]);
            triangles.iter().for_each(|&triangle| self.visit(triangle, base, nodes, slab));
        }
    }

    /// Looks at some nodes, at fewer of them where the triangle is far from most.
    fn visit(&self, triangle: u32, base: [u32; 3], nodes: Nodes, slab: &mut Slab<'_>) {
        let sides: [u32; 3] = std::array::from_fn(|axis| nodes.end[axis] - nodes.first[axis]);
        if sides.iter().map(|&side| side as usize).product::<usize>() <= 8 * LANES {
            self.offer(triangle, base, nodes, slab);
            return;
        }
        let at = |node: [u32; 3]| self.surface.node(node.map(|index| index as usize));
        let (low, high) = (at(nodes.first), at(nodes.end.map(|end| end - 1)));
        let reach = 0.5 * low.distance(high) + 1.01 * self.surface.spacing.length();
        let middle = 0.5 * (low + high);
        let nearest = crate::measure::Triangle(self.surface.corners(triangle)).nearest(middle).point;
        if nearest.distance_squared(middle) > reach * reach {
            return;
        }
        let axis = (0..3).max_by_key(|&axis| sides[axis]).unwrap_or(0);
        let (mut lower, mut upper) = (nodes, nodes);
        lower.end[axis] = nodes.first[axis] + sides[axis] / 2;
        upper.first[axis] = lower.end[axis];
        self.visit(triangle, base, lower, slab);
        self.visit(triangle, base, upper, slab);
    }

    /// Offers nodes their closest points on a triangle, as many as there are lanes at a time.
    fn offer(&self, triangle: u32, base: [u32; 3], nodes: Nodes, slab: &mut Slab<'_>) {
        let triangles = self.triangles(triangle, base);
        let mut next = Some(nodes.first);
        while let Some(first) = next {
            let (mut places, mut from) = ([first; LANES], [[0; LANES]; 3]);
            let mut count = 0;
            while let (Some(node), true) = (next, count < LANES) {
                places[count] = node;
                for axis in 0..3 {
                    from[axis][count] = node[axis] - base[axis];
                }
                count += 1;
                next = nodes.after(node);
            }
            let mut nearest = Nearest::within(self.cap());
            nearest.take(triangle, &triangles, &self.places(&from));
            slab.offer(&places[..count], &nearest, self.spacing());
        }
    }

    /// Offers the corners of a cell their closest points on triangles in it.
    fn offer_cell(&self, triangles: &[u32], base: [u32; 3], slab: &mut Slab<'_>) {
        let from = self.places(&CELL);
        let mut nearest = Nearest::within(self.cap());
        for &triangle in triangles {
            nearest.take(triangle, &self.triangles(triangle, base), &from);
        }
        let places = std::array::from_fn::<_, LANES, _>(|lane| {
            [base[0] + CELL[0][lane], base[1] + CELL[1][lane], base[2] + CELL[2][lane]]
        });
        slab.offer(&places, &nearest, self.spacing());
    }

    fn spacing(&self) -> [f32; 3] {
        self.surface.spacing.as_vec3().to_array()
    }

    /// Where nodes lie that are a few nodes away from a base.
    #[inline(always)]
    fn places(&self, steps: &[[u32; LANES]; 3]) -> Points {
        let spacing = self.spacing();
        std::array::from_fn(|axis| f32x8::new(steps[axis].map(|step| step as f32)) * spacing[axis])
    }

    /// A triangle for all lanes, seen from a node near it, where numbers are small.
    #[inline(always)]
    fn triangles(&self, triangle: u32, base: [u32; 3]) -> Triangles {
        let origin = self.surface.node(base.map(|at| at as usize));
        self.facets[triangle as usize].spread(origin.as_vec3().to_array())
    }
}

/// The corners of a cell, axis by axis.
const CELL: [[u32; LANES]; 3] =
    [[0, 0, 1, 1, 0, 0, 1, 1], [0, 1, 0, 1, 0, 1, 0, 1], [0, 0, 0, 0, 1, 1, 1, 1]];

impl Nearest {
    /// No points, and none that is farther away than this, squared, will do.
    fn within(most: f32) -> Self {
        let none = f32x8::splat(f32::from_bits(NONE));
        Self { squared: f32x8::splat(most), offsets: [f32x8::ZERO; 3], triangles: none }
    }

    /// Takes the points of a triangle that are nearer.
    #[inline(always)]
    fn take(&mut self, triangle: u32, triangles: &Triangles, from: &Points) {
        let feet = triangles.feet(from);
        let nearer = feet.squared.simd_lt(self.squared);
        self.squared = nearer.select(feet.squared, self.squared);
        for axis in 0..3 {
            self.offsets[axis] = nearer.select(feet.offsets[axis], self.offsets[axis]);
        }
        self.triangles = nearer.select(f32x8::splat(f32::from_bits(triangle)), self.triangles);
    }
}

impl Slab<'_> {
    /// Offers points to nodes, as far as they are in the slab.
    #[inline(always)]
    fn offer(&mut self, places: &[[u32; 3]], nearest: &Nearest, spacing: [f32; 3]) {
        let (found, offsets) = (nearest.squared.as_array(), &nearest.offsets);
        let [width, height] = self.sides;
        for (lane, &node) in places.iter().enumerate() {
            let (x, y, plane) =
                (node[0] as usize, node[1] as usize, node[2].wrapping_sub(self.planes[0]) as usize);
            if plane >= self.rows.len() {
                continue;
            }
            let squared = &mut self.squared[(plane * width + x) * height + y];
            if found[lane] < *squared {
                *squared = found[lane];
                let eight = &mut self.rows[plane][x * self.width + y / LANES];
                for axis in 0..3 {
                    let at = node[axis] as f32 * spacing[axis] - offsets[axis].as_array()[lane];
                    eight.points[axis][y % LANES] = self.ruler.read(at);
                }
                eight.triangles[y % LANES] = nearest.triangles.as_array()[lane].to_bits();
            }
        }
    }
}

impl Nodes {
    /// The node after another: y first, then x.
    fn after(&self, [x, y, z]: [u32; 3]) -> Option<[u32; 3]> {
        let [left, low, _] = self.first;
        let [right, high, deep] = self.end;
        if y + 1 < high {
            Some([x, y + 1, z])
        } else if x + 1 < right {
            Some([x + 1, low, z])
        } else if z + 1 < deep {
            Some([left, low, z + 1])
        } else {
            None
        }
    }
}
