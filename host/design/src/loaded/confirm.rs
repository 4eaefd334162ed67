//! The limb found, judged once more by the finest statics, tubes between plates, each pose followed from rest.

use nalgebra::Vector3;
use serde::Serialize;

use super::built::Built;
use super::clearance::spare_m;
use super::inverse::{Stand, nearest, reach};
use super::limits::{Margin, StandingLimits};
use super::local_solve::abreast;
use super::moves::Move;
use super::plates::by_plates;
use super::search::Found;
use super::space::LimbSpace;
use super::task::LoadedTask;
use crate::synthesis::Aim;
use softlimb_limb::statics::{Answer, BUCKLING_MARGIN_MAX, LoadedLimb};

/// The tip counts as at its aim within this, m.
pub const REACHED_M: f64 = 1e-4;
/// Points of a move, and of the change of mass at its end, that its clearance is taken at.
const DENSE: usize = 48;
const HAND_OVER: usize = 8;
/// Threads that the poses are judged in.
const THREADS: usize = 2;
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
    /// Pressures that bring the tip to its aim under the load of the move, Pa, one a module.
    pub pressures_pa: Vec<f64>,
    /// Distance of the tip from the aim, m.
    pub tip_error_m: f64,
    /// The tip, m.
    pub tip_m: [f64; 3],
    /// Load factor.
    pub load_factor: f64,
    /// Vertical stiffness of the tip, N/m.
    pub stiffness_n_per_m: f64,
    /// Largest sag, m.
    pub sag_m: f64,
    /// Buckling margin.
    pub buckling_margin: f64,
    /// Highest pressure over the lower of limit and limit point.
    pub pressure_share: f64,
    /// Turn of the end effector since it grasped the carried body, rad; 0 without one. The body hangs upright: its grip lets it swing by this.
    pub swing_rad: f64,
    /// Clearance beyond the one asked for, here and on the straight way to it, m; `None` without obstacles.
    pub spare_m: Option<f64>,
    /// Margins that are not kept.
    pub lacks: Vec<Margin>,
}

/// Judges the limb of a search by tubes between plates, pose by pose, each followed from rest, and the moves by dense samples.
pub fn confirm(task: &LoadedTask, space: &LimbSpace, found: &Found) -> Vec<ConfirmedPose> {
    let Some(built) = Built::new(task, space, &found.evaluation.sizes, found.by.reserve) else { return Vec::new() };
    let indices: Vec<usize> = (0..task.poses.len()).collect();
    let confirmed = {
        let halves: Vec<&[usize]> = indices.chunks(indices.len().div_ceil(THREADS).max(1)).collect();
        let of = |half: &&[usize]| -> Vec<_> {
            // Springs that are known are each thread's own.
            let Some(built) = Built::new(task, space, &found.evaluation.sizes, found.by.reserve) else {
                return Vec::new();
            };
            half.iter().map(|index| confirm_pose(task, &built, found, *index)).collect()
        };
        abreast(&halves, of).into_iter().flatten()
    };
    let (mut poses, ends): (Vec<_>, Vec<_>) = confirmed.unzip();
    let mut before: Option<&Ends> = None;
    for (index, (pose, ends)) in poses.iter_mut().zip(&ends).enumerate() {
        let Some(ends) = ends else { break };
        let spare_m = dense_spare_m(task, &built, index, before, ends);
        // A place on the way where the limb does not stand.
        match spare_m {
            None => pose.lacks.push(Margin::Carries),
            Some(spare_m) if !task.obstacles.is_empty() => {
                pose.spare_m = Some(pose.spare_m.unwrap_or(f64::INFINITY).min(spare_m));
                pose.lacks.extend((spare_m < 0.0).then_some(Margin::Clearance));
            }
            Some(_) => {}
        }
        pose.lacks.dedup();
        before = Some(ends);
    }
    poses
}

/// The corrected pressures of a pose as it is reached and as it is held.
struct Ends {
    moved: Corrected,
    held: Corrected,
}

/// Least clearance beyond the one asked for on the way to a pose and while the mass changes hands there, m; infinite without obstacles. `None` where the
/// limb does not stand on the way.
fn dense_spare_m(task: &LoadedTask, built: &Built, index: usize, before: Option<&Ends>, ends: &Ends) -> Option<f64> {
    let pose = &task.poses[index];
    let rest = vec![0.0; built.len()];
    let (moved, held) = (&ends.moved, &ends.held);
    let way = Move {
        from: before.map_or(&rest, |before| &before.held.stand.shares),
        to: &moved.stand.shares,
        kg: pose.move_kg,
        shifts_m: [before.map_or_else(Vector3::zeros, |before| before.held.shift_m()), moved.shift_m()],
    };
    let mut near: Option<Stand> = None;
    let mut least_m = f64::INFINITY;
    for part in 0..=DENSE {
        let share = part as f64 / DENSE as f64;
        let stand = way.stand(built, share, near.as_ref())?;
        let spare = spare_m(built, task, &stand, pose.carried.as_ref(), &way.shift_m(share));
        least_m = spare.map_or(least_m, |(spare_m, _)| least_m.min(spare_m));
        near = Some(stand);
    }
    // The mass changes hands while the pressures change in step.
    for part in 0..=HAND_OVER {
        let share = part as f64 / HAND_OVER as f64;
        let kg = pose.move_kg + share * (pose.hold_kg - pose.move_kg);
        let shifts_m = [moved.shift_m(), held.shift_m()];
        let change = Move { from: &moved.stand.shares, to: &held.stand.shares, kg, shifts_m };
        let stand = change.stand(built, share, near.as_ref())?;
        let spare = spare_m(built, task, &stand, pose.carried.as_ref(), &change.shift_m(share));
        least_m = spare.map_or(least_m, |(spare_m, _)| least_m.min(spare_m));
        near = Some(stand);
    }
    Some(least_m)
}

