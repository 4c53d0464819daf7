//! The figures of the thesis that this method comes from (Fumoto 2022, figures 18 to 24), made again from the examples:
//! one picture for each, and what comes out of every run in one table.

use super::Charting;
use super::examples::{Example, examples};
use super::shape::{shape, shape_at_start, strokes};
use super::table::{Table, number};
use crate::exit::Exit;
use crate::failure::Failure;
use fissure_chart::{Figure, Panel, Plot};
use fissure_plane::Point;
use fissure_scene::{Frame, Scene, TipState};
use fissure_sim::Simulation;
use fissure_verify::cpu_time;
use std::ops::ControlFlow;
use std::path::Path;

const NAME: &str = "thesis";
const COLUMNS: &str =
    "figure,panel,example,changed,spacing,particles,steps,cpu_seconds,begins,ends,length,aside,outcome,shape";

/// A picture.
struct Remade {
    /// Its number in the thesis.
    number: &'static str,
    title: &'static str,
    columns: usize,
    runs: &'static [Run],
}

/// A panel of one.
struct Run {
    /// What is written above it.
    word: &'static str,
    example: &'static str,
    /// Keys of the scene that are set otherwise.
    changed: &'static [&'static str],
    /// Shown before it moves.
    at_start: bool,
}

const fn run(word: &'static str, example: &'static str, changed: &'static [&'static str]) -> Run {
    Run { word, example, changed, at_start: false }
}

const fn start(word: &'static str, example: &'static str) -> Run {
    Run { word, example, changed: &[], at_start: true }
}

const FIGURES: [Remade; 7] = [
    Remade {
        number: "18",
        title: "initial cracks, and a guide",
        columns: 3,
        runs: &[
            start("straight", "pull"),
            start("turned by 30°", "pull-rotated"),
            start("guided", "pull-guided"),
            run("straight", "pull", &[]),
            run("turned by 30°", "pull-rotated", &[]),
            run("guided", "pull-guided", &[]),
        ],
    },
    Remade {
        number: "19",
        title: "steps",
        columns: 3,
        runs: &[
            run("40 µs", "pull-rotated", &["solver.time_step=4e-5", "grid.particle_spacing=1"]),
            run("100 µs", "pull-rotated", &["solver.time_step=1e-4", "grid.particle_spacing=1"]),
            run("400 µs", "pull-rotated", &["solver.time_step=4e-4", "grid.particle_spacing=1"]),
            run("40 µs", "pull-rotated", &["solver.time_step=4e-5", "grid.particle_spacing=0.25"]),
            run("100 µs", "pull-rotated", &["solver.time_step=1e-4", "grid.particle_spacing=0.25"]),
            run("400 µs", "pull-rotated", &["solver.time_step=4e-4", "grid.particle_spacing=0.25"]),
        ],
    },
    Remade {
        number: "20",
        title: "bending",
        columns: 5,
        runs: &[
            run("2", "pull-rotated", &["growth.bending=2"]),
            run("3", "pull-rotated", &["growth.bending=3"]),
            run("4", "pull-rotated", &["growth.bending=4"]),
            run("5", "pull-rotated", &["growth.bending=5"]),
            run("6", "pull-rotated", &["growth.bending=6"]),
        ],
    },
    Remade {
        number: "21",
        title: "distances of particles",
        columns: 3,
        runs: &[
            run("0.5 m", "pull-rotated", &["grid.particle_spacing=0.5"]),
            run("1 m", "pull-rotated", &["grid.particle_spacing=1"]),
            run("2 m", "pull-rotated", &["grid.particle_spacing=2"]),
        ],
    },
    Remade {
        number: "22",
        title: "materials, pulled",
        columns: 2,
        runs: &[
            run("glass", "pull-rotated", &["body.plate.material=glass"]),
            run("pmma", "pull-rotated", &["body.plate.material=pmma"]),
        ],
    },
    Remade {
        number: "23",
        title: "materials, dropped",
        columns: 4,
        runs: &[
            run("jello", "drop-jello", &[]),
            run("snow", "drop-snow", &[]),
            run("pmma", "drop-pmma", &[]),
            run("glass", "drop-glass", &[]),
        ],
    },
    Remade {
        number: "24",
        title: "distances of particles, dropped",
        columns: 3,
        runs: &[
            run("2 m", "drop-pmma", &["grid.particle_spacing=2"]),
            run("1 m", "drop-pmma", &["grid.particle_spacing=1"]),
            run("0.5 m", "drop-pmma", &["grid.particle_spacing=0.5"]),
        ],
    },
];

