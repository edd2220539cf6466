//! What a device has to lend the kernel.

use std::error::Error;

use serde_json::json;
use wavelift_host::codec::Grid;
use wavelift_kernel::{Codec, Extent, Plan, SampleType, Wavelet, max_encoded_len};

/// Extents that the memory is told of: a line, a slice, a small brick and the brick that volumes are cut into.
fn extents() -> Result<[Extent; 4], Box<dyn Error>> {
    let [x, y, z] = Grid::default_sides([4096; 3]);
    Ok([Extent::line(4096)?, Extent::slice(512, 512)?, Extent::brick(16, 16, 16)?, Extent::brick(x, y, z)?])
}

/// Prints a row for each of a few extents: state and scratch of the coder, samples, longest codestream, in bytes.
pub(crate) fn measure() -> Result<(), Box<dyn Error>> {
    for extent in extents()? {
        let plan = Plan::new(Wavelet::Linear, extent, extent.max_levels())?;
        let row = json!({
            "measure": "memory",
            "extent": extent.axes(),
            "state": size_of::<Codec>(),
            "scratch": size_of::<i32>() * plan.scratch_len(),
            "samples": size_of::<i32>() * extent.samples(),
            "output": max_encoded_len(extent, SampleType::U16),
        });
        println!("{row}");
    }
    Ok(())
}
