//! Links without start code or libraries.

fn main() {
    println!("cargo::rerun-if-changed=image.x");
    println!("cargo::rustc-link-arg=-T{}/image.x", env!("CARGO_MANIFEST_DIR"));
}
