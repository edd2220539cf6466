//! Chances of the bits of coefficients, and what they depend on.

use wavelift_kernel::bits::{BitCoder, Chance, Mix};

/// Classes of sums of magnitudes, in units of the current plane.
const CLASSES: usize = 12;

/// The class of a sum.
const fn class(sum: u32) -> usize {
    match sum {
        0..3 => sum as usize,
        3..5 => 3,
        5..7 => 4,
        7..10 => 5,
        10..14 => 6,
        14..20 => 7,
        20..30 => 8,
        30..45 => 9,
        45..70 => 10,
        _ => 11,
    }
}

/// A class in fewer steps.
const fn coarse(class: usize) -> usize {
    match class {
        0..2 => class,
        2..4 => 2,
        4..7 => 3,
        _ => 4,
    }
}

/// Where a coefficient is, and what is known around it, in magnitudes in units of the current plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// In a face, not in an edge.
    pub(super) in_face: bool,
    /// Steps to the finest one, at most 7.
    pub(super) depth: usize,
    /// The plane, at most 31.
    pub(super) plane: usize,
    /// Faces next to an edge or edges next to a face.
    pub(super) near: [u32; 3],
    /// Edges beyond the faces next to an edge, or faces beyond the edges of a face.
    pub(super) far: [u32; 3],
    /// Vertices of the coarser level that it lies between.
    pub(super) parents: [u32; 3],
    /// The components of the vertex itself.
    pub(super) own: [u32; 3],
}

/// Chances that are mixed for whether a coefficient begins in a plane.
const MIXED: usize = 6;

/// Everything that is learnt about coefficients.
#[derive(Clone, Debug)]
pub(super) struct Models {
    begins: [Vec<Chance>; MIXED],
    begin_mix: Vec<Mix<MIXED>>,
    more: [Vec<Chance>; 2],
    more_mix: Vec<Mix<2>>,
}

impl Models {
    pub(super) fn new() -> Self {
        let chances = |count: usize| vec![Chance::expecting(1 << 13, 0); count];
        Self {
            begins: [
                chances(6 * CLASSES * 5),
                chances(6 * 8 * CLASSES),
                chances(6 * 5 * CLASSES),
                chances(6 * 5 * 5 * 5 * 5),
                chances(6 * 8 * 32),
                chances(6 * CLASSES * CLASSES),
            ],
            begin_mix: vec![Mix::new(16_000); 6 * 5],
            more: [vec![Chance::EVEN; 6 * 3 * CLASSES], vec![Chance::EVEN; 6 * 3 * 8]],
            more_mix: vec![Mix::new(32_000); 6],
        }
    }

    /// Codes whether a component that was nothing in the planes above begins in this one.
    pub(super) fn begins(
        &mut self,
        coder: &mut impl BitCoder,
        bit: bool,
        place: &Place,
        component: usize,
    ) -> bool {
        let kind = component * 2 + usize::from(place.in_face);
        let [near, far, parent] = [place.near, place.far, place.parents].map(|sums| class(sums[component]));
        let energy = class(2 * place.near[component] + place.far[component]);
        let others = |sums: &[u32; 3]| sums.iter().sum::<u32>() - sums[component];
        let (own, beside) = (others(&place.own), class(2 * others(&place.near) + others(&place.far)));
        let own = class(own);
        let contexts = [
            (kind * CLASSES + energy) * 5 + coarse(parent),
            (kind * 8 + place.depth) * CLASSES + parent,
            (kind * 5 + coarse(own)) * CLASSES + beside,
            (((kind * 5 + coarse(near)) * 5 + coarse(far)) * 5 + coarse(parent)) * 5 + coarse(own),
            (kind * 8 + place.depth) * 32 + place.plane,
            (kind * CLASSES + near) * CLASSES + far,
        ];
        let mut chances =
            self.begins.each_mut().into_iter().zip(contexts).map(|(all, context)| &mut all[context]);
        let chances: [&mut Chance; MIXED] =
            std::array::from_fn(|_| chances.next().expect("as many as mixed"));
        coder.mixed(bit, chances, &mut self.begin_mix[kind * 5 + coarse(energy)])
    }

    /// Codes the bit in this plane of a component that began in one `above` planes higher.
    pub(super) fn more(
        &mut self,
        coder: &mut impl BitCoder,
        bit: bool,
        place: &Place,
        (component, above): (usize, usize),
    ) -> bool {
        let kind = (component * 2 + usize::from(place.in_face)) * 3 + above.min(3) - 1;
        let energy = class((2 * place.near[component] + place.far[component]) / 2);
        let [first, second] = &mut self.more;
        let chances = [&mut first[kind * CLASSES + energy], &mut second[kind * 8 + place.depth]];
        coder.mixed(bit, chances, &mut self.more_mix[kind / 3])
    }
}
