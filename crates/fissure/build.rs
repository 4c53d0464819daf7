//! Tells the program which commit it is built from, as `FISSURE_REVISION`.

#[path = "build/revision.rs"]
mod revision;

use std::path::{Path, PathBuf};

fn main() {
    // Where the package is now, not where this script was compiled: clones may share a target folder.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default();
    let root = Path::new(&package).join("../..");
    let sources = revision::sources(&root);
    let found = revision::revision(&root, &sources);
    println!("cargo::rustc-env=FISSURE_REVISION={}", found.as_deref().unwrap_or_default());
    // What is watched is what is looked at: where HEAD is, and the sources that may differ from it.
    for path in revision::places_of_head(&root).iter().chain(&sources).filter(|path| path.exists()) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    for file in ["build.rs", "build"].map(PathBuf::from) {
        println!("cargo::rerun-if-changed={}", file.display());
    }
}
