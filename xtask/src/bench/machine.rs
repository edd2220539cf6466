//! Where and when something was measured.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

use crate::shell::output;

/// A machine and what was built on it.
#[derive(Serialize)]
pub(super) struct Machine {
    pub(super) processor: String,
    pub(super) cores: usize,
    pub(super) system: String,
    pub(super) rustc: String,
    /// The commit that was measured, `+` behind it if files had changed since.
    pub(super) commit: String,
}

impl Machine {
    /// This one. What it does not tell is called unknown.
    pub(super) fn here() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS.to_owned(),
            rustc: output("rustc", &["--version"]).map_or_else(|_| unknown(), |text| text.trim().to_owned()),
            commit: commit().unwrap_or_else(|_| unknown()),
        }
    }

    /// One that nothing was measured on.
    #[cfg(test)]
    pub(super) fn example() -> Self {
        Self {
            processor: "a processor".to_owned(),
            cores: 2,
            system: "linux".to_owned(),
            rustc: "rustc 1.95".to_owned(),
            commit: "0123abc".to_owned(),
        }
    }
}

fn unknown() -> String {
    "unknown".to_owned()
}

/// The first processor's name, where the system has a file that says it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn commit() -> Result<String, String> {
    let git = |arguments: &[&str]| output("git", &[&["-c", "safe.directory=*"], arguments].concat());
    let changed = if git(&["status", "--porcelain"])?.is_empty() { "" } else { "+" };
    Ok(git(&["rev-parse", "--short", "HEAD"])?.trim().to_owned() + changed)
}

/// Today in UTC, as `2026-11-22`.
pub(super) fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    date(seconds / 86_400)
}

/// The date so many days after 1 January 1970, by counting years and months off.
fn date(mut days: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        let expected =
            [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (11_322, "2000-12-31")];
        for (days, text) in expected {
            assert_eq!(date(days), text);
        }
    }
}
