//! Coarse versions of the reference cases. Truth: the closed forms and finite element solutions that each case names.
//! Bounds are what was measured at these resolutions with a margin; the targets, at the standard resolutions of
//! `fissure verify`, are in `docs/verification.md`.
#![allow(clippy::unwrap_used)]

use fissure_verify::{Options, Report, find};

fn coarse(name: &str, cells: f64) -> Report {
    anywhere(name, cells, 1)
}

/// At so many places on the grid; every fourth is one of those that people draw.
fn anywhere(name: &str, cells: f64, places: usize) -> Report {
    let options = Options { cells: Some(cells), places, ..Options::default() };
    find(name).unwrap().run(&options, &mut |_| ()).unwrap()
}

/// The error of every row whose quantity contains `part` is below `bound` (a fraction where the reference is not zero
/// by nature, else in the row's unit).
fn within(report: &Report, part: &str, bound: f64) {
    let mut any = false;
    for row in report.rows_of(part) {
        any = true;
        assert!(row.error().is_some_and(|e| e.abs() < bound), "{}: {row:?}, bound {bound}", report.name);
    }
    assert!(any, "{} has no row {part}", report.name);
}

fn met(report: &Report, part: &str) {
    let mut any = false;
    for row in report.rows_of(part) {
        any = true;
        assert_eq!(row.met(), Some(true), "{}: {row:?}", report.name);
    }
    assert!(any, "{} has no row {part}", report.name);
}

/// The work of the case is what was measured, to 3 %: a change that gets the same result in more steps, by more looks
/// at the tips or by taking up cracks more often, is found as well as one that looks too seldom.
fn worked(report: &Report, counts: [u64; 3]) {
    let found = [report.steps, report.looks, report.recuts];
    let is_near = |(found, expected): (&u64, &u64)| found.abs_diff(*expected) as f64 <= 0.03 * *expected as f64;
    assert!(found.iter().zip(&counts).all(is_near), "{}: {found:?}, not {counts:?}", report.name);
}

/// Measured 1.1 % (target 2 % at 16 cells).
#[test]
fn center_crack() {
    let report = anywhere("center-crack", 8.0, 5);
    worked(&report, [10752, 0, 0]);
    within(&report, "K_I/(σ√πa)", 0.013);
    met(&report, "difference between the tips");
    met(&report, "|K_II|/K_I");
}

/// Two of the four places are turned by any angle.
#[test]
fn double_notch() {
    let report = anywhere("double-notch", 4.0, 4);
    within(&report, "K_I/(σ√πa)", 0.03);
}

/// Energy is kept wherever the plate lies, and no run is stopped.
#[test]
fn ringing_plate() {
    let report = anywhere("ringing-plate", 8.0, 4);
    met(&report, "");
}

/// Measured 1.9 % in K_I, 0.9 % in √J (targets 2 % at 16 cells).
#[test]
fn pressed_crack() {
    met(&anywhere("pressed-crack", 6.0, 3), "");
}

/// Measured 0.4 % (target 1 % at 12 cells).
#[test]
fn thick_ring() {
    let report = anywhere("thick-ring", 6.0, 4);
    within(&report, "mean radial displacement", 0.006);
    within(&report, "strain energy", 0.006);
}

/// Measured 2.2 % and 1.1° at 45° where the crack lies on nodes or particles, 0.7 % and 0.4° else (targets 2 % and 1°
/// at 16 cells).
#[test]
fn slanted_crack() {
    let report = anywhere("slanted-crack", 8.0, 5);
    within(&report, "√(K_I²+K_II²)", 0.025);
    within(&report, "mode angle", 1.5);
}

/// Measured 0.030 in K_II, 0.031 in J (targets 0.03 at 12 cells). Faces that slide and just touch at 30° press K_I up
/// to 0.154 of K_II (target 0.01): a fault that is known.
#[test]
fn closed_crack() {
    let report = coarse("closed-crack", 6.0);
    worked(&report, [33890, 67780, 0]);
    met(&report, "overlap of the faces");
    within(&report, "K_II/K_II apart", 0.04);
    met(&report, "K_I/K_II apart, crack at 0°");
    met(&report, "K_I/K_II apart, crack at 30°, μ");
    within(&report, "K_I/K_II apart, crack at 30°, shear alone", 0.17);
    within(&report, "J/J apart", 0.04);
}

/// Measured 1.9 % and 2.3 % (target 3 % at 8 cells).
#[test]
fn double_cantilever() {
    let report = coarse("double-cantilever", 4.0);
    worked(&report, [21696, 0, 0]);
    within(&report, "J, ", 0.022);
    within(&report, "D/P", 0.027);
    met(&report, "|K_II|/K_I");
}

/// Measured 0.8 % of K_I and 0.003 in K_II for all but the inner tips of the narrower gap, which is two cells wide here
/// (targets 3 % at 8 cells).
#[test]
fn crack_pairs() {
    let report = anywhere("crack-pairs", 4.0, 1);
    within(&report, "K_I/(σ√πa), stacked", 0.012);
    within(&report, "K_I/(σ√πa), collinear, gap 1 a", 0.01);
    met(&report, "K_II/(σ√πa), stacked");
}

