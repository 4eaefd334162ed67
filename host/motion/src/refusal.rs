//! Whether a module takes a setpoint, and why not.

use fra_model::{Load, State, Status};

use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Corrections, Located, Scene, SceneError, SetpointKind, Span};

/// The state at a setpoint, or why there is none that the module may take.
pub(super) fn state_at(module: &LimbModule, start: &State<f64>, value: f64) -> Result<State<f64>, Refusal> {
    let none = Load::none();
    let solution = match module.target(value) {
        Some(target) => module.actuator.inverse_from(start, target, &none),
        None => module.actuator.forward_from(start, value, &none),
    };
    let solution = solution.map_err(|error| Refusal::Invalid(error.to_string()))?;
    match solution.status {
        Status::Solved => {}
        Status::NoSolution => return Err(Refusal::BeyondLimit(solution.limit_pressure_pa)),
        Status::NotConverged => return Err(Refusal::NotConverged),
    }
    let pressure_pa = solution.state.pressure_pa;
    // Rounding of a setpoint at rest may ask for a vacuum that no gauge sees.
    if pressure_pa < -1.0 {
        return Err(Refusal::Vacuum(pressure_pa));
    }
    if pressure_pa > module.reference_max_pa * (1.0 + 1e-9) {
        return Err(Refusal::OverPressure(pressure_pa));
    }
    Ok(solution.state)
}

/// Why a module does not take a setpoint.
pub(super) enum Refusal {
    Invalid(String),
    BeyondLimit(Option<f64>),
    NotConverged,
    Vacuum(f64),
    OverPressure(f64),
}

impl Refusal {
    /// The reason in words.
    pub(super) fn label(&self, module: &LimbModule) -> String {
        let kpa = |pa: f64| format!("{:.2} kPa", pa * 1e-3);
        let allowed = kpa(module.reference_max_pa);
        let limit = kpa(module.pressure_max_pa);
        match self {
            Self::Invalid(message) => message.clone(),
            Self::BeyondLimit(Some(limit)) => format!("beyond the limit point of `{}` at {}", module.name, kpa(*limit)),
            Self::BeyondLimit(None) => format!("`{}` reaches this at no pressure", module.name),
            Self::NotConverged => format!("the model finds no state of `{}` for this", module.name),
            Self::Vacuum(pressure) => {
                format!("`{}` would need {}: a vacuum, which the valves cannot make", module.name, kpa(*pressure))
            }
            Self::OverPressure(pressure) => {
                format!(
                    "`{}` would need {}; the device follows up to {allowed}, a margin below `pressure_max` of {limit}",
                    module.name,
                    kpa(*pressure)
                )
            }
        }
    }
}

/// Checks that a module takes a target.
///
/// # Errors
/// A diagnostic at the target, with the range that the module reaches.
pub(super) fn check_target(scene: &Scene, module: &LimbModule, value: f64, span: Span) -> Result<(), SceneError> {
    let refusal = match state_at(module, &module.actuator.rest(), value) {
        Ok(_) => return Ok(()),
        Err(refusal) => refusal,
    };
    let (rest, most) = module.range();
    let help = format!(
        "between rest and {:.2} kPa it reaches {} to {}",
        module.curve.pressure_max_pa() * 1e-3,
        in_units(module.kind, rest),
        in_units(module.kind, most)
    );
    Err(scene.diagnostic(span, "this target is out of the module's reach", &refusal.label(module), Some(&help)))
}

/// Refuses corrections of a scene that are larger than what a module has: they are in another unit, or of another limb.
///
/// # Errors
/// A diagnostic at the name of their file, with row, module and range.
pub(super) fn check_corrections(
    scene: &Scene,
    limb: &Limb,
    corrections: &Located<Corrections>,
) -> Result<(), SceneError> {
    for (time_s, row) in corrections.times_s.iter().zip(&corrections.rows) {
        for (module, value) in limb.modules().iter().zip(row) {
            let (rest, last) = module.range();
            if value.abs() > (last - rest).abs() {
                let title = format!("the correction of `{}` at {time_s} s is larger than its range", module.name);
                let [value, rest, last] = [*value, rest, last].map(|value| in_units(module.kind, value));
                let label = format!("{value} here, and setpoints are from {rest} to {last}");
                let help = "corrections are in m, rad or Pa, as `softlimb learn --csv` writes them";
                return Err(scene.diagnostic(corrections.span, &title, &label, Some(help)));
            }
        }
    }
    Ok(())
}

/// A setpoint as people read it.
pub(super) fn in_units(kind: SetpointKind, value: f64) -> String {
    match kind {
        SetpointKind::Pressure => format!("{:.2} kPa", value * 1e-3),
        SetpointKind::AxialStretch => format!("{value:.4}"),
        SetpointKind::OuterRadius | SetpointKind::InnerRadius => format!("{:.3} mm", value * 1e3),
        SetpointKind::Twist | SetpointKind::BendAngle => format!("{:.2} deg", value.to_degrees()),
    }
}
