//! One pose of a limb: its pressures under load, and what its margins are.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use super::built::Built;
use super::clearance::{least, nearer, spares_m};
use super::inverse::{Reached, Stand, reach};
use super::limits::StandingLimits;
use super::plates::Shift;
use super::task::{LoadedPose, LoadedTask};
use crate::synthesis::Aim;
use softlimb_limb::statics::{Bends, Rod, Shape, UNKNOWNS, solve};

/// Shares of a payload that a pose is judged with; the limb found is judged with half of it, too.
pub(super) const LOADS: [f64; 2] = [0.0, 1.0];
/// A margin that is this many times its limit is far from it.
const FAR: f64 = 1.25;

/// A pose under a share of its payload, at the pressures that hold all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadState {
    /// Payload, kg.
    pub payload_kg: f64,
    /// Load factor, up to that which is enough with the reserve.
    pub load_factor: f64,
    /// Vertical stiffness of the tip, N/m; like the sag it is that of rods with what tubes change, where the limb is judged by them.
    pub stiffness_n_per_m: f64,
    /// Distance of the tip from that without any load, m.
    pub sag_m: f64,
    /// Compression of the worst tube over its load of buckling.
    pub buckling_ratio: f64,
    /// Least bend of a bending module towards its mount angle, rad/m.
    pub least_bend_rad_per_m: f64,
}

/// A pose of a limb.
#[derive(Clone, Debug)]
pub struct PoseState {
    /// Pressures that hold it, Pa, one a drive.
    pub pressures_pa: Vec<f64>,
    /// The same over the highest that keep the margin.
    pub shares: Vec<f64>,
    /// The tip, m: that of rods with its shift.
    pub tip_m: [f64; 3],
    /// What is missing to the aim, m.
    pub missing_m: Vector3<f64>,
    /// Angle between the end effector and the direction that it shall have, beyond the tolerance, rad.
    pub turned_rad: f64,
    /// Tilt of the axis of the carried body, which turns with the end effector since it was grasped, here and on the way, rad; 0 without one.
    pub tilt_rad: f64,
    /// The states without and with all of the payload; fewer where the limb does not carry it.
    pub loads: Vec<LoadState>,
    /// Share of the load that is not carried; 0 where all is.
    pub not_carried: f64,
    /// Least clearance of each obstacle beyond the one asked for, in the pose and on the way to it, m.
    pub(super) spares_m: Vec<f64>,
    pub(super) moved: Reached,
    pub(super) held: Reached,
    /// The equilibrium at the pressures as it is held, under the payload that it is not held with.
    other: Option<Stand>,
    /// Equilibria on the way to it.
    pub(super) way: Vec<Option<Arc<Stand>>>,
    /// The one on the way that comes nearest to each obstacle, at a share of the way; `None` where the pose itself does, or where all are far.
    pub(super) nearest: Vec<Option<(f64, Arc<Stand>)>>,
    /// The same of the one where the carried body tilts most.
    pub(super) steepest: Option<(f64, Arc<Stand>)>,
}

/// A pose and how it is judged.
pub(super) struct Sought<'a> {
    pub(super) task: &'a LoadedTask,
    pub(super) pose: &'a LoadedPose,
    /// Where its tip shall be.
    pub(super) aim: Aim,
    pub(super) home: &'a [f64],
    pub(super) reserve: f64,
    /// From rods to tubes.
    pub(super) shift: Shift,
    /// Orientation of the tip when it grasped the body that it carries.
    pub(super) grasp: Option<UnitQuaternion<f64>>,
}

/// An aim elsewhere, by a way in m.
pub(super) fn moved_aim(aim: &Aim, by_m: &Vector3<f64>) -> Aim {
    match aim {
        Aim::Point(place_m) => Aim::Point(place_m + by_m),
        Aim::Inside { center_m, half_m, rotation } => {
            Aim::Inside { center_m: center_m + by_m, half_m: *half_m, rotation: *rotation }
        }
    }
}

/// The pose of a limb by inverse kinematics from a stand of the same limb in another pose; `None` where it does not stand.
pub(super) fn pose_state(built: &Built, sought: &Sought<'_>, start: &Stand) -> Option<PoseState> {
    let Sought { pose, home, shift: Shift { tip_m: shift_m, .. }, .. } = sought;
    let aim = moved_aim(&sought.aim, &-shift_m[0]);
    let moved = reach(built, start, (home, pose.move_kg), &aim, None).ok()?;
    let (mut held, mut not_carried) = (moved.clone(), 0.0);
    if pose.hold_kg != pose.move_kg {
        // The mass changes hands step by step, and the tip stays.
        let aim = Aim::Point(moved.stand.tip_m() + shift_m[0] - shift_m[1]);
        for part in [0.5, 1.0] {
            let kg = pose.move_kg + part * (pose.hold_kg - pose.move_kg);
            match reach(built, &held.stand, (home, kg), &aim, None) {
                Ok(next) => held = next,
                Err(_) => not_carried += 0.5,
            }
        }
    }
    Some(PoseState { not_carried, ..judged(built, sought, moved, held, None) }.with_loads(built, sought, None))
}

