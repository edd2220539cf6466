//! Progress, for people who wait at a terminal.

use std::ops::ControlFlow;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on standard error, with rate and time left; nothing is shown where that is no terminal. It disappears when
/// it is dropped.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
    bytes: u64,
}

impl Bar {
    /// A bar for `samples` of so many bytes.
    pub(crate) fn new(label: &'static str, samples: u64, bytes: usize) -> Self {
        let bytes = bytes as u64;
        let target = ProgressDrawTarget::stderr_with_hz(8);
        let style = "{msg} {wide_bar:.cyan} {percent:>3} %, {decimal_bytes_per_sec}, {eta} left";
        let style = ProgressStyle::with_template(style).expect("the template is sound");
        let bar = ProgressBar::with_draw_target(Some(samples.saturating_mul(bytes)), target)
            .with_style(style)
            .with_message(label);
        bar.enable_steady_tick(Duration::from_millis(500));
        Self { bar, bytes }
    }

    /// A bar for as many values as there may be.
    pub(crate) fn spinner(label: &'static str) -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(8);
        let style = ProgressStyle::with_template("{msg} {spinner} {human_pos} values, {elapsed}");
        let bar = ProgressBar::with_draw_target(None, target)
            .with_style(style.expect("the template is sound"))
            .with_message(label);
        bar.enable_steady_tick(Duration::from_millis(500));
        Self { bar, bytes: 1 }
    }

    /// So many samples more are done.
    pub(crate) fn count(&self, samples: u64) -> ControlFlow<()> {
        self.bar.inc(samples.saturating_mul(self.bytes));
        ControlFlow::Continue(())
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
