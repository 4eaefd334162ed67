//! Studies: scenes with varied parameters.

mod read;
mod value;

use std::num::NonZero;
use std::path::Path;

use toml_edit::DocumentMut;

use super::data::Scene;
use super::error::SceneError;
use super::source::{Source, fnv1a};
use super::writer::set;
use value::{Setting, Values, quantity};

/// Scenes with varied parameters. A design is one scene with one value of each parameter. Each design has several simulated limbs.
#[derive(Clone, Debug)]
pub struct Study {
    /// Its file.
    name: String,
    scenes: Vec<VariedScene>,
    parameters: Vec<Parameter>,
    points: u32,
    limbs: u32,
    seed: u32,
    experiment: Experiment,
    hash: u64,
}

/// What each simulated limb of a study does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Experiment {
    /// One run.
    Run,
    /// Iterative learning control.
    Learn {
        /// Runs to learn from.
        iterations: u32,
        /// Runs of each evaluation.
        runs: NonZero<u32>,
        /// Standard deviation of each coordinate in one observation of the camera, m.
        camera_noise_m: f64,
    },
}

/// A scene of a study.
#[derive(Clone, Debug)]
struct VariedScene {
    /// File name as written in the study, so that tables do not depend on the current folder.
    file: String,
    source: Source,
}

/// A parameter of a study.
#[derive(Clone, Debug)]
struct Parameter {
    /// Names of tables, then the key.
    place: Vec<String>,
    values: Values,
}

/// Reads and checks a study file with its scenes: each is read with the first value of each parameter.
///
/// # Errors
/// [`SceneError`] of the study, or of a scene with the values.
pub fn load_study(path: impl AsRef<Path>) -> Result<Study, SceneError> {
    let path = path.as_ref();
    let study = read::study(Source::read(path)?, path.parent().unwrap_or(Path::new("")))?;
    let drawn = vec![0.0; study.drawn_count()];
    let designs = study.designs() / study.scenes.len() as u64;
    for scene in 0..study.scenes.len() as u64 {
        study.scene(scene * designs, &drawn)?;
    }
    Ok(study)
}

impl Study {
    /// Number of designs.
    pub fn designs(&self) -> u64 {
        let listed: u64 = self.parameters.iter().filter_map(|parameter| parameter.values.listed()).product();
        (self.scenes.len() as u64).saturating_mul(listed).saturating_mul(u64::from(self.points))
    }

    /// Simulated limbs of each design; their seeds are 1 to this number.
    pub fn limbs(&self) -> u32 {
        self.limbs
    }

    /// Number of rows: one for each limb of each design.
    pub fn rows(&self) -> u64 {
        self.designs().saturating_mul(u64::from(self.limbs))
    }

    /// Number of parameters that are drawn.
    pub fn drawn_count(&self) -> usize {
        self.parameters.iter().filter(|parameter| parameter.values.listed().is_none()).count()
    }

    /// Seed of the drawn points.
    pub fn seed(&self) -> u32 {
        self.seed
    }

    /// What each limb does.
    pub fn experiment(&self) -> Experiment {
        self.experiment
    }

    /// Scene files, as the study names them: relative to its folder, or absolute.
    pub fn scene_files(&self) -> impl Iterator<Item = &str> {
        self.scenes.iter().map(|scene| scene.file.as_str())
    }

    /// FNV-1a hash of the texts of the study and its scenes.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Column headings of the scene and of each parameter, with its unit.
    pub fn headings(&self) -> Vec<String> {
        let heading = |parameter: &Parameter| match parameter.values.unit() {
            "" => parameter.place.join("."),
            unit => format!("{} [{unit}]", parameter.place.join(".")),
        };
        std::iter::once("scene".to_owned()).chain(self.parameters.iter().map(heading)).collect()
    }

    /// Index of the design's drawn point.
    pub fn point(&self, design: u64) -> u32 {
        (design % u64::from(self.points)) as u32
    }

    /// The cells under [`headings`](Self::headings) of a design. `drawn` has a number from 0 to 1 for each drawn parameter.
    pub fn cells(&self, design: u64, drawn: &[f64]) -> Vec<String> {
        let (scene, settings) = self.design(design, drawn);
        let cells = settings.into_iter().map(|(_, setting)| setting.shown);
        std::iter::once(self.scenes[scene].file.clone()).chain(cells).collect()
    }

    /// The scene of a design.
    ///
    /// # Errors
    /// [`SceneError`] if the scene refuses the values.
    pub fn scene(&self, design: u64, drawn: &[f64]) -> Result<Scene, SceneError> {
        let (scene, settings) = self.design(design, drawn);
        let source = &self.scenes[scene].source;
        // `load_study` has parsed this text.
        let Ok(mut document) = source.text.parse::<DocumentMut>() else { return super::read::scene(source.clone()) };
        for (place, setting) in &settings {
            // `load_study` has found this place.
            let _ = set(&mut document, place, &setting.written);
        }
        let name = format!("{} as varied by {}", source.name, self.name);
        super::parse(&document.to_string(), &name)
    }

    /// The scene of a design and the value of each parameter.
    fn design(&self, design: u64, drawn: &[f64]) -> (usize, Vec<(&[String], Setting)>) {
        let mut rest = design / u64::from(self.points);
        let mut drawn = drawn.iter().rev();
        let mut settings: Vec<(&[String], Setting)> = Vec::with_capacity(self.parameters.len());
        for parameter in self.parameters.iter().rev() {
            let setting = match &parameter.values {
                Values::Listed { settings, .. } => {
                    let count = settings.len() as u64;
                    let choice = rest % count;
                    rest /= count;
                    settings[choice as usize].clone()
                }
                Values::Range { ends: [low, high], unit } => {
                    let share = drawn.next().copied().unwrap_or(0.0);
                    quantity(low + share * (high - low), unit)
                }
            };
            settings.push((&parameter.place, setting));
        }
        settings.reverse();
        ((rest % self.scenes.len() as u64) as usize, settings)
    }

    /// [`hash`](Self::hash) of a study's text and its scenes.
    fn hashed(text: &str, scenes: &[VariedScene]) -> u64 {
        let texts = std::iter::once(text).chain(scenes.iter().map(|scene| &*scene.source.text));
        fnv1a(texts.collect::<Vec<_>>().join("\0").as_bytes())
    }
}
