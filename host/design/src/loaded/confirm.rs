//! The limb found, judged once more by the finest statics, tubes between plates, each pose followed from rest.

use nalgebra::Vector3;
use serde::Serialize;

use super::built::Built;
use super::inverse::{Reached, Stand, nearest, reach};
use super::limits::{Margin, StandingLimits};
use super::plates::by_plates;
use super::search::Found;
use super::space::LimbSpace;
use super::task::LoadedTask;
use crate::synthesis::Aim;
use softlimb_limb::statics::{Answer, BUCKLING_MARGIN_MAX, LoadedLimb};

/// The tip counts as at its aim within this, m.
pub const REACHED_M: f64 = 1e-4;
/// Corrections of the aim by the tip offset of the tubes.
const CORRECTIONS: usize = 6;
/// Shares of a payload that a pose is judged with.
const LOADS: [f64; 3] = [0.0, 0.5, 1.0];

/// A pose under load by tubes between plates: the worst of no, half and all payload.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConfirmedPose {
    /// Name of the phase.
    pub name: String,
    /// Largest payload, kg.
    pub payload_kg: f64,
    /// Pressures that bring the tip to its aim under the load of the move, Pa, one a module.
    pub pressures_pa: Vec<f64>,
    /// Distance of the tip from the aim, m.
    pub tip_error_m: f64,
    /// The tip, m.
    pub tip_m: [f64; 3],
    /// Load factor.
    pub load_factor: f64,
    /// Vertical stiffness of the tip, N/m.
    pub stiffness_n_per_m: f64,
    /// Largest sag, m.
    pub sag_m: f64,
    /// Buckling margin.
    pub buckling_margin: f64,
    /// Highest pressure over the lower of limit and limit point.
    pub pressure_share: f64,
    /// Angle of the end effector from pointing straight down, rad.
    pub tilt_rad: f64,
    /// Clearance beyond the one asked for, here and on the straight way to it, m; `None` without obstacles.
    pub spare_m: Option<f64>,
    /// Margins that are not kept.
    pub lacks: Vec<Margin>,
}

/// Judges the limb of a search by tubes between plates, pose by pose, each followed from rest.
pub fn confirm(task: &LoadedTask, space: &LimbSpace, found: &Found) -> Vec<ConfirmedPose> {
    let Some(built) = Built::new(task, space, &found.evaluation.sizes, 0.0) else { return Vec::new() };
    (0..task.poses.len()).map(|index| confirm_pose(task, &built, found, index)).collect()
}

/// Pressures with which tubes between plates have their tip at a place.
struct Corrected {
    stand: Stand,
    error_m: f64,
    tip_m: Vector3<f64>,
}

/// By rods, with the aim moved by the tip offset of the tubes until these are at the place.
fn corrected(
    built: &Built,
    start: &Stand,
    (home, kg): (&[f64], f64),
    (place_m, shift_m): (&Vector3<f64>, &Vector3<f64>),
) -> Option<Corrected> {
    let (mut here, mut aim_m, mut jacobian) = (start.clone(), place_m - shift_m, None);
    let mut best: Option<Corrected> = None;
    for _ in 0..CORRECTIONS {
        let Ok(next) = reach(built, &here, (home, kg), &Aim::Point(aim_m), jacobian.as_ref()) else { break };
        (here, jacobian) = (next.stand, next.jacobian);
        let Some((_, fine)) = by_plates(built, &here.shares, kg) else { break };
        let tip_m = fine.tip().translation.vector;
        let off = place_m - tip_m;
        aim_m += off;
        let error_m = off.norm();
        if best.as_ref().is_none_or(|best| error_m < best.error_m) {
            best = Some(Corrected { stand: here.clone(), error_m, tip_m });
        }
        if error_m <= 0.1 * REACHED_M {
            break;
        }
    }
    best
}

