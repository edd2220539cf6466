//! Files of chunks, of which no more is read than there is.
//!
//! The store of zarrs takes memory for as many bytes as it is asked for before it looks whether the file has them, and
//! the index of a shard may ask for any number. Here a range beyond the end of a file, or of more bytes than a chunk can
//! have, is an error.

use std::path::Path;

use zarrs::filesystem::{FilesystemStore, FilesystemStoreCreateError};
use zarrs::storage::byte_range::{ByteRange, ByteRangeIterator, InvalidByteRangeError};
use zarrs::storage::{MaybeBytesIterator, ReadableStorageTraits, StorageError, StoreKey};

/// A folder of files that are read within their ends.
#[derive(Debug)]
pub(super) struct Within {
    files: FilesystemStore,
    /// Most bytes that are read at once.
    most: u64,
}

impl Within {
    /// The store of a folder, of which at most so many bytes are read at once.
    pub(super) fn new(folder: &Path, most: u64) -> Result<Self, FilesystemStoreCreateError> {
        Ok(Self { files: FilesystemStore::new(folder)?, most })
    }

    /// Whether a range lies in a file of so many bytes, and is no longer than any should be.
    fn has(&self, range: &ByteRange, bytes: u64) -> bool {
        let (start, length) = match *range {
            ByteRange::FromStart(start, Some(length)) => (start, length),
            ByteRange::FromStart(start, None) => (start, bytes.saturating_sub(start)),
            ByteRange::Suffix(length) => (0, length),
        };
        length <= self.most && start.checked_add(length).is_some_and(|end| end <= bytes)
    }
}

impl ReadableStorageTraits for Within {
    fn get_partial_many<'a>(
        &'a self,
        key: &StoreKey,
        byte_ranges: ByteRangeIterator<'a>,
    ) -> Result<MaybeBytesIterator<'a>, StorageError> {
        let Some(bytes) = self.size_key(key)? else { return Ok(None) };
        let ranges: Vec<ByteRange> = byte_ranges.collect();
        if let Some(range) = ranges.iter().find(|range| !self.has(range, bytes)) {
            return Err(InvalidByteRangeError::new(*range, bytes).into());
        }
        self.files.get_partial_many(key, Box::new(ranges.into_iter()))
    }

    fn size_key(&self, key: &StoreKey) -> Result<Option<u64>, StorageError> {
        self.files.size_key(key)
    }

    fn supports_get_partial(&self) -> bool {
        self.files.supports_get_partial()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_is_read_than_there_is() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a"), [7; 100]).unwrap();
        let store = Within::new(folder.path(), 90).unwrap();
        let key = StoreKey::new("a").unwrap();
        let read = |range| store.get_partial(&key, range).map(|bytes| bytes.unwrap().len());
        for (range, expected) in [
            (ByteRange::FromStart(10, None), 90),
            (ByteRange::FromStart(100, None), 0),
            (ByteRange::FromStart(0, Some(90)), 90),
            (ByteRange::FromStart(99, Some(1)), 1),
            (ByteRange::Suffix(90), 90),
        ] {
            assert_eq!(read(range).unwrap(), expected, "{range}");
        }
        for range in [
            ByteRange::FromStart(0, None),
            ByteRange::FromStart(9, None),
            ByteRange::FromStart(101, None),
            ByteRange::FromStart(99, Some(2)),
            ByteRange::FromStart(0, Some(1 << 60)),
            ByteRange::FromStart(u64::MAX, Some(u64::MAX)),
            ByteRange::Suffix(91),
            ByteRange::Suffix(u64::MAX),
        ] {
            read(range).unwrap_err();
        }
        assert!(store.get(&StoreKey::new("b").unwrap()).unwrap().is_none());
    }
}
