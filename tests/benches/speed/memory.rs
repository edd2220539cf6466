//! What a device has to lend the kernel.

use std::error::Error;

use serde_json::json;
use wavelift_host::codec::Grid;
use wavelift_kernel::{Codec, Dense, Extent, Lattice, Plan, SampleType, Training, Wavelet, max_encoded_len};

/// Extents that the memory is told of: a line, a slice, a small brick and the brick that volumes are cut into.
fn extents() -> Result<[Extent; 4], Box<dyn Error>> {
    let [x, y, z] = Grid::default_sides([4096; 3], Grid::SMALL_BRICK);
    Ok([Extent::line(4096)?, Extent::slice(512, 512)?, Extent::brick(16, 16, 16)?, Extent::brick(x, y, z)?])
}

/// Prints a row for each way to code each of a few extents: the state of encoder and of decoder, the encoder's scratch,
/// samples, longest codestream, in bytes.
pub(crate) fn measure() -> Result<(), Box<dyn Error>> {
    let [codec, dense, lattice] = [size_of::<Codec>(), size_of::<Dense>(), size_of::<Lattice>()];
    let trained = codec + size_of::<Training>();
    for extent in extents()? {
        let transform = Plan::new(Wavelet::Linear, extent, extent.max_levels())?.scratch_len();
        let surroundings = Dense::scratch_len(&Plan::new(Wavelet::Linear, extent, 0)?);
        let ways = [
            ("fast", [codec, codec], transform),
            ("default", [trained, codec], transform),
            ("dense", [trained + dense, codec + dense], surroundings),
            ("lattice", [lattice, lattice], Lattice::encoding_scratch_len(extent)),
        ];
        for (way, [encoder, decoder], scratch) in ways {
            let row = json!({
                "measure": "memory",
                "extent": extent.axes(),
                "way": way,
                "encoder": encoder,
                "decoder": decoder,
                "scratch": size_of::<i32>() * scratch,
                "samples": size_of::<i32>() * extent.samples(),
                "output": max_encoded_len(extent, SampleType::U16),
            });
            println!("{row}");
        }
    }
    Ok(())
}
