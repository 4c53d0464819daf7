//! Tables beside the take, as fine as the run is: what engineers hand in. Rows of a frame go to the disk with it.

mod contours;
mod energy;
mod looks;
mod supports;
mod table_file;

use crate::args::TableName;
use crate::failure::Failure;
use contours::Contours;
use energy::Energy;
use fissure_files::Folder;
use fissure_sim::{Progress, Simulation};
use looks::Looks;
use supports::Supports;

/// Rows of energies and supports to a frame, at most.
const ROWS_PER_FRAME: u64 = 8;

/// The tables of a run that are wanted.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    looks: Option<Looks>,
    contours: Option<Contours>,
    energy: Option<Energy>,
    supports: Option<Supports>,
}

impl Tables {
    /// The tables `wanted` in `folder`, going on after the frame that `simulation` is at. Rows of later frames, which
    /// an interrupted run has left, go; when a run begins, so do tables of an earlier one that are not wanted any more.
    ///
    /// # Errors
    /// When they cannot be written.
    pub(crate) fn open(wanted: &[TableName], folder: &Folder, simulation: &mut Simulation) -> Result<Self, Failure> {
        let is_wanted = |name| wanted.contains(&name);
        if simulation.frame_number() == simulation.scene().frames.first {
            for (name, kind, head) in [
                (TableName::Looks, looks::KIND, looks::HEAD),
                (TableName::Contours, contours::KIND, contours::HEAD),
                (TableName::Energy, energy::KIND, energy::HEAD),
                (TableName::Supports, supports::KIND, supports::HEAD),
            ] {
                if !is_wanted(name) {
                    table_file::remove(folder, kind, head, simulation)?;
                }
            }
        }
        if is_wanted(TableName::Contours) {
            simulation.watch_contours();
        }
        if !is_wanted(TableName::Looks) && !is_wanted(TableName::Contours) {
            simulation.spare_looks();
        }
        let simulation = &*simulation;
        let looks = is_wanted(TableName::Looks).then(|| Looks::open(folder, simulation));
        let contours = is_wanted(TableName::Contours).then(|| Contours::open(folder, simulation));
        let energy = is_wanted(TableName::Energy).then(|| Energy::open(folder, simulation));
        let supports = is_wanted(TableName::Supports).then(|| Supports::open(folder, simulation));
        Ok(Self {
            looks: looks.transpose()?,
            contours: contours.transpose()?,
            energy: energy.transpose()?,
            supports: supports.transpose()?,
        })
    }

    /// After a step towards the frame `frame`.
    pub(crate) fn step(&mut self, simulation: &Simulation, frame: i64, now: &Progress) {
        if let Some(looks) = &mut self.looks {
            looks.step(simulation, frame);
        }
        if let Some(contours) = &mut self.contours {
            contours.step(simulation, frame);
        }
        let stride = now.frame_steps_total.div_ceil(ROWS_PER_FRAME).max(1);
        let has_row = now.frame_steps.is_multiple_of(stride) || now.frame_steps == now.frame_steps_total;
        if let Some(energy) = &mut self.energy {
            energy.step(simulation, frame, has_row);
        }
        if let Some(supports) = self.supports.as_mut().filter(|_| has_row) {
            supports.row(simulation, frame);
        }
    }

    /// The frame is there: its rows go to the disk.
    ///
    /// # Errors
    /// When they cannot be written.
    pub(crate) fn frame(&mut self) -> Result<(), Failure> {
        if let Some(looks) = &mut self.looks {
            looks.file.write()?;
        }
        if let Some(contours) = &mut self.contours {
            contours.file.write()?;
        }
        if let Some(energy) = &mut self.energy {
            energy.file.write()?;
        }
        if let Some(supports) = &mut self.supports {
            supports.file.write()?;
        }
        Ok(())
    }
}
