//! The setpoints that reach the goal of a phase.

use super::inverse_kinematics::{Reach, TipGoal, TipTask, solutions, solve};
use super::setpoint::state_at;
use super::space::Space;
use super::unreachable::Unreachable;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::collision::Shape;
use softlimb_scene::{Goal, Phase, Scene};

/// Rows of setpoints, each of which meets the goal of a phase at its end; the preferred one first.
///
/// # Errors
/// [`Unreachable`]: a target, a way-point, a region or a direction.
pub(super) fn goals(
    scene: &Scene,
    limb: &Limb,
    space: &Space<'_>,
    phase: usize,
    before: &[f64],
) -> Result<Vec<Vec<f64>>, Unreachable> {
    match &scene.phases()[phase].goal {
        Goal::Targets(targets) => {
            let mut goal = before.to_vec();
            for (index, target) in targets.iter().enumerate() {
                let module = &limb.modules()[target.module];
                state_at(module, &module.actuator.rest(), target.value.value).map_err(|cause| Unreachable::Target {
                    phase,
                    target: index,
                    cause,
                })?;
                goal[target.module] = target.value.value;
            }
            check_clear(scene, limb, space, (before, &goal), phase)?;
            Ok(vec![goal])
        }
        Goal::Tip(_) | Goal::Inside(_) => tip_goals(scene, limb, phase, before),
        // A series is planned row by row, as way-points.
        Goal::Series(_) => Ok(vec![before.to_vec()]),
    }
}

/// The setpoints at one position of a marker series, from those at the position before.
///
/// # Errors
/// [`Unreachable::Marker`].
pub(super) fn marker(
    scene: &Scene,
    limb: &Limb,
    phase: usize,
    (position, tip_m): (usize, [f64; 3]),
    before: &[f64],
) -> Result<Vec<f64>, Unreachable> {
    let shapes = shapes(scene);
    let task =
        TipTask { goal: TipGoal::Point(tip_m), aim: None, obstacles: &shapes, clearance_m: scene.limits().clearance_m };
    let nearest = solve(limb, &task, &pressures(limb, before));
    if nearest.reached() { Ok(values(limb, &nearest)) } else { Err(Unreachable::Marker { phase, position, nearest }) }
}

/// The solids of a scene.
pub(super) fn shapes(scene: &Scene) -> Vec<&Shape> {
    scene.obstacles().iter().map(|obstacle| &obstacle.shape).collect()
}

/// What a phase asks of the tip; `None` where it asks nothing.
pub(super) fn tip_task<'a>(scene: &'a Scene, phase: &Phase, obstacles: &'a [&'a Shape]) -> Option<TipTask<'a>> {
    let goal = match &phase.goal {
        Goal::Tip(tip) => TipGoal::Point(tip.value),
        Goal::Inside(region) => TipGoal::Inside(&scene.regions()[region.value].shape),
        Goal::Targets(_) | Goal::Series(_) => return None,
    };
    Some(TipTask { goal, aim: phase.aim, obstacles, clearance_m: scene.limits().clearance_m })
}

fn tip_goals(scene: &Scene, limb: &Limb, phase: usize, before: &[f64]) -> Result<Vec<Vec<f64>>, Unreachable> {
    let shapes = shapes(scene);
    let Some(task) = tip_task(scene, &scene.phases()[phase], &shapes) else { return Ok(vec![before.to_vec()]) };
    let mut found = solutions(limb, &task, &pressures(limb, before));
    if found.iter().all(Reach::reached) {
        return Ok(found.iter().map(|reach| values(limb, reach)).collect());
    }
    Err(Unreachable::Tip { phase, before: before.to_vec(), nearest: found.swap_remove(0) })
}

/// Checks that setpoints which are given keep the limb clear.
fn check_clear(
    scene: &Scene,
    limb: &Limb,
    space: &Space<'_>,
    (before, goal): (&[f64], &[f64]),
    phase: usize,
) -> Result<(), Unreachable> {
    let Some(states) = space.states(goal) else { return Ok(()) };
    let Some(by) = space.nearest(&limb.body(&states), scene.limits().clearance_m) else { return Ok(()) };
    let fraction = space.blocked(before, goal).map_or(0.0, |blocked| blocked.share);
    Err(Unreachable::TooNear { phase, by, fraction })
}

/// The states of a reach.
pub(super) fn states(limb: &Limb, reach: &Reach) -> Vec<fra_model::State<f64>> {
    limb.modules().iter().zip(&reach.pressures_pa).map(|(module, pressure)| module.curve.at(*pressure)).collect()
}

/// The setpoints of a reach.
pub(super) fn values(limb: &Limb, reach: &Reach) -> Vec<f64> {
    limb.modules().iter().zip(states(limb, reach)).map(|(module, state)| module.measure(&state)).collect()
}

pub(super) fn pressures(limb: &Limb, values: &[f64]) -> Vec<f64> {
    limb.modules().iter().zip(values).map(|(module, value)| pressure_near(module, *value)).collect()
}

fn pressure_near(module: &LimbModule, value: f64) -> f64 {
    let off = |state: &&fra_model::State<f64>| (module.measure(state) - value).abs();
    let nearest = module.curve.states().iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.map_or(0.0, |state| state.pressure_pa)
}
