//! What was found, asked of the model again.

use serde::Serialize;

use super::forces::{Forces, Placed};
use super::layout::{PLACED, Quantity};
use super::search::ZERO;
use softlimb_limb::payload::PayloadError;
use softlimb_numerics::least_squares::LeastSquares;

/// The answer to eq. (18).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// `"reached"`: nothing is left; `"best_found"`: the least objective of all local solves.
    pub status: &'static str,
    /// Eq. (18): the mean over samples of the weighted squares.
    pub objective: f64,
    /// The samples.
    pub samples: Vec<SampleAnswer>,
    /// The actuators.
    pub actuators: Vec<ActuatorAnswer>,
    /// Objectives evaluated.
    pub evaluations: u64,
    /// Jacobians evaluated.
    pub jacobians: u64,
    /// Descents made.
    pub starts: usize,
    /// Descents that agree with the best within 1e-9.
    pub agreeing: usize,
}

/// A wrench.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleAnswer {
    /// As wanted, N and N m.
    pub target: [f64; 6],
    /// As found.
    pub found: [f64; 6],
}

/// An actuator.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ActuatorAnswer {
    /// Its name.
    pub name: String,
    /// Inner radius at rest, m.
    pub inner_radius_m: f64,
    /// Outer radius at rest, m.
    pub outer_radius_m: f64,
    /// Length at rest, m.
    pub length_m: f64,
    /// Fiber angle from the hoop, deg.
    pub angle_deg: f64,
    /// Where it is attached, m.
    pub point_m: [f64; 3],
    /// Its axis.
    pub axis: [f64; 3],
    /// Gauge pressure in each sample, Pa.
    pub pressures_pa: Vec<f64>,
    /// Push in each sample, N.
    pub pushes_n: Vec<f64>,
    /// Bounds that hold, as `"wall_m max"`; a pressure with its sample.
    pub active_bounds: Vec<String>,
}

pub(super) fn answer(forces: &mut Forces<'_>, place: &[f64], starts: (usize, usize)) -> Result<Answer, PayloadError> {
    let (evaluations, jacobians) = (forces.evaluations, forces.jacobians);
    let point = forces.evaluate(place).ok_or_else(|| PayloadError::Solver("the place found has no forces".into()))?;
    let objective = forces.residuals(&point).iter().map(|r| r * r).sum::<f64>();
    let samples = point.wrenches.iter().zip(&forces.problem.samples);
    let actuators = point.actuators.iter().enumerate();
    Ok(Answer {
        status: if objective <= 100.0 * ZERO { "reached" } else { "best_found" },
        objective,
        samples: samples
            .map(|(found, sample)| SampleAnswer { target: sample.wrench, found: (*found).into() })
            .collect(),
        actuators: actuators.map(|(index, placed)| actuator(forces, index, placed, place)).collect(),
        evaluations,
        jacobians,
        starts: starts.0,
        agreeing: starts.1,
    })
}

fn actuator(forces: &Forces<'_>, index: usize, placed: &Placed, place: &[f64]) -> ActuatorAnswer {
    let active = |slot: &super::layout::Slot| {
        let at = place[slot.axis?];
        let end = if at <= 0.0 {
            "min"
        } else if at >= 1.0 {
            "max"
        } else {
            return None;
        };
        Some(match slot.quantity {
            Quantity::Pressure(sample) => format!("pressure_pa[{sample}] {end}"),
            other => format!("{} {end}", other.name()),
        })
    };
    let values = &placed.values;
    let attachment = &forces.problem.actuators[index];
    ActuatorAnswer {
        name: attachment.name.clone(),
        inner_radius_m: values[0],
        outer_radius_m: values[0] + values[1],
        length_m: values[2],
        angle_deg: attachment.tube.hand() * values[3].to_degrees(),
        point_m: placed.point_m.into(),
        axis: placed.axis.into(),
        pressures_pa: values[PLACED..].to_vec(),
        pushes_n: (0..placed.held.len()).map(|sample| placed.load(sample).x).collect(),
        active_bounds: forces.layout.slots[index].iter().filter_map(active).collect(),
    }
}