/// Runs what is missing and draws. All are so small that `--quick` leaves nothing out.
pub(super) fn chart(charting: &Charting<'_>, folder: &Path) -> Result<(), Failure> {
    let examples = examples(folder)?;
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    for figure in &FIGURES {
        for run in figure.runs {
            if row_of(&table, figure, run).is_none() {
                let row = measure(charting, figure, run, find(&examples, run.example, folder)?)?;
                table.add(row)?;
            }
        }
        charting.draw(&format!("{NAME}-{}", figure.number), &picture(charting, &table, figure))?;
    }
    Ok(())
}

fn find<'a>(examples: &'a [Example], name: &str, folder: &Path) -> Result<&'a Example, Failure> {
    examples.iter().find(|example| example.name == name).ok_or_else(|| {
        Failure::new(
            Exit::File,
            format!("no example `{name}` in `{}`", folder.display()),
            "say where it is with --examples",
        )
    })
}

/// What a row is known by: figure, panel, example and what is changed in it.
fn key(figure: &Remade, run: &Run) -> [String; 4] {
    let changed = if run.at_start { "not moved".into() } else { run.changed.join(" ") };
    [figure.number.into(), run.word.into(), run.example.into(), changed]
}

fn row_of<'a>(table: &'a Table<'_>, figure: &Remade, run: &Run) -> Option<&'a Vec<String>> {
    let key = key(figure, run);
    table.rows().iter().find(|row| row[..4] == key)
}

/// Runs one to the end of its frames. One that is refused or stops is a row, too, with what is said.
fn measure(charting: &Charting<'_>, figure: &Remade, run: &Run, example: &Example) -> Result<Vec<String>, Failure> {
    let overrides: Vec<String> = run.changed.iter().map(|&key| key.to_owned()).collect();
    let scene = fissure_scene::load(&example.file, &overrides)?;
    let mut row = key(figure, run).to_vec();
    row.push(format!("{}", scene.particle_spacing));
    if run.at_start {
        row.extend((0..7).map(|_| String::new()).chain(["at the start".into(), shape_at_start(&scene)]));
        return Ok(row);
    }
    let task = format!("figure {}, {}", figure.number, run.word);
    let before = cpu_time();
    let mut simulation = match Simulation::new(&scene) {
        Ok(simulation) => simulation,
        Err(error) => {
            row.extend((0..7).map(|_| String::new()).chain([format!("refused: {error}"), shape_at_start(&scene)]));
            return Ok(row);
        }
    };
    let done = charting.showing(&task, |say| {
        while !simulation.is_finished() {
            say(&format!("frame {}", simulation.frame_number()));
            simulation.advance(&mut |_| ControlFlow::Continue(()))?;
        }
        Ok::<(), Failure>(())
    });
    let seconds = (cpu_time() - before).as_secs_f64();
    let frame = simulation.frame();
    let outcome = match done {
        Ok(()) => outcome(&frame).to_owned(),
        Err(failure) => format!("stops: {failure}"),
    };
    row.extend([simulation.particles().to_string(), simulation.steps().to_string(), format!("{seconds:.3}")]);
    row.extend(way(&scene, &frame));
    row.extend([outcome, shape(&scene, &frame)]);
    Ok(row)
}

/// What became of the crack that is drawn.
fn outcome(frame: &Frame) -> &'static str {
    match frame.tips.first().map(|tip| tip.state) {
        Some(TipState::LeftBody) => "through",
        Some(TipState::Resting) => "has not moved",
        Some(TipState::GuideEnded) => "at the end of its guide",
        Some(_) => "stays inside",
        None => "no tip",
    }
}

