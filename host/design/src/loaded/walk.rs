//! The moves of a limb by dense samples: clearance, and tilt of the carried body.

use nalgebra::{UnitQuaternion, Vector3};

use super::built::Built;
use super::clearance::{least, spares_m};
use super::confirm::Ends;
use super::inverse::Stand;
use super::moves::Move;
use super::task::{CarriedBody, LoadedTask};

/// Points of a move, and of the change of mass at its end, that its clearance is taken at.
const DENSE: usize = 48;
const HAND_OVER: usize = 8;

/// Points of a way in the pressures under loads.
struct Walk<'a> {
    task: &'a LoadedTask,
    built: &'a Built,
    carried: Option<(CarriedBody, UnitQuaternion<f64>)>,
    near: Option<Stand>,
    spare_m: f64,
    tilt_rad: f64,
}

impl Walk<'_> {
    /// Goes along a move; `None` where the limb does not stand on it.
    fn go(&mut self, way: &Move<'_>, parts: usize) -> Option<()> {
        for part in 0..=parts {
            let share = part as f64 / parts as f64;
            self.at(way, share)?;
        }
        Some(())
    }

    fn at(&mut self, way: &Move<'_>, share: f64) -> Option<()> {
        let stand = way.stand(self.built, share, self.near.as_ref())?;
        let carried = self.carried.as_ref().map(|(body, grasp)| (body, *grasp));
        let spares_m = spares_m(self.built, self.task, &stand, carried, &way.shift_m(share));
        self.spare_m = least(&spares_m).map_or(self.spare_m, |(spare_m, _)| self.spare_m.min(spare_m));
        if let Some((_, grasp)) = carried {
            self.tilt_rad = self.tilt_rad.max(stand.tilt_rad(Some(&grasp)));
        }
        self.near = Some(stand);
        Some(())
    }
}

/// Least clearance beyond the one asked for and largest tilt of the carried body, rad, on the way to a pose and while the mass changes hands there, m;
/// infinite without obstacles. `None` where the limb does not stand on the way.
pub(super) fn dense(
    task: &LoadedTask,
    built: &Built,
    index: usize,
    (before, ends): (Option<&Ends>, &Ends),
    carried: Option<(CarriedBody, UnitQuaternion<f64>)>,
) -> Option<(f64, f64)> {
    let pose = &task.poses[index];
    let rest = vec![0.0; built.drives()];
    let (moved, held) = (&ends.moved, &ends.held);
    let mut walk = Walk { task, built, carried, near: None, spare_m: f64::INFINITY, tilt_rad: 0.0 };
    let way = Move {
        from: before.map_or(&rest, |before| &before.held.stand.shares),
        to: &moved.stand.shares,
        kg: pose.move_kg,
        shifts_m: [before.map_or_else(Vector3::zeros, |before| before.held.shift_m()), moved.shift_m()],
    };
    walk.go(&way, DENSE)?;
    // The mass changes hands while the pressures change in step.
    for part in 0..=HAND_OVER {
        let share = part as f64 / HAND_OVER as f64;
        let kg = pose.move_kg + share * (pose.hold_kg - pose.move_kg);
        let shifts_m = [moved.shift_m(), held.shift_m()];
        walk.at(&Move { from: &moved.stand.shares, to: &held.stand.shares, kg, shifts_m }, share)?;
    }
    Some((walk.spare_m, walk.tilt_rad))
}

/// Least clearance beyond the one asked for on the way of the empty limb back to rest, m: straight, or else past the poses in their reverse order.
/// `None` where the limb does not stand on the way.
pub(super) fn back_spare_m(task: &LoadedTask, built: &Built, ends: &[&Ends]) -> Option<f64> {
    let rest = vec![0.0; built.drives()];
    let along = |from: usize, past: &mut dyn Iterator<Item = usize>| {
        let mut walk = Walk { task, built, carried: None, near: None, spare_m: f64::INFINITY, tilt_rad: 0.0 };
        let mut here = from;
        let shift_m = |index: usize| ends[index].held.shift_m();
        let shares = |index: usize| &ends[index].held.stand.shares;
        for next in past {
            let way = Move { from: shares(here), to: shares(next), kg: 0.0, shifts_m: [shift_m(here), shift_m(next)] };
            walk.go(&way, DENSE)?;
            here = next;
        }
        let way = Move { from: shares(here), to: &rest, kg: 0.0, shifts_m: [shift_m(here), Vector3::zeros()] };
        walk.go(&way, DENSE)?;
        Some(walk.spare_m)
    };
    let last = ends.len().checked_sub(1)?;
    let straight = along(last, &mut std::iter::empty());
    if straight.is_some_and(|spare_m| spare_m >= 0.0) {
        return straight;
    }
    let past = along(last, &mut (0..last).rev());
    [straight, past].into_iter().flatten().reduce(f64::max)
}
