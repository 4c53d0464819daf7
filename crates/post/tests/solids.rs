//! From frames to checked solids. Truth: closed forms, the shoelace formula, and a brute-force winding area.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;
#[path = "common/places.rs"]
mod places;
#[path = "common/winding.rs"]
mod winding;

use common::{Opened, frame, halves, options, particles, scene, square};
use fissure_plane::find_crossing;
use fissure_post::{Content, Mesh, PostError, PostOptions, Slot, Vertex, post_frame};
use fissure_scene::{CrackEnd, Curve, Cut, Frame, OpeningSettings, Part, Point, Region, Scene, Vector, Walls};
use places::mergeable;
use proptest::prelude::*;
use winding::covered_area;

fn cracked(scene: &Scene, frame: &Frame) -> Vec<Mesh> {
    post_frame(scene, frame, &options(scene)).unwrap().parts.remove(0).1
}

/// The same with openings as narrow as they are.
fn exact(scene: &Scene, frame: &Frame) -> Vec<Mesh> {
    let options = PostOptions { shortest_edge: 0.0, ..options(scene) };
    post_frame(scene, frame, &options).unwrap().parts.remove(0).1
}

fn area(meshes: &[Mesh]) -> f64 {
    let area = |m: &Mesh| if let Content::Solid { area, .. } = m.content { area } else { panic!("not a solid") };
    meshes.iter().map(area).sum()
}

fn inside_triangles(meshes: &[Mesh]) -> usize {
    meshes.iter().map(|m| m.slot(Slot::Inside).len()).sum()
}

/// What the boundary of the body winds around, from the frame alone.
fn brute_force_area(frame: &Frame) -> f64 {
    let openings = frame.cracks.iter().map(|c| {
        let mut ring: Vec<Point> = c.above.iter().chain(c.below.iter().rev()).copied().collect();
        let (n, middle) = (c.rest.len(), |i: usize| nalgebra::center(&c.above[i], &c.below[i]));
        if c.start == CrackEnd::Tip {
            (ring[0], ring[2 * n - 1]) = (middle(0), middle(0));
        }
        if c.end == CrackEnd::Tip {
            (ring[n - 1], ring[n]) = (middle(n - 1), middle(n - 1));
        }
        ring
    });
    let rings: Vec<Vec<Point>> = frame.outlines.iter().map(|o| o.position.clone()).chain(openings).collect();
    covered_area(&rings)
}

fn edge_crack(size: f64, opening: f64) -> Opened {
    let rest = (0..=4).map(|i| Point::new(0.1 * size * f64::from(i), 0.5 * size)).collect();
    let profile: Vec<f64> = (0..=4).map(|i| opening * (1.0 - 0.25 * f64::from(i))).collect();
    Opened::symmetric(rest, &profile, CrackEnd::Mouth, CrackEnd::Tip)
}

#[test]
fn a_whole_square_is_a_box() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let meshes = cracked(&scene, &frame(&region, 1, &[]));
    assert_eq!(meshes.len(), 1);
    assert_eq!(meshes[0].name, "plate_piece_0000");
    assert_eq!(meshes[0].triangle_count(), 12);
    assert_eq!(area(&meshes), 400.0);
    assert_eq!(inside_triangles(&meshes), 0);
}

#[test]
fn an_open_edge_crack_takes_off_its_triangle() {
    for size in [1e-3, 20.0, 1e4] {
        let region = square(size);
        let scene = scene(region.clone());
        let opening = 0.01 * size;
        let meshes = exact(&scene, &frame(&region, 3, &[edge_crack(size, opening)]));
        let expected = size * size - 0.5 * 0.4 * size * opening;
        // Each corner may move by half a step of size · 2⁻²³ or so.
        assert!((area(&meshes) / expected - 1.0).abs() < 1e-6, "{} {expected}", area(&meshes));
        // Four wall edges on each face.
        assert_eq!(inside_triangles(&meshes), 2 * 2 * 4);
    }
}

#[test]
fn a_closed_crack_has_no_walls() {
    let region = square(20.0);
    let scene = scene(region.clone());
    for opening in [0.0, -1e-9, -1e-3, -0.1] {
        let through = Opened { end: CrackEnd::Mouth, ..edge_crack_across(20.0, opening) };
        for crack in [edge_crack(20.0, opening), through] {
            let meshes = cracked(&scene, &frame(&region, 3, &[crack]));
            assert_eq!(inside_triangles(&meshes), 0, "opening {opening}");
            assert_eq!(meshes.len(), 1);
            // Overlapping material counts once, and nothing is missing.
            assert!((area(&meshes) - 400.0).abs() < 1e-4, "{}", area(&meshes) - 400.0);
        }
    }
}

/// A crack from the left edge to the right edge.
/// Truth: by hand. All cracks have walls when asked for, closed ones too, in contact or at rest; fragments stay as they
/// are.
#[test]
fn closed_cracks_have_walls_when_asked() {
    let region = square(20.0);
    let mut scene = scene(region.clone());
    scene.output.walls = Walls::All;
    let inner = |opening: f64| {
        let rest = (0..=4).map(|i| Point::new(4.0 + f64::from(i), 5.0)).collect();
        Opened::symmetric(rest, &[0.0, opening, opening, opening, 0.0], CrackEnd::Tip, CrackEnd::Tip)
    };
    for opening in [0.0, -1e-3, 1e-3] {
        let cracks = [edge_crack(20.0, opening), inner(opening)];
        let meshes = cracked(&scene, &frame(&region, 2, &cracks));
        assert_eq!(inside_triangles(&meshes), 2 * 16, "{opening}");
        let open = if opening > 0.0 { 0.5 * 8.0 * opening + 3.0 * opening } else { 0.0 };
        assert!((area(&meshes) - (400.0 - open)).abs() < 1e-3 * opening.abs() + 2e-4, "{opening}: {}", area(&meshes));
    }
    let (mut scene, frame) = halves(20.0, [(0.0, Vector::zeros()), (0.0, Vector::new(-0.5, 0.0))]);
    let before = cracked(&scene, &frame);
    scene.output.walls = Walls::All;
    assert_eq!(cracked(&scene, &frame), before);
}

fn edge_crack_across(size: f64, opening: f64) -> Opened {
    let rest: Vec<Point> = (0..=4).map(|i| Point::new(0.25 * size * f64::from(i), 0.5 * size)).collect();
    Opened::symmetric(rest, &[opening; 5], CrackEnd::Mouth, CrackEnd::Mouth)
}

