//! What the margins of a pose lack, as residuals that are zero where the margins are kept.

use serde::Serialize;

use super::built::Built;
use super::evaluate::Judgement;
use super::limits::Margin;
use super::pose::{LOADS, PoseState};
use super::task::LoadedTask;

/// Distance of the tip, m, and angle, rad, that count as one.
const REACH_M: f64 = 0.01;
const ANGLE_RAD: f64 = 0.1;
/// Clearance that counts as one, m.
const CLEARANCE_M: f64 = 0.02;
/// Share of a limit that counts as one.
const SHARE: f64 = 0.25;
/// Excess of a pressure over the highest that keeps its margin, as a share of it, that counts as one.
const PRESSURE: f64 = 0.05;
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

/// Residuals of a pose, as many for every limb.
pub(super) fn of_pose(task: &LoadedTask, built: &Built, pose: usize, state: &PoseState, by: &Judgement) -> Vec<Lack> {
    let reserve = by.reserve;
    let limits = &task.limits;
    let more = 1.0 + reserve;
    let mut lacks = Vec::new();
    let mut push = |margin, value| lacks.push(Lack { margin, pose, value });
    state.missing_m.iter().for_each(|missing| push(Margin::Reach, missing / REACH_M));
    if task.poses[pose].hold_kg != task.poses[pose].move_kg {
        state.held.missing_m.iter().for_each(|missing| push(Margin::Reach, missing / REACH_M));
    }
    push(Margin::Direction, state.turned_rad / ANGLE_RAD);
    if let Some(body) = task.poses[pose].carried {
        push(Margin::Tilt, (state.tilt_rad + by.shift(pose).tilt_rad - body.tilt_max_rad / more).max(0.0) / ANGLE_RAD);
    }
    state.shares.iter().for_each(|share| push(Margin::Pressure, (share - 1.0).max(0.0) / PRESSURE));
    push(Margin::Carries, FALLS * state.not_carried);
    let states = if task.poses[pose].payload_kg() > 0.0 { LOADS.len() } else { 1 };
    for index in 0..states {
        // A load that is not carried has no margins: it counts above.
        let Some(load) = state.loads.get(index) else {
            for margin in [Margin::LoadFactor, Margin::Stiffness, Margin::Sag, Margin::Buckling, Margin::BentBack] {
                push(margin, 1.0 / SHARE);
            }
            continue;
        };
        let below = |value: f64, least: f64| (1.0 - value / least).max(0.0) / SHARE;
        let above = |value: f64, most: f64| (value / most - 1.0).max(0.0) / SHARE;
        push(Margin::LoadFactor, below(load.load_factor, limits.load_factor * more));
        push(Margin::Stiffness, below(load.stiffness_n_per_m, limits.stiffness_n_per_m * more));
        push(Margin::Sag, above(load.sag_m / built.length_m, limits.sag_share / more));
        push(Margin::Buckling, above(load.buckling_ratio, 1.0 / (limits.buckling_margin * more)));
        push(Margin::BentBack, (-load.least_bend_rad_per_m / BEND_RAD_PER_M).max(0.0));
    }
    let clearance = state.spare_m.map_or(0.0, |(spare, obstacle)| {
        let reserve_m = reserve * task.obstacles[obstacle].clearance_m;
        ((reserve_m - spare) / CLEARANCE_M).max(0.0)
    });
    push(Margin::Clearance, clearance);
    lacks
}
