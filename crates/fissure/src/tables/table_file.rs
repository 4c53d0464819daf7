//! The file of a table, which grows frame by frame and goes on where a run was interrupted.

use crate::failure::Failure;
use fissure_files::Folder;
use fissure_sim::Simulation;
use std::fmt::{Display, Write as _};

/// A file of comma-separated values, of which the first is the number of the frame that a row is written with.
#[derive(Debug)]
pub(super) struct TableFile {
    folder: Folder,
    name: String,
    /// Rows of the frame that is being computed.
    rows: String,
}

impl TableFile {
    /// The table `SCENE.KIND.csv` in `folder` with the columns of `head`; and its rows up to the frame that
    /// `simulation` is at, without the head. Rows of later frames, and one that was cut off, go.
    ///
    /// # Errors
    /// When it cannot be read or written.
    pub(super) fn open(
        folder: &Folder,
        kind: &str,
        head: &str,
        simulation: &Simulation,
    ) -> Result<(Self, String), Failure> {
        let name = name(kind, simulation);
        let found = folder.read(&name)?.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default();
        let kept = kept(&found, head, simulation.frame_number());
        folder.write(&name, format!("{head}\n{kept}").as_bytes())?;
        Ok((Self { folder: folder.clone(), name, rows: String::new() }, kept))
    }

    /// Adds a row: words and whole numbers, then numbers that are written so that nothing is lost.
    pub(super) fn add(&mut self, words: &[&dyn Display], numbers: &[f64]) {
        // Writing to a string cannot fail.
        for (k, word) in words.iter().enumerate() {
            let _ = write!(self.rows, "{}{word}", if k > 0 { "," } else { "" });
        }
        for number in numbers {
            let _ = write!(self.rows, ",{number:e}");
        }
        self.rows.push('\n');
    }

    /// Brings the rows to the disk.
    ///
    /// # Errors
    /// When they cannot be written.
    pub(super) fn write(&mut self) -> Result<(), Failure> {
        self.folder.append(&self.name, self.rows.as_bytes())?;
        self.rows.clear();
        Ok(())
    }
}

/// Removes the table of an earlier run, if there is one.
///
/// # Errors
/// When it cannot be read or removed.
pub(super) fn remove(folder: &Folder, kind: &str, head: &str, simulation: &Simulation) -> Result<(), Failure> {
    let name = name(kind, simulation);
    // What does not begin as a table does is somebody's own.
    if folder.read(&name)?.is_some_and(|found| found.starts_with(head.as_bytes())) {
        folder.remove(&name)?;
    }
    Ok(())
}

/// Name of a table's file.
fn name(kind: &str, simulation: &Simulation) -> String {
    format!("{}.{kind}.csv", simulation.scene().name)
}

/// The whole rows in `text` of frames up to `newest`; none of a table with another head.
fn kept(text: &str, head: &str, newest: i64) -> String {
    let is_kept = |row: &&str| {
        let frame = row.split(',').next().and_then(|cell| cell.parse::<i64>().ok());
        row.ends_with('\n') && frame.is_some_and(|frame| frame <= newest)
    };
    let rows = text.strip_prefix(head).and_then(|rest| rest.strip_prefix('\n')).unwrap_or_default();
    rows.split_inclusive('\n').filter(is_kept).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: what a run that was never interrupted would have written up to that frame; a row that was cut off, rows
    /// of the frame that was not finished, and a table of another kind go.
    #[test]
    fn rows_of_frames_that_are_not_there_go() {
        assert_eq!(kept("frame,a\n1,a\n2,b\n3,c\n4,d\n3,", "frame,a", 3), "1,a\n2,b\n3,c\n");
        assert_eq!(kept("frame,a,b\n1,a\n", "frame,a", 3), "");
    }
}
