//! Corners within a cap that was made at rest, moved to where no triangle is folded.
//!
//! Where the material is pressed flat its particles are not where the boundary beside them leaves room. Each corner
//! around which a triangle is folded goes where the triangle around it that is smallest, against its size at rest, is
//! largest (Freitag and Plassmann, Int. J. Numer. Methods Eng. 49, 2000, 109-125): a linear program in three unknowns.

use crate::snap::{GridPoint, turn};
use fissure_scene::Point;
use rustc_hash::FxHashMap;

/// Times that all such corners are moved, at most.
const ROUNDS: usize = 40;
/// Stars of more triangles are looked at only as far as so many.
const MOST: usize = 24;

/// The triangles that are folded or flat, by their numbers.
pub(crate) fn folded(now: &[GridPoint], triangles: &[[u32; 3]]) -> Vec<usize> {
    let is_folded = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| now[corner as usize]);
        turn(a, b, c) <= 0
    };
    (0..triangles.len()).filter(|&k| is_folded(&triangles[k])).collect()
}

/// Moves corners from number `first` on so that none of `triangles` is folded, as far as that can be had. `rest`: the
/// places of all corners at rest [m].
pub(crate) fn untangle(now: &mut [GridPoint], first: usize, rest: &[Point], triangles: &[[u32; 3]]) {
    let mut bad = folded(now, triangles);
    if bad.is_empty() {
        return;
    }
    let mut stars = FxHashMap::<u32, Vec<usize>>::default();
    for (k, triangle) in triangles.iter().enumerate() {
        for &corner in triangle.iter().filter(|corner| **corner as usize >= first) {
            stars.entry(corner).or_default().push(k);
        }
    }
    for _ in 0..ROUNDS {
        let mut corners: Vec<u32> = bad.iter().flat_map(|&k| triangles[k]).filter(|c| *c as usize >= first).collect();
        corners.sort_unstable();
        corners.dedup();
        let mut moves = false;
        for corner in corners {
            if let Some(place) = best(corner, &stars[&corner], now, rest, triangles) {
                moves |= place != now[corner as usize];
                now[corner as usize] = place;
            }
        }
        bad = folded(now, triangles);
        if bad.is_empty() || !moves {
            break;
        }
    }
}

/// Where the smallest of the triangles `star` around a corner is largest, against what it is at rest; none where they
/// are none or many.
fn best(corner: u32, star: &[usize], now: &[GridPoint], rest: &[Point], triangles: &[[u32; 3]]) -> Option<GridPoint> {
    if star.len() < 3 || star.len() > MOST {
        return None;
    }
    let here = now[corner as usize];
    // Of each triangle: twice its area is c + n·x, with x the place of the corner from where it is, in grid steps.
    let mut lines = Vec::with_capacity(star.len());
    for &k in star {
        let triangle = triangles[k];
        let place = triangle.iter().position(|c| *c == corner)?;
        let [a, b] = [1, 2].map(|next| triangle[(place + next) % 3] as usize);
        let at_rest = (rest[a] - rest[corner as usize]).perp(&(rest[b] - rest[corner as usize]));
        let [p, q] = [a, b].map(|k| [(now[k].x - here.x) as f64, (now[k].y - here.y) as f64]);
        let area = p[0] * q[1] - p[1] * q[0];
        lines.push([p[1] - q[1], q[0] - p[0], at_rest, area]);
    }
    // The best place is where three of them are equally large: n·x − s·a = −c, s the least ratio.
    let mut best: Option<(f64, [f64; 2])> = None;
    for i in 0..lines.len() {
        for j in i + 1..lines.len() {
            for k in j + 1..lines.len() {
                let Some([x, y, ratio]) = solved([lines[i], lines[j], lines[k]]) else { continue };
                if best.is_some_and(|(most, _)| ratio <= most) {
                    continue;
                }
                let holds = |[u, v, at_rest, area]: &[f64; 4]| {
                    area + u * x + v * y - ratio * at_rest >= -1e-9 * (area.abs() + (ratio * at_rest).abs())
                };
                if lines.iter().all(holds) {
                    best = Some((ratio, [x, y]));
                }
            }
        }
    }
    let (_, [x, y]) = best?;
    Some(GridPoint::new(here.x + x.round() as i64, here.y + y.round() as i64))
}

