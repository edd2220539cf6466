//! Generalized lifting of integer coordinates, without loss.
//!
//! Source: Diss eq. (4.16)–(4.19) with b = 1, the forms in which corners read the edges as they were before the lift; where
//! no vertex is on a feature these are the lifts of [`wavelift_kernel::stencil`], bit for bit, but sums wrap.
//!
//! With b = 1 the lifts of the bicubic and biquintic basis leave old vertices smaller than they were: by 2 or 4 for each
//! of the directions in which they are lifted, two where the surface is smooth, one on a crease, none for a sharp vertex.
//! So neighbours of different kinds have different units. Whoever reads one of another unit than its rule expects shifts it
//! first, rounding; as a lift only ever adds what depends on others, it can still be undone.

use super::basis::{Basis, Kind};
use crate::subdivision::{EdgeRule, Hierarchy, Step, VertexRule};

/// A weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    /// Above the line, less than 2^12 in magnitude.
    pub numerator: i64,
    /// Below the line, positive and less than 2^17.
    pub denominator: i64,
}

/// `corner <- corner + [4a² centre average + 4a edge average]`, then `edge <- edge + [2a centre average]`, where
/// \[r\] = floor(r + 1/2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegerLift {
    /// What is moved.
    pub kind: Kind,
    /// Weight of the neighbours.
    pub a: Ratio,
    /// By how many bits an s-lift shrinks old vertices in each direction.
    pub shrinks: u32,
}

const fn lift(kind: Kind, numerator: i64, denominator: i64, shrinks: u32) -> IntegerLift {
    IntegerLift { kind, a: Ratio { numerator, denominator }, shrinks }
}

/// The lifts of decomposition, in order: ψ1, ψ3 and ψ5 of Diss Table 3.3, the last step scaled down (Diss §3.4.3).
pub const fn lifts(basis: Basis) -> &'static [IntegerLift] {
    use Kind::{S, W};
    match basis {
        Basis::Bilinear => const { &[lift(W, -1, 2, 0), lift(S, 1, 4, 0)] },
        Basis::Bicubic => const { &[lift(S, -1, 4, 1), lift(W, -1, 1, 0), lift(S, 3, 16, 0)] },
        Basis::Biquintic => {
            const { &[lift(W, -1, 6, 0), lift(S, -9, 16, 2), lift(W, -4, 3, 0), lift(S, 5, 32, 0)] }
        }
    }
}

/// Three coordinates.
type Triple = [i32; 3];

/// Sums of coordinates.
type Sum = [i64; 3];

/// Turns the coordinates of the finest mesh into those of the base mesh and, at all later vertices, details. Sums wrap, so
/// that all coordinates are restored.
///
/// # Panics
/// If there is not one triple a vertex of the finest mesh.
pub fn forward(basis: Basis, hierarchy: &Hierarchy, points: &mut [Triple]) {
    assert_eq!(points.len(), hierarchy.finest_vertices(), "one triple a vertex of the finest mesh");
    let per_level = per_level(basis);
    for (before, step) in hierarchy.steps().iter().rev().enumerate() {
        let mut units = Units { finer: per_level * before as u32, here: 0 };
        for lift in lifts(basis) {
            apply(step, units, &mut points[..step.split.finer_vertices()], lift, 1);
            units.here += lift.shrinks;
        }
    }
}

/// Undoes [`forward`].
///
/// # Panics
/// If there is not one triple a vertex of the finest mesh.
pub fn inverse(basis: Basis, hierarchy: &Hierarchy, points: &mut [Triple]) {
    assert_eq!(points.len(), hierarchy.finest_vertices(), "one triple a vertex of the finest mesh");
    inverse_to_level(basis, hierarchy, hierarchy.steps().len(), points);
}

/// Turns coefficients into the control points of a level, the base mesh being level 0, each in its unit ([`unit_of`]); only
/// the vertices of that level are looked at.
///
/// # Panics
/// If there are fewer triples than the level has vertices, or fewer levels.
pub fn inverse_to_level(basis: Basis, hierarchy: &Hierarchy, level: usize, points: &mut [Triple]) {
    let here = per_level(basis);
    let levels = hierarchy.steps().len();
    for (number, step) in hierarchy.steps()[..level].iter().enumerate() {
        let mut units = Units { finer: here * (levels - 1 - number) as u32, here };
        for lift in lifts(basis).iter().rev() {
            units.here -= lift.shrinks;
            apply(step, units, &mut points[..step.split.finer_vertices()], lift, -1);
        }
    }
}

