//! A slice and a maximum of a compressed file as pictures, from the level that is fine enough.
//!
//! `cargo run --example picture -- head.wlift head.png`

use std::error::Error;
use std::path::PathBuf;

use wavelift_host::codec::{self, CompressOptions, Container};
use wavelift_host::preview::{Axis, Depth, Select, View, Window, of_container, suitable_level};
use wavelift_host::progress::ignore;
use wavelift_host::volume::ElementType;
use wavelift_host::volume::synthetic::{Kind, generate};

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let given = paths.next().filter(|path| Container::is_container(path)).zip(paths.next());
    let (container, to) = match given {
        Some((from, to)) => (Container::open(&from)?, to),
        None => {
            let volume = generate(Kind::Waves, [128, 96, 64], ElementType::U16, 1);
            let mut bytes = Vec::new();
            codec::compress(&volume, &CompressOptions::default(), &mut bytes, &ignore)?;
            // A container need not be a file: here it lies in memory.
            (Container::new(Box::new(bytes))?, folder.path().join("waves.png"))
        }
    };
    for view in [View::Slice(Axis::Z, None), View::Maximum(Axis::Y)] {
        let level = suitable_level(&container, view, 0, 64)?;
        let picture = of_container(&container, view, Select::default(), level, (None, &ignore))?;
        picture.write_png(&to, Window::default(), Depth::Eight)?;
        println!("{view:?} at level {level}: {:?} pixels in {}", picture.size, to.display());
    }
    Ok(())
}