#[test]
fn fragments_turn_and_fly_apart() {
    let far = Vector::new(37.0, -11.0);
    // Upside down and away; swapped sides; a small gap; in contact; a corner that overlaps the other half; one on the
    // other.
    for motions in [
        [(0.0, Vector::zeros()), (3.0, far)],
        [(1.0, far), (-2.0, -far)],
        [(0.0, Vector::zeros()), (0.0, Vector::new(1e-3, 0.0))],
        [(0.0, Vector::zeros()), (0.0, Vector::zeros())],
        [(0.0, Vector::zeros()), (0.15, Vector::new(0.2, 0.0))],
        [(0.0, Vector::zeros()), (0.0, Vector::new(-10.0, 0.0))],
    ] {
        let (scene, frame) = halves(20.0, motions);
        let meshes = cracked(&scene, &frame);
        assert_eq!(meshes.iter().map(|m| m.piece).collect::<Vec<_>>(), [0, 1]);
        for mesh in &meshes {
            assert!((area(std::slice::from_ref(mesh)) - 200.0).abs() < 1e-3);
            assert_eq!(mesh.slot(Slot::Inside).len(), 2 * 8);
        }
    }
}

#[test]
fn a_crack_may_run_from_a_hole() {
    let mut region = square(20.0);
    region.holes = vec![[(8.0, 8.0), (8.0, 12.0), (12.0, 12.0), (12.0, 8.0)].map(|(x, y)| Point::new(x, y)).to_vec()];
    let scene = scene(region.clone());
    // From the exterior into the hole, and from the hole to a tip.
    let one = (0..=3).map(|i| Point::new(8.0 / 3.0 * f64::from(i), 10.0)).collect();
    let two = (0..=3).map(|i| Point::new(12.0 + f64::from(i), 10.0)).collect();
    let one = Opened::symmetric(one, &[0.1; 4], CrackEnd::Mouth, CrackEnd::Mouth);
    let two = Opened::symmetric(two, &[0.2, 0.2, 0.1, 0.0], CrackEnd::Mouth, CrackEnd::Tip);
    let meshes = cracked(&scene, &frame(&region, 1, &[one, two]));
    let expected = 400.0 - 16.0 - 0.8 - (0.2 + 0.15 + 0.05);
    assert!((area(&meshes) - expected).abs() < 1e-4, "{}", area(&meshes));
}

#[test]
fn a_branch_opens_into_the_crack_it_ends_on() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let (a, b) = (0.1, 0.2);
    // Along y = 10, its upper face parted by b where the branch comes down at x = 8.
    let x = [0.0, 4.0, 8.0, 8.0, 12.0];
    let trunk = Opened {
        rest: x.iter().map(|&x| Point::new(x, 10.0)).collect(),
        above: [0.0, 0.0, -b, b, 0.0].iter().map(|&dx| Vector::new(dx, a)).collect(),
        below: x.iter().map(|_| Vector::new(0.0, -a)).collect(),
        start: CrackEnd::Mouth,
        end: CrackEnd::Tip,
    };
    // Upwards from the trunk: its left side is above.
    let branch = Opened {
        rest: (0..=2).map(|i| Point::new(8.0, 10.0 + 2.0 * f64::from(i))).collect(),
        above: vec![Vector::new(-b, a), Vector::new(-b, 0.0), Vector::zeros()],
        below: vec![Vector::new(b, a), Vector::new(b, 0.0), Vector::zeros()],
        start: CrackEnd::Junction { crack: 0 },
        end: CrackEnd::Tip,
    };
    let frame = frame(&region, 1, &[trunk, branch]);
    let meshes = exact(&scene, &frame);
    // Trunk: a strip of height 2a over 8 m and a triangle of 4 m; branch: a strip 2b wide and a triangle; no skin
    // between.
    let trunk = 2.0 * a * 8.0 + 0.5 * 2.0 * a * 4.0 - 0.5 * a * b;
    let branch = 2.0 * b * (2.0 - a) + 0.5 * 2.0 * b * 2.0;
    let expected = brute_force_area(&frame);
    assert!((area(&meshes) - expected).abs() < 1e-4);
    assert!((400.0 - trunk - branch - expected).abs() < 2.0 * a * b, "{expected}");
    assert_eq!(meshes.len(), 1);
    let at_junction = |p: &[f64; 3]| (p[0] - 8.0).abs() < 0.5 * b && (p[1] - 10.0 - a).abs() < 1e-3;
    assert!(!meshes[0].vertices.iter().any(|v| at_junction(&v.position)), "a wall across the junction");
}

#[test]
fn mouths_and_junctions_open_even_where_the_boundary_was_not_parted() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let straight = |x0: f64, x1: f64| (0..=4).map(|i| Point::new(x0 + 0.25 * (x1 - x0) * f64::from(i), 10.0)).collect();
    // Faces apart by 0.2 up to the outline, which has one tracer there, or none.
    let across = Opened::symmetric(straight(0.0, 20.0), &[0.2; 5], CrackEnd::Mouth, CrackEnd::Mouth);
    for per_side in [2, 3] {
        let whole = frame(&region, per_side, &[]);
        let mut cut = frame(&region, per_side, std::slice::from_ref(&across));
        cut.outlines = whole.outlines;
        let meshes = exact(&scene, &cut);
        assert!((area(&meshes) - 396.0).abs() < 1e-4, "{}", area(&meshes));
        assert_eq!(inside_triangles(&meshes), 2 * 2 * 4);
    }
    // A branch upwards and one downwards; the trunk has a point where the first leaves it, none where the second does.
    let up = |x: f64, way: f64| Opened {
        rest: (0..=2).map(|i| Point::new(x, 10.0 + way * f64::from(i))).collect(),
        above: [0.1, 0.05, 0.0].map(|d| Vector::new(-way * d, if d == 0.1 { 0.1 * way } else { 0.0 })).to_vec(),
        below: [0.1, 0.05, 0.0].map(|d| Vector::new(way * d, if d == 0.1 { 0.1 * way } else { 0.0 })).to_vec(),
        start: CrackEnd::Junction { crack: 0 },
        end: CrackEnd::Tip,
    };
    let mut branched = frame(&region, 2, &[across, up(10.0, 1.0), up(7.0, -1.0)]);
    let meshes = exact(&scene, &branched);
    // Each branch: a triangle 0.2 wide and 2 high, less the strip of 0.1 that the trunk takes.
    let branch = 0.15 * 0.9 + 0.05;
    assert!((area(&meshes) - (396.0 - 2.0 * branch)).abs() < 1e-4, "{}", area(&meshes) - 396.0 + 2.0 * branch);
    // The same with the branches walked from tip to junction.
    for crack in &mut branched.cracks[1..] {
        for points in [&mut crack.rest, &mut crack.above, &mut crack.below] {
            points.reverse();
        }
        std::mem::swap(&mut crack.above, &mut crack.below);
        std::mem::swap(&mut crack.start, &mut crack.end);
    }
    assert!((area(&exact(&scene, &branched)) - area(&meshes)).abs() < 1e-9);
}

