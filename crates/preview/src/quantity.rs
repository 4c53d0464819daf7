//! Numbers with units, for people.

/// Prefixes of units and their powers of ten.
const PREFIXES: [(i32, &str); 9] =
    [(12, "T"), (9, "G"), (6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "µ"), (-9, "n"), (-12, "p")];

/// `value` with three digits and the prefix of `unit` that reads best; zero without a prefix.
pub(crate) fn quantity(value: f64, unit: &str) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value} {unit}");
    }
    // Rounded first, so that 999.9 becomes 1.00 k and not 1000.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let power = rounded.abs().log10().floor() as i32;
    let fitting = PREFIXES.iter().find(|(of_prefix, _)| power >= *of_prefix);
    let (of_prefix, prefix) = fitting.copied().unwrap_or(PREFIXES[PREFIXES.len() - 1]);
    let decimals = (2 - (power - of_prefix)).clamp(0, 2) as usize;
    format!("{:.decimals$} {prefix}{unit}", rounded / 10.0_f64.powi(of_prefix))
}

/// The same without zeros at the end.
pub(crate) fn short_quantity(value: f64, unit: &str) -> String {
    let text = quantity(value, unit);
    let Some((number, unit)) = text.split_once(' ') else { return text };
    let number = if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number };
    format!("{number} {unit}")
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `limit`, which is above 0.
pub(crate) fn round_below(limit: f64) -> f64 {
    let power = 10.0_f64.powf(limit.log10().floor());
    [5.0, 2.0].into_iter().map(|step| step * power).find(|value| *value <= limit).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        let cases = [
            (0.0, "0 s"),
            (0.025, "25.0 ms"),
            (1.234e6, "1.23 Ms"),
            (-0.000_999_9, "-1.00 ms"),
            (999.4, "999 s"),
            (3.0e-15, "0.00 ps"),
            (7.5e15, "7500 Ts"),
        ];
        for (value, text) in cases {
            assert_eq!(quantity(value, "s"), text);
        }
        assert_eq!((short_quantity(0.5, "m"), short_quantity(2.0, "m")), ("500 mm".into(), "2 m".into()));
    }

    #[test]
    fn bars_are_round() {
        for (limit, round) in [(0.37, 0.2), (5.0, 5.0), (199.0, 100.0), (9.9e-5, 5e-5)] {
            assert!((round_below(limit) / round - 1.0).abs() < 1e-12, "{limit}");
        }
    }
}
