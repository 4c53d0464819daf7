//! Interpolation kernels: weights w_ip and gradients ∇w_ip between a particle and the nodes around it.
//!
//! All lengths inside are in cells: node i of an axis stands at i. The plane kernels are products of one-dimensional
//! ones, so a hot loop needs only four weights and four gradients per axis.

use fissure_scene::{Kernel, Vector};

/// Most nodes per axis that a kernel reaches.
pub(crate) const MAX_WIDTH: usize = 4;

/// Number of nodes per axis that `kernel` reaches.
#[inline]
pub(crate) const fn width(kernel: Kernel) -> usize {
    match kernel {
        Kernel::Bilinear => 2,
        Kernel::Gimp | Kernel::Quadratic => 3,
        Kernel::Cubic => 4,
    }
}

/// How far a particle sees nodes along an axis, in cells.
pub(crate) fn reach(kernel: Kernel) -> f64 {
    0.5 * width(kernel) as f64
}

/// Weights along one axis. Entries from the kernel's width on are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AxisStencil {
    /// Lowest node reached.
    pub(crate) first: i32,
    /// Weights [–].
    pub(crate) weight: [f64; MAX_WIDTH],
    /// Derivatives of the weights by the particle's place [1/cell].
    pub(crate) gradient: [f64; MAX_WIDTH],
}

/// Weights along one axis for a particle at `x` [cells]; `half_size` is half the particle's domain l_p [cells], at most
/// 1/2, used by GIMP only.
///
/// Where a kernel has a kink (bilinear: exactly on a node) the derivative is that of the higher cell.
#[inline(always)]
pub(crate) fn axis_stencil(kernel: Kernel, half_size: f64, x: f64) -> AxisStencil {
    match kernel {
        Kernel::Bilinear => bilinear(x),
        Kernel::Gimp => gimp(half_size, x),
        Kernel::Quadratic => quadratic(x),
        Kernel::Cubic => cubic(x),
    }
}

/// ⌊x⌋ as a number and as an index; what is beyond all indices gets the last one. Without a call into the mathematical
/// library, which baseline x86-64 needs for `f64::floor`.
#[inline(always)]
fn floor(x: f64) -> (f64, i32) {
    // Numbers of this size are whole ones with the bits of an index at their end, so that adding it rounds. `x as i32`,
    // which looks at what has no index case by case, takes several times as long where numbers go side by side.
    const WHOLE: f64 = 3.0 * (1_u64 << 51) as f64;
    let x = x.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
    let shifted = x + WHOLE;
    let nearest = shifted - WHOLE;
    let is_above = nearest > x;
    (if is_above { nearest - 1.0 } else { nearest }, (shifted.to_bits() as i32).wrapping_sub(i32::from(is_above)))
}

#[inline(always)]
fn bilinear(x: f64) -> AxisStencil {
    let (base, first) = floor(x);
    let f = x - base;
    AxisStencil { first, weight: [1.0 - f, f, 0.0, 0.0], gradient: [-1.0, 1.0, 0.0, 0.0] }
}

/// The hat averaged over the particle's domain [x - l, x + l] (uniform GIMP, Bardenhagen & Kober 2004); l = 0 gives the
/// hat.
#[inline(always)]
fn gimp(half_size: f64, x: f64) -> AxisStencil {
    debug_assert!((0.0..=0.5).contains(&half_size), "a domain wider than a cell reaches more than three nodes");
    let l = half_size;
    let (above, first) = floor(x + 0.5);
    let base = above - 1.0;
    let mut stencil = AxisStencil { first: first - 1, weight: [0.0; MAX_WIDTH], gradient: [0.0; MAX_WIDTH] };
    for k in 0..3 {
        let offset = x - (base + k as f64);
        let (distance, sign) = (offset.abs(), if offset < 0.0 { -1.0 } else { 1.0 });
        (stencil.weight[k], stencil.gradient[k]) = if distance < l {
            (1.0 - (offset * offset + l * l) / (2.0 * l), -offset / l)
        } else if distance <= 1.0 - l {
            (1.0 - distance, -sign)
        } else if distance < 1.0 + l {
            let reach = 1.0 + l - distance;
            (reach * reach / (4.0 * l), -sign * reach / (2.0 * l))
        } else {
            (0.0, 0.0)
        };
    }
    stencil
}

