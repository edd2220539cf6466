//! The bytes that arrays lie in.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::document::{Buffer, Document};
use crate::mesh::MeshFault;
use crate::volume::{excerpt, in_words};

/// All buffers of a document, the first of which may be the binary chunk.
pub(super) fn load<'a>(
    document: &Document,
    binary: Option<&'a [u8]>,
    folder: &Path,
) -> Result<Vec<Cow<'a, [u8]>>, MeshFault> {
    let all = document.buffers.iter().enumerate().map(|(index, buffer)| {
        let bytes = match (&buffer.uri, binary) {
            (Some(uri), _) => Cow::Owned(named(uri, buffer, folder)?),
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            (None, _) => {
                return Err(MeshFault::header(format!("buffer {index} has neither a uri nor a chunk")));
            }
        };
        if bytes.len() < buffer.byte_length {
            return Err(MeshFault::header(format!(
                "buffer {index} has {} bytes of the {} that it should have",
                bytes.len(),
                buffer.byte_length
            )));
        }
        Ok(bytes)
    });
    all.collect()
}

fn named(uri: &str, buffer: &Buffer, folder: &Path) -> Result<Vec<u8>, MeshFault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let data = data.split_once(";base64,").map(|(_, data)| data);
        let bytes = data.and_then(|data| STANDARD.decode(data).ok());
        return bytes.ok_or_else(|| MeshFault::header("a buffer is a data uri that is no base64"));
    }
    let path = path(uri, folder).ok_or_else(|| MeshFault::Unsupported {
        what: format!("a buffer outside the folder, {},", excerpt(uri)),
    })?;
    read_file(&path, buffer.byte_length as u64).map_err(|cause| {
        MeshFault::header(format!("the buffer {} cannot be read: {}", excerpt(uri), in_words(&cause)))
    })
}

/// The file of a buffer, unless it is none, or lies outside the folder.
pub(super) fn path(uri: &str, folder: &Path) -> Option<PathBuf> {
    let path = Path::new(uri);
    let is_beside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (is_beside && !uri.contains(':')).then(|| folder.join(path))
}

/// The first bytes of a regular file.
fn read_file(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    if !file.metadata()?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    let mut bytes = Vec::new();
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}
