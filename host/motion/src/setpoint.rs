//! The state of a module at a setpoint.

use fra_model::{Load, State, Status};

use softlimb_limb::LimbModule;

/// Reason why a module has no state at a setpoint. Pressures are gauge, Pa.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoState {
    Invalid(String),
    BeyondLimit(Option<f64>),
    NotConverged,
    Vacuum(f64),
    OverPressure(f64),
}

/// The state at a setpoint that the module may take.
///
/// # Errors
/// [`NoState`].
pub(super) fn state_at(module: &LimbModule, start: &State<f64>, value: f64) -> Result<State<f64>, NoState> {
    let none = Load::none();
    let solution = match module.target(value) {
        Some(target) => module.actuator.inverse_from(start, target, &none),
        None => module.actuator.forward_from(start, value, &none),
    };
    let solution = solution.map_err(|error| NoState::Invalid(error.to_string()))?;
    match solution.status {
        Status::Solved => {}
        Status::NoSolution => return Err(NoState::BeyondLimit(solution.limit_pressure_pa)),
        Status::NotConverged => return Err(NoState::NotConverged),
    }
    let pressure_pa = solution.state.pressure_pa;
    // Rounding of a setpoint at rest may ask for a vacuum that no gauge sees.
    if pressure_pa < -1.0 {
        return Err(NoState::Vacuum(pressure_pa));
    }
    if pressure_pa > module.reference_max_pa * (1.0 + 1e-9) {
        return Err(NoState::OverPressure(pressure_pa));
    }
    Ok(solution.state)
}