#[test]
fn openings_that_touch_in_a_point_are_parted() {
    let region = square(20.0);
    let scene = scene(region.clone());
    // Two lens-shaped cracks whose middles touch in (10, 10): the material hangs together in a point there.
    let lens = |y: f64, down: f64, up: f64| Opened {
        rest: (0..=2).map(|i| Point::new(6.0 + 4.0 * f64::from(i), y)).collect(),
        above: vec![Vector::zeros(), Vector::new(0.0, up), Vector::zeros()],
        below: vec![Vector::zeros(), Vector::new(0.0, -down), Vector::zeros()],
        start: CrackEnd::Tip,
        end: CrackEnd::Tip,
    };
    let frame = frame(&region, 1, &[lens(9.0, 0.5, 1.0), lens(11.0, 1.0, 0.5)]);
    let exact = PostOptions { shortest_edge: 0.0, ..options(&scene) };
    let meshes = post_frame(&scene, &frame, &exact).unwrap().parts.remove(0).1;
    // The four edges of 4 m that meet there now end on the rim of the diamond, half a step of 2⁻¹⁹ m off at most.
    assert!((area(&meshes) - brute_force_area(&frame)).abs() <= 4.0 * 4.0 * 2.0_f64.powi(-20));
    let from_touch = |v: &Vertex| (v.position[0] - 10.0).hypot(v.position[1] - 10.0);
    let nearest = |meshes: &[Mesh]| meshes[0].vertices.iter().map(from_touch).fold(f64::INFINITY, f64::min);
    assert!(nearest(&meshes) > 0.0);
    // The rim of the diamond is at least this far off.
    assert!(nearest(&cracked(&scene, &frame)) >= 0.7 * 5e-5 * 20.0);
}

#[test]
fn small_fragments_are_dropped_when_asked() {
    let (mut scene, frame) = halves(20.0, [(0.0, Vector::zeros()), (0.0, Vector::new(1.0, 0.0))]);
    scene.output.smallest_fragment = 201.0;
    assert_eq!(cracked(&scene, &frame).len(), 0);
    scene.output.smallest_fragment = 199.0;
    assert_eq!(cracked(&scene, &frame).len(), 2);
}

#[test]
fn most_particles_decide_the_fragment() {
    let (scene, mut frame) = halves(20.0, [(0.0, Vector::zeros()), (0.0, Vector::new(1.0, 0.0))]);
    // Three of two hundred have strayed.
    for p in 0..3 {
        frame.particles.piece[p] = 1 - frame.particles.piece[p];
    }
    let meshes = cracked(&scene, &frame);
    let left = meshes.iter().find(|m| m.vertices.iter().all(|v| v.position[0] < 10.5)).unwrap();
    assert_eq!(left.piece, 0);
}

#[test]
fn open_cracks_that_cross_leave_one_hole() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let line = |a: (f64, f64), b: (f64, f64)| {
        let at = |s: f64| Point::new(a.0 + s * (b.0 - a.0), a.1 + s * (b.1 - a.1));
        Opened::symmetric(
            vec![at(0.0), at(0.25), at(0.75), at(1.0)],
            &[0.0, 1.0, 1.0, 0.0],
            CrackEnd::Tip,
            CrackEnd::Tip,
        )
    };
    let meshes =
        cracked(&scene, &frame(&region, 1, &[line((4.0, 10.0), (16.0, 10.0)), line((10.0, 4.0), (10.0, 16.0))]));
    // Two spindles of 6 m at full width and two tips of 3 m each; they share a square of 1 m².
    assert!((area(&meshes) - (400.0 - 2.0 * (6.0 + 3.0) + 1.0)).abs() < 1e-4, "{}", area(&meshes));
}

#[test]
fn a_fragment_without_particles_goes_with_its_neighbour() {
    let (scene, mut frame) = halves(20.0, [(0.0, Vector::zeros()), (0.0, Vector::new(1.0, 0.0))]);
    let particles = &mut frame.particles;
    let keep = particles.position.iter().position(|p| p.x < 10.0).unwrap();
    for field in [&mut particles.id, &mut particles.body] {
        *field = vec![field[keep]; 1];
    }
    (particles.piece, particles.position) = (vec![7], vec![particles.position[keep]]);
    (particles.rest, particles.velocity) = (vec![particles.rest[keep]], vec![particles.velocity[keep]]);
    for field in [&mut particles.deformation_gradient, &mut particles.cauchy_stress] {
        field.truncate(1);
    }
    let meshes = cracked(&scene, &frame);
    assert_eq!(meshes.iter().map(|m| m.piece).collect::<Vec<_>>(), [7]);
    assert!((area(&meshes) - 400.0).abs() < 1e-3);
}

#[test]
fn textures_stay_with_the_material() {
    let shift = Vector::new(3.0, 0.5);
    let (scene, frame) = halves(20.0, [(0.0, Vector::zeros()), (0.3, shift)]);
    let (_, rest) = halves(20.0, [(0.0, Vector::zeros()), (0.0, Vector::new(1.0, 0.0))]);
    let (moved, rest) = (cracked(&scene, &frame), cracked(&scene, &rest));
    // Truth: the material at rest, moved by what its half is moved by.
    for vertex in
        moved.iter().flat_map(|m| m.vertices.iter().map(move |v| (m.piece, v))).filter(|v| v.1.normal[2] != 0.0)
    {
        let (piece, Vertex { position: [x, y, _], texture, .. }) = vertex;
        let place = Point::new(*x, *y);
        let center = Point::new(15.0, 10.0);
        let back = center + nalgebra::Rotation2::new(-0.3) * (place - shift - center);
        let rest = if piece == 0 { place } else { back };
        assert!((rest - 20.0 * Point::from(*texture).coords).coords.norm() < 2e-5, "{rest} {texture:?}");
    }
    // Truth: the same material in another place. The walls of both frames have the same vertices in another order.
    let textures = |meshes: &[Mesh]| {
        let walls = meshes.iter().flat_map(|m| &m.vertices).filter(|v| v.normal[2] == 0.0);
        let mut all: Vec<_> = walls.map(|v| v.texture.map(|t| (t * 1e6).round())).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    let walls = textures(&moved);
    assert_eq!(walls, textures(&rest));
    assert!(walls.iter().all(|t| (0.0..=4e6).contains(&t[0]) && (0.0..=1e6).contains(&t[1])));
}

/// Truth: what the other cut says, and by hand. Both cuts of halves that are parted and of a crack within agree to the
/// grid; triangles and texture coordinates of the cut at rest do not depend on how far anything has moved.
#[test]
fn the_cut_at_rest_stays_and_has_the_same_area() {
    let cut = |scene: &Scene, frame: &Frame, cut| {
        let options = PostOptions { cut, shortest_edge: 0.0, ..options(scene) };
        post_frame(scene, frame, &options).unwrap().parts.remove(0).1
    };
    let (scene, parted) = halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]);
    let (_, together) = halves(20.0, [(0.0, Vector::zeros()), (0.0, Vector::zeros())]);
    let region = square(20.0);
    let (open, closed) = (frame(&region, 3, &[edge_crack(20.0, 0.2)]), frame(&region, 3, &[edge_crack(20.0, 0.0)]));
    for [first, second] in [[parted, together], [open, closed]] {
        let (moved, rest) = (cut(&scene, &first, Cut::Rest), cut(&scene, &second, Cut::Rest));
        // Closed cracks are held open by eight grid steps of 2⁻¹⁹ m, all along their 20 m.
        let hair = 20.0 * 8.0 * 2.0_f64.powi(-19);
        for (frame, meshes) in [(&first, &moved), (&second, &rest)] {
            let difference = area(meshes) - area(&cut(&scene, frame, Cut::Opening));
            assert!(difference.abs() < 1.5 * hair, "{difference:e}");
        }
        assert_eq!(moved.len(), rest.len());
        for (moved, rest) in moved.iter().zip(&rest) {
            assert_eq!(moved.triangles, rest.triangles);
            let close = |p: &Vertex, q: &Vertex| (0..2).all(|k| (p.texture[k] - q.texture[k]).abs() < 1e-9);
            assert!(moved.vertices.iter().zip(&rest.vertices).all(|(p, q)| close(p, q)));
        }
    }
}

