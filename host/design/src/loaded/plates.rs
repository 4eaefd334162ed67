//! The finest statics beside the rods of the search: tubes between plates.

use nalgebra::Vector3;

use super::built::Built;
use super::evaluate::Evaluation;
use super::inverse::Reached;
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

/// Way from the tip of rods to that of tubes in each pose, m, as it is reached and as it is held; zero where tubes have no shape.
pub(super) fn shifts_m(task: &LoadedTask, limb: &Evaluation) -> Vec<[Vector3<f64>; 2]> {
    let shift = |reached: &Reached, kg: f64| {
        let tubes = by_plates(&limb.built, &reached.stand.shares, kg);
        tubes.map_or_else(Vector3::zeros, |(_, tubes)| tubes.tip().translation.vector - reached.stand.tip_m())
    };
    let of_pose = |(pose, state): (&LoadedPose, &PoseState)| {
        let moved = shift(&state.moved, pose.move_kg);
        [moved, if pose.hold_kg == pose.move_kg { moved } else { shift(&state.held, pose.hold_kg) }]
    };
    task.poses.iter().zip(&limb.poses).map(of_pose).collect()
}
