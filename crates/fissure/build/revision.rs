//! The commit that sources stand at, as git tells it: no network, no clock, nothing of this machine.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Hexadecimal digits of a commit that are shown; fixed, so that the number of objects in a clone changes nothing.
const DIGITS: usize = 12;

/// What the program is made of: the sources of all crates and the versions of what they use.
pub(crate) fn sources(root: &Path) -> Vec<PathBuf> {
    let crates = std::fs::read_dir(root.join("crates")).into_iter().flatten().flatten();
    let mut sources: Vec<PathBuf> =
        crates.flat_map(|entry| ["Cargo.toml", "build.rs", "src"].map(|name| entry.path().join(name))).collect();
    sources.extend(["Cargo.toml", "Cargo.lock"].map(|name| root.join(name)));
    sources.retain(|path| path.exists());
    sources.sort();
    sources
}

/// The commit of the repository whose root folder is `root`, with `-dirty` where `sources` differ from it. None without
/// git, without a repository, and where `root` only lies within another repository, which says nothing about it.
pub(crate) fn revision(root: &Path, sources: &[PathBuf]) -> Option<String> {
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if std::fs::canonicalize(top).ok()? != std::fs::canonicalize(root).ok()? {
        return None;
    }
    let commit = git(root, &["rev-parse", "--verify", "HEAD"])?.get(..DIGITS)?.to_owned();
    let sources: Option<Vec<&str>> = sources.iter().map(|path| path.to_str()).collect();
    let compare = [&["diff", "--name-only", "HEAD", "--"][..], &sources?].concat();
    let is_clean = git(root, &compare)?.is_empty();
    Some(if is_clean { commit } else { commit + "-dirty" })
}

/// Files that change when HEAD moves: HEAD itself, when another branch is checked out, and its log, when the branch
/// moves.
pub(crate) fn places_of_head(root: &Path) -> Vec<PathBuf> {
    let place = |name| git(root, &["rev-parse", "--git-path", name]).map(|path| root.join(path));
    ["HEAD", "logs/HEAD"].into_iter().filter_map(place).collect()
}

/// What git says in `folder`, without the line break at its end; none when it fails or is not there.
fn git(folder: &Path, arguments: &[&str]) -> Option<String> {
    // Looking must not write: another git may be at work in the same repository.
    let output =
        Command::new("git").current_dir(folder).env("GIT_OPTIONAL_LOCKS", "0").args(arguments).output().ok()?;
    let text = output.status.success().then(|| String::from_utf8(output.stdout).ok())??;
    Some(text.trim_end().to_owned())
}
