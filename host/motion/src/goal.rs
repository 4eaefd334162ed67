//! The setpoints that reach the goal of a phase.

use fra_model::State;
use nalgebra::Vector3;

use super::carrier::Carrier;
use super::inverse_kinematics::{REACHED_M, Reach, TipGoal, TipTask, solutions_of, solve_near};
use super::setpoint::state_at;
use super::space::Space;
use super::unreachable::Unreachable;
use super::weight::pressures_pa;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::collision::Shape;
use softlimb_scene::{Goal, Phase, Scene, Target};

/// Most solutions that are considered.
const SOLUTIONS: usize = 4;
/// The tip of tubes between plates is brought this near to its goal, m, in this many turns at most.
const REFINED_M: f64 = 2e-6;
const REFINEMENTS: usize = 6;

/// Rows of setpoints, each of which meets the goal of a phase at its end; the preferred one first. The move begins at `before`; drives without
/// a target keep the setpoint that they were `asked` for.
///
/// # Errors
/// [`Unreachable`]: a target, a way-point, a region or a direction.
pub(super) fn goals(
    scene: &Scene,
    space: &Space<'_>,
    phase: usize,
    (before, asked): (&[f64], &[f64]),
) -> Result<Vec<Vec<f64>>, Unreachable> {
    match &scene.phases()[phase].goal {
        Goal::Targets(targets) => {
            check_targets(space.carrier().limb(), phase, targets)?;
            let goal = with_load(space.carrier(), phase, &with_targets(space.carrier().limb(), targets, asked))?;
            check_clear(scene, space, (before, &goal), phase)?;
            Ok(vec![goal])
        }
        Goal::Tip(_) | Goal::Inside(_) => tip_goals(scene, space, phase, before),
        // A series is planned row by row, as way-points.
        Goal::Series(_) => Ok(vec![before.to_vec()]),
    }
}

/// Setpoints with those of targets in their places; all drives of a module get its target.
pub(super) fn with_targets(limb: &Limb, targets: &[Target], asked: &[f64]) -> Vec<f64> {
    let mut goal = asked.to_vec();
    targets.iter().for_each(|target| goal[limb.drives_of(target.module)].fill(target.value.value));
    goal
}

fn check_targets(limb: &Limb, phase: usize, targets: &[Target]) -> Result<(), Unreachable> {
    for (index, target) in targets.iter().enumerate() {
        let module = &limb.modules()[target.module];
        state_at(module, &module.actuator.rest(), target.value.value).map_err(|cause| Unreachable::Target {
            phase,
            target: index,
            cause,
        })?;
    }
    Ok(())
}

/// Setpoints that bring the tip under load to where given ones have it without; those themselves without load.
fn with_load(carrier: &Carrier<'_>, phase: usize, values: &[f64]) -> Result<Vec<f64>, Unreachable> {
    if !carrier.is_loaded() {
        return Ok(values.to_vec());
    }
    let states: Vec<State<f64>> = states_at(carrier.limb(), values);
    let tip_m = carrier.limb().tip(&states);
    kept(carrier, phase, values, tip_m.into())
}

/// Drives that can hold the three coordinates of a tip; fewer hold it as near as they can.
const ENOUGH_DRIVES: usize = 3;

/// Setpoints near others that hold the tip under load at a place, m, or next to it where the limb has too few drives for that.
///
/// # Errors
/// [`Unreachable::UnderLoad`].
pub(super) fn kept(
    carrier: &Carrier<'_>,
    phase: usize,
    near: &[f64],
    tip_m: Vector3<f64>,
) -> Result<Vec<f64>, Unreachable> {
    let task =
        TipTask { goal: TipGoal::Point(tip_m.into()), aim: None, upright: None, obstacles: &[], clearance_m: 0.0 };
    let start = pressures_pa(&states_at(carrier.limb(), near));
    let found = refined(carrier, &task, solve_near(carrier, &task, &start));
    let few = carrier.limb().drives().len() < ENOUGH_DRIVES && found.distance_m.is_finite();
    if found.reached() || few {
        Ok(values(carrier.limb(), &found))
    } else {
        Err(Unreachable::UnderLoad { phase, nearest: found })
    }
}

