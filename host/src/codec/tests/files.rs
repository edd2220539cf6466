//! Files made in one call, or piece by piece.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use super::*;
use crate::volume::{Fault, Header, InMemory, Metadata};

/// Samples of three time steps of two components.
fn values() -> (Header, Vec<u16>) {
    let metadata = Metadata::default();
    let header = Header { extent: [13, 9, 5], components: 2, steps: 3, element: ElementType::U16, metadata };
    let values = (0..13 * 9 * 5 * 2 * 3).map(|value: u16| value.wrapping_mul(value) / 7);
    (header, values.collect())
}

/// A file of the first `steps` time steps, made in one call.
fn at_once(path: &Path, steps: u64, options: &CompressOptions) -> Report {
    let (header, values) = values();
    let header = Header { steps, ..header };
    let bytes = &bytemuck::cast_slice(&values)[..header.bytes().unwrap() as usize];
    compress_file(path, &mut InMemory::of(header, bytes).unwrap(), options, &ignore).unwrap()
}

#[test]
fn pieces_make_the_same_file_as_all_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, pieces] = ["whole", "pieces"].map(|name| folder.path().join(name));
    let (header, values) = values();
    let report = at_once(&whole, 3, &small_bricks("auto", None));
    for (memory, piece) in [(0, 1), (1 << 30, 700), (1 << 30, values.len())] {
        let options = CompressOptions { memory: Some(memory), ..small_bricks("auto", None) };
        let mut writer = StepWriter::create(&pieces, &header, &options, &ignore).unwrap();
        values.chunks(piece).for_each(|piece| writer.write(piece).unwrap());
        // What is not finished is not there.
        assert!(!pieces.exists());
        assert_eq!(writer.finish().unwrap(), report);
        assert!(fs::read(&whole).unwrap() == fs::read(&pieces).unwrap());
        fs::remove_file(&pieces).unwrap();
    }
}

/// Values of a region of one time step, in the order of the file.
fn of_region(header: &Header, step: &[u16], Region { from, to }: Region) -> Vec<u16> {
    let ([width, height, _], components) = (header.extent, u64::from(header.components));
    let mut values = Vec::new();
    for (z, y) in (from[2]..to[2]).flat_map(|z| (from[1]..to[1]).map(move |y| (z, y))) {
        let row = (z * height + y) * width;
        let [first, last] = [from[0], to[0]].map(|x| ((row + x) * components) as usize);
        values.extend_from_slice(&step[first..last]);
    }
    values
}

#[test]
fn regions_in_any_order_make_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, regions] = ["whole", "regions"].map(|name| folder.path().join(name));
    let (header, values) = values();
    let report = at_once(&whole, 3, &small_bricks("auto", None));
    let bricks: Vec<Brick> = Grid::new(header.extent, [4, 5, 3]).unwrap().iter().collect();
    for memory in [0, 1 << 30] {
        let options = CompressOptions { memory: Some(memory), ..small_bricks("auto", None) };
        let mut writer = StepWriter::create(&regions, &header, &options, &ignore).unwrap();
        let steps: Vec<&[u16]> = values.chunks(1170).collect();
        for &brick in bricks.iter().rev() {
            writer.write_region(brick, &of_region(&header, steps[0], brick.into())).unwrap();
        }
        // The next step in order, and the last as one region without ends.
        writer.write(steps[1]).unwrap();
        writer.write_region([0..u64::MAX, 0..u64::MAX, 0..u64::MAX], steps[2]).unwrap();
        assert_eq!(writer.finish().unwrap(), report);
        assert!(fs::read(&whole).unwrap() == fs::read(&regions).unwrap());
    }
}

#[test]
fn regions_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wlift");
    let (header, values) = values();
    let options = small_bricks("auto", None);
    let create = || StepWriter::create(&path, &header, &options, &ignore).unwrap();
    let refused = |mut writer: StepWriter<'_>, region: [std::ops::Range<u64>; 3], count| {
        let error = writer.write_region(region, &values[..count]).unwrap_err();
        assert!(matches!(writer.finish(), Err(CompressError::AfterError)));
        error
    };
    let begun = || {
        let mut writer = create();
        writer.write_region([0..2, 0..3, 0..4], &values[..48]).unwrap();
        writer
    };
    let outside = refused(create(), [10..14, 0..1, 0..1], 8);
    assert!(matches!(outside, CompressError::OutsideVolume { extent: [13, 9, 5], .. }));
    assert!(matches!(refused(create(), [0..0, 0..1, 0..1], 0), CompressError::OutsideVolume { .. }));
    let twice = refused(begun(), [1..3, 2..3, 3..4], 4);
    assert!(matches!(twice, CompressError::WrittenBefore { region } if region.from == [1, 2, 3]));
    assert!(matches!(
        refused(begun(), [2..4, 0..1, 0..1], 5),
        CompressError::SampleBytes { expected: 8, actual: 10 }
    ));
    let mut writer = create();
    writer.write(&values[..3]).unwrap();
    assert!(matches!(refused(writer, [2..4, 0..1, 0..1], 4), CompressError::MixedOrder));
    let mut writer = begun();
    writer.write::<u16>(&[]).unwrap();
    assert!(matches!(writer.write(&values[..1]), Err(CompressError::MixedOrder)));
    assert!(matches!(begun().finish(), Err(CompressError::UnfinishedStep { found: 96, .. })));
}