/// x, y and s of u x + v y − a s = −c for three rows [u, v, a, c], after Cramer; none where they are not independent.
fn solved(rows: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    let column = |k: usize, sign: f64| nalgebra::Vector3::new(sign * rows[0][k], sign * rows[1][k], sign * rows[2][k]);
    let (u, v, a, c) = (column(0, 1.0), column(1, 1.0), column(2, -1.0), column(3, -1.0));
    let whole = u.dot(&v.cross(&a));
    if whole.abs() <= 1e-12 * u.norm() * v.norm() * a.norm() {
        return None;
    }
    Some([c.dot(&v.cross(&a)), u.dot(&c.cross(&a)), u.dot(&v.cross(&c))].map(|part| part / whole))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the middle of a star-shaped ring of triangles can see all its sides. Wherever the corner within was
        /// carried to, no triangle is folded afterwards, and the boundary stays.
        #[test]
        fn what_is_carried_beyond_the_boundary_comes_back(
            radii in proptest::collection::vec(0.3..1.0_f64, 4..12),
            flat in 0.01..1.0_f64,
            (x, y) in (-3.0..3.0_f64, -3.0..3.0_f64),
        ) {
            let count = radii.len();
            let rest: Vec<Point> = (0..=count)
                .map(|k| {
                    let (sin, cos) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
                    if k == count { Point::origin() } else { Point::new(radii[k] * cos, radii[k] * sin) }
                })
                .collect();
            let triangles: Vec<[u32; 3]> =
                (0..count as u32).map(|k| [k, (k + 1) % count as u32, count as u32]).collect();
            let mut now: Vec<GridPoint> =
                rest.iter().map(|p| GridPoint::new((1e6 * p.x) as i64, (1e6 * flat * p.y) as i64)).collect();
            let boundary = now[..count].to_vec();
            now[count] = GridPoint::new((1e6 * x) as i64, (1e6 * y) as i64);
            untangle(&mut now, count, &rest, &triangles);
            prop_assert_eq!(folded(&now, &triangles), Vec::<usize>::new());
            prop_assert_eq!(&now[..count], &boundary[..]);
        }
    }

    /// Truth: by hand. Several layers of a square that were all carried beyond its side, which has come up, find room.
    #[test]
    fn layers_that_are_pressed_flat_find_room() {
        let n = 6_u32;
        let on_rim = |i: u32, j: u32| i == 0 || j == 0 || i == n || j == n;
        let mut places: Vec<(u32, u32)> = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).collect();
        places.sort_by_key(|&(i, j)| (!on_rim(i, j), i, j));
        let first = places.iter().filter(|&&(i, j)| on_rim(i, j)).count();
        let number = |i: u32, j: u32| places.iter().position(|&p| p == (i, j)).map_or(0, |k| k as u32);
        let mut triangles = Vec::new();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| number(i, j));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        let rest: Vec<Point> = places.iter().map(|&(i, j)| Point::new(f64::from(i), f64::from(j))).collect();
        // The rim is pressed to a tenth of its height; what is within goes on down, to below the rim.
        let pressed = |&(i, j): &(u32, u32)| {
            let height = if on_rim(i, j) { 100_000 * i64::from(j) } else { -50_000 * i64::from(n - j) };
            GridPoint::new(1_000_000 * i64::from(i), height)
        };
        let mut now: Vec<GridPoint> = places.iter().map(pressed).collect();
        assert!(!folded(&now, &triangles).is_empty());
        untangle(&mut now, first, &rest, &triangles);
        assert_eq!(folded(&now, &triangles), Vec::<usize>::new());
    }
}
