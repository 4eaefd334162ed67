//! Gauss-Legendre nodes in `ln R`, where the integrands of the wall are smoothest.

use crate::real::{Real, real};

/// Positive half of the 8-point Gauss-Legendre abscissae on (-1, 1), and their weights.
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Positive half of the 4-point rule.
const GAUSS_4: [(f64, f64); 2] =
    [(0.339_981_043_584_856_26, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_85)];

const NODES: usize = 2 * GAUSS_8.len();

/// Largest span of `ln X` one panel covers: a radius ratio of 2.
const PANEL_SPAN: f64 = 1.386_294_361_119_890_6;

/// A rule for `int f(X) dX` from `X_a` to `X_b`: Gauss-Legendre in `ln X`, in equal panels.
///
/// Only the nodes of the first panel are kept; those of the others are multiples of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallRule<T> {
    /// Nodes and weights; unused ones have no weight.
    first_panel: [(T, T); NODES],
    nodes: u8,
    panel_ratio: T,
    panels: u8,
}

impl<T: Real> WallRule<T> {
    /// The rule of eight nodes a panel from `x_a` > 0 to `x_b` > `x_a`.
    pub(crate) fn new(x_a: T, x_b: T) -> Self {
        Self::with(&GAUSS_8, x_a, x_b)
    }

    /// The rule of four nodes a panel.
    pub(crate) fn coarse(x_a: T, x_b: T) -> Self {
        Self::with(&GAUSS_4, x_a, x_b)
    }

    fn with(half_rule: &[(f64, f64)], x_a: T, x_b: T) -> Self {
        let span = (x_b / x_a).ln();
        let mut panels = 1u8;
        let mut covered = real::<T>(PANEL_SPAN);
        while covered < span && panels < 8 {
            panels += 1;
            covered += real::<T>(PANEL_SPAN);
        }
        let half = span / real::<T>(2.0) / count(panels);
        let mut first_panel = [(T::zero(), T::zero()); NODES];
        for (pair, &(abscissa, weight)) in first_panel.chunks_exact_mut(2).zip(half_rule) {
            for (node, sign) in pair.iter_mut().zip([-T::one(), T::one()]) {
                let x = x_a * (half * (T::one() + sign * real::<T>(abscissa))).exp();
                *node = (x, real::<T>(weight) * half * x);
            }
        }
        let nodes = 2 * half_rule.len() as u8;
        Self { first_panel, nodes, panel_ratio: (half + half).exp(), panels }
    }

    /// The rule of one point: a sheet at `x` whose weight is `weight`.
    pub(crate) fn point(x: T, weight: T) -> Self {
        let mut first_panel = [(x, T::zero()); NODES];
        first_panel[0].1 = weight;
        Self { first_panel, nodes: 1, panel_ratio: T::one(), panels: 1 }
    }

    /// Calls `f(X, weight)` at every node.
    pub(crate) fn for_each(&self, mut f: impl FnMut(T, T)) {
        let mut scale = T::one();
        for _ in 0..self.panels {
            for &(x, weight) in self.first_panel.iter().take(usize::from(self.nodes)) {
                f(x * scale, weight * scale);
            }
            scale *= self.panel_ratio;
        }
    }
}

/// A small count as a scalar, without a conversion from a run-time `f64`.
fn count<T: Real>(n: u8) -> T {
    let mut sum = T::zero();
    for _ in 0..n {
        sum += T::one();
    }
    sum
}
