//! The limb found, judged once more by the finest statics, tubes between plates, each pose followed from rest.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Serialize;

use super::built::Built;
use super::evaluate::{Evaluation, Judgement};
use super::inverse::{Stand, nearest, reach, tilt_rad};
use super::limits::{Margin, StandingLimits};
use super::local_solve::abreast;
use super::plates::{by_plates, sag_m, stiffness_n_per_m};
use super::task::LoadedTask;
use super::walk::{back_spare_m, dense};
use crate::synthesis::Aim;
use softlimb_limb::statics::{Answer, BUCKLING_MARGIN_MAX, LoadedLimb};

/// The tip counts as at its aim within this, m.
pub const REACHED_M: f64 = 1e-4;
/// Load factors are followed no farther than this, or than to their limit where it is higher.
pub const LOAD_FACTOR_MOST: f64 = 2.0;
/// Rods decide by more than this on the moves; tubes decide within it: m, rad.
const DOUBT_M: f64 = 5e-4;
const DOUBT_RAD: f64 = 5e-3;
/// Corrections of the aim by the tip offset of the tubes.
const CORRECTIONS: usize = 6;
/// Shares of a payload that a pose is judged with.
const LOADS: [f64; 3] = [0.0, 0.5, 1.0];

/// A pose under load by tubes between plates: the worst of no, half and all payload.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConfirmedPose {
    /// Name of the phase.
    pub name: String,
    /// Largest payload, kg.
    pub payload_kg: f64,
    /// Pressures that bring the tip to its aim under the load of the move, Pa, one a drive.
    pub pressures_pa: Vec<f64>,
    /// Distance of the tip from the aim, m.
    pub tip_error_m: f64,
    /// The tip, m.
    pub tip_m: [f64; 3],
    /// Load factor, up to [`LOAD_FACTOR_MOST`], which stands for that and more.
    pub load_factor: f64,
    /// Vertical stiffness of the tip, N/m.
    pub stiffness_n_per_m: f64,
    /// Largest sag, m.
    pub sag_m: f64,
    /// Buckling margin.
    pub buckling_margin: f64,
    /// Highest pressure over the lower of limit and limit point.
    pub pressure_share: f64,
    /// Largest tilt of the axis of the carried body, which turns with the end effector since it was grasped, here and on the way, rad; 0 without one.
    pub tilt_rad: f64,
    /// Clearance beyond the one asked for, here and on the straight way to it, m; `None` without obstacles.
    pub spare_m: Option<f64>,
    /// Margins that are not kept.
    pub lacks: Vec<Margin>,
}

/// How much of a limb is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// All poses, for a report; load factors up to [`LOAD_FACTOR_MOST`].
    Whole,
    /// Until a margin is not kept; load factors up to their limit.
    Verdict,
}

/// Whether a limb keeps every margin by tubes between plates, pose by pose, each followed from rest, and by dense samples of the moves; cheap to dear.
pub(super) fn keeps(task: &LoadedTask, limb: &Evaluation, by: &Judgement) -> bool {
    let rods: Vec<Option<Ends>> = (0..task.poses.len()).map(|index| Some(Ends::of_rods(limb, by, index))).collect();
    let mut answers: Vec<_> = (0..task.poses.len()).map(|index| unjudged(task, limb, index)).collect();
    walked(task, &limb.built, &mut answers, &rods, (DOUBT_M, DOUBT_RAD));
    if answers.iter().any(|answer| !answer.lacks.is_empty()) {
        return false;
    }
    let (mut poses, mut ends) = (Vec::new(), Vec::new());
    for index in 0..task.poses.len() {
        let (pose, own) = confirm_pose(task, limb, by, index, Extent::Verdict);
        if !pose.lacks.is_empty() {
            return false;
        }
        poses.push(pose);
        ends.push(own);
    }
    walked(task, &limb.built, &mut poses, &ends, (0.0, 0.0));
    poses.iter().all(|pose| pose.lacks.is_empty())
}

/// Judges the limb of a search by tubes between plates, pose by pose, each followed from rest, and the moves by dense samples.
pub(super) fn confirm(task: &LoadedTask, limb: &Evaluation, by: &Judgement) -> Vec<ConfirmedPose> {
    let indices: Vec<usize> = (0..task.poses.len()).collect();
    let judged = abreast(&indices, |index| confirm_pose(task, limb, by, *index, Extent::Whole));
    let (mut poses, ends): (Vec<_>, Vec<_>) = judged.into_iter().unzip();
    walked(task, &limb.built, &mut poses, &ends, (0.0, 0.0));
    poses.iter_mut().for_each(|pose| pose.lacks.dedup());
    poses
}

