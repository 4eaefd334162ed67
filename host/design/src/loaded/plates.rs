//! The finest statics beside the rods of the search: tubes between plates.

use nalgebra::{Isometry3, Vector3};

use super::built::Built;
use super::evaluate::{Evaluation, grasped_at};
use super::inverse::{Reached, tilt_rad};
use super::pose::PoseState;
use super::task::{LoadedPose, LoadedTask};
use softlimb_limb::statics::{Answer, LoadedLimb, by_tubes};

/// Tubes are cut into as many pieces as change their tip by no more than this, m.
const PIECES_M: f64 = 2e-5;

/// Tubes between plates at shares of the pressures with a payload, kg; `None` where they have no shape that the limb at rest leads to.
pub(super) fn by_plates(built: &Built, shares: &[f64], kg: f64) -> Option<(LoadedLimb, Answer)> {
    let limb = built.loaded(shares, kg)?;
    let answer = by_tubes(&limb, PIECES_M / built.length_m, built.length_m)?;
    Some((limb, answer))
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
}

impl Shift {
    /// Its change from another one, over the change that is none.
    pub(super) fn change(&self, other: &Self) -> f64 {
        let tips = [0, 1].map(|state: usize| (self.tip_m[state] - other.tip_m[state]).norm());
        (tips[0].max(tips[1]) / SHIFTED_M).max((self.tilt_rad - other.tilt_rad).abs() / SHIFTED_RAD)
    }
}

/// From rods to tubes in each pose; zero where tubes have no shape.
pub(super) fn shifts(task: &LoadedTask, limb: &Evaluation) -> Vec<Shift> {
    let tip = |reached: &Reached, kg: f64| {
        let tubes = by_plates(&limb.built, &reached.stand.shares, kg);
        tubes.map_or_else(|| reached.stand.shape.tip(), |(_, tubes)| tubes.tip())
    };
    let mut turns = Vec::with_capacity(task.poses.len());
    let of_pose = |(index, (pose, state)): (usize, (&LoadedPose, &PoseState))| {
        let way = |tip: &Isometry3<f64>, reached: &Reached| tip.translation.vector - reached.stand.tip_m();
        let moved = tip(&state.moved, pose.move_kg);
        let first_m = way(&moved, &state.moved);
        let held_m =
            if pose.hold_kg == pose.move_kg { first_m } else { way(&tip(&state.held, pose.hold_kg), &state.held) };
        turns.push(moved.rotation);
        let tilt_rad = grasped_at(task, index).map_or(0.0, |grasp| {
            let rods = state.moved.stand.tilt_rad(Some(&limb.poses[grasp].moved.stand.shape.tip().rotation));
            tilt_rad(&moved.rotation, &turns[grasp]) - rods
        });
        Shift { tip_m: [first_m, held_m], tilt_rad }
    };
    task.poses.iter().zip(&limb.poses).enumerate().map(of_pose).collect()
}
