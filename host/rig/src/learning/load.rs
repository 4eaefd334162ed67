//! Tracking under load: a scene without compensation, with the nominal limb's statics, and with learned corrections.
//!
//! The error is the distance of the tip from the goal of the plan without weight, in the last tenth of a second of each phase. All
//! evaluations have the same limb and the same noise. Learning starts from the setpoints by the nominal limb's statics.

use nalgebra::Vector3;

use super::observe::{ends_s, mean, tips_m};
use super::{Distances, LearningError, Settings, iterate, samples};
use crate::run::{Prepared, RunError};
use softlimb_scene::Scene;

/// Errors over the evaluated runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    /// Root mean square distance from the goals, m.
    pub rmse_m: f64,
    /// The largest distance, m.
    pub max_m: f64,
    /// Root mean square distance of the positions at the end of the last phase from their mean, m.
    pub repeatability_m: f64,
}

/// A scene under one load.
#[derive(Clone, Debug, PartialEq)]
pub struct UnderLoad {
    /// The load, N.
    pub load_n: f64,
    /// Time of the motion, s.
    pub time_s: f64,
    /// With setpoints for a limb without weight.
    pub uncorrected: Tracking,
    /// With setpoints by the nominal limb's statics.
    pub compensated: Tracking,
    /// With learned corrections of these.
    pub corrected: Tracking,
}

/// Evaluates a scene with a load, N, that hangs on the tip in all phases. The grippers of its phases are left out.
///
/// # Errors
/// [`LearningError`] where a run fails, the limb falls, or cannot reach its goals under the load.
pub fn under_load(scene: &Scene, load_n: f64, settings: &Settings) -> Result<UnderLoad, LearningError> {
    let payload_kg = load_n / softlimb_limb::statics::GRAVITY_M_PER_S2;
    let [bare, weighed] = [false, true].map(|compensated| scene.carrying(payload_kg, compensated));
    let (bare, weighed) = (Prepared::by_model(&bare)?, Prepared::by_model(&weighed)?);
    let free = bare.plan();
    let goals: Vec<Vector3<f64>> = ends_s(free).map(|end_s| free.tip_m(bare.limb(), end_s * 1e6).into()).collect();
    let evaluated = settings.noise..settings.noise + u64::from(settings.runs.get());
    let tracking = |prepared: &Prepared<'_>| -> Result<Tracking, LearningError> {
        let run = |noise: u64| -> Result<Vec<Vec<Vector3<f64>>>, LearningError> {
            let samples = samples(prepared, settings, noise)?;
            // Moves without a `duration` take another time under weight.
            Ok(ends_s(prepared.plan()).map(|end_s| tips_m(&samples, end_s)).collect::<Result<_, RunError>>()?)
        };
        Ok(score(&goals, &evaluated.clone().map(run).collect::<Result<Vec<_>, _>>()?))
    };
    let (_, corrected, _) = iterate(&weighed, settings, &mut (evaluated.end..))?;
    Ok(UnderLoad {
        load_n,
        time_s: free.duration_us() as f64 * 1e-6,
        uncorrected: tracking(&bare)?,
        compensated: tracking(&weighed)?,
        corrected: tracking(&corrected)?,
    })
}

/// Scores the positions at the ends of the phases of each run.
fn score(goals: &[Vector3<f64>], runs: &[Vec<Vec<Vector3<f64>>>]) -> Tracking {
    let (mut errors, mut spread) = (Distances::default(), Distances::default());
    let tips = runs.iter().flat_map(|run| goals.iter().zip(run));
    tips.for_each(|(goal, tips)| tips.iter().for_each(|tip| errors.add(&(tip - goal))));
    let last: Vec<Vector3<f64>> = runs.iter().filter_map(|run| run.last()).map(|tips| mean(tips)).collect();
    last.iter().for_each(|place| spread.add(&(place - mean(&last))));
    Tracking { rmse_m: errors.rmse_m(), max_m: errors.max_m, repeatability_m: spread.rmse_m() }
}
