//! States of an actuator over its pressures: polynomials through a few solutions.

use std::f64::consts::PI;

use fra_model::State;

use super::{EndLoad, Outcome, Section, SectionError};

/// Solutions; the polynomials have one degree less. Bends of tubes need about 15 for the error of the mesh, soft ones under high pressure more.
const NODES: usize = 25;

/// Share of the pressure at the end of a branch up to which states are interpolated: at the end itself their slopes are infinite.
const BELOW_END: f64 = 0.98;

/// States without load between no pressure and a highest one.
#[derive(Clone, Debug)]
pub struct Interpolated {
    states: [State<f64>; NODES],
    pressure_max_pa: f64,
    limit_pressure_pa: Option<f64>,
}

impl Section {
    /// The states of an actuator that is all such section over a length at rest, m, up to a gauge pressure, Pa, or to just below the end of
    /// its branch. `None` where the search for them fails.
    ///
    /// # Errors
    /// [`SectionError::Option`] for a pressure out of range.
    pub fn interpolated(&self, length_m: f64, pressure_max_pa: f64) -> Result<Option<Interpolated>, SectionError> {
        let mut limit_pressure_pa = None;
        let mut highest_pa = pressure_max_pa;
        // The end of a branch is known once it was passed.
        for _ in 0..2 {
            let pressures_pa: [f64; NODES] = std::array::from_fn(|node| highest_pa * share(node));
            let curve = self.curve(&pressures_pa, &EndLoad::default())?;
            let states: Option<Vec<State<f64>>> =
                curve.answers.iter().map(|answer| Some(answer.equilibrium()?.state.over(length_m))).collect();
            if let Some(states) = states.and_then(|states| states.try_into().ok()) {
                return Ok(Some(Interpolated { states, pressure_max_pa: highest_pa, limit_pressure_pa }));
            }
            let end = curve.answers.iter().find_map(|answer| match answer.outcome {
                Outcome::NoEquilibrium { limit_pressure_pa } => Some(limit_pressure_pa),
                _ => None,
            });
            let Some(end_pa) = end.filter(|end_pa| *end_pa > 0.0) else { return Ok(None) };
            (limit_pressure_pa, highest_pa) = (Some(end_pa), BELOW_END * end_pa);
        }
        Ok(None)
    }
}

impl Interpolated {
    /// The highest pressure, gauge Pa.
    pub fn pressure_max_pa(&self) -> f64 {
        self.pressure_max_pa
    }

    /// The end of the branch where it comes before the highest pressure that was to be reached, gauge Pa.
    pub fn limit_pressure_pa(&self) -> Option<f64> {
        self.limit_pressure_pa
    }

    /// The state at a gauge pressure, Pa, clamped to the range; by the barycentric formula.
    pub fn at(&self, pressure_pa: f64) -> State<f64> {
        let at = (pressure_pa / self.pressure_max_pa).clamp(0.0, 1.0);
        let offsets: [f64; NODES] = std::array::from_fn(|node| at - share(node));
        if let Some(node) = offsets.iter().position(|offset| *offset == 0.0) {
            return self.states[node];
        }
        let weights: [f64; NODES] = std::array::from_fn(|node| {
            let end = if node == 0 || node == NODES - 1 { 0.5 } else { 1.0 };
            if node % 2 == 0 { end / offsets[node] } else { -end / offsets[node] }
        });
        let whole: f64 = weights.iter().sum();
        State::combine(self.states.each_ref(), |values| {
            values.iter().zip(&weights).map(|(value, weight)| value * weight).sum::<f64>() / whole
        })
    }
}

/// Place of a node, of the range: they crowd towards both ends.
fn share(node: usize) -> f64 {
    (0.5 * PI * node as f64 / (NODES - 1) as f64).sin().powi(2)
}
