//! How well a scene is tracked under loads: uncorrected, corrected by the nominal limb's statics, and taught by looks at rehearsals.
//!
//! A run is looked at where it rests: in the last tenth of a second of each phase. The error is the distance of the tip that happened from
//! the goal that the plan without weight has there. Teaching adds to the goal of each phase, run by run, what the tip was off at its end;
//! the limb stays the same and only valves and sensors have other noise. What differs from run to run cannot be taught.

use std::ops::Range;

use nalgebra::Vector3;

use crate::record::Sample;
use crate::run;
use crate::run::RunError;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_numerics::Random;
use softlimb_numerics::statistics::{mean, root_mean_square};
use softlimb_scene::Scene;

/// How long before the end of a phase the tip is looked at, s.
const LOOK_S: f64 = 0.1;
/// Stream of the camera's noise.
const CAMERA: u64 = 1;

/// What is tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Force of the load's weight, N; >= 0.
    pub load_n: f64,
    /// Runs that are counted; >= 1.
    pub repeats: u64,
    /// Rehearsals that are looked at before the taught runs.
    pub rehearsals: u64,
    /// Seed of what the limb and its valves and sensors are.
    pub parts: u64,
    /// Seed of the noise of the first run; the others follow.
    pub noise: u64,
}

/// What came out of the counted runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// Root of the mean square distance from the goals, m.
    pub rmse_m: f64,
    /// The largest, m.
    pub max_m: f64,
    /// Of the last phase: root of the mean square distance of the placing positions from their mean, m.
    pub repeatability_m: f64,
}

/// A scene under one load.
#[derive(Clone, Debug, PartialEq)]
pub struct UnderLoad {
    /// The load, N.
    pub load_n: f64,
    /// Time of the motion, s.
    pub time_s: f64,
    /// Without any correction.
    pub uncorrected: Tracked,
    /// By the nominal limb's statics.
    pub corrected: Tracked,
    /// After the rehearsals.
    pub taught: Tracked,
}

/// Tries a scene under a load that hangs on the tip in all phases; the gripper is told nothing.
///
/// # Errors
/// [`RunError`] where a run fails, the limb falls, or cannot reach its goals under the load.
pub fn track(scene: &Scene, trial: &Trial) -> Result<UnderLoad, RunError> {
    let payload_kg = trial.load_n / softlimb_limb::statics::GRAVITY_M_PER_S2;
    let [bare, weighed] = [false, true].map(|compensated| scene.carrying(payload_kg, compensated));
    let limb = Limb::new(scene)?;
    let free = motion::plan(&bare, &limb)?;
    let goals: Vec<Vector3<f64>> = ends_s(&free).map(|end_s| free.tip_m(&limb, end_s * 1e6).into()).collect();
    let counted = trial.noise..trial.noise + trial.repeats;
    let tracked = |scene: &Scene, plan: &Plan| -> Result<Tracked, RunError> {
        let runs = counted.clone().map(|noise| looks(scene, &limb, plan, (trial.parts, noise)));
        Ok(judge(&goals, &runs.collect::<Result<Vec<_>, _>>()?))
    };
    let uncorrected = tracked(&bare, &free)?;
    let corrected = tracked(&weighed, &motion::plan(&weighed, &limb)?)?;
    let mut offsets = vec![Vector3::zeros(); goals.len()];
    for rehearsal in 0..trial.rehearsals {
        let plan = motion::taught(&weighed, &limb, &offsets)?;
        let noise = counted.end + rehearsal;
        let seen = looks(&weighed, &limb, &plan, (trial.parts, noise))?;
        // The first looks see the limb, the later ones mostly noise: they count for less and less.
        let gain = if rehearsal < 2 { 1.0 } else { 1.0 / (rehearsal as f64) };
        for ((offset, goal), seen) in offsets.iter_mut().zip(&goals).zip(&seen) {
            *offset += (goal - middle(seen)) * gain;
        }
    }
    let taught = tracked(&weighed, &motion::taught(&weighed, &limb, &offsets)?)?;
    let time_s = free.duration_us() as f64 * 1e-6;
    Ok(UnderLoad { load_n: trial.load_n, time_s, uncorrected, corrected, taught })
}

/// Ends of the phases, s.
fn ends_s(plan: &Plan) -> impl Iterator<Item = f64> {
    plan.phases.iter().map(|phase| (phase.start_us + phase.move_us + phase.hold_us) as f64 * 1e-6)
}

