//! Reading files that strangers name: regular ones only, and no more of them than expected.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The bytes of a regular file of at most `most` bytes.
///
/// A pipe or a device is refused before it is opened: reading it might never end.
///
/// # Errors
/// When the file cannot be read, is not a regular one, is larger, or does not fit into memory.
pub fn read_regular(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let about = std::fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
    }
    if !about.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a pipe or a device, not a regular file"));
    }
    let too_large = |bytes: u64| {
        let message = format!("it has {bytes} bytes, at most {most} ({} MiB) are read", most >> 20);
        io::Error::new(io::ErrorKind::FileTooLarge, message)
    };
    if about.len() > most {
        return Err(too_large(about.len()));
    }
    let mut bytes = Vec::new();
    // A file of holes may be longer than all memory.
    bytes.try_reserve_exact(usize::try_from(about.len()).unwrap_or(usize::MAX))?;
    // A file that grows while it is read counts as it is at the end.
    File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn only_regular_files_of_the_expected_size_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, [7; 100]).unwrap();
        assert_eq!(read_regular(&path, 100).unwrap(), [7; 100]);
        let told = |path: &Path, most| read_regular(path, most).unwrap_err().to_string();
        assert!(told(&path, 99).contains("at most 99"));
        assert!(told(folder.path(), 100).contains("folder"));
        #[cfg(unix)]
        for device in ["/dev/zero", "/dev/null"] {
            assert!(told(Path::new(device), 100).contains("device"));
        }
    }
}
