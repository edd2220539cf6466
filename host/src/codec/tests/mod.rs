//! A volume to a container and back: every type, region, level, and every damaged byte.

mod bounds;
mod lattices;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Mutex;

use super::*;
use crate::bound::{Bound, Scale};
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{ElementType, Fault, Volume};

/// A container in a folder of its own.
struct Stored {
    _folder: tempfile::TempDir,
    path: PathBuf,
    bytes: Vec<u8>,
}

fn store(volume: &Volume, options: &CompressOptions) -> (Stored, Report) {
    let mut bytes = Vec::new();
    let report = compress(volume, options, &mut bytes, &|_| ()).unwrap();
    assert_eq!(report.container_bytes, bytes.len() as u64);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("volume.wlift");
    std::fs::write(&path, &bytes).unwrap();
    (Stored { _folder: folder, path, bytes }, report)
}

fn read(path: &std::path::Path, part: &Part) -> Result<Volume, ContainerError> {
    Container::open(path)?.read(part, None, &|_| ())
}

fn small_bricks(wavelet: &str, levels: Option<u8>) -> CompressOptions {
    CompressOptions {
        wavelet: wavelet.parse().unwrap(),
        levels,
        brick: Some([8, 8, 4]),
        ..CompressOptions::default()
    }
}

#[test]
fn every_type_and_kind_comes_back() {
    for element in ElementType::ALL {
        for kind in Kind::ALL {
            let volume = generate(kind, [19, 9, 6], element, 1);
            let (stored, _) = store(&volume, &small_bricks("auto", None));
            assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume, "{element} {}", kind.name());
        }
    }
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let volume = generate(Kind::Waves, [40, 30, 20], ElementType::U16, 3);
    let bytes = [1, 2, 5].map(|threads| {
        let options = CompressOptions { threads: NonZeroUsize::new(threads), ..small_bricks("auto", None) };
        store(&volume, &options).0.bytes
    });
    assert!(bytes.windows(2).all(|pair| pair[0] == pair[1]));
}

/// The samples `from .. to` of a volume of u16.
fn crop(volume: &Volume, from: [u64; 3], to: [u64; 3]) -> Vec<u8> {
    let [width, height, _] = volume.extent;
    let mut samples = Vec::new();
    for (z, y) in (from[2]..to[2]).flat_map(|z| (from[1]..to[1]).map(move |y| (z, y))) {
        let start = 2 * ((z * height + y) * width + from[0]) as usize;
        samples.extend_from_slice(&volume.samples[start..start + 2 * (to[0] - from[0]) as usize]);
    }
    samples
}

#[test]
fn regions_are_those_of_the_whole() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("linear", None));
    for (from, to) in
        [([0, 0, 0], [1, 1, 1]), ([7, 7, 3], [9, 9, 5]), ([18, 16, 8], [19, 17, 9]), ([3, 0, 4], [17, 17, 8])]
    {
        let part = Part { level: 0, region: Some(Region { from, to }) };
        let read = read(&stored.path, &part).unwrap();
        assert_eq!(read.samples, crop(&volume, from, to), "{from:?} {to:?}");
    }
}

#[test]
fn levels_are_seamless_and_in_scale() {
    let constant = generate(Kind::Constant, [21, 17, 9], ElementType::U16, 3);
    for wavelet in wavelift_kernel::Wavelet::ALL {
        let (stored, report) = store(&constant, &small_bricks(wavelet.name(), None));
        assert_eq!((report.index.levels, report.index.readable_levels), (3, 2));
        let coarse = read(&stored.path, &Part { level: 2, region: None }).unwrap();
        assert_eq!(coarse.extent, [6, 5, 3]);
        // The low-pass part is made of integers; after six splits one unit of it stands for gain^-6 samples.
        let (numerator, denominator) = wavelet.low_pass_gain();
        let slack = 2 * (denominator.pow(6) / numerator.pow(6)) as i32;
        let value = |bytes: &[u8]| i32::from(u16::from_le_bytes([bytes[0], bytes[1]]));
        let expected = value(&constant.samples);
        assert!(
            coarse.samples.chunks(2).all(|bytes| (value(bytes) - expected).abs() <= slack),
            "{wavelet:?}"
        );
    }
    let waves = generate(Kind::Waves, [21, 17, 9], ElementType::U16, 3);
    let (stored, _) = store(&waves, &small_bricks("haar", None));
    let coarse = read(&stored.path, &Part { level: 1, region: None }).unwrap();
    let region = Region { from: [3, 8, 2], to: [14, 17, 5] };
    let part = read(&stored.path, &Part { level: 1, region: Some(region) }).unwrap();
    assert_eq!((part.extent, part.samples), ([5, 5, 2], crop(&coarse, [2, 4, 1], [7, 9, 3])));
}