/// Measured 2.1 % (target 1 % at 40 cells).
#[test]
fn step_load() {
    let report = coarse("step-load", 20.0);
    worked(&report, [90, 90, 0]);
    within(&report, "rms error of K_I", 2.4);
}

/// Measured 3.4 % (target 10 % at 40 cells).
#[test]
fn moving_crack() {
    let report = coarse("moving-crack", 30.0);
    worked(&report, [150, 150, 28]);
    within(&report, "mean J E'/K_I² at 1500 m/s", 0.06);
    within(&report, "of J with A_I", 0.03);
}

/// Measured 6.0 % at 2.4 t_c (target 10 % at 40 cells).
#[test]
fn crack_motion() {
    let report = coarse("crack-motion", 20.0);
    worked(&report, [240, 152, 63]);
    met(&report, "start");
    within(&report, "Δa at 2.4 t_c", 0.1);
    met(&report, "highest speed");
}

/// Measured .85 % at the worst of 8 places: a crack at the highest speed there is.
#[test]
fn pull_price() {
    let report = anywhere("pull-price", 40.0, 2);
    within(&report, "energy taken by ∫G_c da", 0.01);
    met(&report, "crack through the plate");
}

/// Measured at the worst of 8 places: 2.1 % longer than straight and .3 % of the energy; 7.5 % longer at 20 MN/m. With
/// tips that are looked at in every second step the one at 20 MN/m goes 73 cells back up. What that one takes misses
/// its target: 31 % more than its length costs.
#[test]
fn turned_notch() {
    let report = anywhere("turned-notch", 80.0, 2);
    met(&report, "leaves through the lower edge");
    met(&report, "largest way back up");
    met(&report, "longer than straight");
    for plate in ["15°, 6 MN/m", "30°, 6 MN/m", "45°, 6 MN/m"] {
        within(&report, &format!("energy taken by ∫G_c da, {plate}"), 0.01);
    }
}

/// Measured 4.0 % and 0.03 µs (targets 3 % and 0.2 µs at 80 cells).
#[test]
fn strip() {
    let report = coarse("strip", 40.0);
    worked(&report, [240, 480, 0]);
    within(&report, "first peak of K_I", 0.05);
    within(&report, "middle of the first peak", 0.06);
}

/// Measured .3 % of both starts (target 1 %), 66.3° and 82.9 mm from the open notch, K_I 0.
#[test]
fn impacted_notch() {
    let report = coarse("impacted-notch", 25.0);
    worked(&report, [2464, 2152, 767]);
    met(&report, "mean angle");
    met(&report, "largest |K_I|/K_Ic");
    within(&report, "K_II/K_Ic at the start", 0.02);
    within(&report, "start, closed notch", 0.006);
    within(&report, "start, open notch", 0.006);
    met(&report, "angle from the notch to the far edge, open notch");
    met(&report, "where it leaves, open notch");
}

/// Measured 0.9 % (target 3 % at 80 cells), and 4.3 % of the run at 14 µs.
#[test]
fn branching_plate() {
    let report = coarse("branching-plate", 40.0);
    worked(&report, [270, 177, 25]);
    within(&report, "start of growth", 0.015);
    within(&report, "run at 14 µs", 0.08);
    met(&report, "mean speed");
}

/// Measured 0.8° (target 2° at 16 cells).
#[test]
fn kink_angles() {
    let report = coarse("kink-angles", 8.0);
    worked(&report, [3616, 16, 8]);
    within(&report, "angle asked for", 1.2);
    within(&report, "kink of the crack", 1.2);
}

/// Measured 0.7 % (target 2 % at 8 cells).
#[test]
fn cantilever() {
    within(&coarse("cantilever", 4.0), "ωL√(ρ/E)", 0.01);
}

/// Measured 0.5 % (target 1 %).
#[test]
fn bar_wave() {
    let report = coarse("bar-wave", 20.0);
    within(&report, "speed of", 0.008);
    within(&report, "stress behind", 0.003);
    within(&report, "particle speed", 0.003);
}

/// Measured 1.2 %, four times as much as at 20 cells (target 2 % there).
#[test]
fn spinning_disc() {
    let report = coarse("spinning-disc", 10.0);
    within(&report, "mean of σ_r + σ_t", 0.015);
    met(&report, "change of angular momentum");
}

#[test]
fn free_flight() {
    met(&coarse("free-flight", 5.0), "");
}

/// Half a turn and whole turns are where a rotation computed from its sine or cosine alone fails.
#[test]
fn ten_turns() {
    let report = coarse("ten-turns", 4.0);
    met(&report, "change of angular momentum, relative, without contact");
    met(&report, "momentum by mass times rim speed, without contact");
}

/// Measured 1.8 % of the length, 0.8 % of J/G_c and 0.4 % of the work (targets 3, 3 and 2 % at 8 cells): the crack
/// takes what it costs.
#[test]
fn cantilever_growth() {
    let report = coarse("cantilever-growth", 4.0);
    worked(&report, [29000, 20823, 34]);
    met(&report, "opening D at the start");
    met(&report, "length at the end");
    met(&report, "mean of J/G_c");
    within(&report, "U + T + G_c Δa", 0.01);
}
