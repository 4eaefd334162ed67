//! The setpoints of a whole run, checked against what the limb can do.

use fra_model::{State, StateQuantity};

use super::clear::{self, Nearness};
use super::path::Path;
use super::profile::minimum_jerk;
use super::schedule::schedule;
use super::track::{Track, owners, states};
use super::unreachable::{Shortcoming, Unreachable};
use super::upright::Upright;
use super::weight::{self, Judged, Weighed};
use super::wire::{from_wire, to_wire};
use softlimb_limb::Limb;
use softlimb_limb::statics::Fidelity;
use softlimb_scene::{Gripper, PhaseTimes, Scene};

/// A phase on the clock of the run, with the value of every drive at its end.
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
    /// Setpoint of every drive at the end of the move.
    pub values: Vec<f64>,
    /// Command to the gripper. It closes from the end of the move on; it is open at the end of the hold.
    pub gripper: Option<Gripper>,
    /// Time of the command, us after the start of the run.
    pub gripper_us: u64,
    /// Via points that the move passes to stay clear of obstacles.
    pub via_points: usize,
    /// Where the body comes nearest to an obstacle from the start of the move to the end of the pause; `None` without obstacles.
    pub nearest: Option<Nearness>,
    /// Largest tilt of what the tip holds in that time, since it was taken, rad; `None` where it holds nothing.
    pub tilt_rad: Option<f64>,
    /// What it holds during the move, and during the pause.
    pub(super) uprights: [Option<Upright>; 2],
    pub(super) path: Path,
    /// Setpoints of the hold, at equal shares of the mass that changes hands in it.
    pub(super) held: Vec<Vec<f64>>,
}

impl PlannedPhase {
    /// Share of the hold's change of mass, and of setpoints with it, at a time of the run.
    pub(super) fn held_share(&self, time_us: u64) -> f64 {
        held_share(self.start_us + self.move_us, self.hold_us, time_us)
    }

    /// Share of the move at a time of the run, 0 to 1.
    pub(super) fn move_share(&self, time_us: u64) -> f64 {
        minimum_jerk(time_us.saturating_sub(self.start_us) as f64 / self.move_us as f64)
    }

    /// Setpoints at a time of the run, from its start on.
    fn at(&self, time_us: u64) -> Vec<f64> {
        let share = self.held_share(time_us);
        if share <= 0.0 || self.hold_us == 0 {
            return self.path.at((time_us - self.start_us) as f64);
        }
        let place = share * (self.held.len() - 1) as f64;
        let before = (place as usize).min(self.held.len().saturating_sub(2));
        let (from, to) = (&self.held[before], &self.held[(before + 1).min(self.held.len() - 1)]);
        from.iter().zip(to).map(|(a, b)| a + (b - a) * (place - before as f64)).collect()
    }

    /// Setpoints that the next phase begins with.
    pub(super) fn last(&self) -> &[f64] {
        if self.hold_us == 0 { &self.values } else { self.held.last().unwrap_or(&self.values) }
    }
}

/// All setpoints of a run: one row per knot, one value per drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The phases.
    pub phases: Vec<PlannedPhase>,
    /// What the limb will not do as planned, in words: moves that are faster than valves or supply.
    pub warnings: Vec<String>,
    pub(super) track: Track,
    weighed: Option<Weighed>,
}

impl Plan {
    /// Time between two knots, us.
    pub fn knot_period_us(&self) -> u64 {
        self.track.period_us
    }

    /// Time of the last knot, us after the start.
    pub fn duration_us(&self) -> u64 {
        self.track.duration_us()
    }

    /// Times of the phases, in their order.
    pub fn phase_times(&self) -> Vec<PhaseTimes> {
        let seconds = |us: u64| us as f64 * 1e-6;
        let times = |phase: &PlannedPhase| {
            let [start_s, move_s, hold_s] = [phase.start_us, phase.move_us, phase.hold_us].map(seconds);
            PhaseTimes { start_s, move_s, hold_s }
        };
        self.phases.iter().map(times).collect()
    }

