//! The kernel's generalized lifting, of lines and of meshes, against the reference over exact fractions.

use std::num::NonZeroI32;

use conformance::oracle::noise::Noise;
use conformance::oracle::stencil;
use wavelift_kernel::lifting::generalized::{I16F16, inverse_s_lift, inverse_w_lift, s_lift, w_lift};
use wavelift_kernel::stencil::{Adjacency, Neighbours};
use wavelift_kernel::{LiftError, Slice};

/// Draws parameters and values.
struct Draw(Noise);

impl Draw {
    /// From 0 to `bound - 1`.
    fn below(&mut self, bound: u64) -> usize {
        usize::try_from(self.0.bits() % bound).expect("a small bound")
    }

    /// a of any size, b from -4 to 4 but 0.
    fn parameters(&mut self) -> (I16F16, NonZeroI32) {
        let bits = (self.0.bits() as i32) >> self.below(32);
        let b = [-4, -3, -2, -1, 1, 2, 3, 4][self.below(8)];
        (I16F16::from_bits(bits), NonZeroI32::new(b).expect("not 0"))
    }

    /// Values of any size, all of much the same.
    fn values(&mut self, count: usize) -> Vec<i32> {
        let shift = self.below(32);
        self.0.full_range(count).into_iter().map(|value| value >> shift).collect()
    }
}

fn wide(values: &[i32]) -> Vec<i64> {
    values.iter().copied().map(i64::from).collect()
}

/// The values as the kernel must return them: the first that is no `i32` is an overflow.
fn narrow(values: &[i64], slice: Slice) -> Result<Vec<i32>, LiftError> {
    let converted = values.iter().enumerate();
    converted
        .map(|(index, &value)| i32::try_from(value).map_err(|_| LiftError::Overflow { slice, index }))
        .collect()
}

/// The low and the high half, one after the other.
fn interleaved(low: &[i32], high: &[i32]) -> Vec<i64> {
    (0..low.len() + high.len())
        .map(|k| i64::from(if k % 2 == 0 { low[k / 2] } else { high[k / 2] }))
        .collect()
}

fn half(line: &[i64], first: usize) -> Vec<i64> {
    line.iter().skip(first).step_by(2).copied().collect()
}

type Lift = fn(&mut [i64], i64, i64);

/// Lifts the half `first` (0 low, 1 high) of a line and back, both as the reference does. Returns whether it was
/// accepted.
fn check_line(low: &[i32], high: &[i32], first: usize, (a, b): (I16F16, NonZeroI32)) -> bool {
    let parameters = (i64::from(a.to_bits()), i64::from(b.get()));
    let (forward, inverse): (Lift, Lift) = match first {
        0 => (stencil::s_lift, stencil::inverse_s_lift),
        _ => (stencil::w_lift, stencil::inverse_w_lift),
    };
    let mut line = interleaved(low, high);
    forward(&mut line, parameters.0, parameters.1);
    let slice = if first == 0 { Slice::Low } else { Slice::High };
    // A single sample is left alone, whatever b is.
    let expected = narrow(&half(&line, first), slice);

    let (mut lows, mut highs) = (low.to_vec(), high.to_vec());
    let lifted = match first {
        0 => s_lift(&mut lows, &highs, a, b),
        _ => w_lift(&lows, &mut highs, a, b),
    };
    let found = lifted.map(|()| if first == 0 { lows.clone() } else { highs.clone() });
    assert_eq!(found, expected, "half {first} of {low:?} {high:?}, a = {a}, b = {b}");
    if lifted.is_err() {
        assert!(lows == low && highs == high, "nothing is written");
        return false;
    }
    inverse(&mut line, parameters.0, parameters.1);
    assert_eq!(line, interleaved(low, high), "the reference undoes itself");
    let restored = match first {
        0 => inverse_s_lift(&mut lows, &highs, a, b),
        _ => inverse_w_lift(&lows, &mut highs, a, b),
    };
    assert_eq!(restored, Ok(()));
    assert!(lows == low && highs == high, "a = {a}, b = {b}");
    true
}

