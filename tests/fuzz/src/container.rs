//! Any bytes as a container file, as they are and with their checksums made right, so that damage reaches what lies
//! behind these.

use wavelift_host::codec::{BrickLabel, Container, Part, Scanner};
use wavelift_host::progress::ignore;

/// Bytes before the first record and of the footer, as `host/docs/container.md` has them.
const ENDS: [usize; 2] = [10, 12];

/// Values that are read; of a larger file only what stands before the bricks is.
const MOST_VALUES: u64 = 1 << 18;

/// Opens, verifies, reads and scans the file, and the file with checksums that fit.
pub fn check(bytes: &[u8]) {
    open(bytes);
    let sealed = seal(bytes);
    open(&sealed);
    for found in Scanner::new(&sealed) {
        found.expect("memory can be read");
    }
}

fn open(bytes: &[u8]) {
    let Ok(container) = Container::new(Box::new(bytes.to_vec())) else { return };
    let Ok(header) = container.header() else { return };
    let values = header.bytes().map(|bytes| bytes / header.element.bytes() as u64);
    if values.is_some_and(|values| values <= MOST_VALUES) {
        let threads = std::num::NonZeroUsize::new(1);
        container.verify(threads, &ignore, &|_| {}).expect("threads");
        for level in 0..=3 {
            let _ = container.read_values(&Part { level, ..Part::default() }, threads, &ignore);
        }
    }
}

/// The bytes with the checksums of all records, bricks and the footer as they should be, as far as records follow each
/// other.
fn seal(bytes: &[u8]) -> Vec<u8> {
    let mut sealed = bytes.to_vec();
    let mut at = ENDS[0];
    while let Some(end) = seal_record(&mut sealed, at) {
        at = end;
    }
    if let Some(footer) = sealed.len().checked_sub(ENDS[1]) {
        let crc = crc32fast::hash(&sealed[footer..footer + 4]);
        sealed[footer + 4..footer + 8].copy_from_slice(&crc.to_le_bytes());
    }
    sealed
}

/// Makes the checksums of the record at `at` right; returns where the next begins.
fn seal_record(bytes: &mut [u8], at: usize) -> Option<usize> {
    let (len, rest) =
        postcard::take_from_bytes::<u32>(bytes.get(at..)?.strip_prefix(&[0xB7])?.get(1..)?).ok()?;
    let start = bytes.len() - rest.len();
    let end = start.checked_add(usize::try_from(len).ok()?)?;
    let mut after = end.checked_add(4).filter(|&after| after <= bytes.len())?;
    if bytes[at + 1] == b'B' {
        let mut label: BrickLabel = postcard::from_bytes(&bytes[start..end]).ok()?;
        let stored = after..after.checked_add(usize::try_from(label.bytes()).ok()?)?;
        label.stored_crc = crc32fast::hash(bytes.get(stored.clone())?);
        let label = postcard::to_allocvec(&label).ok().filter(|label| label.len() == end - start)?;
        bytes[start..end].copy_from_slice(&label);
        after = stored.end;
    }
    let crc = crc32fast::hash(&bytes[at..end]);
    bytes[end..end + 4].copy_from_slice(&crc.to_le_bytes());
    Some(after)
}
