//! One local solve of the search: bounded least squares on what the margins lack.

use std::panic::resume_unwind;

use super::built::Built;
use super::evaluate::{Evaluation, Judgement, evaluate_at, grasp, grasped_at, poses_at, refs, residuals, sought};
use super::hinges::{Ends, Hinged, minimise};
use super::moves::beside;
use super::pose::{Changed, PoseState, pose_at};
use super::residuals::Residual;
use super::space::{HOME, LimbSpace};
use super::task::LoadedTask;
use nalgebra::{DMatrix, DVector};
use softlimb_numerics::least_squares::Minimum;

/// Steps of a derivative in the unit box, and of that of a load factor, which is known to a thousandth.
const STEP: f64 = 1e-6;
const LOAD_STEP: f64 = 2e-4;
/// A sum of squares that counts as nothing lacking: 0.03 mm, or 0.1 % of a limit, which the reserve covers.
pub(super) const NOTHING: f64 = 1e-5;

struct Problem<'a> {
    task: &'a LoadedTask,
    space: &'a LimbSpace,
    by: &'a Judgement,
    evaluations: usize,
    /// A limb to start from.
    near: &'a Evaluation,
    warm: Option<Evaluation>,
    /// Variables of the space, and those of them that are none of a limb at given pressures.
    sizes: usize,
    idle: Vec<bool>,
}

/// The point of a limb at its pressures: the variables of the space, then shares of the pressures.
pub(super) fn with_pressures(task: &LoadedTask, sizes: &[f64], limb: &Evaluation) -> Vec<f64> {
    let shares = limb.shares();
    let pressures = shares.iter().enumerate().flat_map(|(pose, shares)| {
        shares.iter().take(states(task, pose)).flatten().map(|share| share.clamp(0.0, 1.0)).collect::<Vec<f64>>()
    });
    sizes.iter().copied().chain(pressures).collect()
}

/// Number of states of a pose that have pressures of their own.
fn states(task: &LoadedTask, pose: usize) -> usize {
    if task.poses[pose].hold_kg == task.poses[pose].move_kg { 1 } else { 2 }
}

impl Problem<'_> {
    fn near(&self) -> &Evaluation {
        self.warm.as_ref().unwrap_or(self.near)
    }

    /// Shares of the pressures of each pose, as it is reached and as it is held.
    fn shares(&self, point: &[f64]) -> Vec<[Vec<f64>; 2]> {
        let mut left = point[self.sizes..].chunks(self.space.owners().len());
        let mut next = || left.next().unwrap_or_default().to_vec();
        let of_pose = |pose: usize| {
            let moved = next();
            let held = if states(self.task, pose) == 1 { moved.clone() } else { next() };
            [moved, held]
        };
        (0..self.task.poses.len()).map(of_pose).collect()
    }

    /// The pose, and the state of it, that a pressure belongs to.
    fn pose_of(&self, pressure: usize) -> (usize, usize) {
        let mut state = pressure / self.space.owners().len();
        for pose in 0..self.task.poses.len() {
            if state < states(self.task, pose) {
                return (pose, state);
            }
            state -= states(self.task, pose);
        }
        (0, 0)
    }

    /// Derivative of the residuals by one variable; zeros where the limb beside does not stand. `base` is the limb itself by the same route.
    fn column(&self, at: &At, base: &Base, axis: usize) -> DVector<f64> {
        let here = &base.residuals;
        let sign = if at.point[axis] > 0.5 { -1.0 } else { 1.0 };
        let by = |step: f64| {
            let mut point = at.point.clone();
            point[axis] += step;
            let there = if axis < self.sizes {
                self.with_size(at, &point).map(|there| there.residuals)
            } else {
                self.with_pressure(at, base, &point, axis)
            };
            match there {
                Some(there) => DVector::from_fn(here.len(), |row, _| (there[row].value - here[row].value) / step),
                None => DVector::zeros(here.len()),
            }
        };
        let mut column = by(sign * STEP);
        if here.iter().any(Residual::is_stepped) {
            let coarse = by(sign * LOAD_STEP);
            (0..here.len()).filter(|row| here[*row].is_stepped()).for_each(|row| column[row] = coarse[row]);
        }
        column
    }

    fn with_size(&self, at: &At, point: &[f64]) -> Option<Base> {
        let (task, space, by) = (self.task, self.space, self.by);
        let near = &at.limb;
        let mut sizes = space.sizes(&point[..self.sizes]);
        // Another number of spacers is a jump, not a slope.
        sizes.modules.iter_mut().zip(&near.sizes.modules).for_each(|(own, near)| own.spacers = near.spacers);
        let built = Built::near(task, space, &sizes, by.reserve, (&near.built, &near.sizes))?;
        let mut poses = poses_at(task, &built, &self.shares(point), by, &near.poses, Changed::All)?;
        let moves: Vec<_> =
            (0..poses.len()).map(|index| beside(&built, task, by, index, &refs(&poses), &near.poses[index])).collect();
        poses.iter_mut().zip(moves).for_each(|(pose, by)| (pose.spares_m, pose.tilt_rad) = by);
        let residuals = residuals(task, &built, &refs(&poses), by);
        Some(Base { poses, residuals })
    }

    fn with_pressure(&self, at: &At, base: &Base, point: &[f64], axis: usize) -> Option<Vec<Residual>> {
        let (task, by, near) = (self.task, self.by, &at.limb);
        let (pose, state) = self.pose_of(axis - self.sizes);
        let changed = match (states(task, pose), state) {
            (1, _) => Changed::All,
            (_, 0) => Changed::Moved,
            _ => Changed::Held,
        };
        let [moved, held] = &self.shares(point)[pose];
        let poses = refs(&base.poses);
        let seeks = |index: usize, poses: &[&PoseState]| sought(task, index, by, grasp(task, poses, index));
        let own =
            pose_at(&near.built, &seeks(pose, &poses), [moved, held], (&near.poses[pose], &base.poses[pose]), changed)?;
        // The moves to it and from it, and the bodies that are grasped there.
        let affected = |index: &usize| {
            *index == pose || *index == pose + 1 || (state == 0 && grasped_at(task, *index) == Some(pose))
        };
        let mut others: Vec<(usize, PoseState)> = Vec::new();
        for index in (pose..poses.len()).filter(affected) {
            let mut there = poses.clone();
            there[pose] = &own;
            let turned = (index != pose && grasped_at(task, index) == Some(pose))
                .then(|| base.poses[index].grasped(&near.built, &seeks(index, &there)));
            if let Some(turned) = &turned {
                there[index] = turned;
            }
            let (spares_m, tilt_rad) = beside(&near.built, task, by, index, &there, &near.poses[index]);
            let mut judged = if index == pose { own.clone() } else { base.poses[index].clone() };
            (judged.spares_m, judged.tilt_rad) = (spares_m, tilt_rad);
            others.push((index, judged));
        }
        let mut poses = poses;
        others.iter().for_each(|(index, judged)| poses[*index] = judged);
        Some(residuals(task, &near.built, &poses, by))
    }
}

