//! Gauss-Legendre nodes in `ln R`, where the integrands of the wall are smoothest.

use crate::number::scalar::Scalar;

/// Positive half of the 8-point Gauss-Legendre abscissae on (-1, 1), and their weights.
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

const NODES: usize = 2 * GAUSS_8.len();

/// Largest span of `ln X` one panel covers: at large twists the integrands grow as the fourth power of `X`.
const PANEL_SPAN: f64 = 0.7;

/// Widest panel as a share of its distance in `ln X` from a pole: eight nodes then are exact to the last digit of a double.
const SHARE_OF_DISTANCE: f64 = 0.45;

/// Most panels of a graded rule: enough for a lumen of 1e-6 of its volume.
const GRADED_PANELS: u8 = 60;

/// A rule for `int f(X) dX` from `X_a` to `X_b`: Gauss-Legendre in `ln X`, in equal panels.
///
/// Only the nodes of the first panel are kept; those of the others are multiples of them. Where the lumen has shrunk, the integrands
/// have a pole at `X = -w` close before `X_a`; then the panels grow with their distance from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallRule<T> {
    /// Positive half of the rule on (-1, 1), and how many of its nodes there are: none for a single point.
    half_rule: [(T, T); NODES / 2],
    pairs: usize,
    from: T,
    span: T,
    /// Nodes and weights; unused ones have no weight.
    first_panel: [(T, T); NODES],
    panel_width: T,
    panel_ratio: T,
    panels: u8,
}

impl<T: Scalar> WallRule<T> {
    /// The rule of eight nodes a panel from `x_a` > 0 to `x_b` > `x_a`.
    pub(crate) fn new(x_a: T, x_b: T) -> Self {
        Self::with(GAUSS_8.map(constants), GAUSS_8.len(), x_a, x_b)
    }

    fn with(half_rule: [(T, T); NODES / 2], pairs: usize, x_a: T, x_b: T) -> Self {
        let span = (x_b / x_a).ln();
        let mut panels = 1u8;
        let mut covered = T::constant(PANEL_SPAN);
        while covered < span && panels < u8::MAX {
            panels += 1;
            covered += T::constant(PANEL_SPAN);
        }
        let width = span / count(panels);
        let mut first_panel = [(T::zero(), T::zero()); NODES];
        for (node, value) in first_panel.iter_mut().zip(panel(&half_rule, pairs, x_a, width)) {
            *node = value;
        }
        Self { half_rule, pairs, from: x_a, span, first_panel, panel_width: width, panel_ratio: width.exp(), panels }
    }

    /// The rule of one point: a sheet at `x` whose weight is `weight`.
    pub(crate) fn point(x: T, weight: T) -> Self {
        let mut first_panel = [(x, T::zero()); NODES];
        first_panel[0].1 = weight;
        let half_rule = GAUSS_8.map(constants);
        Self {
            half_rule,
            pairs: 0,
            from: x,
            span: T::zero(),
            first_panel,
            panel_width: T::zero(),
            panel_ratio: T::one(),
            panels: 1,
        }
    }

    /// Calls `f(X, weight)` at every node; `w` tells where the pole is.
    pub(crate) fn for_each(&self, w: T, mut f: impl FnMut(T, T)) {
        let Self { pairs, first_panel, panel_width, .. } = self;
        // A sheet has no rule, and only a smaller lumen has a pole at a positive X.
        if *pairs > 0 && w < T::zero() {
            let distance = (self.from / -w).ln();
            if *panel_width > distance * T::constant(SHARE_OF_DISTANCE) {
                return self.for_each_graded(distance, f);
            }
        }
        let nodes = (2 * pairs).max(1);
        let mut scale = T::one();
        for _ in 0..self.panels {
            for &(x, weight) in first_panel.iter().take(nodes) {
                f(x * scale, weight * scale);
            }
            scale *= self.panel_ratio;
        }
    }

    fn for_each_graded(&self, distance: T, mut f: impl FnMut(T, T)) {
        let (mut distance, mut from, mut left) = (distance, self.from, self.span);
        for round in 0..GRADED_PANELS {
            let widest = distance * T::constant(SHARE_OF_DISTANCE);
            let last = round + 1 == GRADED_PANELS || left <= widest;
            let width = if last { left } else { widest };
            panel(&self.half_rule, self.pairs, from, width).for_each(|(x, weight)| f(x, weight));
            if last {
                return;
            }
            from *= width.exp();
            left -= width;
            distance += width;
        }
    }
}

/// Nodes and weights of one panel that starts at `from` and is `width` wide in `ln X`.
fn panel<T: Scalar>(half_rule: &[(T, T)], pairs: usize, from: T, width: T) -> impl Iterator<Item = (T, T)> {
    let half = width * T::constant(0.5);
    half_rule.iter().take(pairs).flat_map(move |&(abscissa, weight)| {
        [-T::one(), T::one()].map(|sign| {
            let x = from * (half * (T::one() + sign * abscissa)).exp();
            (x, weight * half * x)
        })
    })
}

/// One node of a table in the scalar: converted while it is still a constant of the source.
fn constants<T: Scalar>((abscissa, weight): (f64, f64)) -> (T, T) {
    (T::constant(abscissa), T::constant(weight))
}

/// A small count as a scalar, without a conversion from a run-time `f64`.
fn count<T: Scalar>(n: u8) -> T {
    let mut sum = T::zero();
    for _ in 0..n {
        sum += T::one();
    }
    sum
}