/// In units of 2 to which power the control point of a vertex of a level is: finer levels take a part of it.
///
/// # Panics
/// If there is no such vertex or level.
pub fn unit_of(basis: Basis, hierarchy: &Hierarchy, level: usize, vertex: usize) -> u32 {
    let finer = &hierarchy.steps()[level..];
    let units = Units { finer: per_level(basis) * finer.len() as u32, here: 0 };
    finer.first().map_or(0, |step| units.of_old(step.rules.vertices[vertex]))
}

/// By which power of 2 units grow from a level to the next coarser one, for each direction.
fn per_level(basis: Basis) -> u32 {
    lifts(basis).iter().map(|lift| lift.shrinks).sum()
}

/// In units of 2 to which power the vertices of a step are, for each of their directions.
#[derive(Clone, Copy, Debug, Default)]
struct Units {
    /// Because of the finer levels.
    finer: u32,
    /// Because of the lifts of this level that are done.
    here: u32,
}

impl Units {
    fn of_old(self, rule: VertexRule) -> u32 {
        let directions = match rule {
            VertexRule::Smooth => 2,
            VertexRule::Crease => 1,
            VertexRule::Fixed => 0,
        };
        directions * (self.finer + self.here)
    }

    fn of_edge(self, rule: EdgeRule) -> u32 {
        match rule {
            EdgeRule::Smooth => 2 * self.finer + self.here,
            EdgeRule::Held => 2 * self.finer,
            EdgeRule::Sharp => self.finer,
        }
    }

    const fn of_face(self) -> u32 {
        2 * self.finer
    }
}

/// A value brought to a unit: times 2 to the power of what its own unit is above that, rounded.
fn shifted(value: Triple, by: i32) -> Sum {
    value.map(|value| {
        let value = i64::from(value);
        match by {
            0.. => value << by.min(8),
            _ => (value + (1 << (-by - 1).min(40))) >> (-by).min(41),
        }
    })
}

fn add(sum: &mut Sum, more: Sum, weight: i64) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum = sum.wrapping_add(more.wrapping_mul(weight)));
}

/// Adds to `value`, with a sign, `sum / parts` rounded.
fn move_by(value: &mut Triple, sum: Sum, parts: i64, sign: i32) {
    for (value, sum) in value.iter_mut().zip(sum) {
        // The double of parts is even, so that its half is exact.
        let rounded = sum.wrapping_mul(2).wrapping_add(parts).div_euclid(2 * parts);
        *value = value.wrapping_add((rounded as i32).wrapping_mul(sign));
    }
}

/// Applies a lift, or undoes it if `sign` is -1.
fn apply(step: &Step, units: Units, points: &mut [Triple], lift: &IntegerLift, sign: i32) {
    let (old, added) = points.split_at_mut(step.split.coarser_vertices());
    let (edges, faces) = added.split_at_mut(step.split.edges.len());
    let lifting = Lifting { step, units, a: lift.a, sign };
    match (lift.kind, sign) {
        (Kind::S, 1) => {
            lifting.old_from(old, edges, faces);
            lifting.edges_from_faces(edges, faces);
        }
        (Kind::S, _) => {
            lifting.edges_from_faces(edges, faces);
            lifting.old_from(old, edges, faces);
        }
        (Kind::W, 1) => {
            lifting.faces_from(faces, edges, old);
            lifting.edges_from_old(edges, old);
        }
        (Kind::W, _) => {
            lifting.edges_from_old(edges, old);
            lifting.faces_from(faces, edges, old);
        }
    }
}

/// What all parts of a lift need.
struct Lifting<'a> {
    step: &'a Step,
    units: Units,
    a: Ratio,
    sign: i32,
}

