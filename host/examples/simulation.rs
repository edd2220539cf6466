//! Time steps into a compressed file as they are computed, a plane at a time, with progress; some more later; and work
//! that is stopped half-way.
//!
//! `cargo run --example simulation`

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use wavelift_host::array::Samples;
use wavelift_host::bound::Tolerance;
use wavelift_host::codec::{CompressError, CompressOptions, Container, Label, Part, StepWriter, append_file};
use wavelift_host::ndarray::Array3;
use wavelift_host::progress::{Progress, ignore};
use wavelift_host::volume::{ElementType, Header, Metadata};

/// Cells along each axis.
const SIDE: usize = 48;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("run.wlift");
    let options =
        CompressOptions { tolerance: Some(Tolerance::relative(1e-4)?), ..CompressOptions::default() };

    let done = AtomicU64::new(0);
    let count = |samples| {
        done.fetch_add(samples, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    run(&path, 4, &options, &count)?;
    assert_eq!(done.into_inner(), 4 * (SIDE as u64).pow(3));

    // A step that lies in memory as an array follows them.
    let last = Array3::from_shape_fn((SIDE, SIDE, SIDE), |(z, y, x)| heat(4, [x, y, z]));
    append_file(&path, &mut Samples::of_array(last.view())?.source(), &options, &ignore)?;

    let container = Container::open(&path)?;
    println!("{} time steps in {} bytes", container.steps(), container.bytes());
    for number in 0..container.steps() {
        let step = container.step(number)?;
        let part = Part { step: Some(number), ..Part::region([0..SIDE as u64, 0..1, 0..1]) };
        let line: Array3<f32> = container.read_array(&part, None, &ignore)?;
        println!("{:?} at {:?}: {:?}", step.name, step.time, line[[0, 0, 20]]);
        let bound = step.channels[0].bound.ok_or("a bound was asked for")?.error;
        assert!(f64::from(line[[0, 0, 20]] - heat(number, [20, 0, 0])).abs() <= bound);
    }

    // Whoever follows the work can stop it: the file is as it was.
    let stopped = run(&path, 2, &options, &|_| ControlFlow::Break(()));
    assert!(matches!(stopped, Err(CompressError::Stopped(_))));
    assert_eq!(Container::open(&path)?.steps(), 5);
    Ok(())
}

/// Computes so many time steps, and writes them as a file that is there when all is done.
fn run(
    path: &Path,
    steps: u64,
    options: &CompressOptions,
    progress: Progress<'_>,
) -> Result<(), CompressError> {
    let mut metadata = Metadata::default();
    metadata.set_field("sample units", "K");
    let header = Header::scalar([SIDE as u64; 3], ElementType::F32, metadata);
    let mut file = StepWriter::create(path, &header, options, progress)?;
    for step in 0..steps {
        file.label(Label { name: Some(format!("heat {step}")), time: Some(0.5 * step as f64) });
        for z in 0..SIDE {
            let plane: Vec<f32> =
                (0..SIDE * SIDE).map(|place| heat(step, [place % SIDE, place / SIDE, z])).collect();
            file.write(&plane)?;
        }
    }
    file.finish().map(|_| ())
}

/// A wave that fades.
fn heat(step: u64, cell: [usize; 3]) -> f32 {
    let [x, y, z] = cell.map(|place| place as f32 / SIDE as f32);
    300.0 + 50.0 * (6.0 * x + 3.0 * y * y - z).sin() / (1.0 + step as f32)
}