#[test]
fn steps_are_called_as_was_said_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wlift");
    let (header, values) = values();
    let label = |name: &str, time| Label { name: Some(name.to_owned()), time };
    let labels = vec![label("first", Some(0.5)), label("second", None)];
    let options = CompressOptions { labels, ..small_bricks("auto", None) };
    let mut writer = StepWriter::create(&path, &header, &options, &ignore).unwrap();
    writer.write(&values[..1170]).unwrap();
    writer.label(label("other", Some(1.5)));
    writer.write(&values[1170..]).unwrap();
    let said = writer.finish().unwrap().steps.into_iter().map(|step| (step.name, step.time));
    let expected =
        [(Some("first".to_owned()), Some(0.5)), (Some("other".to_owned()), Some(1.5)), (None, None)];
    assert!(said.eq(expected));
}

#[test]
fn steps_follow_those_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, longer, pieces] = ["whole", "longer", "pieces"].map(|name| folder.path().join(name));
    let options = small_bricks("auto", None);
    at_once(&whole, 3, &options);
    at_once(&longer, 2, &options);
    fs::copy(&longer, &pieces).unwrap();
    let (header, values) = values();
    let third = Header { steps: 1, ..header };
    let last = &values[2 * 1170..];
    let mut source = InMemory::of(third.clone(), bytemuck::cast_slice(last)).unwrap();
    let report = append_file(&longer, &mut source, &options, &ignore).unwrap();
    assert_eq!(report.steps.len(), 1);
    let mut writer = StepWriter::append(&pieces, &third, &options, &ignore).unwrap();
    writer.write(last).unwrap();
    assert_eq!(writer.finish().unwrap(), report);
    let whole = fs::read(whole).unwrap();
    assert!(fs::read(&longer).unwrap() == whole && fs::read(&pieces).unwrap() == whole);

    let other = Header { components: 1, ..third };
    let refused = StepWriter::append(&pieces, &other, &options, &ignore);
    let told = refused.unwrap_err().to_string();
    assert!(told.contains("pieces: they hold 13x9x5 u16 of 2 components, the input 13x9x5 u16"), "{told}");
    assert!(matches!(
        append_file(&longer, &mut InMemory::of(other, bytemuck::cast_slice(&last[..585])).unwrap(), &options, &ignore),
        Err(CompressError::OtherSteps { file, .. }) if file.ends_with("longer")
    ));
    let missing = append_file(folder.path().join("none"), &mut source, &options, &ignore).unwrap_err();
    assert_eq!(missing.kind(), Fault::Io);
    assert!(missing.to_string().contains("none: cannot read: "), "{missing}");
}

#[test]
fn nothing_is_written_after_an_error_or_without_all_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wlift");
    let (header, values) = values();
    let options = small_bricks("auto", None);
    let create = || StepWriter::create(&path, &header, &options, &ignore).unwrap();
    assert!(matches!(create().finish(), Err(CompressError::UnfinishedStep { expected: 2340, found: 0 })));
    let mut writer = create();
    writer.write(&values[..1171]).unwrap();
    assert!(matches!(writer.finish(), Err(CompressError::UnfinishedStep { found: 2, .. })));

    let mut writer = create();
    assert!(matches!(writer.write(&[0.5_f32]), Err(CompressError::WrongType { .. })));
    assert!(matches!(writer.write(&values), Err(CompressError::AfterError)));
    assert!(matches!(writer.finish(), Err(CompressError::AfterError)));

    let stop = |_| ControlFlow::Break(());
    let mut writer = StepWriter::create(&path, &header, &options, &stop).unwrap();
    writer.write(&values[..1169]).unwrap();
    assert!(matches!(writer.write(&values[1169..]), Err(CompressError::Stopped(_))));
    drop(writer);

    let empty = Header { extent: [4, 0, 4], ..header.clone() };
    let refused = StepWriter::create(&path, &empty, &options, &ignore).unwrap_err();
    assert!(refused.to_string().contains("4x0x4"), "{refused}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let nowhere = StepWriter::create(folder.path().join("none/a"), &header, &options, &ignore).unwrap_err();
    assert!(nowhere.to_string().contains("none/a: cannot write: the folder"), "{nowhere}");
}