/// Takes clearance and tilt on the moves between ends into the poses that they lead to; both may be missed by a doubt, m and rad.
fn walked(
    task: &LoadedTask,
    built: &Built,
    poses: &mut [ConfirmedPose],
    ends: &[Option<Ends>],
    (doubt_m, doubt_rad): (f64, f64),
) {
    let mut before: Option<&Ends> = None;
    let mut grasp: Option<UnitQuaternion<f64>> = None;
    for (index, (pose, ends)) in poses.iter_mut().zip(ends).enumerate() {
        let Some(ends) = ends else { break };
        let carried = task.poses[index].carried.zip(grasp);
        match dense(task, built, index, (before, ends), carried) {
            // A place on the way where the limb does not stand.
            None => pose.lacks.push(Margin::Carries),
            Some((spare_m, on_way_rad)) => {
                pose.keep_clear(task, spare_m, doubt_m);
                if let Some((body, grasp)) = carried {
                    let own = |corrected: &Corrected| tilt_rad(&corrected.tip.rotation, &grasp);
                    pose.tilt_rad = on_way_rad.max(own(&ends.moved)).max(own(&ends.held));
                    let tilts = pose.tilt_rad > body.tilt_max_rad + doubt_rad;
                    pose.lacks.extend(tilts.then_some(Margin::Tilt));
                }
            }
        }
        if task.poses[index].carried.is_none() {
            grasp = Some(ends.moved.tip.rotation);
        }
        before = Some(ends);
    }
    let released = task.poses.last().is_some_and(|pose| pose.hold_kg == 0.0);
    let all: Option<Vec<&Ends>> = ends.iter().map(Option::as_ref).collect();
    if let (Some(last), true, Some(all)) = (poses.last_mut(), released && task.moves, all) {
        match back_spare_m(task, built, &all) {
            None => last.lacks.push(Margin::Carries),
            Some(spare_m) => last.keep_clear(task, spare_m, doubt_m),
        }
    }
}

impl ConfirmedPose {
    fn keep_clear(&mut self, task: &LoadedTask, spare_m: f64, doubt_m: f64) {
        if !task.obstacles.is_empty() {
            self.spare_m = Some(self.spare_m.unwrap_or(f64::INFINITY).min(spare_m));
            self.lacks.extend((spare_m < -doubt_m).then_some(Margin::Clearance));
        }
    }
}

/// The corrected pressures of a pose as it is reached and as it is held.
pub(super) struct Ends {
    pub(super) moved: Corrected,
    pub(super) held: Corrected,
}

impl Ends {
    /// Those of the rods of the search, with the tip where tubes have it.
    fn of_rods(limb: &Evaluation, by: &Judgement, index: usize) -> Self {
        let (state, shift) = (&limb.poses[index], by.shift(index));
        let of = |stand: &Stand, shift_m: Vector3<f64>| {
            let mut tip = stand.shape.tip();
            tip.translation.vector += shift_m;
            Corrected { stand: stand.clone(), error_m: 0.0, tip }
        };
        Self { moved: of(&state.moved.stand, shift.tip_m[0]), held: of(&state.held.stand, shift.tip_m[1]) }
    }
}

/// Pressures with which tubes between plates have their tip at a place.
#[derive(Clone)]
pub(super) struct Corrected {
    pub(super) stand: Stand,
    error_m: f64,
    tip: Isometry3<f64>,
}

impl Corrected {
    /// From the tip of the rods to that of the tubes, m.
    pub(super) fn shift_m(&self) -> Vector3<f64> {
        self.tip.translation.vector - self.stand.tip_m()
    }
}

/// By rods, with the aim moved by the tip offset of the tubes until these are at the place.
fn corrected(
    built: &Built,
    start: &Stand,
    kg: f64,
    (place_m, shift_m): (&Vector3<f64>, &Vector3<f64>),
) -> Option<Corrected> {
    let (mut here, mut aim_m, mut jacobian) = (start.clone(), place_m - shift_m, None);
    let mut best: Option<Corrected> = None;
    for _ in 0..CORRECTIONS {
        let Ok(next) = reach(built, &here, (&start.shares, kg), &Aim::Point(aim_m), jacobian.as_ref()) else { break };
        (here, jacobian) = (next.stand, next.jacobian);
        let Some((_, fine)) = by_plates(built, &here.shares, kg) else { break };
        let tip = fine.tip();
        let off = place_m - tip.translation.vector;
        aim_m += off;
        let error_m = off.norm();
        if best.as_ref().is_none_or(|best| error_m < best.error_m) {
            best = Some(Corrected { stand: here.clone(), error_m, tip });
        }
        if error_m <= 0.1 * REACHED_M {
            break;
        }
    }
    best
}

