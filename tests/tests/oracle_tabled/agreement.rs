//! What one writes, the other reads.

use std::collections::BTreeMap;

use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::encode;
use conformance::oracle::coder::SampleType;
use conformance::oracle::noise::Noise;
use conformance::oracle::tabled::{self, Breadth, CLASSES, Form, Model, Segment, bounds, fit};
use conformance::reference::sides;
use conformance::vectors::Manifest;
use wavelift_kernel::{Codec, Extent, Header, Plan, Wavelet};

use crate::{both, oracle, random_model, written};

/// Of 2^14 samples or more, of which the kernel writes a table.
const EXTENTS: [[u32; 3]; 17] = [
    [128, 128, 1],
    [129, 131, 1],
    [1, 16_387, 1],
    [2, 8_193, 1],
    [8_194, 2, 1],
    [1, 1, 16_385],
    [1, 131, 127],
    [130, 1, 127],
    [8_193, 1, 2],
    [26, 25, 27],
    [3, 74, 75],
    [4, 65, 64],
    [5, 2, 1_640],
    [6, 2_731, 1],
    [7, 49, 48],
    [67, 123, 2],
    [1_366, 3, 4],
];

/// Inputs and types that are tabled: what is left of them is not nearly as wide as the type.
fn inputs(breadth: Breadth) -> Vec<(Input, SampleType)> {
    let waves = |amplitude, offset| Input::Waves { periods: [230, 170, 130], amplitude, offset };
    let [low, high, bits] = match breadth {
        Breadth::Narrow => [260_000, 200_000, 19],
        Breadth::Wide | Breadth::Celled => [32_000, 27_000, 16],
    };
    vec![
        (waves(100, 128), SampleType::U8),
        (waves(120, 0), SampleType::I8),
        (waves(30_000, 32_768), SampleType::U16),
        (waves(20_000, -1000), SampleType::I16),
        (waves(low, -2_147_000_000), SampleType::I32),
        (waves(high, 4_000_000_000), SampleType::U32),
        (Input::Steps { width: 9, height: 1, offset: -900 }, SampleType::I16),
        (Input::Noise { bits: 7, offset: -100, seed: 4 }, SampleType::I8),
        (Input::Noise { bits: bits as u32, offset: -400_000, seed: 5 }, SampleType::I32),
        (Input::Sparse { one_in: 40, bits: 12, seed: 6 }, SampleType::U16),
        (Input::Constant { value: -77 }, SampleType::I8),
    ]
}

fn kernel_type(sample_type: SampleType) -> wavelift_kernel::SampleType {
    let index = SampleType::ALL.iter().position(|&t| t == sample_type);
    wavelift_kernel::SampleType::ALL[index.expect("all are listed")]
}

/// Where the one segment begins: after magic, version, storage, type, levels and four numbers.
fn segment_of(bytes: &[u8]) -> &[u8] {
    let mut last_bytes = bytes.iter().enumerate().skip(6).filter(|(_, byte)| **byte < 0x80);
    let (last, _) = last_bytes.nth(3).expect("extent and length");
    &bytes[last + 1..]
}

#[test]
fn what_the_kernel_writes_is_read() {
    let mut codec = Codec::NEW;
    for (breadth, effort) in [(Breadth::Narrow, Effort::Tabled), (Breadth::Celled, Effort::Wide)] {
        for axes in EXTENTS {
            for (input, sample_type) in inputs(breadth) {
                let extent = Extent::new(axes).expect("an extent");
                let plan = Plan::new(Wavelet::Haar, extent, 0).expect("a plan");
                let samples = input.generate(extent).expect("a generator");
                let bytes = encode(&mut codec, effort, &plan, kernel_type(sample_type), &samples);
                assert_eq!(bytes[3], breadth.storage(), "{axes:?} {input:?} is tabled");
                let found = oracle(segment_of(&bytes), Form { breadth, extent: sides(extent) }, sample_type);
                assert!(found == Ok(samples), "{axes:?} {input:?} {sample_type:?}: {:?}", found.err());
            }
        }
    }
}

/// Which is as large as those of the encoders of before.
#[test]
fn what_encoders_of_today_no_longer_write_is_read() {
    let (mut noise, breadth) = (Noise::new(7), Breadth::Wide);
    for (axes, (input, sample_type)) in EXTENTS.into_iter().zip(inputs(breadth).into_iter().cycle()) {
        let samples = input.generate(Extent::new(axes).expect("an extent")).expect("a generator");
        let form = Form { breadth, extent: axes.map(|n| n as usize) };
        let segment = written(&samples, form, random_model(form, &mut noise));
        assert!(both(&segment, form, sample_type) == Ok(samples), "{form:?} {input:?}");
    }
}

