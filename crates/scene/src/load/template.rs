//! The scene that `fissure new` writes.

/// A commented scene file that loads and runs: a plate with an edge crack, pulled apart.
pub fn template() -> &'static str {
    include_str!("template.toml")
}
