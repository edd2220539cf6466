//! Lattices: bounds, levels, regions, extremes, and an index that says otherwise than its bricks.

use super::bounds::{absolute, reals, within_options};
use super::*;
use crate::bound::Deviation;

/// Bricks, the last along each axis of one sample.
const EXTENT: [u64; 3] = [65, 33, 17];
const SIDES: [u32; 3] = [32, 16, 16];

fn options(error: f64) -> CompressOptions {
    CompressOptions { tolerance: absolute(error), brick: Some(SIDES), ..CompressOptions::default() }
}

/// A smooth function of the place, from -3 to 3.
fn waves() -> impl Iterator<Item = f64> {
    let [width, height, _] = EXTENT;
    let place = move |i: u64| [i % width, i / width % height, i / width / height].map(|n| n as f64);
    let samples = EXTENT.into_iter().product();
    (0..samples)
        .map(place)
        .map(|[x, y, z]| (0.11 * x).sin() + (0.13 * y + 0.1 * z).cos() + (0.09 * (x - z)).sin())
}

fn floats() -> Volume {
    reals(EXTENT, &waves().map(|x| x as f32).collect::<Vec<_>>())
}

fn integers() -> Volume {
    let mut volume = generate(Kind::Constant, EXTENT, ElementType::I16, 1);
    volume.samples = waves().flat_map(|x| ((1000.0 * x) as i16).to_le_bytes()).collect();
    volume
}

/// Volumes that are coded as lattices, their bounds, and those without.
fn volumes() -> [(Volume, f64, f64); 2] {
    [(floats(), 0.03, 1e-6), (integers(), 20.0, 0.5)]
}

#[test]
fn smooth_volumes_are_lattices_if_the_bound_is_wide() {
    for (volume, wide, narrow) in volumes() {
        let (_, report, _) = within_options(&volume, &options(wide));
        assert!(channel(&report).form.slack().is_some(), "{:?}", channel(&report).form);
        assert_eq!((channel(&report).wavelet, channel(&report).readable_levels), (None, 4));
        let transformed = CompressOptions { wavelet: "linear".parse().unwrap(), ..options(wide) };
        let fast = CompressOptions { effort: Effort::Fast, ..options(wide) };
        for rival in [transformed, fast, options(narrow)] {
            let (_, other, _) = within_options(&volume, &rival);
            assert_eq!(channel(&other).form.slack(), None);
            assert!(report.container_bytes < other.container_bytes);
        }
    }
}

#[test]
fn a_level_of_a_lattice_is_every_so_many_samples() {
    for (volume, error, _) in volumes() {
        let (stored, _, whole) = within_options(&volume, &options(error));
        let sides = EXTENT.map(|side| side as u32);
        for number in 1..=4 {
            let coarse = read(&stored.path, &level(number)).unwrap();
            let thinned = scaled::thin(volume.element, sides, number, &whole.samples);
            assert_eq!(coarse.samples, thinned, "{number}");
        }
        let part = read(&stored.path, &region(1, [30, 7, 3], [65, 33, 17])).unwrap();
        let coarse = read(&stored.path, &level(1)).unwrap();
        assert_eq!(part.extent, [18, 13, 7]);
        assert_eq!(part.samples[..4], coarse.samples[sample_at(&coarse, [15, 4, 2])..][..4]);
    }
}

/// Where a sample is among the bytes.
fn sample_at(volume: &Volume, [x, y, z]: [u64; 3]) -> usize {
    let [width, height, _] = volume.extent;
    ((z * height + y) * width + x) as usize * volume.element.bytes()
}

#[test]
fn odd_values_of_a_lattice_are_kept_at_every_level() {
    let mut samples: Vec<f32> = waves().map(|x| x as f32).collect();
    let odd = [f32::NAN, f32::INFINITY, -0.0, 1e30];
    for (place, value) in odd.into_iter().enumerate() {
        samples[16 * place] = value;
    }
    let (stored, report, _) = within_options(&reals(EXTENT, &samples), &options(0.03));
    assert_eq!((summary(&report).exceptions, channel(&report).form.slack()), (4, Some(7)));
    for number in 0..=4 {
        let read = read(&stored.path, &level(number)).unwrap();
        for (place, value) in odd.into_iter().enumerate() {
            let at = 4 * ((16 * place) >> number);
            assert_eq!(read.samples[at..][..4], value.to_le_bytes(), "{value} at {number}");
        }
    }
}