/// Which equilibria of a pose are those of another limb or other pressures. But for the first, the limb is just beside the other one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Changed {
    /// All of them, anywhere near.
    Anew,
    /// All of them.
    All,
    /// The one as the pose is reached.
    Moved,
    /// Those as it is held.
    Held,
}

/// The pose at given pressures, shares of their ranges as it is reached and as it is held, near another one; `None` where it does not stand. What has not
/// changed is that of `same`.
pub(super) fn pose_at(
    built: &Built,
    sought: &Sought<'_>,
    shares: [&[f64]; 2],
    (near, same): (&PoseState, &PoseState),
    changed: Changed,
) -> Option<PoseState> {
    let Sought { pose, shift: Shift { tip_m: shift_m, .. }, .. } = sought;
    let at = |shares: &[f64], kg, near: &Stand| match changed {
        Changed::Anew => Stand::at(built, shares, kg, Some(near)).ok(),
        _ => Stand::beside(built, shares, kg, near),
    };
    let stand = match changed {
        Changed::Held => same.moved.stand.clone(),
        _ => at(shares[0], pose.move_kg, &near.moved.stand)?,
    };
    let aim = moved_aim(&sought.aim, &-shift_m[0]);
    let moved = Reached::of(stand, &aim);
    let held = if pose.hold_kg == pose.move_kg {
        moved.clone()
    } else {
        let stand = match changed {
            Changed::Moved => same.held.stand.clone(),
            _ => at(shares[1], pose.hold_kg, &near.held.stand)?,
        };
        Reached::of(stand, &Aim::Point(moved.stand.tip_m() + shift_m[0] - shift_m[1]))
    };
    let state = judged(built, sought, moved, held, Some(near));
    if changed == Changed::Moved && pose.hold_kg != pose.move_kg {
        let kept = same.clone();
        return Some(PoseState { loads: kept.loads, not_carried: kept.not_carried, other: kept.other, ..state });
    }
    Some(state.with_loads(built, sought, Some((near, changed != Changed::Anew))))
}

/// A pose with its equilibria, and without the states under its loads.
fn judged(built: &Built, sought: &Sought<'_>, moved: Reached, held: Reached, near: Option<&PoseState>) -> PoseState {
    let Sought { pose, shift: Shift { tip_m: shift_m, .. }, .. } = sought;
    let axis = moved.stand.shape.tip().rotation * Vector3::z();
    let turned_rad =
        pose.direction.map_or(0.0, |direction| (axis.angle(&direction.axis) - direction.tolerance_rad).max(0.0));
    let state = PoseState {
        pressures_pa: built.pressures_pa(&held.stand.shares),
        shares: moved.stand.shares.iter().zip(&held.stand.shares).map(|(a, b)| a.max(*b)).collect(),
        tip_m: (moved.stand.tip_m() + shift_m[0]).into(),
        missing_m: moved.missing_m,
        turned_rad,
        tilt_rad: 0.0,
        loads: Vec::new(),
        not_carried: 0.0,
        spares_m: end_spares_m(built, sought, &moved.stand, &held.stand),
        moved,
        held,
        other: near.and_then(|near| near.other.clone()),
        way: Vec::new(),
        nearest: Vec::new(),
        steepest: None,
    };
    PoseState { tilt_rad: state.end_tilt_rad(sought.grasp.as_ref()), ..state }
}

/// Clearance beyond the one asked for of each obstacle in a pose, as it is reached and as it is held, m.
fn end_spares_m(built: &Built, sought: &Sought<'_>, moved: &Stand, held: &Stand) -> Vec<f64> {
    let Sought { task, pose, shift: Shift { tip_m: shift_m, .. }, .. } = sought;
    let clear = |stand: &Stand, shift_m| spares_m(built, task, stand, pose.carried.as_ref().zip(sought.grasp), shift_m);
    let moved_m = clear(moved, &shift_m[0]);
    if pose.hold_kg == pose.move_kg { moved_m } else { nearer(&moved_m, &clear(held, &shift_m[1])) }
}

impl PoseState {
    /// The same pose with what it carries grasped in another way; the way to it is not judged.
    pub(super) fn grasped(&self, built: &Built, sought: &Sought<'_>) -> Self {
        Self { spares_m: end_spares_m(built, sought, &self.moved.stand, &self.held.stand), ..self.clone() }
    }

    /// Least clearance beyond the one asked for, in the pose and on the way to it, m, and the obstacle; `None` without obstacles.
    pub fn spare_m(&self) -> Option<(f64, usize)> {
        least(&self.spares_m)
    }

