//! Decoders of others that panic where a file is damaged.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Takes a panic for an error: sums that overflow, places that are not there. What `run` works on is of no use then.
pub(super) fn guarded<T>(run: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| Err("it is damaged".to_owned()))
}
