use super::*;
use crate::codec::{CompressOptions, Container, compress};
use crate::progress::ignore;
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{ElementType, Header, InMemory, Metadata, Volume};

/// A volume in which every sample says where it is: x + 10 y + 100 z.
fn places() -> Volume {
    let samples =
        (0..4_u16).flat_map(|z| (0..3).flat_map(move |y| (0..5).map(move |x| x + 10 * y + 100 * z)));
    Volume {
        extent: [5, 3, 4],
        element: ElementType::U16,
        samples: samples.flat_map(u16::to_le_bytes).collect(),
        metadata: Metadata::default(),
    }
}

fn stored(volume: &Volume, options: &CompressOptions) -> Container {
    let mut bytes = Vec::new();
    compress(volume, options, &mut bytes, &ignore).unwrap();
    Container::new(Box::new(bytes)).unwrap()
}

/// The picture of a view, which is the same of the volume and of the compressed file.
fn picture(volume: &Volume, view: View) -> Picture {
    let mut source = InMemory::new(volume).unwrap();
    let of_source = of_source(&mut source, view, Select::default(), &ignore).unwrap();
    let bricks = CompressOptions { brick: Some([2; 3]), ..CompressOptions::default() };
    let of_container =
        of_container(&stored(volume, &bricks), view, Select::default(), 0, (None, &ignore)).unwrap();
    assert_eq!(of_source, of_container);
    of_source
}

#[test]
fn slices_show_the_samples_at_their_place() {
    let volume = places();
    for at in [0, 2] {
        let z = picture(&volume, View::Slice(Axis::Z, Some(at)));
        assert_eq!((z.size, z.values[7]), ([5, 3], (12 + 100 * at) as f64));
        let y = picture(&volume, View::Slice(Axis::Y, Some(at)));
        assert_eq!((y.size, y.values[7]), ([5, 4], (102 + 10 * at) as f64));
        let x = picture(&volume, View::Slice(Axis::X, Some(at)));
        assert_eq!((x.size, x.values[7]), ([3, 4], (210 + at) as f64));
    }
    assert_eq!(picture(&volume, View::Slice(Axis::Z, None)).values[0], 200.0);
}

#[test]
fn maxima_are_those_along_the_axis() {
    let mut volume = generate(Kind::Noise, [7, 6, 5], ElementType::I16, 3);
    volume.samples.truncate(2 * 7 * 6 * 5);
    let sample = |x: usize, y: usize, z: usize| {
        let at = 2 * ((z * 6 + y) * 7 + x);
        f64::from(i16::from_le_bytes([volume.samples[at], volume.samples[at + 1]]))
    };
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::MIN, f64::max);
    let z = picture(&volume, View::Maximum(Axis::Z));
    assert_eq!(z.values[2 * 7 + 3], most(&mut (0..5).map(|z| sample(3, 2, z))));
    let y = picture(&volume, View::Maximum(Axis::Y));
    assert_eq!(y.values[2 * 7 + 3], most(&mut (0..6).map(|y| sample(3, y, 2))));
    let x = picture(&volume, View::Maximum(Axis::X));
    assert_eq!(x.values[2 * 6 + 3], most(&mut (0..7).map(|x| sample(x, 3, 2))));
}

#[test]
fn components_are_colors() {
    let volume = places();
    let mut header = Header::scalar([4, 2, 1], ElementType::U8, Metadata::default());
    (header.components, header.steps) = (3, 2);
    let samples = &volume.samples[..48];
    let mut source = InMemory::of(header, samples).unwrap();
    let view = View::Slice(Axis::Z, None);
    let colors = of_source(&mut source, view, Select { step: 1, component: None }, &ignore).unwrap();
    assert_eq!((colors.size, colors.channels), ([4, 2], 3));
    assert_eq!(colors.shades(colors.usual_window(), Depth::Eight), samples[24..]);
    let green = of_source(&mut source, view, Select { step: 0, component: Some(1) }, &ignore).unwrap();
    let expected: Vec<f64> = samples[..24].iter().skip(1).step_by(3).map(|&value| value.into()).collect();
    assert_eq!((green.channels, green.values), (1, expected));
    of_source(&mut source, view, Select { step: 2, component: None }, &ignore).unwrap_err();
    of_source(&mut source, view, Select { step: 0, component: Some(3) }, &ignore).unwrap_err();
    of_source(&mut source, View::Slice(Axis::Y, Some(2)), Select::default(), &ignore).unwrap_err();
}

#[test]
fn coarse_levels_give_the_size_asked_for() {
    let volume = generate(Kind::Waves, [64, 40, 30], ElementType::U8, 3);
    let bricks = CompressOptions { brick: Some([16; 3]), ..CompressOptions::default() };
    let container = stored(&volume, &bricks);
    let view = View::Slice(Axis::Z, Some(13));
    for (size, level) in [(1000, 0), (64, 0), (33, 0), (32, 1), (16, 2)] {
        assert_eq!(suitable_level(&container, view, 0, size).unwrap(), level, "{size}");
    }
    for level in 0..=2 {
        let picture = of_container(&container, view, Select::default(), level, (None, &ignore)).unwrap();
        assert_eq!(picture.size, [64 >> level, 40 >> level]);
        let whole =
            container.read(&crate::codec::Part { level, ..Default::default() }, None, &ignore).unwrap();
        let plane = (picture.size[0] * picture.size[1]) as usize;
        let start = plane * (13 >> level);
        let expected = whole.samples[start..start + plane].iter().map(|&value| f64::from(value));
        assert!(picture.values.iter().copied().eq(expected), "level {level}");
    }
}

#[test]
fn windows_put_values_between_black_and_white() {
    let mut volume = places();
    volume.samples.truncate(2 * 5 * 3 * 4);
    let picture = picture(&volume, View::Slice(Axis::Z, Some(0)));
    let shades = picture.shades(Window::Values(0.0, 24.0), Depth::Sixteen);
    assert_eq!((&shades[..2], &shades[28..]), (&[0, 0][..], &[255, 255][..]));
    assert_eq!(shades[2 * 7..2 * 8], (32768_u16).to_be_bytes());
    assert_eq!(Window::Percentiles(0.0, 100.0).ends(&picture.values), [0.0, 24.0]);
    assert_eq!(Window::Percentiles(0.0, 50.0).ends(&[f64::NAN, 5.0, 1.0, f64::INFINITY, 3.0]), [1.0, 3.0]);
    assert_eq!(Window::default().ends(&[f64::NAN]), [0.0; 2]);
    assert_eq!(Window::values("-3.5:7"), Ok(Window::Values(-3.5, 7.0)));
    for text in ["", "1", "2:1", "1:1", "a:b", "0:inf", "nan:1"] {
        Window::values(text).unwrap_err();
    }
    Window::percentiles("0:101").unwrap_err();
    let constant = Picture { values: vec![3.0, f64::NAN, 3.0], size: [3, 1], ..picture };
    assert_eq!(constant.shades(Window::default(), Depth::Eight), [0; 3]);
}
