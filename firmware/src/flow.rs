//! Mass flow through valves and lines after ISO 6358, with closed-form consequences.
//!
//! Pressures in this file are absolute. Legend: `C` sonic conductance, `b` critical ratio, `r = p2/p1`, `phi` flow function, `q = m'/(C rho0)`.

use nalgebra::ComplexField;

use crate::gas::{Absolute, REFERENCE_DENSITY_KG_PER_M3};

/// Pressure ratio above which the flow is taken as linear in `1 - r`, so that the slope at `r = 1` stays finite.
const LINEAR_RATIO: f32 = 0.995;

/// Critical ratio taken for a line: that of a 2.5 mm tube of about 1 m.
const LINE_CRITICAL_RATIO: f32 = 0.3;

/// One restriction: a valve, a line, or both in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orifice {
    conductance: f32,
    critical_ratio: f32,
}

impl Orifice {
    /// A restriction of sonic conductance `C` in m3/(s Pa), > 0, and critical ratio `b`, `0 <= b < 1`.
    pub const fn new(conductance_m3_per_s_pa: f32, critical_ratio: f32) -> Self {
        Self { conductance: conductance_m3_per_s_pa, critical_ratio }
    }

    /// A line of sonic conductance `C` in m3/(s Pa), > 0.
    pub const fn line(conductance_m3_per_s_pa: f32) -> Self {
        Self::new(conductance_m3_per_s_pa, LINE_CRITICAL_RATIO)
    }

    /// This restriction followed by `line`: `1/C^2 = 1/C1^2 + 1/C2^2`, with the critical ratio of `self`.
    #[must_use]
    pub fn in_series_with(&self, line: &Self) -> Self {
        let (a, b) = (self.conductance, line.conductance);
        Self { conductance: a * b / ComplexField::sqrt(a * a + b * b), critical_ratio: self.critical_ratio }
    }

    /// Mass flow in kg/s from `upstream` to `downstream` at the reference temperature; 0 when the pressures do not drive it.
    pub fn mass_flow_kg_per_s(&self, upstream: Absolute, downstream: Absolute) -> f32 {
        let (p1, p2) = (upstream.pa(), downstream.pa());
        if p1 <= 0.0 || p2 >= p1 {
            return 0.0;
        }
        self.conductance * REFERENCE_DENSITY_KG_PER_M3 * p1 * self.flow_function(p2 / p1)
    }

    /// Pressure behind the restriction when `mass_flow_kg_per_s` passes from `upstream`; the critical pressure when the flow is choked.
    pub fn downstream(&self, upstream: Absolute, mass_flow_kg_per_s: f32) -> Absolute {
        let p1 = upstream.pa();
        let phi = self.q(mass_flow_kg_per_s) / p1;
        Absolute::new(p1 * self.ratio(phi))
    }

    /// Pressure before the restriction when `mass_flow_kg_per_s` passes to `downstream`.
    ///
    /// Positive root of `(1-2b) p1^2 + 2 b p2 p1 = p2^2 + (1-b)^2 q^2`, the subsonic branch squared, in the form that holds at
    /// `b = 1/2` too; `p1 = q` when choked. The linear zone near `r = 1` is left out: 0.1 % of the pressure at most.
    pub fn upstream(&self, downstream: Absolute, mass_flow_kg_per_s: f32) -> Absolute {
        let (b, p2, q) = (self.critical_ratio, downstream.pa(), self.q(mass_flow_kg_per_s));
        if b * q >= p2 {
            return Absolute::new(q);
        }
        let right = p2 * p2 + (1.0 - b) * (1.0 - b) * q * q;
        let half = b * p2;
        Absolute::new(right / (half + ComplexField::sqrt((half * half + (1.0 - 2.0 * b) * right).max(0.0))))
    }

    fn q(&self, mass_flow_kg_per_s: f32) -> f32 {
        mass_flow_kg_per_s.max(0.0) / (self.conductance * REFERENCE_DENSITY_KG_PER_M3)
    }

