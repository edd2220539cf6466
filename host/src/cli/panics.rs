//! What is printed where a thread panics.

use std::panic;

/// Crates whose panics are caught, and told as faults of the file that they read.
const CAUGHT: [&str; 5] = ["zarrs", "bytes-", "hayro-jpeg2000", "hdf5-", "netcdf-"];

/// Keeps the text of panics that are caught from standard error; all others are printed as ever.
pub(crate) fn print_no_caught() {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        let is_caught = info.location().is_some_and(|place| is_caught(place.file()));
        if !is_caught {
            usual(info);
        }
    }));
}

/// Whether a source file is one of those crates, which lie in folders of their names and versions.
fn is_caught(file: &str) -> bool {
    file.split(['/', '\\']).any(|folder| CAUGHT.iter().any(|name| folder.starts_with(name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crates_are_known_by_their_folders() {
        assert!(is_caught("/home/a/.cargo/registry/src/index/zarrs-0.23.14/src/array.rs"));
        assert!(is_caught(r"C:\cargo\registry\src\index\bytes-1.11.0\src\bytes.rs"));
        assert!(!is_caught("host/src/volume/zarr/source.rs") && !is_caught("kernel/src/lib.rs"));
    }
}