impl Lifting<'_> {
    /// Weights of centres and of edges over `denominator²`, in 4a² centre average + 4a edge average.
    const fn weights(&self) -> (i64, i64, i64) {
        let Ratio { numerator, denominator } = self.a;
        (4 * numerator * numerator, 4 * numerator * denominator, denominator * denominator)
    }

    fn edges_from_faces(&self, edges: &mut [Triple], faces: &[Triple]) {
        let sides = self.step.split.edge_faces.iter().zip(&self.step.rules.edges);
        for (edge, (beside, rule)) in edges.iter_mut().zip(sides) {
            if let ([Some(one), Some(other)], EdgeRule::Smooth) = (*beside, rule) {
                let mut sum = [0; 3];
                for face in [one, other] {
                    add(&mut sum, faces[face as usize].map(i64::from), self.a.numerator);
                }
                move_by(edge, sum, self.a.denominator, self.sign);
            }
        }
    }

    fn edges_from_old(&self, edges: &mut [Triple], old: &[Triple]) {
        let rules = &self.step.rules;
        for ((edge, ends), &rule) in edges.iter_mut().zip(&self.step.split.edges).zip(&rules.edges) {
            let expected = self.units.of_edge(rule) + self.units.here;
            let mut sum = [0; 3];
            for end in ends.map(|end| end as usize) {
                let unit = self.units.of_old(rules.vertices[end]);
                add(&mut sum, shifted(old[end], unit as i32 - expected as i32), self.a.numerator);
            }
            move_by(edge, sum, self.a.denominator, self.sign);
        }
    }

    fn faces_from(&self, faces: &mut [Triple], edges: &[Triple], old: &[Triple]) {
        let (of_corners, of_edges, parts) = self.weights();
        let (units, rules) = (self.units, &self.step.rules);
        let expected = units.of_face() + units.here;
        let mut first = 0;
        let quads = self.step.split.quads.chunk_by(|one, next| one[2] == next[2]);
        for (face, quads) in faces.iter_mut().zip(quads) {
            let mut sum = [0; 3];
            let sides = &self.step.split.side_edges[first..first + quads.len()];
            first += quads.len();
            for (quad, &edge) in quads.iter().zip(sides) {
                let (corner, edge) = (quad[0] as usize, edge as usize);
                let unit = units.of_old(rules.vertices[corner]) as i32 - (expected + units.here) as i32;
                add(&mut sum, shifted(old[corner], unit), of_corners);
                let unit = units.of_edge(rules.edges[edge]) as i32 - expected as i32;
                add(&mut sum, shifted(edges[edge], unit), of_edges);
            }
            move_by(face, sum, parts * quads.len() as i64, self.sign);
        }
    }

    fn old_from(&self, old: &mut [Triple], edges: &[Triple], faces: &[Triple]) {
        let sums = self.sums_at_old(old.len(), edges, faces);
        let (_, _, parts) = self.weights();
        let rules = self.step.rules.vertices.iter().zip(&self.step.rules.movers);
        for ((old, sum), (rule, &movers)) in old.iter_mut().zip(sums).zip(rules) {
            match rule {
                VertexRule::Smooth => move_by(old, sum, parts * i64::from(movers), self.sign),
                VertexRule::Crease => move_by(old, sum, self.a.denominator * i64::from(movers), self.sign),
                VertexRule::Fixed => {}
            }
        }
    }

    /// What is to be averaged at old vertices: 4a² f + 4a e of all around a smooth one, 2a e of sharp edges on a crease.
    fn sums_at_old(&self, count: usize, edges: &[Triple], faces: &[Triple]) -> Vec<Sum> {
        let (of_faces, of_edges, _) = self.weights();
        let rules = &self.step.rules;
        let mut sums = vec![[0; 3]; count];
        for ((edge, ends), &rule) in edges.iter().zip(&self.step.split.edges).zip(&rules.edges) {
            for end in ends.map(|end| end as usize) {
                match (rules.vertices[end], rule) {
                    (VertexRule::Smooth, _) => {
                        let expected = self.units.of_edge(EdgeRule::Smooth) as i32;
                        let unit = self.units.of_edge(rule) as i32 - expected;
                        add(&mut sums[end], shifted(*edge, unit), of_edges);
                    }
                    (VertexRule::Crease, EdgeRule::Sharp) => {
                        add(&mut sums[end], edge.map(i64::from), 2 * self.a.numerator);
                    }
                    _ => {}
                }
            }
        }
        let middle = self.step.split.face_vertex(0);
        for quad in &self.step.split.quads {
            let corner = quad[0] as usize;
            if rules.vertices[corner] == VertexRule::Smooth {
                let face = faces[(quad[2] - middle) as usize];
                add(&mut sums[corner], face.map(i64::from), of_faces);
            }
        }
        sums
    }
}
