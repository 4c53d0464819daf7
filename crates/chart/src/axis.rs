//! Axes: from values to places, and where their ticks are.

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithm; values that are not above 0 have no place.
    Logarithmic,
}

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// What it shows, with its unit. Upwards none: without ticks.
    pub label: String,
    /// Its scale.
    pub scale: Scale,
    /// Values are parts of one, and are shown in percent.
    pub percent: bool,
    /// Least and greatest value; none: those of what is drawn.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis over what is drawn.
    pub fn linear(label: &str) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis over what is drawn.
    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic, ..Self::default() }
    }

    /// The same, its values shown in percent.
    #[must_use]
    pub fn in_percent(self) -> Self {
        Self { percent: true, ..self }
    }
}

/// An axis laid over a length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ruler {
    scale: Scale,
    percent: bool,
    low: f64,
    high: f64,
    /// Where `low` and `high` are drawn.
    ends: (f64, f64),
}

impl Ruler {
    /// `axis` from `ends.0` to `ends.1`, wide enough for `values`.
    pub(crate) fn new(axis: &Axis, values: impl Iterator<Item = f64>, ends: (f64, f64)) -> Self {
        let is_shown = |x: &f64| x.is_finite() && (axis.scale == Scale::Linear || *x > 0.0);
        let (mut low, mut high) = axis.range.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
        if axis.range.is_none() {
            for value in values.filter(is_shown) {
                (low, high) = (low.min(value), high.max(value));
            }
            if low > high {
                (low, high) = (1.0, 10.0);
            }
            match axis.scale {
                Scale::Linear => {
                    low = low.min(0.0);
                    high += 0.05 * (high - low).max(f64::MIN_POSITIVE);
                }
                Scale::Logarithmic => (low, high) = (low / 1.3, high * 1.3),
            }
        }
        Self { scale: axis.scale, percent: axis.percent, low, high, ends }
    }

    /// Where a value is drawn; none: it has no place on this axis.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        let map = |x: f64| if self.scale == Scale::Logarithmic { x.ln() } else { x };
        let part = (map(value) - map(self.low)) / (map(self.high) - map(self.low));
        let is_inside = (-1e-9..=1.0 + 1e-9).contains(&part);
        is_inside.then_some(self.ends.0 + part * (self.ends.1 - self.ends.0))
    }

    /// Values that have a tick, each with its word: at most some eight.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let values = match self.scale {
            Scale::Linear => linear_ticks(self.low, self.high),
            Scale::Logarithmic => logarithmic_ticks(self.low, self.high),
        };
        values.into_iter().map(|value| (value, self.word(value))).collect()
    }

    fn word(&self, value: f64) -> String {
        if self.percent { format!("{} %", word(100.0 * value)) } else { word(value) }
    }
}

/// Round values between two bounds: multiples of 1, 2 or 5 of a power of ten.
fn linear_ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|&s| s >= rough).unwrap_or(rough);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

/// Powers of ten between two bounds, with 2 and 5 times each where they are few.
fn logarithmic_ticks(low: f64, high: f64) -> Vec<f64> {
    let decades = (high / low).log10();
    let of_decade: &[f64] = match decades {
        d if d < 2.0 => &[1.0, 2.0, 5.0],
        d if d < 4.0 => &[1.0, 3.0],
        _ => &[1.0],
    };
    let every = (decades / 8.0).ceil().max(1.0) as i32;
    let powers = (low.log10().floor() as i32..=high.log10().ceil() as i32).filter(|p| p % every == 0);
    let all = powers.flat_map(|p| of_decade.iter().map(move |m| m * 10.0_f64.powi(p)));
    all.filter(|v| (low..=high).contains(v)).collect()
}

/// A number as people write it on an axis.
pub fn word(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".into()
    } else if !(1e-3..1e6).contains(&magnitude) {
        let exponent = magnitude.log10().floor();
        let digits = format!("{:.2}", value / 10.0_f64.powf(exponent));
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        format!("{digits}e{exponent}")
    } else {
        let text = format!("{value:.4}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: worked out by hand; the ends and the geometric middle of a logarithmic axis, and what it cannot show.
    #[test]
    fn values_have_their_places() {
        let axis = Axis { range: Some((0.01, 100.0)), ..Axis::logarithmic("x") };
        let ruler = Ruler::new(&axis, std::iter::empty(), (50.0, 450.0));
        for (value, place) in [(0.01, 50.0), (1.0, 250.0), (100.0, 450.0)] {
            assert!(ruler.place(value).is_some_and(|x| (x - place).abs() < 1e-9), "{value}");
        }
        for nowhere in [0.0, -1.0, 1e3, f64::NAN] {
            assert_eq!(ruler.place(nowhere), None);
        }
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(linear_ticks(0.0, 9.3), [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(logarithmic_ticks(0.6, 30.0), [1.0, 2.0, 5.0, 10.0, 20.0]);
        for (low, high) in [(1e-9, 1e9), (0.3, 0.4), (1e3, 4e6), (0.9, 1.1)] {
            assert!(logarithmic_ticks(low, high).len() <= 9 && linear_ticks(low, high).len() <= 9, "{low} {high}");
        }
        let words = [0.0, 0.5, 20.0, 1e-4, 2.5e6, 1000.0].map(word);
        assert_eq!(words, ["0", "0.5", "20", "1e-4", "2.5e6", "1000"]);
    }
}
