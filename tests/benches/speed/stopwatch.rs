//! CPU time, the least of several runs.

use std::time::Duration;

use cpu_time::ProcessTime;

/// Work is repeated until it has taken so long, or so often.
const ENOUGH: Duration = Duration::from_secs(1);
const RUNS: u32 = 5;

/// CPU time of `work`.
pub(crate) fn time(work: impl FnOnce()) -> Duration {
    let start = ProcessTime::now();
    work();
    start.elapsed()
}

/// Least CPU time of several runs of `work`, and what the last one came to.
pub(crate) fn least<T, E>(mut work: impl FnMut() -> Result<T, E>) -> Result<(Duration, T), E> {
    let start = ProcessTime::now();
    let mut result = work();
    let mut least = start.elapsed();
    for _ in 1..RUNS {
        if result.is_err() || start.elapsed() > ENOUGH {
            break;
        }
        least = least.min(time(|| result = work()));
    }
    result.map(|result| (least, result))
}
