//! `NAME.looks.csv`: what was measured at the tips, at every look instead of every frame.

use crate::failure::Failure;
use fissure_files::Folder;
use fissure_scene::{End, TipRecord, TipState};
use fissure_sim::{Simulation, StressIntensity};
use std::collections::BTreeMap;
use std::collections::VecDeque;
use std::fmt::Write as _;

const HEAD: &str = "frame,time,crack,end,state,length,speed,j_integral,mode_1,mode_2,mode_1_moving,mode_2_moving,\
                    equivalent,fracture_toughness,kink_angle,contour_radius\n";

/// The speed of a tip is its mean over the last so many cells of its way: within a cell it runs now faster, now slower.
const SPEED_OVER: f64 = 2.0;
/// A tip that has not moved for so many times that a wave takes for a cell has no speed.
const STANDS_STILL: f64 = 25.0;

/// The table, which grows with every frame.
#[derive(Debug)]
pub(crate) struct Looks {
    folder: Folder,
    name: String,
    /// Rows of the frame that is being computed.
    rows: String,
    tips: BTreeMap<(u32, u8), Seen>,
    /// When the step that is being looked at began [s].
    time: f64,
}

/// What is known of a tip.
#[derive(Debug, Default)]
struct Seen {
    /// J, K_I, K_II and length of its last row.
    last: Option<[f64; 4]>,
    /// When [s] it had which length [m], each time that it grew.
    way: VecDeque<(f64, f64)>,
}

impl Looks {
    /// The table of the scene `name` in `folder`, going on after the frame `newest` of a run that is at `time` [s].
    /// Rows of later frames, which an interrupted run has left, go.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn open(folder: &Folder, name: &str, newest: i64, time: f64) -> Result<Self, Failure> {
        let name = format!("{name}.looks.csv");
        let found = folder.read(&name)?.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default();
        let is_kept = |row: &&str| {
            let frame = row.split(',').next().and_then(|cell| cell.parse::<i64>().ok());
            row.ends_with('\n') && frame.is_some_and(|frame| frame <= newest)
        };
        let kept: String = found.strip_prefix(HEAD).unwrap_or_default().split_inclusive('\n').filter(is_kept).collect();
        folder.write(&name, format!("{HEAD}{kept}").as_bytes())?;
        Ok(Self { folder: folder.clone(), name, rows: String::new(), tips: BTreeMap::new(), time })
    }

    /// After a step towards the frame `frame`: a row for each tip that was looked at.
    pub(crate) fn step(&mut self, simulation: &Simulation, frame: i64) {
        let measured = std::mem::replace(&mut self.time, simulation.time());
        let h = simulation.scene().cell_size;
        for tip in simulation.tips() {
            let seen = self.tips.entry((tip.crack, u8::from(tip.end == End::End))).or_default();
            if seen.way.back().is_none_or(|&(_, length)| tip.length > length) {
                seen.way.push_back((measured, tip.length));
            }
            let now = [tip.j_integral, tip.mode_1, tip.mode_2, tip.length];
            if seen.last == Some(now) {
                continue;
            }
            seen.last = Some(now);
            let Some(elastic) = simulation.elastic_at(&tip) else { continue };
            let still = STANDS_STILL * h / elastic.dilatational_wave_speed();
            let speed = seen.speed(measured, SPEED_OVER * h, still, &tip);
            let modes = StressIntensity { mode_1: tip.mode_1, mode_2: tip.mode_2 };
            let moving = modes.of_moving_tip(tip.j_integral, elastic, speed);
            let end = if tip.end == End::Start { "start" } else { "end" };
            // Writing to a string cannot fail.
            let _ = write!(self.rows, "{frame},{measured:e},{},{end},{}", tip.crack, tip.state.word());
            let numbers = [tip.length, speed, tip.j_integral, tip.mode_1, tip.mode_2, moving.mode_1, moving.mode_2];
            let more = [tip.equivalent, tip.fracture_toughness, tip.kink_angle, tip.contour_radius];
            for number in numbers.into_iter().chain(more) {
                let _ = write!(self.rows, ",{number:e}");
            }
            self.rows.push('\n');
        }
    }

    /// The frame is there: its rows go to the disk.
    ///
    /// # Errors
    /// When they cannot be written.
    pub(crate) fn frame(&mut self) -> Result<(), Failure> {
        self.folder.append(&self.name, self.rows.as_bytes())?;
        self.rows.clear();
        Ok(())
    }
}

impl Seen {
    /// Mean speed over the last `over` of its way [m/s]; 0 where it has stood still for longer than `still` [s].
    fn speed(&mut self, now: f64, over: f64, still: f64, tip: &TipRecord) -> f64 {
        while self.way.len() > 2 && self.way.get(1).is_some_and(|&(_, length)| tip.length - length >= over) {
            self.way.pop_front();
        }
        match (self.way.front(), self.way.back()) {
            (Some(&(begun, from)), Some(&(moved, to)))
                if to > from && now - moved < still && tip.state == TipState::Growing =>
            {
                (to - from) / (now - begun)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: what a run that was never interrupted would have written up to that frame; a row that was cut off, and
    /// rows of the frame that was not finished, go.
    #[test]
    fn rows_of_frames_that_are_not_there_go() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::new(place.path());
        folder.write("s.looks.csv", format!("{HEAD}1,a\n2,b\n3,c\n4,d\n4,").as_bytes()).unwrap();
        Looks::open(&folder, "s", 3, 0.0).unwrap();
        let text = String::from_utf8(folder.read("s.looks.csv").unwrap().unwrap()).unwrap();
        assert_eq!(text, format!("{HEAD}1,a\n2,b\n3,c\n"));
    }
}
