//! Clearance of the moves: straight ways in the pressures, from the sagging rest pose to the first pose and from each to the next.

use nalgebra::Vector3;

use super::built::Built;
use super::clearance::spare_m;
use super::evaluate::{Evaluation, Judgement, grasp, refs};
use super::inverse::Stand;
use super::pose::PoseState;
use super::task::LoadedTask;

/// Number of parts in which a move is sampled, and how often the parts next to the nearest point are halved.
const PARTS: usize = 4;
const HALVINGS: usize = 3;
/// A move that is clear by more than this at all of its points is not looked at in more of them, m.
const FAR_M: f64 = 0.04;
/// What a rest pose that does not stand counts as a share of the load that is not carried.
const FALLS: f64 = 1.0;

/// A straight way in the pressures, shares of their ranges, under one mass.
pub(super) struct Move<'a> {
    pub(super) from: &'a [f64],
    pub(super) to: &'a [f64],
    pub(super) kg: f64,
    /// From the tip of rods to that of tubes at both ends, m.
    pub(super) shifts_m: [Vector3<f64>; 2],
}

impl Move<'_> {
    /// The limb at a share of the way.
    pub(super) fn stand(&self, built: &Built, share: f64, near: Option<&Stand>) -> Option<Stand> {
        Stand::at(built, &self.shares(share), self.kg, near).ok()
    }

    /// The same for a limb just beside another one, near its equilibrium.
    fn stand_beside(&self, built: &Built, share: f64, near: &Stand) -> Option<Stand> {
        Stand::beside(built, &self.shares(share), self.kg, near)
    }

    fn shares(&self, share: f64) -> Vec<f64> {
        self.from.iter().zip(self.to).map(|(a, b)| a + share * (b - a)).collect()
    }

    /// Shift of the tip at a share of the way, m.
    pub(super) fn shift_m(&self, share: f64) -> Vector3<f64> {
        self.shifts_m[0].lerp(&self.shifts_m[1], share)
    }
}

/// The move to a pose, from the one before or else from rest.
fn way<'a>(
    task: &LoadedTask,
    by: &Judgement,
    index: usize,
    (before, rest): (Option<&'a PoseState>, &'a [f64]),
    pose: &'a PoseState,
) -> Move<'a> {
    Move {
        from: before.map_or(rest, |before| &before.held.stand.shares),
        to: &pose.moved.stand.shares,
        kg: task.poses[index].move_kg,
        shifts_m: [
            index.checked_sub(1).map_or_else(Vector3::zeros, |before| by.shift(before).tip_m[1]),
            by.shift(index).tip_m[0],
        ],
    }
}

/// Takes clearance and tilt of the moves into those of the poses that they lead to. `near` is a limb of nearly the same sizes.
pub(super) fn moves(
    built: &Built,
    task: &LoadedTask,
    by: &Judgement,
    poses: &mut [PoseState],
    near: Option<&Evaluation>,
) {
    let rest = vec![0.0; built.len()];
    for index in 0..poses.len() {
        let (done, ahead) = poses.split_at_mut(index);
        let carried = task.poses[index].carried.as_ref().zip(grasp(task, &refs(done), index));
        let (before, pose) = (done.last(), &mut ahead[0]);
        let way = way(task, by, index, (before, &rest), pose);
        let grasp = carried.map(|(_, grasp)| grasp);
        let at = |stand: Stand, share| Point {
            spare_m: spare_m(built, task, &stand, carried, &way.shift_m(share)),
            tilt_rad: stand.tilt_rad(grasp.as_ref()),
            share,
            stand: Some(stand),
        };
        let mut last = before.map(|before| before.held.stand.clone());
        let mut stands = Vec::with_capacity(PARTS);
        let mut points: Vec<Point> = Vec::new();
        let mut falls = false;
        // At the end of a move is the pose; at its start the one before, but for the limb at rest.
        for part in usize::from(before.is_some())..PARTS {
            let share = part as f64 / PARTS as f64;
            let near = near.and_then(|near| near.poses.get(index)?.way.get(stands.len())?.as_ref());
            let stand = way.stand(built, share, near.or(last.as_ref()));
            if let Some(stand) = &stand {
                points.push(at(stand.clone(), share));
                last = Some(stand.clone());
            } else {
                falls = falls || part == 0;
            }
            stands.push(stand);
        }
        points.push(Point { share: 1.0, spare_m: pose.spare_m, tilt_rad: pose.tilt_rad, stand: None });
        let mut width = 1.0 / PARTS as f64;
        for _ in 0..HALVINGS {
            let nearest = points.iter().min_by(|a, b| a.spare().total_cmp(&b.spare()));
            let Some(from) = nearest.filter(|point| point.spare() < FAR_M).map(|point| point.share) else { break };
            width *= 0.5;
            for share in [from - width, from + width].into_iter().filter(|share| (0.0..=1.0).contains(share)) {
                let near =
                    stands.iter().flatten().nth(((share * PARTS as f64) as usize).min(stands.len().saturating_sub(1)));
                if let Some(stand) = way.stand(built, share, near) {
                    points.push(at(stand, share));
                }
            }
        }
        if falls {
            pose.not_carried += FALLS;
        }
        if let Some(steepest) = points.iter().max_by(|a, b| a.tilt_rad.total_cmp(&b.tilt_rad)) {
            pose.tilt_rad = steepest.tilt_rad;
            pose.steepest = steepest.stand.clone().map(|stand| (steepest.share, stand));
        }
        if let Some(nearest) = points.into_iter().min_by(|a, b| a.spare().total_cmp(&b.spare())) {
            pose.spare_m = nearest.spare_m;
            pose.nearest = nearest.stand.map(|stand| (nearest.share, stand));
        }
        pose.way = stands;
    }
}

/// A point of a move; without an equilibrium the pose that it leads to.
struct Point {
    share: f64,
    spare_m: Option<(f64, usize)>,
    tilt_rad: f64,
    stand: Option<Stand>,
}

impl Point {
    fn spare(&self) -> f64 {
        spare(&self.spare_m)
    }
}

/// Clearance and tilt on the move to a pose of a limb just beside, at the points of the move that are the nearest and the steepest one at `near`: as far
/// as derivatives go, they are so there, too.
pub(super) fn beside(
    built: &Built,
    task: &LoadedTask,
    by: &Judgement,
    index: usize,
    poses: &[&PoseState],
    near: &PoseState,
) -> (Option<(f64, usize)>, f64) {
    let rest = vec![0.0; built.len()];
    let before = index.checked_sub(1).map(|before| poses[before]);
    let way = way(task, by, index, (before, &rest), poses[index]);
    let grasp = grasp(task, poses, index);
    let carried = task.poses[index].carried.as_ref().zip(grasp);
    let stand = |(share, stand): &(f64, Stand)| Some((*share, way.stand_beside(built, *share, stand)?));
    let spare_m = match &near.nearest {
        None => poses[index].spare_m,
        Some(_) if spare(&near.spare_m) > FAR_M => near.spare_m,
        Some(nearest) => stand(nearest)
            .map_or(near.spare_m, |(share, stand)| spare_m(built, task, &stand, carried, &way.shift_m(share))),
    };
    let tilt_rad = match &near.steepest {
        None => poses[index].moved.stand.tilt_rad(grasp.as_ref()),
        Some(steepest) => stand(steepest).map_or(near.tilt_rad, |(_, stand)| stand.tilt_rad(grasp.as_ref())),
    };
    (spare_m, tilt_rad)
}

fn spare(spare: &Option<(f64, usize)>) -> f64 {
    spare.map_or(f64::INFINITY, |(spare, _)| spare)
}
