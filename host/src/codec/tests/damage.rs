//! Files that are damaged or cut short: the damage is found and named, and what is whole is saved, bit for bit.

use std::ops::{ControlFlow, Range};

use super::*;
use crate::progress::ignore;

/// A file of bricks of single bytes that cannot be compressed, so that it is long enough for copies of its records.
struct Whole {
    volume: Volume,
    bytes: Vec<u8>,
    /// The bytes of each brick, and its samples.
    bricks: Vec<(Range<usize>, Vec<u8>)>,
    grid: Grid,
}

impl Whole {
    fn new(extent: [u64; 3], side: u32) -> Self {
        let volume = generate(Kind::Noise, extent, ElementType::U8, 5);
        let options = CompressOptions { brick: Some([side; 3]), effort: Effort::Fast, ..Default::default() };
        let (stored, _) = store(&volume, &options);
        let container = Container::open(&stored.path).unwrap();
        let grid = container.grid(0).unwrap();
        let bricks = (0..grid.bricks()).map(|brick| {
            let Range { start, end } = container.brick_bytes(0, brick, 0);
            (start as usize..end as usize, samples_of(&container, &grid, brick).unwrap())
        });
        Self { bricks: bricks.collect(), volume, bytes: stored.bytes, grid }
    }

    /// The brick that a byte of the file belongs to.
    fn brick_at(&self, byte: usize) -> Option<u64> {
        self.bricks.iter().position(|(range, _)| range.contains(&byte)).map(|brick| brick as u64)
    }

    /// Asserts that all bricks but those are as they were, and those are refused.
    fn assert_intact_but(&self, lost: &[u64], container: &Container) {
        for (brick, (_, samples)) in (0..).zip(&self.bricks) {
            match samples_of(container, &self.grid, brick) {
                Ok(found) => assert!(found == *samples && !lost.contains(&brick), "brick {brick}"),
                Err(error) => assert!(lost.contains(&brick), "brick {brick}: {error}"),
            }
        }
    }
}

fn samples_of(container: &Container, grid: &Grid, brick: u64) -> Result<Vec<u8>, ContainerError> {
    let Brick { origin, sides } = grid.brick(brick);
    let to = grid::per_axis(|axis| origin[axis] + u64::from(sides[axis]));
    container.read_values(&region(0, origin, to), NonZeroUsize::new(1), &ignore)
}

fn opened(bytes: &[u8]) -> Result<Container, ContainerError> {
    Container::new(Box::new(bytes.to_vec()))
}

fn repaired(bytes: &[u8]) -> Result<(Repaired, Vec<u8>), RepairError> {
    let mut out = Vec::new();
    let repaired = repair(&bytes, &mut out, NonZeroUsize::new(1), &ignore)?;
    Ok((repaired, out))
}

/// Calls `check` with each of `items`, on two threads: not on those of a pool, as it waits for pools of its own.
fn each<T: Sync>(items: &[T], check: impl Fn(&T) + Sync) {
    std::thread::scope(|scope| {
        for first in 0..2 {
            let check = &check;
            scope.spawn(move || items.iter().skip(first).step_by(2).for_each(check));
        }
    });
}

/// All that verifying finds.
fn found(container: &Container) -> Vec<ContainerError> {
    let found = Mutex::new(Vec::new());
    container.verify(NonZeroUsize::new(1), &ignore, &|error| found.lock().unwrap().push(error)).unwrap();
    found.into_inner().unwrap()
}

#[test]
fn a_whole_file_is_repaired_to_itself() {
    for kind in Kind::ALL {
        let volume = generate(kind, [40, 30, 20], ElementType::F32, 5);
        let (stored, _) = store(&volume, &small_bricks("auto", None));
        let (repaired, out) = repaired(&stored.bytes).unwrap();
        assert!(out == stored.bytes, "{}", kind.name());
        assert_eq!((repaired.lost.len(), repaired.lost_metadata, repaired.lost_steps.len()), (0, false, 0));
        assert!(repaired.gaps.is_empty());
    }
}

/// Changes one bit: it is found and named, all other bricks are as they were, before and after a repair.
fn flip(whole: &Whole, byte: usize, bit: u32) {
    let mut bytes = whole.bytes.clone();
    bytes[byte] ^= 1 << bit;
    let hit = whole.brick_at(byte);
    match (opened(&bytes), hit) {
        (Ok(container), Some(hit)) => {
            let found = found(&container);
            let [ContainerError::Brick { place, brick, .. }] = &found[..] else {
                panic!("{byte}: {found:?}")
            };
            assert_eq!((place.brick, *brick), (hit, whole.grid.brick(hit)), "byte {byte}, bit {bit}");
            whole.assert_intact_but(&[hit], &container);
        }
        (Ok(container), None) => {
            assert!(!found(&container).is_empty(), "byte {byte}, bit {bit} is not found");
            // Nothing is left of a file whose only head or step is damaged; a repair finds the copies.
        }
        (Err(error), None) => assert_eq!(error.kind(), Fault::Data, "byte {byte}, bit {bit}: {error}"),
        (Err(error), Some(_)) => {
            panic!("byte {byte}, bit {bit} of a brick keeps the file from opening: {error}")
        }
    }
    let (repaired, out) = repaired(&bytes).unwrap_or_else(|error| panic!("byte {byte}, bit {bit}: {error}"));
    let lost: Vec<u64> = repaired.lost.iter().map(|lost| lost.place.brick).collect();
    assert_eq!(lost, hit.into_iter().collect::<Vec<_>>(), "byte {byte}, bit {bit}");
    match hit {
        None => assert!(out == whole.bytes, "byte {byte}, bit {bit}: not as it was"),
        Some(_) => whole.assert_intact_but(&lost, &opened(&out).unwrap()),
    }
}

