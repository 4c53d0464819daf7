//! What is wrong with a scene or will go wrong, and where: the words that all checks share.

use std::fmt;

/// One step of a path into a scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Key {
    /// A key of a table.
    Name(String),
    /// An item of an array, from 0.
    Index(usize),
}

impl From<&str> for Key {
    fn from(name: &str) -> Self {
        Self::Name(name.into())
    }
}

impl From<usize> for Key {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// A path into a scene file, such as `body[0].shape.rectangle.min`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct KeyPath(pub Vec<Key>);

impl KeyPath {
    /// This path and one step more.
    pub fn then(&self, key: impl Into<Key>) -> Self {
        let mut keys = self.0.clone();
        keys.push(key.into());
        Self(keys)
    }

    /// Path of an item of a top-level array of tables.
    pub fn item(array: &str, index: usize) -> Self {
        Self(vec![array.into(), index.into()])
    }

    /// Path of a key of a top-level table.
    pub fn setting(table: &str, key: &str) -> Self {
        Self(vec![table.into(), key.into()])
    }

    /// Path of a top-level key.
    pub fn top(key: &str) -> Self {
        Self(vec![key.into()])
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, key) in self.0.iter().enumerate() {
            match key {
                Key::Name(name) if i == 0 => write!(f, "{name}")?,
                Key::Name(name) => write!(f, ".{name}")?,
                Key::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// Something in a scene that cannot be simulated: where it is, what it is, and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{path}: {message}; {remedy}")]
pub struct SceneFault {
    /// The key of the scene file that holds the offending value.
    pub path: KeyPath,
    /// Another key that it does not go together with.
    pub other: Option<KeyPath>,
    /// What is wrong, with the offending value.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

impl SceneFault {
    /// A fault at `path`.
    pub fn new(path: KeyPath, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { path, other: None, message: message.into(), remedy: remedy.into() }
    }

    /// The same fault of two keys that do not go together.
    pub fn with(self, other: KeyPath) -> Self {
        Self { other: Some(other), ..self }
    }
}

/// What a check of a scene says: it holds, or the first fault.
pub(crate) type Check = Result<(), SceneFault>;

/// Something in a scene that can be simulated but will hardly give what its author wants: where it is, what it is, and
/// what to do about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// The key of the scene file that holds the value that matters.
    pub path: KeyPath,
    /// What is to be expected, with the value.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

impl Warning {
    /// A warning about what stands at `path`.
    pub fn new(path: KeyPath, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { path, message: message.into(), remedy: remedy.into() }
    }
}

/// A point as messages show it.
pub(crate) fn show(point: crate::Point) -> String {
    format!("({}, {})", short(point.x), short(point.y))
}

/// A number with at most seven digits.
pub(crate) fn short(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}