/// The way of the crack that is drawn: when it begins and ends to grow [s], its whole length and how far it comes to
/// lie beside the line that the drawn part points along [m], all where the body was at rest.
fn way(scene: &Scene, frame: &Frame) -> [String; 4] {
    let (Some(crack), Some(drawn)) = (frame.cracks.first(), scene.cracks.first()) else {
        return [const { String::new() }; 4];
    };
    let length: f64 = crack.rest.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let (mouth, tip) = (drawn.points[0], drawn.points[drawn.points.len() - 1]);
    let along = (tip - mouth).normalize();
    let aside = |p: &Point| (along.x * (p.y - mouth.y) - along.y * (p.x - mouth.x)).abs();
    let aside = crack.rest.iter().map(aside).fold(0.0, f64::max);
    let times = crack.formed.iter().flatten().map(|formed| formed.time).filter(|&time| time > 0.0);
    let (first, last) = times.fold((f64::INFINITY, f64::NAN), |(first, last), t| (first.min(t), t.max(last)));
    let time = |t: f64| if t.is_finite() { format!("{t:.4e}") } else { String::new() };
    [time(first), time(last), format!("{length:.4}"), format!("{aside:.3}")]
}

fn picture(charting: &Charting<'_>, table: &Table<'_>, figure: &Remade) -> Figure {
    let panel = |run: &Run| {
        let row = row_of(table, figure, run)?;
        let said = if run.at_start {
            "at the start".into()
        } else if row[10].is_empty() {
            "refused".into()
        } else if row[8].is_empty() {
            row[12].clone()
        } else {
            format!("{}, {:.1} m", row[12], number(&row[10]))
        };
        Some(Panel { title: format!("{}: {said}", run.word), plot: Plot::Drawing(strokes(&row[13])) })
    };
    Figure {
        title: format!("Figure {} again: {}", figure.number, figure.title),
        caption: vec![
            "Outlines blue, cracks red, floors grey; lengths are those of the crack, notch included, as it lies in the body at rest."
                .into(),
            charting.origin.to_string(),
        ],
        columns: figure.columns,
        panels: figure.runs.iter().filter_map(panel).collect(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fissure_scene::CrackFrame;

    /// Truth: the examples themselves. Every run is one of an example that loads with what is changed in it, and is
    /// known from every other.
    #[test]
    fn every_run_is_of_an_example() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let mut keys = Vec::new();
        for figure in &FIGURES {
            for run in figure.runs {
                let example = find(&examples(&folder).unwrap(), run.example, &folder).unwrap().file.clone();
                let overrides: Vec<String> = run.changed.iter().map(|&key| key.to_owned()).collect();
                let scene = fissure_scene::load(&example, &overrides).unwrap();
                assert!(strokes(&shape_at_start(&scene)).iter().any(|stroke| stroke.colour == 1), "{}", run.example);
                assert!(!keys.contains(&key(figure, run)), "{:?}", key(figure, run));
                keys.push(key(figure, run));
            }
        }
    }

    /// Truth: by hand. A crack of 3 m that then goes up 2 m and down 4 m is 9 m long and lies 2 m aside at most.
    #[test]
    fn the_way_is_that_of_the_crack_at_rest() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/pull/scene.toml");
        let mut scene = fissure_scene::load(&folder, &[]).unwrap();
        scene.cracks[0].points = vec![Point::new(0.0, 0.0), Point::new(3.0, 0.0)];
        let crack = CrackFrame {
            rest: vec![Point::new(0.0, 0.0), Point::new(3.0, 0.0), Point::new(3.0, 2.0), Point::new(3.0, -2.0)],
            ..CrackFrame::default()
        };
        let frame = Frame { cracks: vec![crack], ..Frame::default() };
        assert_eq!(way(&scene, &frame)[2..], ["9.0000", "2.000"]);
    }
}
