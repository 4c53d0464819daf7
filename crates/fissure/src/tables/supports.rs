//! `NAME.supports.csv`: load over displacement of each support.

use super::table_file::TableFile;
use crate::failure::Failure;
use fissure_files::Folder;
use fissure_sim::Simulation;

pub(super) const KIND: &str = "supports";
pub(super) const HEAD: &str = "frame,support,time,displacement_x,displacement_y,force_x,force_y,work";

/// The table.
#[derive(Debug)]
pub(super) struct Supports {
    pub(super) file: TableFile,
    /// Time of the last rows [s], and the force times time of each support until then [N s/m].
    before: (f64, Vec<[f64; 2]>),
}

impl Supports {
    /// See [`super::Tables::open`].
    pub(super) fn open(folder: &Folder, simulation: &Simulation) -> Result<Self, Failure> {
        let (file, _) = TableFile::open(folder, KIND, HEAD, simulation)?;
        Ok(Self { file, before: (simulation.time(), simulation.support_impulses()) })
    }

    /// A row for each support: how far it has moved the material, and the mean force since the last row.
    pub(super) fn row(&mut self, simulation: &Simulation, frame: i64) {
        let now = (simulation.time(), simulation.support_impulses());
        let (since, before) = std::mem::replace(&mut self.before, now.clone());
        let records = simulation.support_records();
        for (k, support) in simulation.scene().supports.iter().enumerate() {
            let way = support.displacement(now.0);
            let force = [0, 1].map(|axis| (now.1[k][axis] - before[k][axis]) / (now.0 - since));
            let numbers = [now.0, way[0], way[1], force[0], force[1], records[k].work];
            self.file.add(&[&frame, &k], &numbers);
        }
    }
}