/// A limb beside another one: its poses and residuals.
struct Base {
    poses: Vec<PoseState>,
    residuals: Vec<Residual>,
}

/// A point with its limb.
pub(super) struct At {
    pub(super) point: Vec<f64>,
    pub(super) limb: Evaluation,
}

impl Hinged for Problem<'_> {
    type Evaluation = At;

    fn evaluate(&mut self, point: &[f64]) -> Option<At> {
        self.evaluations += 1;
        let sizes = self.space.sizes(&point[..self.sizes]);
        let limb = evaluate_at(self.task, self.space, &sizes, &self.shares(point), self.by, self.near())?;
        Some(At { point: point.to_vec(), limb })
    }

    fn residuals(&self, at: &At) -> Vec<(f64, bool)> {
        at.limb.residuals.iter().map(|residual| (residual.value, residual.one_sided)).collect()
    }

    fn jacobian(&mut self, at: &At) -> Option<DMatrix<f64>> {
        self.warm = Some(at.limb.clone());
        let base = self.with_size(at, &at.point)?;
        let count = base.residuals.len();
        self.evaluations += 1 + self.sizes - self.idle.iter().filter(|idle| **idle).count();
        let columns: Vec<DVector<f64>> = (0..at.point.len())
            .map(|axis| {
                let idle = self.idle.get(axis).copied().unwrap_or(false);
                if idle { DVector::zeros(count) } else { self.column(at, &base, axis) }
            })
            .collect();
        Some(DMatrix::from_columns(&columns))
    }
}

/// The limb that least squares lead to from a limb at a point of the space, and the limbs judged.
pub(super) fn local(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    near: &Evaluation,
    by: &Judgement,
    steps: usize,
) -> Option<(Minimum<At>, usize)> {
    let variables = space.variables();
    let idle: Vec<bool> = variables.iter().map(|variable| variable.name == HOME).collect();
    let sizes = variables.len();
    let start = with_pressures(task, &start[..sizes], near);
    let mut problem = Problem { task, space, by, evaluations: 0, near, warm: None, sizes, idle };
    let ends = Ends { zero: NOTHING, relative: 1e-4, least_gain: 5e-3, steps: steps.max(1) };
    let minimum = minimise(&mut problem, &start, ends)?;
    Some((minimum, problem.evaluations))
}

/// Applies `work` to every item in its own thread; results keep the order of the items.
pub(super) fn abreast<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    std::thread::scope(|scope| {
        let handles: Vec<_> = items.iter().map(|item| scope.spawn(|| work(item))).collect();
        handles.into_iter().map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}

#[cfg(test)]
pub(super) mod compared;
