//! The state of a module at a setpoint.

use fra_model::{Load, State, StateQuantity, Status};

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
    if module.is_restrained() {
        return held_back(module, value);
    }
    if module.is_by_curve() {
        return on_curve(module, value);
    }
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
        // An equilibrium at a high pressure may lie on a branch that does not start at rest.
        return Err(if is_other_way(module, value) { other_way(module) } else { NoState::OverPressure(pressure_pa) });
    }
    Ok(solution.state)
}

/// Whether pressure moves a module away from a setpoint.
fn is_other_way(module: &LimbModule, value: f64) -> bool {
    let (rest, end) = module.range();
    (value - rest) * (end - rest) < 0.0
}

fn other_way(module: &LimbModule) -> NoState {
    NoState::Invalid(format!("pressure moves `{}` away from this value", module.name))
}

/// The state of a module whose actuators have no other model than their curve.
fn on_curve(module: &LimbModule, value: f64) -> Result<State<f64>, NoState> {
    if module.kind == StateQuantity::Pressure {
        let allowed_pa = module.range().1 * (1.0 + 1e-9);
        return match value {
            _ if value < -1.0 => Err(NoState::Vacuum(value)),
            _ if value <= allowed_pa => Ok(module.curve.at(value)),
            _ if module.curve.limit_point_pa().is_some() => Err(NoState::BeyondLimit(module.curve.limit_point_pa())),
            _ => Err(NoState::OverPressure(value)),
        };
    }
    module.state_at(value).ok_or_else(|| match module.curve.limit_point_pa() {
        _ if is_other_way(module, value) => other_way(module),
        None => NoState::Invalid(format!(
            "`{}` does not reach this below {:.2} kPa, which the device follows up to",
            module.name,
            module.curve.pressure_max_pa() * 1e-3
        )),
        limit_pa => NoState::BeyondLimit(limit_pa),
    })
}

/// The state of a module whose plates hold its actuators back: by its curve, which is the model of the bundle.
fn held_back(module: &LimbModule, value: f64) -> Result<State<f64>, NoState> {
    let within = module.kind != StateQuantity::Pressure || value <= module.range().1 * (1.0 + 1e-9);
    let found = module.state_at(value).filter(|_| within);
    if let Some(state) = found {
        let vacuum = module.kind == StateQuantity::Pressure && value < -1.0;
        return if vacuum { Err(NoState::Vacuum(value)) } else { Ok(state) };
    }
    if is_other_way(module, value) {
        return Err(other_way(module));
    }
    let (pressure_pa, share) = module.twist_share().unwrap_or_default();
    let why = if pressure_pa < module.reference_max_pa * (1.0 - 1e-9) {
        format!(
            "plates hold the actuators of `{}` back: it ends at {:.2} kPa, where they lean too far or touch, with {:.0} % of the twist of one alone",
            module.name,
            pressure_pa * 1e-3,
            100.0 * share
        )
    } else {
        format!(
            "plates hold the actuators of `{}` back: at {:.2} kPa it has {:.0} % of the twist of one alone",
            module.name,
            pressure_pa * 1e-3,
            100.0 * share
        )
    };
    Err(NoState::Invalid(why))
}
