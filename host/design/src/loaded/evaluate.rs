//! One limb judged: its poses under load, and what every margin lacks.

use nalgebra::{UnitQuaternion, Vector3};

use super::built::Built;
use super::clearance::spare_m;
use super::inverse::{Reached, Stand, reach};
use super::moves::moves;
use super::residuals::{Lack, of_pose};
use super::space::{LimbSizes, LimbSpace};
use super::task::{LoadedPose, LoadedTask};
use crate::synthesis::Aim;
use softlimb_limb::statics::{Bends, Rod, Shape, UNKNOWNS, solve};

/// Shares of a payload that a pose is judged with; the limb found is judged with half of it, too.
pub(super) const LOADS: [f64; 2] = [0.0, 1.0];
/// A tip that is off by more than this in the pose of a limb of nearly the same sizes is sought step by step, too, m.
const WARM_M: f64 = 1e-3;
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

/// The less of two clearances.
pub(super) fn nearer(one: Option<(f64, usize)>, other: Option<(f64, usize)>) -> Option<(f64, usize)> {
    [one, other].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
}

impl Evaluation {
    /// Sum of the squares of what is lacking.
    pub fn objective(&self) -> f64 {
        self.lacks.iter().map(|lack| lack.value * lack.value).sum()
    }
}

/// What limbs are judged by beyond their task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Share by which every margin shall be better than its limit.
    pub reserve: f64,
    /// Way from the tip of rods to that of tubes between plates in each pose, m: as it is reached and as it is held. Zero where there is none.
    pub shifts_m: Vec<[Vector3<f64>; 2]>,
}

impl Judgement {
    pub(super) fn shift_m(&self, pose: usize) -> [Vector3<f64>; 2] {
        self.shifts_m.get(pose).copied().unwrap_or_default()
    }
}

/// Judges a limb of sizes. `warm` is a limb of nearly the same sizes to start from.
///
/// `None` where an actuator cannot be modelled or the limb does not stand in the first pose.
pub fn evaluate(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    by: &Judgement,
    warm: Option<&Evaluation>,
) -> Option<Evaluation> {
    judge(task, space, sizes, by, warm.map(|warm| (warm, false)))
}

/// The same for a derivative, from the limb that it is the derivative at: its Jacobians of the tip are used, too.
pub(super) fn evaluate_beside(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    by: &Judgement,
    at: &Evaluation,
) -> Option<Evaluation> {
    judge(task, space, sizes, by, Some((at, true)))
}

fn judge(
    task: &LoadedTask,
    space: &LimbSpace,
    sizes: &LimbSizes,
    by: &Judgement,
    warm: Option<(&Evaluation, bool)>,
) -> Option<Evaluation> {
    let built = Built::new(task, space, sizes, by.reserve)?;
    let mut poses: Vec<PoseState> = Vec::with_capacity(task.poses.len());
    for (index, pose) in task.poses.iter().enumerate() {
        let near = warm.and_then(|(warm, beside)| Some((warm.poses.get(index)?, beside)));
        let sought = Sought { task, pose, home: &sizes.home, reserve: by.reserve, shift_m: by.shift_m(index) };
        let own = near.and_then(|(near, beside)| pose_state(&built, &sought, &Start::Warm { near, beside }));
        let after = || pose_state(&built, &sought, &Start::Cold(&poses.last()?.held.stand));
        let anew = || pose_state(&built, &sought, &Start::Cold(&first(&built, sizes, pose.move_kg)?));
        let found = own.or_else(after).or_else(anew)?;
        poses.push(found);
    }
    swing(task, &mut poses);
    if !task.obstacles.is_empty() && task.moves {
        moves(&built, task, by, &mut poses, warm.map(|(warm, _)| warm));
    }
    let lacks =
        poses.iter().enumerate().flat_map(|(index, state)| of_pose(task, &built, index, state, by.reserve)).collect();
    Some(Evaluation { sizes: sizes.clone(), lacks, poses, mass_kg: built.mass_kg(), length_m: built.length_m })
}

/// Turns of the end effector since the pose before a body is carried.
fn swing(task: &LoadedTask, poses: &mut [PoseState]) {
    let mut grasped: Option<UnitQuaternion<f64>> = None;
    for (pose, state) in task.poses.iter().zip(poses) {
        let turn = state.moved.stand.shape.tip().rotation;
        match (pose.carried, grasped) {
            (Some(_), Some(grasp)) => state.swing_rad = (turn * grasp.inverse() * Vector3::z()).angle(&Vector3::z()),
            _ => grasped = Some(turn),
        }
    }
}

/// A pose and how it is judged.
struct Sought<'a> {
    task: &'a LoadedTask,
    pose: &'a LoadedPose,
    home: &'a [f64],
    reserve: f64,
    /// From the tip of rods to that of tubes, as the pose is reached and as it is held, m.
    shift_m: [Vector3<f64>; 2],
}

/// Where a pose is sought from.
enum Start<'a> {
    /// A stand of the same limb in another pose.
    Cold(&'a Stand),
    /// The same pose of a limb of nearly the same sizes; of one just beside it, the Jacobians serve, too.
    Warm { near: &'a PoseState, beside: bool },
}

fn first(built: &Built, sizes: &LimbSizes, kg: f64) -> Option<Stand> {
    let home = Stand::at(built, &sizes.home, kg, None).ok();
    home.or_else(|| FIRST.iter().find_map(|share| Stand::at(built, &vec![*share; built.len()], kg, None).ok()))
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

fn pose_state(built: &Built, sought: &Sought<'_>, start: &Start<'_>) -> Option<PoseState> {
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