/// How far under load the tip at setpoints is from where those that were asked for have it without, m; 0 where it counts as there.
pub(super) fn off_m(carrier: &Carrier<'_>, values: &[f64], asked: &[f64]) -> f64 {
    let limb = carrier.limb();
    let there_m = Vector3::from(limb.tip(&states_at(limb, asked)));
    let off_m = tip_m(carrier, values).map_or(0.0, |tip_m| (tip_m - there_m).norm());
    if off_m > REACHED_M { off_m } else { 0.0 }
}

/// The tip at setpoints, m, as tubes between plates have it under load; `None` where the limb does not stand.
pub(super) fn tip_m(carrier: &Carrier<'_>, values: &[f64]) -> Option<Vector3<f64>> {
    let states = states_at(carrier.limb(), values);
    let rods_m = carrier.body_in(&states)?.end().translation.vector;
    Some(rods_m + carrier.tubes_shift_m(&pressures_pa(&states)))
}

/// A reach whose tip is at its goal as tubes between plates have it: the goal of the rods is moved by what the tubes are off.
fn refined(carrier: &Carrier<'_>, task: &TipTask<'_>, found: Reach) -> Reach {
    if !carrier.is_loaded() || !found.distance_m.is_finite() {
        return found;
    }
    let mut here = found;
    for turn in 0.. {
        let rods_m = Vector3::from(here.tip_m);
        let tip_m = rods_m + carrier.tubes_shift_m(&here.pressures_pa);
        let missing_m = task.goal.missing_m(&tip_m);
        if missing_m.norm() <= REFINED_M || turn == REFINEMENTS {
            return Reach { tip_m: tip_m.into(), distance_m: task.goal.distance_m(&tip_m), ..here };
        }
        let aimed = TipTask { goal: TipGoal::Point((rods_m + missing_m).into()), ..*task };
        let next = solve_near(carrier, &aimed, &here.pressures_pa);
        if !next.distance_m.is_finite() {
            return here;
        }
        here = next;
    }
    here
}

/// The goal of the tip that is nearest to where a move begins, under load; `None` where it is not found at once, or without load.
pub(super) fn near_goal(scene: &Scene, space: &Space<'_>, phase: usize, before: &[f64]) -> Option<Vec<f64>> {
    let carrier = space.carrier();
    if !carrier.is_loaded() {
        return None;
    }
    let shapes = shapes(scene);
    let task = tip_task(scene, &scene.phases()[phase], space, &shapes)?;
    let start = pressures_pa(&states_at(carrier.limb(), before));
    let found = refined(carrier, &task, solve_near(carrier, &task, &start));
    found.reached().then(|| values(carrier.limb(), &found))
}

/// The setpoints at one position of a marker series, from those at the position before.
///
/// # Errors
/// [`Unreachable::Marker`].
pub(super) fn marker(
    scene: &Scene,
    space: &Space<'_>,
    phase: usize,
    (position, tip_m): (usize, [f64; 3]),
    before: &[f64],
) -> Result<Vec<f64>, Unreachable> {
    let (carrier, shapes) = (space.carrier(), shapes(scene));
    let (goal, clearance_m) = (TipGoal::Point(tip_m), scene.limits().clearance_m);
    let task = TipTask { goal, aim: None, upright: space.upright(), obstacles: &shapes, clearance_m };
    let start = pressures(carrier.limb(), before);
    let near = Some(solve_near(carrier, &task, &start)).filter(|near| carrier.is_loaded() && near.reached());
    let nearest = near.unwrap_or_else(|| solutions_of(carrier, &task, &start).swap_remove(0));
    if nearest.reached() {
        Ok(values(carrier.limb(), &nearest))
    } else {
        Err(Unreachable::Marker { phase, position, nearest })
    }
}

