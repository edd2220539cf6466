//! Closest points for the nodes of all cells that triangles meet.

use rayon::prelude::*;

use super::block::{Block, Layout, NONE, SEED};
use super::surface::Surface;
use crate::field::Grid;
use crate::mesh::Point;

/// A closest point, relative to the origin.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Site {
    pub(super) triangle: u32,
    pub(super) point: [f32; 3],
}

/// Nodes from the first to the last along each axis.
#[derive(Clone, Copy, Debug)]
struct Nodes {
    first: [usize; 3],
    last: [usize; 3],
}

/// Triangles by block.
#[derive(Debug)]
pub(super) struct Bins {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

/// How nodes are seeded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seeding<'a> {
    pub(super) surface: &'a Surface<'a>,
    pub(super) grid: &'a Grid,
    pub(super) layout: &'a Layout,
    /// How far beyond a triangle, in cells, cells are taken to be met by it.
    pub(super) margin: f64,
}

impl Seeding<'_> {
    /// The nodes of the cells that the bounding box of a triangle meets, `None` if none is in the grid.
    fn nodes(&self, triangle: u32) -> Option<Nodes> {
        let [a, b, c] = self.surface.corners(triangle).map(|corner| corner / self.grid.spacing);
        let least = (a.min(b).min(c) - self.margin).floor().to_array();
        let most = (a.max(b).max(c) + self.margin).ceil().to_array();
        let extent = self.grid.extent;
        let meets = (0..3).all(|axis| most[axis] >= 0.0 && least[axis] <= extent[axis] as f64 - 1.0);
        meets.then(|| Nodes {
            first: least.map(|at| at.max(0.0) as usize),
            last: std::array::from_fn(|axis| (most[axis] as usize).min(extent[axis] - 1)),
        })
    }

    /// Sorts triangles by the blocks that their nodes belong to.
    pub(super) fn bins(&self) -> Bins {
        let side = self.layout.side;
        let blocks = |triangle: usize| {
            let nodes = self.nodes(triangle as u32);
            nodes.into_iter().flat_map(move |Nodes { first, last }| {
                let [x, y, z] = [0, 1, 2].map(|axis| first[axis] / side[axis]..=last[axis] / side[axis]);
                z.flat_map(move |z| {
                    let x = x.clone();
                    y.clone().flat_map(move |y| x.clone().map(move |x| self.layout.number([x, y, z])))
                })
            })
        };
        let mut starts = vec![0_u32; self.layout.len() + 1];
        let count = self.surface.triangles.len();
        (0..count).flat_map(blocks).for_each(|block| starts[block] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut triangles = vec![0; sum as usize];
        for triangle in (0..count).rev() {
            for block in blocks(triangle) {
                starts[block] -= 1;
                triangles[starts[block] as usize] = triangle as u32;
            }
        }
        Bins { starts, triangles }
    }

    /// Gives the nodes of a block their closest points; returns these, in the order of the nodes. The sites of the nodes
    /// are marked as seeds and numbered from 0.
    pub(super) fn seed(&self, block: &mut Block, bins: &Bins) -> Vec<Site> {
        let number = self.layout.number(block.place);
        let [from, to] = self.layout.nodes(block.place);
        let cap = self.grid.spacing.length_squared() as f32 * 1.0001;
        let [start, end] = [0, 1].map(|next| bins.starts[number + next] as usize);
        // The nearest triangle of each node, for now.
        let mut nearest = vec![cap; if start == end { 0 } else { block.squared.len() }];
        for &triangle in &bins.triangles[start..end] {
            let Some(Nodes { first, last }) = self.nodes(triangle) else { continue };
            let nodes = Nodes {
                first: std::array::from_fn(|axis| first[axis].max(from[axis])),
                last: std::array::from_fn(|axis| last[axis].min(to[axis] - 1)),
            };
            self.visit(triangle, nodes, &mut |node, squared| {
                let at = self.layout.index(std::array::from_fn(|axis| node[axis] - from[axis] + 1));
                if squared < nearest[at] {
                    (nearest[at], block.sites[at]) = (squared, triangle);
                }
            });
        }
        let mut sites = Vec::new();
        for (at, &squared) in nearest.iter().enumerate() {
            if block.sites[at] != NONE {
                let triangle = std::mem::replace(&mut block.sites[at], SEED | sites.len() as u32);
                let node = self.layout.coordinates(at);
                let node = std::array::from_fn(|axis| from[axis] + node[axis] - 1);
                let foot = self.surface.foot(triangle, self.position(node));
                sites.push(Site { triangle, point: foot.point.as_vec3().to_array() });
                block.squared[at] = squared.min(block.squared[at]);
            }
        }
        sites
    }

    /// Calls a function with the squared distance of each of the nodes that is less than a cell's diagonal away.
    fn visit(&self, triangle: u32, nodes: Nodes, near: &mut impl FnMut([usize; 3], f32)) {
        let Nodes { first, last } = nodes;
        let sides: [usize; 3] = std::array::from_fn(|axis| last[axis] + 1 - first[axis]);
        if sides.iter().product::<usize>() <= 64 {
            for z in first[2]..=last[2] {
                for y in first[1]..=last[1] {
                    for x in first[0]..=last[0] {
                        let foot = self.surface.foot(triangle, self.position([x, y, z]));
                        near([x, y, z], foot.squared as f32);
                    }
                }
            }
            return;
        }
        let (low, high) = (self.position(first), self.position(last));
        let reach = 0.5 * low.distance(high) + 1.01 * self.grid.spacing.length();
        if self.surface.foot(triangle, 0.5 * (low + high)).squared > reach * reach {
            return;
        }
        let axis = (0..3).max_by_key(|&axis| sides[axis]).unwrap_or(0);
        let (mut lower, mut upper) = (nodes, nodes);
        lower.last[axis] = first[axis] + sides[axis] / 2 - 1;
        upper.first[axis] = first[axis] + sides[axis] / 2;
        self.visit(triangle, lower, near);
        self.visit(triangle, upper, near);
    }

    /// Where a node lies, relative to the origin.
    pub(super) fn position(&self, node: [usize; 3]) -> Point {
        self.grid.spacing * Point::from_array(node.map(|index| index as f64))
    }

    /// Seeds all blocks; returns all sites, and renumbers those of the blocks.
    pub(super) fn run(&self, blocks: &mut [Block]) -> Vec<Site> {
        let bins = self.bins();
        let lists: Vec<Vec<Site>> = blocks.par_iter_mut().map(|block| self.seed(block, &bins)).collect();
        let mut next = 0;
        let starts = lists.iter().map(|list| {
            next += list.len() as u32;
            next - list.len() as u32
        });
        let starts: Vec<u32> = starts.collect();
        blocks.par_iter_mut().zip(&starts).zip(&lists).for_each(|((block, start), list)| {
            let seeds = block.sites.iter_mut().filter(|site| !list.is_empty() && **site & SEED != 0);
            seeds.for_each(|site| *site += start);
        });
        lists.concat()
    }
}
