//! The setpoints that reach the goal of a phase.

use super::inverse_kinematics::{Reach, TipGoal, TipTask, solutions, solve};
use super::refusal::check_target;
use super::space::Space;
use super::why_not::{WhyNot, missed, nearest_point};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::collision::Shape;
use softlimb_scene::{Goal, Phase, Scene, SceneError, Span};

/// Rows of setpoints, each of which does what a phase asks for at its end; the preferred one first.
///
/// # Errors
/// A diagnostic at what cannot be had: a target, a way-point, a region or a direction.
pub(super) fn goals(
    scene: &Scene,
    limb: &Limb,
    space: &Space<'_>,
    phase: &Phase,
    before: &[f64],
) -> Result<Vec<Vec<f64>>, SceneError> {
    match &phase.goal {
        Goal::Targets(targets) => {
            let mut goal = before.to_vec();
            for target in targets {
                check_target(scene, &limb.modules()[target.module], target.value.value, target.value.span)?;
                goal[target.module] = target.value.value;
            }
            let span = targets.first().map_or(phase.span, |target| target.value.span);
            check_clear(scene, limb, space, (before, &goal), span)?;
            Ok(vec![goal])
        }
        Goal::Tip(tip) => tip_goals((scene, limb, space), phase, tip.span, before),
        Goal::Inside(region) => tip_goals((scene, limb, space), phase, region.span, before),
        // A series is planned row by row, as way-points.
        Goal::Series(_) => Ok(vec![before.to_vec()]),
    }
}

/// The setpoints at one position of a marker series, from those at the position before.
///
/// # Errors
/// A diagnostic at the name of the file.
pub(super) fn marker(
    scene: &Scene,
    limb: &Limb,
    (index, tip_m): (usize, [f64; 3]),
    span: Span,
    before: &[f64],
) -> Result<Vec<f64>, SceneError> {
    let shapes = shapes(scene);
    let task =
        TipTask { goal: TipGoal::Point(tip_m), aim: None, obstacles: &shapes, clearance_m: scene.limits().clearance_m };
    let reach = solve(limb, &task, &pressures(limb, before));
    if reach.reached() {
        return Ok(values(limb, &reach));
    }
    let label = format!("position {} of the series: {}", index + 1, missed(&reach));
    let title = "the limb cannot follow this series";
    Err(scene.diagnostic(span, title, &label, Some(&nearest_point(&reach))))
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

fn tip_goals(
    (scene, limb, space): (&Scene, &Limb, &Space<'_>),
    phase: &Phase,
    span: Span,
    before: &[f64],
) -> Result<Vec<Vec<f64>>, SceneError> {
    let shapes = shapes(scene);
    let Some(task) = tip_task(scene, phase, &shapes) else { return Ok(vec![before.to_vec()]) };
    let start = pressures(limb, before);
    let found = solutions(limb, &task, &start);
    if found.iter().all(Reach::reached) {
        return Ok(found.iter().map(|reach| values(limb, reach)).collect());
    }
    Err(WhyNot { scene, limb, space, task, span, before, start: &start }.diagnostic(&found[0]))
}

/// Checks that setpoints which are given keep the limb clear.
fn check_clear(
    scene: &Scene,
    limb: &Limb,
    space: &Space<'_>,
    (before, goal): (&[f64], &[f64]),
    span: Span,
) -> Result<(), SceneError> {
    let Some(states) = space.states(goal) else { return Ok(()) };
    let required_m = scene.limits().clearance_m;
    let Some(found) = space.nearest(&limb.body(&states), required_m) else { return Ok(()) };
    let name = &scene.obstacles()[found.obstacle].name.value;
    let share = space.blocked(before, goal).map_or(0.0, |blocked| blocked.share);
    let help = format!("on the straight way there the limb gets {:.0} % far", (share * 100.0).floor());
    let title = format!("at this goal the limb is too near `{name}`");
    Err(scene.diagnostic(span, &title, &too_near(name, found.clearance.distance_m, required_m), Some(&help)))
}

/// How near an obstacle is, and how near it may be.
pub(super) fn too_near(name: &str, distance_m: f64, required_m: f64) -> String {
    let allowed = format!("`clearance` is {:.1} mm", required_m * 1e3);
    if distance_m < 0.0 {
        format!("the limb would be {:.1} mm deep in `{name}`; {allowed}", -distance_m * 1e3)
    } else {
        format!("the limb would be {:.1} mm from `{name}`; {allowed}", distance_m * 1e3)
    }
}

/// The states of a reach.
pub(super) fn states(limb: &Limb, reach: &Reach) -> Vec<fra_model::State<f64>> {
    limb.modules().iter().zip(&reach.pressures_pa).map(|(module, pressure)| module.curve.at(*pressure)).collect()
}

/// The setpoints of a reach.
pub(super) fn values(limb: &Limb, reach: &Reach) -> Vec<f64> {
    limb.modules().iter().zip(states(limb, reach)).map(|(module, state)| module.measure(&state)).collect()
}

fn pressures(limb: &Limb, values: &[f64]) -> Vec<f64> {
    limb.modules().iter().zip(values).map(|(module, value)| pressure_near(module, *value)).collect()
}

fn pressure_near(module: &LimbModule, value: f64) -> f64 {
    let off = |state: &&fra_model::State<f64>| (module.measure(state) - value).abs();
    let nearest = module.curve.states().iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.map_or(0.0, |state| state.pressure_pa)
}
