//! `cargo xtask capi`: the C library, and the example in C that tests it, here and on an emulated microcontroller.

use crate::shell::{Failures, cargo, output, run_with};

/// Name of the package of the C library.
pub(crate) const CAPI: &str = "wavelift-capi";

/// The microcontroller of the example.
const DEVICE: &str = "thumbv7em-none-eabihf";

const EXAMPLE: &str = "kernel/capi/example";

/// Where the example's Makefile puts the program of the microcontroller.
const DEVICE_PROGRAM: &str = "target/capi/device.elf";

/// Builds the static libraries of this machine and of the microcontroller, then builds and runs the example on both, on
/// this machine with sanitizers too, and looks for panics in what was linked.
pub(crate) fn run() -> Failures {
    let device = ["--target", DEVICE, "--features", "small,panic-handler"];
    let mut failures = build("staticlib", &[]);
    failures.extend(build("staticlib", &device));
    if failures.is_empty() {
        failures.extend(make());
        failures.extend(panics());
    }
    failures
}

/// Builds the library with all optimizations for size. As the only type of the crate, so that it is optimized across
/// crates.
pub(crate) fn build(crate_type: &str, options: &[&str]) -> Failures {
    let arguments = ["rustc", "--quiet", "--package", CAPI, "--profile", "small", "--crate-type", crate_type];
    cargo(&[&arguments, options].concat())
}

fn make() -> Failures {
    let arguments = ["--always-make", "--no-print-directory", "--directory", EXAMPLE, "check"];
    run_with("make", &arguments, &[])
}

/// Ways to panic that the program of the microcontroller holds.
fn panics() -> Failures {
    match output("arm-none-eabi-nm", &["--format=just-symbols", DEVICE_PROGRAM]) {
        Ok(symbols) => {
            panicking(&symbols).map(|symbol| format!("{DEVICE_PROGRAM} can panic: {symbol}")).collect()
        }
        Err(error) => vec![error],
    }
}

fn panicking(symbols: &str) -> impl Iterator<Item = &str> {
    symbols.lines().filter(|symbol| symbol.contains("9panicking"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_to_panic_are_found_by_name() {
        let symbols = "main\n_RNvNtCs7ldSeZOOJos_4core9panicking9panic_fmt\nwavelift_decode\n";
        let found: Vec<&str> = panicking(symbols).collect();
        assert_eq!(found, ["_RNvNtCs7ldSeZOOJos_4core9panicking9panic_fmt"]);
    }
}
