//! The setpoints that reach the goal of a phase, or why there are none and what is nearest.

use super::inverse_kinematics::{Reach, TipGoal, TipTask, solutions, solve};
use super::refusal::check_target;
use super::space::Space;
use crate::design::{Limb, LimbModule};
use crate::obstacle::Shape;
use crate::scene::{Goal, Phase, Scene, SceneError, Span};

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
        Goal::Tip(tip) => tip_goals(scene, limb, phase, TipGoal::Point(tip.value), tip.span, before),
        Goal::Inside(region) => {
            let shape = &scene.regions()[region.value].shape;
            tip_goals(scene, limb, phase, TipGoal::Inside(shape), region.span, before)
        }
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

fn tip_goals(
    scene: &Scene,
    limb: &Limb,
    phase: &Phase,
    goal: TipGoal<'_>,
    span: Span,
    before: &[f64],
) -> Result<Vec<Vec<f64>>, SceneError> {
    let shapes = shapes(scene);
    let task = TipTask { goal, aim: phase.aim, obstacles: &shapes, clearance_m: scene.limits().clearance_m };
    let start = pressures(limb, before);
    let found = solutions(limb, &task, &start);
    if found.iter().all(Reach::reached) {
        return Ok(found.iter().map(|reach| values(limb, reach)).collect());
    }
    Err(why_not(scene, limb, &task, span, &start, &found[0]))
}

/// Leaves one demand after the other away to find the one that cannot be met.
fn why_not(scene: &Scene, limb: &Limb, task: &TipTask<'_>, span: Span, start: &[f64], nearest: &Reach) -> SceneError {
    let place = TipTask { aim: None, obstacles: &[], ..*task };
    let free = solutions(limb, &place, start);
    if !free[0].reached() {
        let title = match task.goal {
            TipGoal::Point(_) => "the limb cannot reach this way-point",
            TipGoal::Inside(_) => "the limb cannot reach into this region",
        };
        return scene.diagnostic(span, title, &missed(&free[0]), Some(&nearest_point(&free[0])));
    }
    if let Some(aim) = task.aim {
        let pointed = solve(limb, &TipTask { obstacles: &[], ..*task }, start);
        if !pointed.reached() {
            let off = |reach: &Reach| direction_off(limb, reach, *aim.direction);
            let least = free.iter().map(off).fold(f64::INFINITY, f64::min).to_degrees();
            let enough = (least * 10.0).ceil() / 10.0;
            let label = if pointed.allowed() {
                format!("in this direction {}", missed(&pointed))
            } else {
                format!("there the end effector points at least {least:.1} deg off, as far as was found")
            };
            let help = if pointed.allowed() {
                format!("{}; or a `direction_tolerance` of \"{enough:.1} deg\" is enough", nearest_point(&pointed))
            } else {
                format!("a `direction_tolerance` of \"{enough:.1} deg\" is enough")
            };
            let title = "the tip gets there, but not in this direction";
            return scene.diagnostic(aim.direction.span, title, &label, Some(&help));
        }
    }
    blocked(scene, limb, task, span, &free, nearest)
}

fn blocked(scene: &Scene, limb: &Limb, task: &TipTask<'_>, span: Span, free: &[Reach], nearest: &Reach) -> SceneError {
    let pointed = solutions(limb, &TipTask { obstacles: &[], ..*task }, &free[0].pressures_pa);
    let space = Space::new(limb, task.obstacles.to_vec(), task.clearance_m);
    let widest = pointed
        .iter()
        .filter_map(|reach| space.nearest(&limb.body(&states(limb, reach)), f64::INFINITY))
        .max_by(|a, b| a.clearance.distance_m.total_cmp(&b.clearance.distance_m));
    let Some(widest) = widest else {
        return scene.diagnostic(span, "the limb finds no way to be here", &missed(nearest), None);
    };
    let name = &scene.obstacles()[widest.obstacle].name.value;
    let label = too_near(name, widest.clearance.distance_m, task.clearance_m);
    let mut help = if nearest.allowed() {
        let point = point(nearest);
        format!(
            "the nearest point that is clear, whatever the way there, is {point}, {:.1} mm away",
            nearest.distance_m * 1e3
        )
    } else {
        "nothing near it was found that is clear".to_owned()
    };
    if widest.clearance.distance_m > 1e-4 {
        let enough = (widest.clearance.distance_m * 1e4).floor() / 10.0;
        help = format!("a `clearance` of \"{enough:.1} mm\" can be kept here; or {help}");
    }
    let title = format!("the limb cannot be here and clear of `{name}`");
    scene.diagnostic(span, &title, &label, Some(&help))
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

fn missed(reach: &Reach) -> String {
    format!("the nearest the tip gets is {:.1} mm away", reach.distance_m * 1e3)
}

fn nearest_point(reach: &Reach) -> String {
    format!("the nearest reachable point is {}", point(reach))
}

/// Where the tip is, as a scene says it.
fn point(reach: &Reach) -> String {
    let [x, y, z] = reach.tip_m.map(|v| v * 1e3);
    format!("[\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]")
}

fn direction_off(limb: &Limb, reach: &Reach, direction: [f64; 3]) -> f64 {
    let axis = limb.tip_pose(&states(limb, reach)).rotation * nalgebra::Vector3::z();
    super::inverse_kinematics::angle(&axis, &direction.into())
}

fn states(limb: &Limb, reach: &Reach) -> Vec<fra_model::State<f64>> {
    limb.modules().iter().zip(&reach.pressures_pa).map(|(module, pressure)| module.curve.at(*pressure)).collect()
}

fn values(limb: &Limb, reach: &Reach) -> Vec<f64> {
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
