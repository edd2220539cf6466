//! Following long work, and stopping it.

use std::ops::ControlFlow;

/// Told the number of samples done since it was last told, from any thread, perhaps 0; `Break` stops the work soon.
///
/// Stopped work ends in an error that says so, and leaves nothing behind.
pub type Progress<'a> = &'a (dyn Fn(u64) -> ControlFlow<()> + Sync);

/// Follows nothing and stops nothing.
pub const fn ignore(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Work was stopped by whoever followed it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before it was done")]
pub struct Stopped;

/// Tells of `samples` done.
///
/// # Errors
/// [`Stopped`] if the answer is to stop.
pub(crate) fn tell(progress: Progress<'_>, samples: u64) -> Result<(), Stopped> {
    match progress(samples) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Stopped),
    }
}
