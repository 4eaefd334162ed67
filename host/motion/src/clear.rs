//! The last word on clearance: what is streamed, knot by knot, and why there is no way.

use fra_model::State;

use super::goal::{shapes, too_near};
use super::plan::PlannedPhase;
use super::route::route;
use super::space::Space;
use super::why_not::nearest_with_way;
use softlimb_limb::Limb;
use softlimb_scene::collision::Body;
use softlimb_scene::{Phase, Scene, SceneError};

/// Where the body is nearest to an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearness {
    /// Distance of the surfaces, m; negative where they overlap.
    pub distance_m: f64,
    /// Index of the obstacle in [`Scene::obstacles`](softlimb_scene::Scene::obstacles).
    pub obstacle: usize,
    /// Time after the start of the run, us.
    pub time_us: u64,
    /// The nearest point of the centre line, m.
    pub point_m: [f64; 3],
}

/// Checks that the limb is clear where it starts.
///
/// # Errors
/// A diagnostic at the obstacle.
pub(super) fn start(scene: &Scene, limb: &Limb, space: &Space<'_>, start: &[f64]) -> Result<(), SceneError> {
    let required_m = scene.limits().clearance_m;
    let Some(states) = space.states(start) else { return Ok(()) };
    let Some(found) = space.nearest(&limb.body(&states), required_m) else { return Ok(()) };
    let obstacle = &scene.obstacles()[found.obstacle];
    let distance_m = found.clearance.distance_m;
    let label = too_near(&obstacle.name.value, distance_m, required_m);
    let [x, y, z] = <[f64; 3]>::from(found.clearance.point_m).map(|v| v * 1e3);
    let help = format!(
        "the nearest point of the limb's centre line is [\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]; the obstacle must be {:.1} mm farther away",
        (required_m - distance_m) * 1e3
    );
    Err(scene.diagnostic(obstacle.span, "the limb at rest is too near this obstacle", &label, Some(&help)))
}

/// Proves that no setpoint between two knots brings the limb too near an obstacle, and notes the least clearance of every phase.
///
/// # Errors
/// A diagnostic at the phase that does.
pub(super) fn prove(
    scene: &Scene,
    limb: &Limb,
    phases: &mut [PlannedPhase],
    (rows, states): (&[Vec<f64>], &[Vec<State<f64>>]),
    period_us: u64,
) -> Result<(), SceneError> {
    if scene.obstacles().is_empty() {
        return Ok(());
    }
    let space = Space::new(limb, shapes(scene), scene.limits().clearance_m);
    let mut body = Body::new(limb.base());
    for (index, phase) in phases.iter_mut().enumerate() {
        let end_us = phase.start_us + phase.move_us + phase.hold_us;
        let knots = (phase.start_us / period_us) as usize..=(end_us.div_ceil(period_us) as usize).min(rows.len() - 1);
        let mut nearest: Option<Nearness> = None;
        for knot in knots {
            let time_us = knot as u64 * period_us;
            let new = knot == 0 || rows[knot] != rows[knot - 1] || nearest.is_none();
            if !new {
                continue;
            }
            limb.shape(&states[knot], &mut body);
            let enough_m = nearest.map_or(f64::INFINITY, |known| known.distance_m);
            if let Some(found) = space.nearest(&body, enough_m) {
                let (distance_m, point_m) = (found.clearance.distance_m, found.clearance.point_m.into());
                nearest = Some(Nearness { distance_m, obstacle: found.obstacle, time_us, point_m });
            }
            if knot > 0 && time_us > phase.start_us {
                passed(scene, &space, index, (&rows[knot - 1], &rows[knot]), time_us)?;
            }
        }
        phase.nearest = nearest;
    }
    Ok(())
}

fn passed(
    scene: &Scene,
    space: &Space<'_>,
    phase: usize,
    (from, to): (&[f64], &[f64]),
    time_us: u64,
) -> Result<(), SceneError> {
    let Some(blocked) = space.blocked(from, to) else { return Ok(()) };
    let phase = &scene.phases()[phase];
    let title = "on the way to its goal this phase comes too near an obstacle";
    let required_m = scene.limits().clearance_m;
    let label = blocked.by.map_or("the limb has no shape here".to_owned(), |by| {
        too_near(&scene.obstacles()[by.obstacle].name.value, by.clearance.distance_m, required_m)
    });
    let label = format!("{:.2} s into the run {label}", time_us as f64 * 1e-6);
    Err(scene.diagnostic(phase.span, title, &label, None))
}

/// Why there is no way to a goal that itself is clear, and the greatest clearance with which one is found.
pub(super) fn no_way(
    scene: &Scene,
    limb: &Limb,
    space: &Space<'_>,
    phase: &Phase,
    (from, to): (&[f64], &[f64]),
    ranges: &[(f64, f64)],
) -> SceneError {
    let required_m = scene.limits().clearance_m;
    let blocked = space.blocked(from, to);
    let label = blocked.and_then(|blocked| Some((blocked.share, blocked.by?))).map_or(String::new(), |(share, by)| {
        let name = &scene.obstacles()[by.obstacle].name.value;
        let near = too_near(name, by.clearance.distance_m, required_m);
        format!("straight, {:.0} % of the way, {near}; no way around was found", share * 100.0)
    });
    let possible = |clearance_m: f64| {
        let other = Space::new(limb, shapes(scene), clearance_m);
        route(&other, ranges, from, to).is_some()
    };
    // Quarters of what is asked for: finer steps would take long and say little more.
    let widest =
        [0.75, 0.5, 0.25, 0.0].into_iter().map(|share| share * required_m).find(|m| *m < required_m && possible(*m));
    let smaller = widest.map(|m| format!("with a `clearance` of \"{:.2} mm\" there is a way", m * 1e3));
    let nearer = nearest_with_way(scene, limb, space, phase, from);
    let helps: Vec<String> = smaller.into_iter().chain(nearer).collect();
    let help = (!helps.is_empty()).then(|| helps.join("; "));
    scene.diagnostic(phase.span, "the limb finds no way to this goal that keeps clear", &label, help.as_deref())
}
