//! A table of measurements: comma-separated values that grow by a row as each is measured.

use super::origin::Origin;
use crate::exit::Exit;
use crate::failure::Failure;
use fissure_files::Folder;

/// A table in a file. Its first line says on what it was measured, its second names the columns.
#[derive(Debug)]
pub(super) struct Table<'a> {
    folder: &'a Folder,
    name: String,
    rows: Vec<Vec<String>>,
}

impl<'a> Table<'a> {
    /// Opens the table `name`: goes on with one of the same origin and columns, and begins any other anew.
    ///
    /// # Errors
    /// When the file cannot be read or written.
    pub(super) fn open(folder: &'a Folder, name: &str, origin: &Origin, columns: &str) -> Result<Self, Failure> {
        let name = format!("{name}.csv");
        let head = format!("# {origin}\n{columns}\n");
        let found = folder.read(&name)?.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default();
        let mut rows = Vec::new();
        match found.strip_prefix(&head) {
            Some(text) => {
                // A last row that was cut off goes, and the next one begins a line of its own.
                let whole = text.rfind('\n').map_or(0, |end| end + 1);
                if whole < text.len() {
                    folder.write(&name, &found.as_bytes()[..head.len() + whole])?;
                }
                let width = columns.split(',').count();
                rows.extend(text[..whole].lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>()));
                if let Some(row) = rows.iter().find(|row| row.len() != width) {
                    return Err(Failure::new(
                        Exit::File,
                        format!("`{}` has a row of {} columns, not {width}: {}", name, row.len(), row.join(",")),
                        "remove the file to measure anew",
                    ));
                }
            }
            None => folder.write(&name, head.as_bytes())?,
        }
        Ok(Self { folder, name, rows })
    }

    /// The rows so far.
    pub(super) fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// Adds a row, which is on the disk when this returns. Commas and line breaks in cells become semicolons.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn add(&mut self, row: Vec<String>) -> Result<(), Failure> {
        let row: Vec<String> = row.into_iter().map(|cell| cell.replace([',', '\n'], ";")).collect();
        self.folder.append(&self.name, format!("{}\n", row.join(",")).as_bytes())?;
        self.rows.push(row);
        Ok(())
    }
}

/// A number of a row; what is none there is none here.
pub(super) fn number(cell: &str) -> f64 {
    cell.parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: what was added is there, no more and no less; a row that was cut off is measured again, and numbers of
    /// another machine or program are never mixed with ours.
    #[test]
    fn a_table_goes_on_where_it_was_interrupted() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::new(place.path());
        let (ours, theirs) = (Origin::of_now(1, true), Origin::of_now(2, true));
        let row = |words: [&str; 2]| words.map(str::to_owned).to_vec();
        let mut table = Table::open(&folder, "t", &ours, "what,much").unwrap();
        table.add(row(["a", "1"])).unwrap();
        table.add(row(["b", "2, 3"])).unwrap();
        let whole = folder.read("t.csv").unwrap().unwrap();
        folder.write("t.csv", &whole[..whole.len() - 2]).unwrap();
        let mut table = Table::open(&folder, "t", &ours, "what,much").unwrap();
        assert_eq!(table.rows(), [row(["a", "1"])]);
        table.add(row(["b", "2; 3"])).unwrap();
        assert_eq!(folder.read("t.csv").unwrap().unwrap(), whole);
        assert!(Table::open(&folder, "t", &theirs, "what,much").unwrap().rows().is_empty());
    }
}
