//! Counters, mixers and the numbers that they code.

use super::super::coder::arithmetic::Decoder;
use super::log2;

/// The first chances of a class, in 1/256, at each node.
const PRIORS: [[i32; 8]; 28] = [
    [1, 26, 9, 119, 186, 198, 189, 167],
    [17, 20, 4, 14, 81, 96, 64, 128],
    [41, 24, 4, 19, 93, 111, 91, 43],
    [63, 30, 4, 9, 55, 90, 96, 64],
    [77, 36, 6, 7, 47, 77, 77, 64],
    [86, 41, 7, 5, 34, 60, 32, 128],
    [93, 47, 9, 7, 32, 43, 77, 64],
    [101, 53, 13, 7, 29, 58, 48, 64],
    [114, 61, 20, 8, 22, 52, 23, 64],
    [134, 76, 36, 11, 16, 52, 72, 48],
    [154, 89, 57, 15, 12, 35, 20, 64],
    [171, 98, 78, 21, 15, 30, 29, 77],
    [187, 105, 106, 30, 12, 23, 24, 21],
    [199, 111, 132, 44, 13, 22, 35, 53],
    [207, 113, 149, 59, 15, 19, 21, 30],
    [211, 115, 162, 73, 18, 16, 24, 36],
    [217, 117, 176, 94, 25, 17, 22, 18],
    [223, 119, 190, 118, 39, 21, 18, 29],
    [228, 121, 201, 139, 56, 26, 15, 33],
    [231, 122, 209, 157, 77, 33, 16, 16],
    [236, 123, 219, 177, 106, 45, 17, 12],
    [241, 124, 227, 196, 134, 58, 18, 12],
    [244, 125, 232, 205, 150, 70, 23, 11],
    [245, 125, 235, 211, 161, 81, 28, 11],
    [128, 124, 235, 213, 164, 82, 23, 13],
    [128, 125, 238, 219, 178, 104, 37, 15],
    [128, 125, 241, 226, 192, 129, 52, 17],
    [128, 126, 244, 231, 203, 146, 65, 20],
];

/// A chance of true, and how often it learned.
#[derive(Debug, Clone, Copy)]
struct Counter {
    chance: i32,
    seen: i32,
}

impl Counter {
    const NEW: Self = Self { chance: 32768, seen: 0 };

    /// The eight nodes of a context that begins with the chances of a class.
    fn of_class(class: usize, seen: i32) -> [Self; 8] {
        let row = if class < 28 { class } else { 24 + class % 4 };
        PRIORS[row].map(|prior| Self { chance: 256 * prior + 128, seen })
    }

    fn learn(&mut self, decided: bool) {
        let goal = if decided { 65535 } else { 0 };
        self.chance += ((goal - self.chance) * (16384 / (2 * self.seen + 3)) + 4096) >> 13;
        self.seen = (self.seen + 1).min(255);
    }
}

/// Where a sample stands in each of the five contexts, and its energy.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) energy: u32,
    pub(super) class: usize,
    pub(super) contexts: [usize; 5],
}

/// Chances at the knots of squash.
fn knots() -> Vec<i64> {
    let mut tails = vec![1_u128 << 40];
    for n in 0..3072 {
        tails.push((tails[n] * 1_095_226_199_139) >> 40);
    }
    let h = |n: usize| (((1_u128 << 80) / ((1 << 40) + tails[n])) >> 24) as i64;
    let chance = |x: i64| if x < 0 { 65536 - h(x.unsigned_abs() as usize) } else { h(x as usize) };
    (-48..=48).map(|knot| chance(64 * knot).min(65535)).collect()
}

/// Everything that learns from decisions.
#[derive(Debug)]
pub(super) struct Model {
    knots: Vec<i64>,
    /// Of a chance in 1/4096.
    stretched: Vec<i32>,
    contexts: [Vec<[Counter; 8]>; 5],
    mixers: [[[i32; 6]; 5]; 16],
    low: [[Counter; 4]; 16],
    mantissa: [[[Counter; 3]; 8]; 10],
}

