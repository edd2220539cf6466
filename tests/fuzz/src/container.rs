//! Any bytes as a container file, as they are and with their checksums made right, so that damage reaches what lies
//! behind these.

use std::path::PathBuf;

use wavelift_host::codec::{Container, Index, Part};

/// Bytes of the header and of the footer, as `host/docs/container.md` has them.
const ENDS: [usize; 2] = [12, 32];

/// Samples that are read; a larger volume is only opened.
const MOST_SAMPLES: u64 = 1 << 18;

/// Opens, verifies and reads the file, and the file with checksums that fit.
pub fn check(bytes: &[u8]) {
    open(bytes);
    if let Some(sealed) = seal(bytes) {
        open(&sealed);
    }
}

fn open(bytes: &[u8]) {
    let path: PathBuf = std::env::temp_dir().join(format!("wavelift-fuzz-{}", std::process::id()));
    std::fs::write(&path, bytes).expect("a file for the container");
    if let Ok(container) = Container::open(&path) {
        let grid = container.index().grid;
        let samples = grid.extent.iter().try_fold(1_u64, |product, &axis| product.checked_mul(axis));
        if samples.is_some_and(|samples| samples <= MOST_SAMPLES) {
            let threads = std::num::NonZeroUsize::new(1);
            container.verify(threads, &|_| {}, &|_| {}).expect("threads");
            for level in 0..=container.index().readable_levels.saturating_add(1) {
                let _ = container.read(&Part { level, region: None }, threads, &|_| {});
            }
        }
    }
    std::fs::remove_file(&path).expect("the file is there");
}

/// The bytes with the checksums of bricks, index and footer, and the position of the index, as they should be; `None`
/// if there is no index to be found.
fn seal(bytes: &[u8]) -> Option<Vec<u8>> {
    let end = bytes.len().checked_sub(ENDS[1]).filter(|&end| end >= ENDS[0])?;
    let length = u64::from_le_bytes(bytes[end + 8..end + 16].try_into().ok()?);
    let position = end.checked_sub(usize::try_from(length).ok()?).filter(|&position| position >= ENDS[0])?;
    let mut index: Index = postcard::from_bytes(&bytes[position..end]).ok()?;
    let mut at = ENDS[0];
    for brick in &mut index.bricks {
        let next = at.checked_add(usize::try_from(brick.bytes()).ok()?)?;
        brick.stored_crc = crc32fast::hash(bytes.get(at..next)?);
        at = next;
    }
    let index = postcard::to_allocvec(&index).ok()?;
    let mut sealed = [&bytes[..position], &index].concat();
    let mut footer = [(position as u64).to_le_bytes(), (index.len() as u64).to_le_bytes()].concat();
    footer.extend(crc32fast::hash(&index).to_le_bytes());
    footer.extend(crc32fast::hash(&footer).to_le_bytes());
    footer.extend(b"WLIFTEND");
    sealed.extend(footer);
    Some(sealed)
}
