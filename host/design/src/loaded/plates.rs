//! The finest statics beside the rods of the search: tubes between plates.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::built::Built;
use super::evaluate::{Evaluation, Judgement, grasped_at};
use super::inverse::tilt_rad;
use super::pose::{LOADS, PoseState};
use super::task::LoadedTask;
use softlimb_limb::statics::{Answer, Fidelity, LoadedLimb, by_tubes};

/// Tubes are cut into as many pieces as change their tip by no more than this, m.
const PIECES_M: f64 = 2e-5;

/// Tubes between plates at shares of the pressures with a payload, kg; `None` where they have no shape that the limb at rest leads to.
pub(super) fn by_plates(built: &Built, shares: &[f64], kg: f64) -> Option<(LoadedLimb, Answer)> {
    let limb = built.loaded(shares, kg)?;
    let answer = by_tubes(&limb, PIECES_M / built.length_m, built.length_m)?;
    Some((limb, answer))
}

/// Vertical stiffness of the tip, N/m: the lower of that of tubes and that of the finest rods, which `check` has where they are exact enough.
pub(super) fn stiffness_n_per_m(answer: &Answer) -> f64 {
    let (_, bends) = Fidelity::Fourfold.pieces();
    let both = [answer.compliance_m_per_n(), answer.shape.compliance_m_per_n(&answer.rod, bends)];
    both.map(|by| by.map_or(0.0, |by| 1.0 / by[(2, 2)])).into_iter().fold(f64::INFINITY, f64::min)
}

/// Sag of the tip, m: the larger of that of tubes and that of the finest rods.
pub(super) fn sag_m(limb: &LoadedLimb, answer: &Answer) -> f64 {
    let free_m = limb.free_tip().translation.vector;
    let both = [answer.tip(), answer.shape.tip()];
    both.map(|tip| (tip.translation.vector - free_m).norm()).into_iter().fold(0.0, f64::max)
}

/// Changes of a shift that are none: m, rad. They are less than what the corrected pressures of a confirmation make up for.
const SHIFTED_M: f64 = 2e-4;
const SHIFTED_RAD: f64 = 2e-3;

/// From rods to tubes between plates in a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// Way of the tip, m, as the pose is reached and as it is held.
    pub tip_m: [Vector3<f64>; 2],
    /// Tilt of the carried body by tubes less that by rods, rad.
    pub tilt_rad: f64,
    /// Vertical stiffness over that of the rods of the search, less one, without and with all of the payload.
    pub stiffening: [f64; LOADS.len()],
    /// Sag less that of the rods of the search, m.
    pub sag_m: [f64; LOADS.len()],
}

impl Shift {
    /// Its change from another one, over the change that is none.
    pub(super) fn change(&self, other: &Self) -> f64 {
        let tips = [0, 1].map(|state: usize| (self.tip_m[state] - other.tip_m[state]).norm());
        (tips[0].max(tips[1]) / SHIFTED_M).max((self.tilt_rad - other.tilt_rad).abs() / SHIFTED_RAD)
    }
}

/// From rods to tubes in each pose; zero where tubes have no shape. `by` is what the limb was judged by.
pub(super) fn shifts(task: &LoadedTask, limb: &Evaluation, by: &Judgement) -> Vec<Shift> {
    let mut turns = Vec::with_capacity(task.poses.len());
    let mut all = Vec::with_capacity(task.poses.len());
    for (index, (pose, state)) in task.poses.iter().zip(&limb.poses).enumerate() {
        let by = by.shift(index);
        let [moved, held] = [&state.moved.stand, &state.held.stand];
        let tubes = |shares: &[f64], kg: f64| by_plates(&limb.built, shares, kg);
        let loads: Vec<_> = state.loads.iter().map(|load| tubes(&held.shares, load.payload_kg)).collect();
        let known = state.loads.iter().position(|load| load.payload_kg == pose.hold_kg);
        let tip = |answer: &(LoadedLimb, Answer)| answer.1.tip();
        let held_tip = match known {
            Some(known) => loads[known].as_ref().map(tip),
            None => tubes(&held.shares, pose.hold_kg).as_ref().map(tip),
        };
        let held_tip = held_tip.unwrap_or_else(|| held.shape.tip());
        let moved_tip = if pose.hold_kg == pose.move_kg {
            held_tip
        } else {
            tubes(&moved.shares, pose.move_kg).as_ref().map_or_else(|| moved.shape.tip(), tip)
        };
        turns.push(moved_tip.rotation);
        let mut shift = Shift {
            tip_m: [moved_tip.translation.vector - moved.tip_m(), held_tip.translation.vector - held.tip_m()],
            tilt_rad: tilt_shift_rad(task, limb, index, &turns, &[moved_tip, held_tip]),
            ..Shift::default()
        };
        for (slot, (load, tubes)) in state.loads.iter().zip(&loads).enumerate() {
            let Some((limb, tubes)) = tubes else { continue };
            shift.stiffening[slot] =
                stiffness_n_per_m(tubes) * (1.0 + by.stiffening[slot]) / load.stiffness_n_per_m - 1.0;
            shift.sag_m[slot] = sag_m(limb, tubes) - (load.sag_m - by.sag_m[slot]);
        }
        all.push(shift);
    }
    all
}

/// Largest tilt of the carried body at the end of a pose by tubes less that by rods, rad; `turns` are those of the tip by tubes as the poses are reached.
fn tilt_shift_rad(
    task: &LoadedTask,
    limb: &Evaluation,
    index: usize,
    turns: &[UnitQuaternion<f64>],
    tips: &[Isometry3<f64>; 2],
) -> f64 {
    let Some(grasp) = grasped_at(task, index) else { return 0.0 };
    let of = |state: &PoseState| state.moved.stand.shape.tip().rotation;
    let tubes = tips.iter().map(|tip| tilt_rad(&tip.rotation, &turns[grasp])).fold(0.0, f64::max);
    tubes - limb.poses[index].end_tilt_rad(Some(&of(&limb.poses[grasp])))
}
