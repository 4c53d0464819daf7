#![allow(clippy::unwrap_used)]
use super::*;
use fissure_plane::Region;
use proptest::prelude::*;

const TIP: CrackEnd = CrackEnd::Tip;
const MOUTH: CrackEnd = CrackEnd::Mouth;

fn points(of: &[[f64; 2]]) -> Vec<Point> {
    of.iter().map(|&[x, y]| Point::new(x, y)).collect()
}

/// The square 0 ≤ x, y ≤ 4 with a square hole in its middle.
fn plate() -> Region {
    Region {
        exterior: points(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]),
        holes: vec![points(&[[1.5, 1.5], [1.5, 2.5], [2.5, 2.5], [2.5, 1.5]])],
    }
}

fn cut(region: &Region, cracks: &[(Vec<Point>, [CrackEnd; 2])]) -> Fragments {
    let rings: Vec<_> = region.rings().map(|points| RestRing { body: 0, points }).collect();
    let cracks: Vec<_> = cracks
        .iter()
        .enumerate()
        .map(|(i, (points, ends))| RestCrack { crack: i as u32, body: 0, points, ends: *ends })
        .collect();
    Fragments::new(&rings, &cracks)
}

fn area(fragment: &Fragment) -> f64 {
    let ring = |b: &Boundary| fissure_plane::signed_area(&b.iter().map(|e| e.rest[0]).collect::<Vec<_>>());
    fragment.boundaries.iter().map(ring).sum()
}

/// Areas of the fragments of the plate, smallest first; each must be closed, and hold the places that it should.
fn areas(cracks: &[(&[[f64; 2]], [CrackEnd; 2])]) -> Vec<f64> {
    let cracks: Vec<_> = cracks.iter().map(|(line, ends)| (points(line), *ends)).collect();
    let found = cut(&plate(), &cracks);
    for boundary in found.list().iter().flat_map(|f| &f.boundaries) {
        for (edge, next) in boundary.iter().zip(boundary.iter().cycle().skip(1)) {
            assert_eq!(edge.rest[1], next.rest[0]);
        }
    }
    let mut counted = vec![0; found.list().len()];
    let lattice = (0..160).flat_map(|i| (0..160).map(move |j| (i, j)));
    for (i, j) in lattice {
        let place = Point::new(0.0125 + 0.025 * f64::from(i), 0.0125 + 0.025 * f64::from(j));
        if plate().contains(place) {
            counted[found.at(0, place).unwrap()] += 1;
        }
    }
    let mut areas: Vec<f64> = found.list().iter().map(area).collect();
    for (counted, area) in counted.iter().zip(&areas) {
        assert!((f64::from(*counted) * 0.025 * 0.025 - area).abs() < 0.05, "{counted} {area}");
    }
    areas.sort_by(f64::total_cmp);
    areas
}

fn assert_areas(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    found.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-8, "{found:?}"));
}

/// Truth: areas by hand. A crack with a tip cuts nothing off, wherever it is; one that arrives does.
#[test]
fn what_lines_close_off_is_a_fragment() {
    let to_hole = |x: f64, end| (vec![[0.0, 2.0], [x, 2.0]], [MOUTH, end]);
    let lines = |of: &[(Vec<[f64; 2]>, [CrackEnd; 2])]| {
        areas(&of.iter().map(|(line, ends)| (line.as_slice(), *ends)).collect::<Vec<_>>())
    };
    assert_areas(&lines(&[]), &[15.0]);
    assert_areas(&lines(&[to_hole(1.49, TIP)]), &[15.0]);
    assert_areas(&lines(&[to_hole(1.5, MOUTH)]), &[15.0]);
    let right = (vec![[4.0, 2.0], [2.5, 2.0]], [MOUTH, MOUTH]);
    assert_areas(&lines(&[to_hole(1.5, MOUTH), right.clone()]), &[7.5, 7.5]);
    // Ends beside what they end on are led there.
    assert_areas(&lines(&[(vec![[1e-9, 2.0], [1.5 - 1e-9, 2.0]], [MOUTH, MOUTH]), right.clone()]), &[7.5, 7.5]);
    // Across a corner, and a crack on its own within each part.
    let corner = (vec![[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]], [MOUTH, MOUTH]);
    let inner = (vec![[0.1, 0.1], [0.2, 0.2]], [TIP, TIP]);
    let other = (vec![[3.0, 0.1], [3.0, 3.9], [2.0, 3.9]], [TIP, TIP]);
    assert_areas(&lines(&[corner.clone(), inner.clone(), other.clone()]), &[0.5, 14.5]);
}

