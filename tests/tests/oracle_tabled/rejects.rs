//! Every row of what a decoder must reject, written by hand.

use conformance::oracle::coder::SampleType;
use conformance::oracle::tabled::{self, Breadth, CLASSES, Form, Model, Segment, constant, fit};
use wavelift_kernel::{DecodeError, Malformed};

use crate::both;

const NARROW: Form = Form { breadth: Breadth::Narrow, extent: [5, 3, 2] };

const WIDE: Form = Form { breadth: Breadth::Wide, ..NARROW };

const CELLED: Form = Form { breadth: Breadth::Celled, ..NARROW };

/// Of a single cell.
const SLICE: Form = Form { extent: [5, 6, 1], ..CELLED };

const FORMS: [Form; 4] = [NARROW, WIDE, CELLED, SLICE];

/// Small and large residuals: extra bits, and several classes.
fn samples() -> Vec<i32> {
    (0..30).map(|i| if i % 4 == 0 { 200 - i } else { i % 3 }).collect()
}

const BOUNDS: [i32; 2] = [0, 200];

/// Each sample by the sample before it.
fn weights(form: Form) -> Vec<Vec<i64>> {
    // Which is what the wide ones begin with.
    let first = if form.breadth == Breadth::Narrow { 256 } else { 0 };
    let before = |count| (0..count).map(move |i| if i == 0 { first } else { 0 }).collect();
    form.sets().into_iter().map(before).collect()
}

fn sound_of(form: Form) -> (Segment, Model) {
    sound_under(form, Model::new(weights(form)))
}

/// The same under this model, which gets tables.
fn sound_under(form: Form, model: Model) -> (Segment, Model) {
    let model = fit(&samples(), form, BOUNDS, model);
    (tabled::encode(&samples(), form, BOUNDS, &model), model)
}

fn sound() -> (Segment, Model) {
    sound_of(NARROW)
}

#[track_caller]
fn refused(segment: &[u8], form: Form, sample_type: SampleType, error: Malformed) {
    assert_eq!(both(segment, form, sample_type).err(), Some(DecodeError::Malformed(error)));
}

#[track_caller]
fn wrong_of(form: Form, segment: &Segment) {
    refused(&segment.bytes(), form, SampleType::U8, Malformed::Segment);
}

#[track_caller]
fn wrong(segment: &Segment) {
    wrong_of(NARROW, segment);
}

/// The sound segment with other bytes of weights and tables.
fn with_model(model: Vec<u8>) -> Segment {
    Segment { model, ..sound().0 }
}

#[test]
fn the_sound_one_is_read() {
    for form in FORMS {
        let (segment, _) = sound_of(form);
        assert!(!segment.extra.is_empty() && !segment.words.is_empty());
        assert_eq!(both(&segment.bytes(), form, SampleType::U8), Ok(samples()));
    }
}

#[test]
fn spans() {
    for form in FORMS {
        let (segment, _) = sound_of(form);
        let limit = form.breadth.span_limit();
        for span in [-1, i32::MIN, limit, i32::MAX] {
            wrong_of(form, &Segment { span, ..segment.clone() });
        }
        // The same residuals from the same predictions, as none is above 200.
        let widest = Segment { span: limit - 1, ..segment.clone() };
        assert_eq!(both(&widest.bytes(), form, SampleType::U8), Ok(samples()));
        // No byte after a span of 0, but the samples are there.
        assert_eq!(both(&constant(7, 0), form, SampleType::U8), Ok(vec![7; 30]));
        refused(&[constant(7, 0), vec![0]].concat(), form, SampleType::U8, Malformed::Segment);
        wrong_of(form, &Segment { span: 0, ..segment });
    }
}

#[test]
fn one_row() {
    for (breadth, width) in Breadth::ALL.into_iter().flat_map(|breadth| [(breadth, 30), (breadth, 1)]) {
        let form = Form { breadth, extent: [width, 1, 1] };
        assert_eq!(both(&constant(-9, 0), form, SampleType::I8), Ok(vec![-9; width]));
        let model = fit(&samples()[..width], form, BOUNDS, Model::new(weights(form)));
        let segment = tabled::encode(&samples()[..width], form, BOUNDS, &model);
        refused(&segment.bytes(), form, SampleType::U8, Malformed::Segment);
    }
}

