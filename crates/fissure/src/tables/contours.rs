//! `NAME.contours.csv`: J and K of each look over several radii.

use super::table_file::TableFile;
use crate::failure::Failure;
use fissure_files::Folder;
use fissure_scene::End;
use fissure_sim::Simulation;

pub(super) const KIND: &str = "contours";
pub(super) const HEAD: &str =
    "frame,crack,end,time,length,cells,radius,j_domain,j_contour,j_contour_inertia,mode_1,mode_2";

/// The table.
#[derive(Debug)]
pub(super) struct Contours {
    pub(super) file: TableFile,
    /// When the step that is being looked at began [s].
    time: f64,
}

impl Contours {
    /// See [`super::Tables::open`].
    pub(super) fn open(folder: &Folder, simulation: &Simulation) -> Result<Self, Failure> {
        let (file, _) = TableFile::open(folder, KIND, HEAD, simulation)?;
        Ok(Self { file, time: simulation.time() })
    }

    /// After a step towards the frame `frame`: a row for each radius of each tip that was looked at.
    pub(super) fn step(&mut self, simulation: &Simulation, frame: i64) {
        let measured = std::mem::replace(&mut self.time, simulation.time());
        let readings = simulation.contours();
        if readings.is_empty() {
            return;
        }
        let tips = simulation.tips();
        for r in readings {
            let Some(tip) = tips.iter().find(|tip| (tip.crack, tip.end) == (r.crack, r.end)) else { continue };
            let end = if r.end == End::Start { "start" } else { "end" };
            let lengths = [measured, tip.length, r.cells, r.radius];
            let integrals = [r.domain, r.contour, r.contour_with_inertia, r.modes.mode_1, r.modes.mode_2];
            self.file.add(&[&frame, &r.crack, &end], &[&lengths[..], &integrals].concat());
        }
    }
}
