//! Bytes of which a few are read as others than they are.

use std::collections::BTreeMap;
use std::io;

use super::ReadAt;
use super::wrong_byte::Change;

/// A source with some bytes changed.
pub(super) struct Patched {
    source: Box<dyn ReadAt>,
    /// Bits that are flipped in the bytes at these places.
    flips: BTreeMap<u64, u8>,
}

impl Patched {
    pub(super) fn new(source: Box<dyn ReadAt>) -> Self {
        Self { source, flips: BTreeMap::new() }
    }

    /// Changes a byte, which is counted from `start`; done twice, it is as it was.
    pub(super) fn toggle(&mut self, start: u64, change: Change) {
        let place = start + change.at as u64;
        let flips = self.flips.entry(place).or_default();
        *flips ^= change.by;
        if *flips == 0 {
            self.flips.remove(&place);
        }
    }

    /// The places of all bytes that are changed.
    pub(super) fn places(&self) -> Vec<u64> {
        self.flips.keys().copied().collect()
    }
}

impl ReadAt for Patched {
    fn bytes(&self) -> u64 {
        self.source.bytes()
    }

    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()> {
        self.source.read_at(position, out)?;
        for (place, flips) in self.flips.range(position..position.saturating_add(out.len() as u64)) {
            out[(place - position) as usize] ^= flips;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_bytes_are_read_changed() {
        let mut patched = Patched::new(Box::new(vec![0_u8; 10]));
        patched.toggle(3, Change { at: 2, by: 7 });
        patched.toggle(8, Change { at: 1, by: 1 });
        let read = |patched: &Patched, position, len| {
            let mut out = vec![0; len];
            patched.read_at(position, &mut out).map(|()| out).ok()
        };
        assert_eq!(read(&patched, 4, 3), Some(vec![0, 7, 0]));
        assert_eq!(read(&patched, 6, 4), Some(vec![0, 0, 0, 1]));
        assert_eq!((read(&patched, 9, 2), patched.places()), (None, vec![5, 9]));
        patched.toggle(5, Change { at: 0, by: 7 });
        assert_eq!((patched.places(), patched.bytes()), (vec![9], 10));
    }
}
