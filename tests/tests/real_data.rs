//! Measured and simulated volumes, slices and terrains come back bit for bit, where a collection of them is at hand.
//!
//! The collection is the folder that `WAVELIFT_DATA` names, or `../shared/data` beside the repository. Its
//! `MANIFEST.tsv` has one file a line, after a line with the names of the columns.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use conformance::effort::Effort;
use conformance::lent;
use conformance::streams::{Pieces, encode};
use wavelift_host::codec::{self, Choice, CompressOptions, Container, Part};
use wavelift_host::progress::ignore;
use wavelift_host::volume::{self, ElementType, FileFormat, Metadata, RankedExtent, RawLayout, Volume};
use wavelift_kernel::stream::RowPlan;
use wavelift_kernel::{Codec, Extent, Plan, SampleType, Wavelet};

/// Most samples along each axis that are taken from the middle of a volume, and of a slice.
const MOST: [u64; 2] = [96, 512];

fn folder() -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    std::env::var_os("WAVELIFT_DATA").map_or_else(beside, PathBuf::from)
}

/// Files that are no meshes, with their layouts.
fn files(manifest: &str) -> Vec<(String, RawLayout)> {
    let mut lines = manifest.lines();
    let names: Vec<&str> = lines.next().expect("names of the columns").split('\t').collect();
    let column = |name| names.iter().position(|found| *found == name).expect("a column of that name");
    let [file, kind, extent, element] = ["file", "kind", "extent", "type"].map(column);
    let fields = lines.map(|line| line.split('\t').collect::<Vec<_>>());
    let volumes = fields.filter(|fields| fields[kind] != "mesh");
    let layouts = volumes.map(|fields| {
        let (extent, element) =
            (fields[extent].parse().expect("an extent"), fields[element].parse().expect("a type"));
        (fields[file].to_owned(), RawLayout::new(extent, element))
    });
    layouts.collect()
}

/// The middle of a volume.
fn middle(whole: &Volume) -> Volume {
    let most = if whole.extent[2] > 1 { MOST[0] } else { MOST[1] };
    let extent = whole.extent.map(|axis| axis.min(most));
    let [from_x, from_y, from_z] = [0, 1, 2].map(|axis| (whole.extent[axis] - extent[axis]) / 2);
    let [nx, ny, _] = whole.extent;
    let (bytes, width) = (whole.element.bytes(), extent[0] as usize);
    let mut samples = Vec::new();
    for z in from_z..from_z + extent[2] {
        for y in from_y..from_y + extent[1] {
            let start = (from_x + nx * (y + ny * z)) as usize * bytes;
            samples.extend(&whole.samples[start..start + width * bytes]);
        }
    }
    Volume { extent, element: whole.element, samples, metadata: whole.metadata.clone() }
}

/// Compresses and reads back; what was chosen, and bits a sample.
fn round_trip(original: &Volume, wavelet: Choice, path: &Path) -> String {
    let options = CompressOptions { wavelet, ..CompressOptions::default() };
    let mut file = File::create(path).expect("the folder takes files");
    let report =
        codec::compress(original, &options, &mut file, &ignore).expect("any volume can be compressed");
    let container = Container::open(path).expect("what was written is whole");
    let back = container.read(&Part::default(), None, &ignore).expect("what was written can be read");
    assert!(back == *original, "{}: other samples", path.display());
    let samples: u64 = original.extent.iter().product();
    assert_eq!(fs::metadata(path).expect("the file is there").len(), report.container_bytes);
    let wavelet = report.steps[0].channels[0].wavelet.map_or("none", Wavelet::name);
    format!("{wavelet} {:.3}", 8.0 * report.container_bytes as f64 / samples as f64)
}

#[test]
fn every_file_of_the_collection_comes_back() {
    let collection = folder();
    let Ok(manifest) = fs::read_to_string(collection.join("MANIFEST.tsv")) else {
        println!("skipped: no collection of volumes beside the repository, and WAVELIFT_DATA names none");
        return;
    };
    let choices = Wavelet::ALL.map(Choice::Wavelet).into_iter().chain([Choice::None, Choice::Auto]);
    let scratch = tempfile::tempdir().expect("a temporary folder");
    let files = files(&manifest);
    assert!(!files.is_empty(), "the collection holds nothing");
    for ((name, layout), choice) in files.iter().zip(choices.cycle()) {
        let whole =
            volume::read(collection.join(name), Some(layout)).unwrap_or_else(|error| panic!("{error}"));
        let original = middle(&whole);
        let told = round_trip(&original, choice, &scratch.path().join("a.wlift"));
        println!("{name} {:?}: {told} bits a sample", original.extent);
    }
    println!("{} files", files.len());
}

