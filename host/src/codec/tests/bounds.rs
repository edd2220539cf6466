//! Error bounds: every type, every kind of odd value, and what a reader gets.

use super::*;
use crate::bound::{Deviation, Profile, Real, Tolerance, extend_bytes, samples_of};

/// A volume of floating-point samples.
pub(super) fn reals<R: Real>(extent: [u64; 3], samples: &[R]) -> Volume {
    let element = if size_of::<R>() == 4 { ElementType::F32 } else { ElementType::F64 };
    let mut volume = generate(Kind::Constant, extent, element, 1);
    volume.samples.clear();
    extend_bytes(&mut volume.samples, samples.iter().copied());
    volume
}

/// A smooth field of 32 x 16 x 8 samples.
fn field() -> Vec<f32> {
    let place = |i: u32| [i % 32, i / 32 % 16, i / 512].map(|n| n as f32);
    (0..4096).map(place).map(|[x, y, z]| (0.2 * x).sin() * (0.1 * y).cos() + 0.05 * z).collect()
}

fn with(tolerance: Option<Tolerance>) -> CompressOptions {
    CompressOptions { tolerance, ..small_bricks("auto", None) }
}

pub(super) fn absolute(error: f64) -> Option<Tolerance> {
    Some(Tolerance::absolute(error).unwrap())
}

/// Compresses, reads again, and checks the bound.
fn within(volume: &Volume, tolerance: Option<Tolerance>) -> (Stored, Report, Volume) {
    within_options(volume, &with(tolerance))
}

/// As [`within`].
pub(super) fn within_options(volume: &Volume, options: &CompressOptions) -> (Stored, Report, Volume) {
    let (stored, report) = store(volume, options);
    let back = read(&stored.path, &Part::default()).unwrap();
    let error = channel(&report).bound.map_or(0.0, |bound| bound.error);
    let deviation = Deviation::of(volume.element, &volume.samples, &back.samples, error);
    assert_eq!(deviation.beyond, None, "{deviation:?} {error}");
    let container = Container::open(&stored.path).unwrap();
    assert_eq!((container.head(), container.step(0).unwrap()), (&report.head, &report.steps[0]));
    assert_eq!(container.summaries().unwrap(), report.summaries);
    (stored, report, back)
}

#[test]
fn every_type_and_kind_stays_within_every_bound() {
    for element in ElementType::ALL {
        for kind in Kind::ALL {
            let volume = generate(kind, [19, 9, 6], element, 1);
            for error in [1e-30, 1e-3, 0.9, 1.0, 7.5, 1e4, 1e30] {
                within(&volume, absolute(error));
            }
            within(&volume, Some(Tolerance::relative(1e-3).unwrap()));
        }
    }
}

#[test]
fn the_wider_the_bound_the_smaller_the_file() {
    let volume = reals([32, 16, 8], &field());
    let sizes = [0.1, 1e-2, 1e-3, 1e-4].map(|fraction| {
        let (_, report, _) = within(&volume, Some(Tolerance::relative(fraction).unwrap()));
        assert!(matches!(channel(&report).form, Form::Scaled { .. }));
        assert_eq!((summary(&report).exceptions, summary(&report).exact_bricks), (0, 0));
        report.container_bytes
    });
    let (_, exact, back) = within(&volume, None);
    assert_eq!((&channel(&exact).form, back), (&Form::Exact, volume));
    assert!(sizes.is_sorted_by(|a, b| a < b) && sizes[3] < exact.container_bytes, "{sizes:?} {exact:?}");
}

#[test]
fn odd_values_come_back_bit_for_bit() {
    let odd = [
        f32::NAN,
        f32::from_bits(0xFFC0_1234),
        f32::from_bits(0x7F80_0001),
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        1e30,
        f32::MIN,
    ];
    let mut samples = field();
    for (place, value) in odd.into_iter().enumerate() {
        samples[37 * place + 5] = value;
    }
    let (_, report, back) = within(&reals([32, 16, 8], &samples), absolute(1e-3));
    assert_eq!(summary(&report).exceptions, odd.len() as u64);
    let back: Vec<f32> = samples_of(&back.samples).collect();
    for (place, value) in odd.into_iter().enumerate() {
        assert_eq!(back[37 * place + 5].to_bits(), value.to_bits());
    }
}

