//! Questions to the finite element model of the section.

use fra_model::{Actuator, State, Status, Target};
use serde::Serialize;

use super::request::{Case, Question};
use crate::section::{Answer, EndLoad, Equilibrium, Options, Outcome, Section, SectionError};

/// Steps of the search for a pressure.
const STEPS: usize = 30;
/// Relative change of the pressure at which the search ends, far below the error of discretisation.
const TOLERANCE: f64 = 1e-10;

/// Error of discretisation of an answer, in its own units.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Discretisation {
    axial_stretch: f64,
    outer_radius_m: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
}

/// What the section model says of a case.
pub(super) struct Found {
    pub(super) status: Status,
    /// The equilibrium, if the status is [`Status::Solved`].
    pub(super) state: Option<State<f64>>,
    pub(super) error: Option<Discretisation>,
    pub(super) limit_pressure_pa: Option<f64>,
    pub(super) iterations: u32,
}

/// A section with the question's length and load, and the work done for it.
struct Asked<'a> {
    section: Section,
    case: &'a Case,
    load: EndLoad,
    iterations: u32,
}

/// Answers a case.
pub(super) fn solve(case: &Case) -> Result<Found, String> {
    let section = Section::new(&case.parameters, &Options::default()).map_err(plain)?;
    let load = EndLoad::of(&case.load, case.parameters.motion);
    let mut asked = Asked { section, case, load, iterations: 0 };
    match case.question {
        Question::Forward { pressure_pa } => {
            let answer = asked.at(pressure_pa)?;
            Ok(asked.found(&answer))
        }
        Question::Inverse { target } => asked.reach(target),
    }
}

fn plain(error: SectionError) -> String {
    error.to_string().replace("pressures_pa", "pressure_pa")
}

impl Asked<'_> {
    fn at(&mut self, pressure_pa: f64) -> Result<Answer, String> {
        let curve = self.section.curve(&[pressure_pa], &self.load).map_err(plain)?;
        self.iterations += curve.effort.newton_iterations;
        curve.answers.first().copied().ok_or_else(|| "the model gave no answer".into())
    }

    /// The pressure that reaches a target, from that of the analytic model by the secant method.
    fn reach(&mut self, target: Target<f64>) -> Result<Found, String> {
        let actuator = Actuator::new(&self.case.parameters).map_err(|error| error.to_string())?;
        let first = actuator.inverse(target, &self.case.load).map_err(|error| error.to_string())?;
        if first.status != Status::Solved || first.state.pressure_pa < 0.0 {
            return Ok(self.nothing(Status::NoSolution, first.limit_pressure_pa));
        }
        let mut before = (0.0, self.at(0.0)?);
        let mut now = (first.state.pressure_pa, self.at(first.state.pressure_pa)?);
        for _ in 0..STEPS {
            let (Some(old), Some(new)) = (self.miss(&before.1, target), self.miss(&now.1, target)) else {
                return Ok(self.nothing(Status::NoSolution, limit(&now.1)));
            };
            let step = if new == 0.0 { 0.0 } else { new * (now.0 - before.0) / (new - old) };
            let next = now.0 - step;
            if step.abs() <= TOLERANCE * now.0.abs() {
                return Ok(self.found(&now.1));
            }
            if !next.is_finite() || next < 0.0 {
                return Ok(self.nothing(Status::NoSolution, None));
            }
            before = now;
            now = (next, self.at(next)?);
        }
        Ok(self.nothing(Status::NotConverged, None))
    }

    /// How far an answer is beyond a target.
    fn miss(&self, answer: &Answer, target: Target<f64>) -> Option<f64> {
        let state = answer.equilibrium()?.state.over(self.case.parameters.length_m);
        Some(match target {
            Target::AxialStretch(value) => state.axial_stretch - value,
            Target::OuterRadius(value) => state.outer_radius_m - value,
            Target::InnerRadius(value) => state.inner_radius_m - value,
            Target::Twist(value) => state.twist_rad - value,
            Target::BendAngle(value) => state.bend_angle_rad - value,
        })
    }

    fn found(&self, answer: &Answer) -> Found {
        let length_m = self.case.parameters.length_m;
        let Some(equilibrium) = answer.equilibrium() else { return self.nothing(Status::NoSolution, limit(answer)) };
        Found {
            state: Some(equilibrium.state.over(length_m)),
            error: discretisation(equilibrium, length_m),
            ..self.nothing(Status::Solved, None)
        }
    }

    fn nothing(&self, status: Status, limit_pressure_pa: Option<f64>) -> Found {
        Found { status, state: None, error: None, limit_pressure_pa, iterations: self.iterations }
    }
}

fn limit(answer: &Answer) -> Option<f64> {
    match answer.outcome {
        Outcome::NoEquilibrium { limit_pressure_pa } => Some(limit_pressure_pa),
        _ => None,
    }
}

fn discretisation(equilibrium: &Equilibrium, length_m: f64) -> Option<Discretisation> {
    let error = equilibrium.error?;
    let [first, second] = error.bend_rates_rad_per_m;
    Some(Discretisation {
        axial_stretch: error.axial_strain,
        outer_radius_m: error.outer_radius_m,
        twist_rad: error.twist_rate_rad_per_m * length_m,
        bend_angle_rad: first.hypot(second) * length_m,
    })
}