#[test]
fn the_middle_is_cut_out_sample_by_sample() {
    let extent: RankedExtent = "100x98x97".parse().expect("an extent");
    let samples: Vec<u8> = (0..extent.samples()).flat_map(|index| (index as u32).to_le_bytes()).collect();
    let metadata = Metadata::plain(3, FileFormat::Raw);
    let whole = Volume { extent: extent.axes(), element: volume::ElementType::U32, samples, metadata };
    let cut = middle(&whole);
    assert_eq!(cut.extent, [96; 3]);
    assert_eq!(cut.samples.len(), 4 * 96 * 96 * 96);
    assert_eq!(cut.samples[..4], 102_u32.to_le_bytes());
    assert_eq!(cut.samples[cut.samples.len() - 4..], (97 + 100 * (96 + 98 * 95_u32)).to_le_bytes());
}

/// The slice in the middle of a volume of integers of up to 16 bits.
fn middle_slice(volume: &Volume) -> Option<(SampleType, [u32; 2], Vec<i32>)> {
    let sample_type = match volume.element {
        ElementType::U8 => SampleType::U8,
        ElementType::U16 => SampleType::U16,
        ElementType::I16 => SampleType::I16,
        _ => return None,
    };
    let bytes = volume.element.bytes();
    let [x, y, z] = volume.extent;
    let slice = (x * y) as usize * bytes;
    let samples =
        volume.samples[(z / 2) as usize * slice..][..slice].chunks_exact(bytes).map(|sample| {
            match (sample, sample_type) {
                (&[low], _) => i32::from(low),
                (&[low, high], SampleType::I16) => i32::from(i16::from_le_bytes([low, high])),
                (sample, _) => i32::from(u16::from_le_bytes([sample[0], sample[1]])),
            }
        });
    Some((sample_type, [x as u32, y as u32], samples.collect()))
}

/// As the codec makes the whole slice without training, within 3 in 100: under every wavelet. What training, which
/// takes the whole slice, and predictions from a coarser level would save is told.
#[test]
fn slices_that_come_row_by_row_take_no_more() {
    let folder = folder();
    let Ok(manifest) = fs::read_to_string(folder.join("MANIFEST.tsv")) else {
        println!("skipped: no collection at {}", folder.display());
        return;
    };
    let (mut grown, mut untrained) = (Vec::new(), Vec::new());
    for (name, layout) in files(&manifest) {
        let whole = volume::read(folder.join(&name), Some(&layout)).expect("it can be read");
        let Some((sample_type, [width, height], samples)) = middle_slice(&whole) else { continue };
        for wavelet in Wavelet::ALL {
            let extent = Extent::slice(width, height).expect("an extent");
            let plan = Plan::new(wavelet, extent, 3).expect("levels that it has");
            let [whole, trained] = [Effort::Fast, Effort::Default]
                .map(|effort| lent::encode(&mut { Codec::NEW }, effort, &plan, sample_type, &samples).len());
            let plan = RowPlan::new(wavelet, width, 3, sample_type).expect("a plan of rows");
            let stream = encode(&plan, &samples, Pieces::Whole).len() as f64;
            let more = stream / whole as f64 - 1.0;
            // A header and a strip's end weigh as much in a few bytes.
            assert!(more <= 0.03 || whole < 1000, "{name}, {wavelet}: {more}");
            grown.push((more, format!("{name}, {wavelet}")));
            untrained.push((stream / trained as f64 - 1.0, format!("{name}, {wavelet}")));
        }
    }
    for (effort, mut more) in [(Effort::Fast, grown), (Effort::Default, untrained)] {
        more.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let (count, middle) = (more.len(), &more[more.len() / 2]);
        println!("{count} slices, to {effort:?}: {middle:?} in the median, at most {:?}", more.last());
    }
}
