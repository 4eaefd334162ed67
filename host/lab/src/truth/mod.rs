//! Tip errors of runs on limbs that are not the planner's: each effect of a true body alone, and all together.

mod command;
mod picture;
mod table;

use std::num::NonZero;
use std::path::Path;

use softlimb::cli::Failure;
use softlimb_rig::learning::{Outcome, Settings, learn};
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
    TrueLimb::Body(BodyEffects { hysteresis: true, creep: true, softening: true, assembly: true, ..NONE }),
    TrueLimb::Body(BodyEffects { hysteresis: true, creep: true, softening: true, assembly: true, swing: true, ..NONE }),
];

const NONE: BodyEffects =
    BodyEffects { hysteresis: false, creep: false, softening: false, assembly: false, contact: false, swing: false };

/// A line of the table: tip errors before and after learning, m.
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
}

/// A scene of the repository with another simulated limb.
///
/// # Errors
/// [`Failure`] if the scene cannot be read.
fn scene_on(folder: &Path, name: &str, limb: TrueLimb) -> Result<Scene, Failure> {
    let file = folder.join(format!("{name}.toml"));
    let text = softlimb::cli::read(&file)?;
    let truth = match limb {
        TrueLimb::Simple => "limb = \"simple\"\n".to_owned(),
        TrueLimb::Body(BodyEffects { hysteresis, creep, softening, assembly, contact, swing }) => format!(
            "limb = \"body\"\nhysteresis = {hysteresis}\ncreep = {creep}\nsoftening = {softening}\nassembly = {assembly}\n\
             contact = {contact}\nswing = {swing}\n"
        ),
    };
    Ok(scene::parse(&format!("{text}\n[plant.truth]\n{truth}"), &file.display().to_string())?)
}

/// The line of a scene on a limb, with a run before and one after `iterations` of learning.
///
/// # Errors
/// [`Failure`] if the scene cannot run.
fn row(folder: &Path, name: &str, limb: TrueLimb, iterations: u32) -> Result<Row, Failure> {
    let scene = scene_on(folder, name, limb)?;
    let settings =
        Settings { limb: scene.seed(), noise: 1, iterations, runs: NonZero::<u32>::MIN, camera_noise_m: 0.2e-3 };
    let words = limb.label().unwrap_or_else(|| "simple".to_owned());
    let line = |found: Option<&Outcome>| Row {
        scene: name.to_owned(),
        limb: words.clone(),
        by_model: found.map(|found| figures(&found.by_model)),
        learned: found.map(|found| figures(&found.corrected)),
    };
    match learn(&scene, &settings) {
        Ok(found) => Ok(line(Some(&found))),
        Err(softlimb_rig::learning::LearningError::Fell { .. }) => Ok(line(None)),
        Err(error) => Err(error.into()),
    }
}

fn figures(score: &softlimb_rig::learning::Score) -> [f64; 3] {
    let dwells = score.at_targets();
    [dwells.rmse_m(), dwells.max_m, score.whole_way.rmse_m()]
}