/// Pressures with which tubes between plates have their tip at a place.
struct Corrected {
    stand: Stand,
    error_m: f64,
    tip_m: Vector3<f64>,
}

impl Corrected {
    /// From the tip of the rods to that of the tubes, m.
    fn shift_m(&self) -> Vector3<f64> {
        self.tip_m - self.stand.tip_m()
    }
}

/// By rods, with the aim moved by the tip offset of the tubes until these are at the place.
fn corrected(
    built: &Built,
    start: &Stand,
    (home, kg): (&[f64], f64),
    (place_m, shift_m): (&Vector3<f64>, &Vector3<f64>),
) -> Option<Corrected> {
    let (mut here, mut aim_m, mut jacobian) = (start.clone(), place_m - shift_m, None);
    let mut best: Option<Corrected> = None;
    for _ in 0..CORRECTIONS {
        let Ok(next) = reach(built, &here, (home, kg), &Aim::Point(aim_m), jacobian.as_ref()) else { break };
        (here, jacobian) = (next.stand, next.jacobian);
        let Some((_, fine)) = by_plates(built, &here.shares, kg) else { break };
        let tip_m = fine.tip().translation.vector;
        let off = place_m - tip_m;
        aim_m += off;
        let error_m = off.norm();
        if best.as_ref().is_none_or(|best| error_m < best.error_m) {
            best = Some(Corrected { stand: here.clone(), error_m, tip_m });
        }
        if error_m <= 0.1 * REACHED_M {
            break;
        }
    }
    best
}

fn confirm_pose(task: &LoadedTask, built: &Built, found: &Found, index: usize) -> (ConfirmedPose, Option<Ends>) {
    let (pose, state) = (&task.poses[index], &found.evaluation.poses[index]);
    let home = found.evaluation.sizes.home.as_slice();
    let shifts_m = found.by.shifts_m.get(index).copied().unwrap_or_default();
    let place_m = nearest(&pose.aim, &state.tip_m.into());
    let moved = corrected(built, &state.moved.stand, (home, pose.move_kg), (&place_m, &shifts_m[0]));
    let held = corrected(built, &state.held.stand, (home, pose.hold_kg), (&place_m, &shifts_m[1]));
    let payload_kg = pose.payload_kg();
    let mut answer = ConfirmedPose {
        name: pose.name.clone(),
        payload_kg,
        pressures_pa: state.pressures_pa.clone(),
        tip_error_m: f64::INFINITY,
        tip_m: state.tip_m,
        load_factor: 0.0,
        stiffness_n_per_m: 0.0,
        sag_m: f64::INFINITY,
        buckling_margin: 0.0,
        pressure_share: 0.0,
        swing_rad: state.swing_rad,
        spare_m: state.spare_m.map(|(spare, _)| spare),
        lacks: Vec::new(),
    };
    if let (Some(moved), Some(held)) = (&moved, &held) {
        answer.tip_error_m = moved.error_m.max(held.error_m);
        answer.tip_m = moved.tip_m.into();
        answer.pressures_pa = built.pressures_pa(&moved.stand.shares);
        let highest = moved.stand.shares.iter().chain(&held.stand.shares).copied().fold(0.0, f64::max);
        answer.pressure_share = task.limits.pressure_share / (1.0 + found.by.reserve) * highest;
        let loads: &[f64] = if payload_kg > 0.0 { &LOADS } else { &[0.0] };
        let states = loads.iter().map(|share| by_plates(built, &held.stand.shares, share * payload_kg));
        if let Some(states) = states.collect::<Option<Vec<_>>>() {
            let least = |of: &dyn Fn(&(LoadedLimb, Answer)) -> f64| states.iter().map(of).fold(f64::INFINITY, f64::min);
            answer.load_factor = least(&|(_, tubes)| tubes.load_factor());
            answer.stiffness_n_per_m =
                least(&|(_, tubes)| tubes.compliance_m_per_n().map_or(0.0, |by| 1.0 / by[(2, 2)]));
            answer.buckling_margin =
                least(&|(_, tubes)| 1.0 / tubes.buckling.map_or(0.0, |tube| tube.ratio())).min(BUCKLING_MARGIN_MAX);
            answer.sag_m =
                -least(&|(limb, tubes)| -(tubes.tip().translation.vector - limb.free_tip().translation.vector).norm());
        }
    }
    answer.lacks = lacks(&task.limits, &answer, built.length_m);
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
