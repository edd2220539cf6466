//! Codings of chunks that programs bring along: LZF, Blosc, bitshuffle and Zstandard.
//!
//! Sources: the list of registered filters of The HDF Group for their numbers; *LibLZF* (M. Lehmann) as h5py has it; K.
//! Masui et al., *A compression scheme for radio data in high performance computing* (Astronomy and Computing 12, 2015)
//! for bitshuffle, with its filter for what stands before the blocks; RFC 8878 for Zstandard.

use std::borrow::Cow;
use std::io::Read;

use hdf5_reader::FilterRegistry;
use hdf5_reader::error::Error;
use ruzstd::decoding::StreamingDecoder;
#[cfg(feature = "zarr")]
use zarrs::array::codec::{blosc_decompress_bytes, blosc_validate};

const LZF: u16 = 32_000;
#[cfg(feature = "zarr")]
const BLOSC: u16 = 32_001;
const BITSHUFFLE: u16 = 32_008;
const ZSTD: u16 = 32_015;

/// What is said of bitshuffle: the bytes of a value, the values of a block or 0, and what compresses blocks.
const VALUE: usize = 2;
const BLOCK: usize = 3;
const COMPRESSOR: usize = 4;

/// Bytes that a block of bitshuffle has at most if nothing else is said, and the values that it has at least.
const USUAL_BLOCK_BYTES: usize = 1 << 13;
const LEAST_BLOCK: usize = 128;

/// A byte of LZ4 stands for at most so many.
const LZ4_RATIO: usize = 255;

/// All codings that are read, none of which makes more than `most` bytes of a chunk.
pub(super) fn registry(most: usize) -> FilterRegistry {
    let mut registry = FilterRegistry::new();
    registry.register(LZF, Box::new(move |_, bytes, _| told("LZF", lzf(bytes, most))));
    #[cfg(feature = "zarr")]
    registry.register(BLOSC, Box::new(move |_, bytes, _| told("Blosc", blosc(bytes, most))));
    registry.register(ZSTD, Box::new(move |_, bytes, _| told("Zstandard", zstd(bytes, most))));
    let shuffled = move |said: &[u32], bytes: &[u8], size: usize| bitshuffle(said, bytes, size, most);
    registry.register(
        BITSHUFFLE,
        Box::new(move |filter, bytes, size| told("bitshuffle", shuffled(&filter.client_data, bytes, size))),
    );
    registry
}

fn told(name: &str, decoded: Option<Vec<u8>>) -> Result<Vec<u8>, Error> {
    decoded.ok_or_else(|| {
        Error::DecompressionError(format!("a chunk in {name} is damaged, or in a form not read"))
    })
}

/// Decodes runs of bytes and references to what came before.
fn lzf(mut bytes: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    while let Some(control) = next(&mut bytes) {
        if control < 32 {
            let (run, rest) = bytes.split_at_checked(control + 1)?;
            out.extend_from_slice(run);
            bytes = rest;
        } else {
            let more = if control >> 5 == 7 { next(&mut bytes)? } else { 0 };
            let back = ((control & 31) << 8) + next(&mut bytes)? + 1;
            let first = out.len().checked_sub(back)?;
            // What is referred to may reach into what it makes.
            (first..first + (control >> 5) + more + 2).for_each(|place| out.push(out[place]));
        }
        if out.len() > most {
            return None;
        }
    }
    Some(out)
}

fn next(bytes: &mut &[u8]) -> Option<usize> {
    let (&byte, rest) = bytes.split_first()?;
    *bytes = rest;
    Some(byte.into())
}

fn zstd(bytes: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    let decoder = StreamingDecoder::new(bytes).ok()?;
    decoder.take(most as u64 + 1).read_to_end(&mut out).ok()?;
    (out.len() <= most).then_some(out)
}

/// Decodes with the library that Zarr's chunks are decoded with; where Zarr is left out, so is this.
#[cfg(feature = "zarr")]
fn blosc(bytes: &[u8], most: usize) -> Option<Vec<u8>> {
    let len = blosc_validate(bytes).filter(|&len| len <= most)?;
    blosc_decompress_bytes(bytes, len, 1).ok()
}