#[test]
fn extremes_stay_within_their_type() {
    for element in ElementType::ALL.into_iter().filter(|element| !element.is_float() && element.bytes() <= 4)
    {
        let mut volume = generate(Kind::Noise, [16, 8, 4], element, 1);
        let is_signed = element.is_signed_integer();
        for (i, sample) in volume.samples.chunks_mut(element.bytes()).enumerate() {
            sample.fill(if i % 3 == 0 { 0xFF } else { 0 });
            let highest = sample.len() - 1;
            sample[highest] ^= if is_signed { 0x80 } else { 0 };
        }
        for slack in [1, 2, 100, 60_000, steps::MOST_SLACK] {
            let (transform, form) = (Transform::NONE, Form::Near(slack));
            let coding = brick::Coding { effort: Effort::Default, transform, form, error: slack.into() };
            let samples = brick::Samples { element, sides: [16, 8, 4], bytes: &volume.samples };
            // The worker compares.
            assert!(brick::Worker::new().encode(samples, &coding).is_ok(), "{element} {slack}");
        }
        for error in [1.0, 2.9, 1e5, 1e30] {
            within_options(&volume, &CompressOptions { brick: None, ..options(error) });
        }
    }
}

#[test]
fn bricks_of_another_slack_than_the_index_says_are_refused() {
    let with_slack = |form: &Form, slack: u32| match form {
        Form::Scaled { scale, integers } => {
            Form::Scaled { scale: Scale::try_from((scale.density(), slack)).unwrap(), integers: *integers }
        }
        _ if slack == 0 => Form::Exact,
        _ => Form::Near(slack),
    };
    for (volume, wide, narrow) in volumes() {
        for error in [wide, narrow] {
            let none = CompressOptions { wavelet: Choice::None, ..options(error) };
            let (stored, report, _) = within_options(&volume, &none);
            let form = &channel(&report).form;
            for slack in [0, 1, 5, 20, 4000].into_iter().filter(|slack| *slack != form.slack().unwrap_or(0)) {
                let lie =
                    with_lies(&stored.bytes, |told| told.step.channels[0].form = with_slack(form, slack));
                std::fs::write(&stored.path, lie).unwrap();
                for number in [0, 1, 4] {
                    let error = read(&stored.path, &level(number)).unwrap_err();
                    assert_eq!(error.kind(), Fault::Data, "{form:?} as of {slack} at {number}");
                }
            }
        }
        let (stored, report, _) = within_options(&volume, &options(wide));
        let lies: [&dyn Fn(&mut Told); 5] = [
            &|told| told.step.channels[0].wavelet = Some(wavelift_kernel::Wavelet::Haar),
            &|told| told.step.channels[0].form = Form::Near(0),
            &|told| told.step.channels[0].form = Form::Near(u32::MAX),
            &|told| told.step.channels[0].readable_levels = 5,
            &|told| told.head.element = ElementType::I64,
        ];
        for lie in lies {
            std::fs::write(&stored.path, with_lies(&stored.bytes, lie)).unwrap();
            assert_eq!(
                read(&stored.path, &level(0)).unwrap_err().kind(),
                Fault::Data,
                "{:?}",
                channel(&report).form
            );
        }
    }
}

#[test]
fn damage_to_lattices_is_noticed() {
    for (volume, error, _) in volumes() {
        let (stored, report, whole) = within_options(&volume, &options(error));
        let deviation = Deviation::of(
            volume.element,
            &volume.samples,
            &whole.samples,
            channel(&report).bound.unwrap().error,
        );
        assert_eq!(deviation.beyond, None);
        damage_is_noticed(&stored, 97);
    }
}
