//! Room between the corners of triangles at rest.
//!
//! Where two lines hardly part, their edges are divided until parts are as short as the lines are near: thousands of
//! corners that readers merge, in triangles that fold as soon as the material moves. Of those only some are kept, no
//! two of them nearer to each other than asked for, and the rest is divided again with the edges as they are.

use rustc_hash::FxHashMap;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

/// Whether corners that are not among the first `old` are nearer than `room` to others.
pub(crate) fn is_crowded(triangles: &ConstrainedDelaunayTriangulation<Point2<f64>>, old: usize, room: f64) -> bool {
    // The corner nearest to another one is at the other end of an edge.
    triangles.undirected_edges().any(|edge| {
        let is_new = edge.vertices().iter().any(|vertex| vertex.index() >= old);
        is_new && edge.length_2() < room * room
    })
}

/// The places of the corners of `triangles` without those that are nearer than `room` to one before them, which stay
/// if they are among the first `old`; and the number of each that stays.
pub(crate) fn with_room(
    triangles: &ConstrainedDelaunayTriangulation<Point2<f64>>,
    old: usize,
    room: f64,
) -> (Vec<Point2<f64>>, Vec<Option<usize>>) {
    let bin = |place: Point2<f64>| [place.x, place.y].map(|x| (x / room).floor() as i64);
    let mut bins = FxHashMap::<[i64; 2], Vec<Point2<f64>>>::default();
    let (mut places, mut numbers) = (Vec::new(), Vec::with_capacity(triangles.num_vertices()));
    for k in 0..triangles.num_vertices() {
        let place = triangles.vertex(FixedVertexHandle::from_index(k)).position();
        let [column, row] = bin(place);
        let near = (column - 1..=column + 1).flat_map(|column| (row - 1..=row + 1).map(move |row| [column, row]));
        let is_near = |other: &Point2<f64>| (other.x - place.x).hypot(other.y - place.y) < room;
        if k >= old && near.filter_map(|bin| bins.get(&bin)).flatten().any(is_near) {
            numbers.push(None);
            continue;
        }
        bins.entry([column, row]).or_default().push(place);
        numbers.push(Some(places.len()));
        places.push(place);
    }
    (places, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: all pairs. Of places anywhere the first ones stay, of the others those that have room, and each
        /// that goes is near to one that stays.
        #[test]
        fn what_stays_has_room(
            places in proptest::collection::vec((0.0..10.0_f64, 0.0..10.0_f64), 8..80), old in 3_usize..8, room in 0.1..3.0_f64,
        ) {
            let places: Vec<_> = places.into_iter().map(|(x, y)| Point2::new(x, y)).collect();
            let mut triangles = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
            for place in places {
                prop_assert!(triangles.insert(place).is_ok());
            }
            let at = |k: usize| triangles.vertex(FixedVertexHandle::from_index(k)).position();
            let near = |p: Point2<f64>, q: Point2<f64>| (p.x - q.x).hypot(p.y - q.y) < room;
            let (kept, numbers) = with_room(&triangles, old, room);
            let mut crowded = false;
            for (k, number) in numbers.iter().enumerate() {
                let others = || (0..numbers.len()).filter(|&j| j != k && near(at(j), at(k)));
                crowded |= k >= old && others().next().is_some();
                match number {
                    Some(number) => {
                        prop_assert_eq!(kept[*number], at(k));
                        prop_assert!(k < old || !others().any(|j| j < k && numbers[j].is_some()));
                    }
                    None => prop_assert!(k >= old && others().any(|j| numbers[j].is_some())),
                }
            }
            prop_assert_eq!(is_crowded(&triangles, old, room), crowded);
        }
    }
}