/// Decodes a block that has so many bytes then.
type Decode = fn(&[u8], usize) -> Option<Vec<u8>>;

/// Decodes blocks of values whose bits lie together by their place in a value, compressed or not. Behind them are the
/// values that are too few for a byte of such bits, as they are.
fn bitshuffle(said: &[u32], bytes: &[u8], size: usize, most: usize) -> Option<Vec<u8>> {
    let said = |what: usize| said.get(what).map_or(0, |&number| number as usize);
    let size = if said(VALUE) == 0 { size } else { said(VALUE) };
    let usual = (USUAL_BLOCK_BYTES.checked_div(size)? / 8 * 8).max(LEAST_BLOCK);
    let mut rest = bytes;
    let (decode, total, block): (Option<Decode>, usize, usize) = match said(COMPRESSOR) {
        0 => (None, bytes.len(), if said(BLOCK) == 0 { usual } else { said(BLOCK) }),
        2 => (Some(lz4), big_endian::<8>(&mut rest)?, big_endian::<4>(&mut rest)? / size),
        3 => (Some(zstd), big_endian::<8>(&mut rest)?, big_endian::<4>(&mut rest)? / size),
        _ => return None,
    };
    if total > most || block == 0 || !block.is_multiple_of(8) {
        return None;
    }
    let (mut out, mut values) = (Vec::new(), total / size);
    while values >= 8 {
        let count = block.min(values / 8 * 8);
        unshuffle(&next_block(&mut rest, count * size, decode)?, size, &mut out);
        values -= count;
    }
    out.extend_from_slice(rest);
    (out.len() == total).then_some(out)
}

/// The number that comes next.
fn big_endian<const BYTES: usize>(bytes: &mut &[u8]) -> Option<usize> {
    let (number, rest) = bytes.split_first_chunk::<BYTES>()?;
    *bytes = rest;
    usize::try_from(number.iter().fold(0, |number, &byte| number << 8 | u64::from(byte))).ok()
}

/// The block of so many bytes that comes next.
fn next_block<'a>(bytes: &mut &'a [u8], len: usize, decode: Option<Decode>) -> Option<Cow<'a, [u8]>> {
    let stored = if decode.is_some() { big_endian::<4>(bytes)? } else { len };
    let (stored, rest) = bytes.split_at_checked(stored)?;
    *bytes = rest;
    let Some(decode) = decode else { return Some(stored.into()) };
    decode(stored, len).filter(|block| block.len() == len).map(Cow::from)
}

fn lz4(bytes: &[u8], len: usize) -> Option<Vec<u8>> {
    let is_possible = len / LZ4_RATIO <= bytes.len();
    is_possible.then(|| lz4_flex::block::decompress(bytes, len).ok())?
}

/// Appends the values of which `bits` has first the lowest bit of the first byte of all, then the next, and so on.
fn unshuffle(bits: &[u8], size: usize, out: &mut Vec<u8>) {
    let (start, plane) = (out.len(), bits.len() / size / 8);
    out.resize(start + bits.len(), 0);
    for (group, values) in out[start..].chunks_exact_mut(8 * size).enumerate() {
        for place in 0..size {
            let bits_of_eight = std::array::from_fn(|bit| bits[(8 * place + bit) * plane + group]);
            for (value, byte) in transposed(bits_of_eight).into_iter().enumerate() {
                values[value * size + place] = byte;
            }
        }
    }
}

