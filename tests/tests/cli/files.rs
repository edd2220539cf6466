//! Files of volumes, written here from the descriptions of their formats.

use conformance::inputs::random;

/// A sample type: its name, its bytes, and its names in `.npy` (after the byte order) and in NRRD.
pub(crate) struct Type {
    pub(crate) name: &'static str,
    pub(crate) bytes: usize,
    pub(crate) npy: &'static str,
    pub(crate) nrrd: &'static str,
}

/// All ten.
pub(crate) const TYPES: [Type; 10] = [
    Type { name: "u8", bytes: 1, npy: "u1", nrrd: "uint8" },
    Type { name: "i8", bytes: 1, npy: "i1", nrrd: "int8" },
    Type { name: "u16", bytes: 2, npy: "u2", nrrd: "uint16" },
    Type { name: "i16", bytes: 2, npy: "i2", nrrd: "int16" },
    Type { name: "u32", bytes: 4, npy: "u4", nrrd: "uint32" },
    Type { name: "i32", bytes: 4, npy: "i4", nrrd: "int32" },
    Type { name: "u64", bytes: 8, npy: "u8", nrrd: "uint64" },
    Type { name: "i64", bytes: 8, npy: "i8", nrrd: "int64" },
    Type { name: "f32", bytes: 4, npy: "f4", nrrd: "float" },
    Type { name: "f64", bytes: 8, npy: "f8", nrrd: "double" },
];

/// Random bytes, which hold every value of any type sooner or later: the ends, NaN, infinities.
pub(crate) fn noise(bytes: usize, seed: u64) -> Vec<u8> {
    (0..bytes as u64).map(|index| random(seed, index) as u8).collect()
}

/// Samples of a field that is smooth along each axis, as little-endian `u16`.
pub(crate) fn smooth_u16([nx, ny, nz]: [u64; 3]) -> Vec<u8> {
    let hill = |n: u64, length: u64| n * (length - n);
    let heights = (0..nz).flat_map(|z| {
        (0..ny).flat_map(move |y| {
            (0..nx).map(move |x| 900 + 5 * hill(x, nx) + 3 * hill(y, ny) + 7 * hill(z, nz))
        })
    });
    heights.flat_map(|height| u16::try_from(height).expect("a low hill").to_le_bytes()).collect()
}

/// The samples with their bytes in the other order.
pub(crate) fn swapped(samples: &[u8], bytes: usize) -> Vec<u8> {
    samples.chunks(bytes).flat_map(|sample| sample.iter().rev()).copied().collect()
}

/// A file as NumPy writes it; `shape` is as in Python, `(3, 4)`.
pub(crate) fn npy(descr: &str, fortran_order: bool, shape: &str, samples: &[u8]) -> Vec<u8> {
    let order = if fortran_order { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend(u16::try_from(length).expect("a short header").to_le_bytes());
    file.extend(format!("{header:<width$}\n", width = length - 1).into_bytes());
    file.extend(samples);
    file
}

/// A file with the lines of a header, a blank line, and samples.
pub(crate) fn nrrd(lines: &[&str], samples: &[u8]) -> Vec<u8> {
    let mut file = (lines.join("\n") + "\n\n").into_bytes();
    file.extend(samples);
    file
}

/// The lines of an NRRD header, and the bytes after it.
pub(crate) fn split_nrrd(file: &[u8]) -> (Vec<&str>, &[u8]) {
    let end = file.windows(2).position(|pair| pair == b"\n\n").map_or(file.len(), |end| end + 2);
    (str::from_utf8(&file[..end]).expect("a header is text").trim_end().lines().collect(), &file[end..])
}
