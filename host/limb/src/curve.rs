//! The states of one actuator over its pressure range, solved once and interpolated.

use fra_model::{Actuator, ActuatorParameters, Fiber, Load, State, Status};
use softlimb_fea::cross_section::{Options, Section};

/// Nodes of the curve; cubic interpolation between them.
const NODES: usize = 257;

/// States at evenly spaced pressures from zero to the highest the branch reaches below the module's limit.
#[derive(Clone, Debug)]
pub struct StateCurve {
    states: Vec<State<f64>>,
    step_pa: f64,
    limit_point_pa: Option<f64>,
}

impl StateCurve {
    /// Solves the curve of an unloaded actuator up to `pressure_max_pa`, or to just below its limit point.
    pub fn new(actuator: &Actuator<f64>, pressure_max_pa: f64) -> Self {
        let (reach, limit_point_pa) = reachable_pressure(actuator, pressure_max_pa);
        let step_pa = reach / (NODES - 1) as f64;
        let mut states = vec![actuator.rest()];
        for node in 1..NODES {
            let start = states[node - 1];
            let pressure_pa = step_pa * node as f64;
            match actuator.forward_from(&start, pressure_pa, &Load::none()) {
                Ok(solution) if solution.status == Status::Solved => states.push(solution.state),
                _ => break,
            }
        }
        Self { states, step_pa, limit_point_pa }
    }

    /// The curve of an unloaded actuator with one or two windings by finite elements of its section, up to `pressure_max_pa` or to just below the
    /// end of its branch.
    ///
    /// # Errors
    /// The reason why they have none.
    pub fn by_section(
        parameters: &ActuatorParameters<f64>,
        second_fiber: Option<&Fiber<f64>>,
        pressure_max_pa: f64,
    ) -> Result<Self, String> {
        let options = Options::default();
        let section = match second_fiber {
            None => Section::new(parameters, &options),
            Some(second) => Section::with_two_windings(parameters, second, &options),
        };
        let states = section.and_then(|section| section.interpolated(parameters.length_m, pressure_max_pa));
        let states = states.map_err(|error| error.to_string())?;
        let states = states.ok_or_else(|| format!("the search for its equilibria up to {pressure_max_pa} Pa fails"))?;
        let step_pa = states.pressure_max_pa() / (NODES - 1) as f64;
        // The sum takes the sign off a zero. Rounding bends an actuator at rest backwards, which no device accepts.
        let unsigned = |state: State<f64>| {
            let state = State::combine([&state], |[value]| value + 0.0);
            State { bend_angle_rad: state.bend_angle_rad.max(0.0), ..state }
        };
        let nodes = (0..NODES).map(|node| unsigned(states.at(step_pa * node as f64))).collect();
        Ok(Self { states: nodes, step_pa, limit_point_pa: states.limit_pressure_pa() })
    }

    /// A curve of other states for the nodes of this one, as many as there are, from the one at rest on.
    pub(crate) fn with_states(&self, states: Vec<State<f64>>) -> Self {
        Self { states, ..*self }
    }

    /// The same curve with another limit point, gauge Pa.
    pub(crate) fn with_limit_point(self, limit_point_pa: Option<f64>) -> Self {
        Self { limit_point_pa, ..self }
    }

    /// The pressure between two nodes, Pa.
    pub(crate) fn step_pa(&self) -> f64 {
        self.step_pa
    }

    /// The highest pressure of the curve, gauge Pa.
    pub fn pressure_max_pa(&self) -> f64 {
        self.step_pa * (self.states.len() - 1) as f64
    }

    /// The actuator's limit point where it comes before the highest pressure that the curve was to have, gauge Pa.
    pub fn limit_point_pa(&self) -> Option<f64> {
        self.limit_point_pa
    }

    /// The states at the nodes, from rest upwards.
    pub fn states(&self) -> &[State<f64>] {
        &self.states
    }

    /// The state whose quantity has a value, the first from rest upwards; `None` where none has.
    ///
    /// The quantity is taken as monotone between two nodes.
    pub fn find(&self, quantity: impl Fn(&State<f64>) -> f64, value: f64) -> Option<State<f64>> {
        let off = |state: &State<f64>| quantity(state) - value;
        if off(&self.states[0]) == 0.0 {
            return Some(self.states[0]);
        }
        let cell = self.states.windows(2).position(|pair| off(&pair[0]) * off(&pair[1]) <= 0.0)?;
        let (mut low, mut high) = (self.step_pa * cell as f64, self.step_pa * (cell + 1) as f64);
        let (mut at_low, mut at_high) = (off(&self.states[cell]), off(&self.states[cell + 1]));
        let whole = (at_high - at_low).abs();
        // Regula falsi, with the Illinois rule against an end that stays.
        for _ in 0..60 {
            let pressure_pa = if at_high == at_low { low } else { low - at_low * (high - low) / (at_high - at_low) };
            let state = self.at(pressure_pa);
            let here = off(&state);
            if here.abs() <= 1e-13 * whole || (high - low).abs() <= 1e-12 * self.step_pa {
                return Some(state);
            }
            if here * at_high <= 0.0 {
                (low, at_low) = (high, at_high);
            } else {
                at_low *= 0.5;
            }
            (high, at_high) = (pressure_pa, here);
        }
        Some(self.at(high))
    }

