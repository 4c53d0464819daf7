//! Runs of the program that was built for the tests.
#![allow(dead_code, reason = "each program of tests uses a part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder to work in that holds one file.
pub(crate) fn folder_with(name: &str, text: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    folder
}

/// `fissure ARGUMENTS` in a folder, not started yet.
pub(crate) fn fissure(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fissure"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command
}

/// Runs `fissure ARGUMENTS` in a folder to its end.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Output {
    fissure(folder, arguments).output().unwrap()
}

/// What `fissure ARGUMENTS` says in a folder: exit code, standard output, standard error.
pub(crate) fn said(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } = run(folder, arguments);
    (status.code().unwrap(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

/// All files below `folder`: relative path and content.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    fissure_tests::program::files(folder).unwrap()
}

/// The relative paths of all files below `folder`.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    files(folder).into_keys().map(|path| path.to_string_lossy().into_owned()).collect()
}

/// Holds all files below `a` against those below `b`.
#[track_caller]
pub(crate) fn assert_same_files(a: &Path, b: &Path) {
    assert_eq!(names(a), names(b));
    for ((name, left), (_, right)) in files(a).into_iter().zip(files(b)) {
        assert!(left == right, "{} differs", name.display());
    }
}
