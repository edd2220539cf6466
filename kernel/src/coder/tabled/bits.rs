//! Bits as they are, the lowest first, in bytes.

use crate::memory::copy;

/// Bits on their way: small builds keep them in a word, and move them byte by byte.
#[cfg(not(feature = "small"))]
type Pending = u64;
#[cfg(feature = "small")]
type Pending = u32;

/// Bits of a field, at most.
const LONGEST: u32 = 24;

/// Bytes that are written or read at once.
const GROUP: usize = if cfg!(feature = "small") { 1 } else { 4 };

/// Their bits.
const GROUP_BITS: u32 = if cfg!(feature = "small") { 8 } else { 32 };

const _: () = assert!(LONGEST + GROUP_BITS <= Pending::BITS);

/// Writes bits into lent bytes.
#[derive(Debug)]
pub(super) struct BitWriter<'a> {
    out: &'a mut [u8],
    written: usize,
    pending: Pending,
    count: u32,
}

impl<'a> BitWriter<'a> {
    pub(super) fn new(out: &'a mut [u8]) -> Self {
        Self { out, written: 0, pending: 0, count: 0 }
    }

    /// Writes the `count` (at most 24) low bits of `bits`; `None` if they do not fit.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn put(&mut self, bits: u32, count: u32) -> Option<()> {
        self.pending |= low_bits(pending(bits.to_le_bytes()), count) << self.count;
        self.count = self.count.wrapping_add(count);
        while self.count >= GROUP_BITS {
            let end = self.written.wrapping_add(GROUP);
            let group = self.pending.to_le_bytes();
            copy(group.get(..GROUP)?, self.out.get_mut(self.written..end)?);
            self.written = end;
            self.pending >>= GROUP_BITS;
            self.count = self.count.wrapping_sub(GROUP_BITS);
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
    pending: Pending,
    count: u32,
}

impl<'a> BitReader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, read: 0, pending: 0, count: 0 }
    }

    /// The next `count` (at most 24) bits.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn take(&mut self, count: u32) -> u32 {
        while self.count < count {
            self.refill();
        }
        let bits = low_bits(self.pending, count);
        self.pending >>= count;
        self.count = self.count.wrapping_sub(count);
        low_word(bits)
    }

    /// Reads a group more.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn refill(&mut self) {
        let rest = self.bytes.get(self.read..).unwrap_or(&[]);
        let group = rest.first_chunk().copied().unwrap_or_else(|| {
            let mut group = [0; GROUP];
            copy(rest, &mut group);
            group
        });
        self.pending |= pending::<GROUP>(group) << self.count;
        self.count = self.count.wrapping_add(GROUP_BITS);
        self.read = self.read.wrapping_add(GROUP);
    }

    /// All bytes.
    pub(super) const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// Bits taken.
    pub(super) fn position(&self) -> usize {
        self.read.wrapping_mul(8).wrapping_sub(crate::extent::to_usize(self.count))
    }

    /// Bytes that the bits taken are in; `None` if there are not as many, or the last has bits set beyond.
    pub(super) fn finish(&self) -> Option<usize> {
        let unread = crate::extent::to_usize(self.count / 8);
        let taken = self.read.wrapping_sub(unread);
        let padding = low_bits(self.pending, self.count % 8);
        (taken <= self.bytes.len() && padding == 0).then_some(taken)
    }

    /// Whether all bytes are taken, and no more.
    pub(super) fn is_finished(&self) -> bool {
        self.finish() == Some(self.bytes.len())
    }
}

/// The `count` low bits.
#[inline(always)]
const fn low_bits(bits: Pending, count: u32) -> Pending {
    bits & !(Pending::MAX << count)
}

/// Bytes with zeros above them.
#[inline(always)]
fn pending<const N: usize>(bytes: [u8; N]) -> Pending {
    let mut pending = [0; size_of::<Pending>()];
    copy(&bytes, &mut pending);
    Pending::from_le_bytes(pending)
}

/// The low 32 bits.
#[inline(always)]
fn low_word(bits: Pending) -> u32 {
    let mut word = [0; 4];
    copy(&bits.to_le_bytes(), &mut word);
    u32::from_le_bytes(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back() {
        let mut out = [0; 16];
        let mut writer = BitWriter::new(&mut out);
        let fields = [(5, 3), (0, 0), (u32::MAX, 24), (1, 1), (0x1234, 13), (7, 23)];
        fields.iter().for_each(|&(bits, count)| writer.put(bits, count).unwrap());
        let len = writer.finish().unwrap();
        assert_eq!(len, (3 + 24 + 1 + 13 + 23_usize).div_ceil(8));
        let mut reader = BitReader::new(&out[..len]);
        for (bits, count) in fields {
            assert_eq!(reader.take(count), bits & ((1 << count) - 1));
        }
        assert!(reader.is_finished());
        assert_eq!(BitReader::new(&[]).take(24), 0);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let mut out = [0; 3];
        let mut writer = BitWriter::new(&mut out);
        assert_eq!(writer.put(1, 23), Some(()));
        assert_eq!(writer.put(1, 1), Some(()));
        assert_eq!(writer.put(1, 8), None);
        assert_eq!(BitWriter { out: &mut [], written: 0, pending: 1, count: 1 }.finish(), None);
        let mut reader = BitReader::new(&[1]);
        reader.take(9);
        assert_eq!(reader.finish(), None);
        let mut padded = BitReader::new(&[0b100]);
        padded.take(2);
        assert_eq!(padded.finish(), None);
    }
}