/// Truth: the drawing. A zigzag that opens as a wedge within one fragment, the particles on either side of it with its
/// faces: nothing of one side goes with the other one, so the wedge is empty and no triangle is folded.
#[test]
fn what_lies_beside_an_open_crack_goes_with_its_own_side() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let half = |x: f64| (1.5 * (1.0 - x / 14.0)).max(0.0);
    for (height, smoothing) in [(0.0, 0.0), (0.6, 0.0), (0.6, 0.5)] {
        let path = |x: f64| 10.0 + height * (x / 0.7 - (x / 0.7).round());
        let rest: Vec<Point> = (0..=80).map(|i| 0.175 * f64::from(i)).map(|x| Point::new(x, path(x))).collect();
        let opening: Vec<f64> = rest.iter().map(|p| 2.0 * half(p.x)).collect();
        let crack = Opened::symmetric(rest, &opening, CrackEnd::Mouth, CrackEnd::Tip);
        let mut frame = frame(&region, 40, &[crack]);
        let side = |p: Point| if p.y > path(p.x) { 1.0 } else { -1.0 };
        frame.particles = particles(&region, |p| (0, Vector::new(0.0, side(p) * half(p.x))));
        let (rest, gradients) = (&frame.particles.rest, &mut frame.particles.deformation_gradient);
        for (rest, gradient) in rest.iter().zip(gradients).filter(|(rest, _)| rest.x < 14.0) {
            gradient[(1, 0)] = -1.5 / 14.0 * side(*rest);
        }
        for outline in &mut frame.outlines {
            for (position, rest) in outline.position.iter_mut().zip(&outline.rest) {
                *position = rest + Vector::new(0.0, side(*rest) * half(rest.x));
            }
        }
        let options = PostOptions { smoothing, cut: Cut::Rest, cap_size: Some(0.12), ..options(&scene) };
        let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
        for mesh in &meshes {
            let corner = |i: u32| mesh.vertices[i as usize].position;
            let front = mesh.all_triangles().filter(|t| t.iter().all(|&i| mesh.vertices[i as usize].normal[2] == 1.0));
            let twice = |[a, b, c]: [[f64; 3]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let folded = front.map(|t| twice(t.map(corner))).filter(|twice| *twice <= 0.0).count();
            assert_eq!(folded, 0, "{height} {smoothing}");
        }
    }
}

/// The triangles of the front caps.
fn front(meshes: &[Mesh]) -> Vec<[Point; 3]> {
    let of_mesh = |mesh: &Mesh| {
        let is_front = |t: &[u32; 3]| t.iter().all(|&i| mesh.vertices[i as usize].normal[2] == 1.0);
        let place = |i: u32| mesh.vertices[i as usize].position;
        mesh.all_triangles()
            .filter(is_front)
            .map(|t| t.map(|i| Point::new(place(i)[0], place(i)[1])))
            .collect::<Vec<_>>()
    };
    meshes.iter().flat_map(of_mesh).collect()
}

/// Truth: by hand. Faces that have parted beside particles that know nothing of it: what lies between goes along.
#[test]
fn the_cut_at_rest_does_not_fold_where_particles_stay() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let rest: Vec<Point> = (0..=40).map(|i| Point::new(0.35 * f64::from(i), 10.0)).collect();
    let opening: Vec<f64> = rest.iter().map(|p| 1.4 * (p.x * std::f64::consts::PI / 14.0).sin()).collect();
    let frame = frame(&region, 40, &[Opened::symmetric(rest, &opening, CrackEnd::Mouth, CrackEnd::Tip)]);
    for cap_size in [None, Some(0.2)] {
        let options = PostOptions { cut: Cut::Rest, cap_size, ..options(&scene) };
        let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
        let folded = front(&meshes).into_iter().filter(|[a, b, c]| (b - a).perp(&(c - a)) <= 0.0).count();
        assert_eq!(folded, 0, "{cap_size:?}");
    }
}

/// Truth: what the guide promises of caps. A crack at rest with a short edge after a long one and a tip of another one
/// beside it: no angle below 20 degrees, no edge below a ten-thousandth of the body, both faces with the same corners.
#[test]
fn caps_cut_at_rest_have_no_needles() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let closed = |rest: Vec<Point>| {
        let opening = vec![0.0; rest.len()];
        Opened::symmetric(rest, &opening, CrackEnd::Mouth, CrackEnd::Tip)
    };
    let row = [0.0, 9.0, 9.0004, 12.0, 12.0001, 12.0003, 17.0].map(|x| Point::new(x, 10.0)).to_vec();
    let column = vec![Point::new(5.0, 0.0), Point::new(5.0, 9.8)];
    let frame = frame(&region, 3, &[closed(row), closed(column)]);
    let options = PostOptions { cut: Cut::Rest, ..options(&scene) };
    let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
    let triangles = front(&meshes);
    for [a, b, c] in &triangles {
        for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
            let angle = (q - p).angle(&(r - p)).to_degrees();
            assert!(angle >= 20.0, "{angle} at {p}");
            assert!((q - p).norm() >= 1e-4 * 20.0, "{p} {q}");
        }
    }
    let area: f64 = triangles.iter().map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a))).sum();
    // 26.8 m of closed cracks, held open by 5.5e-5 of 20 m but at their tips.
    let held_open = 26.8 * 5.5e-5 * 20.0;
    assert!((0.8..1.05).contains(&((400.0 - area) / held_open)), "{area}");
}

