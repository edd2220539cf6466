//! Data sets of several components and time steps, in any amount of memory, and sources that misbehave.

use std::sync::{Arc, Mutex};

use super::bounds::absolute;
use super::*;
use crate::volume::{Header, InMemory, Metadata, ReadError, Sink, Source, WriteError};

/// Values of waves and of noise, in the order of a file.
fn values(header: &Header) -> Vec<u8> {
    let kinds = [Kind::Waves, Kind::Blobs, Kind::Noise, Kind::Constant];
    let size = header.element.bytes();
    let mut values = Vec::new();
    for step in 0..header.steps {
        let volumes: Vec<Volume> = (0..header.components)
            .map(|c| {
                generate(kinds[(step as usize + c as usize) % 4], header.extent, header.element, step + 1)
            })
            .collect();
        for at in (0..volumes[0].samples.len()).step_by(size) {
            volumes.iter().for_each(|volume| values.extend_from_slice(&volume.samples[at..at + size]));
        }
    }
    values
}

fn header(extent: [u64; 3], components: u32, steps: u64, element: ElementType) -> Header {
    Header { extent, components, steps, element, metadata: Metadata::default() }
}

/// A source that cannot go back at little cost, as a compressed file.
struct Slow<'a> {
    inner: InMemory<'a>,
    at: u64,
}

impl Source for Slow<'_> {
    fn header(&self) -> &Header {
        self.inner.header()
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        self.at += out.len() as u64;
        self.inner.read(out)
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        assert!(position >= self.at, "it goes back");
        self.at = position;
        self.inner.seek(position)
    }

    fn is_random(&self) -> bool {
        false
    }
}

/// A sink that keeps what it gets.
struct Kept(Vec<u8>, Arc<Mutex<Vec<u8>>>);

impl Sink for Kept {
    fn write(&mut self, values: &[u8]) -> Result<(), WriteError> {
        self.0.extend_from_slice(values);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        *self.1.lock().unwrap() = self.0;
        Ok(())
    }
}

fn compressed(source: &mut dyn Source, options: &CompressOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    let report = compress_stream(source, options, &mut bytes, &ignore).unwrap();
    assert_eq!(report.container_bytes, bytes.len() as u64);
    bytes
}

fn open(bytes: &[u8]) -> Container {
    Container::new(Box::new(bytes.to_vec())).unwrap()
}

fn decompressed(container: &Container, part: &Part, memory: u64) -> Vec<u8> {
    let kept = Arc::default();
    let options = DecompressOptions { threads: NonZeroUsize::new(2), memory: Some(memory) };
    container.decompress(part, Box::new(Kept(Vec::new(), Arc::clone(&kept))), &options, &ignore).unwrap();
    std::mem::take(&mut *kept.lock().unwrap())
}

#[test]
fn every_type_comes_back_whatever_the_memory() {
    for (i, element) in ElementType::ALL.into_iter().enumerate() {
        for extent in [[1, 1, 1], [7, 1, 1], [19, 9, 6], [5, 17, 1], [9, 8, 13]] {
            let header = header(extent, 1 + (i % 3) as u32, 1 + i as u64 % 2, element);
            let values = values(&header);
            let source = || InMemory::of(header.clone(), &values).unwrap();
            let options = |memory, threads| CompressOptions {
                memory: Some(memory),
                threads: NonZeroUsize::new(threads),
                tolerance: if i % 2 == 0 { None } else { absolute(1e-2) },
                ..small_bricks("auto", None)
            };
            let bytes = compressed(&mut source(), &options(1 << 30, 1));
            for (memory, threads) in [(0, 4), (100 << 10, 2), (1 << 20, 3)] {
                assert!(
                    compressed(&mut source(), &options(memory, threads)) == bytes,
                    "{element} {extent:?}"
                );
                let mut slow = Slow { inner: source(), at: 0 };
                assert!(compressed(&mut slow, &options(memory, threads)) == bytes, "{element} {extent:?}");
            }
            let container = open(&bytes);
            assert!(faults(&bytes).is_empty());
            let whole = container.read_values(&Part::default(), None, &ignore).unwrap();
            if i % 2 == 0 {
                assert!(whole == values, "{element} {extent:?}");
            }
            for memory in [0, 1 << 10, 1 << 30] {
                assert!(decompressed(&container, &Part::default(), memory) == whole);
            }
        }
    }
}

