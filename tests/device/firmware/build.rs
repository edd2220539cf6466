//! Gives the linker the memory of the board that the target stands for.

use std::path::{Path, PathBuf};

fn main() {
    let target = std::env::var("TARGET").expect("cargo says for what");
    let board = match target.as_str() {
        "thumbv7em-none-eabihf" => "mps2-an386",
        "thumbv6m-none-eabi" => "microbit",
        "riscv32imc-unknown-none-elf" => "virt",
        // Not linked for others.
        _ => return,
    };
    let memory = Path::new("memory").join(board).with_extension("x");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo says where"));
    std::fs::copy(&memory, out.join("memory.x")).expect("the layout can be copied");
    println!("cargo::rerun-if-changed={}", memory.display());
    println!("cargo::rustc-link-search={}", out.display());
    if board == "virt" {
        println!("cargo::rustc-link-arg=-Tmemory.x");
    }
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg={argument}");
    }
}