#[test]
fn a_volume_without_a_transform_has_levels_too() {
    let waves = generate(Kind::Waves, [21, 17, 9], ElementType::U16, 3);
    let level = Part { level: 1, region: None };
    let [none, linear] = ["none", "linear"].map(|wavelet| {
        let (stored, report) = store(&waves, &small_bricks(wavelet, None));
        assert_eq!(report.index.readable_levels, 2);
        read(&stored.path, &level).unwrap()
    });
    assert_eq!(none, linear);
    let wide = generate(Kind::Waves, [21, 17, 9], ElementType::U64, 3);
    let (stored, _) = store(&wide, &small_bricks("none", None));
    assert_eq!(read(&stored.path, &level).unwrap_err().kind(), Fault::Usage);
}

#[test]
fn few_values_are_packed_if_that_is_smaller() {
    for element in [ElementType::I16, ElementType::U32, ElementType::F32] {
        let mut volume = generate(Kind::Noise, [32, 16, 8], element, 3);
        for sample in volume.samples.chunks_mut(element.bytes()) {
            // Four values far apart, the sign bit among them.
            let value = sample[0] & 0x81;
            sample.fill(value);
        }
        let (stored, report) = store(&volume, &small_bricks("auto", None));
        assert_eq!(report.index.form.values().map(Values::count), Some(4), "{element}");
        // Two bits a sample, and what a brick costs.
        assert!(
            report.container_bytes < 32 * 16 * 8 / 4 + 64 * report.index.grid.bricks() + 200,
            "{report:?}"
        );
        assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume);
    }
    let waves = generate(Kind::Waves, [32, 16, 8], ElementType::U8, 3);
    assert_eq!(store(&waves, &small_bricks("auto", None)).1.index.form, Form::Exact);
}

#[test]
fn axes_left_out_of_a_region_are_whole() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("linear", None));
    let part = Part { level: 0, region: Some("2:5".parse().unwrap()) };
    let read = read(&stored.path, &part).unwrap();
    assert_eq!((read.extent, read.samples), ([3, 17, 9], crop(&volume, [2, 0, 0], [5, 17, 9])));
}

#[test]
fn parts_that_do_not_exist_are_the_users_fault() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("linear", None));
    for (level, region) in [(3, None), (0, Some("0:20,0:1,0:1")), (2, Some("1:3,0:1,0:1"))] {
        let part = Part { level, region: region.map(|region| region.parse().unwrap()) };
        assert_eq!(read(&stored.path, &part).unwrap_err().kind(), Fault::Usage, "{level} {region:?}");
    }
    assert!("1:1,0:1,0:1".parse::<Region>().is_err());
    assert!("0:1,0:1,0:1,0:1".parse::<Region>().is_err());
    assert!("0:1;0:1".parse::<Region>().is_err());
}

#[test]
fn impossible_options_are_the_users_fault() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let refuse = |options: CompressOptions| {
        let error = compress(&volume, &options, &mut Vec::new(), &|_| ()).unwrap_err();
        assert_eq!(error.kind(), Fault::Usage);
        error.to_string()
    };
    assert!(refuse(small_bricks("linear", Some(4))).contains("at most 3 levels"));
    assert!(refuse(small_bricks("none", Some(1))).contains("contradict"));
    assert!(refuse(small_bricks("cubic", Some(0))).contains("contradict"));
    assert!(refuse(CompressOptions { brick: Some([0, 8, 8]), ..Default::default() }).contains("--brick"));
}

