//! Maps of where the method fails.

use super::Charting;
use super::table::{Table, number};
use crate::failure::Failure;
use fissure_chart::{Figure, Map, Panel, Plot, word};
use fissure_verify::{Parameter, STABILITY_MAPS, StabilityMap};

const NAME: &str = "stability";
const COLUMNS: &str = "map,across,up,value,message";

/// Measures what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    for map in &STABILITY_MAPS {
        for &up in map.up.values {
            // Every third column shows the shape.
            for &across in map.across.values.iter().step_by(if charting.quick { 3 } else { 1 }) {
                let key = [map.name.to_owned(), across.to_string(), up.to_string()];
                if table.rows().iter().any(|row| row[..3] == key) {
                    continue;
                }
                let found = charting.showing(map.name, |say| {
                    say(&format!("{} {across}, {} {up}", map.across.label, map.up.label));
                    map.value(across, up)
                });
                let (value, message) = match found {
                    Ok(value) => (format!("{value:.3e}"), String::new()),
                    Err(error) => (String::new(), error.to_string()),
                };
                table.add(key.into_iter().chain([value, message]).collect())?;
            }
        }
    }
    charting.draw(NAME, &figure(charting, &table))
}

fn figure(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panels = STABILITY_MAPS.iter().map(|map| Panel { title: map.title.into(), plot: Plot::Map(drawn(map, table)) });
    Figure {
        title: "Where it fails".into(),
        caption: vec![
            "Each cell is a run. Blue is well, red is bad; grey: the solver stopped with a message, which the table holds."
                .into(),
            charting.origin.to_string(),
        ],
        columns: 1,
        panels: panels.collect(),
    }
}

/// The cells of a map that the table has.
fn drawn(map: &StabilityMap, table: &Table<'_>) -> Map {
    let words = |parameter: &Parameter| -> Vec<String> {
        if parameter.words.is_empty() {
            parameter.values.iter().map(|&value| word(value)).collect()
        } else {
            parameter.words.iter().map(|&word| word.to_owned()).collect()
        }
    };
    let row = |across: f64, up: f64| {
        let key = [map.name.to_owned(), across.to_string(), up.to_string()];
        table.rows().iter().find(|row| row[..3] == key)
    };
    let cell = |across: f64, up: f64| row(across, up).map(|row| number(&row[3])).filter(|value| value.is_finite());
    let label = |across: f64, up: f64| match (row(across, up), cell(across, up)) {
        (_, Some(value)) => percent(value),
        (Some(_), None) => "stops".into(),
        (None, None) => String::new(),
    };
    let rows = |of: &dyn Fn(f64, f64) -> String| -> Vec<Vec<String>> {
        map.up.values.iter().map(|&up| map.across.values.iter().map(|&across| of(across, up)).collect()).collect()
    };
    Map {
        across: (map.across.label.into(), words(&map.across)),
        up: (map.up.label.into(), words(&map.up)),
        cells: map.up.values.iter().map(|&up| map.across.values.iter().map(|&a| cell(a, up)).collect()).collect(),
        words: rows(&label),
        limits: map.limits.to_vec(),
    }
}

/// "0.3 %", "12 %".
fn percent(value: f64) -> String {
    let value = 100.0 * value;
    if value.abs() < 9.95 { format!("{value:.1} %") } else { format!("{value:.0} %") }
}
