//! Bending from the energy of the deformed section: where fra-model integrates over the undeformed wall and solves for the place of
//! every node, this integrates over the deformed wall, whose nodes come from explicitly, and solves for its two edges alone.
//!
//! Lengths in units of `R_o`, `k = kappa R_o`, `A_0 = 1 + k`. The material at the deformed radius `r` under the angle `phi_c` comes from
//! `R^2 = rho_f^2 - A_0 (rho_f^2 - r^2) + (2/3) k cos(phi_c) (rho_f^3 - r^3)`; a volume element is `r lambda dr dphi`,
//! `lambda = A_0 - k r cos(phi_c)`. The slope by `k` is carried along exactly.

use fra_model::{ActuatorParameters, Material};

use crate::accuracy::gauss::Rule;
use crate::accuracy::number::{Dual, Number};

/// Angles on half a turn; the midpoint rule converges geometrically for what is smooth and periodic.
const ANGLES: u32 = 48;

/// A bending actuator in the numbers of the reference.
pub(super) struct Section<'a, N> {
    rule: &'a Rule<N>,
    inner: N,
    winding: N,
    mu: f64,
    c: [N; 3],
}

impl<'a, N: Number> Section<'a, N> {
    pub(super) fn new(p: &ActuatorParameters<f64>, rule: &'a Rule<N>) -> Self {
        let c = match p.material {
            Material::NeoHookean { shear_modulus_pa } => [0.5 * shear_modulus_pa, 0.0, 0.0],
            Material::Yeoh { c_pa } => c_pa,
        };
        let outer = N::of(p.outer_radius_m);
        Self {
            rule,
            inner: N::of(p.inner_radius_m) / outer,
            winding: N::of(p.fiber.map_or(p.outer_radius_m, |fiber| fiber.radius_m)) / outer,
            mu: 2.0 * c[0],
            c: c.map(N::of),
        }
    }

    /// `P/mu` at a curvature: `P pi R_f^2 R_o = dU/dkappa`.
    pub(super) fn pressure(&self, k: N) -> N {
        let k = Dual { value: k, slope: N::of(1.0) };
        let mut slope = N::of(0.0);
        for index in 0..ANGLES {
            let angle = N::pi() * N::of((f64::from(index) + 0.5) / f64::from(ANGLES));
            let (sin, cos) = angle.sin_cos();
            slope = slope + self.ray(k, Dual::constant(sin), Dual::constant(cos));
        }
        // Both halves of the section.
        let turn = N::of(2.0 / f64::from(ANGLES)) * N::pi();
        slope * turn / (N::pi() * self.winding * self.winding * N::of(self.mu))
    }

    /// Slope of the energy of one ray.
    fn ray(&self, k: Dual<N>, sin: Dual<N>, cos: Dual<N>) -> N {
        let half = Dual::of(0.5);
        let (from, to) = (self.place(k, cos, self.inner), self.place(k, cos, N::of(1.0)));
        let (middle, reach) = ((from + to) * half, (to - from) * half);
        let mut sum = Dual::of(0.0);
        for &(x, weight) in self.rule.nodes() {
            let r = middle + reach * Dual::constant(x);
            sum = sum + self.density(k, r, sin, cos) * reach * Dual::constant(weight);
        }
        sum.slope
    }

    /// `W r lambda` at a deformed place, Pa.
    fn density(&self, k: Dual<N>, r: Dual<N>, sin: Dual<N>, cos: Dual<N>) -> Dual<N> {
        let one = Dual::of(1.0);
        let lambda = one + k * (one - r * cos);
        let square = self.origin(k, r, cos);
        let f = Dual::constant(self.winding);
        // dr/dphi at constant R.
        let lean = k * sin * (f * f * f - r * r * r) / (Dual::of(3.0) * r * lambda);
        let radial = square / (r * r * lambda * lambda);
        let excess = radial + (r * r + lean * lean) / square + lambda * lambda - Dual::of(3.0);
        let [c1, c2, c3] = self.c.map(Dual::constant);
        excess * (c1 + excess * (c2 + excess * c3)) * r * lambda
    }

    /// `R^2` of the material at `r`.
    fn origin(&self, k: Dual<N>, r: Dual<N>, cos: Dual<N>) -> Dual<N> {
        let f = Dual::constant(self.winding);
        let within = (Dual::of(1.0) + k) * (f * f - r * r);
        f * f - within + Dual::of(2.0) / Dual::of(3.0) * k * cos * (f * f * f - r * r * r)
    }

    /// Where the undeformed radius goes: `d(R^2)/dr = 2 r lambda`. The last rounds settle the slope.
    fn place(&self, k: Dual<N>, cos: Dual<N>, radius: N) -> Dual<N> {
        let one = Dual::of(1.0);
        let wanted = Dual::constant(radius * radius);
        let mut r = Dual::constant(radius);
        for _ in 0..12 {
            let lambda = one + k * (one - r * cos);
            r = r - (self.origin(k, r, cos) - wanted) / (Dual::of(2.0) * r * lambda);
        }
        r
    }
}