/// Samples on a scale.
fn scaled() -> Form {
    Form::Scaled { scale: Scale::try_from((1.0, 0)).unwrap(), integers: wavelift_kernel::SampleType::I16 }
}

/// A container whose index has been replaced, with checksums that are right.
fn with_index(bytes: &[u8], change: impl Fn(&mut Index)) -> Vec<u8> {
    let footer = bytes.len() - 32;
    let position = u64::from_le_bytes(bytes[footer..footer + 8].try_into().unwrap());
    let mut index: Index = postcard::from_bytes(&bytes[position as usize..footer]).unwrap();
    change(&mut index);
    let index = postcard::to_allocvec(&index).unwrap();
    let mut changed = bytes[..position as usize].to_vec();
    changed.extend_from_slice(&index);
    changed.extend_from_slice(&container::footer(position, &index));
    changed
}

#[test]
fn an_index_that_lies_is_refused() {
    let volume = generate(Kind::Waves, [12, 9, 5], ElementType::U16, 3);
    let options = CompressOptions { brick: Some([64; 3]), ..small_bricks("none", None) };
    let (stored, report) = store(&volume, &options);
    assert_eq!(report.index.grid.bricks(), 1);
    let lies: [&dyn Fn(&mut Index); 14] = [
        &|index| (index.levels, index.readable_levels) = (255, 255),
        &|index| (index.wavelet, index.levels) = (Some(wavelift_kernel::Wavelet::Linear), 3),
        &|index| index.readable_levels = 5,
        &|index| index.element = ElementType::I16,
        &|index| (index.element, index.readable_levels) = (ElementType::F32, 1),
        &|index| index.grid.extent = [u64::MAX; 3],
        &|index| index.grid.sides = [u32::MAX; 3],
        &|index| index.bricks[0].lengths = vec![u32::MAX, 1],
        &|index| index.bricks[0].exceptions = Some(Kept::default()),
        &|index| index.form = Form::Steps(2),
        &|index| index.form = Form::Steps(u64::MAX),
        &|index| index.form = scaled(),
        &|index| (index.element, index.form) = (ElementType::F32, scaled()),
        &|index| index.bound = Some(Bound { error: f64::NAN, relative: None }),
    ];
    for (number, lie) in lies.into_iter().enumerate() {
        std::fs::write(&stored.path, with_index(&stored.bytes, lie)).unwrap();
        for level in [0, 1, 4, 64, 255] {
            let error = read(&stored.path, &Part { level, region: None }).unwrap_err();
            assert!(matches!(error.kind(), Fault::Data | Fault::Usage), "{number} at {level}: {error}");
            assert!(level > 4 || error.kind() == Fault::Data, "{number} at {level}: {error}");
        }
    }
}

#[test]
fn every_damaged_byte_and_every_truncation_is_noticed() {
    let volume = generate(Kind::Blobs, [12, 9, 5], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("auto", None));
    let damaged = |bytes: &[u8]| {
        std::fs::write(&stored.path, bytes).unwrap();
        let read = read(&stored.path, &Part::default());
        let verified = Container::open(&stored.path).map(|container| {
            let found = Mutex::new(0);
            container.verify(None, &|_| (), &|_| *found.lock().unwrap() += 1).unwrap();
            found.into_inner().unwrap()
        });
        assert_eq!(read.unwrap_err().kind(), Fault::Data);
        assert!(!matches!(verified, Ok(0)));
    };
    for at in 0..stored.bytes.len() {
        let mut bytes = stored.bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        damaged(&bytes);
        damaged(&stored.bytes[..at]);
    }
    damaged(&[stored.bytes.clone(), vec![0]].concat());
}

#[test]
fn every_effort_comes_back() {
    let volume = generate(Kind::Waves, [40, 30, 20], ElementType::U16, 3);
    let bytes = Effort::ALL.map(|effort| {
        let (stored, report) = store(&volume, &CompressOptions { effort, ..CompressOptions::default() });
        assert_eq!(report.index.effort, effort);
        assert_eq!(Container::open(&stored.path).unwrap().index().effort, effort);
        assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume);
        report.container_bytes
    });
    let [fast, default, dense] = bytes;
    assert!(dense <= default && dense <= fast, "{bytes:?}");
}
