//! What nothing measured is both faster and more accurate than.

/// Errors above this are not drawn: they are no solutions [–].
const MOST_ERROR: f64 = 3.0;

/// One measured point of a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) cells: f64,
    pub(super) seconds: f64,
    pub(super) worst: f64,
}

impl Point {
    /// Whether it has a place in a figure, and is a solution at all.
    pub(super) fn is_shown(&self) -> bool {
        self.worst > 0.0 && self.worst <= MOST_ERROR && self.seconds > 0.0
    }
}

/// The points of a curve, from coarse to fine, with the largest error that it has in so many cells and in more.
///
/// An error that grows with the number of cells is small by chance where it is small: it passes through zero, or two
/// errors cancel. Nobody can count on it, and it must not be what others are held against.
fn held(points: &[Point]) -> Vec<Point> {
    let mut held = points.to_vec();
    for k in (1..held.len()).rev() {
        held[k - 1].worst = held[k - 1].worst.max(held[k].worst);
    }
    held
}

/// The same without those that are no solutions, and without those that finer cells are as fast as: from fast and
/// coarse to slow and accurate.
fn reached(points: &[Point]) -> Vec<Point> {
    let mut reached: Vec<Point> = Vec::new();
    for point in held(points).into_iter().filter(Point::is_shown) {
        while reached.last().is_some_and(|last| last.seconds >= point.seconds) {
            reached.pop();
        }
        reached.push(point);
    }
    reached
}

/// The error that a curve has in so many seconds [–]: between its points that of the straight line which is drawn
/// there, as cells may be of any size; infinite before its first point.
fn error_in(reached: &[Point], seconds: f64) -> f64 {
    let after = reached.partition_point(|p| p.seconds <= seconds);
    match (after.checked_sub(1).map(|k| reached[k]), reached.get(after)) {
        (None, _) => f64::INFINITY,
        (Some(last), None) => last.worst,
        (Some(a), Some(b)) => {
            let part = (seconds / a.seconds).ln() / (b.seconds / a.seconds).ln();
            a.worst * (b.worst / a.worst).powf(part)
        }
    }
}

/// The time in which a curve comes to an error [s]; none where it does not.
fn seconds_to(reached: &[Point], worst: f64) -> Option<f64> {
    let k = reached.iter().position(|p| p.worst <= worst)?;
    let b = reached[k];
    let Some(a) = k.checked_sub(1).map(|before| reached[before]) else { return Some(b.seconds) };
    let part = (worst / a.worst).ln() / (b.worst / a.worst).ln();
    Some(a.seconds * (b.seconds / a.seconds).powf(part))
}

/// The points of curves that no other curve is both faster and more accurate than, from fast to accurate.
pub(super) fn front(curves: &[Vec<Point>]) -> Vec<(f64, f64)> {
    let curves: Vec<Vec<Point>> = curves.iter().map(|curve| reached(curve)).collect();
    // A point is on its own curve, but for round-off.
    const ROUND_OFF: f64 = 1e-9;
    let is_beaten = |p: &Point| curves.iter().any(|curve| error_in(curve, p.seconds) < p.worst * (1.0 - ROUND_OFF));
    let mut all: Vec<Point> = curves.iter().flatten().copied().filter(|p| !is_beaten(p)).collect();
    all.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then(a.worst.total_cmp(&b.worst)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in all {
        if front.last().is_none_or(|last| point.worst < last.1) {
            front.push((point.seconds, point.worst));
        }
    }
    front
}

/// How many times as long as `default` the fastest other curve takes to an error of it, at the error where that is
/// least; none where no other comes to any.
pub(super) fn lead(default: &[Point], others: &[Vec<Point>]) -> Option<f64> {
    let others: Vec<Vec<Point>> = others.iter().map(|curve| reached(curve)).collect();
    let ours = reached(default);
    let leads = ours.iter().flat_map(|p| others.iter().filter_map(|o| Some(seconds_to(o, p.worst)? / p.seconds)));
    leads.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand. An error that passes through zero counts with what it comes to beyond.
    #[test]
    fn a_curve_counts_with_what_it_holds() {
        let errors = [0.3, 0.01, 0.05, 0.02, 0.02];
        let curve = errors.map(|worst| Point { cells: 8.0, seconds: 1.0, worst });
        assert_eq!(held(&curve).iter().map(|p| p.worst).collect::<Vec<_>>(), [0.3, 0.05, 0.05, 0.02, 0.02]);
        assert!(held(&[]).is_empty());
    }

    fn curve(points: &[(f64, f64)]) -> Vec<Point> {
        points.iter().map(|&(seconds, worst)| Point { cells: 8.0, seconds, worst }).collect()
    }

    /// Truth: by hand. The curve goes through (2, .05) and (4, .025), so that (3, .04) is above it and (3, .03) below;
    /// a point that takes longer than the next finer one of its curve does not count, nor one without a solution.
    #[test]
    fn nothing_on_the_front_is_beaten() {
        let line = curve(&[(1.0, 0.1), (5.0, 0.04), (4.0, 0.025)]);
        let ends = [(1.0, 0.1), (4.0, 0.025)];
        assert_eq!(front(&[line.clone(), curve(&[(3.0, 0.04)]), curve(&[(0.5, 20.0)])]), ends);
        assert_eq!(front(&[line, curve(&[(3.0, 0.03)])]), [ends[0], (3.0, 0.03), ends[1]]);
    }

    /// Truth: by hand, on lines of slope -1 in logarithms: at .05 the other needs 6 s where the default needs 2.
    #[test]
    fn the_lead_is_that_of_time_to_the_same_error() {
        let default = curve(&[(1.0, 0.1), (2.0, 0.05)]);
        let slower = curve(&[(2.0, 0.15), (10.0, 0.03)]);
        let found = lead(&default, std::slice::from_ref(&slower));
        assert!(found.is_some_and(|found| (found - 3.0).abs() < 1e-9), "{found:?}");
        // Who never comes to it is no rival.
        assert_eq!(lead(&default, &[curve(&[(1.0, 0.2)])]), None);
    }
}