/// `WAVELIFT_FLIPS` sets how many.
#[test]
fn random_damage_is_found_and_the_rest_is_saved() {
    let flips = std::env::var("WAVELIFT_FLIPS").map_or(200, |flips| flips.parse().expect("a number"));
    let whole = Whole::new([64, 32, 32], 16);
    let mut state = 7_u64;
    let places: Vec<u64> = (0..flips)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 20
        })
        .collect();
    each(&places, |place| flip(&whole, (*place >> 3) as usize % whole.bytes.len(), (*place & 7) as u32));
}

#[test]
fn damage_outside_the_bricks_costs_no_brick() {
    let whole = Whole::new([64, 32, 32], 16);
    let outside: Vec<usize> = (0..whole.bytes.len()).filter(|byte| whole.brick_at(*byte).is_none()).collect();
    assert!(outside.len() > 100);
    each(&outside, |byte| flip(&whole, *byte, *byte as u32 % 8));
}

#[test]
fn every_truncation_leaves_the_bricks_before_it() {
    let whole = Whole::new([16, 16, 8], 8);
    let first = whole.bricks[0].0.start;
    let lengths: Vec<usize> = (0..whole.bytes.len()).collect();
    each(&lengths, |&len| {
        let cut = &whole.bytes[..len];
        assert_eq!(opened(cut).map(|_| ()).unwrap_err().kind(), Fault::Data, "{len} bytes");
        if len < first {
            assert_eq!(repaired(cut).unwrap_err().kind(), Fault::Data, "{len} bytes");
            return;
        }
        let (repaired, out) = repaired(cut).unwrap();
        let lost: Vec<u64> = repaired.lost.iter().map(|lost| lost.place.brick).collect();
        let cut_off = (0..).zip(&whole.bricks).filter(|(_, (range, _))| range.end > len);
        assert_eq!(lost, cut_off.map(|(brick, _)| brick).collect::<Vec<_>>(), "{len} bytes");
        whole.assert_intact_but(&lost, &opened(&out).unwrap());
    });
}

#[test]
fn a_repaired_file_says_what_is_lost() {
    let whole = Whole::new([64, 32, 32], 16);
    let mut bytes = whole.bytes.clone();
    bytes[whole.bricks[5].0.start + 100] ^= 1;
    let (_, out) = repaired(&bytes).unwrap();
    let errors = found(&opened(&out).unwrap());
    let [error] = &errors[..] else { panic!("{errors:?}") };
    let text = error.to_string();
    assert!(text.contains("brick 5 (samples 16:32,16:32,0:16)") && text.contains("lost"), "{text}");
    // Once more, nothing more is lost.
    let (again, same) = repaired(&out).unwrap();
    assert!(same == out && again.lost.len() == 1 && again.gaps.is_empty());
}

#[test]
fn what_is_no_container_cannot_be_repaired() {
    let noise = generate(Kind::Noise, [64, 32, 32], ElementType::U8, 5).samples;
    for bytes in [&[][..], b"\x89WLIFT\r\n", &noise] {
        assert!(matches!(repaired(bytes), Err(RepairError::NoHead)));
    }
    let whole = Whole::new([16, 16, 8], 8);
    let stopped = repair(&&whole.bytes[..], &mut Vec::new(), None, &|_| ControlFlow::Break(()));
    assert!(matches!(stopped, Err(RepairError::Stopped(_))));
}

#[test]
fn readers_do_not_disturb_each_other() {
    let whole = Whole::new([64, 32, 32], 16);
    let container = opened(&whole.bytes).unwrap();
    std::thread::scope(|scope| {
        for reader in 0..8_u64 {
            let (whole, container) = (&whole, &container);
            scope.spawn(move || {
                for turn in 0..whole.grid.bricks() {
                    let brick = (turn * 7 + reader) % whole.grid.bricks();
                    let samples = samples_of(container, &whole.grid, brick).unwrap();
                    assert!(samples == whole.bricks[brick as usize].1, "brick {brick}");
                }
                let all = container.read(&Part::default(), NonZeroUsize::new(2), &ignore).unwrap();
                assert!(all == whole.volume);
            });
        }
    });
}
