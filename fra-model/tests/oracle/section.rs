//! The bend, from the energy of the isochoric map of the section and its derivative by dual numbers.
//!
//! `r^2 = R^2 + 2 kappa G`, `G = R_o (R_f^2 - r^2)/2 - cos f (R_f^3 - r^3)/3`, `lambda = 1 + kappa (R_o - r cos f)`,
//! `P pi R_f^2 R_o + M + N R_o = dU/dkappa`.

use fra_model::{ActuatorParameters, Load, Material};

use super::number::{Dual, Number};
use super::wall::Rule;

/// Indices of the inputs.
const INNER: usize = 0;
const OUTER: usize = 1;
const LENGTH: usize = 2;
const C1: usize = 3;
const WINDING: usize = 6;
const FORCE: usize = 7;
const TORQUE: usize = 8;
const INPUTS: usize = 9;

/// A bending actuator under a load.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    inputs: [f64; INPUTS],
}

impl Section {
    pub(crate) fn new(p: &ActuatorParameters<f64>, load: &Load<f64>) -> Self {
        let c = match p.material {
            Material::NeoHookean { shear_modulus_pa } => [0.5 * shear_modulus_pa, 0.0, 0.0],
            Material::Yeoh { c_pa } => c_pa,
        };
        let wound = p.fiber.map_or(p.outer_radius_m, |f| f.radius_m);
        let (inner, outer) = (p.inner_radius_m, p.outer_radius_m);
        Self { inputs: [inner, outer, p.length_m, c[0], c[1], c[2], wound, load.force_n, load.torque_nm] }
    }

    /// Shear modulus at small strain, Pa.
    pub(crate) fn mu1(&self) -> f64 {
        2.0 * self.inputs[C1]
    }

    /// The pressure in equilibrium with a bend angle, Pa.
    pub(crate) fn pressure(&self, rule: &Rule, angle: f64) -> f64 {
        let p = &self.inputs;
        let (inner, outer, wound) = (p[INNER], p[OUTER], p[WINDING]);
        let kappa = Dual::<1>::variable(angle / p[LENGTH], 0);
        // The nearest singularity lies an angle of about sqrt(2/(kappa R_o)) off the axis of the angles.
        let bend = kappa.value * outer;
        let angles = (16.0 + 14.0 * bend.sqrt()).ceil() as u32;
        let span = (outer - inner) * (outer + inner);
        let mut moment = 0.0;
        for j in 0..angles {
            let (sin, cos) = (std::f64::consts::PI * (f64::from(j) + 0.5) / f64::from(angles)).sin_cos();
            rule.integrate(span, inner * inner, |t: f64, weight: f64| {
                moment += weight * self.density(kappa, inner * inner + span * t, cos, sin, outer, wound);
            });
        }
        moment *= span * std::f64::consts::PI / f64::from(angles);
        let lever = std::f64::consts::PI * wound * wound * outer;
        (moment - p[TORQUE] - p[FORCE] * outer) / lever
    }