#[test]
fn a_brick_full_of_exceptions_is_exact() {
    let mut samples = field();
    // The first brick holds denormal noise with the signs of zeros, the others a field.
    for (i, sample) in
        samples.iter_mut().enumerate().filter(|(i, _)| i % 32 < 8 && i / 32 % 16 < 8 && i / 512 < 4)
    {
        *sample = if i % 3 == 0 { -0.0 } else { f32::from_bits(0x7FC0_0000 + i as u32) };
    }
    let volume = reals([32, 16, 8], &samples);
    let coding = brick::Coding {
        effort: Effort::Default,
        transform: Transform::NONE,
        form: scaled::form(&Profile::of(field().into_iter()), 1e-3, 0).unwrap(),
        error: 1e-3,
    };
    let grid = Grid::new(volume.extent, [8, 8, 4]).unwrap();
    let kept = |index| {
        let Brick { origin, sides } = grid.brick(index);
        let bytes: Vec<u8> = volume.rows(origin, sides).flatten().copied().collect();
        let samples = brick::Samples { element: volume.element, sides, bytes: &bytes };
        brick::Worker::new().encode(samples, &coding).unwrap().exceptions
    };
    assert_eq!((kept(0), kept(1)), (None, Some(Kept::default())));
}

#[test]
fn a_mask_costs_little_and_stays_at_every_level() {
    let mut samples = field();
    for (i, sample) in samples.iter_mut().enumerate().filter(|(i, _)| i % 32 < 12) {
        *sample = if i < 2048 { f32::NAN } else { 1e20 };
    }
    let (stored, report, _) = within(&reals([32, 16, 8], &samples), Some(Tolerance::absolute(1e-3).unwrap()));
    assert_eq!((summary(&report).exceptions, channel(&report).readable_levels), (12 * 128, 2));
    let coarse = read(&stored.path, &level(1)).unwrap();
    assert_eq!(coarse.extent, [16, 8, 4]);
    for (i, sample) in samples_of::<f32>(&coarse.samples).enumerate() {
        match i % 16 {
            0..6 if i < 256 => assert!(sample.is_nan()),
            0..6 => assert_eq!(sample, 1e20),
            _ => assert!(sample.abs() < 2.0, "{sample}"),
        }
    }
    let part = read(&stored.path, &region(0, [5, 3, 4], [21, 12, 7])).unwrap();
    let first: Vec<f32> = samples_of(&part.samples).take(9).collect();
    assert!(first[..7] == [1e20; 7] && first[7].abs() < 2.0 && first[8].abs() < 2.0);
}

#[test]
fn floats_on_a_scale_have_levels_with_every_wavelet() {
    let volume = reals([32, 16, 8], &field().iter().map(|x| 3.0 + 0.01 * x).collect::<Vec<_>>());
    for wavelet in ["none", "haar", "linear"] {
        let options = CompressOptions { tolerance: absolute(1e-4), ..small_bricks(wavelet, None) };
        let (stored, report) = store(&volume, &options);
        assert_eq!(channel(&report).readable_levels, 2);
        let coarse = read(&stored.path, &level(2)).unwrap();
        assert!(samples_of::<f32>(&coarse.samples).all(|sample| (sample - 3.0).abs() < 0.02));
    }
}

#[test]
fn denormals_huge_ranges_and_tiny_bounds() {
    let denormals: Vec<f64> = (0..512_u64).map(|i| f64::from_bits(i * i + 1)).collect();
    let huge: Vec<f64> =
        (0..512).map(|i| if i % 2 == 0 { f64::MAX } else { f64::MIN } / f64::from(i + 1)).collect();
    let steep: Vec<f64> = (-256..256).map(|i| 10_f64.powi(i)).collect();
    for samples in [denormals, huge, steep] {
        let volume = reals([8, 8, 8], &samples);
        for error in [f64::from_bits(1), f64::MIN_POSITIVE, 1e-3, 1e300, f64::MAX] {
            within(&volume, absolute(error));
        }
        for fraction in [1e-300, 1e-9, 1e-3, 0.5, 0.99] {
            within(&volume, Some(Tolerance::relative(fraction).unwrap()));
        }
        assert_eq!(within(&volume, None).2, volume);
    }
}

