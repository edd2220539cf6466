//! Coefficients, bit plane by bit plane, coarse to fine within each.

use std::ops::Range;

use wavelift_kernel::bits::{BitCoder, BitDecoder, BitEncoder, Chance};

use super::contexts::{Around, Models, Place};
use super::regions::Regions;
use crate::subdivision::Hierarchy;

/// Three components, each a magnitude with a sign.
pub(super) type Triple = [i32; 3];

/// A coder that may come to the end of what it reads.
pub(super) trait Ending: BitCoder {
    /// Whether the last decision was not to be read any more.
    fn is_ended(&self) -> bool;
}

impl Ending for BitEncoder<'_> {
    fn is_ended(&self) -> bool {
        false
    }
}

impl Ending for BitDecoder<'_> {
    fn is_ended(&self) -> bool {
        BitDecoder::is_ended(self)
    }
}

/// How many bits coefficients have, and which belong to which plane.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Depths {
    /// For each step and component the bits of the largest magnitude.
    pub(super) bits: Vec<Triple>,
    /// For each step, the plane of the lowest bit.
    pub(super) shifts: Vec<u32>,
    /// Low bits of the points of the base mesh that are coded in planes.
    pub(super) base_bits: u32,
    /// The plane of the lowest of them.
    pub(super) base_shift: u32,
}

impl Depths {
    /// Number of planes.
    pub(super) fn planes(&self) -> u32 {
        let steps = self.bits.iter().zip(&self.shifts);
        let steps = steps.map(|(bits, shift)| bits.iter().max().copied().unwrap_or(0) as u32 + shift);
        steps.max().unwrap_or(0).max(self.base_bits + self.base_shift)
    }

    /// The last plane that holds something of a part that is asked for.
    fn last_plane(&self, part: &Part) -> u32 {
        let steps = self.shifts[part.steps.start..part.steps.end.min(part.until)].iter().copied();
        let base = (part.base && self.base_bits > 0).then_some(self.base_shift);
        steps.chain(base).min().unwrap_or(self.planes())
    }
}

/// Up to where coefficients are known: all that come before this in the plane, and all planes above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cut {
    plane: u32,
    vertex: usize,
    component: usize,
}

impl Cut {
    /// Everything is known.
    pub(super) const NONE: Self = Self { plane: 0, vertex: usize::MAX, component: 0 };

    /// How many low bits of a component are unknown, the lowest of which is in plane `shift`.
    pub(super) fn unknown(&self, vertex: usize, component: usize, shift: u32) -> u32 {
        let known = (vertex, component) < (self.vertex, self.component);
        (self.plane + u32::from(!known)).saturating_sub(shift)
    }
}

/// Which coefficients are coded together.
#[derive(Clone, Debug)]
pub(super) struct Part<'a> {
    /// Whether the base mesh is among them.
    pub(super) base: bool,
    /// Steps, and of them the vertices of one region, if given.
    pub(super) steps: Range<usize>,
    /// The regions, and which of them.
    pub(super) region: Option<(&'a Regions, u32)>,
    /// Only steps before this one are asked for: nothing is coded behind their last bit.
    pub(super) until: usize,
}

/// What either direction works on.
pub(super) struct Scan<'a, C> {
    pub(super) coder: C,
    pub(super) hierarchy: &'a Hierarchy,
    pub(super) depths: &'a Depths,
    pub(super) part: Part<'a>,
    /// What is coded so far.
    pub(super) known: &'a mut [Triple],
    /// What is to be encoded.
    pub(super) given: Option<&'a [Triple]>,
    models: Models,
    base_models: Vec<Chance>,
}

/// A coder has come to its end.
struct Ended(usize, usize);

impl<'a, C: Ending> Scan<'a, C> {
    pub(super) fn new(
        coder: C,
        hierarchy: &'a Hierarchy,
        depths: &'a Depths,
        part: Part<'a>,
        (known, given): (&'a mut [Triple], Option<&'a [Triple]>),
    ) -> Self {
        let base_models = vec![Chance::EVEN; 32];
        Self { coder, hierarchy, depths, part, known, given, models: Models::new(), base_models }
    }

    /// Codes all planes, and tells how far it came.
    pub(super) fn run(mut self) -> (C, Cut) {
        let last = self.depths.last_plane(&self.part);
        for plane in (last..self.depths.planes()).rev() {
            let steps = if plane == last { self.part.until } else { usize::MAX };
            if let Err(Ended(vertex, component)) = self.plane(plane, steps) {
                return (self.coder, Cut { plane, vertex, component });
            }
        }
        (self.coder, Cut::NONE)
    }

    /// A plane of the steps before `until`.
    fn plane(&mut self, plane: u32, until: usize) -> Result<(), Ended> {
        if self.part.base
            && let Some(place) = plane.checked_sub(self.depths.base_shift)
            && place < self.depths.base_bits
        {
            self.base(place)?;
        }
        for step in self.part.steps.start..self.part.steps.end.min(until) {
            if let Some(place) = plane.checked_sub(self.depths.shifts[step])
                && self.depths.bits[step].iter().any(|&bits| place < bits as u32)
            {
                self.step(step, place)?;
            }
        }
        Ok(())
    }

