//! How many bytes are read for what.

use super::*;

/// A container that counts what is read of it.
fn counted(bytes: &[u8]) -> (Container, std::sync::Arc<Count>) {
    let counted = Counted::new(bytes.to_vec());
    let count = counted.count();
    (Container::new(Box::new(counted)).unwrap(), count)
}

#[test]
fn a_small_file_costs_little_beside_its_bricks() {
    let volume = generate(Kind::Waves, [64, 33, 32], ElementType::U8, 1);
    let (stored, _) = store(&volume, &CompressOptions::default());
    let bricks: u64 = Scanner::new(&stored.bytes)
        .filter_map(|found| match found.unwrap().content {
            Some(Content::Brick { label, .. }) => Some(label.bytes()),
            _ => None,
        })
        .sum();
    let around = stored.bytes.len() as u64 - bricks;
    assert!(around < 180, "{around}");
}

#[test]
fn a_brick_costs_little() {
    let volume = generate(Kind::Waves, [64, 64, 64], ElementType::U16, 1);
    for wavelet in ["none", "haar"] {
        let (stored, _) = store(&volume, &small_bricks(wavelet, None));
        let (bricks, bytes) = Scanner::new(&stored.bytes)
            .filter_map(|found| match found.unwrap().content {
                Some(Content::Brick { label, .. }) => Some(label.bytes()),
                _ => None,
            })
            .fold((0, 0), |(count, bytes), brick| (count + 1, bytes + brick));
        let each = (stored.bytes.len() as u64 - bytes) as f64 / f64::from(bricks);
        println!("{wavelet}: {each:.1} bytes a brick");
        assert!(each < 48.0, "{wavelet} {each}");
    }
}

/// Reads of a brick and of its level 2, which have to take no byte that they could do without.
fn read_a_brick(volume: &Volume, wavelet: &str) {
    let options = CompressOptions { wavelet: wavelet.parse().unwrap(), ..CompressOptions::default() };
    let (stored, report) = store(volume, &options);
    assert_eq!(report.steps[0].sides, [64; 3]);
    // The brick, the record before it, and what of it makes level 2.
    let bricks: Vec<(u64, u64, u64)> = Scanner::new(&stored.bytes)
        .filter_map(|found| {
            let found = found.unwrap();
            match found.content {
                Some(Content::Brick { label, stored }) => {
                    let header = wavelift_kernel::Header::parse(&stored).unwrap();
                    let record = found.bytes.end - found.bytes.start - label.bytes();
                    Some((label.bytes(), record, header.bytes_to_level(2)))
                }
                _ => None,
            }
        })
        .collect();
    let (brick, record, beginning) = bricks[5];
    let region = |level| region(level, [64, 64, 0], [128, 128, 64]);
    let (container, count) = counted(&stored.bytes);
    let opened = count.bytes();
    let whole = container.read(&region(0), None, &ignore).unwrap().samples.len();
    let read = count.bytes();
    println!("{wavelet}: opening takes {opened} bytes, the region {}, its brick {brick}", read - opened);
    assert!(opened < 300 && read as f64 <= 1.03 * brick as f64);
    let coarse = container.read(&region(2), None, &ignore).unwrap();
    let level = count.bytes() - read;
    println!("{wavelet}: level 2 takes {level} bytes of {brick} and {whole}");
    assert_eq!((coarse.extent, level), ([16; 3], record + beginning));
    assert!(level as f64 <= 0.03 * whole as f64);
}

#[test]
fn a_region_takes_its_bricks_and_a_level_its_beginnings() {
    let volume = generate(Kind::Waves, [256, 128, 128], ElementType::U16, 1);
    for wavelet in ["haar", "linear"] {
        read_a_brick(&volume, wavelet);
    }
}

#[test]
fn bricks_are_found_by_their_values() {
    let mut volume = generate(Kind::Constant, [64, 16, 16], ElementType::U8, 1);
    volume.samples.fill(10);
    // One bright sample at a border between the second and the third brick along x.
    volume.samples[(5 * 16 + 3) * 64 + 32] = 200;
    let options = CompressOptions { brick: Some([16; 3]), ..CompressOptions::default() };
    let (stored, _) = store(&volume, &options);
    let container = Container::new(Box::new(stored.bytes)).unwrap();
    let place = Place { step: 0, brick: 0, component: 0 };
    let crossing = |isovalue| container.bricks_crossing(place.step, place.component, isovalue).unwrap();
    assert_eq!((crossing(100.0), crossing(10.0)), (vec![1, 2], vec![0, 1, 2, 3]));
    assert_eq!((crossing(9.0), crossing(200.5)), (vec![], vec![]));
    let summary = &container.summaries().unwrap()[0][0];
    assert_eq!(summary.range(ElementType::U8), Some([10.0, 200.0]));
}
