//! The setpoints of a whole run, checked against what the limb can do.

use fra_model::{Load, State, Status};

use super::inverse_kinematics::solve_tip;
use super::profile::{PEAK_RATE, minimum_jerk};
use super::wire::{from_wire, to_wire};
use crate::design::{Limb, LimbModule};
use crate::scene::{Goal, Phase, Scene, SceneError, SetpointKind, Span};

/// A phase on the clock of the run, with the value of every module at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPhase {
    /// Its name in the scene.
    pub name: String,
    /// Start, us after the start of the run.
    pub start_us: u64,
    /// Time of its move, us.
    pub move_us: u64,
    /// Time it rests at its goal, us.
    pub hold_us: u64,
    /// Setpoint of every module at its end.
    pub values: Vec<f64>,
}

/// All setpoints of a run: one row per knot, one value per module.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Time between two knots, us.
    pub knot_period_us: u64,
    /// The phases.
    pub phases: Vec<PlannedPhase>,
    kinds: Vec<SetpointKind>,
    /// Setpoints as the device gets them, in wire units.
    knots: Vec<Vec<i32>>,
    /// The limb's states at the knots, by the model.
    states: Vec<Vec<State<f64>>>,
}

impl Plan {
    /// Time of the last knot, us after the start.
    pub fn duration_us(&self) -> u64 {
        (self.knots.len().saturating_sub(1)) as u64 * self.knot_period_us
    }

    /// Wire values per module at every knot.
    pub fn knots(&self) -> &[Vec<i32>] {
        &self.knots
    }

    /// Setpoint of every module at a time, interpolated between knots as the device does.
    pub fn values_at(&self, time_us: f64) -> Vec<f64> {
        let (before, after, share) = self.between(time_us);
        let modules = self.kinds.iter().zip(&self.knots[before]).zip(&self.knots[after]);
        modules
            .map(|((kind, a), b)| {
                let (a, b) = (from_wire(*kind, *a), from_wire(*kind, *b));
                a + (b - a) * share
            })
            .collect()
    }

    /// States that the model gives for the setpoints at a time.
    pub fn states_at(&self, time_us: f64) -> Vec<State<f64>> {
        let (before, after, share) = self.between(time_us);
        self.states[before]
            .iter()
            .zip(&self.states[after])
            .map(|(a, b)| State::combine([a, b], |[a, b]| a + (b - a) * share))
            .collect()
    }

    fn between(&self, time_us: f64) -> (usize, usize, f64) {
        let last = self.knots.len() - 1;
        let position = (time_us / self.knot_period_us as f64).clamp(0.0, last as f64);
        let before = position as usize;
        (before, (before + 1).min(last), position - before as f64)
    }
}

/// Plans all phases of a scene.
///
/// # Errors
/// A diagnostic at the target, way-point or duration that the limb cannot follow, with the nearest value that it can.
pub fn plan(scene: &Scene, limb: &Limb) -> Result<Plan, SceneError> {
    let mut values: Vec<f64> = limb.modules().iter().map(|module| module.measure(&module.actuator.rest())).collect();
    let start = values.clone();
    let mut phases = Vec::new();
    let mut start_us = 0;
    for phase in scene.phases() {
        let goal = goal_values(scene, limb, phase, &values)?;
        check_rates(scene, limb, phase, &values, &goal)?;
        let planned = PlannedPhase {
            name: phase.name.to_string(),
            start_us,
            move_us: *phase.move_us,
            hold_us: phase.hold_us,
            values: goal.clone(),
        };
        start_us += planned.move_us + planned.hold_us;
        phases.push(planned);
        values = goal;
    }
    let knot_period_us = u64::from(scene.controller().knot_period_us);
    let knots = knots(limb, &phases, &start, knot_period_us);
    let states = states(scene, limb, &phases, &knots, knot_period_us)?;
    Ok(Plan { knot_period_us, phases, kinds: limb.modules().iter().map(|m| m.kind).collect(), knots, states })
}

/// The value of every module at the end of a phase.
fn goal_values(scene: &Scene, limb: &Limb, phase: &Phase, before: &[f64]) -> Result<Vec<f64>, SceneError> {
    match &phase.goal {
        Goal::Targets(targets) => {
            let mut goal = before.to_vec();
            for target in targets {
                check_target(scene, &limb.modules()[target.module], target.value.value, target.value.span)?;
                goal[target.module] = target.value.value;
            }
            Ok(goal)
        }
        Goal::Tip(tip) => {
            let start: Vec<f64> = limb.modules().iter().zip(before).map(|(m, v)| pressure_near(m, *v)).collect();
            let reach = solve_tip(limb, tip.value, &start);
            if !reach.reached() {
                return Err(unreachable_tip(scene, tip.span, &reach));
            }
            let modules = limb.modules().iter().zip(&reach.pressures_pa);
            Ok(modules.map(|(module, pressure)| module.measure(&module.curve.at(*pressure))).collect())
        }
    }
}

fn pressure_near(module: &LimbModule, value: f64) -> f64 {
    let off = |state: &&State<f64>| (module.measure(state) - value).abs();
    let nearest = module.curve.states().iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.map_or(0.0, |state| state.pressure_pa)
}

