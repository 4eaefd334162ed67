//! One limb judged: its poses under load, and what every margin lacks.

use nalgebra::{UnitQuaternion, Vector3};

use super::built::Built;
use super::inverse::{Stand, reach};
use super::moves::moves;
use super::plates::Shift;
use super::pose::{Changed, PoseState, Sought, moved_aim, pose_at, pose_state};
use super::residuals::{Lack, Residual, of_pose};
use super::space::{LimbSizes, LimbSpace};
use super::task::LoadedTask;
use crate::synthesis::Aim;

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
    pub(super) built: Built,
    pub(super) residuals: Vec<Residual>,
}

impl Evaluation {
    /// Sum of the squares of what is lacking.
    pub fn objective(&self) -> f64 {
        self.lacks.iter().map(|lack| lack.value * lack.value).sum()
    }

    /// Unit vector along the end effector in each pose at whose end it grasps a body, fixed frame; `None` in the others.
    pub fn grasp_directions(&self, task: &LoadedTask) -> Vec<Option<[f64; 3]>> {
        let mut directions = vec![None; self.poses.len()];
        for pose in 0..self.poses.len() {
            let before = refs(&self.poses);
            if let Some((grasp, turn)) = grasped_at(task, pose).zip(grasp(task, &before, pose)) {
                directions[grasp] = Some((turn * Vector3::z()).into());
            }
        }
        directions
    }
}

/// What limbs are judged by beyond their task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Share by which every margin shall be better than its limit.
    pub reserve: f64,
    /// From rods to tubes between plates in each pose. Zero where there is none.
    pub shifts: Vec<Shift>,
    /// Whether the moves are judged, too, where the task wants them clear.
    pub moves: bool,
    /// Places within regions that poses are led to, m; a pose without one, or with `None`, may be anywhere in its region.
    pub places: Vec<Option<Vector3<f64>>>,
}

impl Judgement {
    pub(super) fn shift(&self, pose: usize) -> Shift {
        self.shifts.get(pose).copied().unwrap_or_default()
    }

    /// Where the tip shall be in a pose.
    pub(super) fn aim(&self, task: &LoadedTask, pose: usize) -> Aim {
        let place = self.places.get(pose).copied().flatten();
        place.map_or_else(|| task.poses[pose].aim.clone(), Aim::Point)
    }
}

/// Judges a limb of sizes, with pressures by inverse kinematics under load that are nearest to the home of the sizes.
///
/// `None` where an actuator cannot be modelled or the limb does not stand in the first pose.
pub fn evaluate(task: &LoadedTask, space: &LimbSpace, sizes: &LimbSizes, by: &Judgement) -> Option<Evaluation> {
    let built = Built::new(task, space, sizes, by.reserve)?;
    let mut poses: Vec<PoseState> = Vec::with_capacity(task.poses.len());
    for (index, pose) in task.poses.iter().enumerate() {
        let grasp = grasp(task, &refs(&poses), index);
        let sought = Sought { home: &sizes.home, ..sought(task, index, by, grasp) };
        let after = || pose_state(&built, &sought, &poses.last()?.held.stand);
        let anew = || pose_state(&built, &sought, &first(&built, sizes, pose.move_kg)?);
        let found = after().or_else(anew)?;
        poses.push(found);
    }
    Some(Evaluation::of(task, built, sizes, by, poses, None))
}

/// Judges a limb of sizes at pressures, near a limb of nearly the same sizes and pressures.
///
/// `None` where an actuator cannot be modelled or the limb does not stand in a pose.
pub(super) fn evaluate_at(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    shares: &[[Vec<f64>; 2]],
    by: &Judgement,
    near: &Evaluation,
) -> Option<Evaluation> {
    let built = Built::near(task, space, sizes, by.reserve, (&near.built, &near.sizes))?;
    let poses = poses_at(task, &built, shares, by, &near.poses, Changed::Anew)?;
    Some(Evaluation::of(task, built, sizes, by, poses, Some(near)))
}

/// The poses of a limb at pressures, near those of a limb of nearly the same sizes and pressures.
pub(super) fn poses_at(
    task: &LoadedTask,
    built: &Built,
    shares: &[[Vec<f64>; 2]],
    by: &Judgement,
    near: &[PoseState],
    changed: Changed,
) -> Option<Vec<PoseState>> {
    let mut poses: Vec<PoseState> = Vec::with_capacity(task.poses.len());
    for (index, [moved, held]) in shares.iter().enumerate() {
        let sought = sought(task, index, by, grasp(task, &refs(&poses), index));
        poses.push(pose_at(built, &sought, [moved, held], (&near[index], &near[index]), changed)?);
    }
    Some(poses)
}

