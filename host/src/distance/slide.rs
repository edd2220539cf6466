//! Walks over neighbouring triangles to the nearest point.

use rayon::prelude::*;

use super::surface::{Feature, Foot, Surface};
use crate::mesh::Point;

/// No triangle there.
const NONE: u32 = u32::MAX;

/// Most steps of a walk. Walks are short, as they start near their end; a limit keeps hostile meshes from making them long.
const STEPS: usize = 32;

/// The triangles across the edges of each triangle.
#[derive(Debug)]
pub(super) struct Neighbours {
    across: Vec<[u32; 3]>,
    around: Around,
}

impl Neighbours {
    /// Finds neighbours: those that have the edge the other way round, if the mesh is oriented, else any that have it.
    ///
    /// Cost: each triangle looks through the triangles around its corners.
    pub(super) fn new(surface: &Surface) -> Self {
        let around = Around::new(surface);
        let across = |(triangle, &[a, b, c]): (usize, &[u32; 3])| {
            [[a, b], [b, c], [c, a]].map(|[from, to]| {
                let mut others = around.vertex(from).iter().copied().filter(|&other| {
                    other as usize != triangle && surface.triangles[other as usize].contains(&to)
                });
                others.next().unwrap_or(NONE)
            })
        };
        let across = surface.triangles.par_iter().enumerate().with_min_len(4096).map(across).collect();
        Self { across, around }
    }

    /// The triangle across an edge.
    pub(super) fn across(&self, triangle: u32, edge: u8) -> Option<u32> {
        let other = self.across[triangle as usize][usize::from(edge)];
        (other != NONE).then_some(other)
    }

    /// The nearest point to be found from a triangle on: while the nearest point of the triangle lies on its border, the
    /// walk goes on to a neighbour there that is nearer.
    pub(super) fn slide(&self, surface: &Surface, from: Point, triangle: u32) -> Foot {
        let mut foot = surface.foot(triangle, from);
        for _ in 0..STEPS {
            let feet = |others: &[u32]| {
                let feet = others.iter().map(|&other| surface.foot(other, from));
                feet.min_by(|a, b| a.squared.total_cmp(&b.squared))
            };
            let best = match foot.feature {
                Feature::Face => None,
                Feature::Edge(edge) => self.across(foot.triangle, edge).and_then(|other| feet(&[other])),
                Feature::Corner(corner) => {
                    let vertex = surface.triangles[foot.triangle as usize][usize::from(corner)];
                    feet(self.around.vertex(vertex))
                }
            };
            let Some(best) = best else { break };
            if best.squared >= foot.squared {
                break;
            }
            foot = best;
        }
        foot
    }
}

/// The triangles around each vertex, as compressed rows.
#[derive(Debug)]
struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(surface: &Surface) -> Self {
        let mut starts = vec![0_u32; surface.positions.len() + 1];
        for &corner in surface.triangles.iter().flatten() {
            starts[corner as usize] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut triangles = vec![0; sum as usize];
        for (triangle, corners) in surface.triangles.iter().enumerate().rev() {
            for &corner in corners {
                starts[corner as usize] -= 1;
                triangles[starts[corner as usize] as usize] = triangle as u32;
            }
        }
        Self { starts, triangles }
    }

    fn vertex(&self, vertex: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|next| self.starts[vertex as usize + next] as usize);
        &self.triangles[start..end]
    }
}
