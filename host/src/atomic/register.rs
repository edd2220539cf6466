//! What is not in its place yet.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

static REGISTER: Mutex<Register> = Mutex::new(Register::new());

/// Output of this process.
#[derive(Debug)]
struct Register {
    /// What is not in its place, by number, with its temporary name if it has one.
    pending: BTreeMap<u64, Option<PathBuf>>,
    begun: u64,
    has_appeared: bool,
}

/// Nothing is begun, comes into place or is abandoned while this is held.
fn register() -> MutexGuard<'static, Register> {
    REGISTER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all files of this process that are not in their place yet, and keeps any from being made or put there;
/// unless there is output, and all of it is in its place. Then nothing changes, and the answer is `false`.
///
/// Threads that try to write after `true` wait for ever: it is for a program that ends at once, as on Ctrl-C. After
/// `false` its work is done, and it may go on to its end.
pub fn abandon_all() -> bool {
    let mut register = register();
    let is_abandoned = register.abandon();
    if is_abandoned {
        std::mem::forget(register);
    }
    is_abandoned
}

impl Register {
    const fn new() -> Self {
        Self { pending: BTreeMap::new(), begun: 0, has_appeared: false }
    }

    fn begin(&mut self, name: Option<PathBuf>) -> u64 {
        self.begun += 1;
        self.pending.insert(self.begun, name);
        self.begun
    }

    fn abandon(&mut self) -> bool {
        if self.has_appeared && self.pending.is_empty() {
            return false;
        }
        for path in std::mem::take(&mut self.pending).into_values().flatten() {
            // What cannot be removed stays; nobody is left to be told. Others may still be writing into a folder.
            let is_gone = || fs::remove_file(&path).is_ok() || fs::remove_dir_all(&path).is_ok();
            let _ = (0..8).any(|_| is_gone());
        }
        true
    }
}

/// Output that is not in its place, until [`appear`](Self::appear) or until this is dropped.
#[derive(Debug)]
pub(super) struct Pending(u64);

impl Pending {
    /// Output without a name that would have to go.
    pub(super) fn nameless() -> Self {
        Self(register().begin(None))
    }

    /// Makes a file or a folder, and notes its name.
    pub(super) fn named<T>(
        make: impl FnOnce() -> io::Result<T>,
        path: impl Fn(&T) -> &Path,
    ) -> io::Result<(T, Self)> {
        let mut register = register();
        let made = make()?;
        let number = register.begin(Some(path(&made).to_owned()));
        Ok((made, Self(number)))
    }

    /// Puts the output in its place.
    pub(super) fn appear<T, E>(self, place: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        Self::appear_together(vec![self], place)
    }

    /// Puts several outputs in their places; none is abandoned when another is there.
    pub(super) fn appear_together<T, E>(
        all: Vec<Self>,
        place: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        // Dropped before `all`, which ask for it.
        let mut register = register();
        let placed = place()?;
        register.has_appeared = true;
        for Self(number) in &all {
            register.pending.remove(number);
        }
        Ok(placed)
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        register().pending.remove(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_in_its_place_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "1").unwrap();
        let mut own = Register::new();
        own.begin(Some(path.clone()));
        own.begin(Some(folder.path().join("none")));
        own.begin(None);
        assert!(own.abandon() && own.pending.is_empty() && !path.exists());
    }

    #[test]
    fn work_is_abandoned_unless_all_of_it_is_in_its_place() {
        let mut own = Register::new();
        assert!(own.abandon());
        let first = own.begin(None);
        own.has_appeared = true;
        assert!(own.abandon() && !own.pending.contains_key(&first));
        assert!(!own.abandon());
    }

    #[test]
    fn output_is_pending_until_it_appears_or_is_dropped() {
        let is_pending = |number| register().pending.contains_key(&number);
        let [first, second, third] = [(); 3].map(|()| Pending::nameless());
        let numbers = [first.0, second.0, third.0];
        assert!(numbers.into_iter().all(is_pending));
        assert_eq!(first.appear(|| Err::<(), _>("full")), Err("full"));
        assert_eq!(Pending::appear_together(vec![second], || Ok::<_, ()>(1)), Ok(1));
        drop(third);
        assert!(register().has_appeared && !numbers.into_iter().any(is_pending));
    }
}