#[inline(always)]
fn quadratic(x: f64) -> AxisStencil {
    let (base, first) = floor(x - 0.5);
    let f = x - base; // 1/2 to 3/2
    let (left, middle, right) = (1.5 - f, f - 1.0, f - 0.5);
    AxisStencil {
        first,
        weight: [0.5 * left * left, 0.75 - middle * middle, 0.5 * right * right, 0.0],
        gradient: [-left, -2.0 * middle, right, 0.0],
    }
}

#[inline(always)]
fn cubic(x: f64) -> AxisStencil {
    let (base, first) = floor(x);
    let (f, g) = (x - base, 1.0 - (x - base));
    let outer = |t: f64| t * t * t / 6.0;
    let inner = |t: f64| (0.5 * t - 1.0) * t * t + 2.0 / 3.0;
    let inner_slope = |t: f64| (1.5 * t - 2.0) * t;
    AxisStencil {
        first: first - 1,
        weight: [outer(g), inner(f), inner(g), outer(f)],
        gradient: [-0.5 * g * g, inner_slope(f), -inner_slope(g), 0.5 * f * f],
    }
}

/// The nodes a particle reaches, with weights and gradients along each axis; index 0 is x, index 1 is y.
///
/// Node (a, b) of the stencil is grid node `first + (a, b)`, with weight `weight[0][a] * weight[1][b]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stencil {
    /// Lowest node reached along each axis.
    pub(crate) first: [i32; 2],
    /// Nodes per axis.
    pub(crate) width: usize,
    /// Weights along each axis [–].
    pub(crate) weight: [[f64; MAX_WIDTH]; 2],
    /// Derivatives of the weights along each axis [1/m].
    pub(crate) gradient: [[f64; MAX_WIDTH]; 2],
}

impl Stencil {
    /// The stencil of a particle at `place` [cells from node (0, 0)]; `half_size` as in [`axis_stencil`];
    /// `inverse_cell_size` 1/h [1/m].
    #[inline(always)]
    pub(crate) fn new(kernel: Kernel, half_size: f64, place: [f64; 2], inverse_cell_size: f64) -> Self {
        let x = axis_stencil(kernel, half_size, place[0]);
        let y = axis_stencil(kernel, half_size, place[1]);
        Self {
            first: [x.first, y.first],
            width: width(kernel),
            weight: [x.weight, y.weight],
            gradient: [x.gradient.map(|g| g * inverse_cell_size), y.gradient.map(|g| g * inverse_cell_size)],
        }
    }

    /// The same weights, each axis carried on in a straight line by `way` [m], into a neighbouring cell if need be:
    /// exact for the bilinear kernel.
    pub(crate) fn carried_on(&self, way: Vector) -> Self {
        let mut moved = *self;
        for axis in 0..2 {
            for (w, g) in moved.weight[axis].iter_mut().zip(&self.gradient[axis]) {
                *w += g * way[axis];
            }
        }
        moved
    }

    /// Weight w_ip of node (a, b) [–].
    #[inline]
    pub(crate) fn weight(&self, a: usize, b: usize) -> f64 {
        self.weight[0][a] * self.weight[1][b]
    }

