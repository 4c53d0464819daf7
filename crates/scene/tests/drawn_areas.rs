//! What elements of a drawing cover: fill rules, strokes, clips, groups.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::regions_of;
use fissure_scene::{Point, Region, Vector};
use proptest::prelude::*;

fn area(regions: &[Region]) -> f64 {
    regions.iter().map(Region::area).sum()
}

/// Regions of element `b` of a drawing that is 100 units and 100 metres wide, with (0, 0) in its centre and y up.
fn drawn(inner: &str) -> Vec<Region> {
    regions_of(&format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>{inner}</svg>"))
}

/// How often a ring turns around a point.
fn turns(ring: &[Point], p: Point) -> i32 {
    let mut turns = 0;
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let side = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        if a.y <= p.y && b.y > p.y && side > 0.0 {
            turns += 1;
        } else if a.y > p.y && b.y <= p.y && side < 0.0 {
            turns -= 1;
        }
    }
    turns
}

fn distance_to_line(line: &[Point], closed: bool, p: Point) -> f64 {
    let count = if closed { line.len() } else { line.len() - 1 };
    (0..count)
        .map(|i| {
            let (a, b) = (line[i], line[(i + 1) % line.len()]);
            let along: Vector = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * t - p).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

/// A lattice of places over the drawing, off every round number.
fn places() -> impl Iterator<Item = Point> {
    (0..40).flat_map(|i| (0..40).map(move |j| Point::new(-49.1 + 2.47 * i as f64, -49.3 + 2.47 * j as f64)))
}

fn covers(regions: &[Region], p: Point) -> bool {
    regions.iter().any(|r| r.contains(p))
}

/// Corners as path data, without Z: SVG closes what it fills. Half numbers, so that corners lie on edges and on each
/// other.
fn path_of(corners: &[(i32, i32)]) -> (String, Vec<Point>) {
    let data: Vec<String> =
        corners.iter().map(|(x, y)| format!("{} {}", f64::from(*x) / 2.0, f64::from(*y) / 2.0)).collect();
    let ring = corners.iter().map(|&(x, y)| Point::new(f64::from(x) / 2.0 - 50.0, 50.0 - f64::from(y) / 2.0)).collect();
    (format!("M{}", data.join("L")), ring)
}

fn corners() -> impl Strategy<Value = Vec<(i32, i32)>> {
    prop_oneof![
        prop::collection::vec((0..=200_i32, 0..=200_i32), 3..12),
        // A coarse lattice: corners on edges, edges on edges, places passed several times.
        prop::collection::vec((0..=4_i32, 0..=4_i32).prop_map(|(x, y)| (50 * x, 50 * y)), 3..14),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Truth: the winding number of the path around each place, counted edge by edge. What is left may be loaded as
    /// bodies, so rings neither cross nor touch.
    #[test]
    fn crossing_outlines_cover_what_their_fill_rule_fills(
        first in corners(), second in corners(), even_odd in any::<bool>()
    ) {
        let ((a, ring_a), (b, ring_b)) = (path_of(&first), path_of(&second));
        let rule = if even_odd { "evenodd" } else { "nonzero" };
        let inner = format!("<path id='b' fill-rule='{rule}' d='{a} {b}'/>");
        let filled = |p| {
            let turns = turns(&ring_a, p) + turns(&ring_b, p);
            if even_odd { turns % 2 != 0 } else { turns != 0 }
        };
        let wanted: Vec<Point> = places().filter(|&p| filled(p)).collect();
        prop_assume!(wanted.len() > 20);
        let regions = drawn(&inner);
        for p in places() {
            let near = distance_to_line(&ring_a, true, p).min(distance_to_line(&ring_b, true, p));
            if near > 1e-2 {
                prop_assert_eq!(covers(&regions, p), filled(p), "{} {:?}", inner, p);
            }
        }
    }

    /// Truth: a pen with a round tip covers what lies within half its width of the line.
    #[test]
    fn strokes_cover_what_their_pen_reaches(line in corners(), width in 1.0..12.0_f64, closed in any::<bool>()) {
        let (data, points) = path_of(&line);
        prop_assume!(points.windows(2).all(|w| w[0] != w[1]) && points[0] != points[points.len() - 1]);
        let z = if closed { "Z" } else { "" };
        let inner = format!(
            "<path id='b' d='{data}{z}' fill='none' stroke='red' stroke-width='{width}' stroke-linecap='round'
             stroke-linejoin='round'/>"
        );
        let regions = drawn(&inner);
        for p in places() {
            let reach = distance_to_line(&points, closed, p) - 0.5 * width;
            if reach.abs() > 0.05 {
                prop_assert_eq!(covers(&regions, p), reach < 0.0, "{} {:?} {}", inner, p, reach);
            }
        }
    }

    /// Truth: the winding numbers of element and clip, each by its own rule.
    #[test]
    fn clips_leave_what_both_cover(shape in corners(), clip in corners(), even_odd in any::<bool>(), turn in 0..360_i32) {
        let ((a, ring), (b, clip_ring)) = (path_of(&shape), path_of(&clip));
        let rule = if even_odd { "evenodd" } else { "nonzero" };
        let inner = format!(
            "<clipPath id='c'><path d='{b}' clip-rule='{rule}' transform='rotate({turn} 50 50)'/></clipPath>
             <g clip-path='url(#c)'><path id='b' d='{a}'/></g>"
        );
        // SVG turns clockwise as seen, y down; so it does in the scene, y up.
        let (sin, cos) = f64::from(-turn).to_radians().sin_cos();
        let clip_ring: Vec<Point> =
            clip_ring.iter().map(|p| Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y)).collect();
        let inside = |p| {
            let within = turns(&clip_ring, p);
            turns(&ring, p) != 0 && if even_odd { within % 2 != 0 } else { within != 0 }
        };
        prop_assume!(places().filter(|&p| inside(p)).count() > 20);
        let regions = drawn(&inner);
        for p in places() {
            let near = distance_to_line(&ring, true, p).min(distance_to_line(&clip_ring, true, p));
            if near > 1e-2 {
                prop_assert_eq!(covers(&regions, p), inside(p), "{} {:?}", inner, p);
            }
        }
    }
}

/// Truth: areas by hand.
#[test]
fn paint_decides_what_an_element_is() {
    let cases = [
        ("open subpath closes when filled", "<path id='b' d='M0 0H10V10'/>", 50.0),
        (
            "fill alone when there is a stroke too",
            "<rect id='b' width='10' height='10' stroke='red' stroke-width='4'/>",
            100.0,
        ),
        ("stroke without fill", "<path id='b' d='M10 10H30' fill='none' stroke='red' stroke-width='2'/>", 40.0),
        (
            "a line has nothing to fill",
            "<line id='b' x1='10' y1='10' x2='30' y2='10' stroke='red' stroke-width='2'/>",
            40.0,
        ),
        ("inherited paint", "<g fill='none' stroke='red' stroke-width='2'><path id='b' d='M10 10H30'/></g>", 40.0),
        (
            "from a style sheet",
            "<style>.s {fill: none; stroke: red; stroke-width: 2}</style><path id='b' class='s' d='M10 10H30'/>",
            40.0,
        ),
        (
            "square caps",
            "<path id='b' d='M10 10H30' fill='none' stroke='red' stroke-width='2' stroke-linecap='square'/>",
            44.0,
        ),
        (
            "mitred ring",
            "<rect id='b' x='10' y='10' width='10' height='10' fill='none' stroke='red' stroke-width='2'/>",
            80.0,
        ),
        (
            "dashes",
            "<path id='b' d='M10 10H30' fill='none' stroke='red' stroke-width='2' stroke-dasharray='3 2'/>",
            24.0,
        ),
        (
            "scaled stroke",
            "<path id='b' transform='scale(2 1)' d='M10 10H20' fill='none' stroke='red' stroke-width='2'/>",
            40.0,
        ),
        ("no paint at all", "<path id='b' d='M0 0H10V10H0Z M2 2H8V8H2Z' fill-rule='evenodd' fill='none'/>", 64.0),
        (
            "transparent counts as no paint",
            "<g id='b'><rect width='10' height='10'/><rect x='20' width='10' height='10' fill-opacity='0'/></g>",
            100.0,
        ),
        (
            "hidden parts do not count",
            "<g id='b'><rect width='10' height='10'/><rect x='20' width='10' height='10' display='none'/></g>",
            100.0,
        ),
        ("a hidden layer counts whole", "<g id='b' style='display:none'><rect width='10' height='10'/></g>", 100.0),
        ("an element of a hidden layer", "<g visibility='hidden'><rect id='b' width='10' height='10'/></g>", 100.0),
        (
            "filled and stroked parts",
            "<g id='b'><rect width='10' height='10'/><path d='M20 5H30' fill='none' stroke='red' stroke-width='2'/></g>",
            120.0,
        ),
        (
            "a use",
            "<defs><rect id='r' width='10' height='10'/></defs><use id='b' href='#r' x='5' transform='scale(2)'/>",
            400.0,
        ),
    ];
    for (what, inner, wanted) in cases {
        let found = area(&drawn(inner));
        assert!((found / wanted - 1.0).abs() < 1e-5, "{what}: {found} is not {wanted}");
    }
}

/// Truth: a dot has the area of its pen's tip. Chords may leave its rim, of radius 2, by 0.05: up to 3.3 % of the area.
#[test]
fn dots_are_drawn() {
    let pen = "fill='none' stroke='red' stroke-width='4' stroke-linecap='round'";
    let disc = 4.0 * std::f64::consts::PI;
    for (inner, count) in [
        (format!("<path id='b' d='M10 10h0' {pen}/>"), 1),
        (format!("<path id='b' d='M10 10h0M30 30h0' {pen}/>"), 2),
        (format!("<path id='b' d='M10 10H41' stroke-dasharray='0 10' {pen}/>"), 4),
    ] {
        let regions = drawn(&inner);
        assert_eq!(regions.len(), count, "{inner}");
        assert!((area(&regions) / (count as f64 * disc) - 1.0).abs() < 4e-2, "{inner}: {}", area(&regions));
    }
}

/// Truth: areas and counts by hand. Shapes that overlap or share an edge are one body, those that meet in a corner are
/// two.
#[test]
fn groups_are_united() {
    let square = |x: f64, y: f64| format!("<rect x='{x}' y='{y}' width='10' height='10'/>");
    let group = |parts: &[String]| drawn(&format!("<g id='b'>{}</g>", parts.concat()));
    let cases = [
        ("overlapping", vec![square(0.0, 0.0), square(5.0, 0.0)], 1, 150.0),
        ("abutting", vec![square(0.0, 0.0), square(10.0, 0.0)], 1, 200.0),
        ("abutting but for rounding", vec![square(0.0, 0.0), square(10.0001, 0.0)], 1, 200.0),
        ("apart", vec![square(0.0, 0.0), square(11.0, 0.0)], 2, 200.0),
        ("corner to corner", vec![square(0.0, 0.0), square(10.0, 10.0)], 2, 200.0),
        (
            "a hole of four",
            vec![square(10.0, 0.0), square(0.0, 10.0), square(20.0, 10.0), square(10.0, 20.0)],
            4,
            400.0,
        ),
    ];
    for (what, parts, count, wanted) in cases {
        let regions = group(&parts);
        assert_eq!(regions.len(), count, "{what}");
        assert!((area(&regions) / wanted - 1.0).abs() < 1e-4, "{what}: {}", area(&regions));
        assert!(regions.iter().all(|r| r.holes.is_empty()), "{what}");
    }
    // Sectors of a disc, each with its own arcs, at any turn: the disc.
    let sector = |from: f64, to: f64| {
        let at = |angle: f64| format!("{} {}", 50.0 + 30.0 * angle.cos(), 50.0 + 30.0 * angle.sin());
        format!("<path d='M50 50L{}A30 30 0 0 1 {}Z'/>", at(from), at(to))
    };
    for turn in [0.0, 0.3, 1.1] {
        let cuts = [0.0, 0.9, 2.2, 3.6, 5.0, std::f64::consts::TAU].map(|a| a + turn);
        let parts: Vec<String> = cuts.windows(2).map(|w| sector(w[0], w[1])).collect();
        let regions = group(&parts);
        assert_eq!((regions.len(), regions[0].holes.len()), (1, 0), "{turn}");
        assert!((area(&regions) / (900.0 * std::f64::consts::PI) - 1.0).abs() < 2e-3);
    }
    // Two halves of a blob that share a curve, drawn from either side with other nodes.
    let left = "<path d='M20 20C40 30 10 50 30 80H0V20Z'/>";
    let right = "<path d='M60 20V80H30C20 65 17.5 52.5 20.625 42.5 C23.75 32.5 30 25 20 20Z'/>";
    assert!(!drawn(&format!("<g id='b'>{left}{right}</g>")).is_empty());
}

/// Letters that overlap are one body each word; parts are numbered from left to right.
#[test]
fn tight_letters_melt_and_parts_are_numbered_from_the_left() {
    let word = |spacing: &str, text: &str| {
        drawn(&format!("<text id='b' x='5' y='80' font-size='30' letter-spacing='{spacing}'>{text}</text>"))
    };
    assert_eq!(word("-6", "TYA").len(), 1);
    let apart = word("6", "TYA");
    assert_eq!(apart.len(), 3);
    assert!(apart.windows(2).all(|w| w[0].bounds().0.x < w[1].bounds().0.x));
}

/// Truth: areas by hand. Clips in clips, clips on clips, in box units, with holes, and of symbols.
#[test]
fn clips_apply() {
    let cases = [
        (
            "on the element",
            "<clipPath id='c'><rect width='5' height='20'/></clipPath><rect id='b' width='10' height='10' clip-path='url(#c)'/>",
            50.0,
        ),
        (
            "box units",
            "<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='.5' height='.5'/></clipPath><rect id='b' x='20' y='10' width='10' height='10' clip-path='url(#c)'/>",
            25.0,
        ),
        (
            "nested",
            "<clipPath id='d'><rect height='20' width='4'/></clipPath><clipPath id='c' clip-path='url(#d)'><rect width='5' height='2'/></clipPath><rect id='b' width='10' height='10' clip-path='url(#c)'/>",
            8.0,
        ),
        (
            "clip of a clip's child",
            "<clipPath id='d'><rect height='20' width='4'/></clipPath><clipPath id='c'><rect width='5' height='2' clip-path='url(#d)'/></clipPath><rect id='b' width='10' height='10' clip-path='url(#c)'/>",
            8.0,
        ),
        (
            "with a hole",
            "<clipPath id='c'><path clip-rule='evenodd' d='M0 0H10V10H0ZM2 2H8V8H2Z'/></clipPath><rect id='b' width='10' height='10' clip-path='url(#c)'/>",
            64.0,
        ),
        (
            "transformed user",
            "<clipPath id='c'><rect width='5' height='20'/></clipPath><g transform='translate(30) scale(2)' clip-path='url(#c)'><rect id='b' width='10' height='10'/></g>",
            200.0,
        ),
        (
            "stroke clipped",
            "<clipPath id='c'><rect width='20' height='20'/></clipPath><path id='b' d='M10 10H30' fill='none' stroke='red' stroke-width='2' clip-path='url(#c)'/>",
            20.0,
        ),
        (
            "symbol",
            "<symbol id='s' viewBox='0 0 10 10'><rect width='20' height='10'/></symbol><use id='b' href='#s' width='30' height='30' transform='translate(3 4)'/>",
            900.0,
        ),
    ];
    for (what, inner, wanted) in cases {
        let found = area(&drawn(inner));
        assert!((found / wanted - 1.0).abs() < 1e-4, "{what}: {found} is not {wanted}");
    }
}