    /// The larger tilt of a body that stood upright when the tip grasped it, as the pose is reached and as it is held, rad; 0 without one.
    pub(super) fn end_tilt_rad(&self, grasp: Option<&UnitQuaternion<f64>>) -> f64 {
        self.moved.stand.tilt_rad(grasp).max(self.held.stand.tilt_rad(grasp))
    }

    /// The same with its states without and with all of the payload, from those of a pose nearby.
    fn with_loads(mut self, built: &Built, sought: &Sought<'_>, near: Option<(&PoseState, bool)>) -> Self {
        let Sought { task, pose, reserve, .. } = sought;
        let reserve = *reserve;
        let payload_kg = pose.payload_kg();
        let enough = task.limits.load_factor * (1.0 + reserve);
        self.other = None;
        let loads = LOADS.iter().skip(if payload_kg > 0.0 { 0 } else { LOADS.len() - 1 });
        for (index, share) in loads.enumerate() {
            let kg = share * payload_kg;
            let by = (sought.shift.stiffening[index], sought.shift.sag_m[index]);
            let held = &self.held.stand;
            let own = kg == pose.hold_kg;
            let known = near.filter(|(_, beside)| *beside).and_then(|(near, _)| near.loads.get(index));
            // A margin that is far from its limit has no derivative that counts.
            if let Some(load) = known.filter(|load| load.is_far(&task.limits, built.length_m, 1.0 + reserve)) {
                self.loads.push(*load);
                continue;
            }
            let stand = match near.map(|(near, beside)| (near.other.as_ref().unwrap_or(held), beside)) {
                _ if own => Some(held.clone()),
                Some((near, true)) => Stand::beside(built, &held.shares, kg, near),
                near => Stand::at(built, &held.shares, kg, Some(near.map_or(held, |(near, _)| near))).ok(),
            };
            // The load factor of a limb beside is left out where it is enough.
            let enough = known.map_or(enough, |load| if load.load_factor < enough { enough } else { 0.0 });
            let far = FAR * (1.0 + reserve) * task.limits.stiffness_n_per_m;
            let stiffness = known.map(|load| load.stiffness_n_per_m).filter(|stiffness| *stiffness >= far);
            match stand.and_then(|stand| Some((load_state(built, &stand, kg, (enough, stiffness), by)?, stand))) {
                Some((state, stand)) => {
                    self.loads.push(state);
                    self.other = if own { self.other } else { Some(stand) };
                }
                None => self.not_carried += 1.0 / LOADS.len() as f64,
            }
        }
        self
    }
}

impl LoadState {
    /// Whether all of it is far from its limits with a reserve: by a quarter of them.
    fn is_far(&self, limits: &StandingLimits, length_m: f64, more: f64) -> bool {
        let far = FAR * more;
        self.load_factor >= limits.load_factor * more
            && self.stiffness_n_per_m >= far * limits.stiffness_n_per_m
            && far * self.sag_m <= limits.sag_share * length_m
            && far * self.buckling_ratio * limits.buckling_margin <= 1.0
            && self.least_bend_rad_per_m > 1.0
    }
}

/// The load factor, or `enough` where it is at least that: one step there is much cheaper than the way to where the limb falls.
fn load_factor(rod: &Rod, shape: &Shape, enough: f64) -> f64 {
    if enough <= 0.0 {
        return f64::INFINITY;
    }
    let reached = solve(&rod.grown(enough), Bends::Linear, Some(&shape.q)).is_ok_and(|found| found.steps == 1);
    if reached { enough } else { shape.load_factor(rod, Bends::Linear) }
}

/// The state of a stand, with the stiffening and the further sag of tubes, m; its stiffness may be known.
fn load_state(
    built: &Built,
    stand: &Stand,
    kg: f64,
    (enough, stiffness): (f64, Option<f64>),
    (stiffening, more_m): (f64, f64),
) -> Option<LoadState> {
    let (limb, rod, shape) = (&stand.limb, &stand.rod, &stand.shape);
    let compliance = || shape.compliance_along_m_per_n(rod, Bends::Linear, 2);
    let stiffness_n_per_m = stiffness.or_else(|| Some((1.0 + stiffening) / compliance()?))?;
    let bends = rod.pieces.iter().zip(shape.q.as_slice().chunks(UNKNOWNS)).enumerate();
    let bends = bends.filter(|(index, _)| built.is_bending(*index));
    let least = bends.map(|(_, (piece, q))| piece.free[1] + q[2] - q[3].abs()).fold(f64::INFINITY, f64::min);
    Some(LoadState {
        payload_kg: kg,
        load_factor: load_factor(rod, shape, enough),
        stiffness_n_per_m,
        sag_m: (stand.tip_m() - limb.free_tip().translation.vector).norm() + more_m,
        buckling_ratio: limb.buckling(rod, shape).map_or(0.0, |tube| tube.ratio()),
        least_bend_rad_per_m: least,
    })
}