    fn flow_function(&self, r: f32) -> f32 {
        let b = self.critical_ratio;
        if r <= b {
            1.0
        } else if r < LINEAR_RATIO {
            ellipse(r, b)
        } else {
            ellipse(LINEAR_RATIO, b) * (1.0 - r) / (1.0 - LINEAR_RATIO)
        }
    }

    /// Inverse of the flow function: `b..=1` for `phi` in `0..=1`, `b` beyond.
    fn ratio(&self, phi: f32) -> f32 {
        let b = self.critical_ratio;
        let knee = ellipse(LINEAR_RATIO, b);
        if phi <= knee {
            1.0 - phi / knee * (1.0 - LINEAR_RATIO)
        } else {
            b + (1.0 - b) * ComplexField::sqrt((1.0 - phi * phi).max(0.0))
        }
    }
}

/// Subsonic branch: `sqrt(1 - ((r-b)/(1-b))^2)`.
fn ellipse(r: f32, b: f32) -> f32 {
    let x = (r - b) / (1.0 - b);
    ComplexField::sqrt((1.0 - x * x).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: Orifice = Orifice::new(1.44e-9, 0.3);

    fn kpa(value: f32) -> Absolute {
        Absolute::new(value * 1e3)
    }

    #[test]
    fn choked_flow_is_conductance_times_density_times_upstream_pressure() {
        // 0.144 dm3/(s bar) at 3 bar absolute passes 0.432 normal litres a second, 0.51192 g/s.
        let flow = VALVE.mass_flow_kg_per_s(kpa(300.0), kpa(80.0));
        assert!((flow - 0.51192e-3).abs() < 1e-8, "{flow}");
        assert_eq!(flow, VALVE.mass_flow_kg_per_s(kpa(300.0), kpa(10.0)));
    }

    #[test]
    fn subsonic_flow_follows_the_ellipse_and_ends_at_zero() {
        // r = 0.65 with b = 0.3: phi = sqrt(1 - 0.5^2) = 0.8660254.
        let flow = VALVE.mass_flow_kg_per_s(kpa(200.0), kpa(130.0));
        assert!((flow - 1.44e-9 * 1.185 * 2e5 * 0.866_025_4).abs() < 1e-10);
        assert_eq!(VALVE.mass_flow_kg_per_s(kpa(200.0), kpa(200.0)), 0.0);
        assert_eq!(VALVE.mass_flow_kg_per_s(kpa(100.0), kpa(200.0)), 0.0);
    }

    #[test]
    fn equal_restrictions_in_series_pass_less_by_root_two() {
        let both = VALVE.in_series_with(&VALVE);
        let ratio = VALVE.mass_flow_kg_per_s(kpa(400.0), kpa(1.0)) / both.mass_flow_kg_per_s(kpa(400.0), kpa(1.0));
        assert!((ratio - core::f32::consts::SQRT_2).abs() < 1e-5);
    }

    #[test]
    fn pressure_on_either_side_is_recovered_from_the_flow() {
        let line = Orifice::line(3.78e-9);
        for (p1, p2) in [(179.0, 161.0), (120.0, 119.9), (250.0, 200.0), (161.0, 140.0)] {
            let flow = line.mass_flow_kg_per_s(kpa(p1), kpa(p2));
            let down = line.downstream(kpa(p1), flow).pa();
            let up = line.upstream(kpa(p2), flow).pa();
            assert!((down - p2 * 1e3).abs() < 20.0, "{p1} {p2} {down}");
            assert!((up - p1 * 1e3).abs() < 0.001 * p1 * 1e3, "{p1} {p2} {up}");
        }
    }

    #[test]
    fn upstream_of_a_choked_flow_is_the_choked_answer() {
        let line = Orifice::line(3.78e-9);
        let flow = line.mass_flow_kg_per_s(kpa(500.0), kpa(100.0));
        assert!((line.upstream(kpa(100.0), flow).pa() - 5e5).abs() < 50.0);
    }
}
