//! `cargo xtask size`: parts of the kernel, linked alone, and what they take of flash.

use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind};

use crate::budget::{self, Image, WORKSPACE};
use crate::shell::{Failures, cargo};

/// What no symbol of an image may hold, as symbols are mangled: panics, formatting, allocation.
const FORBIDDEN: [&str; 4] = ["4core9panicking", "4core3fmt", "__rust_alloc", "__rust_no_alloc_shim"];

/// Links every image and compares it with its budget.
pub(crate) fn run() -> Failures {
    let images = match budget::read() {
        Ok(budgets) => budgets.images,
        Err(error) => return vec![error],
    };
    let mut failures = vec![];
    for image in &images {
        match measure(image) {
            Ok(flash) => {
                println!("{:12} {:24} {flash:6} bytes", image.binary, image.profile);
                let what = format!("{} ({}), bytes of flash", image.binary, image.profile);
                failures.extend(image.flash.check(&what, flash));
            }
            Err(error) => failures.push(error),
        }
    }
    failures
}

/// Links an image: bytes of flash, or what is wrong.
pub(crate) fn measure(image: &Image) -> Result<u64, String> {
    let Image { binary, target, features, build, .. } = image;
    let features = features.join(",");
    let arguments = ["build", "--quiet", "--manifest-path", WORKSPACE, "--package", "image"];
    let selection = ["--bin", binary, "--target", target, "--profile", build, "--features", &features];
    if let Some(failure) = cargo(&[&arguments[..], &selection].concat()).pop() {
        return Err(failure);
    }
    let file = Path::new("tests/device/target").join(target).join(build).join(binary);
    let bytes = std::fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let elf =
        object::File::parse(bytes.as_slice()).map_err(|error| format!("{}: {error}", file.display()))?;
    match forbidden(&elf).as_slice() {
        [] => Ok(flash(&elf)),
        symbols => Err(format!("{}: holds {}", file.display(), symbols.join(", "))),
    }
}

/// Bytes of every section that is loaded: code, constants, and what variables begin with.
fn flash(elf: &object::File<'_>) -> u64 {
    use SectionKind::{Data, ReadOnlyData, ReadOnlyString, Text};
    let is_loaded = |section: &object::Section<'_, '_>| {
        matches!(section.kind(), Text | ReadOnlyData | ReadOnlyString | Data)
    };
    let loaded = elf.sections().filter(is_loaded);
    loaded.map(|section| section.size()).sum()
}

/// The symbols that should not be there.
fn forbidden(elf: &object::File<'_>) -> Vec<String> {
    let names = elf.symbols().filter_map(|symbol| symbol.name().ok());
    names.filter(|name| FORBIDDEN.iter().any(|part| name.contains(part))).map(str::to_owned).collect()
}
