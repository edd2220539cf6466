/* Files of vectors/ as arrays of bytes; the Makefile names the folder. */
    .macro bytes name, file
    .global \name
    .global \name\()_end
\name:
    .incbin "\file"
\name\()_end:
    .endm

    .section .rodata
    bytes rt_brick64, "rt_brick64_64x64x64_u8.raw"
    bytes rt_slice512, "rt_slice512_512x512x1_u8.raw"
    bytes linear_brick_crop, "v2/linear_brick_crop.wlc"
    bytes duchaineau_brick_crop, "v2/duchaineau_brick_crop.wlc"
    bytes cubic_slice_crop, "v2/cubic_slice_crop.wlc"
    bytes dense_brick_crop, "v2/dense_brick_crop.wlc"
    bytes lattice_brick_crop, "v2/lattice_brick_crop.wlc"
    bytes tabled_slice_odd, "v2/tabled_slice_odd.wlc"
    bytes wide_high_u32, "v2/wide_high_u32.wlc"

    .section .note.GNU-stack, "", %progbits