/// Truth: what the guide promises. Closed cracks within a fragment that is cut at rest, one of which ends on the
/// other, and which are pressed into each other or slid: vertices within 5e-5 of the body may be merged, whatever
/// lies there.
#[test]
fn what_is_cut_at_rest_may_be_merged_by_distance() {
    let region = square(20.0);
    let scene = scene(region.clone());
    for (sink, slide) in [(0.0, 0.0), (0.05, 0.0), (0.0, 0.1), (0.02, 0.3), (-0.0005, 0.0)] {
        let crack = |rest: Vec<Point>, across: Vector, start| {
            let along = Vector::new(across.y, -across.x);
            let half = -0.5 * sink * across + 0.5 * slide * along;
            let still = |k: usize| if k + 1 == rest.len() { Vector::zeros() } else { half };
            let above: Vec<Vector> = (0..rest.len()).map(still).collect();
            let below = above.iter().map(|way| -way).collect();
            Opened { rest, above, below, start, end: CrackEnd::Tip }
        };
        let row = (0..=12).map(|k| Point::new(f64::from(k), 10.0 + 0.01 * f64::from(k * k))).collect();
        let column = (0..=6).map(|k| Point::new(6.0 + 0.1 * f64::from(k), 10.36 + f64::from(k))).collect();
        let mouth = crack(row, Vector::new(0.0, 1.0), CrackEnd::Mouth);
        let branch = crack(column, Vector::new(-1.0, 0.0), CrackEnd::Junction { crack: 0 });
        let frame = frame(&region, 3, &[mouth, branch]);
        let options = PostOptions { cut: Cut::Rest, ..options(&scene) };
        let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
        for mesh in &meshes {
            assert_eq!(mergeable(mesh, 5e-5 * 20.0), None, "{sink} {slide}");
        }
    }
}

/// Truth: by hand. A zigzag that cuts a square in two: smoothed, it keeps the areas of both halves and their sum to the
/// grid, and its turns are a fraction of what they were.
#[test]
fn smoothed_walls_match() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let rest: Vec<Point> = (0..=80).map(|i| Point::new(0.25 * f64::from(i), 10.0 + 0.1 * f64::from(i % 2))).collect();
    let crack = |opening: f64| Opened::symmetric(rest.clone(), &[opening; 81], CrackEnd::Mouth, CrackEnd::Mouth);
    for opening in [0.0, 0.01] {
        let mut frame = frame(&region, 3, &[crack(opening)]);
        frame.particles.piece = frame.particles.rest.iter().map(|x| u32::from(x.y > 10.0)).collect();
        let smooth = PostOptions { smoothing: 0.5, ..options(&scene) };
        let meshes = post_frame(&scene, &frame, &smooth).unwrap().parts.remove(0).1;
        assert_eq!(meshes.len(), 2);
        assert!((area(&meshes) - (400.0 - 20.0 * opening)).abs() < 1e-3, "{}", area(&meshes));
        let walls = meshes[0].vertices.iter().filter(|v| v.normal[2] == 0.0);
        let heights = walls.filter(|v| (9.5..10.5).contains(&v.position[1]));
        let middle = heights.filter(|v| (3.0..17.0).contains(&v.position[0])).map(|v| v.position[1]);
        let (low, high) = middle.fold((20.0_f64, 0.0_f64), |(low, high), y| (low.min(y), high.max(y)));
        assert!(high - low < 0.02, "{low} {high}");
    }
}

/// Truth: the same with all points. Both fragments have the same wall, of a third of the edges, nowhere farther off
/// than promised: so much area may go from one to the other, and none is lost.
#[test]
fn longer_walls_enclose_the_same() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let height = |x: f64| 10.0 + 2.0 * (0.3 * x).sin();
    let rest: Vec<Point> = (0..=160).map(|i| 0.125 * f64::from(i)).map(|x| Point::new(x, height(x))).collect();
    let crack = Opened::symmetric(rest, &[0.05; 161], CrackEnd::Mouth, CrackEnd::Mouth);
    let mut frame = frame(&region, 40, &[crack]);
    frame.particles = particles(&region, |p| (u32::from(p.y > height(p.x)), Vector::zeros()));
    let made = |wall_step: f64, cut: Cut| {
        let options = PostOptions { wall_step, cut, smoothing: 0.5, ..options(&scene) };
        post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1
    };
    for cut in [Cut::Opening, Cut::Rest] {
        let (all, some) = (made(0.0, cut), made(1.0, cut));
        assert_eq!((all.len(), some.len()), (2, 2));
        assert!((area(&all) - area(&some)).abs() < 1e-3, "{} {}", area(&all), area(&some));
        let apart = (area(&all[..1]) - area(&some[..1])).abs();
        assert!(apart < 0.04 * 22.0, "{apart}");
        assert!(3 * inside_triangles(&some) < inside_triangles(&all));
    }
}

#[test]
fn walls_are_smooth_below_the_crease_angle() {
    let count = 64;
    let corner = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
        Point::new(cos, sin)
    };
    let region = Region { exterior: (0..count).map(corner).collect(), holes: Vec::new() };
    let scene = scene(region.clone());
    let mesh = cracked(&scene, &frame(&region, 1, &[])).remove(0);
    let walls = || mesh.vertices.iter().filter(|v| v.normal[2] == 0.0);
    for vertex in walls() {
        let [x, y, _] = vertex.position;
        assert!((vertex.normal[0] - x).abs() < 1e-6 && (vertex.normal[1] - y).abs() < 1e-6);
    }
    // One pair of wall vertices per corner, and one more where the ring closes.
    assert_eq!(walls().count(), 2 * (count + 1));
}

/// Truth: closed form, n ~ F⁻ᵀ N. Walls along an arc stand as the arc does, within .1 degrees, however coarse its
/// chords are, and turn with the material; the side that was drawn straight is flat, up to the corners where both meet.
#[test]
fn walls_along_a_curve_have_its_normals() {
    let count = 12;
    let half = 0.5 * std::f64::consts::PI / count as f64;
    let corner = |i: usize| Point::new((2.0 * half * i as f64).cos(), (2.0 * half * i as f64).sin());
    let region = Region { exterior: (0..=count).map(corner).collect(), holes: Vec::new() };
    let mut scene = scene(region.clone());
    let straight = scene.clone();
    scene.bodies[0].turns = vec![vec![[-half, half]; count]];
    scene.bodies[0].turns[0].push([0.0; 2]);
    let stretch = nalgebra::Matrix2::new(1.002, 0.0, 0.0, 0.999);
    let moved = nalgebra::Rotation2::new(0.7).matrix() * stretch;
    let back = moved.try_inverse().unwrap();
    // Mouths are no corners of what was drawn: one is in the middle of a chord, one is beside a corner.
    let mouth = nalgebra::center(&region.exterior[4], &region.exterior[5]);
    let rest = vec![mouth, mouth - 0.1 * mouth.coords, mouth - 0.2 * mouth.coords];
    let crack = Opened::symmetric(rest, &[0.001, 0.0005, 0.0], CrackEnd::Mouth, CrackEnd::Tip);
    for cracks in [vec![], vec![crack]] {
        let mut frame = frame(&region, 5, &cracks);
        let move_on = |points: &mut Vec<Point>| points.iter_mut().for_each(|p| *p = moved * *p);
        frame.outlines.iter_mut().for_each(|outline| move_on(&mut outline.position));
        for crack in &mut frame.cracks {
            move_on(&mut crack.above);
            move_on(&mut crack.below);
        }
        move_on(&mut frame.particles.position);
        let worst = |scene: &Scene, part: Part| {
            let options = PostOptions { parts: vec![part], ..options(scene) };
            let mesh = post_frame(scene, &frame, &options).unwrap().parts.remove(0).1.remove(0);
            let used: std::collections::BTreeSet<u32> = mesh.slot(Slot::Outside).iter().flatten().copied().collect();
            let walls = used.into_iter().map(|i| mesh.vertices[i as usize]).filter(|v| v.normal[2] == 0.0);
            let (mut worst, mut corners) = (0.0_f64, 0);
            for vertex in walls {
                let [x, y, _] = vertex.position;
                let place = back * Point::new(x, y);
                let normal = (moved.transpose() * Vector::new(vertex.normal[0], vertex.normal[1])).normalize();
                let is_flat = place.y.abs() < 1e-6 && normal.y < -0.5;
                corners += usize::from(place.y.abs() < 1e-6 && !is_flat);
                let truth = if is_flat { -Vector::y() } else { place.coords.normalize() };
                worst = worst.max(normal.perp(&truth).atan2(normal.dot(&truth)).abs().to_degrees());
            }
            (worst, corners)
        };
        for part in [Part::Cracked, Part::Body] {
            let (found, corners) = worst(&scene, part);
            assert!(found < 0.1, "{found} degrees, {part:?}, {} cracks", cracks.len());
            // Two vertices at each end of the straight side stand on the arc.
            assert_eq!(corners, 4);
            assert!(worst(&straight, part).0 > 3.0);
        }
    }
}

