//! Threads to work on, which wait from call to call: starting some takes longer than to code a small volume.

use std::io;
use std::num::NonZeroUsize;
use std::ops::Deref;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads that are started at most, however many are asked for.
const MOST_THREADS: usize = 256;

/// Pools that wait at most.
const MOST_IDLE: usize = 8;

/// Pools that nobody works on, and how many threads were asked for in each.
static IDLE: Mutex<Vec<(usize, ThreadPool)>> = Mutex::new(Vec::new());

/// A pool that nobody else works on; it waits for the next when it is dropped.
#[derive(Debug)]
pub(super) struct Pool {
    threads: usize,
    pool: Option<ThreadPool>,
}

impl Pool {
    /// As many threads as asked for, or one per core.
    pub(super) fn new(threads: Option<NonZeroUsize>) -> io::Result<Self> {
        let threads = threads.map_or(0, NonZeroUsize::get).min(MOST_THREADS);
        let mut idle = idle();
        let waiting =
            idle.iter().position(|&(count, _)| count == threads).map(|place| idle.swap_remove(place).1);
        drop(idle);
        let pool = waiting.map_or_else(|| ThreadPoolBuilder::new().num_threads(threads).build(), Ok);
        let pool = pool.map_err(|error| io::Error::other(format!("cannot start threads: {error}")))?;
        Ok(Self { threads, pool: Some(pool) })
    }
}

impl Deref for Pool {
    type Target = ThreadPool;

    fn deref(&self) -> &ThreadPool {
        self.pool.as_ref().expect("only dropping takes it")
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let mut idle = idle();
        if idle.len() < MOST_IDLE {
            idle.extend(self.pool.take().map(|pool| (self.threads, pool)));
        }
    }
}

fn idle() -> MutexGuard<'static, Vec<(usize, ThreadPool)>> {
    IDLE.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_works_on_the_pool_of_another() {
        let threads = NonZeroUsize::new(3);
        let (first, second) = (Pool::new(threads).unwrap(), Pool::new(threads).unwrap());
        let thread = |pool: &Pool| pool.install(|| std::thread::current().id());
        assert_eq!([&first, &second].map(|pool| pool.current_num_threads()), [3, 3]);
        let used = thread(&first);
        assert!((0..20).all(|_| thread(&second) != used));
        drop(first);
        assert!(idle().iter().any(|&(count, _)| count == 3));
    }
}
