//! Which commit a build says it is from. Truth: git itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../build/revision.rs"]
mod revision;

use revision::{places_of_head, revision, sources};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

fn git(folder: &Path, arguments: &[&str]) -> String {
    let who = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false"];
    let output = Command::new("git").current_dir(folder).args(who).args(arguments).output().unwrap();
    assert!(output.status.success(), "git {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().trim_end().to_owned()
}

/// A repository with one crate, committed.
fn repository() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir_all(folder.path().join("crates/one/src")).unwrap();
    for file in ["Cargo.toml", "Cargo.lock", "README.md", "crates/one/Cargo.toml", "crates/one/src/main.rs"] {
        std::fs::write(folder.path().join(file), "text").unwrap();
    }
    git(folder.path(), &["init", "-q"]);
    git(folder.path(), &["add", "."]);
    git(folder.path(), &["commit", "-q", "-m", "first"]);
    folder
}

fn seen(folder: &Path) -> Option<String> {
    revision(folder, &sources(folder))
}

#[test]
fn the_commit_is_told_and_changes_of_the_sources_are() {
    let folder = repository();
    let root = folder.path();
    let commit = git(root, &["rev-parse", "HEAD"])[..12].to_owned();
    assert_eq!(seen(root), Some(commit.clone()));
    std::fs::write(root.join("README.md"), "not part of the program").unwrap();
    assert_eq!(seen(root), Some(commit.clone()));
    std::fs::write(root.join("crates/one/src/main.rs"), "changed").unwrap();
    assert_eq!(seen(root), Some(format!("{commit}-dirty")));
    git(root, &["add", "."]);
    assert_eq!(seen(root), Some(format!("{commit}-dirty")));
    let heads: Vec<Vec<u8>> = places_of_head(root).iter().map(|path| std::fs::read(path).unwrap()).collect();
    git(root, &["commit", "-q", "-m", "second"]);
    let moved: Vec<Vec<u8>> = places_of_head(root).iter().map(|path| std::fs::read(path).unwrap()).collect();
    assert!(heads.len() == 2 && heads != moved, "what is watched does not change when HEAD moves");
    assert_eq!(seen(root), Some(git(root, &["rev-parse", "HEAD"])[..12].to_owned()));
}

#[test]
fn sources_without_a_repository_of_their_own_have_no_commit() {
    let bare = TempDir::new().unwrap();
    assert_eq!(seen(bare.path()), None);
    // A package that was unpacked within the repository of something else.
    let folder = repository();
    let unpacked = folder.path().join("vendor/fissure");
    std::fs::create_dir_all(unpacked.join("crates")).unwrap();
    assert_eq!(seen(&unpacked), None);
    // A repository before its first commit.
    git(bare.path(), &["init", "-q"]);
    assert_eq!(seen(bare.path()), None);
}

#[test]
fn the_program_says_its_version_and_commit() {
    let output = Command::new(env!("CARGO_BIN_EXE_fissure")).arg("--version").output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let version = env!("CARGO_PKG_VERSION");
    let expected = match seen(&root) {
        Some(commit) => format!("fissure {version} ({commit})\n"),
        None => format!("fissure {version}\n"),
    };
    assert_eq!(said, expected);
}