#[test]
fn damaged_frames_are_refused() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let good = frame(&region, 1, &[edge_crack(20.0, 0.1)]);
    let refused = |change: &dyn Fn(&mut Frame)| {
        let mut bad = good.clone();
        change(&mut bad);
        let error = post_frame(&scene, &bad, &options(&scene)).unwrap_err();
        assert!(matches!(error, PostError::Inconsistent { frame: 1, .. }), "{error}");
    };
    refused(&|f| f.outlines[0].position[2].x = f64::NAN);
    refused(&|f| f.cracks[0].body = 3);
    refused(&|f| f.cracks[0].above.truncate(2));
    refused(&|f| f.particles.piece.truncate(2));
    let mut stray = good.clone();
    stray.cracks[0].rest[2].x = -9e307;
    assert!(matches!(post_frame(&scene, &stray, &options(&scene)), Err(PostError::TooFar { frame: 1, .. })));
    let mut thin = options(&scene);
    thin.thickness = 0.0;
    assert!(matches!(post_frame(&scene, &good, &thin), Err(PostError::Option { name: "thickness", .. })));
}

#[test]
fn all_parts_of_a_scene() {
    use fissure_scene::{Collider, ColliderShape, Contact, Pose};
    let region = square(20.0);
    let mut scene = scene(region.clone());
    let pose = Pose { position: Point::new(1.0, -2.0), angle: 0.4 };
    let shapes = [
        ColliderShape::HalfPlane { normal: Vector::new(0.0, 1.0) },
        ColliderShape::Disc { radius: 2.0 },
        ColliderShape::Box { half_extents: Vector::new(3.0, 0.5) },
        ColliderShape::Polygon { ring: square(1.0).exterior },
    ];
    for shape in shapes {
        let later = Pose { position: pose.position + Vector::new(0.0, 6.0), angle: 0.4 };
        let (keyframes, contact) = (vec![(0.0, pose), (2.0, later)], Contact::Stick);
        scene.colliders.push(Collider { name: "floor.1".into(), shape, keyframes, contact, friction: 0.0 });
    }
    let mut frame = frame(&region, 1, &[edge_crack(20.0, 0.1)]);
    frame.colliders = vec![pose; 4];
    let mut options = options(&scene);
    options.parts = vec![Part::Cracked, Part::Body, Part::Faces, Part::Collider, Part::Particles];
    let parts = post_frame(&scene, &frame, &options).unwrap().parts;
    let part = |i: usize| &parts[i].1;

    // The outline keeps its notch of 0.1 at the mouth only as the edge between the two tracers.
    assert!((area(part(1)) - 400.0).abs() < 1e-4);
    assert_eq!(part(2)[0].slot(Slot::Inside).len(), 2 * 2 * 4);
    let disc = &part(3)[1];
    assert_eq!(disc.name, "floor_1_collider_0001");
    assert!((area(std::slice::from_ref(disc)) - 4.0 * std::f64::consts::PI).abs() < 0.01);
    assert!((area(&part(3)[2..3]) - 6.0).abs() < 1e-4);
    assert!(part(3)[2].vertices.iter().all(|v| (v.velocity[1] - 3.0).abs() < 1e-12));
    // No corner of the floor is above its surface, which passes through the origin of the collider.
    let normal = nalgebra::Rotation2::new(0.4) * Vector::new(0.0, 1.0);
    let height = |v: &Vertex| (Point::new(v.position[0], v.position[1]) - pose.position).dot(&normal);
    let heights: Vec<f64> = part(3)[0].vertices.iter().map(height).collect();
    assert!(heights.iter().all(|h| *h < 1e-4) && heights.iter().any(|h| *h > -1e-4));
    assert_eq!(part(4)[0].vertices.len(), 400);
}

/// A random crack: where it runs, how its faces move (from 1e-9 to 0.1 m, opening, closing or sliding), what its ends
/// are.
fn random_crack() -> impl Strategy<Value = Opened> {
    let ends = prop_oneof![Just(0), Just(1), Just(2)];
    let motion = (-9.0..-1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64);
    (ends, 0.02..0.98_f64, 0.02..0.98_f64, proptest::collection::vec((motion, -1.0..1.0_f64), 2..12)).prop_map(
        |(ends, y0, y1, points)| {
            let size = 20.0;
            let (x0, x1) = [(0.0, 1.0), (0.0, 0.7), (0.2, 0.7)][ends];
            let (start, end) =
                [(CrackEnd::Mouth, CrackEnd::Mouth), (CrackEnd::Mouth, CrackEnd::Tip), (CrackEnd::Tip, CrackEnd::Tip)]
                    [ends];
            let last = points.len() - 1;
            let (mut rest, mut above, mut below) = (Vec::new(), Vec::new(), Vec::new());
            for (i, ((exponent, normal, slide), wander)) in points.into_iter().enumerate() {
                let s = i as f64 / last as f64;
                let wander = if i == 0 || i == last { 0.0 } else { 0.02 * wander };
                rest.push(Point::new(size * (x0 + s * (x1 - x0)), size * (y0 + s * (y1 - y0) + wander)));
                // Parts of a body that is cut through stay apart, so that they cover what they have.
                let (slide, normal) = if ends == 0 { (0.0, normal.abs()) } else { (slide, normal) };
                let moved = 10.0_f64.powf(exponent) * Vector::new(slide, normal);
                above.push(moved);
                below.push(-moved);
            }
            Opened { rest, above, below, start, end }
        },
    )
}