#[test]
fn too_large_weights() {
    // W and the middle of N, and of the brick too.
    let limit = |sum: i64| {
        let mut weights = weights(NARROW);
        for set in &mut weights {
            (set[0], set[3]) = (1024, 1024 - sum);
        }
        sound_under(NARROW, Model::new(weights)).0
    };
    assert_eq!(both(&limit(2048).bytes(), NARROW, SampleType::U8), Ok(samples()));
    wrong(&limit(2049));
    // The second set alone.
    let (segment, mut model) = sound();
    model.weights[1][5] = -1793;
    wrong(&Segment { model: model.write(NARROW).bytes, ..segment });
}

#[test]
fn tables() {
    let (_, model) = sound();
    let full = |last: i64| (0..41).map(|_| 1).chain([4096 - 41, last]).collect::<Vec<i64>>();
    // 43 tokens; sums below and above; a last frequency of 0; a size of 14.
    for table in [full(1), vec![4095], vec![4097], vec![2048, 2047], vec![4096, 0], vec![0], vec![8192]] {
        for class in [0, CLASSES - 1] {
            let mut model = model.clone();
            model.tables[class] = table.clone();
            wrong(&with_model(model.write(NARROW).bytes));
        }
    }
}

#[test]
fn too_large_wide_weights() {
    // The set of which planes, and what its magnitudes add up to.
    let with = |form: Form, set: usize, sum: i64| {
        let mut weights = weights(form);
        weights[set][..8].fill(-2047);
        weights[set][9] = sum - 8 * 2047;
        sound_under(form, Model::new(weights)).0
    };
    for (form, set) in [(WIDE, 0), (WIDE, 1), (CELLED, 0), (CELLED, 1), (SLICE, 0)] {
        assert_eq!(both(&with(form, set, 16_384).bytes(), form, SampleType::U8), Ok(samples()));
        wrong_of(form, &with(form, set, 16_385));
    }
}

#[test]
fn scales() {
    let with = |scale| sound_under(CELLED, Model { scale, ..Model::new(weights(CELLED)) }).0;
    for scale in 0..=16 {
        assert_eq!(both(&with(scale).bytes(), CELLED, SampleType::U8), Ok(samples()), "{scale}");
    }
    for scale in 17..32 {
        wrong_of(CELLED, &with(scale));
    }
}

#[test]
fn labels() {
    let with = |sets: usize| {
        let [set] = &weights(SLICE)[..] else { panic!("a slice has one kind") };
        let model = Model { labels: vec![0], ..Model::new(vec![set.clone(); sets]) };
        sound_under(SLICE, model)
    };
    for sets in 2..=8_usize {
        let (segment, mut model) = with(sets);
        for label in 0..sets.next_power_of_two() {
            model.labels = vec![label];
            let segment = Segment { model: model.write(SLICE).bytes, ..segment.clone() };
            // All sets are alike.
            match label < sets {
                true => assert_eq!(both(&segment.bytes(), SLICE, SampleType::U8), Ok(samples())),
                false => wrong_of(SLICE, &segment),
            }
        }
        // The last set alone.
        model.labels = vec![0];
        model.weights[sets - 1][..9].fill(2047);
        wrong_of(SLICE, &Segment { model: model.write(SLICE).bytes, ..segment });
    }
}

#[test]
fn celled_tables() {
    // The largest sum that there may be, and one more.
    let table = |last| [&[7680; 8][..], &[3840, 240], &[1; 14], &[last]].concat();
    for form in [CELLED, SLICE] {
        let (segment, model) = sound_of(form);
        let sound = Model { tables: vec![table(1); CLASSES], ..model.clone() };
        let sound = tabled::encode(&samples(), form, BOUNDS, &sound);
        assert_eq!(both(&sound.bytes(), form, SampleType::U8), Ok(samples()));
        for table in [table(2), vec![1; 43], vec![4096, 0], vec![0], vec![8192]] {
            for class in [0, CLASSES - 1] {
                let mut model = model.clone();
                model.tables[class] = table.clone();
                wrong_of(form, &Segment { model: model.write(form).bytes, ..segment.clone() });
            }
        }
    }
}

