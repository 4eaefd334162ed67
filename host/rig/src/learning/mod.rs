//! Iterative learning control: corrections of the setpoints from a camera's observations of the tip, over a few runs of one limb.
//!
//! A limb differs from its model: moduli, walls, angles, sensors, creep. In an iteration the scene runs, a camera observes the tip, and the
//! model's derivatives turn the tip's error into corrections ([`Learner`]). Evaluated runs use the same limb; only noise differs. The
//! learner knows the camera's observations and the device's reports; the truth is for the evaluation alone ([`Score`]).
//!
//! [`learn`] evaluates a scene before and after learning, [`under_load`] evaluates it with a load on the tip, and [`observe`] gives the
//! camera's observations without and with a load, for payload estimation.

mod learner;
mod load;
mod observe;
mod score;

use std::num::NonZero;

use crate::camera::Camera;
use crate::record::Sample;
use crate::run::{Prepared, RunError};
use softlimb_scene::{Module, Phase, PhaseCorrections, Scene};

use learner::Learner;
pub use load::{Tracking, UnderLoad, under_load};
pub use observe::observe;
pub use score::{Distances, Score, TargetScore};

/// Settings of a learning experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Seed of the limb's deviations from its model.
    pub limb: u64,
    /// Seed of the noise of valves, sensors and camera, which differs from run to run.
    pub noise: u64,
    /// Runs to learn from.
    pub iterations: u32,
    /// Runs of each evaluation.
    pub runs: NonZero<u32>,
    /// Standard deviation of each coordinate in one observation of the camera, m; >= 0. In learning, the scene's `[camera]` states the rest; without it
    /// the camera observes whenever the device reports.
    pub camera_noise_m: f64,
}

/// Result of a learning experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Runs by the model alone.
    pub by_model: Score,
    /// Runs with the corrections.
    pub corrected: Score,
    /// The corrections of the setpoints.
    pub corrections: PhaseCorrections,
    /// Observed error at rest in each iteration, with the corrections from before it; RMS, m.
    pub observed_m: Vec<f64>,
    /// Bound of the tip's error at a target by the device's inverse, m; `None` where a module is not looked up in tables of a verified error.
    pub inverse_m: Option<f64>,
}

/// Failure of a learning experiment.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LearningError {
    /// A run did not come to its end.
    #[error(transparent)]
    Run(#[from] RunError),
    /// No phase rests long enough to be evaluated.
    #[error("no phase rests at its goal: in one of them `hold` must be at least {:.1} s", score::REST_S)]
    NoTarget,
    /// The camera did not see the tip while the limb rested.
    #[error(
        "in a run the camera has no image with a tip while the limb rests: `period` or `drop_outs` of `[camera]` is too large"
    )]
    Unseen,
    /// A scene in which corrections are tested has another limb.
    #[error("{scene} has other modules, actuators or quantities of setpoints than the scene of the corrections")]
    OtherLimb {
        /// Name of the scene.
        scene: String,
    },
    /// A scene in which corrections are tested has a phase that the scene of the corrections does not have.
    #[error("{scene} has the phase `{phase}`, for which there are no corrections")]
    OtherPhase {
        /// Name of the scene.
        scene: String,
        /// Name of the phase.
        phase: String,
    },
    /// The limb fell.
    #[error("{time_s:.2} s into a run the limb has no equilibrium under its weight and payload")]
    Fell {
        /// Time after the start, s.
        time_s: f64,
    },
}

/// Learns corrections for a scene and evaluates it before and after. Corrections of its own are ignored.
///
/// # Errors
/// [`LearningError`].
pub fn learn(scene: &Scene, settings: &Settings) -> Result<Outcome, LearningError> {
    let model = Prepared::by_model(scene)?;
    if !score::is_evaluated(model.plan()) {
        return Err(LearningError::NoTarget);
    }
    // Every run has noise of its own.
    let mut noises = (1..).map(|run| settings.noise.wrapping_add(run));
    let by_model = evaluate(&model, settings, &mut noises)?;
    let (learner, prepared, observed_m) = iterate(&model, settings, &mut noises)?;
    let corrected = evaluate(&prepared, settings, &mut noises)?;
    let inverse_m = score::inverse_m(model.limb(), model.plan(), model.inverse_errors_pa());
    let corrections = model.plan().by_phase(model.limb(), learner.corrections());
    Ok(Outcome { by_model, corrected, corrections, observed_m, inverse_m })
}