/// Eight bytes of eight bits, with bit `i` of byte `k` as bit `k` of byte `i`: blocks of 1, 2 and 4 bits change places.
///
/// Source: H. S. Warren, *Hacker's Delight* (2013), section 7-3.
fn transposed(bytes: [u8; 8]) -> [u8; 8] {
    let mut bits = u64::from_le_bytes(bytes);
    for (mask, by) in [(0x00AA_00AA_00AA_00AA, 7), (0x0000_CCCC_0000_CCCC, 14), (0x0000_0000_F0F0_F0F0, 28)] {
        let changed = (bits ^ bits >> by) & mask;
        bits ^= changed ^ changed << by;
    }
    bits.to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_may_reach_into_what_they_make() {
        // "ab", then 10 bytes from 2 back, 7 + 1 + 2 of them; then 3 from 12 back.
        let coded = [1, b'a', b'b', 7 << 5, 1, 1, 1 << 5, 11];
        assert_eq!(lzf(&coded, 15).unwrap(), b"abababababababa");
        assert_eq!(lzf(&coded, 14), None);
        for wrong in [&coded[..2], &coded[..4], &coded[..5], &[1 << 5, 0]] {
            assert_eq!(lzf(wrong, 99), None, "{wrong:?}");
        }
    }

    #[test]
    fn bits_find_their_values_again() {
        let value = |index: usize| (index * 40_503) as u16;
        let values = (0..24).map(value);
        let bytes: Vec<u8> = values.clone().flat_map(u16::to_le_bytes).collect();
        // Blocks of 16 and 8 values; bit by bit, as the definition says.
        let mut bits = Vec::new();
        for block in [0..16, 16..24] {
            let eights: Vec<Vec<u16>> =
                (block.clone().step_by(8)).map(|i| (i..i + 8).map(value).collect()).collect();
            for bit in 0..16 {
                let byte = |eight: &Vec<u16>| (0..8).map(|i| ((eight[i] >> bit & 1) as u8) << i).sum::<u8>();
                bits.extend(eights.iter().map(byte));
            }
        }
        // Three values more are as they are.
        let more = [1, 2, 3, 4, 5, 6];
        let expected = [&bytes[..], &more].concat();
        let stored = [&bits[..], &more].concat();
        assert_eq!(bitshuffle(&[0, 4, 2, 16, 0], &stored, 2, 99).unwrap(), expected);
        let mut packed = [54_u64.to_be_bytes().to_vec(), 32_u32.to_be_bytes().to_vec()].concat();
        for block in [&bits[..32], &bits[32..]] {
            let coded = lz4_flex::block::compress(block);
            packed.extend((coded.len() as u32).to_be_bytes());
            packed.extend(coded);
        }
        packed.extend(more);
        assert_eq!(bitshuffle(&[0, 4, 2, 0, 2], &packed, 2, 54).unwrap(), expected);
        for end in 0..packed.len() {
            assert_eq!(bitshuffle(&[0, 4, 2, 0, 2], &packed[..end], 2, 54), None, "{end}");
        }
        assert_eq!(bitshuffle(&[0, 4, 2, 0, 2], &packed, 2, 53), None);
        assert_eq!(bitshuffle(&[0, 4, 2, 0, 9], &packed, 2, 54), None);
        assert_eq!(bitshuffle(&[0, 4, 2, 12, 0], &stored, 2, 99), None);
        assert_eq!(bitshuffle(&[], &[], 0, 99), None);
    }

    #[test]
    fn no_chunk_becomes_longer_than_it_may() {
        let coded =
            ruzstd::encoding::compress_to_vec(&[7_u8; 1000][..], ruzstd::encoding::CompressionLevel::Fastest);
        assert_eq!(zstd(&coded, 1000).unwrap(), [7; 1000]);
        assert_eq!(zstd(&coded, 999), None);
        assert_eq!(lz4(&[0; 9], 1 << 40), None);
    }

    #[cfg(feature = "zarr")]
    #[test]
    fn blosc_is_looked_through_first() {
        // Stored as it is: version 2, shuffled by nothing, values of one byte; 5 bytes in a block of 5, 21 in all.
        let coded = [&[2, 1, 0x02, 1][..], &[5, 0, 0, 0, 5, 0, 0, 0, 21, 0, 0, 0], b"abcde"].concat();
        assert_eq!(blosc(&coded, 5).unwrap(), b"abcde");
        assert_eq!(blosc(&coded, 4), None);
        for end in 0..coded.len() {
            assert_eq!(blosc(&coded[..end], 5), None, "{end}");
        }
    }
}