#[test]
fn in_memory_and_streamed_are_the_same_bytes() {
    let volume = generate(Kind::Waves, [40, 30, 20], ElementType::I16, 3);
    let (stored, _) = store(&volume, &small_bricks("auto", None));
    let mut source = Slow { inner: InMemory::new(&volume).unwrap(), at: 0 };
    let options = CompressOptions { memory: Some(0), ..small_bricks("auto", None) };
    assert!(compressed(&mut source, &options) == stored.bytes);
}

/// What `part` should be of all values at full resolution, or of those of a level.
fn cut(all: &Header, values: &[u8], part: &Part, from: [u64; 3], to: [u64; 3]) -> Vec<u8> {
    let (size, [width, height, depth]) = (all.element.bytes() as u64, all.extent);
    let mut cut = Vec::new();
    for step in (0..all.steps).filter(|step| part.step.is_none_or(|wanted| wanted == *step)) {
        for (z, y) in (from[2]..to[2]).flat_map(|z| (from[1]..to[1]).map(move |y| (z, y))) {
            for x in from[0]..to[0] {
                for c in (0..all.components).filter(|c| part.component.is_none_or(|wanted| wanted == *c)) {
                    let sample = ((step * depth + z) * height + y) * width + x;
                    let at = ((sample * u64::from(all.components) + u64::from(c)) * size) as usize;
                    cut.extend_from_slice(&values[at..at + size as usize]);
                }
            }
        }
    }
    cut
}

#[test]
fn parts_are_those_of_the_whole_at_every_level() {
    let header = header([21, 17, 13], 3, 2, ElementType::U16);
    let values = values(&header);
    for wavelet in ["haar", "none"] {
        let options = small_bricks(wavelet, None);
        let container = open(&compressed(&mut InMemory::of(header.clone(), &values).unwrap(), &options));
        for level in 0..=2 {
            let whole = Part { level, ..Part::default() };
            let coarse = container.header_of(&whole).unwrap();
            let coarse_values = container.read_values(&whole, None, &ignore).unwrap();
            for (step, component) in [(None, None), (Some(1), None), (None, Some(2)), (Some(0), Some(1))] {
                for (from, to) in [([0; 3], [21, 17, 13]), ([3, 8, 2], [14, 17, 5]), ([4, 4, 4], [5, 9, 13])]
                {
                    let part = Part { level, region: Some(Region { from, to }), step, component };
                    let scale = |position: u64| position.div_ceil(1 << level);
                    let expected = cut(&coarse, &coarse_values, &part, from.map(scale), to.map(scale));
                    let read = container.read_values(&part, None, &ignore).unwrap();
                    assert!(read == expected, "{wavelet} {part:?}");
                    assert!(decompressed(&container, &part, 1 << 10) == expected, "{wavelet} {part:?}");
                    assert_eq!(container.values(&part), expected.len() as u64 / 2);
                }
            }
        }
    }
}

#[test]
fn steps_that_are_appended_are_as_if_they_had_been_there() {
    let whole = header([19, 9, 6], 2, 3, ElementType::F32);
    let values = values(&whole);
    let step_bytes = values.len() / 3;
    let step = header([19, 9, 6], 2, 1, ElementType::F32);
    let options = small_bricks("auto", None);
    let mut bytes = compressed(&mut InMemory::of(step.clone(), &values[..step_bytes]).unwrap(), &options);
    for number in 1..3 {
        let container = open(&bytes);
        let mut source = InMemory::of(step.clone(), &values[number * step_bytes..][..step_bytes]).unwrap();
        let mut longer = Vec::new();
        let report = append(&container, &mut source, &options, &mut longer, &ignore).unwrap();
        assert_eq!((report.steps[0].number, report.container_bytes), (number as u64, longer.len() as u64));
        bytes = longer;
    }
    assert!(bytes == compressed(&mut InMemory::of(whole, &values).unwrap(), &options));
    let container = open(&bytes);
    let other = header([19, 9, 5], 2, 1, ElementType::F32);
    let mut other = InMemory::of(other, &values[..step_bytes / 6 * 5]).unwrap();
    let error = append(&container, &mut other, &options, &mut Vec::new(), &ignore).unwrap_err();
    assert_eq!(error.kind(), Fault::Usage);
}

