//! Curves from the tables that a run writes beside its take: as fine as the run was, not as its frames.

use super::series::{ContourSeries, EnergySeries, Series, SupportSeries, TipSeries, moved_axes, short};
use fissure_scene::{End, Scene};
use std::collections::BTreeMap;

/// Points of a curve on a page, at most; of longer ones every second, third or further is there.
const POINTS: usize = 1500;

/// A table beside a take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// J and K at every look.
    Looks,
    /// J and K over several radii.
    Contours,
    /// The energy budget.
    Energy,
    /// Load over displacement.
    Supports,
}

/// A table that is not as it was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("its line {line} does not have the columns that it should")]
pub struct TableError {
    /// The first such line, from 1.
    line: usize,
}

impl Table {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Looks, Self::Contours, Self::Energy, Self::Supports];

    /// What stands between the name of the scene and `.csv` in the name of its file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Looks => "looks",
            Self::Contours => "contours",
            Self::Energy => "energy",
            Self::Supports => "supports",
        }
    }
}

impl Series {
    /// Takes the curves of a table instead of those of the frames. `text`: comma-separated values with a head. A table
    /// without rows leaves the curves as they are; columns that are not known are passed over.
    ///
    /// # Errors
    /// When a column is missing, or a row is not as it should be; nothing is taken up then.
    pub fn take_up(&mut self, scene: &Scene, table: Table, text: &str) -> Result<(), TableError> {
        match table {
            Table::Looks => self.take_up_looks(scene, text),
            Table::Contours => self.take_up_contours(scene, text),
            Table::Energy => self.take_up_energy(text),
            Table::Supports => self.take_up_supports(scene, text),
        }
    }

    fn take_up_looks(&mut self, scene: &Scene, text: &str) -> Result<(), TableError> {
        let columns = ["time", "length", "mode_1_moving", "mode_2_moving", "fracture_toughness", "j_integral"];
        let mut tips: BTreeMap<(u32, End), TipSeries> = BTreeMap::new();
        for (tip, rows) in of_tips(&rows(text, ["crack", "end"], columns)?)? {
            let series = tips.entry(tip).or_insert_with(|| TipSeries::of(scene, tip.0, tip.1));
            for [time, length, mode_1, mode_2, fracture_toughness, j_integral] in thinned(rows) {
                series.time.push(time);
                series.length.push(length);
                series.mode_1.push(mode_1);
                series.mode_2.push(mode_2);
                series.fracture_toughness.push(fracture_toughness);
                series.j_integral.push(j_integral);
            }
        }
        for (tip, series) in &mut tips {
            series.contours = self.tips.remove(tip).map(|of_frames| of_frames.contours).unwrap_or_default();
        }
        self.tips.append(&mut tips);
        Ok(())
    }

    fn take_up_contours(&mut self, scene: &Scene, text: &str) -> Result<(), TableError> {
        let rows = rows(text, ["crack", "end"], ["cells", "time", "j_domain", "j_contour"])?;
        for (tip, rows) in of_tips(&rows)? {
            let mut by_radius: BTreeMap<u64, Vec<[f64; 4]>> = BTreeMap::new();
            for row in rows {
                // Positive numbers are ordered as their bits.
                by_radius.entry(row[0].abs().to_bits()).or_default().push(row);
            }
            let series = self.tips.entry(tip).or_insert_with(|| TipSeries::of(scene, tip.0, tip.1));
            series.contours.clear();
            for rows in by_radius.into_values() {
                let mut of_radius = ContourSeries { cells: rows[0][0], ..ContourSeries::default() };
                for [_, time, domain, contour] in thinned(rows) {
                    of_radius.time.push(time);
                    of_radius.domain.push(domain);
                    of_radius.contour.push(contour);
                }
                series.contours.push(of_radius);
            }
        }
        Ok(())
    }

    fn take_up_energy(&mut self, text: &str) -> Result<(), TableError> {
        let columns = ["time", "kinetic", "strain", "external_work", "crack", "damping", "rest"];
        let rows: Vec<[f64; 7]> = rows(text, [], columns)?.into_iter().map(|(_, numbers)| numbers).collect();
        if rows.is_empty() {
            return Ok(());
        }
        let mut energies = EnergySeries::default();
        for [time, kinetic, strain, external_work, crack, damping, rest] in thinned(rows) {
            energies.time.push(time);
            energies.kinetic.push(kinetic);
            energies.strain.push(strain);
            energies.external_work.push(external_work);
            energies.crack.push(crack);
            energies.damping.push(damping);
            energies.rest.push(rest);
        }
        self.energies = energies;
        Ok(())
    }

