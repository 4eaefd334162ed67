//! One pose of a limb: its pressures under load, and what its margins are.

use nalgebra::Vector3;

use super::built::Built;
use super::clearance::{nearer, spare_m};
use super::inverse::{Reached, Stand, reach};
use super::task::{LoadedPose, LoadedTask};
use crate::synthesis::Aim;
use softlimb_limb::statics::{Bends, Rod, Shape, UNKNOWNS, solve};

/// Shares of a payload that a pose is judged with; the limb found is judged with half of it, too.
pub(super) const LOADS: [f64; 2] = [0.0, 1.0];
/// A tip that is off by more than this in the pose of a limb of nearly the same sizes is sought step by step, too, m.
const WARM_M: f64 = 1e-3;
/// A pose under a share of its payload, at the pressures that hold all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadState {
    /// Payload, kg.
    pub payload_kg: f64,
    /// Load factor, up to that which is enough with the reserve.
    pub load_factor: f64,
    /// Vertical stiffness of the tip, N/m.
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
    /// Pressures that hold it, Pa, one a module.
    pub pressures_pa: Vec<f64>,
    /// The same over the highest that keep the margin.
    pub shares: Vec<f64>,
    /// The tip, m: that of rods with its shift.
    pub tip_m: [f64; 3],
    /// What is missing to the aim, m.
    pub missing_m: Vector3<f64>,
    /// Angle between the end effector and the direction that it shall have, beyond the tolerance, rad.
    pub turned_rad: f64,
    /// Turn of the end effector since it grasped the carried body, rad; 0 without one. The body hangs upright: its grip lets it swing by this.
    pub swing_rad: f64,
    /// The states without and with all of the payload; fewer where the limb does not carry it.
    pub loads: Vec<LoadState>,
    /// Share of the load that is not carried; 0 where all is.
    pub not_carried: f64,
    /// Least clearance beyond the one asked for, in the pose and on the way to it, m, and the obstacle.
    pub spare_m: Option<(f64, usize)>,
    pub(super) moved: Reached,
    pub(super) held: Reached,
    unloaded: Option<Stand>,
    /// Stands on the way to it.
    pub(super) way: Vec<Option<Stand>>,
}

/// A pose and how it is judged.
pub(super) struct Sought<'a> {
    pub(super) task: &'a LoadedTask,
    pub(super) pose: &'a LoadedPose,
    pub(super) home: &'a [f64],
    pub(super) reserve: f64,
    /// From the tip of rods to that of tubes, as the pose is reached and as it is held, m.
    pub(super) shift_m: [Vector3<f64>; 2],
}