#[test]
fn a_relative_bound_of_nothing_keeps_every_bit() {
    let relative = Some(Tolerance::relative(1e-2).unwrap());
    for samples in [[7.25_f32; 64], [f32::NAN; 64], [f32::INFINITY; 64], [-0.0; 64]] {
        let volume = reals([8, 8, 1], &samples);
        let (_, report, back) = within(&volume, relative);
        assert_eq!(channel(&report).bound.map(|bound| bound.error), Some(0.0));
        assert_eq!(back, volume);
    }
}

#[test]
fn integers_and_decimals_kept_as_floats_are_integers() {
    for (unit, zero) in [(1.0, 0.0), (100.0, 0.0), (1.0, -0.0), (8.0, 0.0)] {
        let integers: Vec<i32> = (0..32_768_i32).map(|i| (i % 64 - 20) * (i / 2048) % 991).collect();
        let real = |&i: &i32| if i == 0 { zero } else { f64::from(i) / unit };
        let samples: Vec<f32> = integers.iter().map(real).map(|x| x as f32).collect();
        let volume = reals([64, 32, 16], &samples);
        let (stored, report) = store(&volume, &CompressOptions::default());
        assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume);
        assert_ne!(channel(&report).form, Form::Exact, "{unit} {zero}");
        let smallest = if zero.is_sign_negative() { 8 } else { 2 } * volume.samples.len() as u64 / 8;
        assert!(report.container_bytes < smallest, "{unit} {zero}: {}", report.container_bytes);
    }
}

#[test]
fn few_odd_values_among_integers_are_kept() {
    let mut samples: Vec<f64> = (0..32_768_i32).map(|i| f64::from((i % 64) * (i / 2048))).collect();
    for (place, odd) in [-0.0, f64::NAN, f64::from_bits(0xFFF8_0000_0000_0007), f64::INFINITY, 0.1, 1e300]
        .into_iter()
        .enumerate()
    {
        samples[5000 * place + 1] = odd;
    }
    let volume = reals([64, 32, 16], &samples);
    let (stored, report) = store(&volume, &CompressOptions::default());
    assert!(matches!(channel(&report).form, Form::Scaled { integers: wavelift_kernel::SampleType::I16, .. }));
    assert_eq!(summary(&report).exceptions, 6);
    assert_eq!(read(&stored.path, &Part::default()).unwrap(), volume);
}

#[test]
fn integers_are_coded_in_steps() {
    let volume = generate(Kind::Waves, [32, 16, 8], ElementType::U16, 1);
    let (_, exact, back) = within(&volume, absolute(0.99));
    assert_eq!((&channel(&exact).form, back), (&Form::Exact, volume.clone()));
    let (stored, report, back) = within(&volume, absolute(2.5));
    assert!(matches!(channel(&report).form, Form::Steps(5) | Form::Near(2)));
    assert_eq!(channel(&report).readable_levels, 2);
    assert!(report.container_bytes < exact.container_bytes && back != volume);
    let coarse = read(&stored.path, &level(1)).unwrap();
    assert_eq!(coarse.extent, [16, 8, 4]);
}

#[test]
fn damage_to_exceptions_is_noticed() {
    let mut samples = field();
    samples[100] = f32::NAN;
    let (stored, report) = store(&reals([32, 16, 8], &samples), &with(absolute(1e-2)));
    assert_eq!(summary(&report).exceptions, 1);
    let lies: [&dyn Fn(&mut Told); 3] = [
        &|told| {
            told.labels.iter_mut().flat_map(|label| &mut label.exceptions).for_each(|kept| kept.samples += 1)
        },
        &|told| told.labels.iter_mut().for_each(|label| label.exceptions = None),
        &|told| told.step.channels[0].form = Form::Exact,
    ];
    for lie in lies {
        std::fs::write(&stored.path, with_lies(&stored.bytes, lie)).unwrap();
        assert_eq!(read(&stored.path, &Part::default()).unwrap_err().kind(), Fault::Data);
    }
    damage_is_noticed(&stored, 7);
}