#[test]
fn every_damaged_byte_of_many_components_is_noticed() {
    let header = header([9, 5, 3], 2, 2, ElementType::I16);
    let values = values(&header);
    let options = CompressOptions {
        names: vec!["u".to_owned(), "v".to_owned()],
        labels: vec![Label { name: Some("first".to_owned()), time: Some(0.5) }],
        brick: Some([8, 8, 8]),
        ..CompressOptions::default()
    };
    let bytes = compressed(&mut InMemory::of(header, &values).unwrap(), &options);
    let container = open(&bytes);
    assert_eq!(container.head().names, ["u", "v"]);
    let step = container.step(0).unwrap();
    assert_eq!((step.name.as_deref(), step.time), (Some("first"), Some(0.5)));
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(!faults(&damaged).is_empty(), "{at}");
        // All bricks but one at most are found without the index.
        let bricks = Scanner::new(&damaged)
            .filter(|found| matches!(found.as_ref().unwrap().content, Some(Content::Brick { .. })));
        assert!(bricks.count() >= 7, "{at}");
    }
}

#[test]
fn damaged_metadata_leave_the_samples_as_they_are() {
    let volume = generate(Kind::Waves, [16, 8, 4], ElementType::U16, 1);
    let (stored, _) = store(&volume, &small_bricks("none", None));
    let mut place = Scanner::new(&stored.bytes).map(|found| found.unwrap());
    let place = place.find(|found| matches!(found.content, Some(Content::Metadata(_)))).unwrap().bytes;
    let mut damaged = stored.bytes.clone();
    damaged[place.end as usize - 1] ^= 1;
    let container = open(&damaged);
    assert!(container.read_values(&Part::default(), None, &ignore).unwrap() == volume.samples);
    assert!(matches!(container.metadata(), Err(ContainerError::Record { what: "metadata", .. })));
    assert_eq!(faults(&damaged).len(), 1);
}

/// A source that says something else when it is read again.
struct Changing<'a> {
    inner: InMemory<'a>,
    reads: usize,
}

impl Source for Changing<'_> {
    fn header(&self) -> &Header {
        self.inner.header()
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        self.inner.read(out)?;
        self.reads += 1;
        if self.reads > 1 {
            out[0] = out[0].wrapping_add(1);
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.inner.seek(position)
    }

    fn is_random(&self) -> bool {
        true
    }
}

#[test]
fn an_input_that_changes_is_refused() {
    for (kind, wavelet) in [(Kind::Waves, "none"), (Kind::Constant, "none"), (Kind::Noise, "haar")] {
        let volume = generate(kind, [16, 16, 16], ElementType::U16, 1);
        let mut source = Changing { inner: InMemory::new(&volume).unwrap(), reads: 0 };
        let error = compress_stream(&mut source, &small_bricks(wavelet, None), &mut Vec::new(), &ignore);
        assert!(matches!(error.unwrap_err(), CompressError::Changed));
    }
}

#[test]
fn work_can_be_stopped() {
    use std::ops::ControlFlow::Break;
    let volume = generate(Kind::Waves, [40, 30, 20], ElementType::U16, 1);
    let stopped = compress(&volume, &small_bricks("none", None), &mut Vec::new(), &|_| Break(()));
    assert!(matches!(stopped.unwrap_err(), CompressError::Stopped(_)));
    let (stored, _) = store(&volume, &small_bricks("none", None));
    let container = open(&stored.bytes);
    let stopped = container.read(&Part::default(), None, &|_| Break(()));
    assert!(matches!(stopped.unwrap_err(), ContainerError::Stopped(_)));
    let stopped = container.verify(None, &|_| Break(()), &|_| ());
    assert!(matches!(stopped.unwrap_err(), ContainerError::Stopped(_)));
}

#[test]
fn originals_are_compared_value_by_value() {
    let header = header([19, 9, 6], 2, 2, ElementType::U16);
    let mut values = values(&header);
    let bytes = compressed(&mut InMemory::of(header.clone(), &values).unwrap(), &small_bricks("auto", None));
    let container = open(&bytes);
    let compare = |values: &[u8], memory| {
        let mut original = InMemory::of(header.clone(), values).unwrap();
        let options = DecompressOptions { threads: None, memory: Some(memory) };
        container.compare(&mut original, &options, &ignore, &|error| panic!("{error}")).unwrap()
    };
    assert_eq!(compare(&values, 0), Comparison::default());
    let sample = 19 * 9 * 6 + (3 * 9 + 2) * 19 + 1;
    for later in [0, 19, 400] {
        values[(sample + later) * 4 + 3] ^= 1;
    }
    let expected = Difference { step: 1, sample: [3, 2, 1], component: 1, bound: None };
    for memory in [0, 1 << 12, 1 << 30] {
        assert_eq!(compare(&values, memory).difference, Some(expected));
    }
}