    /// Bits of the points of the base mesh.
    fn base(&mut self, place: u32) -> Result<(), Ended> {
        for vertex in 0..self.hierarchy.vertices(0) {
            for component in 0..3 {
                let given = self.given.is_some_and(|given| given[vertex][component] >> place & 1 == 1);
                let bit = self.coder.bit(given, &mut self.base_models[place as usize]);
                if self.coder.is_ended() {
                    return Err(Ended(vertex, component));
                }
                self.known[vertex][component] |= i32::from(bit) << place;
            }
        }
        Ok(())
    }

    /// One plane of the coefficients of a step.
    fn step(&mut self, step: usize, place: u32) -> Result<(), Ended> {
        let split = &self.hierarchy.steps()[step].split;
        let depth = (self.hierarchy.steps().len() - 1 - step).min(7);
        let at = Place { depth, plane: place as usize, ..Place::default() };
        for edge in 0..split.edges.len() {
            let vertex = split.edge_vertex(edge) as usize;
            if self.is_here(vertex) {
                let around = self.around_edge(step, edge, place, at);
                self.vertex(vertex, step, place, around)?;
            }
        }
        for face in 0..split.finer_vertices() - split.face_vertex(0) as usize {
            let vertex = split.face_vertex(face) as usize;
            if self.is_here(vertex) {
                let around = self.around_face(step, face, place, at);
                self.vertex(vertex, step, place, around)?;
            }
        }
        Ok(())
    }

    fn is_here(&self, vertex: usize) -> bool {
        self.part.region.is_none_or(|(regions, region)| regions.of_vertex(vertex) == Some(region))
    }

    /// Adds magnitudes, in units of the plane, and a sign; those of other regions count as zero.
    fn add(&self, sum: &mut Around, vertex: u32, place: u32) {
        if let Some((regions, region)) = self.part.region
            && regions.of_vertex(vertex as usize).is_some_and(|other| other != region)
        {
            return;
        }
        let known = self.known[vertex as usize];
        for (size, value) in sum.sizes.iter_mut().zip(known) {
            *size += (value.unsigned_abs() >> place).min(40);
        }
        sum.leaning += known[0].signum();
    }

    /// Adds what is known of the vertices that a coefficient lies between, but those of the base mesh, which has no details.
    fn add_parent(&self, sum: &mut Around, vertex: u32, place: u32) {
        if vertex as usize >= self.hierarchy.vertices(0) {
            self.add(sum, vertex, place);
        }
    }

    fn around_edge(&self, step: usize, edge: usize, place: u32, at: Place) -> Place {
        let split = &self.hierarchy.steps()[step].split;
        let mut at = at;
        for &face in split.edge_faces[edge].iter().flatten() {
            self.add(&mut at.near, split.face_vertex(face as usize), place);
            for side in self.hierarchy.sides(step, face as usize) {
                let other = split.side_edges[side] as usize;
                if other != edge {
                    self.add(&mut at.far, split.edge_vertex(other), place);
                }
            }
        }
        for end in split.edges[edge] {
            self.add_parent(&mut at.parents, end, place);
        }
        at
    }

    fn around_face(&self, step: usize, face: usize, place: u32, at: Place) -> Place {
        let split = &self.hierarchy.steps()[step].split;
        let mut at = Place { in_face: true, ..at };
        for side in self.hierarchy.sides(step, face) {
            let edge = split.side_edges[side] as usize;
            self.add(&mut at.near, split.edge_vertex(edge), place);
            for &other in split.edge_faces[edge].iter().flatten().filter(|&&other| other as usize != face) {
                self.add(&mut at.far, split.face_vertex(other as usize), place);
            }
            self.add_parent(&mut at.parents, split.quads[side][0], place);
        }
        at
    }

    /// The bits in a plane of the components of a vertex.
    fn vertex(&mut self, vertex: usize, step: usize, place: u32, at: Place) -> Result<(), Ended> {
        let mut at = at;
        for component in 0..3 {
            at.own = self.known[vertex].map(|value| value.unsigned_abs() >> place);
            if place >= self.depths.bits[step][component] as u32 {
                continue;
            }
            let given = self.given.map_or(0, |given| given[vertex][component]);
            let bit = given.unsigned_abs() >> place & 1 == 1;
            let known = self.known[vertex][component];
            if known == 0 {
                let begins = self.models.begins(&mut self.coder, bit, &at, component);
                let negative = begins && self.models.negative(&mut self.coder, given < 0, &at, component);
                if self.coder.is_ended() {
                    return Err(Ended(vertex, component));
                }
                if begins {
                    self.known[vertex][component] = if negative { -(1 << place) } else { 1 << place };
                }
            } else {
                let above = known.unsigned_abs().ilog2() - place;
                let bit = self.models.more(&mut self.coder, bit, &at, (component, above as usize));
                if self.coder.is_ended() {
                    return Err(Ended(vertex, component));
                }
                self.known[vertex][component] += known.signum() * (i32::from(bit) << place);
            }
        }
        Ok(())
    }
}
