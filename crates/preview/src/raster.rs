//! Triangles with a depth buffer.

/// Pixels with depths; the first row is the top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Raster {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Colours, row by row.
    pub(crate) colors: Vec<[u8; 3]>,
    depths: Vec<f32>,
}

impl Raster {
    /// All of one colour, at no depth.
    pub(crate) fn new(width: usize, height: usize, color: [u8; 3]) -> Self {
        Self { width, height, colors: vec![color; width * height], depths: vec![f32::NEG_INFINITY; width * height] }
    }

    /// Fills the pixels whose middle lies in a triangle with `color`, which is asked for each of them, where nothing
    /// nearer is there. Corners in pixels from the left and from the top, and depth, larger is nearer.
    pub(crate) fn fill(&mut self, corners: [[f64; 3]; 3], mut color: impl FnMut([f64; 2]) -> [u8; 3]) {
        let [a, b, c] = corners;
        let twice_area = side(a, b, [c[0], c[1]]);
        if !(twice_area.abs() > 0.0 && twice_area.is_finite()) {
            return;
        }
        let columns = span(corners.map(|p| p[0]), self.width);
        for row in span(corners.map(|p| p[1]), self.height) {
            for column in columns.clone() {
                let place = [column as f64 + 0.5, row as f64 + 0.5];
                let weights = [side(b, c, place), side(c, a, place), side(a, b, place)].map(|w| w / twice_area);
                if weights.iter().any(|&weight| weight < 0.0) {
                    continue;
                }
                let depth = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) as f32;
                let at = row * self.width + column;
                if depth > self.depths[at] {
                    self.depths[at] = depth;
                    self.colors[at] = color(place);
                }
            }
        }
    }
}

/// Twice the area of the triangle a, b, place; its sign tells the side.
fn side(a: [f64; 3], b: [f64; 3], place: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (place[1] - a[1]) - (b[1] - a[1]) * (place[0] - a[0])
}

/// The pixels from 0 to `count` whose middles can lie between these places.
fn span(places: [f64; 3], count: usize) -> std::ops::Range<usize> {
    let low = places.into_iter().fold(f64::INFINITY, f64::min);
    let high = places.into_iter().fold(f64::NEG_INFINITY, f64::max);
    // Numbers beyond the range of the type become its ends.
    let first = (low - 0.5).ceil().max(0.0) as usize;
    let end = ((high + 0.5).floor().max(0.0) as usize).min(count);
    first.min(end)..end
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the pixels counted one by one. A square of two triangles has each of its pixels, and no other.
    #[test]
    fn triangles_that_share_an_edge_leave_no_gap() {
        let mut raster = Raster::new(20, 12, [0; 3]);
        let (low, high) = ([3.2, 1.7], [16.9, 10.4]);
        let [a, b, c, d] = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        let deep = |p: [f64; 2]| [p[0], p[1], 1.0];
        raster.fill([a, b, c].map(deep), |_| [255; 3]);
        raster.fill([a, c, d].map(deep), |_| [255; 3]);
        for row in 0..12 {
            for column in 0..20 {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let inside = x > low[0] && x < high[0] && y > low[1] && y < high[1];
                assert_eq!(raster.colors[row * 20 + column] == [255; 3], inside, "{column} {row}");
            }
        }
    }

    #[test]
    fn the_nearer_triangle_is_seen_whichever_comes_first() {
        let near = [[0.0, 0.0, 2.0], [9.0, 0.0, 2.0], [0.0, 9.0, 2.0]];
        // Leans through the plane of the other one.
        let leaning = [[0.0, 0.0, 0.0], [9.0, 0.0, 9.0], [0.0, 9.0, 0.0]];
        let mut rasters = [Raster::new(8, 8, [0; 3]), Raster::new(8, 8, [0; 3])];
        rasters[0].fill(near, |_| [1; 3]);
        rasters[0].fill(leaning, |_| [2; 3]);
        rasters[1].fill(leaning, |_| [2; 3]);
        rasters[1].fill(near, |_| [1; 3]);
        assert_eq!(rasters[0], rasters[1]);
        assert_eq!((rasters[0].colors[0], rasters[0].colors[6]), ([1; 3], [2; 3]));
    }

    #[test]
    fn triangles_far_outside_and_without_area_are_harmless() {
        let mut raster = Raster::new(4, 4, [7; 3]);
        raster.fill([[-1e300, 0.0, 0.0], [-1e300, 5.0, 0.0], [-2e300, 0.0, 0.0]], |_| [0; 3]);
        raster.fill([[f64::NAN, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]], |_| [0; 3]);
        raster.fill([[0.0, 0.0, 0.0], [4.0, 4.0, 0.0], [2.0, 2.0, 0.0]], |_| [0; 3]);
        assert_eq!(raster.colors, [[7; 3]; 16]);
    }
}
