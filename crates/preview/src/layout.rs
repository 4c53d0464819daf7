//! Where in a picture what goes.

use crate::draw::Detail;
use crate::options::PreviewOptions;
use crate::projection::{Axes, Projection};
use crate::survey::Survey;

/// What is shown around what is in view, as a share of its larger side.
const MARGIN: f64 = 0.04;
/// Height of what is in view for its width, at least and at most.
const ASPECTS: [f64; 2] = [0.3, 1.25];

/// Where in a picture what goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Layout {
    /// Width of the picture [pixels].
    pub(crate) width: u32,
    /// Height of the picture, even, as codecs of films want it [pixels].
    pub(crate) height: u32,
    /// Height of the strip above the scene [pixels].
    pub(crate) header: f64,
    /// Height of the strip below the scene [pixels].
    pub(crate) footer: f64,
    /// Height of letters [pixels].
    pub(crate) letters: f64,
    /// Where places of the scene are.
    pub(crate) projection: Projection,
}

impl Layout {
    /// Of pictures of solids of this thickness [m].
    pub(crate) fn new(survey: &Survey, thickness: f64, options: &PreviewOptions, detail: Detail) -> Self {
        let axes = Axes::from(options.view);
        let [low, high] = survey.corners();
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in 0..8 {
            let of = |bit: u32, a: f64, b: f64| if corner & bit == 0 { a } else { b };
            let position = [of(1, low.x, high.x), of(2, low.y, high.y), of(4, -0.5, 0.5) * thickness];
            let seen = axes.place(position);
            for axis in 0..2 {
                least[axis] = least[axis].min(seen[axis]);
                most[axis] = most[axis].max(seen[axis]);
            }
        }
        let margin = 2.0 * MARGIN * (most[0] - least[0]).max(most[1] - least[1]);
        let [across, upright] = [0, 1].map(|axis| most[axis] - least[axis] + margin);
        let width = options.width;
        let letters = (f64::from(width) / 56.0).clamp(10.0, 36.0);
        let (header, footer) = match detail {
            Detail::Full => (2.2 * letters, 2.8 * letters),
            Detail::Tile => (1.8 * letters, 0.0),
        };
        let inner = f64::from(width) * (upright / across).clamp(ASPECTS[0], ASPECTS[1]);
        let height = (((header + inner + footer) / 2.0).ceil() * 2.0) as u32;
        let inner = f64::from(height) - header - footer;
        let projection = Projection {
            axes,
            scale: (f64::from(width) / across).min(inner / upright),
            center: [0, 1].map(|axis| 0.5 * (least[axis] + most[axis])),
            middle: [0.5 * f64::from(width), header + 0.5 * inner],
        };
        Self { width, height, header, footer, letters, projection }
    }
}
