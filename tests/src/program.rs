//! The program as a process: a scene for it, and what it has written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A plate of 20 m × 20 m with a crack that is torn apart, so coarse that it runs in a moment.
pub const PLATE: &str = r#"
[[body]]
name = "plate"
material = "pmma"
shape = { rectangle = { min = [-10.0, -10.0], max = [10.0, 10.0] } }

[[crack]]
name = "notch"
line = [[0.0, 10.5], [0.0, 4.0]]

[[load]]
select = { edge = "left" }
force = [-20e6, 0.0]

[[load]]
select = { edge = "right" }
force = [20e6, 0.0]

[grid]
particle_spacing = 1.0

[frames]
range = "1-12"
rate = 1000.0

[output]
thickness = 2.0
"#;

/// All files below `folder`: path from there, and content.
///
/// # Errors
/// When the folder cannot be listed or a file cannot be read.
pub fn files(folder: &Path) -> std::io::Result<BTreeMap<PathBuf, Vec<u8>>> {
    let (mut found, mut open) = (BTreeMap::new(), vec![folder.to_owned()]);
    while let Some(directory) = open.pop() {
        for entry in std::fs::read_dir(directory)? {
            let path = entry?.path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap_or(&path).to_owned();
                found.insert(name, std::fs::read(&path)?);
            }
        }
    }
    Ok(found)
}