/// Samples of a slice of 512 columns and rows: its left half goes on down its columns, its right half along its rows.
fn two_textures() -> Vec<i32> {
    let mut noise = Noise::new(8);
    let mut samples: Vec<i32> = Vec::new();
    for (at, step) in noise.within(50, 512 * 512).into_iter().enumerate() {
        let (x, y) = (at % 512, at / 512);
        let back = if x < 256 { y.min(1) * 512 } else { x.min(1) };
        samples.push(if back > 0 { samples[at - back] + step } else { step });
    }
    samples
}

/// One set where all cells are alike, and several where they differ.
#[test]
fn sets_for_cells_of_the_kernel_are_read() {
    let extent = Extent::slice(512, 512).expect("an extent");
    let plan = Plan::new(Wavelet::Haar, extent, 0).expect("a plan");
    let form = Form { breadth: Breadth::Celled, extent: sides(extent) };
    let steps = Input::Steps { width: 9, height: 1, offset: -900 }.generate(extent).expect("a generator");
    let sets = [steps, two_textures()].map(|samples| {
        let sample_type = SampleType::I16;
        let bytes = encode(&mut { Codec::NEW }, Effort::Wide, &plan, kernel_type(sample_type), &samples);
        let (_, model) = Segment::parse(segment_of(&bytes), form).expect("a sound one");
        let found = oracle(segment_of(&bytes), form, sample_type);
        assert!(found == Ok(samples), "{} sets", model.weights.len());
        model.weights.len()
    });
    assert!(sets[0] == 1 && sets[1] > 1, "{sets:?}");
}

/// Borders of cells, as many as there may be, and more than that if they were not larger.
#[test]
fn sets_for_cells_are_read() {
    let mut noise = Noise::new(9);
    let few = [[31, 16], [32, 17], [33, 16], [65, 33], [100, 50]];
    let many = [[65_536, 2], [65_537, 2], [1, 32_768], [1, 32_769], [512, 2_200]];
    for [width, height] in few.repeat(8).into_iter().chain(many) {
        let form = Form { breadth: Breadth::Celled, extent: [width, height, 1] };
        let samples = noise.within(100, width * height);
        let segment = written(&samples, form, random_model(form, &mut noise));
        assert!(both(&segment, form, SampleType::I8) == Ok(samples), "{form:?}");
    }
}

/// Frequencies of all sizes, which sum up to less and to more than they are brought to; of some the largest are many.
#[test]
fn any_tables_are_read() {
    let mut noise = Noise::new(10);
    let [mut below, mut above] = [0; 2];
    for round in 0..500 {
        let form = Form { breadth: Breadth::Celled, extent: [[17, 9, 1], [7, 6, 4]][round % 2] };
        let samples = noise.within(30_000, form.extent.iter().product());
        let mut model = random_model(form, &mut noise);
        let sizes = 1 + round as u64 % 8;
        let mut table =
            || (0..42).map(|_| (1 + noise.bits() % 15) << (noise.bits() % sizes)).map(|f| f as i64).collect();
        model.tables = (0..CLASSES).map(|_| table()).collect();
        for table in &model.tables {
            let sum = table.iter().sum::<i64>();
            below += usize::from(sum < 4096);
            above += usize::from(sum > 4096);
        }
        let segment = tabled::encode(&samples, form, bounds(&samples), &model).bytes();
        assert!(both(&segment, form, SampleType::I16) == Ok(samples), "{form:?} {model:?}");
    }
    assert!(below > 1000 && above > 1000, "{below} below, {above} above");
}

#[test]
fn what_the_oracle_writes_is_read() {
    let mut noise = Noise::new(1);
    let sides = [1, 2, 3, 4, 5, 9];
    let rows = sides.iter().flat_map(|&y| sides.map(|z| [y, z])).filter(|&[y, z]| y * z > 1);
    let widths = [1, 2, 3, 4, 5, 6, 7, 8, 17];
    let extents = rows.flat_map(|[height, depth]| widths.map(|width| [width, height, depth]));
    for axes in extents.collect::<Vec<_>>() {
        for breadth in Breadth::ALL {
            for (input, sample_type) in inputs(breadth) {
                let extent = Extent::new(axes).expect("an extent");
                let samples = input.generate(extent).expect("a generator");
                let form = Form { breadth, extent: axes.map(|n| n as usize) };
                let segment = written(&samples, form, random_model(form, &mut noise));
                assert!(both(&segment, form, sample_type) == Ok(samples), "{form:?} {input:?}");
            }
        }
    }
}

