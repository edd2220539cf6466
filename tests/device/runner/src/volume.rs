//! The volume that the firmware sent: codestreams one after another, and a record that says where each is.

use std::path::Path;

use fixture::{crc32, fill_part};
use wavelift_kernel::record::{Entry, IndexRecord};
use wavelift_kernel::{Codec, Effort, Header};

use crate::brick::encode_samples;

/// More entries than any firmware sends.
const MOST: usize = 64;

/// Reads the record and every codestream it names, compares them with the host's, and says how many there are.
pub(crate) fn compare(folder: &Path) -> Result<usize, String> {
    let read = |name: &str| std::fs::read(folder.join(name)).map_err(|error| format!("{name}: {error}"));
    let (index, volume) = (read("volume.index")?, read("volume.wlc")?);
    let (record, rest) =
        IndexRecord::<MOST>::from_bytes(&index).map_err(|error| format!("volume.index: {error}"))?;
    if !rest.is_empty() {
        return Err("volume.index: bytes follow the record".to_owned());
    }
    let mut left = volume.as_slice();
    for entry in &record.entries {
        let len = usize::try_from(entry.bytes).ok().filter(|len| *len <= left.len());
        let (codestream, after) = left.split_at(len.ok_or("volume.wlc: ends before its last entry")?);
        check(entry, codestream).map_err(|error| format!("{entry:?}: {error}"))?;
        left = after;
    }
    match (record.entries.len(), left) {
        (0, _) => Err("volume.index: no entry".to_owned()),
        (count, []) => Ok(count),
        _ => Err("volume.wlc: bytes that no entry names".to_owned()),
    }
}

/// Compares a codestream with what the record says of it, and with the samples that it must hold.
fn check(entry: &Entry, codestream: &[u8]) -> Result<(), String> {
    let header = Header::parse(codestream).map_err(|error| error.to_string())?;
    let checksum = crc32(codestream.iter().copied());
    if *entry != Entry::new(entry.position, &header, checksum) {
        return Err("the codestream is another".to_owned());
    }
    let plan = header.plan();
    let mut expected = vec![0; plan.extent().samples()];
    fill_part(entry.position, entry.extent, &mut expected);
    let (mut samples, mut scratch) = (vec![0; expected.len()], vec![0; header.scratch_len()]);
    let mut codec = Box::new(Codec::NEW);
    let decoded = codec.decode(codestream, &mut samples, &mut scratch);
    decoded.map_err(|error| error.to_string())?;
    if samples != expected {
        return Err("other samples".to_owned());
    }
    for effort in [Effort::Fast, Effort::Light] {
        if encode_samples(effort, &plan, &mut expected.clone())? == codestream {
            return Ok(());
        }
    }
    Err("the host encodes the brick in other bytes".to_owned())
}