/// Where the tip was seen at the end of each phase of a run, m.
fn looks(scene: &Scene, limb: &Limb, plan: &Plan, seeds: (u64, u64)) -> Result<Vec<Vec<Vector3<f64>>>, RunError> {
    let samples = run::samples(scene, limb, plan, seeds)?;
    ends_s(plan).map(|end_s| tips_m(resting(&samples, end_s), end_s)).collect()
}

/// The samples at rest at the end of a phase.
fn resting(samples: &[Sample], end_s: f64) -> impl Iterator<Item = &Sample> {
    samples.iter().filter(move |sample| sample.time_s > end_s - LOOK_S && sample.time_s <= end_s + 1e-6)
}

fn tips_m<'a>(resting: impl Iterator<Item = &'a Sample>, end_s: f64) -> Result<Vec<Vector3<f64>>, RunError> {
    let seen: Option<Vec<Vector3<f64>>> = resting.map(|sample| sample.tip_achieved_m.map(Vector3::from)).collect();
    seen.filter(|seen| !seen.is_empty()).ok_or(RunError::NotSeen { time_s: end_s })
}

/// What a camera and the sensors see of the limb at the end of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Name of the phase.
    pub phase: String,
    /// Whether the load was on the tip.
    pub loaded: bool,
    /// The tip, m: the mean over the time at which it is looked at.
    pub tip_m: [f64; 3],
    /// Reading of each module's sensors, Pa gauge: the mean over its channels and that time.
    pub pressures_pa: Vec<f64>,
}

/// Runs the setpoints of a scene as it is without and with a load, kg, each `repeats` times, and looks at the ends of all phases. Weight and load
/// are simulated whatever the scene says; `camera_m` is the standard deviation of a coordinate that the camera adds.
///
/// # Errors
/// [`RunError`] where a run fails or the limb falls.
pub fn sightings(scene: &Scene, trial: &Trial, camera_m: f64) -> Result<Vec<Seen>, RunError> {
    let limb = Limb::new(scene)?;
    let plan = motion::sent(scene, &limb, &motion::plan(scene, &limb)?)?;
    let mut random = Random::new(trial.noise, CAMERA);
    let mut noise_m = || camera_m * random.normal();
    let mut seen = Vec::new();
    for (loaded, run) in [false, true].into_iter().flat_map(|loaded| (0..trial.repeats).map(move |run| (loaded, run))) {
        let load_n = if loaded { trial.load_n } else { 0.0 };
        let hung = scene.carrying(load_n / softlimb_limb::statics::GRAVITY_M_PER_S2, true);
        let noise = trial.noise + 2 * run + u64::from(loaded);
        let samples = run::samples(&hung, &limb, &plan, (trial.parts, noise))?;
        for (phase, end_s) in plan.phases.iter().zip(ends_s(&plan)) {
            let tip = middle(&tips_m(resting(&samples, end_s), end_s)?) + Vector3::from_fn(|_, _| noise_m());
            let reading_pa = |channels: &Range<usize>| {
                let readings = resting(&samples, end_s).flat_map(|sample| &sample.channels[channels.clone()]);
                mean(readings.map(|channel| channel.pressure_pa)).unwrap_or(0.0)
            };
            let pressures_pa = limb.modules().iter().map(|module| reading_pa(&module.channels)).collect();
            seen.push(Seen { phase: phase.name.clone(), loaded, tip_m: tip.into(), pressures_pa });
        }
    }
    Ok(seen)
}

fn judge(goals: &[Vector3<f64>], runs: &[Vec<Vec<Vector3<f64>>>]) -> Tracked {
    let of_run = |run: &Vec<Vec<Vector3<f64>>>| -> Vec<f64> {
        let phases = goals.iter().zip(run);
        phases.flat_map(|(goal, seen)| seen.iter().map(move |tip| (tip - goal).norm())).collect()
    };
    let errors: Vec<f64> = runs.iter().flat_map(of_run).collect();
    let places: Vec<Vector3<f64>> = runs.iter().filter_map(|run| run.last().map(|seen| middle(seen))).collect();
    let center = middle(&places);
    let spread = places.iter().map(|place| (place - center).norm());
    Tracked {
        rmse_m: root_mean_square(errors.iter().copied()).unwrap_or(0.0),
        max_m: errors.iter().copied().fold(0.0, f64::max),
        repeatability_m: root_mean_square(spread).unwrap_or(0.0),
    }
}

/// Mean of points; the origin of none.
fn middle(points: &[Vector3<f64>]) -> Vector3<f64> {
    mean(points.iter().copied()).unwrap_or_default()
}
