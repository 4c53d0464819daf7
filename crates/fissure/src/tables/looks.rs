//! `NAME.looks.csv`: what was measured at the tips, at every look instead of every frame.

use super::table_file::TableFile;
use crate::failure::Failure;
use fissure_files::Folder;
use fissure_scene::{End, TipRecord, TipState};
use fissure_sim::{Simulation, StressIntensity};
use std::collections::{BTreeMap, VecDeque};

pub(super) const KIND: &str = "looks";
pub(super) const HEAD: &str = "frame,crack,end,state,time,length,speed,j_integral,mode_1,mode_2,mode_1_moving,mode_2_moving,\
                    equivalent,fracture_toughness,kink_angle,contour_radius";

/// The speed of a tip is its mean over the last so many cells of its way: within a cell it runs now faster, now slower.
const SPEED_OVER: f64 = 2.0;
/// A tip that has not moved for so many times that a wave takes for a cell has no speed.
const STANDS_STILL: f64 = 25.0;

/// The table.
#[derive(Debug)]
pub(super) struct Looks {
    pub(super) file: TableFile,
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
    /// See [`super::Tables::open`].
    pub(super) fn open(folder: &Folder, simulation: &Simulation) -> Result<Self, Failure> {
        let (file, kept) = TableFile::open(folder, KIND, HEAD, simulation)?;
        let mut table = Self { file, tips: BTreeMap::new(), time: simulation.time() };
        kept.lines().for_each(|row| table.remember(row));
        Ok(table)
    }

    /// Takes up what is known of a tip from a row of its own.
    fn remember(&mut self, row: &str) {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |place: usize| cells.get(place).and_then(|cell| cell.parse::<f64>().ok());
        let numbers = [4, 5, 7, 8, 9].map(number);
        let [Some(time), Some(length), Some(j_integral), Some(mode_1), Some(mode_2)] = numbers else { return };
        let Some(crack) = cells.get(1).and_then(|cell| cell.parse().ok()) else { return };
        let seen = self.tips.entry((crack, u8::from(cells.get(2) == Some(&"end")))).or_default();
        seen.was_at(time, length);
        seen.last = Some([j_integral, mode_1, mode_2, length]);
    }

    /// After a step towards the frame `frame`: a row for each tip that was looked at.
    pub(super) fn step(&mut self, simulation: &Simulation, frame: i64) {
        let measured = std::mem::replace(&mut self.time, simulation.time());
        let h = simulation.scene().cell_size;
        for tip in simulation.tips() {
            let seen = self.tips.entry((tip.crack, u8::from(tip.end == End::End))).or_default();
            seen.was_at(measured, tip.length);
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
            let state = tip.state.word();
            let numbers = [measured, tip.length, speed, tip.j_integral, tip.mode_1, tip.mode_2];
            let more = [moving.mode_1, moving.mode_2, tip.equivalent, tip.fracture_toughness];
            let last = [tip.kink_angle, tip.contour_radius];
            self.file.add(&[&frame, &tip.crack, &end, &state], &[&numbers[..], &more, &last].concat());
        }
    }
}

impl Seen {
    /// That the crack had a length [m] at a time [s].
    fn was_at(&mut self, time: f64, length: f64) {
        if self.way.back().is_none_or(|&(_, before)| length > before) {
            self.way.push_back((time, length));
        }
    }

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
