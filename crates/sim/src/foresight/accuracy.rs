//! How right K will be, from the length of the shortest crack.

use fissure_plane::polyline_length;
use fissure_scene::{Formulation, Scene};

/// What resolution makes of K_I.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Error of K_I of the shortest crack, at rest and away from edges, at the worst place on the grid [–].
    pub error: f64,
    /// Index of that crack in the scene.
    pub crack: usize,
    /// Its length in cells, half of that where both of its ends are tips.
    pub cells: f64,
}

/// (Cells, error of K_I): the worst of edge cracks at ten angles and at five heights within a cell, and of cracks in
/// the middle of plates, with a margin.
const TOTAL: [(f64, f64); 7] =
    [(1.0, 0.15), (2.0, 0.12), (3.0, 0.035), (4.0, 0.025), (6.0, 0.015), (8.0, 0.013), (16.0, 0.008)];
/// The same of the updated formulation, at fewer places.
const UPDATED: [(f64, f64); 4] = [(1.0, 0.3), (3.0, 0.08), (4.0, 0.08), (6.0, 0.03)];

/// The accuracy of the shortest crack that has a tip; none: no crack has one.
pub(crate) fn accuracy(scene: &Scene, formulation: Formulation) -> Option<Accuracy> {
    let live = scene.cracks.iter().enumerate().filter(|(_, crack)| crack.start_live || crack.end_live);
    let cells = live.map(|(k, crack)| {
        // An edge crack of length a and a crack of 2a in the middle of a body have about the same field at their tips.
        let tips = f64::from(u8::from(crack.start_live) + u8::from(crack.end_live));
        (k, polyline_length(&crack.points) / tips / scene.cell_size)
    });
    let (crack, cells) = cells.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let table: &[(f64, f64)] = if formulation == Formulation::Updated { &UPDATED } else { &TOTAL };
    Some(Accuracy { error: error(table, cells), crack, cells })
}

/// Between two entries errors go with a power of the number of cells; beyond the table they are those of its ends.
fn error(table: &[(f64, f64)], cells: f64) -> f64 {
    let next = table.partition_point(|entry| entry.0 <= cells);
    match (next.checked_sub(1).map(|last| table[last]), table.get(next)) {
        (Some((c0, e0)), Some(&(c1, e1))) => e0 * (e1 / e0).powf((cells / c0).ln() / (c1 / c0).ln()),
        (Some((_, last)), None) => last,
        (None, Some(&(_, first))) => first,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the entries themselves, the geometric mean in the geometric middle, the ends.
    #[test]
    fn errors_are_those_of_the_table() {
        for (cells, expected) in [(0.3, 0.15), (4.0, 0.025), (16.0, 0.008), (99.0, 0.008)] {
            let found = error(&TOTAL, cells);
            assert!((found - expected).abs() < 1e-12, "{cells}: {found}");
        }
        let between = error(&TOTAL, (8.0_f64 * 16.0).sqrt());
        assert!((between - (0.013_f64 * 0.008).sqrt()).abs() < 1e-12, "{between}");
    }
}
