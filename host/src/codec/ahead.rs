//! Reading while others work on what was read before.

use std::mem;
use std::ops::{Deref, Range};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Scope;

use super::CompressError;
use super::supply::Supply;

/// Values that were read; when this goes, their memory is used for others.
#[derive(Debug)]
pub(super) struct Buffer {
    values: Vec<u8>,
    home: Sender<Vec<u8>>,
}

impl Deref for Buffer {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.values
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // Nobody waits for it once all is read.
        let _ = self.home.send(mem::take(&mut self.values));
    }
}

/// Buffers that there are: one is filled while another is worked on.
pub(super) const BUFFERS: u64 = 2;

/// Reads stretches of a step on a thread of its own, in order, into [`BUFFERS`] buffers in turn; what is all, at once and
/// here. The last that comes may be an error.
pub(super) fn read_ahead<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    supply: &'scope mut Supply<'_>,
    wanted: impl Iterator<Item = (T, Vec<Range<u64>>)> + Send + 'scope,
) -> Receiver<Result<(T, Buffer), CompressError>> {
    let (full, found) = channel();
    let (home, empty) = channel();
    for _ in 0..BUFFERS {
        // Both ends are here.
        let _ = home.send(Vec::new());
    }
    let mut wanted = wanted.peekable();
    let first = wanted.next();
    let is_all = wanted.peek().is_none();
    let read = move || {
        for (what, stretches) in first.into_iter().chain(wanted) {
            let Ok(mut values) = empty.recv() else { return };
            values.clear();
            let read = supply.read(&stretches, &mut values);
            let is_last = read.is_err();
            let buffer = Buffer { values, home: home.clone() };
            if full.send(read.map(|()| (what, buffer))).is_err() || is_last {
                return;
            }
        }
    };
    if is_all {
        read();
    } else {
        scope.spawn(read);
    }
    found
}
