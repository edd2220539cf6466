//! Dense codestreams, decoded the plain way, from `kernel/docs/dense.md` and `kernel/docs/codestream.md` alone: every
//! neighbour is looked up anew, and every sum is formed where it is needed.

mod learn;
mod model;

use super::coder::arithmetic::Decoder;
use super::coder::{Reject, SampleType};
use learn::Learner;
use model::{Model, Place};

/// What is known of a row before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Line,
    Plane,
    Brick,
}

impl Kind {
    const fn of(y: usize, z: usize) -> Self {
        match (y, z) {
            (0, 0) => Self::Line,
            (_, 0) => Self::Plane,
            _ => Self::Brick,
        }
    }

    /// How many weights there are, and those to begin with.
    fn first_weights(self) -> (usize, Vec<i32>) {
        let (unknowns, first): (usize, &[i32]) = match self {
            Self::Line => (2, &[]),
            Self::Plane => (17, &[4096, -4096]),
            Self::Brick => (19, &[3072, 3072, -3072, -3072]),
        };
        let mut weights = first.to_vec();
        weights.resize(unknowns, 0);
        (unknowns, weights)
    }
}

/// log2 rounded down, and 0 for 0.
fn log2(v: u32) -> u32 {
    v.checked_ilog2().unwrap_or(0)
}

/// The samples of a dense codestream of that extent and type, from its segment alone.
///
/// # Errors
///
/// [`Reject::Segment`] and [`Reject::Sample`].
pub fn decode(segment: &[u8], extent: [usize; 3], sample_type: SampleType) -> Result<Vec<i32>, Reject> {
    let mut from = Decoder::new(segment)?;
    let bits = 8 * sample_type.bytes() as u32;
    let least = match sample_type {
        SampleType::U8 | SampleType::U16 => 0,
        SampleType::I8 => i32::from(i8::MIN),
        SampleType::I16 => i32::from(i16::MIN),
        SampleType::U32 | SampleType::I32 => i32::MIN,
    };
    let lowest = least.wrapping_add(from.raw(bits) as i32);
    let span = from.raw(bits);
    if span >= 1 << 25 {
        return Err(Reject::Segment);
    }
    let mut axes: Vec<usize> = extent.into_iter().filter(|&n| n > 1).collect();
    axes.resize(3, 1);
    let volume = Volume::new([axes[0], axes[1], axes[2]], span as i32);
    let samples = if span == 0 { vec![0; extent.iter().product()] } else { volume.decode(&mut from) };
    from.finish()?;
    let samples: Vec<i32> = samples.into_iter().map(|v| lowest.wrapping_add(v)).collect();
    if samples.iter().all(|&v| sample_type.holds(v)) { Ok(samples) } else { Err(Reject::Sample) }
}

/// What is remembered of a place of a plane.
#[derive(Debug, Clone, Copy, Default)]
struct Memory {
    error: i32,
    /// Of the fast and of the slow weights.
    losses: [i32; 2],
}

/// Samples as far as they are known.
#[derive(Debug)]
struct Volume {
    extent: [usize; 3],
    span: i32,
    samples: Vec<i32>,
    plane: Vec<Memory>,
}

/// A prediction, in 1/16.
#[derive(Debug)]
struct Prediction {
    /// By the fast and by the slow weights.
    parts: [i32; 2],
    whole: i32,
    differences: Vec<i32>,
    up: u32,
    down: u32,
}

impl Volume {
    fn new(extent: [usize; 3], span: i32) -> Self {
        let [width, height, _] = extent;
        Self { extent, span, samples: Vec::new(), plane: vec![Memory::default(); width * height] }
    }

    fn decode(mut self, from: &mut Decoder<'_>) -> Vec<i32> {
        let [width, height, depth] = self.extent;
        let mut model = Model::new();
        let mut learner = Learner::new(Kind::Line, self.extent);
        for (z, y) in (0..depth).flat_map(|z| (0..height).map(move |y| (z, y))) {
            if matches!((y, z), (0, 0) | (1, 0) | (0, 1)) {
                learner = Learner::new(Kind::of(y, z), self.extent);
            }
            for x in 0..width {
                self.sample(from, &mut model, &mut learner, [x, y, z]);
            }
        }
        self.samples
    }