/// What the one storage holds is not what the other does.
#[test]
fn another_storage() {
    let all = [NARROW, WIDE, CELLED];
    let pairs = all.into_iter().flat_map(|form| all.map(|other| (form, other)));
    for (form, other) in pairs.filter(|(form, other)| form != other) {
        wrong_of(other, &sound_of(form).0);
    }
}

/// A table whose bits are given, after weights, for class 0.
fn with_ones(ones: usize, then: i64) -> Segment {
    let mut bits = Model::new(weights(NARROW)).write(NARROW);
    bits.bits(6, 1);
    (0..ones).for_each(|_| bits.bits(1, 1));
    bits.bits(1, then);
    let rest = Model { tables: vec![Vec::new(); CLASSES], ..Model::new(Vec::new()) }.write(NARROW);
    bits.bytes.extend(rest.bytes);
    with_model(bits.bytes)
}

#[test]
fn sizes() {
    // 12 - 13, 12 + 2 and a change that is none.
    for ones in [26, 3, 27, 28, 63, 64, 200] {
        wrong(&with_ones(ones, 0));
    }
}

#[test]
fn unused_bits() {
    let (segment, model) = sound();
    let mut bits = model.write(NARROW);
    let mut filled = 0;
    while bits.bytes.len() == segment.model.len() {
        bits.bits(1, 0);
        filled += 1;
    }
    assert!(filled > 1, "no bit is unused");
    let mut last = segment.model;
    *last.last_mut().expect("a model has bytes") |= 0x80;
    wrong(&with_model(last));
}

#[test]
fn states_and_words() {
    let (segment, _) = sound();
    for state in 0..4 {
        for v in [0, 0xFFFF] {
            let mut segment = segment.clone();
            segment.states[state] = v;
            wrong(&segment);
        }
        // One more or less where it begins is another where it ends.
        let mut segment = segment.clone();
        segment.states[state] += 4096;
        wrong(&segment);
    }
    let mut more = segment.clone();
    more.words.push(0);
    wrong(&more);
    let mut fewer = segment.clone();
    fewer.words.pop();
    wrong(&fewer);
    refused(&[segment.bytes(), vec![0]].concat(), NARROW, SampleType::U8, Malformed::Segment);
}

#[test]
fn extra_bits() {
    let (segment, _) = sound();
    let mut more = segment.clone();
    more.extra.push(0);
    wrong(&more);
    let mut fewer = segment.clone();
    fewer.extra.pop();
    wrong(&fewer);
    let mut beyond = segment;
    *beyond.extra.last_mut().expect("there are some") |= 0x80;
    wrong(&beyond);
}

#[test]
fn samples_outside_the_type() {
    let (segment, _) = sound();
    for (lowest, sample_type) in [(56, SampleType::U8), (-1, SampleType::U8), (-129, SampleType::I8)] {
        let segment = Segment { lowest, ..segment.clone() };
        refused(&segment.bytes(), NARROW, sample_type, Malformed::Sample);
    }
    refused(&constant(256, 0), NARROW, SampleType::U8, Malformed::Sample);
    // What is wrong of the segment comes first.
    let mut both = Segment { lowest: -1, ..segment };
    both.words.push(0);
    wrong(&both);
}

/// Of no row of the text, so they are read: samples beyond the span, and a lowest that none is.
#[test]
fn samples_outside_the_span() {
    for bounds in [[0, 1], [-40, 100], [100, 3]] {
        for form in FORMS {
            let model = fit(&samples(), form, bounds, Model::new(weights(form)));
            let segment = tabled::encode(&samples(), form, bounds, &model);
            assert_eq!(both(&segment.bytes(), form, SampleType::U8), Ok(samples()), "{bounds:?}");
        }
    }
}

/// A class that has none is asked for others than token 0.
#[test]
fn tokens_of_an_empty_class() {
    let (segment, mut model) = sound();
    for class in 0..CLASSES {
        if model.tables[class].len() > 1 {
            let used = std::mem::take(&mut model.tables[class]);
            wrong(&Segment { model: model.write(NARROW).bytes, ..segment.clone() });
            model.tables[class] = used;
        }
    }
}
