//! Ctrl-C, and being told to end.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use wavelift_host::atomic;

/// What a shell says of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// Has the program end at Ctrl-C, a termination request or a lost terminal without leaving anything behind: no file
/// half-written, no temporary one, old ones as they were. Where all output is in its place already, there is nothing to
/// end: the program does what little is left, and its exit code says how that went. The second time it ends whatever it
/// is doing then.
///
/// Where one of these is ignored already, as under nohup, or cannot be handled, all stay as they are.
pub(crate) fn watch() {
    static IS_ENDING: AtomicBool = AtomicBool::new(false);
    let end = || {
        if IS_ENDING.swap(true, Ordering::Relaxed) {
            exit(INTERRUPTED);
        }
        thread::spawn(|| {
            if atomic::abandon_all() {
                exit(INTERRUPTED);
            }
        });
    };
    let _ = ctrlc::try_set_handler(end);
}
