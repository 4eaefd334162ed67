//! One limb judged: its poses under load, and what every margin lacks.

use nalgebra::Vector3;

use super::built::Built;
use super::clearance::spare_m;
use super::inverse::{Stand, reach};
use super::residuals::{Lack, of_pose};
use super::space::{LimbSizes, LimbSpace};
use super::task::{LoadedPose, LoadedTask};
use crate::synthesis::Aim;
use softlimb_limb::statics::{Bends, Rod, Shape, UNKNOWNS, solve};

/// Shares of a payload that a pose is judged with; the limb found is judged with half of it, too.
pub(super) const LOADS: [f64; 2] = [0.0, 1.0];
/// Shares of the way between two poses that are looked at.
const WAY: [f64; 3] = [0.25, 0.5, 0.75];
/// Shares of the pressures that the first pose is sought from.
const FIRST: [f64; 2] = [0.1, 0.7];

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
    /// The tip, m.
    pub tip_m: [f64; 3],
    /// What is missing to the aim, m.
    pub missing_m: Vector3<f64>,
    /// Angle between the end effector and the direction that it shall have, beyond the tolerance, rad.
    pub turned_rad: f64,
    /// Angle between the end effector and the vertical, rad.
    pub tilt_rad: f64,
    /// The states without and with all of the payload; fewer where the limb does not carry it.
    pub loads: Vec<LoadState>,
    /// Share of the load that is not carried; 0 where all is.
    pub not_carried: f64,
    /// Least clearance beyond the one asked for, in the pose and on the way to it, m, and the obstacle.
    pub spare_m: Option<(f64, usize)>,
    pub(super) stand: Stand,
}

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

/// Judges a limb of sizes; `reserve` is the share by which every margin shall be better than its limit. `warm` is a limb of nearly the same
/// sizes to start from. `None` where an actuator cannot be modelled or the limb does not stand in the first pose.
pub fn evaluate(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    reserve: f64,
    warm: Option<&Evaluation>,
) -> Option<Evaluation> {
    let built = Built::new(task, space, sizes, reserve)?;
    let mut poses: Vec<PoseState> = Vec::with_capacity(task.poses.len());
    for (index, pose) in task.poses.iter().enumerate() {
        let near = warm.and_then(|warm| warm.poses.get(index)).map(|pose| &pose.stand);
        let start = match (near, poses.last()) {
            (Some(near), _) => near.clone(),
            (None, Some(before)) => before.stand.clone(),
            (None, None) => first(&built, sizes, pose.move_kg)?,
        };
        let found = pose_state(&built, task, pose, &start, (&sizes.home, reserve))
            .or_else(|| pose_state(&built, task, pose, &poses.last()?.stand, (&sizes.home, reserve)))
            .or_else(|| pose_state(&built, task, pose, &first(&built, sizes, pose.move_kg)?, (&sizes.home, reserve)))?;
        poses.push(found);
    }
    if !task.obstacles.is_empty() && task.moves {
        ways(&built, task, &mut poses);
    }
    let lacks =
        poses.iter().enumerate().flat_map(|(index, state)| of_pose(task, &built, index, state, reserve)).collect();
    Some(Evaluation { sizes: sizes.clone(), lacks, poses, mass_kg: built.mass_kg(), length_m: built.length_m })
}

fn first(built: &Built, sizes: &LimbSizes, kg: f64) -> Option<Stand> {
    let home = Stand::at(built, &sizes.home, kg, None).ok();
    home.or_else(|| FIRST.iter().find_map(|share| Stand::at(built, &vec![*share; built.len()], kg, None).ok()))
}

fn pose_state(
    built: &Built,
    task: &LoadedTask,
    pose: &LoadedPose,
    start: &Stand,
    (home, reserve): (&[f64], f64),
) -> Option<PoseState> {
    let (moved, missing_m) = reach(built, start, home, pose.move_kg, &pose.aim).ok()?;
    let mut not_carried = 0.0;
    let held = if pose.hold_kg == pose.move_kg {
        moved.clone()
    } else {
        // The mass changes hands step by step, and the tip stays.
        let aim = Aim::Point(moved.tip_m());
        let mut held = moved.clone();
        for part in [0.5, 1.0] {
            let kg = pose.move_kg + part * (pose.hold_kg - pose.move_kg);
            match reach(built, &held, home, kg, &aim) {
                Ok((next, left)) if left.norm() <= 1e-3 => held = next,
                Ok((next, left)) => {
                    not_carried += left.norm() / built.length_m * 10.0;
                    held = next;
                }
                Err(_) => not_carried += 0.5,
            }
        }
        held
    };
    let spare_m = spare_m(built, task, &moved, pose.carried.as_ref());
    let mut loads = Vec::with_capacity(LOADS.len());
    let payload_kg = pose.payload_kg();
    let enough = task.limits.load_factor * (1.0 + reserve);
    for share in LOADS.iter().skip(if payload_kg > 0.0 { 0 } else { LOADS.len() - 1 }) {
        match load_state(built, &held, share * payload_kg, enough) {
            Some(state) => loads.push(state),
            None => not_carried += 1.0 / LOADS.len() as f64,
        }
    }
    let axis = moved.shape.tip().rotation * Vector3::z();
    let turned_rad =
        pose.direction.map_or(0.0, |direction| (axis.angle(&direction.axis) - direction.tolerance_rad).max(0.0));
    Some(PoseState {
        pressures_pa: built.pressures_pa(&held.shares),
        shares: moved.shares.iter().zip(&held.shares).map(|(a, b)| a.max(*b)).collect(),
        tip_m: moved.tip_m().into(),
        missing_m,
        turned_rad,
        tilt_rad: axis.angle(&-Vector3::z()),
        loads,
        not_carried,
        spare_m,
        stand: held,
    })
}

/// The load factor, or `enough` where it is at least that: one step there is much cheaper than the way to where the limb falls.
fn load_factor(rod: &Rod, shape: &Shape, enough: f64) -> f64 {
    let reached = solve(&rod.grown(enough), Bends::Linear, Some(&shape.q)).is_ok_and(|found| found.steps == 1);
    if reached { enough } else { shape.load_factor(rod, Bends::Linear) }
}

fn load_state(built: &Built, held: &Stand, kg: f64, enough: f64) -> Option<LoadState> {
    let stand = Stand::at(built, &held.shares, kg, Some(held)).ok()?;
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

/// Clearance on straight ways in the pressures, under what is carried on them.
fn ways(built: &Built, task: &LoadedTask, poses: &mut [PoseState]) {
    for index in 0..poses.len() {
        let (kg, carried) = (task.poses[index].move_kg, task.poses[index].carried);
        let to = poses[index].stand.shares.clone();
        let from =
            index.checked_sub(1).map_or_else(|| vec![0.0; to.len()], |before| poses[before].stand.shares.clone());
        let mut last = index.checked_sub(1).map(|before| poses[before].stand.clone());
        for share in WAY {
            let shares: Vec<f64> = from.iter().zip(&to).map(|(a, b)| a + share * (b - a)).collect();
            let Ok(stand) = Stand::at(built, &shares, kg, last.as_ref()) else { continue };
            let found = spare_m(built, task, &stand, carried.as_ref());
            let least = [poses[index].spare_m, found].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
            poses[index].spare_m = least;
            last = Some(stand);
        }
    }
}
