//! Places within regions: where a planner has the tip, which comes from the pose before.

use nalgebra::{DVector, Matrix3, Vector3};

use super::evaluate::{Evaluation, Judgement};
use super::inverse::{HARDLY_M, Jacobian, Stand, reach, tip_jacobian};
use super::pose::moved_aim;
use super::task::LoadedTask;
use crate::synthesis::Aim;

/// Turns of a step to the place that the tangent foretells.
const TURNS: usize = 8;
/// Sweeps over the three coordinates of a place.
const SWEEPS: usize = 60;
/// Change of a place that is none, m: the reserve covers what it changes.
const PLACED_M: f64 = 1e-3;

/// The place within its region that each pose takes the tip to by the least change of its pressures from those of the pose before; `None` for poses whose
/// place is a point.
pub(super) fn places(task: &LoadedTask, limb: &Evaluation, by: &Judgement) -> Vec<Option<Vector3<f64>>> {
    let place = |pose: usize| {
        let Aim::Inside { .. } = task.poses[pose].aim else { return None };
        let rest = vec![0.0; limb.built.drives()];
        let before = pose.checked_sub(1).map_or(&rest, |before| &limb.poses[before].held.stand.shares);
        entered_m(task, limb, by, pose, before)
    };
    (0..task.poses.len()).map(place).collect()
}

/// The largest change of a place, over the change that is none.
pub(super) fn change(places: &[Option<Vector3<f64>>], others: &[Option<Vector3<f64>>]) -> f64 {
    let of = |(index, place): (usize, &Option<Vector3<f64>>)| match (place, others.get(index).copied().flatten()) {
        (Some(place), Some(other)) => (place - other).norm() / PLACED_M,
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    places.iter().enumerate().map(of).fold(0.0, f64::max)
}

fn entered_m(
    task: &LoadedTask,
    limb: &Evaluation,
    by: &Judgement,
    pose: usize,
    before: &[f64],
) -> Option<Vector3<f64>> {
    let (built, kg) = (&limb.built, task.poses[pose].move_kg);
    let shift_m = by.shift(pose).tip_m[0];
    let region = moved_aim(&task.poses[pose].aim, &-shift_m);
    let mut here: Stand = limb.poses[pose].moved.stand.clone();
    for _ in 0..TURNS {
        let jacobian = tip_jacobian(built, &here, kg)?;
        let place_m = nearest_m(&region, &jacobian, &here, before);
        let way_m = (place_m - here.tip_m()).norm();
        let there = reach(built, &here, (before, kg), &Aim::Point(place_m), Some(&jacobian)).ok()?.stand;
        here = there;
        if way_m <= 0.1 * PLACED_M {
            break;
        }
    }
    Some(here.tip_m() + shift_m)
}

/// The place of a region with the shortest way there in the shares of pressures from those of before, as the tangent has it; a pressure that it would
/// take out of its range stays at its end.
fn nearest_m(region: &Aim, jacobian: &Jacobian, here: &Stand, before: &[f64]) -> Vector3<f64> {
    let Aim::Inside { center_m, half_m, rotation } = region else { return here.tip_m() };
    let count = before.len();
    let away = DVector::from_fn(count, |index, _| before[index] - here.shares[index]);
    let mut held: Vec<Option<f64>> = vec![None; count];
    let mut place_m = here.tip_m();
    for _ in 0..=count {
        let mut free = jacobian.clone();
        let mut from_m = here.tip_m();
        for (index, by) in held.iter().enumerate() {
            from_m += jacobian.column(index) * by.unwrap_or(away[index]);
            if by.is_some() {
                free.column_mut(index).fill(0.0);
            }
        }
        let square: Matrix3<f64> =
            (&free * free.transpose()).fixed_view::<3, 3>(0, 0) + Matrix3::identity() * (HARDLY_M * HARDLY_M);
        let Some(metric) = square.try_inverse() else { break };
        place_m = center_m
            + rotation
                * least(&rotation.inverse_transform_vector(&(from_m - center_m)), half_m, &{
                    let turn = rotation.to_rotation_matrix();
                    turn.transpose() * metric * turn
                });
        let step = free.transpose() * (metric * (place_m - from_m));
        let share = |index: usize| before[index] + step[index];
        let outside = |index: usize| (share(index) - 1.0).max(-share(index));
        let open = (0..count).filter(|index| held[*index].is_none());
        match open.max_by(|a, b| outside(*a).total_cmp(&outside(*b))).filter(|index| outside(*index) > 1e-9) {
            None => break,
            Some(index) => held[index] = Some(share(index).clamp(0.0, 1.0) - here.shares[index]),
        }
    }
    place_m
}

/// The point of a box about the origin that is nearest to a point by a metric, by one coordinate after the other.
fn least(point: &Vector3<f64>, half_m: &Vector3<f64>, metric: &Matrix3<f64>) -> Vector3<f64> {
    let mut place = Vector3::from_fn(|axis, _| point[axis].clamp(-half_m[axis], half_m[axis]));
    for _ in 0..SWEEPS {
        for axis in 0..3 {
            let slope = (metric * (place - point))[axis];
            place[axis] = (place[axis] - slope / metric[(axis, axis)]).clamp(-half_m[axis], half_m[axis]);
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conditions of Karush, Kuhn and Tucker: the slope is zero along open coordinates, and leads out of the box along the others.
    #[test]
    fn nearest_point_of_a_box_meets_the_conditions_of_a_minimum() {
        let half = Vector3::new(0.05, 0.05, 0.025);
        let metric = Matrix3::new(5.0, 3.0, -1.0, 3.0, 4.0, 0.5, -1.0, 0.5, 2.0);
        for point in [Vector3::new(0.2, 0.01, 0.1), Vector3::new(-0.3, 0.2, 0.0), Vector3::new(0.01, 0.0, 0.01)] {
            let place = least(&point, &half, &metric);
            let slope = metric * (place - point);
            for axis in 0..3 {
                let open = place[axis].abs() < half[axis] - 1e-12;
                assert!(
                    if open { slope[axis].abs() < 1e-9 } else { slope[axis] * place[axis] <= 0.0 },
                    "{point} {place}"
                );
            }
        }
    }
}
