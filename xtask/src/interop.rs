//! `cargo xtask interop`: files of other programs read by wavelift, and its files read by them.
//!
//! The other programs are Python packages of exact versions, kept in a virtual environment below `target`. Each
//! `tests/interop/check_*.py` runs in an empty folder of its own.

use std::fs;
use std::path::{Path, PathBuf, absolute};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use crate::shell::{Failures, cargo};

/// The checks, and the versions of what they need.
const FOLDER: &str = "tests/interop";

/// Where the packages are installed.
const ENVIRONMENT: &str = "target/interop-venv";

/// Where the checks put their files.
const SCRATCH: &str = "target/interop";

/// Volumes that are too large for the repository; parts of the checks need them.
const DATA: &str = "../shared/data";

pub(crate) fn run() -> Failures {
    prepare();
    // As the tests of its package have it, so that nothing is compiled twice.
    let program = ["test", "--no-run", "--package", "wavelift-host", "--test", "examples"];
    let failures = cargo(&program);
    if !failures.is_empty() {
        return failures;
    }
    let prepared = environment().and_then(|python| Ok((python, checks()?)));
    match prepared {
        Ok((python, checks)) => checks.iter().filter_map(|check| run_check(&python, check).err()).collect(),
        Err(failure) => vec![failure],
    }
}

/// Begins to install the packages, which takes the network more than the processor. Where it fails, [`run`] tries again
/// and says why.
pub(crate) fn prepare() {
    thread::spawn(environment);
}

/// The interpreter of an environment that has the packages, which is made anew if their versions changed.
fn environment() -> Result<PathBuf, String> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let python = Path::new(ENVIRONMENT).join("bin/python");
    let list = Path::new(FOLDER).join("requirements.txt");
    let wanted = fs::read_to_string(&list).map_err(|error| format!("{}: {error}", list.display()))?;
    let installed = Path::new(ENVIRONMENT).join("installed.txt");
    if fs::read_to_string(&installed).is_ok_and(|found| found == wanted) {
        return absolute(&python).map_err(|error| error.to_string());
    }
    let _ = fs::remove_dir_all(ENVIRONMENT);
    let advice = "install python3 and python3-venv";
    succeed(Command::new("python3").args(["-m", "venv", ENVIRONMENT]), advice)?;
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary=:all:", "-r"]);
    succeed(pip.arg(&list), "the packages come from the network, or from an index that pip is set up for")?;
    fs::write(&installed, wanted).map_err(|error| format!("{}: {error}", installed.display()))?;
    absolute(&python).map_err(|error| error.to_string())
}

/// Every check, in the order of their names.
fn checks() -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(FOLDER).map_err(|error| format!("{FOLDER}: {error}"))?;
    let mut checks: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_check(path)).collect();
    checks.sort();
    if checks.is_empty() { Err(format!("{FOLDER}: no check_*.py there")) } else { Ok(checks) }
}

fn is_check(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with("check_") && name.ends_with(".py")
}

fn run_check(python: &Path, check: &Path) -> Result<(), String> {
    let name = check.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let scratch = Path::new(SCRATCH).join(&name);
    let _ = fs::remove_dir_all(&scratch);
    fs::create_dir_all(&scratch).map_err(|error| format!("{}: {error}", scratch.display()))?;
    let full = |path: &Path| absolute(path).map_err(|error| format!("{}: {error}", path.display()));
    let mut command = Command::new(python);
    command.arg(full(check)?).arg("--wavelift").arg(full(Path::new("target/debug/wavelift"))?);
    if Path::new(DATA).is_dir() {
        command.arg("--data").arg(full(Path::new(DATA))?);
    }
    let start = Instant::now();
    succeed(command.current_dir(&scratch), "its files are in the scratch folder above")?;
    eprintln!("{name}: {:.1} s", start.elapsed().as_secs_f64());
    // The files are worth looking at only where a check fails.
    let _ = fs::remove_dir_all(&scratch);
    Ok(())
}

/// Runs a program that is expected to succeed; `advice` follows where it does not.
fn succeed(command: &mut Command, advice: &str) -> Result<(), String> {
    let line = format!("{command:?}").replace('"', "");
    match command.stdin(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{line} ({status}): {advice}")),
        Err(error) => Err(format!("{line}: {error}: {advice}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_are_known_by_name() {
        assert!(is_check(Path::new("a/check_images.py")));
        assert!(!is_check(Path::new("a/check_images.pyc")));
        assert!(!is_check(Path::new("check_a/images.py")));
    }

    #[test]
    fn failures_name_the_command_and_what_to_do() {
        let failure = succeed(&mut Command::new("no-such-program"), "install it").unwrap_err();
        assert!(failure.starts_with("no-such-program: ") && failure.ends_with(": install it"), "{failure}");
        assert!(succeed(&mut Command::new("false"), "fix it").unwrap_err().ends_with("fix it"));
    }
}