#[test]
fn lines_are_lifted_as_by_the_reference() {
    let mut draw = Draw(Noise::new(1));
    let mut accepted = 0;
    for n in (1..=20).cycle().take(40_000) {
        let parameters = draw.parameters();
        let (low, high) = (draw.values(n - n / 2), draw.values(n / 2));
        accepted += usize::from(check_line(&low, &high, 0, parameters));
        accepted += usize::from(check_line(&low, &high, 1, parameters));
    }
    println!("{accepted} of 80000 lines accepted");
    assert!((20_000..79_000).contains(&accepted), "{accepted} accepted: both outcomes must be met often");
}

/// Lists of neighbours as the reference and as the kernel take them.
struct Lists {
    lists: Vec<Vec<usize>>,
    offsets: Vec<u32>,
    indices: Vec<u32>,
    neighbours: usize,
}

impl Lists {
    fn draw(draw: &mut Draw, count: usize, neighbours: usize) -> Self {
        let lists: Vec<Vec<usize>> =
            (0..count).map(|_| (0..draw.below(6)).map(|_| draw.below(neighbours as u64)).collect()).collect();
        let mut offsets = vec![0];
        let mut indices = vec![];
        for list in &lists {
            indices.extend(list.iter().map(|&index| index as u32));
            offsets.push(indices.len() as u32);
        }
        Self { lists, offsets, indices, neighbours }
    }

    fn adjacency(&self) -> Adjacency<'_> {
        Adjacency::new(&self.offsets, &self.indices, self.neighbours).expect("sound lists")
    }
}

/// One mesh, lifted and back. Returns whether it was accepted.
fn check_mesh(draw: &mut Draw) -> bool {
    let [corners, edges, centres] = [1 + draw.below(6), 1 + draw.below(9), 1 + draw.below(6)];
    let centres_of_corner = Lists::draw(draw, corners, centres);
    let edges_of_corner = Lists::draw(draw, corners, edges);
    let centres_of_edge = Lists::draw(draw, edges, centres);
    let neighbours = Neighbours::new(
        centres_of_corner.adjacency(),
        edges_of_corner.adjacency(),
        centres_of_edge.adjacency(),
    )
    .expect("lists of one mesh");
    let (v, e, f) = (draw.values(corners), draw.values(edges), draw.values(centres));
    let (a, b) = draw.parameters();

    let parameters = (i64::from(a.to_bits()), i64::from(b.get()));
    let reference = stencil::Neighbours {
        centres_of_corner: centres_of_corner.lists.clone(),
        edges_of_corner: edges_of_corner.lists.clone(),
        centres_of_edge: centres_of_edge.lists.clone(),
    };
    let (mut wide_v, mut wide_e, wide_f) = (wide(&v), wide(&e), wide(&f));
    stencil::mesh_lift(&mut wide_v, &mut wide_e, &wide_f, &reference, parameters);
    let expected = narrow(&wide_v, Slice::Corners)
        .and_then(|corners| narrow(&wide_e, Slice::Edges).map(|edges| (corners, edges)));

    let (mut lifted_v, mut lifted_e) = (v.clone(), e.clone());
    let lifted = neighbours.lift(&mut lifted_v, &mut lifted_e, &f, a, b);
    assert_eq!(lifted.map(|()| (lifted_v.clone(), lifted_e.clone())), expected, "a = {a}, b = {b}");
    if lifted.is_ok() {
        stencil::inverse_mesh_lift(&mut wide_v, &mut wide_e, &wide_f, &reference, parameters);
        assert_eq!((wide_v, wide_e), (wide(&v), wide(&e)), "the reference undoes itself");
        assert_eq!(neighbours.inverse_lift(&mut lifted_v, &mut lifted_e, &f, a, b), Ok(()));
    }
    assert!(lifted_v == v && lifted_e == e, "restored, or never changed: a = {a}, b = {b}");
    lifted.is_ok()
}

#[test]
fn meshes_are_lifted_as_by_the_reference() {
    let mut draw = Draw(Noise::new(2));
    let accepted = (0..40_000).filter(|_| check_mesh(&mut draw)).count();
    println!("{accepted} of 40000 meshes accepted");
    assert!((10_000..39_000).contains(&accepted), "{accepted} accepted: both outcomes must be met often");
}