    /// Whether the gripper's output is on at a time of the run, us. Before the first command it is in the other state.
    pub fn is_gripping_at(&self, time_us: u64) -> bool {
        let commands = || self.phases.iter().filter_map(|phase| Some((phase.gripper?, phase.gripper_us)));
        match commands().rfind(|(_, told_us)| *told_us <= time_us) {
            Some((command, _)) => command == Gripper::Close,
            None => commands().next().is_some_and(|(first, _)| first == Gripper::Open),
        }
    }

    /// Holds that end before a gripper of this closing and opening time, s, is through.
    pub fn gripper_warnings(&self, gripper_time_s: f64) -> Vec<String> {
        let warning = |phase: &PlannedPhase| {
            let hold_s = phase.hold_us as f64 * 1e-6;
            let done = match phase.gripper? {
                Gripper::Close => "closed",
                Gripper::Open => "open",
            };
            (hold_s < gripper_time_s).then(|| {
                format!(
                    "`{}` ends before its gripper is {done}: `hold` is {hold_s:.2} s, `gripper_time` {gripper_time_s:.2} s",
                    phase.name
                )
            })
        };
        self.phases.iter().filter_map(warning).collect()
    }

    /// Wire values per drive at every knot.
    pub fn knots(&self) -> &[Vec<i32>] {
        &self.track.knots
    }

    /// Setpoint of every drive at a time, interpolated between knots as the device does.
    pub fn values_at(&self, time_us: f64) -> Vec<f64> {
        self.track.values_at(time_us)
    }

    /// States that the model gives for the setpoints at a time, one a drive.
    pub fn states_at(&self, time_us: f64) -> Vec<State<f64>> {
        self.track.states_at(time_us)
    }

    /// What the plan knows of the limb's weight; `None` where its setpoints are not corrected for it.
    pub fn weighed(&self) -> Option<&Weighed> {
        self.weighed.as_ref()
    }

    /// Where the setpoints of a time bring the tip, m: under the limb's weight and payload where they are corrected for it.
    pub fn tip_m(&self, limb: &Limb, time_us: f64) -> [f64; 3] {
        let Some(weighed) = &self.weighed else { return limb.tip(&self.states_at(time_us)) };
        let (before, after, share) = self.track.between(time_us);
        between(weighed.tips_m[before], weighed.tips_m[after], share)
    }

    /// The centre line at the setpoints of a time, m; as [`Plan::tip_m`].
    pub fn line_m(&self, limb: &Limb, time_us: f64) -> Vec<[f64; 3]> {
        let Some(weighed) = &self.weighed else { return limb.backbone(&self.states_at(time_us)) };
        let (before, after, share) = self.track.between(time_us);
        let points = weighed.lines_m[before].iter().zip(&weighed.lines_m[after]);
        points.map(|(a, b)| between(*a, *b, share)).collect()
    }
}

fn between(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + (b[axis] - a[axis]) * share)
}

/// Error of the finest statics, as a share of the limb's length, above which the limb is so far from its unloaded shape that no plan is made.
const STATICS_ERROR_MAX: f64 = 0.1;

/// Plans all phases of a scene. The warnings of the plan are left to those who have the words.
///
/// # Errors
/// [`Unreachable`].
pub(super) fn plan(scene: &Scene, limb: &Limb) -> Result<(Plan, Vec<Shortcoming>), Unreachable> {
    let Some(weight) = scene.weight().filter(|weight| weight.compensated) else {
        let (draft, shortcomings) = drafted(scene, limb, None)?;
        return Ok((proven(scene, limb, draft, None)?, shortcomings));
    };
    let mut judged = Judged::at_rest(scene, limb, weight.error)?;
    loop {
        let tier = judged.tier;
        let (draft, mut shortcomings) = drafted(scene, limb, Some(tier))?;
        judged.look(scene, limb, &draft, weight.error);
        // The poses may need more of a model than the limb at rest.
        if judged.tier > tier {
            continue;
        }
        if judged.error > STATICS_ERROR_MAX {
            return Err(Unreachable::Uncertain { phase: judged.phase, error: judged.error });
        }
        let mut plan = proven(scene, limb, draft, Some(tier))?;
        if judged.error > weight.error {
            shortcomings.push(Shortcoming::Statics { error: judged.error, allowed: weight.error });
        }
        if let Some(weighed) = &mut plan.weighed {
            weighed.error = judged.error;
        }
        return Ok((plan, shortcomings));
    }
}

