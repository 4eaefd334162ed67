//! Error of the analytic bending model against the finite elements of its cross-section.

use fra_model::{ActuatorParameters, Families, Motion, Placement, State};

/// Walls over the inner radius that the estimate was fitted to.
const WALL: [f64; 2] = [0.1, 1.0];
/// Largest stretch of the axis, winding angle from the hoop and strain of the thread of the fit.
const STRETCH_MAX: f64 = 1.6;
const ANGLE_MAX_DEG: f64 = 30.0;
const THREAD_STRAIN_MAX: f64 = 0.05;
/// Stretch of the axis, less one, below which the relative error no longer changes.
const STRAIN_LEAST: f64 = 0.002;

/// Relative error of the analytic bend that is accepted by default.
pub const BEND_TOLERANCE: f64 = 0.005;

/// Whether it is a bending actuator with a stated winding, in place of an ideal one that keeps its radius.
pub fn is_wound_bender(parameters: &ActuatorParameters<f64>) -> bool {
    parameters.motion == Motion::Bending && parameters.fiber.is_some_and(|fiber| fiber.modulus_pa > 0.0)
}

/// The largest [`analytic_bend_error`] of states under pressure; `None` where there are none, or one is outside its range.
pub fn largest_bend_error<'a>(
    parameters: &ActuatorParameters<f64>,
    states: impl IntoIterator<Item = &'a State<f64>>,
) -> Option<f64> {
    let larger =
        |most: Option<f64>, state| Some(Some(most.unwrap_or(0.0).max(analytic_bend_error(parameters, state)?)));
    states.into_iter().try_fold(None, larger).flatten()
}

/// An upper estimate of the relative error of the analytic bend angle, `|analytic / finite elements - 1|` at one pressure without load.
///
/// The analytic model has a thread that does not stretch and a winding that stays a circle.
/// The estimate is a fit to seeded actuators that leaves out fewer than 1 % of them; `docs/explanation/cross-section.md` has its equations. `None` outside the
/// range of the fit: walls of 0.1 to 1 inner radius, two equal families as a sheet at up to 30 deg, stretches up to 1.6, threads strained by up to 5 %.
pub fn analytic_bend_error(parameters: &ActuatorParameters<f64>, state: &State<f64>) -> Option<f64> {
    let wall = parameters.outer_radius_m / parameters.inner_radius_m - 1.0;
    let stretch = state.axial_stretch;
    // A little more than the range, for radii that are stated in decimals.
    let is_covered = parameters.motion == Motion::Bending
        && (WALL[0] - 1e-9..=WALL[1] + 1e-9).contains(&wall)
        && state.pressure_pa >= 0.0
        && (1.0..=STRETCH_MAX).contains(&stretch);
    if !is_covered {
        return None;
    }
    // A winding without a modulus keeps its radius.
    let Some(fiber) = parameters.fiber.filter(|fiber| fiber.modulus_pa > 0.0) else { return Some(0.01 + 0.05 * wall) };
    let thread_strain = state.pressure_pa * parameters.inner_radius_m / (4.0 * fiber.modulus_pa * fiber.thickness_m);
    let is_covered = fiber.placement == Placement::Sheet
        && fiber.families == Families::Two
        && fiber.radius_m == parameters.outer_radius_m
        && fiber.angle_rad.abs() <= ANGLE_MAX_DEG.to_radians() + 1e-9
        && thread_strain <= THREAD_STRAIN_MAX;
    if !is_covered {
        return None;
    }
    let slope = fiber.angle_rad.tan().powi(2);
    let strain = (stretch - 1.0).max(STRAIN_LEAST);
    let thick = 0.18 * wall.powf(1.9) * (-22.7 * strain).exp();
    let circle = 0.063 * strain.powf(1.07) * (-2.86 * slope).exp();
    let thread = 1.87 * thread_strain.powf(1.62) * strain.powf(-1.2) * (5.24 * slope).exp();
    Some(thick + circle + thread)
}