/// Gradients, with which all weights add up to more than one.
#[test]
fn weights_at_their_limits_are_read() {
    let mut noise = Noise::new(2);
    for breadth in Breadth::ALL {
        let form = Form { breadth, extent: [13, 11, 7] };
        let samples = noise.within((breadth.span_limit() - 1) / 2, 13 * 11 * 7);
        // As many as add up to no more than they may, from each place on.
        for (weight, others) in [(2047, 0), (-2048, 0), (2047, 7), (-2048, 7)] {
            let others = if breadth == Breadth::Narrow { 0 } else { others };
            for place in 0..43 {
                let is_set = |i: usize, count: usize| (i + count - place % count) % count <= others;
                let set = |count: usize| {
                    (0..count).map(|i| if is_set(i, count) { weight } else { 0 }).collect::<Vec<i64>>()
                };
                let weights = form.sets().into_iter().map(set).collect();
                let segment = written(&samples, form, Model::new(weights));
                let found = both(&segment, form, SampleType::I32);
                assert!(found.as_ref() == Ok(&samples), "{breadth:?} {weight} {place}");
            }
        }
    }
}

/// Samples far beyond the span, which alone differ as much: sums of predictions leave 32 bits, and energies 24.
#[test]
fn sums_that_wrap_are_read() {
    let mut noise = Noise::new(6);
    let alternating = |i: usize| if i.is_multiple_of(2) { 2047 } else { -2047 };
    let set = |count: usize| (0..count).map(|i| if i < 8 { alternating(i) } else { 0 }).collect();
    let forms = [Breadth::Wide, Breadth::Celled]
        .map(|breadth| [[9, 8, 6], [9, 48, 1]].map(|extent| Form { breadth, extent }))
        .concat();
    for form in forms.repeat(34) {
        let samples: Vec<i32> = (0..9 * 8 * 6).map(|_| (noise.bits() % 2 * 900_000) as i32).collect();
        for span in [1, 65_535] {
            let bounds = [458_000, span];
            let mut model = Model::new(form.sets().into_iter().map(set).collect());
            if form.breadth == Breadth::Celled {
                model.scale = (noise.bits() % 17) as u32;
            }
            let model = fit(&samples, form, bounds, model);
            let segment = tabled::encode(&samples, form, bounds, &model).bytes();
            assert_eq!(both(&segment, form, SampleType::I32).as_ref(), Ok(&samples), "{span}");
        }
    }
}

/// The kernel gives a class that only has token 0 a table of one; none at all says the same.
#[test]
fn a_class_without_tokens_has_the_first() {
    let form = Form { breadth: Breadth::Narrow, extent: [9, 8, 1] };
    // One step in each row, the same but for the last.
    let samples: Vec<i32> = (0..72).map(|i| if i % 9 > 4 || i == 70 { 40 } else { 0 }).collect();
    let weights = vec![vec![0, 0, 0, 256, 0, 0]];
    let mut model = fit(&samples, form, [0, 40], Model::new(weights));
    let full = model.clone();
    model.tables.iter_mut().filter(|table| **table == [4096]).for_each(Vec::clear);
    assert_ne!(model, full, "no class has one token only");
    for model in [model, full] {
        let segment = tabled::encode(&samples, form, [0, 40], &model).bytes();
        assert_eq!(both(&segment, form, SampleType::U8).as_ref(), Ok(&samples));
    }
}

#[test]
fn golden_vectors_are_those_of_the_oracle() {
    let manifest = Manifest::read().expect("the manifest");
    let mut tabled = BTreeMap::new();
    for vector in &manifest.vectors {
        let bytes = vector.read().expect("its file");
        if let Some(breadth) = bytes.get(3).and_then(|&storage| Breadth::of_storage(storage))
            && let Ok(header) = Header::parse(&bytes)
        {
            let index = wavelift_kernel::SampleType::ALL.iter().position(|&t| t == header.sample_type());
            let sample_type = SampleType::ALL[index.expect("all are listed")];
            let form = Form { breadth, extent: sides(header.plan().extent()) };
            let found = both(segment_of(&bytes), form, sample_type);
            *tabled.entry(breadth.storage()).or_insert(0) += usize::from(found.is_ok());
            assert!(vector.input.is_none() || found.ok() == manifest.samples(vector).ok(), "{}", vector.id);
        }
    }
    assert!(
        [3, 6].iter().all(|storage| tabled.get(storage).is_some_and(|&read| read > 0)),
        "narrow and celled: {tabled:?}"
    );
}
