//! How far the work is: a bar on a terminal, plain lines elsewhere, JSON lines for programs.

use crate::report::Report;
use crate::threads;
use fissure_scene::{TipRecord, TipState};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Time between two plain lines.
const LINE_INTERVAL: Duration = Duration::from_secs(2);
/// Time between two JSON lines.
const JSON_INTERVAL: Duration = Duration::from_millis(500);
/// Parts a frame is divided into on the bar, so that it moves within long frames.
const TICKS_PER_FRAME: u64 = 1000;

/// What is known at one moment.
#[derive(Debug, Clone, Serialize)]
struct Moment {
    /// Always `progress`.
    event: &'static str,
    /// Frame being computed.
    frame: i64,
    /// Frame at which the work ends.
    last_frame: i64,
    /// Simulated time [s].
    time: f64,
    /// Steps per second of wall time since the start.
    steps_per_second: f64,
    /// State of the busiest tip; empty without cracks.
    tips: String,
    /// Total crack length at rest [m].
    crack_length: f64,
    /// Wall time left [s]; none until there is something to judge by.
    seconds_left: Option<f64>,
}

/// Progress of a simulation.
#[derive(Debug)]
pub(crate) struct SimulationProgress<'a> {
    report: &'a Report,
    bar: Option<ProgressBar>,
    started: Instant,
    spoken: Option<Instant>,
    first: i64,
    last: i64,
    steps_at_start: Option<u64>,
    /// Said again at each frame and between frames.
    tips: String,
    moment: Option<Moment>,
}

impl<'a> SimulationProgress<'a> {
    /// Progress from the frame `first`, which is there, to the frame `last`.
    pub(crate) fn new(report: &'a Report, first: i64, last: i64) -> Self {
        let length = (last - first).max(0).unsigned_abs() * TICKS_PER_FRAME;
        let bar = report.draws_bars().then(|| bar(length, "{bar:30} {msg}"));
        report.set_bar(bar.clone());
        Self {
            report,
            bar,
            started: Instant::now(),
            spoken: None,
            first,
            last,
            steps_at_start: None,
            tips: String::new(),
            moment: None,
        }
    }

    /// Within a frame: `frame` is being computed.
    pub(crate) fn step(&mut self, frame: i64, now: &fissure_sim::Progress) {
        let part = now.frame_steps as f64 / now.frame_steps_total.max(1) as f64;
        let done = (frame - 1 - self.first) as f64 + part.clamp(0.0, 1.0);
        let steps_before = *self.steps_at_start.get_or_insert(now.steps);
        let seconds = self.started.elapsed().as_secs_f64();
        let whole = (self.last - self.first) as f64;
        self.moment = Some(Moment {
            event: "progress",
            frame,
            last_frame: self.last,
            time: now.time,
            steps_per_second: (now.steps - steps_before.min(now.steps)) as f64 / seconds.max(1e-9),
            tips: self.tips.clone(),
            crack_length: now.crack_length,
            seconds_left: (done > 0.0 && seconds > 0.2).then(|| seconds * (whole - done) / done),
        });
        if let Some(bar) = &self.bar {
            bar.set_position((done * TICKS_PER_FRAME as f64) as u64);
        }
        self.speak(false);
    }

    /// Says something that happened on the way.
    pub(crate) fn note(&self, message: &str) {
        self.report.note(message);
    }

    /// A frame is complete.
    pub(crate) fn frame(&mut self, frame: i64, tips: &[TipRecord]) {
        self.tips = busiest_tip(tips);
        if let Some(moment) = &mut self.moment {
            moment.tips.clone_from(&self.tips);
        }
        if frame == self.last {
            self.speak(true);
        }
    }

    /// Says the moment: at most now and then, unless it must be said.
    fn speak(&mut self, must: bool) {
        let Some(moment) = &self.moment else { return };
        if let Some(bar) = &self.bar {
            bar.set_message(moment.text());
            return;
        }
        if self.report.is_quiet() {
            return;
        }
        let interval = if self.report.is_json() { JSON_INTERVAL } else { LINE_INTERVAL };
        if !must && self.spoken.unwrap_or(self.started).elapsed() < interval {
            return;
        }
        self.spoken = Some(Instant::now());
        if self.report.is_json() {
            self.report.line(moment);
        } else {
            self.report.write(&moment.text());
        }
    }
}

