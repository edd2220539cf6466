//! Progress, for people who wait at a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on standard error that counts up to `samples`; nothing is shown where that is no terminal.
///
/// It disappears when it is dropped. Hand `&|samples| bar.inc(samples)` to the library.
pub(crate) fn bar(label: &'static str, samples: u64) -> ProgressBar {
    let target = ProgressDrawTarget::stderr_with_hz(8);
    let style = ProgressStyle::with_template("{msg} {wide_bar:.cyan} {percent:>3} %, {eta} left")
        .expect("the template is sound");
    let bar = ProgressBar::with_draw_target(Some(samples), target).with_style(style).with_message(label);
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}
