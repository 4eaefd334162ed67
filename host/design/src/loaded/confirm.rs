//! The limb found, judged once more by the finest model that a tolerance needs, each pose followed from rest.

use serde::Serialize;

use super::built::Built;
use super::inverse::{Stand, nearest, reach};
use super::limits::{Margin, StandingLimits};
use super::search::Found;
use super::space::LimbSpace;
use super::task::LoadedTask;
use crate::synthesis::Aim;
use softlimb_limb::statics::Standing;

/// The tip counts as at its aim within this, m.
pub const REACHED_M: f64 = 1e-4;
/// Corrections of the aim by the tip offset of the finer model.
const CORRECTIONS: usize = 6;
/// Shares of a payload that a pose is judged with.
const LOADS: [f64; 3] = [0.0, 0.5, 1.0];

/// A pose under load as the finest model has it: the worst of no, half and all payload.
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
    /// The model.
    pub model: &'static str,
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

/// Judges the limb of a search by the cheapest model whose error is at most `tolerance`, a share of its length.
pub fn confirm(task: &LoadedTask, space: &LimbSpace, found: &Found, tolerance: f64) -> Vec<ConfirmedPose> {
    let Some(built) = Built::new(task, space, &found.evaluation.sizes, 0.0) else { return Vec::new() };
    (0..task.poses.len()).map(|index| confirm_pose(task, &built, found, index, tolerance)).collect()
}

fn confirm_pose(task: &LoadedTask, built: &Built, found: &Found, index: usize, tolerance: f64) -> ConfirmedPose {
    let (pose, state) = (&task.poses[index], &found.evaluation.poses[index]);
    let (length_m, home) = (built.length_m, &found.evaluation.sizes.home);
    let stand_at =
        |shares: &[f64], kg: f64| -> Option<Standing> { built.loaded(shares, kg)?.stand(tolerance, length_m).ok() };
    // By rods under the load of the move, then with the aim moved by the tip offset of the finer model.
    let place = nearest(&pose.aim, &state.tip_m.into());
    let corrected = |start: &Stand, kg: f64| {
        let (mut here, mut aim_m) = (start.clone(), place);
        let mut best: Option<(f64, Stand, Standing)> = None;
        for _ in 0..CORRECTIONS {
            let Ok((next, _)) = reach(built, &here, home, kg, &Aim::Point(aim_m)) else { break };
            here = next;
            let Some(fine) = stand_at(&here.shares, kg) else { break };
            let off = place - nalgebra::Vector3::from(fine.tip_m);
            aim_m += off;
            let error_m = off.norm();
            if best.as_ref().is_none_or(|(least, ..)| error_m < *least) {
                best = Some((error_m, here.clone(), fine));
            }
            if error_m <= 0.1 * REACHED_M {
                break;
            }
        }
        best
    };
    let moved = corrected(&state.stand, pose.move_kg);
    let held = if pose.hold_kg == pose.move_kg { moved.clone() } else { corrected(&state.stand, pose.hold_kg) };
    let payload_kg = pose.payload_kg();
    let mut answer = ConfirmedPose {
        name: pose.name.clone(),
        payload_kg,
        pressures_pa: state.pressures_pa.clone(),
        tip_error_m: f64::INFINITY,
        tip_m: state.tip_m,
        model: "none",
        load_factor: 0.0,
        stiffness_n_per_m: 0.0,
        sag_m: f64::INFINITY,
        buckling_margin: 0.0,
        pressure_share: 0.0,
        tilt_rad: state.tilt_rad,
        spare_m: state.spare_m.map(|(spare, _)| spare),
        lacks: Vec::new(),
    };
    if let (Some((moved_error, moved, fine)), Some((held_error, held, _))) = (&moved, &held) {
        answer.tip_error_m = moved_error.max(*held_error);
        answer.tip_m = fine.tip_m;
        answer.model = fine.answer.tier.name();
        answer.pressures_pa = built.pressures_pa(&moved.shares);
        let highest = moved.shares.iter().chain(&held.shares).copied().fold(0.0, f64::max);
        answer.pressure_share = task.limits.pressure_share * highest;
        let loads: &[f64] = if payload_kg > 0.0 { &LOADS } else { &[0.0] };
        let states: Vec<Option<Standing>> =
            loads.iter().map(|share| stand_at(&held.shares, share * payload_kg)).collect();
        if states.iter().all(Option::is_some) {
            let states: Vec<&Standing> = states.iter().flatten().collect();
            let least = |of: &dyn Fn(&Standing) -> f64| states.iter().map(|s| of(s)).fold(f64::INFINITY, f64::min);
            answer.load_factor = least(&|state| state.load_factor);
            answer.stiffness_n_per_m = least(&|state| state.stiffness_n_per_m.map_or(0.0, |axes| axes[2]));
            answer.buckling_margin = least(&|state| state.buckling_margin);
            answer.sag_m = -least(&|state| -state.sag_m);
        }
    }
    answer.lacks = lacks(&task.limits, &answer, length_m);
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
