//! Real volumes and meshes that some tests use where they are.

use std::path::{Path, PathBuf};

/// The folder of the collection: what `WAVELIFT_DATA` names, or else the one beside the repository, which need not be there.
pub(crate) fn collection() -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    std::env::var_os("WAVELIFT_DATA").map_or_else(beside, PathBuf::from)
}
