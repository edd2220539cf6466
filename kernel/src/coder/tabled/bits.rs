//! Bits as they are, the lowest first, in bytes.

use crate::memory::copy;

/// Bytes that are written at once.
const GROUP: usize = 4;

/// Writes bits into lent bytes.
#[derive(Debug)]
pub(super) struct BitWriter<'a> {
    out: &'a mut [u8],
    written: usize,
    pending: u64,
    count: u32,
}

impl<'a> BitWriter<'a> {
    pub(super) fn new(out: &'a mut [u8]) -> Self {
        Self { out, written: 0, pending: 0, count: 0 }
    }

    /// Writes the `count` (at most 32) low bits of `bits`; `None` if they do not fit.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn put(&mut self, bits: u32, count: u32) -> Option<()> {
        let low = u64::from(bits) & (1_u64 << count).wrapping_sub(1);
        self.pending |= low << self.count;
        self.count = self.count.wrapping_add(count);
        if self.count >= u32::BITS {
            let [a, b, c, d, ..] = self.pending.to_le_bytes();
            let end = self.written.wrapping_add(GROUP);
            copy(&[a, b, c, d], self.out.get_mut(self.written..end)?);
            self.written = end;
            self.pending >>= u32::BITS;
            self.count = self.count.wrapping_sub(u32::BITS);
        }
        Some(())
    }

    /// Writes what is left, up to a whole byte; returns the number of bytes.
    pub(super) fn finish(self) -> Option<usize> {
        let bytes = self.pending.to_le_bytes();
        let rest = bytes.get(..crate::extent::to_usize(self.count.div_ceil(8)))?;
        let end = self.written.wrapping_add(rest.len());
        copy(rest, self.out.get_mut(self.written..end)?);
        Some(end)
    }
}

/// Reads bits; beyond the end there are zeros.
#[derive(Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    read: usize,
    pending: u64,
    count: u32,
}

impl<'a> BitReader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, read: 0, pending: 0, count: 0 }
    }

    /// The next `count` (at most 32) bits.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn take(&mut self, count: u32) -> u32 {
        if self.count < u32::BITS {
            self.refill();
        }
        let bits = self.pending & (1_u64 << count).wrapping_sub(1);
        self.pending >>= count;
        self.count = self.count.wrapping_sub(count);
        low_word(bits)
    }

    /// Makes sure of 32 bits.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn refill(&mut self) {
        let rest = self.bytes.get(self.read..).unwrap_or(&[]);
        let group = rest.first_chunk().copied().unwrap_or_else(|| {
            let mut group = [0; GROUP];
            copy(rest, &mut group);
            group
        });
        self.pending |= u64::from(u32::from_le_bytes(group)) << self.count;
        self.count = self.count.wrapping_add(u32::BITS);
        self.read = self.read.wrapping_add(GROUP);
    }

    /// Bytes that the bits taken are in; `None` if there are not as many, or the last has bits set beyond.
    pub(super) fn finish(&self) -> Option<usize> {
        let unread = crate::extent::to_usize(self.count / 8);
        let taken = self.read.wrapping_sub(unread);
        let padding = self.pending & (1_u64 << (self.count % 8)).wrapping_sub(1);
        (taken <= self.bytes.len() && padding == 0).then_some(taken)
    }

    /// Whether all bytes are taken, and no more.
    pub(super) fn is_finished(&self) -> bool {
        self.finish() == Some(self.bytes.len())
    }
}

const fn low_word(bits: u64) -> u32 {
    let [a, b, c, d, ..] = bits.to_le_bytes();
    u32::from_le_bytes([a, b, c, d])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back() {
        let mut out = [0; 16];
        let mut writer = BitWriter::new(&mut out);
        let fields = [(5, 3), (0, 0), (u32::MAX, 32), (1, 1), (0x1234, 13), (7, 29)];
        fields.iter().for_each(|&(bits, count)| writer.put(bits, count).unwrap());
        let len = writer.finish().unwrap();
        assert_eq!(len, (3 + 32 + 1 + 13 + 29_usize).div_ceil(8));
        let mut reader = BitReader::new(&out[..len]);
        for (bits, count) in fields {
            assert_eq!(u64::from(reader.take(count)), u64::from(bits) & ((1 << count) - 1));
        }
        assert!(reader.is_finished());
        assert_eq!(BitReader::new(&[]).take(32), 0);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let mut out = [0; 3];
        let mut writer = BitWriter::new(&mut out);
        assert_eq!(writer.put(1, 31), Some(()));
        assert_eq!(writer.put(1, 1), None);
        assert_eq!(BitWriter { out: &mut [], written: 0, pending: 1, count: 1 }.finish(), None);
        let mut reader = BitReader::new(&[1]);
        reader.take(9);
        assert_eq!(reader.finish(), None);
        let mut padded = BitReader::new(&[0b100]);
        padded.take(2);
        assert_eq!(padded.finish(), None);
    }
}