/// Area of the solids against brute force where no two cracks cross; `post_frame` itself checks that they are solids.
fn agrees_with_brute_force(cracks: &[Opened]) -> Result<(), String> {
    let region = square(20.0);
    let scene = scene(region.clone());
    let frame = frame(&region, 3, cracks);
    post_frame(&scene, &frame, &options(&scene)).map_err(|e| e.to_string())?;
    let exact = PostOptions { shortest_edge: 0.0, ..options(&scene) };
    let meshes = post_frame(&scene, &frame, &exact).map_err(|e| e.to_string())?.parts.remove(0).1;
    let crosses =
        |(i, c): (usize, &Opened)| cracks[..i].iter().any(|d| find_crossing(&[&c.rest, &d.rest], false).is_some());
    if cracks.iter().enumerate().any(crosses) {
        // What they close off together may overlap.
        return Ok(());
    }
    let (found, expected) = (area(&meshes), brute_force_area(&frame));
    // Snapping moves each side by half a step (2⁻²⁰ m), filled slivers are two steps wide, the longest contours have
    // 200 m.
    let tolerance = 200.0 * 2.5 * 2.0_f64.powi(-19);
    if (found - expected).abs() < tolerance { Ok(()) } else { Err(format!("area {found} instead of {expected}")) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn random_cracks_leave_solids(cracks in proptest::collection::vec(random_crack(), 1..4)) {
        agrees_with_brute_force(&cracks).map_err(TestCaseError::fail)?;
    }
}

/// Settings that widen cracks by so much.
fn widened(scene: &Scene, factor: f64, least: f64, falloff: f64) -> PostOptions {
    let factor = Curve { points: vec![(0.0, factor)] };
    PostOptions { opening: Some(OpeningSettings { factor, least, falloff }), shortest_edge: 0.0, ..options(scene) }
}

/// Truth: a part is not more than the whole. Four cracks cut out a crumb; shown wider than it is, so that its faces
/// pass each other, they leave no more of it than there is.
#[test]
fn crumbs_between_wide_cracks_do_not_grow() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let places = [0.0, 3.0, 6.0, 9.0, 10.0, 11.0, 14.0, 17.0, 20.0];
    let across = |y: f64| places.iter().map(|&x| Point::new(x, y)).collect::<Vec<_>>();
    let up = |x: f64| [9.0, 10.0, 11.0].map(|y| Point::new(x, y)).to_vec();
    let lines = [across(9.0), across(11.0), up(9.0), up(11.0)];
    let ends = [CrackEnd::Mouth, CrackEnd::Mouth];
    let junctions = [CrackEnd::Junction { crack: 0 }, CrackEnd::Junction { crack: 1 }];
    let opened = |(rest, [start, end]): (Vec<Point>, [CrackEnd; 2])| {
        let opening = vec![0.2; rest.len()];
        Opened::symmetric(rest, &opening, start, end)
    };
    let cracks: Vec<Opened> = lines.into_iter().zip([ends, ends, junctions, junctions]).map(opened).collect();
    let mut frame = frame(&region, 5, &cracks);
    let piece = |x: Point| {
        let column = if x.x < 9.0 { 0 } else { 1 + u32::from(x.x > 11.0) };
        if x.y < 9.0 {
            3
        } else if x.y > 11.0 {
            4
        } else {
            column
        }
    };
    frame.particles.piece = frame.particles.rest.iter().map(|&x| piece(x)).collect();
    let of_crumb = |factor: f64| {
        let made = post_frame(&scene, &frame, &widened(&scene, factor, 0.0, 1.0)).unwrap().parts.remove(0).1;
        made.into_iter().filter(|mesh| mesh.piece == 1).map(|mesh| area(std::slice::from_ref(&mesh))).sum::<f64>()
    };
    let plain = of_crumb(1.0);
    for factor in [2.0, 6.0, 30.0] {
        let shown = of_crumb(factor);
        assert!(plain > 3.0 && shown <= plain * (1.0 + 1e-9), "{shown} of {plain} with {factor}");
    }
}

/// Truth: the area of the widths that the settings ask for, along a straight crack from an edge.
#[test]
fn a_widened_crack_takes_the_area_that_was_asked_for() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let rest: Vec<Point> = (0..=40).map(|i| Point::new(0.25 * f64::from(i), 10.0)).collect();
    let opening: Vec<f64> = rest.iter().map(|p| 0.04 * (10.0 - p.x)).collect();
    let crack = Opened::symmetric(rest.clone(), &opening, CrackEnd::Mouth, CrackEnd::Tip);
    let frame = frame(&region, 4, &[crack]);
    for (factor, least) in [(1.0, 0.0), (0.0, 0.0), (3.0, 0.0), (1.0, 0.3), (2.5, 0.3)] {
        let options = widened(&scene, factor, least, 4.0);
        let found = area(&post_frame(&scene, &frame, &options).unwrap().parts[0].1);
        let width = |i: usize| factor * opening[i].max(least * ((10.0 - rest[i].x) / 4.0).clamp(0.0, 1.0).sqrt());
        let taken: f64 = (0..40).map(|i| 0.125 * (width(i) + width(i + 1))).sum();
        // Snapping moves each side by half a step.
        let found = 400.0 - found;
        assert!((found - taken).abs() < 1e-4, "{factor}, {least}: {found} for {taken}");
    }
}

