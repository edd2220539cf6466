//! Threads to work on, and the memory that each works with. They wait from call to call: starting some takes longer than
//! to code a small volume.

use std::convert::Infallible;
use std::io;
use std::num::NonZeroUsize;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::available_parallelism;

use rayon::prelude::*;
use rayon::{Scope, ThreadPool, ThreadPoolBuilder};

use super::brick::Worker;

/// Threads that are started at most, however many are asked for.
const MOST_THREADS: usize = 256;

/// Pools that wait at most.
const MOST_IDLE: usize = 8;

/// Threads that nobody works on, as they were started.
static IDLE: Mutex<Vec<ThreadPool>> = Mutex::new(Vec::new());

/// Threads that nobody else works on; they wait for the next when this is dropped. One is the thread that asks.
#[derive(Debug)]
pub(super) struct Pool {
    threads: Option<ThreadPool>,
    workers: Mutex<Vec<Worker>>,
}

impl Pool {
    /// As many threads as asked for, or one per core.
    pub(super) fn new(threads: Option<NonZeroUsize>) -> io::Result<Self> {
        let count = threads.or_else(|| available_parallelism().ok()).map_or(1, NonZeroUsize::get);
        let threads = (count > 1).then(|| started(count.min(MOST_THREADS))).transpose()?;
        Ok(Self { threads, workers: Mutex::default() })
    }

    /// How many threads there are.
    pub(super) fn count(&self) -> usize {
        self.threads.as_ref().map_or(1, ThreadPool::current_num_threads)
    }

    /// What `work` makes of each item, in their order, or an error of one.
    pub(super) fn try_map<T: Send, R: Send, E: Send>(
        &self,
        items: Vec<T>,
        work: impl Fn(T) -> Result<R, E> + Send + Sync,
    ) -> Result<Vec<R>, E> {
        match &self.threads {
            Some(threads) if items.len() > 1 => threads.install(|| items.into_par_iter().map(work).collect()),
            _ => items.into_iter().map(work).collect(),
        }
    }

    /// As [`Pool::try_map`], where nothing can fail.
    pub(super) fn map<T: Send, R: Send>(&self, items: Vec<T>, work: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
        let Ok(made) = self.try_map(items, |item| Ok::<R, Infallible>(work(item)));
        made
    }

    /// Calls `work` with what begins jobs that end before this does.
    pub(super) fn scope<'scope, R>(&self, work: impl FnOnce(Jobs<'_, 'scope>) -> R) -> R {
        match &self.threads {
            Some(threads) => threads.in_place_scope(|scope| work(Jobs(Some(scope)))),
            None => work(Jobs(None)),
        }
    }

    /// Calls `work` with memory that nobody else works with.
    pub(super) fn with_worker<R>(&self, work: impl FnOnce(&mut Worker) -> R) -> R {
        let free = locked(&self.workers).pop();
        let mut worker = free.unwrap_or_else(Worker::new);
        let done = work(&mut worker);
        locked(&self.workers).push(worker);
        done
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let mut idle = locked(&IDLE);
        if idle.len() < MOST_IDLE {
            idle.extend(self.threads.take());
        }
    }
}

/// Threads that wait, or new ones.
fn started(count: usize) -> io::Result<ThreadPool> {
    let mut idle = locked(&IDLE);
    let waiting = idle.iter().position(|threads| threads.current_num_threads() == count);
    let waiting = waiting.map(|place| idle.swap_remove(place));
    drop(idle);
    let threads = waiting.map_or_else(|| ThreadPoolBuilder::new().num_threads(count).build(), Ok);
    threads.map_err(|error| io::Error::other(format!("cannot start threads: {error}")))
}

/// Jobs on the threads of a pool.
pub(super) struct Jobs<'a, 'scope>(Option<&'a Scope<'scope>>);

impl<'scope> Jobs<'_, 'scope> {
    /// Does a job on the next thread that is free; on the only one, at once.
    pub(super) fn begin(&self, job: impl FnOnce() + Send + 'scope) {
        match self.0 {
            Some(scope) => scope.spawn(|_| job()),
            None => job(),
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::thread::{self, ThreadId};

    use super::*;

    fn ids(pool: &Pool) -> HashSet<ThreadId> {
        pool.map((0..99).collect(), |_| thread::current().id()).into_iter().collect()
    }

    #[test]
    fn nobody_works_on_the_pool_of_another() {
        let threads = NonZeroUsize::new(3);
        let (first, second) = (Pool::new(threads).unwrap(), Pool::new(threads).unwrap());
        assert_eq!([&first, &second].map(Pool::count), [3, 3]);
        let used = ids(&first);
        assert!((0..20).all(|_| ids(&second).is_disjoint(&used)));
        drop(first);
        assert!(locked(&IDLE).iter().any(|threads| threads.current_num_threads() == 3));
    }

    #[test]
    fn one_thread_is_that_which_asks() {
        let pool = Pool::new(NonZeroUsize::new(1)).unwrap();
        assert_eq!(ids(&pool), HashSet::from([thread::current().id()]));
        let done = Mutex::new(Vec::new());
        let note = |job| done.lock().unwrap().push(job);
        pool.scope(|jobs| (0..3).for_each(|job| jobs.begin(move || note(job))));
        assert_eq!(*done.lock().unwrap(), [0, 1, 2]);
    }

    #[test]
    fn results_keep_their_order_and_errors_are_told() {
        for count in [1, 2] {
            let pool = Pool::new(NonZeroUsize::new(count)).unwrap();
            assert_eq!(
                pool.map((0..99).collect(), |item| 2 * item),
                (0..99).map(|item| 2 * item).collect::<Vec<_>>()
            );
            let odd = pool.try_map(vec![2, 3, 4], |item| if item % 2 == 0 { Ok(item) } else { Err(item) });
            assert_eq!(odd, Err(3));
        }
    }
}
