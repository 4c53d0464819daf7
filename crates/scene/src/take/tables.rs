//! `tips.csv` and `energy.csv`: what people plot.

use super::{TakeError, files};
use crate::frame::{End, Frame, TipState};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

const TIPS: &str = "tips.csv";
const TIPS_HEAD: &str = "frame,time,crack,end,state,x,y,direction,j_integral,mode_1,mode_2,kink_angle,equivalent,\
                         fracture_toughness,speed,length,contour_radius,radius_shrunk\n";
const ENERGY: &str = "energy.csv";
const ENERGY_HEAD: &str = "frame,time,kinetic,strain,external_work,crack\n";

/// Starts both tables.
pub(crate) fn create(folder: &Path) -> Result<(), TakeError> {
    files::write_whole(&folder.join(TIPS), TIPS_HEAD.as_bytes())?;
    files::write_whole(&folder.join(ENERGY), ENERGY_HEAD.as_bytes())
}

/// Takes the rows of frames after `last` off, and a row that was cut off in the middle.
pub(crate) fn truncate(folder: &Path, last: i64) -> Result<(), TakeError> {
    for (name, head) in [(TIPS, TIPS_HEAD), (ENERGY, ENERGY_HEAD)] {
        let path = folder.join(name);
        let text = std::fs::read_to_string(&path).map_err(TakeError::io("read", &path))?;
        let kept = text.split_inclusive('\n').skip(1).filter(|row| {
            row.ends_with('\n') && row.split(',').next().and_then(|n| n.parse::<i64>().ok()).is_some_and(|n| n <= last)
        });
        let text: String = std::iter::once(head).chain(kept).collect();
        files::write_whole(&path, text.as_bytes())?;
    }
    Ok(())
}

/// Adds the rows of one frame.
pub(crate) fn append(folder: &Path, frame: &Frame) -> Result<(), TakeError> {
    let mut rows = String::new();
    for t in &frame.tips {
        let _ =
            write!(rows, "{},{:e},{},{},{}", frame.number, frame.time, t.crack, end_word(t.end), state_word(t.state));
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
    add(&folder.join(TIPS), &rows)?;
    let e = &frame.energies;
    let row = format!(
        "{},{:e},{:e},{:e},{:e},{:e}\n",
        frame.number, frame.time, e.kinetic, e.strain, e.external_work, e.crack
    );
    add(&folder.join(ENERGY), &row)
}

fn add(path: &Path, rows: &str) -> Result<(), TakeError> {
    let file = std::fs::OpenOptions::new().append(true).open(path);
    file.and_then(|mut file| file.write_all(rows.as_bytes())).map_err(TakeError::io("write", path))
}

fn end_word(end: End) -> &'static str {
    match end {
        End::Start => "start",
        End::End => "end",
    }
}

fn state_word(state: TipState) -> &'static str {
    match state {
        TipState::Resting => "resting",
        TipState::Growing => "growing",
        TipState::Arrested => "arrested",
        TipState::LeftBody => "left_body",
        TipState::MetCrack => "met_crack",
        TipState::GuideEnded => "guide_ended",
    }
}
