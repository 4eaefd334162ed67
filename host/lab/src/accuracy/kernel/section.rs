//! Bending by less than the model: the printed (13), its repairs, and the model with fewer nodes.
//!
//! All are a pressure as an explicit function of the curvature `k = kappa R_o`; lengths in units of `R_o`, `h = 1 - rho cos(phi_c)`.

use fra_model::{ActuatorParameters, Material};

use crate::accuracy::gauss::Rule;
use crate::accuracy::number::{Dual, Number};

/// Which balance of moments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Balance {
    /// (13) without its stray `L`: the stretch (12) is the same all round the section.
    Printed,
    /// B0: the stretch `1 + k h`; the pressure acts on the caps alone.
    Caps,
    /// B1: as B0, and the pressure carried through the wall to the winding.
    Winding,
    /// B2, that of fra-model: the wall follows the isochoric map. Radial nodes and angles on half a turn.
    Map(u32, u32),
}

/// Nodes and angles of the balances that have no others.
const NODES: u32 = 8;
const ANGLES: u32 = 16;
/// Rounds of the secant method, and of Newton's on the map.
const ROUNDS: u32 = 60;

/// A section, ready to be evaluated.
pub(super) struct Section<N> {
    balance: Balance,
    inner: N,
    winding: N,
    a: N,
    b: N,
    /// `rho^2` with the weight of `rho drho`.
    radii: Vec<(N, N)>,
    /// Sine and cosine on half a turn.
    angles: Vec<(N, N)>,
}

impl<N: Number> Section<N> {
    pub(super) fn new(p: &ActuatorParameters<f64>, balance: Balance) -> Self {
        let mu = p.material.shear_modulus_pa();
        let (a, b) = match p.material {
            Material::NeoHookean { .. } => (0.0, 0.0),
            Material::Yeoh { c_pa } => (2.0 * c_pa[1] / mu, 3.0 * c_pa[2] / mu),
        };
        let inner = p.inner_radius_m / p.outer_radius_m;
        let (radial, around) =
            if let Balance::Map(radial, around) = balance { (radial, around) } else { (NODES, ANGLES) };
        let half = -inner.ln();
        let rule = Rule::<f64>::new(radial);
        let radii = rule.nodes().iter().map(|&(x, weight)| {
            let square = (half * (x - 1.0)).exp();
            (N::of(square), N::of(0.5 * weight * half * square))
        });
        let angle = |index: u32| (std::f64::consts::PI * (f64::from(index) + 0.5) / f64::from(around)).sin_cos();
        Self {
            balance,
            inner: N::of(inner),
            winding: N::of(p.fiber.map_or(1.0, |fiber| fiber.radius_m / p.outer_radius_m)),
            a: N::of(a),
            b: N::of(b),
            radii: radii.collect(),
            angles: (0..around).map(angle).map(|(sin, cos)| (N::of(sin), N::of(cos))).collect(),
        }
    }

    /// `P/mu1` at a curvature.
    pub(super) fn pressure(&self, k: N) -> N {
        let mut moment = N::of(0.0);
        for &(square, weight) in &self.radii {
            let rho = square.sqrt();
            let ring = if self.balance == Balance::Printed {
                // Round the section only h varies, with the mean 1.
                self.axial_stress(N::of(1.0) + k * (N::of(1.0) - rho))
            } else {
                let sum = self.angles.iter().fold(N::of(0.0), |sum, &angle| sum + self.moment(k, rho, angle));
                sum * N::of(1.0 / self.angles.len() as f64)
            };
            moment = moment + weight * ring;
        }
        let radius = if matches!(self.balance, Balance::Printed | Balance::Caps) { self.inner } else { self.winding };
        N::of(2.0) * moment / (radius * radius)
    }

    /// The curvature at `P/mu1` by the secant method, with the rounds it took. `None` where it does not converge.
    pub(super) fn curvature(&self, pressure: N) -> Option<(N, u32)> {
        let tolerance = N::epsilon();
        let (mut before, mut k) = (N::of(0.0), N::of(1e-2));
        let mut off_before = -pressure;
        let mut last = f64::INFINITY;
        for round in 1..=ROUNDS {
            let off = self.pressure(k) - pressure;
            let mut step = off * (k - before) / (off - off_before);
            // The curvature stays positive.
            if step.nearest() >= k.nearest() {
                step = k * N::of(0.5);
            }
            let size = (step / k).nearest().abs();
            // Two equal values tell no way: rounding is all that is left.
            let flat = off.nearest() == off_before.nearest() && last < N::difference();
            if flat || off.nearest() == 0.0 || size <= tolerance || (size >= 0.5 * last && size < N::difference()) {
                return Some((k, round));
            }
            if !size.is_finite() {
                return None;
            }
            (before, off_before, last) = (k, off, size);
            k = k - step;
        }
        None
    }

    /// Axial stress over `mu1` of a stretch at constant width.
    fn axial_stress(&self, stretch: N) -> N {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let square = stretch * stretch;
        let j = square + one / square - two;
        (one + two * j * (self.a + self.b * j)) * (stretch - one / (square * stretch))
    }

    fn moment(&self, k: N, rho: N, (sin, cos): (N, N)) -> N {
        let one = N::of(1.0);
        if let Balance::Map(..) = self.balance {
            return self.energy(k, rho, sin, cos).slope;
        }
        let h = one - rho * cos;
        self.axial_stress(one + k * h) * h
    }

    /// `W/mu1` at a point of the section, with its slope by the curvature.
    fn energy(&self, k: N, rho: N, sin: N, cos: N) -> Dual<N> {
        let (one, f) = (N::of(1.0), self.winding);
        let place = self.place(k, rho, cos);
        let r = Dual { value: place, slope: self.shift(place, cos) / (place * (one + k * (one - place * cos))) };
        let k = Dual { value: k, slope: one };
        let c = Dual::constant;
        let (one, two, cos) = (c(one), Dual::of(2.0), c(cos));
        let h = one - r * cos;
        let lambda = one + k * h;
        let cubes = c(f * f * f) - r * r * r;
        let shift = (c(f * f) - r * r) * Dual::of(0.5) - cos * cubes * c(N::of(1.0) / N::of(3.0));
        let per_square = c(N::of(1.0) / (rho * rho));
        let lean = k * c(sin) * cubes / (Dual::of(3.0) * r * lambda);
        let (eta, eps) = (two * k * shift * per_square, k * h * (two + k * h));
        let product = (one + eta) * (one + eps);
        let j = (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / product + lean * lean * per_square;
        j * (Dual::of(0.5) + j * (c(self.a) * Dual::of(0.5) + c(self.b) * c(N::of(1.0) / N::of(3.0)) * j))
    }

    /// `(rho_f^2 - r^2)/2 - cos (rho_f^3 - r^3)/3`: `r^2 = rho^2 + 2 k shift`.
    fn shift(&self, r: N, cos: N) -> N {
        let f = self.winding;
        (f * f - r * r) * N::of(0.5) - cos * (f * f * f - r * r * r) / N::of(3.0)
    }

    /// Where the radius `rho` goes.
    fn place(&self, k: N, rho: N, cos: N) -> N {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let mut square = rho * rho;
        let mut r = rho;
        for _ in 0..ROUNDS {
            let step = (rho * rho + two * k * self.shift(r, cos) - square) / (one + k * (one - r * cos));
            square = square + step;
            r = square.sqrt();
            if (step / square).nearest().abs() <= N::epsilon() {
                break;
            }
        }
        r
    }
}
