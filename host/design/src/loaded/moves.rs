//! Clearance of the moves: straight ways in the pressures, from the sagging rest pose to the first pose and from each to the next.

use std::sync::Arc;

use nalgebra::Vector3;

use super::built::Built;
use super::clearance::{least, spares_m};
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
    let rest = vec![0.0; built.drives()];
    for index in 0..poses.len() {
        let (done, ahead) = poses.split_at_mut(index);
        let carried = task.poses[index].carried.as_ref().zip(grasp(task, &refs(done), index));
        let (before, pose) = (done.last(), &mut ahead[0]);
        let way = way(task, by, index, (before, &rest), pose);
        let grasp = carried.map(|(_, grasp)| grasp);
        let at = |stand: Arc<Stand>, share| Point {
            spares_m: spares_m(built, task, &stand, carried, &way.shift_m(share)),
            tilt_rad: stand.tilt_rad(grasp.as_ref()),
            share,
            stand: Some(stand),
        };
        let mut last = before.map(|before| Arc::new(before.held.stand.clone()));
        let mut stands = Vec::with_capacity(PARTS);
        let mut points: Vec<Point> = Vec::new();
        let mut falls = false;
        // At the end of a move is the pose; at its start the one before, but for the limb at rest.
        for part in usize::from(before.is_some())..PARTS {
            let share = part as f64 / PARTS as f64;
            let near = near.and_then(|near| near.poses.get(index)?.way.get(stands.len())?.as_deref());
            let stand = way.stand(built, share, near.or(last.as_deref())).map(Arc::new);
            if let Some(stand) = &stand {
                points.push(at(stand.clone(), share));
                last = Some(stand.clone());
            } else {
                falls = falls || part == 0;
            }
            stands.push(stand);
        }
        points.push(Point { share: 1.0, spares_m: pose.spares_m.clone(), tilt_rad: pose.tilt_rad, stand: None });
        let mut width = 1.0 / PARTS as f64;
        for _ in 0..HALVINGS {
            let nearest = points.iter().min_by(|a, b| a.spare().total_cmp(&b.spare()));
            let Some(from) = nearest.filter(|point| point.spare() < FAR_M).map(|point| point.share) else { break };
            width *= 0.5;
            for share in [from - width, from + width].into_iter().filter(|share| (0.0..=1.0).contains(share)) {
                let near =
                    stands.iter().flatten().nth(((share * PARTS as f64) as usize).min(stands.len().saturating_sub(1)));
                if let Some(stand) = way.stand(built, share, near.map(Arc::as_ref)) {
                    points.push(at(Arc::new(stand), share));
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
        let nearest = |obstacle: usize| {
            let spare = |point: &&Point| point.spares_m[obstacle];
            points.iter().min_by(|a, b| spare(a).total_cmp(&spare(b)))
        };
        let nearest: Vec<&Point> = (0..task.obstacles.len()).filter_map(nearest).collect();
        pose.spares_m = nearest.iter().enumerate().map(|(obstacle, point)| point.spares_m[obstacle]).collect();
        let close = |(point, spare_m): (&Point, &f64)| {
            (*spare_m <= FAR_M).then(|| Some((point.share, point.stand.clone()?))).flatten()
        };
        pose.nearest = nearest.into_iter().zip(&pose.spares_m).map(close).collect();
        pose.way = stands;
    }
}

/// A point of a move; without an equilibrium the pose that it leads to.
struct Point {
    share: f64,
    spares_m: Vec<f64>,
    tilt_rad: f64,
    stand: Option<Arc<Stand>>,
}

impl Point {
    fn spare(&self) -> f64 {
        least(&self.spares_m).map_or(f64::INFINITY, |(spare_m, _)| spare_m)
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
) -> (Vec<f64>, f64) {
    let rest = vec![0.0; built.drives()];
    let before = index.checked_sub(1).map(|before| poses[before]);
    let way = way(task, by, index, (before, &rest), poses[index]);
    let grasp = grasp(task, poses, index);
    let carried = task.poses[index].carried.as_ref().zip(grasp);
    let at = |(share, start): &(f64, Arc<Stand>)| {
        let stand = way.stand_beside(built, *share, start)?;
        Some((spares_m(built, task, &stand, carried, &way.shift_m(*share)), stand.tilt_rad(grasp.as_ref())))
    };
    // Some obstacles, and the tilt, have the same point of the way.
    let mut known = Vec::new();
    let mut known_at = |point: &(f64, Arc<Stand>)| {
        let found: Option<Option<_>> =
            known.iter().find(|(share, _)| *share == point.0).map(|(_, found)| Clone::clone(found));
        found.unwrap_or_else(|| {
            let found = at(point);
            known.push((point.0, found.clone()));
            found
        })
    };
    let spare_m = |obstacle: usize| match near.nearest.get(obstacle).and_then(Option::as_ref) {
        _ if near.spares_m[obstacle] > FAR_M => near.spares_m[obstacle],
        None => poses[index].spares_m[obstacle],
        Some(nearest) => known_at(nearest).map_or(near.spares_m[obstacle], |(spares_m, _)| spares_m[obstacle]),
    };
    let spares_m = (0..task.obstacles.len()).map(spare_m).collect();
    let tilt_rad = match &near.steepest {
        None => poses[index].end_tilt_rad(grasp.as_ref()),
        Some(steepest) => known_at(steepest).map_or(near.tilt_rad, |(_, tilt_rad)| tilt_rad),
    };
    (spares_m, tilt_rad)
}