impl Model {
    pub(super) fn new() -> Self {
        let knots = knots();
        // It never falls, so that the least place can be halved for.
        let curve: Vec<i64> = (-3072..3072).map(|x| squash(&knots, x)).collect();
        let least = |goal: i64| curve.partition_point(|&chance| chance < goal) as i32 - 3072;
        let stretched = (0..4096).map(|j| least(16 * j + 8).min(3071)).collect();
        let contexts = [
            (0..320).map(|index| Counter::of_class(index / 8, 8)).collect(),
            (0..243).map(|index| Counter::of_class(4 * (index % 9) + 2, 2)).collect(),
            (0..320).map(|index| Counter::of_class(index / 8, 3)).collect(),
            vec![[Counter::NEW; 8]; 343],
            vec![[Counter::NEW; 8]; 256],
        ];
        Self {
            knots,
            stretched,
            contexts,
            mixers: [[[19000; 6]; 5]; 16],
            low: [[Counter::NEW; 4]; 16],
            mantissa: [[[Counter::NEW; 3]; 8]; 10],
        }
    }

    /// The residual of a sample, not yet turned round.
    pub(super) fn residual(&mut self, from: &mut Decoder<'_>, place: Place) -> i32 {
        let k = log2(place.energy).saturating_sub(6);
        if k == 0 {
            if !self.mixed(from, place, 0) {
                return 0;
            }
            let negative = self.mixed(from, place, 1);
            let magnitude = self.magnitude(from, place) as i32;
            return if negative { magnitude.wrapping_neg() } else { magnitude };
        }
        let negative = self.mixed(from, place, 1);
        let high = self.magnitude(from, place).wrapping_sub(1);
        let highest = single(from, &mut self.low[k.min(15) as usize][high.min(3) as usize]);
        let rest = from.raw(k - 1) as u32;
        let s = ((high << 1 | u32::from(highest)) << (k - 1) | rest) as i32;
        if negative { (-1_i32).wrapping_sub(s) } else { s }
    }

    fn magnitude(&mut self, from: &mut Decoder<'_>, place: Place) -> u32 {
        let mut o = 0;
        while o < 31 && self.mixed(from, place, 2 + o.min(13)) {
            o += 1;
        }
        let mut magnitude = 1;
        let mantissa = &mut self.mantissa[place.class / 4][o.min(7)];
        if o >= 1 {
            let first = single(from, &mut mantissa[0]);
            magnitude = 2 | u32::from(first);
            if o >= 2 {
                let second = single(from, &mut mantissa[if first { 2 } else { 1 }]);
                magnitude = magnitude << 1 | u32::from(second);
                magnitude = magnitude << (o - 2) | from.raw(o as u32 - 2) as u32;
            }
        }
        magnitude
    }

    /// A decision at a node, under all contexts.
    fn mixed(&mut self, from: &mut Decoder<'_>, place: Place, node: usize) -> bool {
        let counter = |context: usize| (place.contexts[context], node.min(7));
        let mut inputs = [64; 6];
        for (context, input) in inputs[..5].iter_mut().enumerate() {
            let (index, node) = counter(context);
            *input = self.stretched[self.contexts[context][index][node].chance as usize >> 4];
        }
        let weights = &mut self.mixers[node][place.class / 8];
        let products = (0..6).map(|i| weights[i].wrapping_mul(inputs[i]) >> 4);
        let odds = products.fold(0, i32::wrapping_add) >> 12;
        let chance = squash(&self.knots, i64::from(odds.clamp(-3071, 3071))).clamp(32, 65504) as i32;
        let decided = from.decision(chance as u64);
        let g = (((if decided { 65536 } else { 0 }) - chance) * 6) >> 8;
        for (weight, input) in weights.iter_mut().zip(inputs) {
            *weight = weight.wrapping_add((input * g + 512) >> 10);
        }
        for context in 0..5 {
            let (index, node) = counter(context);
            self.contexts[context][index][node].learn(decided);
        }
        decided
    }
}

/// Straight between the knots.
fn squash(knots: &[i64], x: i64) -> i64 {
    let (i, f) = ((x + 3072) as usize / 64, (x + 3072) % 64);
    (knots[i] * (64 - f) + knots[i + 1] * f + 32) >> 6
}

fn single(from: &mut Decoder<'_>, counter: &mut Counter) -> bool {
    let decided = from.decision(counter.chance.clamp(64, 65472) as u64);
    counter.learn(decided);
    decided
}