fn unreachable_tip(scene: &Scene, span: Span, reach: &super::Reach) -> SceneError {
    let [x, y, z] = reach.tip_m.map(|v| v * 1e3);
    let label = format!("the nearest the tip gets is {:.1} mm away", reach.distance_m * 1e3);
    let help = format!("the nearest reachable point is [\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]");
    scene.diagnostic(span, "the limb cannot reach this way-point", &label, Some(&help))
}

/// The state at a setpoint, or why there is none that the module may take.
fn state_at(module: &LimbModule, start: &State<f64>, value: f64) -> Result<State<f64>, Refusal> {
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
enum Refusal {
    Invalid(String),
    BeyondLimit(Option<f64>),
    NotConverged,
    Vacuum(f64),
    OverPressure(f64),
}

impl Refusal {
    fn label(&self, module: &LimbModule) -> String {
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

fn check_target(scene: &Scene, module: &LimbModule, value: f64, span: Span) -> Result<(), SceneError> {
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

/// A setpoint as people read it.
pub(super) fn in_units(kind: SetpointKind, value: f64) -> String {
    match kind {
        SetpointKind::Pressure => format!("{:.2} kPa", value * 1e-3),
        SetpointKind::AxialStretch => format!("{value:.4}"),
        SetpointKind::OuterRadius | SetpointKind::InnerRadius => format!("{:.3} mm", value * 1e3),
        SetpointKind::Twist | SetpointKind::BendAngle => format!("{:.2} deg", value.to_degrees()),
    }
}

fn check_rates(scene: &Scene, limb: &Limb, phase: &Phase, from: &[f64], to: &[f64]) -> Result<(), SceneError> {
    let limits = scene.limits();
    let seconds = *phase.move_us as f64 * 1e-6;
    for (module, (a, b)) in limb.modules().iter().zip(from.iter().zip(to)) {
        let limit = match module.kind {
            SetpointKind::AxialStretch => limits.stretch_rate_max_per_s,
            SetpointKind::OuterRadius | SetpointKind::InnerRadius => limits.radius_rate_max_m_per_s,
            SetpointKind::Twist | SetpointKind::BendAngle => limits.angle_rate_max_rad_per_s,
            SetpointKind::Pressure => None,
        };
        let peak = PEAK_RATE * (b - a).abs() / seconds;
        if let Some(limit) = limit.filter(|limit| peak > *limit) {
            let label = format!(
                "`{}` would move at up to {}/s; the limit is {}/s",
                module.name,
                in_units(module.kind, peak),
                in_units(module.kind, limit)
            );
            let help =
                format!("a duration of {:.2} s is enough", (seconds * peak / limit * 100.0 - 1e-6).ceil() / 100.0);
            return Err(scene.diagnostic(phase.move_us.span, "this move is too fast", &label, Some(&help)));
        }
    }
    Ok(())
}

/// Samples the moves at the knots, in wire units. The last knot is at or just behind the end of the last phase.
fn knots(limb: &Limb, phases: &[PlannedPhase], start: &[f64], period_us: u64) -> Vec<Vec<i32>> {
    let end_us = phases.last().map_or(0, |phase| phase.start_us + phase.move_us + phase.hold_us);
    let kinds: Vec<SetpointKind> = limb.modules().iter().map(|module| module.kind).collect();
    let value_at = |time_us: u64| -> Vec<i32> {
        let index = phases.iter().rposition(|phase| phase.start_us <= time_us).unwrap_or(0);
        let before = if index == 0 { start } else { &phases[index - 1].values };
        let Some(phase) = phases.get(index) else { return to_wire_row(&kinds, start) };
        let share = minimum_jerk((time_us - phase.start_us) as f64 / phase.move_us as f64);
        let row: Vec<f64> = before.iter().zip(&phase.values).map(|(a, b)| a + (b - a) * share).collect();
        to_wire_row(&kinds, &row)
    };
    (0..=end_us.div_ceil(period_us)).map(|knot| value_at(knot * period_us)).collect()
}

fn to_wire_row(kinds: &[SetpointKind], row: &[f64]) -> Vec<i32> {
    kinds.iter().zip(row).map(|(kind, value)| to_wire(*kind, *value)).collect()
}

/// The model's states at all knots: the check that a move stays within reach also between its ends.
fn states(
    scene: &Scene,
    limb: &Limb,
    phases: &[PlannedPhase],
    knots: &[Vec<i32>],
    period_us: u64,
) -> Result<Vec<Vec<State<f64>>>, SceneError> {
    let mut here: Vec<State<f64>> = limb.modules().iter().map(|module| module.actuator.rest()).collect();
    let mut last: Option<&Vec<i32>> = None;
    let mut all = Vec::with_capacity(knots.len());
    for (index, knot) in knots.iter().enumerate() {
        // While the limb rests its states do, too.
        if last != Some(knot) {
            for ((module, state), wire) in limb.modules().iter().zip(&mut here).zip(knot) {
                *state = state_at(module, state, from_wire(module.kind, *wire)).map_err(|refusal| {
                    let time_us = index as u64 * period_us;
                    let phase = phases.iter().rposition(|phase| phase.start_us <= time_us).unwrap_or(0);
                    let title = "on the way to its goal this phase leaves what the limb can reach";
                    scene.diagnostic(scene.phases()[phase].span, title, &refusal.label(module), None)
                })?;
            }
            last = Some(knot);
        }
        all.push(here.clone());
    }
    Ok(all)
}
