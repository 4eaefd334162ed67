//! Rehearsals and trials of a scene: what a camera on the tip teaches in a few runs of one limb, and how well that limb then does.
//!
//! A limb differs from its model: moduli, walls, angles, sensors, creep. In a rehearsal the scene runs as it will, a camera looks at the
//! tip, and the setpoints are corrected by what the tip is off, through the model's derivatives ([`Learner`]). Trials are further runs of
//! the same limb; only noise differs. What is learned comes from the camera and from what the device reports; the truth is for the judge
//! alone ([`Score`]).

mod learn;
mod score;

use std::num::NonZero;

use crate::record::Sample;
use crate::run::{Prepared, RunError};
use softlimb_scene::{Corrections, Scene};

use learn::Learner;
pub use score::{Distances, Score, TargetScore};

/// What is repeated how often.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Seed of what the limb is.
    pub limb: u64,
    /// Seed of what differs from run to run: valves, sensors, camera.
    pub noise: u64,
    /// Runs to learn from.
    pub rehearsals: u32,
    /// Runs to be judged by, once by the model alone and once with what was learned.
    pub trials: NonZero<u32>,
    /// Standard deviation of each coordinate in one look of the camera, m; >= 0. It looks whenever the device reports.
    pub camera_noise_m: f64,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Trials by the model alone.
    pub by_model: Score,
    /// Trials with what was learned.
    pub learned: Score,
    /// The corrections of the setpoints.
    pub corrections: Corrections,
    /// Error at the targets as the camera saw it in each rehearsal, RMS, m: of what was learned before it.
    pub seen_m: Vec<f64>,
    /// What the device's inverse can put the tip off by at a target, m, at most; `None` where a module is not looked up in tables of a
    /// verified error.
    pub inverse_m: Option<f64>,
}

/// Why there are no trials.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrialsError {
    /// A run did not come to its end.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There is nothing to judge.
    #[error("no phase rests at its goal: in one of them `hold` must be at least {:.1} s", score::REST_S)]
    NothingHeld,
    /// The limb fell.
    #[error("{time_s:.2} s into a run the limb has no equilibrium under its weight and payload")]
    Fell {
        /// When, s after the start.
        time_s: f64,
    },
}

/// Rehearses a scene and tries it; corrections of its own are not looked at. `on_run` is told how many runs are done, and of how many.
///
/// # Errors
/// [`TrialsError`].
pub fn trials(scene: &Scene, settings: &Settings, on_run: impl FnMut(u32, u32)) -> Result<Outcome, TrialsError> {
    let by_model = Prepared::by_model(scene)?;
    if !score::is_judged(by_model.plan()) {
        return Err(TrialsError::NothingHeld);
    }
    let of = settings.rehearsals + 2 * settings.trials.get();
    let mut runs = Runs { settings, done: 0, of, on_run };
    let first = runs.judge(&by_model)?;
    let mut learner = Learner::new(by_model.limb(), by_model.plan(), settings.camera_noise_m, settings.noise);
    let mut corrected = by_model.corrected(learner.corrections())?;
    let mut seen_m = Vec::new();
    for _ in 0..settings.rehearsals {
        seen_m.push(learner.learn(&runs.run(&corrected)?));
        corrected = by_model.corrected(learner.corrections())?;
    }
    let learned = runs.judge(&corrected)?;
    let inverse_m = score::inverse_m(by_model.limb(), by_model.plan(), by_model.inverse_errors_pa());
    Ok(Outcome { by_model: first, learned, corrections: learner.corrections().clone(), seen_m, inverse_m })
}

/// Runs of one limb, each with noise of its own.
struct Runs<'a, F> {
    settings: &'a Settings,
    done: u32,
    of: u32,
    on_run: F,
}

impl<F: FnMut(u32, u32)> Runs<'_, F> {
    fn run(&mut self, prepared: &Prepared<'_>) -> Result<Vec<Sample>, TrialsError> {
        self.done += 1;
        let noise = self.settings.noise.wrapping_add(u64::from(self.done));
        let samples = prepared.samples(self.settings.limb, noise)?;
        (self.on_run)(self.done, self.of);
        let fallen = samples.iter().find(|sample| sample.tip_achieved_m.is_none());
        fallen.map_or(Ok(samples.clone()), |sample| Err(TrialsError::Fell { time_s: sample.time_s }))
    }

    fn judge(&mut self, prepared: &Prepared<'_>) -> Result<Score, TrialsError> {
        let mut score = Score::new(prepared.plan());
        for _ in 0..self.settings.trials.get() {
            score.add(prepared.plan(), &self.run(prepared)?);
        }
        Ok(score)
    }
}
