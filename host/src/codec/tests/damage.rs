//! Files that are damaged or cut short: the damage is found and named, and what is whole is saved, bit for bit.

use std::ops::{ControlFlow, Range};

use super::*;
use crate::progress::ignore;

/// A file of bricks of single bytes that cannot be compressed.
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
    let repaired = repair(Box::new(bytes.to_vec()), &mut out, NonZeroUsize::new(1), &ignore)?;
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
        assert_eq!(repaired.damage, Damage::default());
    }
}

/// Changes one byte: it is found and named, all other bricks are as they were, and a repair brings back every bit.
fn flip(whole: &Whole, byte: usize, by: u8) {
    let mut bytes = whole.bytes.clone();
    bytes[byte] ^= by;
    let hit = whole.brick_at(byte);
    match (opened(&bytes), hit) {
        (Ok(container), Some(hit)) => {
            let found = found(&container);
            let [ContainerError::Brick { place, brick, .. }] = &found[..] else {
                panic!("{byte}: {found:?}")
            };
            assert_eq!((place.brick, *brick), (hit, whole.grid.brick(hit)), "byte {byte}, by {by}");
            whole.assert_intact_but(&[hit], &container);
        }
        (Ok(container), None) => {
            assert!(!found(&container).is_empty(), "byte {byte}, by {by} is not found");
            // Nothing is left of a file whose only head or step is damaged; a repair finds the copies.
        }
        (Err(error), None) => assert_eq!(error.kind(), Fault::Data, "byte {byte}, by {by}: {error}"),
        (Err(error), Some(_)) => {
            panic!("byte {byte} of a brick, by {by}, keeps the file from opening: {error}")
        }
    }
    let (repaired, out) = repaired(&bytes).unwrap_or_else(|error| panic!("byte {byte}, by {by}: {error}"));
    assert!(out == whole.bytes, "byte {byte}, by {by}: {:?}", repaired.damage);
    assert_eq!(repaired.damage.lost, [], "byte {byte}, by {by}");
}

/// Flips random bytes; `WAVELIFT_FLIPS` sets how many.
fn flip_at_random(whole: &Whole) {
    let flips = std::env::var("WAVELIFT_FLIPS").map_or(200, |flips| flips.parse().expect("a number"));
    let mut state = 7_u64;
    let places: Vec<u64> = (0..flips)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 20
        })
        .collect();
    each(&places, |place| {
        flip(whole, (*place >> 8) as usize % whole.bytes.len(), ((*place & 255) as u8).max(1));
    });
}

#[test]
fn random_damage_is_found_and_put_right() {
    flip_at_random(&Whole::new([64, 32, 32], 16));
}

/// Nothing of them is there twice.
#[test]
fn small_files_survive_every_wrong_byte() {
    for (extent, side) in [([3, 2, 1], 64), ([24, 12, 9], 64), ([16, 16, 8], 8)] {
        let whole = Whole::new(extent, side);
        let all: Vec<usize> = (0..whole.bytes.len()).collect();
        each(&all, |byte| flip(&whole, *byte, 1 << (*byte % 8)));
    }
    flip_at_random(&Whole::new([24, 12, 9], 64));
}

#[test]
fn small_files_survive_without_their_beginning() {
    for (extent, side) in [([3, 2, 1], 64), ([24, 12, 9], 64), ([16, 16, 8], 8)] {
        let whole = Whole::new(extent, side);
        let first = whole.bricks[0].0.start;
        // From a few wrong bytes in one record to all of them.
        for (from, to) in [(0, first), (11, 14), (12, 30), (first - 9, first - 3)] {
            let mut bytes = whole.bytes.clone();
            bytes[from..to].iter_mut().for_each(|byte| *byte ^= 0x5A);
            let (repaired, out) = repaired(&bytes).unwrap_or_else(|error| panic!("{from}..{to}: {error}"));
            assert_eq!((repaired.damage.lost, repaired.damage.lost_steps), (vec![], vec![]), "{from}..{to}");
            assert!(
                opened(&out).unwrap().read(&Part::default(), None, &ignore).unwrap().samples
                    == whole.volume.samples
            );
        }
    }
}

#[test]
fn a_wrong_byte_in_every_record_is_put_right() {
    let whole = Whole::new([32, 32, 16], 16);
    let mut bytes = whole.bytes.clone();
    for found in Scanner::new(&whole.bytes) {
        let Range { start, end } = found.unwrap().bytes;
        bytes[(start + end) as usize / 2] ^= 0x55;
    }
    let (repaired, out) = repaired(&bytes).unwrap();
    assert!(out == whole.bytes, "{:?}", repaired.damage);
}

