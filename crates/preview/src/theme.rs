//! Light and dark.

/// Light or dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// For white pages.
    #[default]
    Light,
    /// For dark pages.
    Dark,
}

impl Theme {
    /// Behind everything.
    pub(crate) fn background(self) -> [u8; 3] {
        match self {
            Self::Light => [255, 255, 255],
            Self::Dark => [24, 26, 30],
        }
    }

    /// Letters, scale bar and marks.
    pub(crate) fn ink(self) -> [u8; 3] {
        match self {
            Self::Light => [40, 44, 52],
            Self::Dark => [226, 230, 236],
        }
    }

    /// Edges of the front faces.
    pub(crate) fn edge(self) -> [u8; 3] {
        match self {
            Self::Light => [96, 110, 128],
            Self::Dark => [14, 15, 18],
        }
    }

    /// Crack walls, seen in full light.
    pub(crate) fn wall(self) -> [u8; 3] {
        [237, 107, 48]
    }

    /// Lines along cracks.
    pub(crate) fn crack(self) -> [u8; 3] {
        match self {
            Self::Light => [140, 51, 18],
            Self::Dark => [255, 140, 82],
        }
    }

    /// Live tips.
    pub(crate) fn tip(self) -> [u8; 3] {
        match self {
            Self::Light => [200, 20, 40],
            Self::Dark => [255, 90, 90],
        }
    }

    /// Edges of inclusions.
    pub(crate) fn inclusion(self) -> [u8; 3] {
        match self {
            Self::Light => [41, 77, 133],
            Self::Dark => [120, 170, 240],
        }
    }

    /// Colliders, seen in full light.
    pub(crate) fn collider(self) -> [u8; 3] {
        match self {
            Self::Light => [158, 158, 158],
            Self::Dark => [92, 94, 100],
        }
    }

    /// A fragment, seen in full light: number 0 is the body before it breaks; others differ from their neighbours in
    /// number by the golden angle.
    pub(crate) fn fragment(self, piece: u32) -> [u8; 3] {
        let (saturation, lightness) = match self {
            Self::Light => (0.45, 0.78),
            Self::Dark => (0.35, 0.60),
        };
        if piece == 0 {
            return match self {
                Self::Light => [190, 205, 220],
                Self::Dark => [128, 144, 162],
            };
        }
        let golden = 0.5 * (3.0 - 5.0_f64.sqrt());
        from_hsl((f64::from(piece) * golden + 0.05).fract(), saturation, lightness)
    }
}

/// A colour by hue, saturation and lightness, each from 0 to 1.
fn from_hsl(hue: f64, saturation: f64, lightness: f64) -> [u8; 3] {
    let reach = saturation * lightness.min(1.0 - lightness);
    [0.0, 8.0, 4.0].map(|channel| {
        let place = (channel + hue * 12.0) % 12.0;
        let value = lightness - reach * (place - 3.0).min(9.0 - place).clamp(-1.0, 1.0);
        (255.0 * value).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the corners of the colour wheel.
    #[test]
    fn hues_are_those_of_the_wheel() {
        let wheel = [[255, 0, 0], [255, 255, 0], [0, 255, 0], [0, 255, 255], [0, 0, 255], [255, 0, 255]];
        for (i, color) in wheel.into_iter().enumerate() {
            assert_eq!(from_hsl(i as f64 / 6.0, 1.0, 0.5), color);
        }
        assert_eq!(from_hsl(0.3, 0.0, 0.2), [51; 3]);
    }
}
