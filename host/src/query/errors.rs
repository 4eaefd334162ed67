//! Errors of an answer, and the choice of the model that they ask for.

use fra_model::{Load, Motion, State, StateQuantity, Status};
use serde::Serialize;

use super::request::{Case, Model, Question};
use super::section_fe::{SectionQuery, solve_section};
use super::two_windings;
use softlimb_fea::cross_section::analytic_bend_error;
use softlimb_limb::{Bent, winding_effect};

/// Errors of the closed forms and of the search, in units of the precision times the condition number.
const ROUNDING: f64 = 10.0;
/// Relative error to which the finite element equations are solved.
const SECTION_ROUNDING: f64 = 1e-9;
/// Relative step of a numeric derivative.
const STEP: f64 = 1e-4;

/// Relative errors of the answer: of the deformation, or of the pressure in an inverse problem.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Errors {
    #[serde(skip_serializing_if = "Option::is_none")]
    rounding: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    discretisation: Option<f64>,
    /// Against finite elements of the cross-section; absent where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) model: Option<f64>,
    /// The largest change of the bend if the winding is 2 deg off.
    #[serde(skip_serializing_if = "Option::is_none")]
    winding_2deg: Option<f64>,
}

/// Upper estimate of the analytic bend's error, where there is one: without load, among other conditions.
pub(super) fn estimated(case: &Case, state: &State<f64>) -> Option<f64> {
    analytic_bend_error(&case.parameters, state).filter(|_| case.load == Load::none())
}

/// Errors of an analytic answer. Without a request for all of them, those of the model and of the winding alone.
pub(super) fn of_analytic(case: &Case, state: &State<f64>, precision: f64) -> Errors {
    let is_stated = case.errors || case.model == Model::Analytic;
    let model = if case.parameters.motion != Motion::Bending {
        Some(0.0)
    } else {
        estimated(case, state).or_else(|| is_stated.then(|| against_section(case, state)).flatten())
    };
    let winding_2deg = case.winding.then(|| winding(case, state, false)).flatten();
    if !case.errors {
        return Errors { model, winding_2deg, ..Errors::default() };
    }
    Errors {
        rounding: condition(case, state).map(|condition| ROUNDING * precision * condition.max(1.0)),
        discretisation: Some(0.0),
        model,
        winding_2deg,
    }
}

/// Errors of an answer by finite elements, with the error of discretisation of its quantity.
pub(super) fn of_section(case: &Case, state: &State<f64>, discretisation: Option<f64>) -> Errors {
    Errors {
        rounding: case.errors.then_some(SECTION_ROUNDING),
        discretisation: discretisation.and_then(|error| relative(error, natural(case, state))),
        model: Some(0.0),
        winding_2deg: case.winding.then(|| winding(case, state, true)).flatten(),
    }
}

/// Error of the analytic bend against finite elements at its pressure, theirs of discretisation added. `None` where they have no equilibrium.
fn against_section(case: &Case, state: &State<f64>) -> Option<f64> {
    let Case { parameters, range, load, .. } = case;
    let question = Question::Forward { pressure_pa: state.pressure_pa };
    let query = SectionQuery { parameters, second_fiber: None, question, range: *range, load: *load };
    let found = solve_section(&query).ok()?;
    let bend = natural(case, found.state.as_ref()?);
    relative((natural(case, state) - bend).abs() + found.error?.natural(parameters.motion), bend)
}

/// An error relative to a deformation; `None` where that is rounding alone.
fn relative(error: f64, deformation: f64) -> Option<f64> {
    (deformation.abs() > SECTION_ROUNDING).then(|| error / deformation.abs())
}

/// The deformation that the motion is named after.
fn natural(case: &Case, state: &State<f64>) -> f64 {
    StateQuantity::natural(case.parameters.motion).of(state)
}

/// Relative change of the answer over that of the given value.
fn condition(case: &Case, state: &State<f64>) -> Option<f64> {
    if state.pressure_pa == 0.0 {
        return Some(1.0);
    }
    let actuator = two_windings::tube(case).ok()?;
    let at = |factor: f64| {
        let found = actuator.forward(factor * state.pressure_pa, &case.load).ok()?;
        (found.status == Status::Solved).then(|| natural(case, &found.state))
    };
    // One-sided next to a limit point.
    let (low, high, width) = match at(1.0 + STEP) {
        Some(high) => (at(1.0 - STEP)?, high, 2.0 * STEP),
        None => (at(1.0 - STEP)?, natural(case, state), STEP),
    };
    let slope = ((high - low) / (width * high)).abs();
    Some(match case.question {
        Question::Forward { .. } => slope,
        Question::Inverse { .. } => slope.recip(),
    })
}

/// The largest relative change of the bend with every winding 2 deg more or less, at the answer's pressure and by its model.
fn winding(case: &Case, state: &State<f64>, by_section: bool) -> Option<f64> {
    let bent = Bent { pressure_pa: state.pressure_pa, bend_angle_rad: state.bend_angle_rad };
    winding_effect(&case.parameters, case.second_fiber.as_ref(), &[bent], &case.load, by_section)
}