    fn sample(&mut self, from: &mut Decoder<'_>, model: &mut Model, learner: &mut Learner, at: [usize; 3]) {
        let prediction = self.predict(learner.weights(at[0]), at);
        let value = prediction.whole.wrapping_add(8) >> 4;
        let offset = prediction.whole.wrapping_sub(value << 4);
        let place = self.place(prediction.whole, value, offset, at);
        let residual = model.residual(from, place);
        let v = if offset < 0 { value.wrapping_sub(residual) } else { value.wrapping_add(residual) };
        let w = self.before(at, 1);
        self.samples.push(v);
        let off = |p: i32| (v << 4).wrapping_sub(p);
        let loss_bits = (log2(self.span as u32) + 1).saturating_sub(12);
        let losses = prediction.parts.map(|p| (off(p).unsigned_abs() >> loss_bits).min(4095) as i32);
        let error = off(prediction.whole).clamp(-(1 << 24), 1 << 24);
        self.plane[at[1] * self.extent[0] + at[0]] = Memory { error, losses };
        let target = v.wrapping_sub(w) << prediction.up >> prediction.down;
        learner.observe(at, &prediction.differences, target);
    }

    /// The sample `back` places before one, in its row.
    fn before(&self, [x, y, z]: [usize; 3], back: usize) -> i32 {
        if x >= back {
            self.row(y, z, x, -(back as isize))
        } else if y > 0 {
            self.row(y - 1, z, 0, 0)
        } else if z > 0 {
            self.row(y, z - 1, 0, 0)
        } else {
            self.span >> 1
        }
    }

    /// The sample of a row at x + i, or the nearest.
    fn row(&self, y: usize, z: usize, x: usize, i: isize) -> i32 {
        let [width, height, _] = self.extent;
        let x = x.saturating_add_signed(i).min(width - 1);
        self.samples[(z * height + y) * width + x]
    }

    /// n, nn and nnn: the row `back` rows up.
    fn north(&self, [x, y, z]: [usize; 3], back: usize, i: isize) -> i32 {
        match (y, z) {
            (0, 0) => 0,
            (0, _) => self.row(0, z - 1, x, i),
            _ => self.row(y.saturating_sub(back), z, x, i),
        }
    }

    fn neighbours(&self, at: [usize; 3]) -> Vec<i32> {
        let [x, y, z] = at;
        let [n, nn, nnn] = [1, 2, 3].map(|back| move |i| self.north(at, back, i));
        let [ww, www] = [2, 3].map(|back| self.before(at, back));
        match Kind::of(y, z) {
            Kind::Line => vec![ww, www],
            Kind::Plane => vec![
                n(0),
                n(-1),
                n(1),
                ww,
                nn(0),
                nn(1),
                nn(-1),
                n(2),
                n(-2),
                www,
                n(-3),
                n(3),
                nn(-2),
                nn(2),
                nnn(-1),
                nnn(0),
                nnn(1),
            ],
            Kind::Brick => {
                let u = |i| self.row(y, z - 1, x, i);
                let un = |i| self.row(y.saturating_sub(1), z - 1, x, i);
                let us = |i| self.row((y + 1).min(self.extent[1] - 1), z - 1, x, i);
                let uu = self.row(y, z.saturating_sub(2), x, 0);
                vec![
                    n(0),
                    u(0),
                    n(-1),
                    u(-1),
                    n(1),
                    u(1),
                    un(0),
                    us(0),
                    ww,
                    nn(0),
                    uu,
                    un(-1),
                    un(1),
                    us(1),
                    us(-1),
                    n(2),
                    n(-2),
                    nn(-1),
                    nn(1),
                ]
            }
        }
    }

