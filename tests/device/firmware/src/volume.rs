//! A small volume, brick by brick, and the record that says where each is: sent to the host, which reads them back.

use embedded_io::Write;
use fixture::{crc32, fill_part};
use wavelift_kernel::record::{Entry, IndexRecord};
use wavelift_kernel::{Effort, Extent, Feature, Header, Plan, SampleType, Wavelet, io};

use crate::file::File;
use crate::memory::Parts;

/// Bricks of the volume, one after another along x.
const BRICKS: usize = 4;

/// Samples along each axis of a brick.
const SIDE: u32 = 8;

/// Sends the volume; whether that went well.
pub(crate) fn run(parts: &mut Parts<'_>) -> bool {
    let sent = send(parts);
    if let Some(record) = &sent {
        defmt::info!("sent {}", record);
    } else {
        defmt::error!("the volume was not sent");
    }
    sent.is_some()
}

fn send(parts: &mut Parts<'_>) -> Option<IndexRecord<BRICKS>> {
    let mut codestreams = File::create(c"volume.wlc").ok()?;
    let mut record = IndexRecord::<BRICKS>::default();
    for number in 0..BRICKS as u32 {
        let position = [SIDE * number, 0, 0];
        let codestream = encode(position, parts)?;
        let header = Header::parse(codestream).ok()?;
        let entry = Entry::new(position, &header, crc32(codestream.iter().copied()));
        defmt::info!("brick at {}: {}", position, header);
        io::write(codestream, &mut codestreams).ok()?;
        record.entries.push(entry).ok()?;
    }
    let mut bytes = [0; IndexRecord::<BRICKS>::MAX_BYTES];
    let written = record.to_slice(&mut bytes).ok()?;
    File::create(c"volume.index").ok()?.write_all(written).ok()?;
    Some(record)
}

/// The codestream of the brick at `position`.
fn encode<'a>(position: [u32; 3], parts: &'a mut Parts<'_>) -> Option<&'a [u8]> {
    let extent = Extent::new([SIDE; 3]).ok()?;
    let plan = Plan::new(Wavelet::Linear, extent, 2).ok()?;
    let samples = &mut parts.samples[..extent.samples()];
    fill_part(position, extent.axes(), samples);
    let codec = &mut parts.codec;
    let effort = if Feature::Adaptive.is_built() { Effort::Fast } else { Effort::Light };
    let len = codec.encode(effort, &plan, SampleType::U16, samples, parts.scratch, parts.bytes).ok()?;
    parts.bytes.get(..len)
}
