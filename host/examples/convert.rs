//! From one format to another, a piece at a time, with progress, and stopped half-way the first time.
//!
//! `cargo run --example convert -- head.nrrd head.npy`

use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use wavelift_host::volume::synthetic::{Kind, generate};
use wavelift_host::volume::{self, CopyError, Created, ElementType, WriteOptions};

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from).filter(|path| path.extension().is_some());
    let (from, to) = match (paths.next(), paths.next()) {
        (Some(from), Some(to)) => (from, to),
        _ => {
            let from = folder.path().join("waves.nrrd");
            let volume = generate(Kind::Waves, [256, 256, 100], ElementType::U16, 1);
            volume::write(&volume, &from, &WriteOptions::default())?;
            (from, folder.path().join("waves.npy"))
        }
    };
    let samples: u64 = volume::open(&from, None)?.header().extent.into_iter().product();
    // Whoever follows the work can stop it: no file is left then.
    match copy(&from, &to, samples / 2) {
        Err(error) if matches!(error.downcast_ref(), Some(CopyError::Stopped(_))) => println!("{error}"),
        outcome => outcome?,
    }
    copy(&from, &to, u64::MAX)?;
    println!("{} is {} bytes", to.display(), std::fs::metadata(&to)?.len());
    Ok(())
}

/// Copies a file, unless it has more samples than `most`.
fn copy(from: &Path, to: &Path, most: u64) -> Result<(), Box<dyn Error>> {
    let mut source = volume::open(from, None)?;
    let Created { sink, losses } = volume::create(to, source.header(), &WriteOptions::default())?;
    for loss in losses {
        println!("{} has no place for {loss}", to.display());
    }
    let done = AtomicU64::new(0);
    let progress = |samples| {
        let done = done.fetch_add(samples, Ordering::Relaxed) + samples;
        if done < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    Ok(volume::copy(source.as_mut(), sink, &progress)?)
}
