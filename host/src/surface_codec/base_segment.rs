//! The segment of the base mesh: connectivity, features, depths of planes, and the high bits of its points.

use wavelift_kernel::bits::{BitCoder, Chance};

use super::base_points;
use super::connectivity::{Connectivity, Given, Order, Walk};
use super::header::Header;
use super::number::code_plain;
use super::planes::{Depths, Triple};
use crate::mesh::Features;
use crate::subdivision::Split;

/// Bits of a number of bits.
const DEPTH_BITS: u32 = 5;

/// Codes connectivity. `None` if the file contradicts itself.
pub(super) fn code_connectivity(
    coder: &mut impl BitCoder,
    header: &Header,
    given: Option<Given<'_>>,
) -> Option<(Connectivity, Order)> {
    Walk::new(coder, given, header.numbers.map(|number| number as usize)).run()
}

/// Codes which edges and vertices are sharp.
pub(super) fn code_features(coder: &mut impl BitCoder, mesh: &Connectivity, given: &Features) -> Features {
    let vertices = mesh.origins.len();
    let split = Split::new(vertices, &mesh.faces);
    let mut at_ends = vec![0_usize; vertices];
    let mut chances = [[Chance::expecting(1 << 13, 2); 3]; 3];
    let mut features = Features::default();
    for ends in &split.edges {
        let edge = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let [low, high] = edge.map(|end| at_ends[end as usize].min(2));
        let chance = &mut chances[low.min(high)][low.max(high)];
        if coder.bit(given.edges.binary_search(&edge).is_ok(), chance) {
            features.edges.push(edge);
            edge.iter().for_each(|&end| at_ends[end as usize] += 1);
        }
    }
    features.edges.sort_unstable();
    let mut chances = [Chance::expecting(1 << 12, 2); 4];
    for vertex in 0..vertices as u32 {
        let chance = &mut chances[at_ends[vertex as usize].min(3)];
        if coder.bit(given.vertices.binary_search(&vertex).is_ok(), chance) {
            features.vertices.push(vertex);
        }
    }
    features
}

/// Codes how many bits coefficients have.
pub(super) fn code_depths(coder: &mut impl BitCoder, header: &Header, given: Option<&Depths>) -> Depths {
    let steps = header.levels as usize;
    let mut number = |given: u32| code_plain(coder, given, DEPTH_BITS);
    let base_bits = number(given.map_or(0, |depths| depths.base_bits));
    let bits = (0..steps)
        .map(|step| {
            std::array::from_fn(|axis| {
                number(given.map_or(0, |depths| depths.bits[step][axis] as u32)) as i32
            })
        })
        .collect();
    Depths { bits, base_bits, ..shifts(header) }
}

/// The planes of the lowest bits. Coefficients that are quantized have steps by their norms already; of integers, those
/// of each coarser level count twice as much, so that their lowest bits come one plane earlier.
pub(super) fn shifts(header: &Header) -> Depths {
    let steps = header.levels;
    let shift = |up: u32| if header.lossless { up } else { 0 };
    Depths {
        bits: Vec::new(),
        shifts: (0..steps).map(|step| shift(steps - 1 - step)).collect(),
        base_bits: 0,
        base_shift: shift(steps),
    }
}

/// Codes the bits of points of the base mesh above those that are coded in planes.
pub(super) fn code_points(
    coder: &mut impl BitCoder,
    mesh: &Connectivity,
    base_bits: u32,
    points: &mut [Triple],
) {
    let mut high: Vec<Triple> = points.iter().map(|point| point.map(|value| value >> base_bits)).collect();
    base_points::code(coder, mesh, &mut high);
    for (point, high) in points.iter_mut().zip(high) {
        *point = high.map(|value| value << base_bits);
    }
}
