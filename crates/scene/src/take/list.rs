//! `frames.jsonl`: the frames there are, one line each. Lines are only ever added; one is added when its frame is on
//! the disk, so that whatever is listed is there.

use super::error::TakeError;
use super::sealed::{LINE, sha256};
use fissure_files::Folder;
use serde::{Deserialize, Serialize};

/// Name of the file.
pub(super) const NAME: &str = "frames.jsonl";

/// One frame of a take.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameEntry {
    /// Frame number; each is one more than the number before.
    pub number: i64,
    /// Time [s].
    pub time: f64,
    /// Its files, that of the frame itself first.
    pub files: Vec<FileEntry>,
    /// What it added to each of the tables.
    pub rows: Vec<FileEntry>,
}

/// A file, or a part of one, and how to know that it is whole.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Name of the file within the take.
    pub name: String,
    /// Length [bytes].
    pub bytes: u64,
    /// SHA-256 in hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    pub(super) fn new(name: &str, content: &[u8]) -> Self {
        Self { name: name.into(), bytes: content.len() as u64, sha256: sha256(content) }
    }

    /// Whether `content` is what was written.
    pub(super) fn fits(&self, content: &[u8]) -> bool {
        self.bytes == content.len() as u64 && self.sha256 == sha256(content)
    }
}

/// Name of the file of a frame: `frame.0001.safetensors`.
pub(super) fn file_name(number: i64) -> String {
    format!("frame.{number:04}.safetensors")
}

/// The list as it is on the disk.
#[derive(Debug, Default)]
pub(super) struct List {
    /// The frames there are, by rising number.
    pub(super) entries: Vec<FrameEntry>,
    /// Whether a last line was not written to its end.
    pub(super) torn: bool,
}

/// Reads the list of a take whose first frame is `first`; one that is missing is empty.
///
/// # Errors
/// When a line is not as it was written.
pub(super) fn read(folder: &Folder, first: i64) -> Result<List, TakeError> {
    let path = folder.place(NAME)?;
    let bytes = folder.read(NAME)?.unwrap_or_default();
    let mut list = List::default();
    for line in bytes.split_inclusive(|&byte| byte == b'\n') {
        let damaged = |cause: &str| TakeError::damaged(&path, format!("line {} {cause}", list.entries.len() + 1));
        let text = std::str::from_utf8(line).ok().filter(|text| LINE.holds(text));
        let Some(text) = text else {
            if line.ends_with(b"\n") || !LINE.is_torn(line) {
                return Err(damaged("is not as it was written"));
            }
            list.torn = true;
            break;
        };
        let entry: FrameEntry = serde_json::from_str(text).map_err(|error| damaged(&format!("says: {error}")))?;
        let expected = list.entries.last().map_or(Some(first), |last| last.number.checked_add(1));
        if expected != Some(entry.number) || entry.files.first().is_none_or(|file| file.name != file_name(entry.number))
        {
            return Err(damaged(&format!("is of frame {}, which is out of place", entry.number)));
        }
        if let Some(file) = entry.files.iter().find(|file| folder.place(&file.name).is_err()) {
            return Err(damaged(&format!("names the file `{}`, which is outside", file.name.escape_debug())));
        }
        list.entries.push(entry);
    }
    Ok(list)
}

/// Adds the line of a frame, and waits until it is on the disk.
pub(super) fn append(folder: &Folder, entry: &FrameEntry) -> Result<(), TakeError> {
    folder.append(NAME, line(folder, entry)?.as_bytes())?;
    Ok(folder.sync_file(NAME)?)
}

/// Writes the whole list; [`Folder::sync`] is left to the caller.
pub(super) fn write(folder: &Folder, entries: &[FrameEntry]) -> Result<(), TakeError> {
    let lines = entries.iter().map(|entry| line(folder, entry)).collect::<Result<String, _>>()?;
    Ok(folder.write(NAME, lines.as_bytes())?)
}

fn line(folder: &Folder, entry: &FrameEntry) -> Result<String, TakeError> {
    let object = serde_json::to_string(entry).map_err(|error| TakeError::damaged(&folder.path().join(NAME), error))?;
    Ok(LINE.seal(&object))
}

/// The frames of a list, in words.
pub(super) fn in_words(entries: &[FrameEntry]) -> String {
    match entries {
        [] => "no frames".into(),
        [only] => format!("frame {}", only.number),
        [first, .., last] => format!("the frames {} to {}", first.number, last.number),
    }
}