/// Where a pose is sought from.
pub(super) enum Start<'a> {
    /// A stand of the same limb in another pose.
    Cold(&'a Stand),
    /// The same pose of a limb of nearly the same sizes; of one just beside it, the Jacobians serve, too.
    Warm { near: &'a PoseState, beside: bool },
}

/// An aim elsewhere, by a way in m.
fn moved_aim(aim: &Aim, by_m: &Vector3<f64>) -> Aim {
    match aim {
        Aim::Point(place_m) => Aim::Point(place_m + by_m),
        Aim::Inside { center_m, half_m, rotation } => {
            Aim::Inside { center_m: center_m + by_m, half_m: *half_m, rotation: *rotation }
        }
    }
}

/// The limb as its pose is reached.
fn moved(built: &Built, sought: &Sought<'_>, start: &Start<'_>) -> Option<Reached> {
    let aim = moved_aim(&sought.pose.aim, &-sought.shift_m[0]);
    let (stand, jacobian) = match start {
        Start::Cold(stand) => (*stand, None),
        Start::Warm { near, beside } => (&near.moved.stand, near.moved.jacobian.as_ref().filter(|_| *beside)),
    };
    reach(built, stand, (sought.home, sought.pose.move_kg), &aim, jacobian).ok()
}

/// The limb as its pose is held, with the tip where it was moved to, and the share of the load that is not carried.
fn held(built: &Built, sought: &Sought<'_>, start: &Start<'_>, moved: &Reached) -> (Reached, f64) {
    let Sought { pose, home, shift_m, .. } = sought;
    if pose.hold_kg == pose.move_kg {
        return (moved.clone(), 0.0);
    }
    let aim = Aim::Point(moved.stand.tip_m() + shift_m[0] - shift_m[1]);
    if let Start::Warm { near, beside } = start {
        let jacobian = near.held.jacobian.as_ref().filter(|_| *beside);
        if let Ok(held) = reach(built, &near.held.stand, (home, pose.hold_kg), &aim, jacobian)
            && held.missing_m.norm() <= WARM_M
        {
            return (held, 0.0);
        }
    }
    // The mass changes hands step by step, and the tip stays.
    let (mut held, mut not_carried) = (moved.clone(), 0.0);
    for part in [0.5, 1.0] {
        let kg = pose.move_kg + part * (pose.hold_kg - pose.move_kg);
        match reach(built, &held.stand, (home, kg), &aim, None) {
            Ok(next) => held = next,
            Err(_) => not_carried += 0.5,
        }
    }
    (held, not_carried)
}

/// The pose of a limb from a start; `None` where it does not stand.
pub(super) fn pose_state(built: &Built, sought: &Sought<'_>, start: &Start<'_>) -> Option<PoseState> {
    let Sought { task, pose, reserve, .. } = *sought;
    let moved = moved(built, sought, start)?;
    let (held, mut not_carried) = held(built, sought, start, &moved);
    let clear = |stand: &Stand, shift_m| spare_m(built, task, stand, pose.carried.as_ref(), shift_m);
    let spare_m = nearer(clear(&moved.stand, &sought.shift_m[0]), clear(&held.stand, &sought.shift_m[1]));
    let mut loads = Vec::with_capacity(LOADS.len());
    let mut unloaded = None;
    let payload_kg = pose.payload_kg();
    let enough = task.limits.load_factor * (1.0 + reserve);
    for share in LOADS.iter().skip(if payload_kg > 0.0 { 0 } else { LOADS.len() - 1 }) {
        let kg = share * payload_kg;
        let near = match start {
            Start::Warm { near, .. } => near.unloaded.as_ref().filter(|_| *share == 0.0),
            Start::Cold(_) => None,
        };
        let stand = if kg == pose.hold_kg {
            Ok(held.stand.clone())
        } else {
            Stand::at(built, &held.stand.shares, kg, Some(near.unwrap_or(&held.stand)))
        };
        match stand.ok().and_then(|stand| Some((load_state(built, &stand, kg, enough)?, stand))) {
            Some((state, stand)) => {
                loads.push(state);
                unloaded = unloaded.or((*share == 0.0).then_some(stand));
            }
            None => not_carried += 1.0 / LOADS.len() as f64,
        }
    }
    let axis = moved.stand.shape.tip().rotation * Vector3::z();
    let turned_rad =
        pose.direction.map_or(0.0, |direction| (axis.angle(&direction.axis) - direction.tolerance_rad).max(0.0));
    Some(PoseState {
        pressures_pa: built.pressures_pa(&held.stand.shares),
        shares: moved.stand.shares.iter().zip(&held.stand.shares).map(|(a, b)| a.max(*b)).collect(),
        tip_m: (moved.stand.tip_m() + sought.shift_m[0]).into(),
        missing_m: moved.missing_m,
        turned_rad,
        swing_rad: 0.0,
        loads,
        not_carried,
        spare_m,
        moved,
        held,
        unloaded,
        way: Vec::new(),
    })
}

/// The load factor, or `enough` where it is at least that: one step there is much cheaper than the way to where the limb falls.
fn load_factor(rod: &Rod, shape: &Shape, enough: f64) -> f64 {
    let reached = solve(&rod.grown(enough), Bends::Linear, Some(&shape.q)).is_ok_and(|found| found.steps == 1);
    if reached { enough } else { shape.load_factor(rod, Bends::Linear) }
}

fn load_state(built: &Built, stand: &Stand, kg: f64, enough: f64) -> Option<LoadState> {
    let (limb, rod, shape) = (&stand.limb, &stand.rod, &stand.shape);
    let compliance = shape.compliance_m_per_n(rod, Bends::Linear)?[(2, 2)];
    let bends = rod.pieces.iter().zip(shape.q.as_slice().chunks(UNKNOWNS)).enumerate();
    let bends = bends.filter(|(index, _)| built.is_bending(*index));
    let least = bends.map(|(_, (piece, q))| piece.free[1] + q[2] - q[3].abs()).fold(f64::INFINITY, f64::min);
    Some(LoadState {
        payload_kg: kg,
        load_factor: load_factor(rod, shape, enough),
        stiffness_n_per_m: 1.0 / compliance,
        sag_m: (stand.tip_m() - limb.free_tip().translation.vector).norm(),
        buckling_ratio: limb.buckling(rod, shape).map_or(0.0, |tube| tube.ratio()),
        least_bend_rad_per_m: least,
    })
}
