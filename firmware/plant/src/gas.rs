//! Air: its constants and the flow through an orifice.

/// Specific gas constant of dry air, J/(kg K).
pub(crate) const R_AIR: f64 = 287.05;
/// Ratio of the specific heats of air.
pub(crate) const GAMMA: f64 = 1.4;
/// Density of the reference atmosphere of ISO 6358 (20 degC, 100 kPa, 65 % humidity), kg/m3.
pub const REFERENCE_DENSITY_KG_PER_M3: f64 = 1.185;
/// Temperature of the reference atmosphere of ISO 6358, K.
pub(crate) const T_REFERENCE_K: f64 = 293.15;
/// Pressure ratio above which the flow is taken as linear in the pressure difference:
/// the law itself has an infinite slope at ratio 1.
pub(crate) const LAMINAR_RATIO: f64 = 0.995;

/// An orifice after ISO 6358 with its gas temperature folded in.
///
/// `m' = C rho0 p_up sqrt(T0/T) phi(r)`, `r = p_down/p_up`, with
/// `phi = 1` up to the critical ratio `b`, `sqrt(1 - ((r-b)/(1-b))^2)` above it and linear in
/// `1 - r` above [`LAMINAR_RATIO`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Orifice {
    /// `C rho0 sqrt(T0/T)`, kg/(s Pa).
    coefficient: f64,
    critical_ratio: f64,
    /// `1 / (1 - b)`.
    inverse_span: f64,
    /// `phi(r)/(1 - r)` in the linear zone.
    laminar_slope: f64,
}

impl Orifice {
    /// An orifice of the sonic conductance `conductance` (m3/(s Pa)) and critical ratio
    /// `critical_ratio` for gas of the upstream temperature `temperature_k`.
    pub(crate) fn new(conductance: f64, critical_ratio: f64, temperature_k: f64) -> Self {
        let inverse_span = 1.0 / (1.0 - critical_ratio);
        let u = (LAMINAR_RATIO - critical_ratio) * inverse_span;
        Self {
            coefficient: conductance * REFERENCE_DENSITY_KG_PER_M3 * (T_REFERENCE_K / temperature_k).sqrt(),
            critical_ratio,
            inverse_span,
            laminar_slope: (1.0 - u * u).sqrt() / (1.0 - LAMINAR_RATIO),
        }
    }

    /// The same orifice with a share of its conductance.
    pub(crate) fn scaled(self, share: f64) -> Self {
        Self { coefficient: share * self.coefficient, ..self }
    }

    /// Mass flow divided by pressure difference, kg/(s Pa), between two absolute pressures, Pa.
    ///
    /// Never negative and the same in both directions, so that a network of chords obeys the
    /// maximum principle whatever the step.
    pub(crate) fn chord(&self, one_abs_pa: f64, other_abs_pa: f64) -> f64 {
        let (up, down) =
            if one_abs_pa >= other_abs_pa { (one_abs_pa, other_abs_pa) } else { (other_abs_pa, one_abs_pa) };
        if down >= LAMINAR_RATIO * up {
            return self.coefficient * self.laminar_slope;
        }
        let r = down / up;
        let phi = if r <= self.critical_ratio {
            1.0
        } else {
            let u = (r - self.critical_ratio) * self.inverse_span;
            (1.0 - u * u).sqrt()
        };
        self.coefficient * phi / (1.0 - r)
    }
}

/// Sonic conductance (m3/(s Pa)) and critical ratio of a smooth tube, after Eckersten's formula
/// in the SI form `C = 0.029 d^2 / sqrt(L/d^1.25 + 510)`, `b = 474 C/d^2`.
pub(crate) fn tube_conductance(length_m: f64, bore_m: f64) -> (f64, f64) {
    let area = bore_m * bore_m;
    let c = 0.029 * area / (length_m / (bore_m * bore_m.sqrt().sqrt()) + 510.0).sqrt();
    (c, 474.0 * c / area)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(o: &Orifice, up: f64, down: f64) -> f64 {
        o.chord(up, down) * (up - down)
    }

    #[test]
    fn choked_flow_is_conductance_times_density_times_upstream_pressure() {
        let o = Orifice::new(1.44e-9, 0.3, 293.15);
        for down in [0.0, 50e3, 0.3 * 301_325.0] {
            let expected = 1.44e-9 * 1.185 * 301_325.0;
            assert!((flow(&o, 301_325.0, down) / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn subsonic_flow_lies_on_the_ellipse() {
        let o = Orifice::new(1.44e-9, 0.3, 293.15);
        // (r-b)/(1-b) = 3/5 gives phi = 4/5.
        let up = 200e3;
        let down = (0.3 + 0.7 * 0.6) * up;
        let expected = 1.44e-9 * 1.185 * up * 0.8;
        assert!((flow(&o, up, down) / expected - 1.0).abs() < 1e-14);
        assert!((flow(&o, down, up) / expected + 1.0).abs() < 1e-14);
    }

    #[test]
    fn flow_is_continuous_into_the_linear_zone_and_zero_at_equal_pressure() {
        let o = Orifice::new(1.44e-9, 0.3, 293.15);
        let at = |r: f64| flow(&o, 100e3, 100e3 * r);
        let (below, above) = (at(LAMINAR_RATIO - 1e-9), at(LAMINAR_RATIO + 1e-9));
        assert!((below / above - 1.0).abs() < 1e-6);
        assert_eq!(at(1.0), 0.0);
        assert!((at(0.9975) / at(0.995) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn hot_gas_flows_less_by_the_root_of_temperature() {
        let (cold, hot) = (Orifice::new(1e-9, 0.3, 293.15), Orifice::new(1e-9, 0.3, 4.0 * 293.15));
        let ratio = flow(&hot, 3e5, 1e5) / flow(&cold, 3e5, 1e5);
        assert!((ratio - 0.5).abs() < 1e-14);
    }

    #[test]
    fn metre_of_two_and_a_half_millimetre_tube() {
        // C = 0.378 dm3/(s bar), b = 0.29, worked by hand from the formula.
        let (c, b) = tube_conductance(1.0, 2.5e-3);
        assert!((c - 3.78e-9).abs() < 0.005e-9, "{c}");
        assert!((b - 0.287).abs() < 0.001, "{b}");
    }
}
