//! Proof of clearance at rest and of the streamed setpoints, knot by knot.

use fra_model::State;

use super::carrier::Carrier;
use super::goal::shapes;
use super::payload::{Carrying, carried};
use super::plan::PlannedPhase;
use super::space::{Hindrance, Space};
use super::unreachable::Unreachable;
use softlimb_limb::Limb;
use softlimb_limb::statics::Fidelity;
use softlimb_scene::Scene;

/// Setpoints and states at the knots, and their period, us.
pub(super) type Way<'a> = (&'a [Vec<f64>], &'a [Vec<State<f64>>], u64);

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
/// [`Unreachable::AtRest`].
pub(super) fn start(scene: &Scene, space: &Space<'_>, start: &[f64]) -> Result<(), Unreachable> {
    let Some(body) = space.body(start) else { return Ok(()) };
    let nearest = space.nearest(&body, scene.limits().clearance_m);
    nearest.map_or(Ok(()), |by| Err(Unreachable::AtRest(by)))
}

/// Proves that no setpoint between two knots brings the limb too near an obstacle or tilts what it holds too much, and notes the least
/// clearance and the largest tilt of every phase.
///
/// Under the load by the statics of a tier, or without load.
///
/// # Errors
/// [`Unreachable::PassesTooNear`], [`Unreachable::Tilts`].
pub(super) fn prove(
    scene: &Scene,
    limb: &Limb,
    phases: &mut [PlannedPhase],
    (rows, states, period_us): Way<'_>,
    tier: Option<Fidelity>,
) -> Result<(), Unreachable> {
    if scene.obstacles().is_empty() && phases.iter().all(|phase| phase.uprights == [None; 2]) {
        return Ok(());
    }
    let carried = carried(scene.phases());
    for (index, (phase, carried)) in phases.iter_mut().zip(&carried).enumerate() {
        let space = |object, upright| {
            let carrying = Carrying { payload_kg: carried.moved.payload_kg, object };
            let carrier = Carrier::new(scene, limb, tier, carrying);
            Space::new(carrier, shapes(scene), scene.limits().clearance_m).keeping(upright)
        };
        let uprights = phase.uprights;
        let [moved, held] = [space(carried.moved.object, uprights[0]), space(carried.held_object(), uprights[1])];
        let end_us = phase.start_us + phase.move_us + phase.hold_us;
        let knots = (phase.start_us / period_us) as usize..=(end_us.div_ceil(period_us) as usize).min(rows.len() - 1);
        let (mut nearest, mut tilt_rad): (Option<Nearness>, Option<f64>) = (None, None);
        for knot in knots {
            let time_us = knot as u64 * period_us;
            let share = phase.held_share(time_us);
            let handed = carried.held != carried.moved && share > 0.0 && share < 1.0;
            let first = nearest.is_none() && tilt_rad.is_none();
            let new = knot == 0 || rows[knot] != rows[knot - 1] || first || handed;
            if !new {
                continue;
            }
            let holds = time_us > phase.start_us + phase.move_us;
            let (at, upright) = if holds { (&held, uprights[1]) } else { (&moved, uprights[0]) };
            at.carrier().load(carried.handed_kg(share));
            let Some(body) = at.carrier().body_in(&states[knot]) else { continue };
            let enough_m = nearest.map_or(f64::INFINITY, |known| known.distance_m);
            if let Some(found) = at.nearest(&body, enough_m) {
                let (distance_m, point_m) = (found.clearance.distance_m, found.clearance.point_m.into());
                nearest = Some(Nearness { distance_m, obstacle: found.obstacle, time_us, point_m });
            }
            let tilts_rad = upright.map(|upright| upright.tilt_rad(&body.end().rotation));
            tilt_rad = tilts_rad.map_or(tilt_rad, |tilts| Some(tilts.max(tilt_rad.unwrap_or(0.0))));
            if knot > 0
                && time_us > phase.start_us
                && let Some(blocked) = at.blocked(&rows[knot - 1], &rows[knot])
            {
                return Err(match blocked.by {
                    Hindrance::Obstacle(by) => Unreachable::PassesTooNear { phase: index, time_us, by: Some(by) },
                    Hindrance::NoShape => Unreachable::PassesTooNear { phase: index, time_us, by: None },
                    Hindrance::Tilt(tilt_rad) => Unreachable::Tilts { phase: index, time_us: Some(time_us), tilt_rad },
                });
            }
        }
        (phase.nearest, phase.tilt_rad) = (nearest, tilt_rad);
    }
    Ok(())
}