impl Drop for SimulationProgress<'_> {
    fn drop(&mut self) {
        self.report.set_bar(None);
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Moment {
    /// The moment as one line.
    fn text(&self) -> String {
        let mut text = format!(
            "frame {}/{}  t {}  {:.0} steps/s",
            self.frame,
            self.last_frame,
            seconds(self.time),
            self.steps_per_second
        );
        if !self.tips.is_empty() {
            text += &format!("  {}  crack {:.4} m", self.tips, self.crack_length);
        }
        if let Some(left) = self.seconds_left {
            text += &format!("  {} left", duration(left));
        }
        text
    }
}

/// What is made of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Made {
    /// Meshes.
    Meshes,
    /// Pictures.
    Pictures,
}

impl Made {
    /// What one is called where programs listen.
    fn event(self) -> &'static str {
        match self {
            Self::Meshes => "mesh",
            Self::Pictures => "picture",
        }
    }

    /// What they are called where people do.
    fn plural(self) -> &'static str {
        match self {
            Self::Meshes => "meshes",
            Self::Pictures => "pictures",
        }
    }
}

/// Progress of making something of each frame of a take.
#[derive(Debug)]
pub(crate) struct TakeProgress<'a> {
    report: &'a Report,
    made: Made,
    bar: Option<ProgressBar>,
    spoken: Instant,
    done: usize,
    total: usize,
}

impl<'a> TakeProgress<'a> {
    /// Progress of `total` frames.
    pub(crate) fn new(report: &'a Report, made: Made, total: usize) -> Self {
        let bar = report.draws_bars().then(|| bar(total as u64, "{bar:30} {pos}/{len} frames  {eta} left"));
        report.set_bar(bar.clone());
        Self { report, made, bar, spoken: Instant::now(), done: 0, total }
    }

    /// One more frame is written.
    pub(crate) fn frame(&mut self, frame: i64) {
        self.done += 1;
        if let Some(bar) = &self.bar {
            bar.inc(1);
        } else if self.report.is_json() {
            self.report.line(&serde_json::json!({
                "event": self.made.event(), "frame": frame, "done": self.done, "total": self.total
            }));
        } else if !self.report.is_quiet() && (self.spoken.elapsed() >= LINE_INTERVAL || self.done == self.total) {
            self.spoken = Instant::now();
            self.report.write(&format!("{} {}/{}  frame {frame}", self.made.plural(), self.done, self.total));
        }
    }
}

impl Drop for TakeProgress<'_> {
    fn drop(&mut self) {
        self.report.set_bar(None);
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(length: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    if threads::are_to_be_had() {
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    bar
}

/// The state of the tip that matters most to who waits: a growing one, else the one nearest to growing.
fn busiest_tip(tips: &[TipRecord]) -> String {
    let live = tips.iter().filter(|tip| tip.state.is_live());
    let load = |tip: &TipRecord| tip.equivalent / tip.fracture_toughness;
    let busiest = live.max_by(|a, b| {
        let growing = |tip: &TipRecord| tip.state == TipState::Growing;
        growing(a).cmp(&growing(b)).then(load(a).total_cmp(&load(b)))
    });
    match busiest {
        Some(tip) if tip.state == TipState::Growing => format!("tip growing at {:.0} m/s", tip.speed),
        Some(tip) => {
            let state = if tip.state == TipState::Arrested { "arrested" } else { "resting" };
            format!("tip {state} at {:.0} % of its toughness", 100.0 * load(tip).max(0.0))
        }
        None if tips.is_empty() => String::new(),
        None => "no live tip".to_owned(),
    }
}

/// A time in the unit that reads best.
pub(crate) fn seconds(time: f64) -> String {
    match time.abs() {
        0.0 => "0 s".to_owned(),
        t if t < 1e-3 => format!("{:.3} µs", time * 1e6),
        t if t < 1.0 => format!("{:.3} ms", time * 1e3),
        _ => format!("{time:.3} s"),
    }
}

/// A wall time for people.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_well() {
        assert_eq!(seconds(1.25e-5), "12.500 µs");
        assert_eq!(seconds(0.0125), "12.500 ms");
        assert_eq!(duration(59.4), "59 s");
        assert_eq!(duration(61.0), "1 min 01 s");
        assert_eq!(duration(7265.0), "2 h 01 min");
    }
}