/// Truth: areas by hand, at junctions on a crack, on its own first part, of three cracks in a point, and at crossings.
#[test]
fn cracks_that_meet_cut_off_what_they_close() {
    let on = |crack| CrackEnd::Junction { crack };
    let line: &[[f64; 2]] = &[[0.0, 1.0], [2.0, 1.0], [4.0, 1.0]];
    // The second meets the first in one of its points, the third between two.
    assert_areas(&areas(&[(line, [MOUTH, MOUTH])]), &[4.0, 11.0]);
    let at_point: &[[f64; 2]] = &[[2.0, 1.0], [2.0, 0.0]];
    let between: &[[f64; 2]] = &[[3.0, 0.0], [3.0, 1.0]];
    let all = [(line, [MOUTH, MOUTH]), (at_point, [on(0), MOUTH]), (between, [MOUTH, on(0)])];
    assert_areas(&areas(&all), &[1.0, 1.0, 2.0, 11.0]);
    // A hair beside, and a hair beyond.
    for beyond in [-1e-16, 1e-16] {
        let between: &[[f64; 2]] = &[[3.0, 0.0], [3.0, 1.0 + beyond]];
        let all = [(line, [MOUTH, MOUTH]), (at_point, [on(0), MOUTH]), (between, [MOUTH, on(0)])];
        assert_areas(&areas(&all), &[1.0, 1.0, 2.0, 11.0]);
    }
    // A loop around the hole, which ends on its own beginning.
    let around: &[[f64; 2]] = &[[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];
    assert_areas(&areas(&[(around, [TIP, on(0)])]), &[3.0, 12.0]);
    // Three that meet in a point, each of which names one other.
    let star: [&[[f64; 2]]; 3] = [&[[0.5, 0.5], [0.0, 0.5]], &[[0.5, 0.5], [0.5, 0.0]], &[[0.5, 0.5], [0.0, 1.0]]];
    let star = [(star[0], [on(1), MOUTH]), (star[1], [on(0), MOUTH]), (star[2], [on(0), MOUTH])];
    assert_areas(&areas(&star), &[0.125, 0.25, 14.625]);
    // Two mouths at one place.
    let fan: [&[[f64; 2]]; 2] = [&[[1.0, 0.0], [0.0, 1.0]], &[[1.0, 0.0], [0.0, 0.5]]];
    assert_areas(&areas(&[(fan[0], [MOUTH, MOUTH]), (fan[1], [MOUTH, MOUTH])]), &[0.25, 0.25, 14.5]);
    let across: &[[f64; 2]] = &[[1.0, 0.0], [1.0, 4.0]];
    assert_areas(&areas(&[(line, [MOUTH, MOUTH]), (across, [MOUTH, MOUTH])]), &[1.0, 3.0, 3.0, 8.0]);
}

proptest! {
    /// Truth: Euler. Chords of a convex body that cross in different points make 1 + chords + crossings fragments; the
    /// area of all is that of the body.
    #[test]
    fn chords_cut_a_square_as_euler_says(ends in proptest::collection::vec((0.1..3.9_f64, 0.1..3.9_f64, 0..2_u8), 1..9)) {
        let region = Region { exterior: plate().exterior, holes: Vec::new() };
        let chord = |&(p, q, way): &(f64, f64, u8)| {
            let line = if way == 0 { [[0.0, p], [4.0, q]] } else { [[p, 0.0], [q, 4.0]] };
            (points(&line), [MOUTH, MOUTH])
        };
        let chords: Vec<_> = ends.iter().map(chord).collect();
        let mut crossings = 0;
        for (i, (a, _)) in chords.iter().enumerate() {
            crossings += chords[..i].iter().filter(|(b, _)| fissure_plane::segments_touch(a[0], a[1], b[0], b[1])).count();
        }
        let found = cut(&region, &chords);
        prop_assert_eq!(found.list().len(), 1 + chords.len() + crossings);
        let total: f64 = found.list().iter().map(area).sum();
        prop_assert!((total - 16.0).abs() < 1e-9);
    }
}

/// Truth: by hand. Two cracks that run into one and lie on each other from there on: there is nothing between them, and
/// no fragment has a boundary around that.
#[test]
fn nothing_lies_between_cracks_on_each_other() {
    let cracks = [
        (points(&[[0.0, 1.0], [1.0, 1.0], [2.0, 1.0]]), [MOUTH, TIP]),
        (points(&[[0.5, 0.0], [1.0, 1.0], [2.0, 1.0]]), [MOUTH, TIP]),
    ];
    let found = cut(&plate(), &cracks);
    for boundary in found.list().iter().flat_map(|fragment| &fragment.boundaries) {
        assert!(boundary.len() > 2, "{boundary:?}");
    }
    let all: f64 = found.list().iter().map(area).sum();
    assert!((all - 15.0).abs() < 1e-12, "{all}");
}