/// Phases and setpoints of the limb under its weight by a tier of the statics, or without weight.
fn drafted(scene: &Scene, limb: &Limb, tier: Option<Fidelity>) -> Result<(Plan, Vec<Shortcoming>), Unreachable> {
    let start: Vec<f64> = limb.drives().map(|drive| drive.measure(&drive.actuator.rest())).collect();
    let (mut phases, shortcomings) = schedule(scene, limb, tier, &start)?;
    if tier.is_some() {
        weight::calmed(scene, limb, &mut phases)?;
    }
    let knot_period_us = u64::from(scene.controller().knot_period_us);
    let knots = knots(limb, &phases, &start, knot_period_us);
    let states = states(limb, &phases, &owners(limb), &knots, knot_period_us)?;
    let kinds = limb.drives().map(|drive| drive.kind).collect();
    let track = Track { period_us: knot_period_us, kinds, knots, states };
    Ok((Plan { phases, warnings: Vec::new(), track, weighed: None }, shortcomings))
}

/// The plan of a draft: with the proof of its clearance, and its tips under load.
fn proven(scene: &Scene, limb: &Limb, draft: Plan, tier: Option<Fidelity>) -> Result<Plan, Unreachable> {
    let Plan { mut phases, warnings, track, .. } = draft;
    let rows: Vec<Vec<f64>> = track
        .knots
        .iter()
        .map(|knot| limb.drives().zip(knot).map(|(drive, wire)| from_wire(drive.kind, *wire)).collect())
        .collect();
    let way = (&rows[..], &track.states[..], track.period_us);
    clear::prove(scene, limb, &mut phases, way, tier)?;
    let weighed = tier.map(|tier| weight::weigh(scene, limb, &phases, way, tier)).transpose()?;
    Ok(Plan { phases, warnings, track, weighed })
}

/// Share of a hold's change of mass at a time of the run, for a hold from `from_us` on.
pub fn held_share(from_us: u64, hold_us: u64, time_us: u64) -> f64 {
    match time_us.checked_sub(from_us) {
        None => 0.0,
        Some(_) if hold_us == 0 => 1.0,
        Some(since_us) => minimum_jerk(since_us as f64 / hold_us as f64),
    }
}

/// Index of the phase at a time, us.
pub(super) fn phase_at(phases: &[PlannedPhase], time_us: u64) -> usize {
    phases.iter().rposition(|phase| phase.start_us <= time_us).unwrap_or(0)
}

/// Samples the moves at the knots, in wire units. The last knot is at or just behind the end of the last phase.
fn knots(limb: &Limb, phases: &[PlannedPhase], start: &[f64], period_us: u64) -> Vec<Vec<i32>> {
    let end_us = phases.last().map_or(0, |phase| phase.start_us + phase.move_us + phase.hold_us);
    let kinds: Vec<StateQuantity> = limb.drives().map(|drive| drive.kind).collect();
    let value_at = |time_us: u64| -> Vec<i32> {
        let Some(phase) = phases.get(phase_at(phases, time_us)) else { return to_wire_row(&kinds, start) };
        to_wire_row(&kinds, &phase.at(time_us))
    };
    (0..=end_us.div_ceil(period_us)).map(|knot| value_at(knot * period_us)).collect()
}

fn to_wire_row(kinds: &[StateQuantity], row: &[f64]) -> Vec<i32> {
    kinds.iter().zip(row).map(|(kind, value)| to_wire(*kind, *value)).collect()
}
