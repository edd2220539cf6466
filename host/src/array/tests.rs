use ndarray::{Array, Axis, s};

use super::*;
use crate::codec::{CompressOptions, Region, compress};
use crate::progress::ignore;
use crate::volume::Source;

fn numbered() -> Array3<i32> {
    Array::from_shape_fn((6, 5, 7), |(z, y, x)| (100 * z + 10 * y + x) as i32 - 300)
}

fn stored(volume: &Volume) -> Container {
    let mut bytes = Vec::new();
    let options = CompressOptions { brick: Some([4, 3, 2]), ..CompressOptions::default() };
    compress(volume, &options, &mut bytes, &ignore).unwrap();
    Container::new(Box::new(bytes)).unwrap()
}

fn region(from: [u64; 3], to: [u64; 3]) -> Part {
    Part { region: Some(Region { from, to }), ..Part::default() }
}

#[test]
fn arrays_come_back_whole_and_in_parts() {
    let array = numbered();
    let volume = Samples::of_array(array.view()).unwrap().to_volume().unwrap();
    assert_eq!((volume.extent, volume.element), ([7, 5, 6], ElementType::I32));
    assert_eq!(volume.to_array::<i32>().unwrap(), array);
    let container = stored(&volume);
    assert_eq!(container.read_array::<i32>(&Part::default(), None, &ignore).unwrap(), array);
    let part = region([1, 2, 3], [6, 4, 5]);
    let expected = array.slice(s![3..5, 2..4, 1..6]);
    assert_eq!(container.read_array::<i32>(&part, None, &ignore).unwrap(), expected);
    let all = container.read_array5::<i32>(&part, None, &ignore).unwrap();
    assert_eq!(all.shape(), [1, 2, 2, 5, 1]);

    let mut slice = vec![0; 20];
    container.read_into_slice(&part, &mut slice, None, &ignore).unwrap();
    assert!(slice.iter().eq(expected.iter()));
}

#[test]
fn numbers_come_of_any_type() {
    let array = numbered();
    let volume = Samples::of_array(array.view()).unwrap().to_volume().unwrap();
    let numbers = array.mapv(f64::from);
    assert_eq!(volume.to_numbers().unwrap(), numbers);
    let part = region([1, 2, 3], [6, 4, 5]);
    let found = stored(&volume).read_numbers(&part, None, &ignore).unwrap();
    assert_eq!(found, numbers.slice(s![3..5, 2..4, 1..6]));
    let short = Volume { samples: vec![0; 8], ..volume };
    assert!(matches!(short.to_numbers(), Err(ArrayError::WrongShape { .. })));
}

#[test]
fn views_of_larger_arrays_are_filled() {
    let array = numbered();
    let container = stored(&Samples::of_array(array.view()).unwrap().to_volume().unwrap());
    let part = region([1, 2, 3], [6, 4, 5]);
    let mut larger = Array3::<i32>::zeros((8, 8, 8));
    container.read_into_array(&part, larger.slice_mut(s![2..4, 1..3, 3..8]), None, &ignore).unwrap();
    assert_eq!(larger.slice(s![2..4, 1..3, 3..8]), array.slice(s![3..5, 2..4, 1..6]));
    assert_eq!(larger.iter().filter(|value| **value != 0).count(), 20);
    let mut whole = Array3::<i32>::zeros((6, 5, 7));
    container.read_into_array(&Part::default(), whole.view_mut(), None, &ignore).unwrap();
    assert_eq!(whole, array);
}

#[test]
fn wrong_types_and_shapes_are_errors() {
    let container = stored(&Samples::of_array(numbered().view()).unwrap().to_volume().unwrap());
    let part = Part::default();
    let told = container.read_array::<u32>(&part, None, &ignore).unwrap_err().to_string();
    assert_eq!(told, "the samples are i32, not u32: read them as that type, and convert them");
    let short = container.read_into_slice(&part, &mut [0_i32; 209], None, &ignore);
    assert!(matches!(short, Err(ArrayError::WrongShape { .. })));
    let turned = container.read_into_array(&part, Array3::<i32>::zeros((7, 5, 6)).view_mut(), None, &ignore);
    assert!(turned.unwrap_err().to_string().contains("[7, 5, 6] does not hold samples of shape [6, 5, 7]"));
    container.read_array::<i32>(&region([0; 3], [8; 3]), None, &ignore).unwrap_err();
}

#[test]
fn arrays_in_any_order_are_sources() {
    let array = numbered();
    let turned = array.view().permuted_axes((2, 0, 1));
    let samples = Samples::of_array(turned).unwrap();
    assert_eq!(samples.header().extent, [5, 6, 7]);
    let mut bytes = vec![0; 4 * 210];
    samples.source().read(&mut bytes).unwrap();
    let expected: Vec<u8> = turned.iter().flat_map(|value| value.to_le_bytes()).collect();
    assert_eq!(bytes, expected);

    let movie = array.view().insert_axis(Axis(0)).insert_axis(Axis(4));
    let (steps, colors) =
        (movie.broadcast((3, 6, 5, 7, 1)).unwrap(), movie.broadcast((1, 6, 5, 7, 3)).unwrap());
    assert_eq!(Samples::of_array5(steps).unwrap().header().steps, 3);
    let colors = Samples::of_array5(colors).unwrap();
    assert_eq!((colors.header().components, colors.to_volume().is_err()), (3, true));
}

#[test]
fn slices_have_as_many_values_as_their_extent() {
    let values: Vec<f32> = (0..24).map(|value| value as f32 / 4.0).collect();
    let volume = Samples::of_slice([4, 3, 2], &values).unwrap().to_volume().unwrap();
    assert_eq!(volume.to_array::<f32>().unwrap()[[1, 2, 3]], 23.0 / 4.0);
    for extent in [[4, 3, 3], [0, 3, 2], [u64::MAX, u64::MAX, 2]] {
        assert!(matches!(Samples::of_slice(extent, &values), Err(ArrayError::WrongShape { .. })));
    }
    assert!(matches!(Samples::of_slice::<f32>([0; 3], &[]), Err(ArrayError::Empty)));
    assert!(matches!(Samples::of_array(Array3::<u8>::zeros((0, 2, 2)).view()), Err(ArrayError::Empty)));
}
