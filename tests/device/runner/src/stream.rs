//! The streams that the firmware encoded: the host's have the same bytes.

use std::collections::BTreeMap;

use fixture::{SLABS, SLABS_OF_ROWS, SLICE, VOLUME, crc32, fill_part};
use wavelift_kernel::io::{SampleWriter, StreamEncoder};
use wavelift_kernel::stream::{RowCodec, RowEncoder, RowPlan, SlabEncoder, SlabMemory, SlabPlan};
use wavelift_kernel::{Codec, Effort, Extent, SampleType};

use crate::brick::{number, wavelet};
use crate::log::Log;

/// Compares every stream of the log, and says how many there are.
pub(crate) fn compare(log: &Log) -> Result<usize, String> {
    let mut count = 0;
    for record in log.records("stream") {
        let (len, checksum) = (number(&record, "bytes")?, number(&record, "crc32")?);
        let stream = match record.get("kind").copied() {
            Some("slabs") => slabs(SLABS, &record)?,
            Some("slabs_of_rows") => slabs(SLABS_OF_ROWS, &record)?,
            Some("rows") => rows(&record)?,
            _ => return Err(format!("a stream of no kind: {record:?}")),
        };
        if (len as usize, checksum) != (stream.len(), crc32(stream.iter().copied())) {
            return Err(format!("the host makes other {} bytes of this stream: {record:?}", stream.len()));
        }
        count += 1;
    }
    Ok(count)
}

fn slabs([volume, slab]: [[u32; 3]; 2], record: &BTreeMap<&str, &str>) -> Result<Vec<u8>, String> {
    let extent = Extent::new(slab).map_err(|error| error.to_string())?;
    let plan = SlabPlan::new(wavelet(record)?, extent, levels(record)?, SampleType::U16);
    let plan = plan.map_err(|error| error.to_string())?;
    let (mut samples, mut scratch) = (vec![0; plan.samples_len()], vec![0; plan.scratch_len()]);
    let (mut bytes, mut codec) = (vec![0; plan.bytes_len()], Box::new(Codec::NEW));
    let memory = SlabMemory { samples: &mut samples, scratch: &mut scratch, bytes: &mut bytes };
    let effort = if record.get("effort") == Some(&"light") { Effort::Light } else { Effort::Fast };
    let encoder = SlabEncoder::new(&plan, &mut codec, effort, memory).map_err(|error| error.to_string())?;
    encode(encoder, volume)
}

fn rows(record: &BTreeMap<&str, &str>) -> Result<Vec<u8>, String> {
    let [width, height] = SLICE;
    let plan = RowPlan::new(wavelet(record)?, width, levels(record)?, SampleType::U16);
    let plan = plan.map_err(|error| error.to_string())?;
    let (mut codec, mut memory) = (Box::new(RowCodec::NEW), vec![0; plan.encoder_memory_len()]);
    let encoder = RowEncoder::new(&plan, &mut codec, &mut memory).map_err(|error| error.to_string())?;
    encode(encoder, [width, height, 1])
}

fn encode(encoder: impl StreamEncoder, extent: [u32; 3]) -> Result<Vec<u8>, String> {
    let (mut samples, mut bytes) = (vec![0; VOLUME], vec![0; 4 * VOLUME]);
    fill_part([0; 3], extent, &mut samples);
    let mut writer = SampleWriter::new(encoder, bytes.as_mut_slice());
    writer.write(&samples).map_err(|error| error.to_string())?;
    let left = writer.finish().map_err(|error| error.to_string())?.len();
    bytes.truncate(bytes.len() - left);
    Ok(bytes)
}

fn levels(record: &BTreeMap<&str, &str>) -> Result<u8, String> {
    number(record, "levels")?.try_into().map_err(|_| "too many levels".to_owned())
}
