//! What a quantity comes to as cells become small, from three resolutions.

/// How a quantity goes from a coarse resolution over a middle one to a fine one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Trend {
    /// The changes become smaller, all in one direction.
    Converges {
        /// The power of the cell size with which the error falls.
        order: f64,
        /// What the quantity comes to without cells.
        extrapolated: f64,
        /// How far the finest value may be from that, as a part of it: the change to it, 1.25 times.
        uncertainty: f64,
    },
    /// It is the same at all of them, to rounding.
    Constant,
    /// It goes up and down; from three values nothing follows but their span.
    Oscillates,
    /// The changes do not become smaller.
    Diverges,
}

/// Change, as a part of the value, below which a quantity is taken to be constant.
const ROUNDING: f64 = 1e-9;
/// Safety factor of the grid convergence index for three grids.
const SAFETY: f64 = 1.25;
/// Orders beyond these are no property of the scheme: the three values lie on its curve by chance.
const ORDERS: std::ops::RangeInclusive<f64> = 0.25..=4.0;

/// Richardson's extrapolation: with f₁, f₂, f₃ from coarse to fine, cells smaller by the factor r each time,
/// p = ln((f₁ − f₂)/(f₂ − f₃))/ln r and f = f₃ + (f₃ − f₂)/(r^p − 1). The uncertainty is the grid convergence index,
/// 1.25 |f₃ − f₂|/(r^p − 1). Orders are taken as 0.25 to 4.
///
/// Source: Roache 1994, J. Fluids Eng. 116, 405–413.
pub(crate) fn trend([coarse, middle, fine]: [f64; 3], ratio: f64) -> Trend {
    let (first, second) = (middle - coarse, fine - middle);
    let size = coarse.abs().max(middle.abs()).max(fine.abs());
    if first.abs().max(second.abs()) <= ROUNDING * size {
        return Trend::Constant;
    }
    let shrinks = second / first;
    if shrinks < 0.0 {
        return Trend::Oscillates;
    }
    // Not below one either: NaN.
    if shrinks.is_nan() || shrinks >= 1.0 {
        return Trend::Diverges;
    }
    let order = (-shrinks.ln() / ratio.ln()).clamp(*ORDERS.start(), *ORDERS.end());
    let left = second / (ratio.powf(order) - 1.0);
    let extrapolated = fine + left;
    Trend::Converges { order, extrapolated, uncertainty: SAFETY * (left / extrapolated).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: f = 2 + 3 h^p, whose limit and order are known.
    #[test]
    fn powers_are_found_again() {
        for order in [0.5, 1.0, 2.0, 3.5] {
            let ratio = 2.0_f64.sqrt();
            let value = |h: f64| 2.0 + 3.0 * h.powf(order);
            let Trend::Converges { order: found, extrapolated, .. } =
                trend([ratio, 1.0, 1.0 / ratio].map(value), ratio)
            else {
                unreachable!("order {order}")
            };
            assert!(
                (found - order).abs() < 1e-9 && (extrapolated - 2.0).abs() < 1e-9,
                "{order}: {found} {extrapolated}"
            );
        }
    }

    #[test]
    fn what_does_not_converge_is_told() {
        assert_eq!(trend([1.0, 2.0, 1.5], 2.0), Trend::Oscillates);
        assert_eq!(trend([1.0, 2.0, 4.0], 2.0), Trend::Diverges);
        assert_eq!(trend([1.0, 1.0, 2.0], 2.0), Trend::Diverges);
        assert_eq!(trend([3.0, 3.0, 3.0], 2.0), Trend::Constant);
        assert_eq!(trend([0.0, 0.0, 0.0], 2.0), Trend::Constant);
        assert_eq!(trend([1.0, f64::NAN, 1.0], 2.0), Trend::Diverges);
    }
}
