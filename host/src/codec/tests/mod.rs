//! A volume to a container and back: every type, region, level, and every damaged byte.

mod bounds;
mod damage;
mod files;
mod lattices;
mod meters;
mod streams;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Mutex;

use super::*;
use crate::bound::{Bound, Scale};
use crate::progress::ignore;
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
    let report = compress(volume, options, &mut bytes, &ignore).unwrap();
    assert_eq!(report.container_bytes, bytes.len() as u64);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("volume.wlift");
    std::fs::write(&path, &bytes).unwrap();
    (Stored { _folder: folder, path, bytes }, report)
}

fn read(path: &std::path::Path, part: &Part) -> Result<Volume, ContainerError> {
    let container = Container::open(path).map_err(|error| match error {
        ContainerError::Open { cause, .. } => *cause,
        other => other,
    })?;
    container.read(part, None, &ignore)
}

/// How the only component of the only time step is coded.
fn channel(report: &Report) -> &Channel {
    &report.steps[0].channels[0]
}

/// What its samples are like.
fn summary(report: &Report) -> &Summary {
    &report.summaries[0][0]
}

/// A level of everything.
fn level(level: u8) -> Part {
    Part { level, ..Part::default() }
}

/// A region at a level.
fn region(level: u8, from: [u64; 3], to: [u64; 3]) -> Part {
    Part { level, region: Some(Region { from, to }), ..Part::default() }
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
        let read = read(&stored.path, &region(0, from, to)).unwrap();
        assert_eq!(read.samples, crop(&volume, from, to), "{from:?} {to:?}");
    }
}

#[test]
fn levels_are_seamless_and_in_scale() {
    let constant = generate(Kind::Constant, [21, 17, 9], ElementType::U16, 3);
    for wavelet in wavelift_kernel::Wavelet::ALL {
        let (stored, report) = store(&constant, &small_bricks(wavelet.name(), None));
        assert_eq!((channel(&report).levels, channel(&report).readable_levels), (3, 2));
        let coarse = read(&stored.path, &level(2)).unwrap();
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
    let coarse = read(&stored.path, &level(1)).unwrap();
    let part = read(&stored.path, &region(1, [3, 8, 2], [14, 17, 5])).unwrap();
    assert_eq!((part.extent, part.samples), ([5, 5, 2], crop(&coarse, [2, 4, 1], [7, 9, 3])));
}

#[test]
fn a_volume_without_a_transform_has_levels_too() {
    let waves = generate(Kind::Waves, [21, 17, 9], ElementType::U16, 3);
    let [none, linear] = ["none", "linear"].map(|wavelet| {
        let (stored, report) = store(&waves, &small_bricks(wavelet, None));
        assert_eq!(channel(&report).readable_levels, 2);
        read(&stored.path, &level(1)).unwrap()
    });
    assert_eq!(none, linear);
    let wide = generate(Kind::Waves, [21, 17, 9], ElementType::U64, 3);
    let (stored, _) = store(&wide, &small_bricks("none", None));
    assert_eq!(read(&stored.path, &level(1)).unwrap_err().kind(), Fault::Usage);
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
        assert_eq!(channel(&report).form.values().map(Values::count), Some(4), "{element}");
        // Two bits a sample, and what a brick costs.
        assert!(
            report.container_bytes < 32 * 16 * 8 / 4 + 76 * summary(&report).bricks.len() as u64 + 200,
            "{report:?}"
        );
        assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume);
    }
    let waves = generate(Kind::Waves, [32, 16, 8], ElementType::U8, 3);
    assert_eq!(channel(&store(&waves, &small_bricks("auto", None)).1).form, Form::Exact);
}

#[test]
fn axes_left_out_of_a_region_are_whole() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("linear", None));
    let part = Part { region: Some("2:5".parse().unwrap()), ..Part::default() };
    let read = read(&stored.path, &part).unwrap();
    assert_eq!((read.extent, read.samples), ([3, 17, 9], crop(&volume, [2, 0, 0], [5, 17, 9])));
}

#[test]
fn parts_that_do_not_exist_are_the_users_fault() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("linear", None));
    for (level, region) in [(3, None), (0, Some("0:20,0:1,0:1")), (2, Some("1:3,0:1,0:1"))] {
        let region = region.map(|region: &str| region.parse().unwrap());
        let part = Part { level, region, ..Part::default() };
        assert_eq!(read(&stored.path, &part).unwrap_err().kind(), Fault::Usage, "{part:?}");
    }
    assert!("1:1,0:1,0:1".parse::<Region>().is_err());
    assert!("0:1,0:1,0:1,0:1".parse::<Region>().is_err());
    assert!("0:1;0:1".parse::<Region>().is_err());
}

#[test]
fn impossible_options_are_the_users_fault() {
    let volume = generate(Kind::Waves, [19, 17, 9], ElementType::U16, 3);
    let refuse = |options: CompressOptions| {
        let error = compress(&volume, &options, &mut Vec::new(), &ignore).unwrap_err();
        assert_eq!(error.kind(), Fault::Usage);
        error.to_string()
    };
    assert!(refuse(small_bricks("linear", Some(4))).contains("at most 3 levels"));
    assert!(refuse(small_bricks("none", Some(1))).contains("contradict"));
    assert!(refuse(small_bricks("cubic", Some(0))).contains("contradict"));
    assert!(refuse(CompressOptions { brick: Some([0, 8, 8]), ..Default::default() }).contains("give sides"));
}

/// Samples on a scale.
fn scaled() -> Form {
    Form::Scaled { scale: Scale::try_from((1.0, 0)).unwrap(), integers: wavelift_kernel::SampleType::I16 }
}

/// What a container of one step says, to be told otherwise.
struct Told {
    head: Head,
    step: Step,
    labels: Vec<BrickLabel>,
}

