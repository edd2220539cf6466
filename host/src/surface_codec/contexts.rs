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

/// What is known of some coefficients around one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Around {
    /// Sums of magnitudes, in units of the current plane.
    pub(super) sizes: [u32; 3],
    /// How many more normal parts are positive than negative.
    pub(super) leaning: i32,
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
    pub(super) near: Around,
    /// Edges beyond the faces next to an edge, or faces beyond the edges of a face.
    pub(super) far: Around,
    /// Vertices of the coarser level that it lies between.
    pub(super) parents: Around,
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
    negative: [Chance; 54],
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
            negative: [Chance::expecting(1 << 15, 4); 54],
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
        let [near, far, parent] =
            [place.near, place.far, place.parents].map(|around| class(around.sizes[component]));
        let (near_sizes, far_sizes) = (&place.near.sizes, &place.far.sizes);
        let energy = class(2 * near_sizes[component] + far_sizes[component]);
        let others = |sums: &[u32; 3]| sums.iter().sum::<u32>() - sums[component];
        let (own, beside) = (others(&place.own), class(2 * others(near_sizes) + others(far_sizes)));
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

    /// Codes the sign of a component that begins. Tangents point anywhere, so that only normal parts go with their
    /// neighbours.
    pub(super) fn negative(
        &mut self,
        coder: &mut impl BitCoder,
        bit: bool,
        place: &Place,
        component: usize,
    ) -> bool {
        if component > 0 {
            return coder.decide(bit, 1 << 15);
        }
        let signs =
            [place.near, place.far, place.parents].map(|around| (around.leaning.signum() + 1) as usize);
        let context = signs.iter().fold(usize::from(place.in_face), |context, sign| context * 3 + sign);
        coder.bit(bit, &mut self.negative[context])
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
        let energy = class((2 * place.near.sizes[component] + place.far.sizes[component]) / 2);
        let [first, second] = &mut self.more;
        let chances = [&mut first[kind * CLASSES + energy], &mut second[kind * 8 + place.depth]];
        coder.mixed(bit, chances, &mut self.more_mix[kind / 3])
    }
}