    /// Gradient ∇w_ip of node (a, b) [1/m].
    #[inline]
    pub(crate) fn weight_gradient(&self, a: usize, b: usize) -> Vector {
        Vector::new(self.gradient[0][a] * self.weight[1][b], self.weight[0][a] * self.gradient[1][b])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KERNELS: [(Kernel, f64); 5] = [
        (Kernel::Bilinear, 0.25),
        (Kernel::Gimp, 0.25),
        (Kernel::Gimp, 0.5),
        (Kernel::Quadratic, 0.25),
        (Kernel::Cubic, 0.25),
    ];

    /// On nodes, on cell edges, on the kinks of GIMP, beside them, negative, far out.
    fn places() -> Vec<f64> {
        let special = [0.0, 0.25, 0.5, 0.75, 1.0, 7.0, -3.0, -2.5, -0.25];
        let mut all: Vec<f64> = special.iter().flat_map(|&s| [s - 1e-9, s, s + 1e-9]).collect();
        all.extend((0..40).map(|i| -2.0 + 0.1037 * f64::from(i)));
        all
    }

    // The sums have at most 16 terms below 1 in size: 16 rounding errors of 1.1e-16 each, times the node index (below
    // 10).
    const ROUND_OFF: f64 = 2e-14;

    /// Truth: the mathematical library. On whole numbers, halves, next to them, and beyond all indices.
    #[test]
    fn floors_as_the_library_does() {
        let whole = [0.0, 1.0, 2.0, 3.0, 1e3, 123_456_789.0, 2_147_483_646.0];
        let near = |x: f64| [x, x + 0.5, x - 0.5, x.next_up(), x.next_down(), x + 0.3];
        let signed = whole.iter().flat_map(|&x| near(x)).flat_map(|x| [x, -x]);
        for x in signed.chain(places()) {
            assert_eq!(floor(x), (x.floor(), x.floor() as i32), "{x}");
        }
        for (x, index) in [(1e300, i32::MAX), (-1e300, i32::MIN), (f64::INFINITY, i32::MAX), (-3e9, i32::MIN)] {
            assert_eq!(floor(x), (f64::from(index), index), "{x}");
        }
        assert!(floor(f64::NAN).0.is_nan());
    }

    #[test]
    fn reproduces_constant_and_linear_fields() {
        for (kernel, half_size) in KERNELS {
            for &x in &places() {
                for &y in &places() {
                    let h = 0.1;
                    let stencil = Stencil::new(kernel, half_size, [x, y], 1.0 / h);
                    let (mut one, mut place, mut slope) = (0.0, Vector::zeros(), Vector::zeros());
                    let mut gradient = fissure_scene::Matrix::zeros();
                    for a in 0..stencil.width {
                        for b in 0..stencil.width {
                            let node = Vector::new(
                                f64::from(stencil.first[0] + a as i32),
                                f64::from(stencil.first[1] + b as i32),
                            );
                            assert!(stencil.weight(a, b) >= 0.0);
                            one += stencil.weight(a, b);
                            place += stencil.weight(a, b) * node;
                            slope += stencil.weight_gradient(a, b);
                            gradient += h * node * stencil.weight_gradient(a, b).transpose();
                        }
                    }
                    assert!((one - 1.0).abs() < ROUND_OFF, "{kernel:?} at {x}, {y}: sum of weights {one}");
                    assert!((place - Vector::new(x, y)).norm() < ROUND_OFF, "{kernel:?} at {x}, {y}: {place}");
                    assert!(slope.norm() < ROUND_OFF / h, "{kernel:?} at {x}, {y}: sum of gradients {slope}");
                    // Linear fields need the exact gradient too: Σ x_i ∇w_i = I.
                    assert!(
                        (gradient - fissure_scene::Matrix::identity()).norm() < 10.0 * ROUND_OFF,
                        "{kernel:?} at {x}, {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn gradient_is_the_derivative_of_the_weight() {
        // Central differences of piecewise cubics: error below step²·|w'''|/6 plus round-off / step, 1e-10 in all;
        // across a kink of w' (bilinear on a node) the truth is not defined, so those places are left out; across a
        // kink of w'' the error is step·|Δw''|/2.
        let step = 1e-6;
        for (kernel, half_size) in KERNELS {
            for i in 0..200 {
                let x = -1.0 + 0.01003 * f64::from(i) + 1e-4;
                let at = |x: f64, node: i32| {
                    let s = axis_stencil(kernel, half_size, x);
                    usize::try_from(node - s.first)
                        .ok()
                        .filter(|&k| k < MAX_WIDTH)
                        .map_or((0.0, 0.0), |k| (s.weight[k], s.gradient[k]))
                };
                for node in -4..4 {
                    let difference = (at(x + step, node).0 - at(x - step, node).0) / (2.0 * step);
                    assert!((difference - at(x, node).1).abs() < 1e-9, "{kernel:?} at {x}, node {node}");
                }
            }
        }
    }

    #[test]
    fn known_weights_on_a_node() {
        let at_node = |kernel| axis_stencil(kernel, 0.25, 5.0);
        assert_eq!((at_node(Kernel::Bilinear).first, at_node(Kernel::Bilinear).weight), (5, [1.0, 0.0, 0.0, 0.0]));
        assert_eq!((at_node(Kernel::Gimp).first, at_node(Kernel::Gimp).weight), (4, [0.0625, 0.875, 0.0625, 0.0]));
        assert_eq!(
            (at_node(Kernel::Quadratic).first, at_node(Kernel::Quadratic).weight),
            (4, [0.125, 0.75, 0.125, 0.0])
        );
        let cubic = at_node(Kernel::Cubic);
        assert_eq!(cubic.first, 4);
        for (w, exact) in cubic.weight.iter().zip([1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0]) {
            assert!((w - exact).abs() < 1e-15);
        }
    }
}
