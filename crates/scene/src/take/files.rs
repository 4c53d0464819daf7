//! Files that appear whole or not at all.

use super::TakeError;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Writes `bytes` under a temporary name in the same folder and renames it to `path`.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), TakeError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let temporary = path.with_file_name(name);
    let written = fs::File::create(&temporary).and_then(|mut file| file.write_all(bytes));
    if let Err(cause) = written.and_then(|()| fs::rename(&temporary, path)) {
        // What is half-written goes; when even that fails, the first cause is the one to tell.
        let _ = fs::remove_file(&temporary);
        return Err(TakeError::io("write", path)(cause));
    }
    Ok(())
}

/// Removes a file; that it is not there is fine.
pub(crate) fn remove(path: &Path) -> Result<(), TakeError> {
    match fs::remove_file(path) {
        Err(cause) if cause.kind() != std::io::ErrorKind::NotFound => Err(TakeError::io("remove", path)(cause)),
        _ => Ok(()),
    }
}