fn confirm_pose(task: &LoadedTask, built: &Built, found: &Found, index: usize) -> ConfirmedPose {
    let (pose, state) = (&task.poses[index], &found.evaluation.poses[index]);
    let home = found.evaluation.sizes.home.as_slice();
    let shifts_m = found.by.shifts_m.get(index).copied().unwrap_or_default();
    let place_m = nearest(&pose.aim, &state.tip_m.into());
    // Shares of a design are of pressures that keep its reserve, too.
    let start = |reached: &Reached| {
        let shares: Vec<f64> =
            reached.stand.shares.iter().map(|share| (share / (1.0 + found.by.reserve)).clamp(0.0, 1.0)).collect();
        Stand { shares, ..reached.stand.clone() }
    };
    let moved = corrected(built, &start(&state.moved), (home, pose.move_kg), (&place_m, &shifts_m[0]));
    let held = corrected(built, &start(&state.held), (home, pose.hold_kg), (&place_m, &shifts_m[1]));
    let payload_kg = pose.payload_kg();
    let mut answer = ConfirmedPose {
        name: pose.name.clone(),
        payload_kg,
        pressures_pa: state.pressures_pa.clone(),
        tip_error_m: f64::INFINITY,
        tip_m: state.tip_m,
        load_factor: 0.0,
        stiffness_n_per_m: 0.0,
        sag_m: f64::INFINITY,
        buckling_margin: 0.0,
        pressure_share: 0.0,
        tilt_rad: state.tilt_rad,
        spare_m: state.spare_m.map(|(spare, _)| spare),
        lacks: Vec::new(),
    };
    if let (Some(moved), Some(held)) = (&moved, &held) {
        answer.tip_error_m = moved.error_m.max(held.error_m);
        answer.tip_m = moved.tip_m.into();
        answer.pressures_pa = built.pressures_pa(&moved.stand.shares);
        let highest = moved.stand.shares.iter().chain(&held.stand.shares).copied().fold(0.0, f64::max);
        answer.pressure_share = task.limits.pressure_share * highest;
        let loads: &[f64] = if payload_kg > 0.0 { &LOADS } else { &[0.0] };
        let states = loads.iter().map(|share| by_plates(built, &held.stand.shares, share * payload_kg));
        if let Some(states) = states.collect::<Option<Vec<_>>>() {
            let least = |of: &dyn Fn(&(LoadedLimb, Answer)) -> f64| states.iter().map(of).fold(f64::INFINITY, f64::min);
            answer.load_factor = least(&|(_, tubes)| tubes.load_factor());
            answer.stiffness_n_per_m = least(&|(_, tubes)| tubes.compliance_m_per_n().map_or(0.0, |by| 1.0 / by[(2, 2)]));
            answer.buckling_margin =
                least(&|(_, tubes)| 1.0 / tubes.buckling.map_or(0.0, |tube| tube.ratio())).min(BUCKLING_MARGIN_MAX);
            answer.sag_m = -least(&|(limb, tubes)| {
                -(tubes.tip().translation.vector - limb.free_tip().translation.vector).norm()
            });
        }
    }
    answer.lacks = lacks(&task.limits, &answer, built.length_m);
    if state.turned_rad > 1e-3 {
        answer.lacks.push(Margin::Direction);
    }
    answer
}

/// Margins that a pose does not keep.
fn lacks(limits: &StandingLimits, pose: &ConfirmedPose, length_m: f64) -> Vec<Margin> {
    [
        (Margin::Reach, pose.tip_error_m <= REACHED_M),
        (Margin::LoadFactor, pose.load_factor >= limits.load_factor),
        (Margin::Stiffness, pose.stiffness_n_per_m >= limits.stiffness_n_per_m),
        (Margin::Sag, pose.sag_m <= limits.sag_share * length_m),
        (Margin::Buckling, pose.buckling_margin >= limits.buckling_margin),
        (Margin::Pressure, pose.pressure_share <= limits.pressure_share * (1.0 + 1e-9)),
        (Margin::Clearance, pose.spare_m.is_none_or(|spare| spare >= 0.0)),
    ]
    .into_iter()
    .filter_map(|(margin, kept)| (!kept).then_some(margin))
    .collect()
}
