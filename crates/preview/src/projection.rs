//! From where a scene is seen, and where its places are in the picture.

use nalgebra::Vector3;

/// From where a scene is seen: a parallel projection.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct View {
    /// Turn about the upright axis, positive to see more of the left side [rad]; between a right angle to either side.
    pub yaw: f64,
    /// Height of the eye above the middle [rad]; between a right angle down and up.
    pub pitch: f64,
}

/// Axes of the picture in the world: x, y of the drawing, z towards the viewer of a drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axes {
    right: Vector3<f64>,
    up: Vector3<f64>,
    /// Towards the eye.
    toward: Vector3<f64>,
}

impl From<View> for Axes {
    fn from(view: View) -> Self {
        let (sin_yaw, cos_yaw) = view.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = view.pitch.sin_cos();
        Self {
            right: Vector3::new(cos_yaw, 0.0, sin_yaw),
            up: Vector3::new(sin_pitch * sin_yaw, cos_pitch, -sin_pitch * cos_yaw),
            toward: Vector3::new(-cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw),
        }
    }
}

impl Axes {
    /// Right, up and towards the eye [m].
    pub(crate) fn place(&self, position: [f64; 3]) -> [f64; 3] {
        let position = Vector3::from(position);
        [self.right.dot(&position), self.up.dot(&position), self.toward.dot(&position)]
    }

    /// A direction of the world seen from the eye; its last component is the share that points towards the eye.
    pub(crate) fn direction(&self, direction: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(self.right.dot(&direction), self.up.dot(&direction), self.toward.dot(&direction))
    }
}

/// Where places of the world are in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Projection {
    pub(crate) axes: Axes,
    /// Pixels per metre.
    pub(crate) scale: f64,
    /// What is seen in the middle, right and up [m].
    pub(crate) center: [f64; 2],
    /// Where the middle is [pixels].
    pub(crate) middle: [f64; 2],
}

impl Projection {
    /// Pixels from the left and from the top, and the depth, larger towards the eye [pixels].
    pub(crate) fn pixel(&self, position: [f64; 3]) -> [f64; 3] {
        let [right, up, toward] = self.axes.place(position);
        [
            self.middle[0] + self.scale * (right - self.center[0]),
            self.middle[1] - self.scale * (up - self.center[1]),
            self.scale * toward,
        ]
    }

    /// The place x, y of the plane at height `z` that is seen at a pixel: the inverse of [`Projection::pixel`].
    pub(crate) fn plane(&self, pixel: [f64; 2], z: f64) -> [f64; 2] {
        let right = self.center[0] + (pixel[0] - self.middle[0]) / self.scale;
        let up = self.center[1] - (pixel[1] - self.middle[1]) / self.scale;
        // right·p and up·p are two equations for x and y; the first has no y.
        let Axes { right: r, up: u, .. } = self.axes;
        let x = (right - r.z * z) / r.x;
        [x, (up - u.z * z - u.x * x) / u.y]
    }

    /// The same in a picture of `factor` times as many pixels each way.
    pub(crate) fn enlarged(&self, factor: f64) -> Self {
        Self { scale: self.scale * factor, middle: self.middle.map(|m| m * factor), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed_and_the_plane_comes_back() {
        for (yaw, pitch) in [(0.0, 0.0), (-0.4, 0.3), (1.2, -0.9), (0.7, 1.1)] {
            let axes = Axes::from(View { yaw, pitch });
            assert!((axes.right.cross(&axes.up) - axes.toward).norm() < 1e-15);
            assert!((axes.right.norm() - 1.0).abs() < 1e-15 && axes.right.dot(&axes.up).abs() < 1e-15);
            let projection = Projection { axes, scale: 37.0, center: [0.3, -0.2], middle: [200.0, 100.0] };
            let [x, y, _] = projection.pixel([1.5, -0.7, 0.2]);
            let [back_x, back_y] = projection.plane([x, y], 0.2);
            assert!((back_x - 1.5).abs() < 1e-12 && (back_y + 0.7).abs() < 1e-12);
        }
    }

    #[test]
    fn a_view_from_above_and_the_left_shows_top_and_left_faces() {
        let axes = Axes::from(View { yaw: 0.4, pitch: 0.3 });
        assert!(axes.direction(-Vector3::x()).z > 0.0 && axes.direction(Vector3::y()).z > 0.0);
        assert!(axes.direction(Vector3::z()).z > 0.0);
    }
}