    fn predict(&self, weights: [&[i32]; 2], at: [usize; 3]) -> Prediction {
        let w = self.before(at, 1);
        let differences: Vec<i32> = self.neighbours(at).iter().map(|v| v.wrapping_sub(w)).collect();
        let bitwise = differences.iter().fold(0, |or, d| or | d.unsigned_abs());
        let bits = 32 - bitwise.leading_zeros();
        let (up, down) = (14_u32.saturating_sub(bits).min(10), bits.saturating_sub(14));
        let differences: Vec<i32> = differences.iter().map(|d| d << up >> down).collect();
        let parts = weights.map(|weights| {
            if bitwise == 0 {
                return w << 4;
            }
            let products = weights.iter().zip(&differences).map(|(weight, s)| weight.wrapping_mul(*s));
            let sum = products.fold(0, i32::wrapping_add);
            (w << 4).wrapping_add(sum >> 8 << down >> up).clamp(0, self.span << 4)
        });
        let [a, b] = [0, 1].map(|which| {
            let loss = |dx, dy| self.memory(at, dx, dy).losses[which];
            let sum = 2 * (loss(-1, 0) + loss(0, -1) + loss(0, 0)) + loss(1, -1) + loss(-2, 0);
            i64::from((sum >> 3) + 1)
        });
        let share = 64 * b * b / (a * a + b * b);
        let [fast, slow] = parts;
        let whole = slow.wrapping_add(((i64::from(fast.wrapping_sub(slow)) * share) >> 6) as i32);
        Prediction { parts, whole, differences, up, down }
    }

    /// What is remembered beside a place; nothing beyond the borders.
    fn memory(&self, [x, y, _]: [usize; 3], dx: isize, dy: isize) -> Memory {
        let [width, height, _] = self.extent;
        match (x.checked_add_signed(dx), y.checked_add_signed(dy)) {
            (Some(x), Some(y)) if x < width && y < height => self.plane[y * width + x],
            _ => Memory::default(),
        }
    }

    fn place(&self, whole: i32, value: i32, offset: i32, at: [usize; 3]) -> Place {
        let is_brick = at[2] > 0;
        let error = |dx, dy| self.memory(at, dx, dy).error;
        let near = [error(-1, 0), error(0, -1), error(0, 0)];
        let far = [error(1, -1), error(-1, -1), error(1, 0), error(0, 1), error(-2, 0)];
        let sum = |errors: &[i32]| errors.iter().map(|e| u64::from(e.unsigned_abs())).sum::<u64>();
        let share = if is_brick { 47 } else { 73 };
        let energy = ((4 * sum(&near) + 2 * sum(&far)) * share) >> 10;
        let class = match quantized(energy as u32) {
            few @ 0..40 => few,
            many => 36 + many % 4,
        };
        let third = if is_brick { near[2] } else { far[0] };
        let errors = [near[0], near[1], third].map(|e| if offset < 0 { -e } else { e });
        let digits = |base: usize, digit: fn(i32) -> usize| {
            errors.iter().fold(0, |number, &error| number * base + digit(error))
        };
        let fraction = offset.unsigned_abs().min(7) as usize;
        let level_bits = (log2(self.span as u32) + 1).saturating_sub(6);
        let level = (value >> level_bits).clamp(0, 63) as usize;
        let contexts = [
            class * 8 + fraction,
            digits(3, sign) * 9 + (class / 4).min(8),
            self.texture(whole, at) * 8 + fraction,
            digits(7, step),
            level * 4 + (class / 8).min(3),
        ];
        Place { energy: energy as u32, class, contexts }
    }

    fn texture(&self, whole: i32, at: [usize; 3]) -> usize {
        let n = |i| self.north(at, 1, i);
        let other = if at[2] > 0 { self.row(at[1], at[2] - 1, at[0], 0) } else { n(-1) };
        let around = [self.before(at, 1), n(0), n(1), other];
        let far = around.map(|v| (v << 4).wrapping_sub(whole).unsigned_abs());
        quantized(far.into_iter().fold(0, u32::wrapping_add) >> 3).min(39)
    }
}

fn quantized(v: u32) -> usize {
    let o = log2(v);
    if v < 4 { v as usize } else { (4 * (o - 1) + (v >> (o - 2)) % 4) as usize }
}

fn sign(error: i32) -> usize {
    match error {
        ..-8 => 0,
        8.. => 2,
        _ => 1,
    }
}

fn step(error: i32) -> usize {
    let size = match error.unsigned_abs() {
        0..5 => 0,
        5..12 => 1,
        12..32 => 2,
        _ => 3,
    };
    if error < 0 { 3 - size } else { 3 + size }
}