/// Truth: the volume, and the way of each half from the middle of both.
#[test]
fn fragments_shown_apart_keep_their_shape() {
    let (scene, frame) = halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]);
    let apart = PostOptions { explode: Some(Curve { points: vec![(0.0, 0.5)] }), ..options(&scene) };
    let (still, moved) = (cracked(&scene, &frame), post_frame(&scene, &frame, &apart).unwrap().parts.remove(0).1);
    let middle = Vector::new(5.0 + 15.0 + 3.0, 10.0 + 10.0 + 0.5) / 2.0;
    let way = |own: Vector| 0.5 * (own - middle);
    let ways = [way(Vector::new(5.0, 10.0)), way(Vector::new(18.0, 10.5))];
    for ((before, after), way) in still.iter().zip(&moved).zip(ways) {
        assert_eq!(before.triangles, after.triangles);
        for (p, q) in before.vertices.iter().zip(&after.vertices) {
            let found = Vector::new(q.position[0] - p.position[0], q.position[1] - p.position[1]);
            assert!((found - way).norm() < 1e-5, "{found} instead of {way}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// However wide, `post_frame` finds that all are solids, and no wall is shaded as if it stood across.
    #[test]
    fn random_cracks_of_any_width_leave_solids(
        cracks in proptest::collection::vec(random_crack(), 1..4),
        factor in 0.0..6.0_f64, least in 0.0..2.0_f64, falloff in 0.1..9.0_f64, explode in 0.0..3.0_f64,
    ) {
        let region = square(20.0);
        let scene = scene(region.clone());
        let explode = Some(Curve { points: vec![(0.0, explode)] });
        let options = PostOptions { explode, ..widened(&scene, factor, least, falloff) };
        let made = post_frame(&scene, &frame(&region, 3, &cracks), &options);
        let meshes = made.map_err(|e| TestCaseError::fail(e.to_string()))?.parts.remove(0).1;
        for mesh in &meshes {
            for corners in mesh.slot(Slot::Inside).iter().map(|t| t.map(|i| mesh.vertices[i as usize])) {
                let [a, b, c] = corners.map(|corner| nalgebra::Vector3::from(corner.position));
                let facing = (b - a).cross(&(c - a));
                for corner in corners {
                    let normal = nalgebra::Vector3::from(corner.normal);
                    prop_assert!(normal.dot(&facing) > 0.7 * facing.norm(), "{:?} on a wall that faces {:?}", normal, facing);
                }
            }
        }
    }
}

/// The same at length: `cargo test -p fissure-post --test solids -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn thousands_of_random_cracks_leave_solids() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let cases = 5000;
    let failures: Vec<String> = (0..cases)
        .filter_map(|_| {
            let cracks = proptest::collection::vec(random_crack(), 1..4).new_tree(&mut runner).unwrap().current();
            agrees_with_brute_force(&cracks).err()
        })
        .collect();
    assert!(failures.is_empty(), "{} of {cases} failed, the first: {}", failures.len(), failures[0]);
}

/// Truth: by hand. A square whose corner was torn over to the inside, with the points beside it, while its particles
/// stay: the cut at rest follows these there, without folds, and all other points stay where they are told to be; one
/// whose outline within has come past its own layers of triangles makes room.
#[test]
fn the_cut_at_rest_unfolds_what_has_turned_over() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let options = PostOptions { cut: Cut::Rest, ..options(&scene) };
    type Moves = fn(Point) -> Point;
    let moves: [(&str, Moves); 3] = [
        ("corner", |p| if p.x + p.y < 0.9 { Point::new(1.5 - p.x, 1.5 - p.y) } else { p }),
        ("ear", |p| if p == Point::new(0.0, 0.0) { Point::new(0.4, 0.4) } else { p }),
        ("pressed", |p| if p.y < 1.3 { Point::new(p.x, 1.2 + p.y / 13.0) } else { p }),
    ];
    for (name, moved) in moves {
        let mut frame = frame(&region, 40, &[]);
        for outline in &mut frame.outlines {
            outline.position = outline.rest.iter().copied().map(moved).collect();
        }
        let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
        let triangles = front(&meshes);
        let folded = triangles.iter().filter(|[a, b, c]| (b - a).perp(&(c - a)) <= 0.0).count();
        assert_eq!(folded, 0, "{name}");
        let is_shown = |p: Point| triangles.iter().flatten().any(|q| (p - q).norm() < 1e-5);
        let stays = |p: &&Point| name == "pressed" || p.x + p.y > 3.0;
        assert!(frame.outlines[0].position.iter().filter(stays).all(|p| is_shown(*p)), "{name}");
    }
}

/// Truth: by hand. A zigzag on which a straight crack ends in one of its points: the end stays on the path when this is
/// made smooth, so that what is cut at rest can be cut there: the same triangles however the parts move.
#[test]
fn smooth_paths_keep_what_ends_on_them() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let zigzag: Vec<Point> =
        (0..=40).map(|k| Point::new(0.5 * f64::from(k), 10.0 + if k % 2 == 0 { 0.0 } else { 0.3 })).collect();
    let on = zigzag[15];
    let branch: Vec<Point> = (0..8).map(|k| on + f64::from(k) * Vector::new(0.1, -1.0)).collect();
    let zeros = |rest: &Vec<Point>| vec![0.0; rest.len()];
    let cracks = [
        Opened::symmetric(zigzag.clone(), &zeros(&zigzag), CrackEnd::Mouth, CrackEnd::Mouth),
        Opened::symmetric(branch.clone(), &zeros(&branch), CrackEnd::Junction { crack: 0 }, CrackEnd::Tip),
    ];
    let mut frame = frame(&region, 3, &cracks);
    frame.particles = particles(&region, |p| (u32::from(p.y < 10.15), Vector::zeros()));
    let options = PostOptions { smoothing: 0.5, cut: Cut::Rest, ..options(&scene) };
    let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
    let ends = |mesh: &Mesh| mesh.vertices.iter().any(|v| (v.position[0] - on.x).hypot(v.position[1] - on.y) < 2e-3);
    assert!(meshes.len() == 2 && meshes.iter().all(ends), "{}", meshes.len());
    // The branch is held open by 5.5e-5 of 20 m.
    assert!((area(&meshes) - 400.0).abs() < 1e-2);
    let folded = front(&meshes).into_iter().filter(|[a, b, c]| (b - a).perp(&(c - a)) <= 0.0).count();
    assert_eq!(folded, 0);
}

/// Truth: by hand. A dovetail is drawn out of its other half, through it, over 60 frames: shown apart, each half goes
/// on from frame to frame by no more than the factor times what it moved.
#[test]
fn fragments_shown_apart_do_not_jump() {
    let region = square(20.0);
    let path = [(10.0, 0.0), (10.0, 8.0), (6.0, 6.0), (6.0, 14.0), (10.0, 12.0), (10.0, 20.0)];
    let rest: Vec<Point> = path.iter().map(|&(x, y)| Point::new(x, y)).collect();
    let is_right = |p: Point| {
        let edge = if (6.0..=14.0).contains(&p.y) { 6.0 } else { 10.0 };
        p.x > edge
    };
    let scene = scene(region.clone());
    let factor = 0.5;
    let apart = Curve { points: vec![(0.0, factor)] };
    let mut before: Option<Vec<Vector>> = None;
    for step in 0..60 {
        let shift = Vector::new(0.2 * f64::from(step), 0.0);
        let still = vec![Vector::zeros(); rest.len()];
        let below = vec![shift; rest.len()];
        let (start, end) = (CrackEnd::Mouth, CrackEnd::Mouth);
        let mut frame = frame(&region, 3, &[Opened { rest: rest.clone(), above: still, below, start, end }]);
        for outline in &mut frame.outlines {
            for (position, rest) in outline.position.iter_mut().zip(&outline.rest) {
                *position += if rest.x > 10.0 { shift } else { Vector::zeros() };
            }
        }
        frame.particles =
            particles(&region, |p| (u32::from(is_right(p)), if is_right(p) { shift } else { Vector::zeros() }));
        let middle = |options: &PostOptions| -> Vec<Vector> {
            let meshes = post_frame(&scene, &frame, options).unwrap().parts.remove(0).1;
            let mean = |mesh: &Mesh| {
                let sum: Vector = mesh.vertices.iter().map(|v| Vector::new(v.position[0], v.position[1])).sum();
                sum / mesh.vertices.len() as f64
            };
            meshes.iter().map(mean).collect()
        };
        let (plain, moved) = (options(&scene), PostOptions { explode: Some(apart.clone()), ..options(&scene) });
        let offsets: Vec<Vector> = middle(&moved).iter().zip(middle(&plain)).map(|(a, b)| a - b).collect();
        assert_eq!(offsets.len(), 2);
        for (now, before) in offsets.iter().zip(before.iter().flatten()) {
            assert!((now - before).norm() <= factor * 0.2 + 1e-3, "{step}: {before} {now}");
        }
        before = Some(offsets);
    }
}