/// Evaluates runs of a scene with its own corrections and, if it asks for it, with feedback. Of the settings, only `limb`, `noise` and `runs` are used.
///
/// # Errors
/// As [`learn`].
pub fn evaluate_as_is(scene: &Scene, settings: &Settings) -> Result<Score, LearningError> {
    let prepared = Prepared::of(scene)?;
    if !score::is_evaluated(prepared.plan()) {
        return Err(LearningError::NoTarget);
    }
    evaluate(&prepared, settings, &mut (1..).map(|run| settings.noise.wrapping_add(run)))
}

/// Evaluates runs of another scene of the same limb by the model alone, and with what was learned in a scene.
///
/// # Errors
/// As [`learn`]; [`LearningError::OtherLimb`] and [`LearningError::OtherPhase`].
pub fn transferred(
    other: &Scene,
    (scene, corrections): (&Scene, &PhaseCorrections),
    settings: &Settings,
) -> Result<[Score; 2], LearningError> {
    let modules = |scene: &Scene| -> Vec<_> {
        let quantity = |module: &Module| (module.name.value.clone(), module.actuators, module.setpoint_kind);
        scene.modules().iter().map(quantity).collect()
    };
    if modules(other) != modules(scene) {
        return Err(LearningError::OtherLimb { scene: other.name().to_owned() });
    }
    let rows_of = |phase: &Phase| {
        let mut known = scene.phases().iter().zip(&corrections.phases);
        let rows = known.find(|(own, _)| own.name.value == phase.name.value).map(|(_, rows)| rows.clone());
        let unknown = || (other.name().to_owned(), phase.name.value.clone());
        rows.ok_or_else(unknown).map_err(|(scene, phase)| LearningError::OtherPhase { scene, phase })
    };
    let phases = other.phases().iter().map(rows_of).collect::<Result<_, _>>()?;
    let model = Prepared::by_model(other)?;
    if !score::is_evaluated(model.plan()) {
        return Err(LearningError::NoTarget);
    }
    let series = PhaseCorrections { phases }.over(&model.plan().phase_times());
    let mut noises = (1..).map(|run| settings.noise.wrapping_add(run));
    let by_model = evaluate(&model, settings, &mut noises)?;
    Ok([by_model, evaluate(&model.corrected(&series)?, settings, &mut noises)?])
}

/// Learns from as many runs as the settings have iterations, with noise of these seeds. The run with the last corrections comes with the
/// observed errors.
fn iterate<'a, 's>(
    model: &'a Prepared<'s>,
    settings: &Settings,
    noises: &mut impl Iterator<Item = u64>,
) -> Result<(Learner<'a>, Prepared<'s>, Vec<f64>), LearningError> {
    let learner =
        Learner::new(model, Camera::learning(model.scene(), settings.camera_noise_m, (settings.noise, settings.limb)));
    let mut learner = learner.map_err(RunError::from)?;
    let mut corrected = model.corrected(learner.corrections())?;
    let mut observed_m = Vec::new();
    for noise in noises.take(settings.iterations as usize) {
        observed_m.push(learner.update(&samples(&corrected, settings, noise)?).ok_or(LearningError::Unseen)?);
        corrected = model.corrected(learner.corrections())?;
    }
    Ok((learner, corrected, observed_m))
}

fn evaluate(
    prepared: &Prepared<'_>,
    settings: &Settings,
    noises: &mut impl Iterator<Item = u64>,
) -> Result<Score, LearningError> {
    let mut score = Score::new(prepared.plan());
    for noise in noises.take(settings.runs.get() as usize) {
        score.add(prepared.plan(), &samples(prepared, settings, noise)?);
    }
    Ok(score)
}

/// Samples of a run in which the limb stands.
fn samples(prepared: &Prepared<'_>, settings: &Settings, noise: u64) -> Result<Vec<Sample>, LearningError> {
    let samples = prepared.samples(settings.limb, noise)?;
    match samples.iter().find(|sample| sample.tip_achieved_m.is_none()) {
        Some(fallen) => Err(LearningError::Fell { time_s: fallen.time_s }),
        None => Ok(samples),
    }
}