/// A container that says something else, with checksums that are right.
fn with_lies(bytes: &[u8], change: impl Fn(&mut Told)) -> Vec<u8> {
    let container = Container::new(Box::new(bytes.to_vec())).unwrap();
    let (head, step) = (container.head().clone(), container.step(0).unwrap().clone());
    let (labels, stored): (Vec<_>, Vec<_>) = Scanner::new(&bytes)
        .filter_map(|found| match found.unwrap().content {
            Some(Content::Brick { label, stored }) => Some((label, stored)),
            _ => None,
        })
        .unzip();
    let mut told = Told { head, step, labels };
    change(&mut told);
    let mut lie = Vec::new();
    let mut writer = writer::Writer::new(&mut lie, &told.head, container.metadata().unwrap()).unwrap();
    writer.step(&told.step).unwrap();
    for (label, stored) in told.labels.iter().zip(stored) {
        writer.brick(&told.step, label, &stored, None).unwrap();
    }
    writer.end_step().unwrap();
    writer.finish().unwrap();
    lie
}

#[test]
fn records_that_lie_are_refused() {
    let volume = generate(Kind::Waves, [12, 9, 5], ElementType::U16, 3);
    let options = CompressOptions { brick: Some([64; 3]), ..small_bricks("none", None) };
    let (stored, report) = store(&volume, &options);
    assert_eq!(summary(&report).bricks.len(), 1);
    let lies: [&dyn Fn(&mut Told); 17] = [
        &|told| (told.step.channels[0].levels, told.step.channels[0].readable_levels) = (255, 255),
        &|told| told.step.channels[0].wavelet = Some(wavelift_kernel::Wavelet::Linear),
        &|told| told.step.channels[0].readable_levels = 5,
        &|told| told.head.element = ElementType::I16,
        &|told| (told.head.element, told.step.channels[0].readable_levels) = (ElementType::F32, 1),
        &|told| told.head.extent = [u64::MAX; 3],
        &|told| told.head.components = 2,
        &|told| told.head.names = vec!["x".to_owned(), "y".to_owned()],
        &|told| told.step.number = 1,
        &|told| told.step.sides = [u32::MAX; 3],
        &|told| told.labels[0].lengths = vec![u32::MAX, 1],
        &|told| told.labels[0].place.brick = 1,
        &|told| told.labels[0].exceptions = Some(Kept::default()),
        &|told| told.step.channels[0].form = Form::Steps(u64::MAX),
        &|told| told.step.channels[0].form = scaled(),
        &|told| (told.head.element, told.step.channels[0].form) = (ElementType::F32, scaled()),
        &|told| told.step.channels[0].bound = Some(Bound { error: f64::NAN, relative: None }),
    ];
    for (number, lie) in lies.into_iter().enumerate() {
        std::fs::write(&stored.path, with_lies(&stored.bytes, lie)).unwrap();
        for asked in [0, 1, 4, 64, 255] {
            let error = read(&stored.path, &level(asked)).unwrap_err();
            assert!(matches!(error.kind(), Fault::Data | Fault::Usage), "{number} at {asked}: {error}");
            assert!(asked > 4 || error.kind() == Fault::Data, "{number} at {asked}: {error}");
        }
    }
}

/// What is wrong with a file: that it cannot be opened, or all that [`Container::verify`] finds.
fn faults(bytes: &[u8]) -> Vec<ContainerError> {
    match Container::new(Box::new(bytes.to_vec())) {
        Err(error) => vec![error],
        Ok(container) => {
            let found = Mutex::new(Vec::new());
            container.verify(None, &ignore, &|error| found.lock().unwrap().push(error)).unwrap();
            found.into_inner().unwrap()
        }
    }
}

/// Damages every so many bytes: it is always noticed, and samples that are read all the same are right.
fn damage_is_noticed(stored: &Stored, every: usize) {
    assert!(faults(&stored.bytes).is_empty());
    let read = |bytes: &[u8]| Container::new(Box::new(bytes.to_vec()))?.read(&Part::default(), None, &ignore);
    let whole = read(&stored.bytes).unwrap();
    for at in (0..stored.bytes.len()).step_by(every) {
        let mut bytes = stored.bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        let faults = faults(&bytes);
        assert!(!faults.is_empty() && faults.iter().all(|fault| fault.kind() == Fault::Data), "{at}");
        match read(&bytes) {
            Err(error) => assert_eq!(error.kind(), Fault::Data),
            // Statistics and copies are not looked at to read samples.
            Ok(read) => assert_eq!(read, whole, "{at}"),
        }
    }
}

#[test]
fn every_damaged_byte_and_every_truncation_is_noticed() {
    let volume = generate(Kind::Blobs, [12, 9, 5], ElementType::U16, 3);
    let (stored, _) = store(&volume, &small_bricks("auto", None));
    damage_is_noticed(&stored, 1);
    let longer = [stored.bytes.clone(), vec![0]].concat();
    for bytes in (0..stored.bytes.len()).map(|len| &stored.bytes[..len]).chain([&longer[..]]) {
        assert_eq!(faults(bytes)[0].kind(), Fault::Data);
    }
}

#[test]
fn every_effort_comes_back() {
    let volume = generate(Kind::Waves, [40, 30, 20], ElementType::U16, 3);
    let bytes = Effort::ALL.map(|effort| {
        let (stored, report) = store(&volume, &CompressOptions { effort, ..CompressOptions::default() });
        assert_eq!(channel(&report).effort, effort);
        assert_eq!(Container::open(&stored.path).unwrap().step(0).unwrap().channels[0].effort, effort);
        assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume);
        report.container_bytes
    });
    let [_, fast, default, dense] = bytes;
    assert!(dense <= default && dense <= fast, "{bytes:?}");
}
