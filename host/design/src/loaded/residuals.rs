//! What the margins of a pose lack, as residuals that are zero or less where the margins are kept.

use nalgebra::Vector3;
use serde::Serialize;

use super::built::Built;
use super::evaluate::Judgement;
use super::limits::Margin;
use super::pose::{LOADS, PoseState};
use super::task::LoadedTask;
use crate::synthesis::Aim;

/// Distance of the tip, m, and angle, rad, that count as one.
const REACH_M: f64 = 0.01;
const ANGLE_RAD: f64 = 0.1;
/// Clearance that counts as one, m.
const CLEARANCE_M: f64 = 0.02;
/// Share of a limit that counts as one.
const SHARE: f64 = 0.25;
/// Excess of a pressure over the highest that keeps its margin, as a share of it, that counts as one.
const PRESSURE: f64 = 0.05;
/// By how much less than the largest mass is sought, as a share of it.
const LIGHTER: f64 = 2e-3;
/// What a load that is not carried counts.
const FALLS: f64 = 10.0;
/// Backward bend that counts as one, rad/m.
const BEND_RAD_PER_M: f64 = 1.0;

/// What one margin lacks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Lack {
    /// The margin.
    pub margin: Margin,
    /// Index of the pose.
    pub pose: usize,
    /// What is lacking; 0 where nothing is.
    pub value: f64,
}

/// What a margin that is far from its limit has to spare, in its own unit.
const FAR: f64 = 1.0;

/// A residual of a margin: positive where the margin is missed. A one-sided residual is negative where there is something to spare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Residual {
    margin: Margin,
    pose: usize,
    pub(super) value: f64,
    /// Whether it counts above zero alone.
    pub(super) one_sided: bool,
}

impl Residual {
    /// Whether it goes in steps: the way to where a limb falls is followed in such.
    pub(super) fn is_stepped(&self) -> bool {
        self.margin == Margin::LoadFactor && self.value > -FAR
    }

    /// What is lacking.
    pub(super) fn lack(&self) -> Lack {
        let Self { margin, pose, value, one_sided } = *self;
        Lack { margin, pose, value: if one_sided { value.max(0.0) } else { value } }
    }
}

/// Residuals of a pose, as many for every limb.
pub(super) fn of_pose(
    task: &LoadedTask,
    built: &Built,
    pose: usize,
    state: &PoseState,
    by: &Judgement,
) -> Vec<Residual> {
    let reserve = by.reserve;
    let limits = &task.limits;
    let more = 1.0 + reserve;
    let mut lacks = Vec::new();
    let reach = |value, one_sided| Residual { margin: Margin::Reach, pose, value: value / REACH_M, one_sided };
    match by.aim(task, pose) {
        Aim::Point(_) => lacks.extend(state.missing_m.iter().map(|missing_m| reach(*missing_m, false))),
        // Within a region the tip has room.
        Aim::Inside { center_m, half_m, rotation } => {
            let own = rotation.inverse_transform_vector(&(Vector3::from(state.tip_m) - center_m));
            lacks.extend((0..3).map(|axis| reach(own[axis].abs() - half_m[axis], true)));
        }
    }
    if task.poses[pose].hold_kg != task.poses[pose].move_kg {
        lacks.extend(state.held.missing_m.iter().map(|missing_m| reach(*missing_m, false)));
    }
    let mut push = |margin, value| lacks.push(Residual { margin, pose, value, one_sided: true });
    // A mass is sought a little below its limit, and needs no reserve.
    if let Some(most) = task.mass_max_kg.filter(|_| pose == 0) {
        push(Margin::Mass, (built.mass_kg() / ((1.0 - LIGHTER) * most) - 1.0) / SHARE);
    }
    push(Margin::Direction, state.turned_rad / ANGLE_RAD);
    if let Some(body) = task.poses[pose].carried {
        push(Margin::Tilt, (state.tilt_rad + by.shift(pose).tilt_rad - body.tilt_max_rad / more) / ANGLE_RAD);
    }
    state.shares.iter().for_each(|share| push(Margin::Pressure, (share - 1.0) / PRESSURE));
    push(Margin::Carries, if state.not_carried > 0.0 { FALLS * state.not_carried } else { -FAR });
    let states = if task.poses[pose].payload_kg() > 0.0 { LOADS.len() } else { 1 };
    for index in 0..states {
        // A load that is not carried has no margins: it counts above.
        let Some(load) = state.loads.get(index) else {
            for margin in [Margin::LoadFactor, Margin::Stiffness, Margin::Sag, Margin::Buckling, Margin::BentBack] {
                push(margin, 1.0 / SHARE);
            }
            continue;
        };
        let below = |value: f64, least: f64| (1.0 - value / least) / SHARE;
        let above = |value: f64, most: f64| (value / most - 1.0) / SHARE;
        // It is followed no farther than to where it is enough.
        let enough = limits.load_factor * more;
        push(Margin::LoadFactor, if load.load_factor < enough { below(load.load_factor, enough) } else { -FAR });
        push(Margin::Stiffness, below(load.stiffness_n_per_m, limits.stiffness_n_per_m * more));
        push(Margin::Sag, above(load.sag_m / built.length_m, limits.sag_share / more));
        push(Margin::Buckling, above(load.buckling_ratio, 1.0 / (limits.buckling_margin * more)));
        push(Margin::BentBack, -load.least_bend_rad_per_m / BEND_RAD_PER_M);
    }
    for (obstacle, spare_m) in task.obstacles.iter().zip(&state.spares_m) {
        push(Margin::Clearance, (reserve * obstacle.clearance_m - spare_m) / CLEARANCE_M);
    }
    lacks
}
