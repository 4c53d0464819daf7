//! Names: those that become file names stay in their folder on every system, and none can mean something to a terminal.

use crate::fault::{Check, KeyPath, SceneFault};

/// Most bytes of a name: with frame number, part and extension a file name stays far below the 255 of common file
/// systems.
const MOST_BYTES: usize = 120;
/// Characters that some system does not take in file names, or takes for a way into another folder.
const FORBIDDEN: [char; 9] = ['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// That the scene's name can be the beginning of file names.
pub(super) fn validate_file_name(path: KeyPath, name: &str) -> Check {
    let refused = |why: &str| {
        Err(SceneFault::new(
            path.clone(),
            format!("the scene's name `{}` {why}, and its files are named after it", name.escape_debug()),
            "choose a plain file name, such as `name = \"plate-2\"`",
        ))
    };
    if name.trim().is_empty() {
        return refused("is empty");
    }
    if name.len() > MOST_BYTES {
        return refused(&format!("has {} bytes, more than {MOST_BYTES}", name.len()));
    }
    if let Some(c) = name.chars().find(|c| c.is_control() || FORBIDDEN.contains(c)) {
        return refused(&format!("holds `{}`", c.escape_debug()));
    }
    if name.ends_with(['.', ' ']) || name.starts_with(' ') {
        return refused("begins with a space, or ends with a space or a dot");
    }
    if is_device(name) {
        return refused("is the name of a device on Windows");
    }
    Ok(())
}

/// Whether Windows takes a name for a device, whatever follows after a dot.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_lowercase();
    let numbered = |kind: &str| {
        stem.strip_prefix(kind).is_some_and(|n| n.len() == 1 && n.starts_with(|c: char| c.is_ascii_digit()))
    };
    ["con", "prn", "aux", "nul"].contains(&stem.as_str()) || numbered("com") || numbered("lpt")
}

/// That a name within the scene can be shown and written into files.
pub(super) fn validate_word(path: KeyPath, what: &str, name: &str) -> Check {
    let why = if name.len() > MOST_BYTES {
        format!("has {} bytes, more than {MOST_BYTES}", name.len())
    } else if let Some(c) = name.chars().find(|c| c.is_control()) {
        format!("holds the control character `{}`", c.escape_debug())
    } else {
        return Ok(());
    };
    let shown: String = name.chars().take(MOST_BYTES).collect();
    let message = format!("the name `{}` of a {what} {why}", shown.escape_debug());
    Err(SceneFault::new(path, message, "choose a short name of letters, digits and the like"))
}

/// That a name can be shown and is no other's. `before`: the names of its like so far.
pub(super) fn unique_name<'a>(
    path: &KeyPath,
    what: &str,
    name: &str,
    mut before: impl Iterator<Item = &'a str>,
) -> Check {
    if name.is_empty() || before.any(|b| b == name) {
        let message = if name.is_empty() {
            format!("a {what} has an empty name")
        } else {
            format!("two of them are called {what} `{name}`")
        };
        return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
    }
    validate_word(path.then("name"), what, name)
}
