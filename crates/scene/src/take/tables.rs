//! `tips.csv`, `energy.csv` and `supports.csv`: what people plot. They hold nothing that is not in the frames, and are
//! written anew from these where they are torn or changed.

use super::list::{FileEntry, FrameEntry};
use super::{TakeError, frame_file};
use crate::frame::{End, Frame};
use fissure_files::Folder;
use std::fmt::Write as _;

/// One table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table {
    /// Name of its file.
    pub(super) name: &'static str,
    /// Its first line.
    head: &'static str,
    /// The rows that a frame adds.
    rows: fn(&Frame) -> String,
}

/// All tables, in the order in which the list of frames has their rows.
pub(super) const TABLES: [Table; 3] = [
    Table {
        name: "tips.csv",
        head: "frame,time,crack,end,state,x,y,direction,j_integral,mode_1,mode_2,kink_angle,equivalent,\
               fracture_toughness,speed,length,contour_radius,radius_shrunk\n",
        rows: tip_rows,
    },
    Table { name: "energy.csv", head: "frame,time,kinetic,strain,external_work,crack\n", rows: energy_row },
    Table { name: "supports.csv", head: "frame,time,support,force_x,force_y,work\n", rows: support_rows },
];

impl Table {
    /// Length of the part of `text` that the list of frames accounts for; none when that part is not as it was written.
    pub(super) fn sound_length(self, text: &[u8], entries: &[FrameEntry]) -> Option<usize> {
        let mut rest = text.strip_prefix(self.head.as_bytes())?;
        for entry in entries {
            let rows = entry.rows.iter().find(|rows| rows.name == self.name)?;
            let (these, after) = rest.split_at_checked(usize::try_from(rows.bytes).ok()?)?;
            if !rows.fits(these) {
                return None;
            }
            rest = after;
        }
        Some(text.len() - rest.len())
    }

    /// Brings the table to the frames that are listed: rows of later ones go, and where it is not as it was written all
    /// of it is made anew from the frames. Returns whether that was so.
    fn repair(self, folder: &Folder, entries: &[FrameEntry]) -> Result<bool, TakeError> {
        let text = folder.read(self.name)?.unwrap_or_default();
        match self.sound_length(&text, entries) {
            Some(length) if length == text.len() => Ok(false),
            Some(length) => Ok(folder.write(self.name, &text[..length]).map(|()| false)?),
            None => {
                let mut text = self.head.to_owned();
                let at_rest = frame_file::read_at_rest(folder, entries)?;
                for entry in entries {
                    text += &(self.rows)(&frame_file::read(folder, entry, at_rest.as_ref())?);
                }
                folder.write(self.name, text.as_bytes())?;
                Ok(true)
            }
        }
    }
}

/// Starts all tables; [`Folder::sync`] is left to the caller.
pub(super) fn create(folder: &Folder) -> Result<(), TakeError> {
    Ok(TABLES.iter().try_for_each(|table| folder.write(table.name, table.head.as_bytes()))?)
}

/// Whether there is nothing in `text` but the first line of one of the tables.
pub(super) fn is_fresh(text: &[u8]) -> bool {
    TABLES.iter().any(|table| table.head.as_bytes() == text)
}

/// Brings all tables to the frames that are listed; returns the names of those that had to be made anew.
pub(super) fn repair(folder: &Folder, entries: &[FrameEntry]) -> Result<Vec<&'static str>, TakeError> {
    let mut made = Vec::new();
    for table in TABLES {
        if table.repair(folder, entries)? {
            made.push(table.name);
        }
    }
    Ok(made)
}

/// Adds the rows of one frame; says what they are.
pub(super) fn append(folder: &Folder, frame: &Frame) -> Result<Vec<FileEntry>, TakeError> {
    let mut added = Vec::new();
    for table in TABLES {
        let rows = (table.rows)(frame);
        folder.append(table.name, rows.as_bytes())?;
        added.push(FileEntry::new(table.name, rows.as_bytes()));
    }
    Ok(added)
}

fn tip_rows(frame: &Frame) -> String {
    let mut rows = String::new();
    for t in &frame.tips {
        // Writing to a string cannot fail.
        let _ = write!(rows, "{},{:e},{},{},{}", frame.number, frame.time, t.crack, end_word(t.end), t.state.word());
        let numbers = [
            t.position.x,
            t.position.y,
            t.direction,
            t.j_integral,
            t.mode_1,
            t.mode_2,
            t.kink_angle,
            t.equivalent,
            t.fracture_toughness,
            t.speed,
            t.length,
            t.contour_radius,
        ];
        numbers.iter().for_each(|n| {
            let _ = write!(rows, ",{n:e}");
        });
        let _ = writeln!(rows, ",{}", u8::from(t.radius_shrunk));
    }
    rows
}

fn energy_row(frame: &Frame) -> String {
    let e = &frame.energies;
    format!("{},{:e},{:e},{:e},{:e},{:e}\n", frame.number, frame.time, e.kinetic, e.strain, e.external_work, e.crack)
}

fn support_rows(frame: &Frame) -> String {
    let mut rows = String::new();
    for (index, s) in frame.supports.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ =
            writeln!(rows, "{},{:e},{index},{:e},{:e},{:e}", frame.number, frame.time, s.force.x, s.force.y, s.work);
    }
    rows
}

fn end_word(end: End) -> &'static str {
    match end {
        End::Start => "start",
        End::End => "end",
    }
}
