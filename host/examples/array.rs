//! An array to a compressed file, and a part of it back.
//!
//! `cargo run --example array`

use std::error::Error;

use wavelift_host::array::Samples;
use wavelift_host::codec::{CompressOptions, Container, Part, compress_file};
use wavelift_host::ndarray::{Array3, s};
use wavelift_host::progress::ignore;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("hill.wlift");

    // Shape z, y, x, as NumPy shows it.
    let hill = |(z, y, x): (usize, usize, usize)| 1000 + (z * (40 - z) + y * (60 - y) + x * (80 - x)) as u16;
    let array = Array3::from_shape_fn((40, 60, 80), hill);
    let samples = Samples::of_array(array.view())?.with_spacing([0.5, 0.5, 2.0]);
    let report = compress_file(&path, &mut samples.source(), &CompressOptions::default(), &ignore)?;
    println!("{} bytes of samples in {} bytes", report.sample_bytes, report.container_bytes);

    // Regions are counted x, y, z. Only the bricks that it meets are read.
    let container = Container::open(&path)?;
    let corner: Array3<u16> = container.read_array(&Part::region([10..74, 20..50, 30..35]), None, &ignore)?;
    assert_eq!(corner, array.slice(s![30..35, 20..50, 10..74]));
    println!("the largest sample there is {:?}", corner.iter().max());
    println!("samples are {:?} apart", container.metadata()?.spacing());
    Ok(())
}