#[test]
fn damage_outside_the_bricks_costs_no_brick() {
    let whole = Whole::new([64, 32, 32], 16);
    let outside: Vec<usize> = (0..whole.bytes.len()).filter(|byte| whole.brick_at(*byte).is_none()).collect();
    assert!(outside.len() > 100);
    each(&outside, |byte| flip(&whole, *byte, 1 << (*byte % 8)));
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
        let lost: Vec<u64> = repaired.damage.lost.iter().map(|lost| lost.place.brick).collect();
        let cut_off = (0..).zip(&whole.bricks).filter(|(_, (range, _))| range.end > len);
        assert_eq!(lost, cut_off.map(|(brick, _)| brick).collect::<Vec<_>>(), "{len} bytes");
        whole.assert_intact_but(&lost, &opened(&out).unwrap());
    });
}

#[test]
fn a_repaired_file_says_what_is_lost() {
    let whole = Whole::new([64, 32, 32], 16);
    let mut bytes = whole.bytes.clone();
    bytes[whole.bricks[5].0.start + 100..][..9].fill(0);
    let (_, out) = repaired(&bytes).unwrap();
    let errors = found(&opened(&out).unwrap());
    let [error] = &errors[..] else { panic!("{errors:?}") };
    let text = error.to_string();
    assert!(text.contains("brick 5 (samples 16:32,16:32,0:16)") && text.contains("lost"), "{text}");
    // Once more, nothing more is lost.
    let (again, same) = repaired(&out).unwrap();
    assert!(same == out && again.damage.lost.len() == 1 && again.damage.gaps.is_empty());
}

/// A sink that keeps what is written.
struct Kept(std::sync::mpsc::Sender<Vec<u8>>);

impl crate::volume::Sink for Kept {
    fn write(&mut self, values: &[u8]) -> Result<(), crate::volume::WriteError> {
        self.0.send(values.to_vec()).unwrap();
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), crate::volume::WriteError> {
        Ok(())
    }
}

#[test]
fn what_is_left_is_read_and_the_rest_filled() {
    let whole = Whole::new([64, 32, 32], 16);
    let mut bytes = whole.bytes.clone();
    bytes[whole.bricks[5].0.start + 100..][..9].fill(0);
    bytes[whole.bricks[9].0.start + 2..][..30].fill(0);
    bytes.truncate(whole.bricks[14].0.start + 7);
    let Salvaged { container, damage } = Container::salvage(Box::new(bytes)).unwrap();
    let lost = |lost: &[Lost]| lost.iter().map(|lost| lost.place.brick).collect::<Vec<_>>();
    assert_eq!((lost(&damage.lost), damage.gaps.len()), (vec![5, 9, 14, 15], 3));
    whole.assert_intact_but(&[5, 9, 14, 15], &container);
    for memory in [None, Some(1)] {
        let (kept, written) = std::sync::mpsc::channel();
        let options = DecompressOptions { threads: None, memory };
        let fill = Fill::of_text(ElementType::U8, "77").unwrap();
        let found =
            container.decompress_with(&Part::default(), Box::new(Kept(kept)), &options, fill, &ignore);
        assert_eq!(lost(&found.unwrap()), [5, 9, 14, 15]);
        let mut expected = whole.volume.samples.clone();
        for brick in [5, 9, 14, 15] {
            let Brick { origin: [x0, y0, z0], sides } = whole.grid.brick(brick);
            let [w, h, d] = sides.map(u64::from);
            for (z, y) in (z0..z0 + d).flat_map(|z| (y0..y0 + h).map(move |y| (z, y))) {
                expected[((z * 32 + y) * 64 + x0) as usize..][..w as usize].fill(77);
            }
        }
        assert!(written.iter().flatten().eq(expected));
    }
}

#[test]
fn what_is_no_container_cannot_be_repaired() {
    let noise = generate(Kind::Noise, [64, 32, 32], ElementType::U8, 5).samples;
    for bytes in [&[][..], b"\x89WLIFT\r\n", &noise] {
        assert!(matches!(repaired(bytes), Err(RepairError::NoHead)));
    }
    let whole = Whole::new([16, 16, 8], 8);
    let stopped = repair(Box::new(whole.bytes), &mut Vec::new(), None, &|_| ControlFlow::Break(()));
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