/// The solids of a scene.
pub(super) fn shapes(scene: &Scene) -> Vec<&Shape> {
    scene.obstacles().iter().map(|obstacle| &obstacle.shape).collect()
}

/// What a phase asks of the tip in a space; `None` where it asks nothing.
pub(super) fn tip_task<'a>(
    scene: &'a Scene,
    phase: &Phase,
    space: &Space<'_>,
    obstacles: &'a [&'a Shape],
) -> Option<TipTask<'a>> {
    let goal = match &phase.goal {
        Goal::Tip(tip) => TipGoal::Point(tip.value),
        Goal::Inside(region) => TipGoal::Inside(&scene.regions()[region.value].shape),
        Goal::Targets(_) | Goal::Series(_) => return None,
    };
    let clearance_m = scene.limits().clearance_m;
    Some(TipTask { goal, aim: phase.aim, upright: space.upright(), obstacles, clearance_m })
}

fn tip_goals(scene: &Scene, space: &Space<'_>, phase: usize, before: &[f64]) -> Result<Vec<Vec<f64>>, Unreachable> {
    let (carrier, shapes) = (space.carrier(), shapes(scene));
    let Some(task) = tip_task(scene, &scene.phases()[phase], space, &shapes) else {
        return Ok(vec![before.to_vec()]);
    };
    let found = solutions_of(carrier, &task, &pressures(carrier.limb(), before));
    let mut found: Vec<Reach> = found.into_iter().take(SOLUTIONS).map(|reach| refined(carrier, &task, reach)).collect();
    if found.iter().any(Reach::reached) {
        found.retain(Reach::reached);
        return Ok(found.iter().map(|reach| values(carrier.limb(), reach)).collect());
    }
    let (before, upright) = (before.to_vec(), space.upright());
    Err(Unreachable::Tip { phase, before, upright, nearest: Box::new(found.swap_remove(0)) })
}

/// Checks that setpoints which are given keep the limb clear, and what it carries upright.
fn check_clear(
    scene: &Scene,
    space: &Space<'_>,
    (before, goal): (&[f64], &[f64]),
    phase: usize,
) -> Result<(), Unreachable> {
    let Some(body) = space.body(goal) else { return Ok(()) };
    if let Some(tilt_rad) = space.tilts_rad(&body) {
        return Err(Unreachable::Tilts { phase, time_us: None, tilt_rad });
    }
    let Some(by) = space.nearest(&body, scene.limits().clearance_m) else { return Ok(()) };
    let fraction = space.blocked(before, goal).map_or(0.0, |blocked| blocked.share);
    Err(Unreachable::TooNear { phase, by, fraction })
}

/// The states at setpoints of a plan, each of which has one.
pub(super) fn states_at(limb: &Limb, values: &[f64]) -> Vec<State<f64>> {
    let drives = limb.drives().zip(values);
    drives.map(|(drive, value)| drive.state_at(*value).unwrap_or_else(|| drive.actuator.rest())).collect()
}

/// The states of a reach.
pub(super) fn states(limb: &Limb, reach: &Reach) -> Vec<fra_model::State<f64>> {
    limb.drives().zip(&reach.pressures_pa).map(|(drive, pressure)| drive.curve.at(*pressure)).collect()
}

/// The setpoints of a reach.
pub(super) fn values(limb: &Limb, reach: &Reach) -> Vec<f64> {
    limb.drives().zip(states(limb, reach)).map(|(drive, state)| drive.measure(&state)).collect()
}

pub(super) fn pressures(limb: &Limb, values: &[f64]) -> Vec<f64> {
    limb.drives().zip(values).map(|(drive, value)| pressure_near(&drive, *value)).collect()
}

fn pressure_near(module: &LimbModule, value: f64) -> f64 {
    let off = |state: &&fra_model::State<f64>| (module.measure(state) - value).abs();
    let nearest = module.curve.states().iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.map_or(0.0, |state| state.pressure_pa)
}