    fn take_up_supports(&mut self, scene: &Scene, text: &str) -> Result<(), TableError> {
        let columns = ["support", "time", "displacement_x", "displacement_y", "force_x", "force_y"];
        let rows = rows(text, [], columns)?;
        for (index, support) in scene.supports.iter().enumerate() {
            let of_support: Vec<[f64; 6]> =
                rows.iter().map(|(_, row)| *row).filter(|row| row[0] == index as f64).collect();
            if of_support.is_empty() {
                continue;
            }
            let of_support = thinned(of_support);
            for axis in moved_axes(support) {
                let series = self.support(index, axis);
                *series = SupportSeries { name: std::mem::take(&mut series.name), ..SupportSeries::default() };
                for row in &of_support {
                    series.time.push(row[1]);
                    series.displacement.push(row[2 + axis]);
                    series.force.push(row[4 + axis]);
                }
            }
        }
        Ok(())
    }
}

/// Rows of a table: some words and some numbers of each.
type Rows<'a, const W: usize, const N: usize> = Vec<([&'a str; W], [f64; N])>;

/// The columns `words` and `numbers` of all rows.
fn rows<'a, const W: usize, const N: usize>(
    text: &'a str,
    words: [&str; W],
    numbers: [&str; N],
) -> Result<Rows<'a, W, N>, TableError> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let places = |wanted: &[&str]| -> Option<Vec<usize>> {
        wanted.iter().map(|name| head.iter().position(|column| column == name)).collect()
    };
    let (Some(word_places), Some(number_places)) = (places(&words), places(&numbers)) else {
        return Err(TableError { line: 1 });
    };
    let row = |line: &'a str| {
        let cells: Vec<&str> = line.split(',').collect();
        let of_words: Option<Vec<&str>> = word_places.iter().map(|&place| cells.get(place).copied()).collect();
        let number = |&place: &usize| cells.get(place).and_then(|cell| cell.parse().ok());
        let of_numbers: Option<Vec<f64>> = number_places.iter().map(number).collect();
        Some((of_words?.try_into().ok()?, of_numbers?.try_into().ok()?))
    };
    lines.enumerate().map(|(k, line)| row(line).ok_or(TableError { line: k + 2 })).collect()
}

/// The numbers of each tip, by its crack and end.
type OfTips<const N: usize> = BTreeMap<(u32, End), Vec<[f64; N]>>;

/// The numbers of each tip in rows of which the words are its crack and end.
fn of_tips<const N: usize>(rows: &Rows<'_, 2, N>) -> Result<OfTips<N>, TableError> {
    let mut tips: OfTips<N> = BTreeMap::new();
    for (k, ([crack, end], numbers)) in rows.iter().enumerate() {
        let end = match *end {
            "start" => Some(End::Start),
            "end" => Some(End::End),
            _ => None,
        };
        let tip = crack.parse().ok().zip(end).ok_or(TableError { line: k + 2 })?;
        tips.entry(tip).or_default().push(*numbers);
    }
    Ok(tips)
}

/// Every n-th row and the last, with the digits that a plot shows.
fn thinned<const N: usize>(rows: Vec<[f64; N]>) -> Vec<[f64; N]> {
    let stride = rows.len().div_ceil(POINTS).max(1);
    let last = rows.len().saturating_sub(1);
    let shown = rows.into_iter().enumerate().filter(|(k, _)| k % stride == 0 || *k == last);
    shown.map(|(_, row)| row.map(short)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: the lines of the table, by hand. Columns may come in any order; what is damaged changes nothing.
    #[test]
    fn a_table_is_taken_up_by_the_names_of_its_columns() {
        let mut series = Series::default();
        let head = "frame,rest,time,external_work,kinetic,strain,crack,damping";
        series.take_up_energy(&format!("{head}\n1,7,0,1,2,3,4,5\n2,8,0.5,1,2,3,4,6\n")).unwrap();
        assert_eq!(
            (&series.energies.time[..], &series.energies.rest[..], &series.energies.damping[..]),
            (&[0.0, 0.5][..], &[7.0, 8.0][..], &[5.0, 6.0][..])
        );
        let before = series.clone();
        for (text, line) in [(String::new(), 1), ("frame,time\n1,0\n".into(), 1), (format!("{head}\n1,7,0,1,2\n"), 2)] {
            assert_eq!(series.take_up_energy(&text), Err(TableError { line }));
        }
        series.take_up_energy(&format!("{head}\n")).unwrap();
        assert_eq!(series, before);
        let many: Vec<[f64; 1]> = (0..=4000).map(|k| [f64::from(k)]).collect();
        let shown = thinned(many);
        assert!(shown.len() <= POINTS + 1 && shown[0] == [0.0] && shown[shown.len() - 1] == [4000.0]);
    }
}
