//! An array to a compressed file, and a part of it back.
//!
//! `cargo run --example array`

use std::error::Error;

use ndarray::{Array3, s};
use wavelift_host::array::Samples;
use wavelift_host::atomic::AtomicFile;
use wavelift_host::codec::{self, CompressOptions, Container, Part, Region};
use wavelift_host::progress::ignore;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("hill.wlift");

    // Shape z, y, x, as NumPy shows it.
    let hill = |(z, y, x): (usize, usize, usize)| 1000 + (z * (40 - z) + y * (60 - y) + x * (80 - x)) as u16;
    let array = Array3::from_shape_fn((40, 60, 80), hill);
    let volume =
        Samples::of_array(array.view()).ok_or("an array without samples")?.to_volume().ok_or("one volume")?;
    let mut file = AtomicFile::create(&path)?;
    let report = codec::compress(&volume, &CompressOptions::default(), &mut file, &ignore)?;
    file.commit()?;
    println!("{} bytes of samples in {} bytes", report.sample_bytes, report.container_bytes);

    // Regions are counted x, y, z. Only the bricks that it meets are read.
    let container = Container::open(&path)?;
    let region = Region { from: [10, 20, 30], to: [74, 50, 35] };
    let part = Part { region: Some(region), ..Part::default() };
    let corner: Array3<u16> = container.read_array(&part, None, &ignore)?;
    assert_eq!(corner, array.slice(s![30..35, 20..50, 10..74]));
    println!("the largest sample of {region} is {:?}", corner.iter().max());
    Ok(())
}