    /// `psi'(I1) dI1/dkappa` at one point of the section.
    fn density(&self, kappa: Dual<1>, square: f64, cos: f64, sin: f64, outer: f64, wound: f64) -> f64 {
        let of = Dual::<1>::of;
        let (one, two) = (of(1.0), of(2.0));
        let gap = |r: Dual<1>| {
            let reach = of(wound).cubed() - r.cubed();
            (of(wound * wound) - r * r) * of(outer * 0.5) - of(cos / 3.0) * reach
        };
        // Newton's method in r, then once more with the derivative.
        let newton = |r: Dual<1>, kappa: Dual<1>| {
            let stretch = one + kappa * (of(outer) - r * of(cos));
            r + (of(square) - r * r + two * kappa * gap(r)) / (two * r * stretch)
        };
        let mut r = of(square.sqrt());
        let fixed = of(kappa.value);
        for _ in 0..40 {
            let next = newton(r, fixed);
            let next = if next.value > 0.0 { next } else { of(0.3 * r.value) };
            let change = (next.value - r.value).abs();
            r = of(next.value);
            if change <= 1e-15 * r.value {
                break;
            }
        }
        let r = newton(r, kappa);
        let eta = two * kappa * gap(r) / of(square);
        let rise = kappa * (of(outer) - r * of(cos));
        let eps = rise * (two + rise);
        let lean = kappa * of(sin / 3.0) * (of(wound).cubed() - r.cubed()) / (r * (one + rise));
        let strain = (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / ((one + eta) * (one + eps));
        let invariant = strain + lean * lean / of(square);
        let c = &self.inputs[C1..C1 + 3];
        let i1 = invariant.value;
        (c[0] + i1 * (2.0 * c[1] + 3.0 * c[2] * i1)) * invariant.slopes[0]
    }

    /// Bends from straight on while the pressure rises, up to an angle or to the bend at which it is largest.
    pub(crate) fn rise(&self, rule: &Rule, until: f64) -> Rise {
        let mut points = vec![(0.0, self.pressure(rule, 0.0))];
        let mut angle = 1e-3 * until;
        while angle <= until {
            let pressure = self.pressure(rule, angle);
            if pressure < points[points.len() - 1].1 {
                let from = points[points.len().saturating_sub(2)].0;
                points.pop();
                points.push(self.largest(rule, from, angle));
                return Rise { points, turns: true };
            }
            points.push((angle, pressure));
            angle *= 1.2;
        }
        Rise { points, turns: false }
    }

    /// The largest pressure between two angles, by golden sections.
    fn largest(&self, rule: &Rule, mut from: f64, mut to: f64) -> (f64, f64) {
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..40 {
            let (a, b) = (to - golden * (to - from), from + golden * (to - from));
            if self.pressure(rule, a) < self.pressure(rule, b) { from = a } else { to = b }
        }
        (from, self.pressure(rule, from))
    }

    /// The angle at which the pressure is the one asked for.
    pub(crate) fn angle(&self, rule: &Rule, pressure: f64, rise: &Rise) -> f64 {
        let next = rise.points.partition_point(|p| p.1 < pressure).clamp(1, rise.points.len() - 1);
        let rest = |(angle, at): (f64, f64)| (angle, at - pressure);
        let (mut low, mut high) = (rest(rise.points[next - 1]), rest(rise.points[next]));
        for round in 0..100 {
            let secant = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let at = if round % 3 == 2 { 0.5 * (low.0 + high.0) } else { secant };
            if !(at > low.0 && at < high.0) || high.0 - low.0 < 1e-15 * at {
                break;
            }
            let here = (at, self.pressure(rule, at) - pressure);
            if here.1.abs() <= 1e-16 * pressure.abs() {
                return at;
            }
            if here.1 < 0.0 { low = here } else { high = here }
        }
        if low.1.abs() < high.1.abs() { low.0 } else { high.0 }
    }

    /// Sum of `|d ln(angle)/d ln(input)|` over all inputs and the pressure, at least one.
    pub(crate) fn condition(&self, rule: &Rule, angle: f64, pressure: f64) -> f64 {
        let h = 1e-4;
        let by_angle = (self.pressure(rule, angle * (1.0 + h)) - self.pressure(rule, angle * (1.0 - h))) / (2.0 * h);
        ((self.by_inputs(rule, angle) + pressure.abs()) / by_angle.abs()).max(1.0)
    }

    /// Sum of `|dP/d ln(input)| / |P|` at fixed angle, at least one.
    pub(crate) fn condition_of_pressure(&self, rule: &Rule, angle: f64, pressure: f64) -> f64 {
        if pressure == 0.0 { 1.0 } else { (self.by_inputs(rule, angle) / pressure.abs()).max(1.0) }
    }

    fn by_inputs(&self, rule: &Rule, angle: f64) -> f64 {
        let h = 1e-4;
        let changed = |k: usize, factor: f64| {
            let mut other = self.clone();
            other.inputs[k] *= factor;
            other.pressure(rule, angle)
        };
        (0..INPUTS).map(|k| ((changed(k, 1.0 + h) - changed(k, 1.0 - h)) / (2.0 * h)).abs()).sum()
    }
}

/// Angles from straight on and the pressures that hold them, which rise.
pub(crate) struct Rise {
    pub(crate) points: Vec<(f64, f64)>,
    /// Whether the last pressure is the largest there is.
    pub(crate) turns: bool,
}
