//! The command line as it was typed, for messages.

/// The words after the program's name, quoted for a shell.
fn words() -> impl Iterator<Item = String> {
    std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()))
}

/// A word as a shell takes it.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let bare = !word.is_empty() && word.chars().all(plain);
    if bare { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// The command as it was typed.
pub(crate) fn typed() -> String {
    std::iter::once("fissure".to_owned()).chain(words()).collect::<Vec<_>>().join(" ")
}

/// The command that goes on: starting afresh again is not going on.
pub(crate) fn to_go_on() -> String {
    let words = words().filter(|word| word != "--overwrite");
    std::iter::once("fissure".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
