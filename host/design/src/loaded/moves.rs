//! Clearance of the moves: straight ways in the pressures, from the sagging rest pose to the first pose and from each to the next.

use nalgebra::Vector3;

use super::built::Built;
use super::clearance::{nearer, spare_m};
use super::evaluate::{Evaluation, Judgement};
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
        let shares: Vec<f64> = self.from.iter().zip(self.to).map(|(a, b)| a + share * (b - a)).collect();
        Stand::at(built, &shares, self.kg, near).ok()
    }

    /// Shift of the tip at a share of the way, m.
    pub(super) fn shift_m(&self, share: f64) -> Vector3<f64> {
        self.shifts_m[0].lerp(&self.shifts_m[1], share)
    }
}

/// Takes the clearance of the moves into that of the poses that they lead to. `warm` is a limb of nearly the same sizes.
pub(super) fn moves(
    built: &Built,
    task: &LoadedTask,
    by: &Judgement,
    poses: &mut [PoseState],
    warm: Option<&Evaluation>,
) {
    let rest = vec![0.0; built.len()];
    for index in 0..poses.len() {
        let (done, ahead) = poses.split_at_mut(index);
        let (before, pose) = (done.last(), &mut ahead[0]);
        let carried = task.poses[index].carried;
        let way = Move {
            from: before.map_or(&rest, |before| &before.held.stand.shares),
            to: &pose.moved.stand.shares,
            kg: task.poses[index].move_kg,
            shifts_m: [
                index.checked_sub(1).map_or_else(Vector3::zeros, |before| by.shift_m(before)[1]),
                by.shift_m(index)[0],
            ],
        };
        let clear = |stand: &Stand, share| spare_m(built, task, stand, carried.as_ref(), &way.shift_m(share));
        let mut last = before.map(|before| before.held.stand.clone());
        let mut stands = Vec::with_capacity(PARTS);
        let mut points: Vec<(f64, Option<(f64, usize)>)> = Vec::new();
        // At the end of a move the pose has been looked at; at its start the one before, but for the limb at rest.
        for part in usize::from(before.is_some())..PARTS {
            let share = part as f64 / PARTS as f64;
            let near = warm.and_then(|warm| warm.poses.get(index)?.way.get(stands.len())?.as_ref());
            let stand = way.stand(built, share, near.or(last.as_ref()));
            if let Some(stand) = &stand {
                points.push((share, clear(stand, share)));
                last = Some(stand.clone());
            } else if part == 0 {
                pose.not_carried += FALLS;
            }
            stands.push(stand);
        }
        points.push((1.0, pose.spare_m));
        let mut width = 1.0 / PARTS as f64;
        for _ in 0..HALVINGS {
            let nearest = points.iter().min_by(|a, b| spare(a).total_cmp(&spare(b)));
            let Some(at) = nearest.filter(|point| spare(point) < FAR_M).map(|point| point.0) else { break };
            width *= 0.5;
            for share in [at - width, at + width].into_iter().filter(|share| (0.0..=1.0).contains(share)) {
                let near =
                    stands.iter().flatten().nth(((share * PARTS as f64) as usize).min(stands.len().saturating_sub(1)));
                if let Some(stand) = way.stand(built, share, near) {
                    points.push((share, clear(&stand, share)));
                }
            }
        }
        pose.spare_m = points.iter().fold(pose.spare_m, |least, (_, spare)| nearer(least, *spare));
        pose.way = stands;
    }
}

fn spare((_, spare): &(f64, Option<(f64, usize)>)) -> f64 {
    spare.map_or(f64::INFINITY, |(spare, _)| spare)
}
