//! Values between the entries of tables.

/// The polynomial through all points `(x, y)`, at `at` (Lagrange); for short tables of smooth functions.
pub(crate) fn polynomial(points: &[(f64, f64)], at: f64) -> f64 {
    let mut sum = 0.0;
    for (i, &(x_i, y_i)) in points.iter().enumerate() {
        let mut basis = 1.0;
        for (j, &(x_j, _)) in points.iter().enumerate() {
            if i != j {
                basis *= (at - x_j) / (x_i - x_j);
            }
        }
        sum += y_i * basis;
    }
    sum
}

/// The polygon through the points `(x, y)`, x rising, at `at`; constant outside.
pub(crate) fn linear(points: &[(f64, f64)], at: f64) -> f64 {
    let next = points.partition_point(|p| p.0 <= at);
    if next == 0 {
        return points[0].1;
    }
    let Some(&(x1, y1)) = points.get(next) else { return points[points.len() - 1].1 };
    let (x0, y0) = points[next - 1];
    y0 + (y1 - y0) * (at - x0) / (x1 - x0)
}

/// The numbers of a table of comma-separated values, line by line; lines that begin with `#` are headings.
pub(crate) fn columns(text: &str) -> Vec<Vec<f64>> {
    text.lines()
        .filter(|line| !line.starts_with('#') && !line.trim().is_empty())
        .map(|line| line.split(',').map(|cell| cell.trim().parse().unwrap_or(f64::NAN)).collect())
        .collect()
}
