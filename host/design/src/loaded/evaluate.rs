//! One limb judged: its poses under load, and what every margin lacks.

use nalgebra::{UnitQuaternion, Vector3};

use super::built::Built;
use super::inverse::Stand;
use super::moves::moves;
use super::pose::{PoseState, Sought, Start, pose_state};
use super::residuals::{Lack, of_pose};
use super::space::{LimbSizes, LimbSpace};
use super::task::LoadedTask;

/// Shares of the pressures that the first pose is sought from.
const FIRST: [f64; 2] = [0.1, 0.7];

/// A limb judged.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Its sizes.
    pub sizes: LimbSizes,
    /// The poses.
    pub poses: Vec<PoseState>,
    /// What the margins lack.
    pub lacks: Vec<Lack>,
    /// Mass without payload, kg.
    pub mass_kg: f64,
    /// Length at rest, m.
    pub length_m: f64,
}

impl Evaluation {
    /// Sum of the squares of what is lacking.
    pub fn objective(&self) -> f64 {
        self.lacks.iter().map(|lack| lack.value * lack.value).sum()
    }
}

/// What limbs are judged by beyond their task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Share by which every margin shall be better than its limit.
    pub reserve: f64,
    /// Way from the tip of rods to that of tubes between plates in each pose, m: as it is reached and as it is held. Zero where there is none.
    pub shifts_m: Vec<[Vector3<f64>; 2]>,
}

impl Judgement {
    pub(super) fn shift_m(&self, pose: usize) -> [Vector3<f64>; 2] {
        self.shifts_m.get(pose).copied().unwrap_or_default()
    }
}

/// Judges a limb of sizes. `warm` is a limb of nearly the same sizes to start from.
///
/// `None` where an actuator cannot be modelled or the limb does not stand in the first pose.
pub fn evaluate(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    by: &Judgement,
    warm: Option<&Evaluation>,
) -> Option<Evaluation> {
    judge(task, space, sizes, by, warm.map(|warm| (warm, false)))
}

/// The same for a derivative, from the limb that it is the derivative at: its Jacobians of the tip are used, too.
pub(super) fn evaluate_beside(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    by: &Judgement,
    at: &Evaluation,
) -> Option<Evaluation> {
    judge(task, space, sizes, by, Some((at, true)))
}

fn judge(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    by: &Judgement,
    warm: Option<(&Evaluation, bool)>,
) -> Option<Evaluation> {
    let built = Built::new(task, space, sizes, by.reserve)?;
    let mut poses: Vec<PoseState> = Vec::with_capacity(task.poses.len());
    for (index, pose) in task.poses.iter().enumerate() {
        let near = warm.and_then(|(warm, beside)| Some((warm.poses.get(index)?, beside)));
        let sought = Sought { task, pose, home: &sizes.home, reserve: by.reserve, shift_m: by.shift_m(index) };
        let own = near.and_then(|(near, beside)| pose_state(&built, &sought, &Start::Warm { near, beside }));
        let after = || pose_state(&built, &sought, &Start::Cold(&poses.last()?.held.stand));
        let anew = || pose_state(&built, &sought, &Start::Cold(&first(&built, sizes, pose.move_kg)?));
        let found = own.or_else(after).or_else(anew)?;
        poses.push(found);
    }
    swing(task, &mut poses);
    if !task.obstacles.is_empty() && task.moves {
        moves(&built, task, by, &mut poses, warm.map(|(warm, _)| warm));
    }
    let lacks =
        poses.iter().enumerate().flat_map(|(index, state)| of_pose(task, &built, index, state, by.reserve)).collect();
    Some(Evaluation { sizes: sizes.clone(), lacks, poses, mass_kg: built.mass_kg(), length_m: built.length_m })
}

/// Turns of the end effector since the pose before a body is carried.
fn swing(task: &LoadedTask, poses: &mut [PoseState]) {
    let mut grasped: Option<UnitQuaternion<f64>> = None;
    for (pose, state) in task.poses.iter().zip(poses) {
        let turn = state.moved.stand.shape.tip().rotation;
        match (pose.carried, grasped) {
            (Some(_), Some(grasp)) => state.swing_rad = (turn * grasp.inverse() * Vector3::z()).angle(&Vector3::z()),
            _ => grasped = Some(turn),
        }
    }
}

fn first(built: &Built, sizes: &LimbSizes, kg: f64) -> Option<Stand> {
    let home = Stand::at(built, &sizes.home, kg, None).ok();
    home.or_else(|| FIRST.iter().find_map(|share| Stand::at(built, &vec![*share; built.len()], kg, None).ok()))
}
