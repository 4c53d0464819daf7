//! Area of the places that closed polygons wind around at least once, by brute force.

use fissure_scene::Point;

/// Cuts the plane into horizontal slabs at every corner and crossing; in each slab the edges are ordered from left to
/// right and the winding number is summed up. Cubic in the number of edges, shares nothing with the engine under test.
pub(crate) fn covered_area(polygons: &[Vec<Point>]) -> f64 {
    let edges: Vec<(Point, Point)> = polygons
        .iter()
        .flat_map(|ring| (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()])))
        .filter(|(a, b)| a.y != b.y)
        .collect();
    let mut heights: Vec<f64> = polygons.iter().flatten().map(|p| p.y).collect();
    for (i, &(a, b)) in edges.iter().enumerate() {
        for &(c, d) in &edges[..i] {
            let (r, s, q) = (b - a, d - c, c - a);
            let cross = r.x * s.y - r.y * s.x;
            let (t, u) = ((q.x * s.y - q.y * s.x) / cross, (q.x * r.y - q.y * r.x) / cross);
            if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u) {
                heights.push(a.y + t * r.y);
            }
        }
    }
    heights.sort_by(f64::total_cmp);
    let mut area = 0.0;
    for slab in heights.windows(2).filter(|slab| slab[1] > slab[0]) {
        let middle = 0.5 * (slab[0] + slab[1]);
        let mut crossings: Vec<(f64, i32)> = edges
            .iter()
            .filter(|(a, b)| (a.y > middle) != (b.y > middle))
            .map(|(a, b)| (a.x + (b.x - a.x) * (middle - a.y) / (b.y - a.y), if b.y < a.y { 1 } else { -1 }))
            .collect();
        crossings.sort_by(|p, q| p.0.total_cmp(&q.0));
        let mut winding = 0;
        for pair in crossings.windows(2) {
            winding += pair[0].1;
            if winding > 0 {
                area += (pair[1].0 - pair[0].0) * (slab[1] - slab[0]);
            }
        }
    }
    area
}
