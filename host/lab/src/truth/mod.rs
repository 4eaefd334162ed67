//! Tip errors of runs on limbs that are not the planner's: each effect of a true body alone, and all together.

mod command;
mod picture;
mod table;

use std::num::NonZero;
use std::path::Path;

use softlimb::cli::Failure;
use softlimb_rig::learning::{LearningError, Score, Settings, evaluate_as_is, learn};
use softlimb_scene as scene;
use softlimb_scene::{BodyEffects, Scene, TrueLimb};

pub(crate) use command::Truth;

/// The simulated limbs of the table.
const LIMBS: [TrueLimb; 9] = [
    TrueLimb::Simple,
    TrueLimb::Body(NONE),
    TrueLimb::Body(BodyEffects { hysteresis: true, ..NONE }),
    TrueLimb::Body(BodyEffects { creep: true, ..NONE }),
    TrueLimb::Body(BodyEffects { softening: true, ..NONE }),
    TrueLimb::Body(BodyEffects { assembly: true, ..NONE }),
    TrueLimb::Body(BodyEffects { swing: true, ..NONE }),
    TrueLimb::Body(BodyEffects { swing: false, ..ALL }),
    TrueLimb::Body(ALL),
];

const NONE: BodyEffects =
    BodyEffects { hysteresis: false, creep: false, softening: false, assembly: false, contact: false, swing: false };

const ALL: BodyEffects =
    BodyEffects { hysteresis: true, creep: true, softening: true, assembly: true, contact: true, swing: true };

/// A camera of the default accuracy, whose images correct the setpoints within a run.
const FEEDBACK: &str = "[camera]\nfeedback = true\n";

/// A line of the table: tip errors before and after learning, and with feedback in place of learning, m.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    /// Name of the scene.
    scene: String,
    /// The simulated limb in words.
    limb: String,
    /// RMSE and maximum at the dwells, then RMSE over the whole way: by the model; `None` where the limb fell.
    by_model: Option<[f64; 3]>,
    /// The same after learning.
    learned: Option<[f64; 3]>,
    /// The same with feedback within the run, without learning.
    feedback: Option<[f64; 3]>,
}

/// A scene of the repository with another simulated limb, and with more text.
///
/// # Errors
/// [`Failure`] if the scene cannot be read.
fn scene_on(folder: &Path, name: &str, limb: TrueLimb, more: &str) -> Result<Scene, Failure> {
    let file = folder.join(format!("{name}.toml"));
    let text = softlimb::cli::read(&file)?;
    let truth = match limb {
        TrueLimb::Simple => "limb = \"simple\"\n".to_owned(),
        TrueLimb::Body(BodyEffects { hysteresis, creep, softening, assembly, contact, swing }) => format!(
            "limb = \"body\"\nhysteresis = {hysteresis}\ncreep = {creep}\nsoftening = {softening}\nassembly = {assembly}\n\
             contact = {contact}\nswing = {swing}\n"
        ),
    };
    Ok(scene::parse(&format!("{text}\n{more}[plant.truth]\n{truth}"), &file.display().to_string())?)
}

/// The line of a scene on a limb, with a run before and one after `iterations` of learning, and a run with feedback.
///
/// # Errors
/// [`Failure`] if the scene cannot run.
fn row(folder: &Path, name: &str, limb: TrueLimb, iterations: u32) -> Result<Row, Failure> {
    let scene = scene_on(folder, name, limb, "")?;
    let settings =
        Settings { limb: scene.seed(), noise: 1, iterations, runs: NonZero::<u32>::MIN, camera_noise_m: 0.2e-3 };
    let learned = unless_it_falls(learn(&scene, &settings))?;
    let feedback = unless_it_falls(evaluate_as_is(&scene_on(folder, name, limb, FEEDBACK)?, &settings))?;
    Ok(Row {
        scene: name.to_owned(),
        limb: limb.label().unwrap_or_else(|| "simple".to_owned()),
        by_model: learned.as_ref().map(|found| figures(&found.by_model)),
        learned: learned.as_ref().map(|found| figures(&found.corrected)),
        feedback: feedback.as_ref().map(figures),
    })
}

/// `None` of a limb that falls.
fn unless_it_falls<T>(found: Result<T, LearningError>) -> Result<Option<T>, Failure> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(LearningError::Fell { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn figures(score: &Score) -> [f64; 3] {
    let dwells = score.at_targets();
    [dwells.rmse_m(), dwells.max_m, score.whole_way.rmse_m()]
}
