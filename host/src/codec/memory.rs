//! How much memory there is to work in.

/// What is taken to be free where the system does not say.
const UNKNOWN: u64 = 2 << 30;

/// Bytes of memory that are free, or can be made so without swapping.
pub(super) fn available() -> u64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    of_meminfo(&text).unwrap_or(UNKNOWN)
}

/// The field `MemAvailable` of Linux.
fn of_meminfo(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1 << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_says_is_understood() {
        let text = "MemTotal:       24537388 kB\nMemFree:  1 kB\nMemAvailable:   21012540 kB\n";
        assert_eq!(of_meminfo(text), Some(21_012_540 << 10));
        assert_eq!((of_meminfo(""), of_meminfo("MemAvailable: lots kB")), (None, None));
        assert!(available() > 1 << 20);
    }
}