    /// Derivative of the state by the gauge pressure, 1/Pa, of the same interpolation as [`StateCurve::at`].
    pub fn slope_at(&self, pressure_pa: f64) -> State<f64> {
        let (neighbours, share, ends) = self.cell(pressure_pa);
        State::combine(neighbours, |values| cubic_slope(values, share, ends) / self.step_pa)
    }

    /// The state at a gauge pressure, clamped to the curve's ends.
    pub fn at(&self, pressure_pa: f64) -> State<f64> {
        let (neighbours, share, (at_start, at_end)) = self.cell(pressure_pa);
        State::combine(neighbours, |values| cubic(values, share, at_start, at_end))
    }

    /// The nodes about a pressure, its share of the cell, and whether the cell is the first or the last.
    fn cell(&self, pressure_pa: f64) -> ([&State<f64>; 4], f64, (bool, bool)) {
        let last = self.states.len() - 1;
        let position = (pressure_pa / self.step_pa).clamp(0.0, last as f64);
        let cell = (position as usize).min(last.saturating_sub(1));
        let node = |offset: isize| &self.states[cell.saturating_add_signed(offset).min(last)];
        ([node(-1), node(0), node(1), node(2)], position - cell as f64, (cell == 0, cell + 2 > last))
    }
}

/// Cubic Hermite between the two middle values with central slopes; one-sided ones at the ends.
fn cubic(values: [f64; 4], t: f64, at_start: bool, at_end: bool) -> f64 {
    let [_, b, c, _] = values;
    let [slope_b, slope_c] = slopes(values, at_start, at_end);
    let (t2, t3) = (t * t, t * t * t);
    b * (2.0 * t3 - 3.0 * t2 + 1.0) + slope_b * (t3 - 2.0 * t2 + t) + c * (3.0 * t2 - 2.0 * t3) + slope_c * (t3 - t2)
}

/// Derivative of [`cubic`] by `t`.
fn cubic_slope(values: [f64; 4], t: f64, (at_start, at_end): (bool, bool)) -> f64 {
    let [_, b, c, _] = values;
    let [slope_b, slope_c] = slopes(values, at_start, at_end);
    let t2 = t * t;
    6.0 * (c - b) * (t - t2) + slope_b * (3.0 * t2 - 4.0 * t + 1.0) + slope_c * (3.0 * t2 - 2.0 * t)
}

fn slopes([a, b, c, d]: [f64; 4], at_start: bool, at_end: bool) -> [f64; 2] {
    let slope_b = if at_start { 2.0 * (c - b) - 0.5 * (if at_end { c - b } else { d - b }) } else { 0.5 * (c - a) };
    let slope_c = if at_end { 2.0 * (c - b) - 0.5 * (if at_start { c - b } else { c - a }) } else { 0.5 * (d - b) };
    [slope_b, slope_c]
}

/// The module's limit, or a little below the actuator's limit point where that comes first; and that point.
fn reachable_pressure(actuator: &Actuator<f64>, pressure_max_pa: f64) -> (f64, Option<f64>) {
    match actuator.forward(pressure_max_pa, &Load::none()) {
        Ok(solution) if solution.status == Status::Solved => (pressure_max_pa, None),
        Ok(solution) => {
            let limit = solution.limit_pressure_pa;
            (limit.map_or(0.0, |limit| 0.98 * limit.clamp(0.0, pressure_max_pa)), limit)
        }
        Err(_) => (0.0, None),
    }
}

#[cfg(test)]
mod tests {
    use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};

    use super::*;

    fn parameters(motion: Motion, angle_deg: f64) -> ActuatorParameters<f64> {
        ActuatorParameters {
            motion,
            inner_radius_m: 10e-3,
            outer_radius_m: 14e-3,
            length_m: 0.24,
            material: Material::NeoHookean { shear_modulus_pa: 0.223e6 },
            fiber: Some(Fiber {
                angle_rad: angle_deg.to_radians(),
                families: if motion == Motion::Twisting { Families::One } else { Families::Two },
                modulus_pa: 361e6,
                placement: Placement::Sheet,
                thickness_m: 0.178e-3,
                radius_m: 14e-3,
            }),
        }
    }

    #[test]
    fn curve_is_the_model_between_its_nodes() {
        for (motion, angle) in [(Motion::Extension, 3.0), (Motion::Twisting, 28.0), (Motion::Bending, 0.0)] {
            let actuator = Actuator::new(&parameters(motion, angle)).unwrap();
            let curve = StateCurve::new(&actuator, 60e3);
            for pressure_pa in [0.0, 50.0, 777.0, 12_345.0, 31_234.0, 59_990.0, 60e3] {
                let exact = actuator.forward(pressure_pa, &Load::none()).unwrap().state;
                let found = curve.at(pressure_pa);
                assert!((found.axial_stretch - exact.axial_stretch).abs() < 1e-7, "{motion:?} {pressure_pa}");
                assert!((found.bend_angle_rad - exact.bend_angle_rad).abs() < 1e-6);
                assert!((found.twist_rad - exact.twist_rad).abs() < 1e-6);
                assert!((found.volume_m3 / exact.volume_m3 - 1.0).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn curve_ends_below_the_limit_point() {
        let actuator = Actuator::new(&parameters(Motion::Expansion, 90.0)).unwrap();
        let limit = actuator.forward(1e6, &Load::none()).unwrap().limit_pressure_pa.unwrap();
        let curve = StateCurve::new(&actuator, 1e6);
        assert!(curve.pressure_max_pa() < limit && curve.pressure_max_pa() > 0.95 * limit);
    }
}