/// A pose before it is judged.
fn unjudged(task: &LoadedTask, limb: &Evaluation, index: usize) -> ConfirmedPose {
    let (pose, state) = (&task.poses[index], &limb.poses[index]);
    ConfirmedPose {
        name: pose.name.clone(),
        payload_kg: pose.payload_kg(),
        pressures_pa: state.pressures_pa.clone(),
        tip_error_m: f64::INFINITY,
        tip_m: state.tip_m,
        load_factor: 0.0,
        stiffness_n_per_m: 0.0,
        sag_m: f64::INFINITY,
        buckling_margin: 0.0,
        pressure_share: 0.0,
        tilt_rad: state.tilt_rad,
        spare_m: state.spare_m().map(|(spare, _)| spare),
        lacks: Vec::new(),
    }
}

fn confirm_pose(
    task: &LoadedTask,
    limb: &Evaluation,
    by: &Judgement,
    index: usize,
    extent: Extent,
) -> (ConfirmedPose, Option<Ends>) {
    let (pose, state, built) = (&task.poses[index], &limb.poses[index], &limb.built);
    let shifts_m = by.shift(index).tip_m;
    let place_m = nearest(&by.aim(task, index), &state.tip_m.into());
    let moved = corrected(built, &state.moved.stand, pose.move_kg, (&place_m, &shifts_m[0]));
    let held = if pose.hold_kg == pose.move_kg {
        moved.clone()
    } else {
        corrected(built, &state.held.stand, pose.hold_kg, (&place_m, &shifts_m[1]))
    };
    let payload_kg = pose.payload_kg();
    let mut answer = unjudged(task, limb, index);
    if let (Some(moved), Some(held)) = (&moved, &held) {
        answer.tip_error_m = moved.error_m.max(held.error_m);
        answer.tip_m = moved.tip.translation.vector.into();
        answer.pressures_pa = built.pressures_pa(&moved.stand.shares);
        let highest = moved.stand.shares.iter().chain(&held.stand.shares).copied().fold(0.0, f64::max);
        answer.pressure_share = task.limits.pressure_share / (1.0 + built.reserve) * highest;
        let loads: &[f64] = if payload_kg > 0.0 { &LOADS } else { &[0.0] };
        let states = loads.iter().map(|share| by_plates(built, &held.stand.shares, share * payload_kg));
        if let Some(states) = states.collect::<Option<Vec<_>>>() {
            let least = |of: &dyn Fn(&(LoadedLimb, Answer)) -> f64| states.iter().map(of).fold(f64::INFINITY, f64::min);
            let enough = task.limits.load_factor;
            let most = if extent == Extent::Whole { enough.max(LOAD_FACTOR_MOST) } else { enough };
            answer.load_factor = least(&|(_, tubes)| tubes.load_factor_to(most));
            answer.stiffness_n_per_m = least(&|(_, tubes)| stiffness_n_per_m(tubes));
            answer.buckling_margin =
                least(&|(_, tubes)| 1.0 / tubes.buckling.map_or(0.0, |tube| tube.ratio())).min(BUCKLING_MARGIN_MAX);
            answer.sag_m = -least(&|(limb, tubes)| -sag_m(limb, tubes));
        }
    }
    answer.lacks = lacks(&task.limits, &answer, built.length_m);
    if index == 0 && task.mass_max_kg.is_some_and(|most| limb.mass_kg > most) {
        answer.lacks.push(Margin::Mass);
    }
    if state.turned_rad > 1e-3 {
        answer.lacks.push(Margin::Direction);
    }
    (answer, moved.zip(held).map(|(moved, held)| Ends { moved, held }))
}

/// Margins that a pose does not keep.
fn lacks(limits: &StandingLimits, pose: &ConfirmedPose, length_m: f64) -> Vec<Margin> {
    [
        (Margin::Reach, pose.tip_error_m <= REACHED_M),
        (Margin::LoadFactor, pose.load_factor >= limits.load_factor),
        (Margin::Stiffness, pose.stiffness_n_per_m >= limits.stiffness_n_per_m),
        (Margin::Sag, pose.sag_m <= limits.sag_share * length_m),
        (Margin::Buckling, pose.buckling_margin >= limits.buckling_margin),
        (Margin::Pressure, pose.pressure_share <= limits.pressure_share * (1.0 + 1e-9)),
        (Margin::Clearance, pose.spare_m.is_none_or(|spare| spare >= 0.0)),
    ]
    .into_iter()
    .filter_map(|(margin, kept)| (!kept).then_some(margin))
    .collect()
}
