//! `cargo xtask ci`: all checks.

use std::process::{Command, ExitCode, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::shell::Failures;
use crate::{browser, capi, doc, fmt, interop, lint, matrix, test, tidy, vectors};

/// Name and check.
type Step = (&'static str, fn() -> Failures);

/// The steps that build in the folder of the workspace, in the order they run: cheap ones first.
const STEPS: [Step; 10] = [
    ("tidy", tidy::run),
    ("fmt", || fmt::run(false)),
    ("lint", lint::run),
    ("test", test::run),
    ("interop", interop::run),
    ("matrix", matrix::run),
    ("doc", doc::run),
    ("vectors", || vectors::run(&[])),
    ("capi", capi::run),
    ("browser", browser::run),
];

/// Those that build in folders of their own. They run one after another beside the others, for each core that has
/// nothing to do while a single program is compiled, linked or run; what they say is shown when they end.
const BESIDE: [&str; 3] = ["size", "device", "fuzz"];

struct Outcome {
    step: &'static str,
    time: Duration,
    failures: Failures,
}

/// Runs every step, whatever failed before, then lists times and failures. The last line of the output is
/// `N passed, N failed`, counted in steps.
pub(crate) fn run() -> ExitCode {
    let start = Instant::now();
    interop::prepare();
    let beside = thread::spawn(|| BESIDE.map(|step| outcome(step, || apart(step))));
    let mut outcomes: Vec<Outcome> = STEPS
        .into_iter()
        .map(|(step, check)| {
            eprintln!("\n== {step}");
            outcome(step, check)
        })
        .collect();
    match beside.join() {
        Ok(beside) => outcomes.extend(beside),
        Err(_) => {
            outcomes.push(outcome(BESIDE[0], || vec!["the steps beside the others stopped".to_owned()]))
        }
    }
    println!("\n{}", report(&outcomes, start.elapsed()));
    let passed = outcomes.iter().all(|outcome| outcome.failures.is_empty());
    if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn outcome(step: &'static str, check: impl FnOnce() -> Failures) -> Outcome {
    let start = Instant::now();
    let failures = check();
    let outcome = Outcome { step, time: start.elapsed(), failures };
    eprintln!("== {}", verdict(&outcome));
    outcome
}

/// Runs a step as a program of its own; what it says comes in one piece.
fn apart(step: &str) -> Failures {
    let program = std::env::current_exe();
    let output = program.and_then(|program| Command::new(program).arg(step).stdin(Stdio::null()).output());
    match output {
        Ok(output) => {
            let [text, errors] =
                [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
            eprintln!("\n== {step}, beside the others\n{text}{errors}");
            if output.status.success() {
                vec![]
            } else {
                vec![format!("{}: what it said is above", output.status)]
            }
        }
        Err(error) => vec![format!("cannot be started: {error}")],
    }
}

fn verdict(outcome: &Outcome) -> String {
    let word = if outcome.failures.is_empty() { "passed" } else { "FAILED" };
    format!("{:8} {word} {:7.1} s", outcome.step, outcome.time.as_secs_f64())
}

fn report(outcomes: &[Outcome], time: Duration) -> String {
    let mut lines: Vec<String> = outcomes.iter().map(verdict).collect();
    for outcome in outcomes {
        lines.extend(outcome.failures.iter().map(|failure| format!("failed: {}: {failure}", outcome.step)));
    }
    lines.push(format!("in all {:16.1} s", time.as_secs_f64()));
    let failed = outcomes.iter().filter(|outcome| !outcome.failures.is_empty()).count();
    lines.push(format!("{} passed, {failed} failed", outcomes.len() - failed));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// This program, under test, lists its tests, and takes no option of that name.
    #[test]
    fn a_step_apart_fails_as_its_program_does() {
        assert_eq!(apart("--list"), [""; 0]);
        assert_eq!(apart("--no-such-option").len(), 1);
    }

    #[test]
    fn the_report_lists_failures_and_ends_with_the_counts() {
        let outcome = |step, failures| Outcome { step, time: Duration::from_millis(1500), failures };
        let outcomes = [outcome("tidy", vec![]), outcome("fmt", vec!["one".to_owned(), "two".to_owned()])];
        let expected = "tidy     passed     1.5 s\n\
                        fmt      FAILED     1.5 s\n\
                        failed: fmt: one\n\
                        failed: fmt: two\n\
                        in all              2.0 s\n\
                        1 passed, 1 failed";
        assert_eq!(report(&outcomes, Duration::from_secs(2)), expected);
    }
}
