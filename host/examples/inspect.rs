//! What a compressed file says of its samples without decoding any: and how that saves work.
//!
//! `cargo run --example inspect -- head.wlift`

use std::error::Error;
use std::path::PathBuf;

use wavelift_host::codec::{self, CompressOptions, Container, compress_file};
use wavelift_host::progress::ignore;
use wavelift_host::volume::synthetic::{Kind, generate};
use wavelift_host::volume::{ElementType, InMemory};

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path =
        match std::env::args_os().nth(1).map(PathBuf::from).filter(|path| Container::is_container(path)) {
            Some(path) => path,
            None => made_here(folder.path().join("balls.wlift"))?,
        };
    let container = Container::open(&path)?;
    let header = container.header()?;
    println!("{:?} {} in {} time steps", header.extent, header.element, header.steps);
    println!("spacing {:?}, source {}", header.metadata.spacing(), header.metadata.source.format.name());

    for step in 0..container.steps() {
        let grid = container.grid(step)?;
        let coding = &container.step(step)?.channels[0];
        println!(
            "step {step}: {} bricks, wavelet {:?}, levels to {}",
            grid.bricks(),
            coding.wavelet,
            coding.readable_levels
        );
        // An isosurface passes only through bricks with values on both sides of it.
        let summary = &container.summaries()?[step as usize][0];
        let Some([min, max]) = summary.range(header.element) else { continue };
        let iso = (min + max) / 2.0;
        let is_met =
            |brick: &&codec::Statistics| brick.min(header.element) <= iso && brick.max(header.element) > iso;
        let met = summary.bricks.iter().flatten().filter(is_met).count();
        println!("values {min} to {max}; {met} bricks hold an isosurface at {iso}");
        assert!(met > 0 && met as u64 <= grid.bricks());
    }
    Ok(())
}

/// A file of bright balls in the dark.
fn made_here(path: PathBuf) -> Result<PathBuf, Box<dyn Error>> {
    let volume = generate(Kind::Blobs, [48, 40, 32], ElementType::U16, 1);
    let options = CompressOptions { brick: Some([16; 3]), ..CompressOptions::default() };
    let mut source = InMemory::new(&volume).ok_or("as many samples as its extent says")?;
    compress_file(&path, &mut source, &options, &ignore)?;
    Ok(path)
}
