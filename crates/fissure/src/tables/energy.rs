//! `NAME.energy.csv`: where the energy is that was put in.

use super::table_file::TableFile;
use crate::failure::Failure;
use fissure_files::Folder;
use fissure_sim::Simulation;

pub(super) const KIND: &str = "energy";
pub(super) const HEAD: &str = "frame,time,external_work,kinetic,strain,crack,damping,rest";

/// The table.
#[derive(Debug)]
pub(super) struct Energy {
    pub(super) file: TableFile,
    /// What the body had in its first row [J/m], less the work until then.
    first: f64,
    /// Energy that damping has taken so far [J/m].
    damping: f64,
    /// When the last step ended [s].
    time: f64,
}

impl Energy {
    /// See [`super::Tables::open`].
    pub(super) fn open(folder: &Folder, simulation: &Simulation) -> Result<Self, Failure> {
        let (file, kept) = TableFile::open(folder, KIND, HEAD, simulation)?;
        let mut table = Self { file, first: 0.0, damping: 0.0, time: simulation.time() };
        match (kept.lines().next().and_then(numbers), kept.lines().last().and_then(numbers)) {
            (Some(first), Some(last)) => {
                let [_, work, kinetic, strain, crack, ..] = first;
                table.first = kinetic + strain + crack - work;
                table.damping = last[5];
            }
            _ => {
                let e = simulation.energies_of_one_moment();
                table.first = e.kinetic + e.strain + e.crack - e.external_work;
                table.row(simulation, simulation.frame_number());
                table.file.write()?;
            }
        }
        Ok(table)
    }

    /// After a step towards the frame `frame`, with a row if it `has_row`.
    pub(super) fn step(&mut self, simulation: &Simulation, frame: i64, has_row: bool) {
        let time_step = simulation.time() - std::mem::replace(&mut self.time, simulation.time());
        let rate = simulation.scene().solver.damping;
        if rate > 0.0 {
            // Velocities have fallen by exp(-rate Δt) to what they are now.
            self.damping += simulation.kinetic_energy() * (2.0 * rate * time_step).exp_m1();
        }
        if has_row {
            self.row(simulation, frame);
        }
    }

    fn row(&mut self, simulation: &Simulation, frame: i64) {
        let e = simulation.energies_of_one_moment();
        let rest = self.first + e.external_work - e.kinetic - e.strain - e.crack - self.damping;
        let numbers = [simulation.time(), e.external_work, e.kinetic, e.strain, e.crack, self.damping, rest];
        self.file.add(&[&frame], &numbers);
    }
}

/// The numbers of a row after that of its frame.
fn numbers(row: &str) -> Option<[f64; 7]> {
    let numbers: Option<Vec<f64>> = row.split(',').skip(1).map(|cell| cell.parse().ok()).collect();
    numbers?.try_into().ok()
}