/// A pose as it is judged at given pressures.
pub(super) fn sought<'a>(
    task: &'a LoadedTask,
    pose: usize,
    by: &Judgement,
    grasp: Option<UnitQuaternion<f64>>,
) -> Sought<'a> {
    let (aim, shift) = (by.aim(task, pose), by.shift(pose));
    Sought { task, pose: &task.poses[pose], aim, home: &[], reserve: by.reserve, shift, grasp }
}

impl Evaluation {
    fn of(
        task: &LoadedTask,
        built: Built,
        sizes: &LimbSizes,
        by: &Judgement,
        mut poses: Vec<PoseState>,
        near: Option<&Self>,
    ) -> Self {
        let matter = !task.obstacles.is_empty() || task.poses.iter().any(|pose| pose.carried.is_some());
        if by.moves && matter && task.moves {
            moves(&built, task, by, &mut poses, near);
        }
        let residuals = residuals(task, &built, &refs(&poses), by);
        let lacks = residuals.iter().map(Residual::lack).collect();
        Self {
            sizes: sizes.clone(),
            residuals,
            lacks,
            mass_kg: built.mass_kg(),
            length_m: built.length_m,
            poses,
            built,
        }
    }

    /// The same sizes judged by something else, with pressures that bring the tip to the places.
    pub(super) fn reaching(&self, task: &LoadedTask, space: &LimbSpace, by: &Judgement) -> Option<Self> {
        let built = Built::new(task, space, &self.sizes, by.reserve)?;
        // The same pressures are other shares of the ranges with another reserve.
        let factor = (1.0 + by.reserve) / (1.0 + self.built.reserve);
        let mut all = Vec::with_capacity(self.poses.len());
        for (index, (pose, state)) in task.poses.iter().zip(&self.poses).enumerate() {
            let reached = |near: &Stand, aim: &Aim, kg| {
                let shares: Vec<f64> = near.shares.iter().map(|share| share * factor).collect();
                let near = near.with_shares(shares.clone());
                Some(reach(&built, &near, (&shares, kg), aim, None).ok()?.stand)
            };
            let [there, then] = by.shift(index).tip_m;
            let moved = reached(&state.moved.stand, &moved_aim(&by.aim(task, index), &-there), pose.move_kg)?;
            let held = if pose.hold_kg == pose.move_kg {
                moved.shares.clone()
            } else {
                reached(&state.held.stand, &Aim::Point(moved.tip_m() + there - then), pose.hold_kg)?.shares
            };
            all.push([moved.shares, held]);
        }
        evaluate_at(task, space, &self.sizes, &all, by, self)
    }

    /// Shares of the pressures of each pose, as it is reached and as it is held.
    pub(super) fn shares(&self) -> Vec<[Vec<f64>; 2]> {
        self.poses.iter().map(|pose| [&pose.moved, &pose.held].map(|reached| reached.stand.shares.clone())).collect()
    }
}

pub(super) fn refs(poses: &[PoseState]) -> Vec<&PoseState> {
    poses.iter().collect()
}

/// Residuals of the margins.
pub(super) fn residuals(task: &LoadedTask, built: &Built, poses: &[&PoseState], by: &Judgement) -> Vec<Residual> {
    poses.iter().enumerate().flat_map(|(index, state)| of_pose(task, built, index, state, by)).collect()
}

/// Orientation of the tip when it grasped the body that it carries to a pose; `None` where it carries none.
pub(super) fn grasp(task: &LoadedTask, before: &[&PoseState], pose: usize) -> Option<UnitQuaternion<f64>> {
    Some(before[grasped_at(task, pose)?].moved.stand.shape.tip().rotation)
}

/// The pose at whose end the body is grasped that is carried to a pose.
pub(super) fn grasped_at(task: &LoadedTask, pose: usize) -> Option<usize> {
    task.poses[pose].carried?;
    (0..pose).rev().find(|index| task.poses[*index].carried.is_none())
}

fn first(built: &Built, sizes: &LimbSizes, kg: f64) -> Option<Stand> {
    let home = Stand::at(built, &sizes.home, kg, None).ok();
    home.or_else(|| FIRST.iter().find_map(|share| Stand::at(built, &vec![*share; built.drives()], kg, None).ok()))
}
