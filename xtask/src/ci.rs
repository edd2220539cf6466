//! `cargo xtask ci`: all checks, in order.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use crate::shell::Failures;
use crate::{browser, capi, device, doc, fmt, fuzz, interop, lint, matrix, size, test, tidy, vectors};

/// Name and check.
type Step = (&'static str, fn() -> Failures);

/// The steps in the order they run: cheap ones first.
const STEPS: [Step; 13] = [
    ("tidy", tidy::run),
    ("fmt", || fmt::run(false)),
    ("lint", lint::run),
    ("test", test::run),
    ("interop", interop::run),
    ("matrix", matrix::run),
    ("size", size::run),
    ("device", device::run),
    ("doc", doc::run),
    ("vectors", || vectors::run(&[])),
    ("capi", capi::run),
    ("browser", browser::run),
    ("fuzz", || fuzz::run(&fuzz::Options::default())),
];

struct Outcome {
    step: &'static str,
    time: Duration,
    failures: Failures,
}

/// Runs every step, whatever failed before, then lists times and failures. The last line of the output is
/// `N passed, N failed`, counted in steps.
pub(crate) fn run() -> ExitCode {
    let outcomes = STEPS.map(|(step, check)| {
        eprintln!("\n== {step}");
        let start = Instant::now();
        let failures = check();
        let outcome = Outcome { step, time: start.elapsed(), failures };
        eprintln!("== {}", verdict(&outcome));
        outcome
    });
    println!("\n{}", report(&outcomes));
    let passed = outcomes.iter().all(|outcome| outcome.failures.is_empty());
    if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn verdict(outcome: &Outcome) -> String {
    let word = if outcome.failures.is_empty() { "passed" } else { "FAILED" };
    format!("{:8} {word} {:7.1} s", outcome.step, outcome.time.as_secs_f64())
}

fn report(outcomes: &[Outcome]) -> String {
    let mut lines: Vec<String> = outcomes.iter().map(verdict).collect();
    for outcome in outcomes {
        lines.extend(outcome.failures.iter().map(|failure| format!("failed: {}: {failure}", outcome.step)));
    }
    let failed = outcomes.iter().filter(|outcome| !outcome.failures.is_empty()).count();
    lines.push(format!("{} passed, {failed} failed", outcomes.len() - failed));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_lists_failures_and_ends_with_the_counts() {
        let outcome = |step, failures| Outcome { step, time: Duration::from_millis(1500), failures };
        let outcomes = [outcome("tidy", vec![]), outcome("fmt", vec!["one".to_owned(), "two".to_owned()])];
        let expected = "tidy     passed     1.5 s\n\
                        fmt      FAILED     1.5 s\n\
                        failed: fmt: one\n\
                        failed: fmt: two\n\
                        1 passed, 1 failed";
        assert_eq!(report(&outcomes), expected);
    }
}
