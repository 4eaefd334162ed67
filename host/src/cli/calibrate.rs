//! `softlimb calibrate`: parameters from measurements.

mod creep;
mod limb;
mod tension;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::Value;

use super::kept::write;
use super::{Failure, Outcome, say, warn};
use softlimb_rig::calibrate::{Law, Noise, Property, Settings};
use softlimb_scene::{Scene, rewritten};

/// Fit moduli, fibers, walls and sensors to tensile tests and to pressures and deformations
#[derive(Args)]
#[command(after_help = "Examples:\n  softlimb calibrate --tension silicone.csv --law yeoh\n  \
                  softlimb calibrate scene.toml --data finger.csv --fit shear_modulus,pressure_offset\n  \
                  softlimb calibrate --run run.mcap --fit shear_modulus --per module --write fitted.toml\n\n\
                  Files and method: docs/calibrate.md")]
pub(super) struct Calibrate {
    /// The scene that describes the actuators; --run takes that of the log where none is given
    scene: Option<PathBuf>,
    /// A tensile test: CSV with stretch or strain and nominal_stress_pa or force_n
    #[arg(long, value_name = "FILE", conflicts_with_all = ["data", "run", "fit", "creep"])]
    tension: Option<PathBuf>,
    /// Pressures and deformations: CSV with module, pressure_pa and axial_stretch, outer_radius_m, bend_angle_rad or twist_rad
    #[arg(long, value_name = "FILE", requires = "scene", conflicts_with = "run")]
    data: Option<PathBuf>,
    /// The log of a run: the ends of its holds
    #[arg(long, value_name = "FILE", conflicts_with = "creep")]
    run: Option<PathBuf>,
    /// What to find: shear_modulus, yeoh_c1, yeoh_c2, yeoh_c3, fiber_modulus, fiber_angle, wall, inner_radius, length, pressure_offset, pressure_gain
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = property)]
    fit: Vec<Property>,
    /// Find the creep of a step response, --data with a column time_s
    #[arg(long, requires = "data", conflicts_with = "fit")]
    creep: bool,
    /// One value for all modules of a material or winding, or one for each module
    #[arg(long, value_enum, default_value_t = Per::Part)]
    per: Per,
    /// The law of a tensile test
    #[arg(long, value_enum, default_value_t = LawWord::Yeoh)]
    law: LawWord,
    /// Undeformed section of the specimen of a tensile test with forces, m2
    #[arg(long, value_name = "M2", value_parser = positive)]
    section_m2: Option<f64>,
    /// Use a tensile test up to this stretch
    #[arg(long, value_name = "STRETCH", value_parser = positive)]
    up_to: Option<f64>,
    /// The material of the scene that a tensile test is about
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Accuracy of a measurement, as a share of the largest one of its kind; what cannot be told at this accuracy is refused
    #[arg(long, value_name = "SHARE", default_value_t = 0.002, value_parser = positive)]
    accuracy: f64,
    /// Share of intervals that hold the true value
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = positive)]
    confidence: f64,
    /// Print the answer as JSON
    #[arg(long)]
    json: bool,
    /// Draw measurements, model and residuals
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write the scene with the values found; its comments stay
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Per {
    /// One for each material and winding, for sizes and sensors one for each module
    Part,
    /// One for each module
    Module,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LawWord {
    NeoHookean,
    /// With C1 and C2
    #[value(name = "yeoh-2")]
    YeohTwo,
    /// With C1, C2 and C3
    Yeoh,
}

impl From<LawWord> for Law {
    fn from(word: LawWord) -> Self {
        match word {
            LawWord::NeoHookean => Self::NeoHookean,
            LawWord::YeohTwo => Self::YeohTwo,
            LawWord::Yeoh => Self::Yeoh,
        }
    }
}

/// What a way of calibrating has to say.
struct Said {
    table: String,
    json: Value,
    svg: String,
    /// Scene and actuators to be written.
    scene: Option<(Scene, Vec<fra_model::ActuatorParameters<f64>>)>,
    warnings: Vec<String>,
}

impl Calibrate {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let said = match (&self.tension, &self.data, &self.run) {
            (Some(file), _, _) => self.tension(file)?,
            (None, Some(file), _) if self.creep => self.creep(file)?,
            (None, None, None) => {
                return Err(Failure::wrong_line("give measurements: --tension, --data or --run"));
            }
            _ if self.fit.is_empty() => {
                return Err(Failure::wrong_line(
                    "say what to find: --fit shear_modulus, or --creep for a step response",
                ));
            }
            (None, Some(file), _) => self.read_table(file)?,
            (None, None, Some(file)) => self.read_log(file)?,
        };
        self.tell(said)
    }

    fn tell(&self, said: Said) -> Result<Outcome, Failure> {
        let written = match (&said.scene, &self.write) {
            (Some((scene, wanted)), _) => Some(rewritten(scene, wanted).map_err(Failure::new)?),
            (None, Some(_)) => {
                return Err(Failure::wrong_line("--write needs a scene, and a fit of what a scene may say"));
            }
            (None, None) => None,
        };
        let changes = written.as_ref().map_or(&[][..], |(_, changes)| changes);
        if self.json {
            let mut json = said.json;
            json["scene_changes"] = changes.into();
            json["warnings"] = said.warnings.clone().into();
            say(&json.to_string())?;
        } else {
            let list = changes.iter().map(|line| format!("  {line}\n")).collect::<String>();
            let list = if list.is_empty() { list } else { format!("\nin the scene:\n{list}") };
            say(&format!("{}{list}", said.table))?;
        }
        if let Some(file) = &self.svg {
            write(file, &said.svg)?;
        }
        if let (Some(file), Some((text, _))) = (&self.write, &written) {
            write(file, text)?;
        }
        Ok(warn(&said.warnings))
    }

    fn settings(&self) -> Settings {
        Settings { noise: Noise::FromResiduals, confidence: self.confidence }
    }
}

/// A failure about a file of measurements.
fn about(file: &Path) -> impl Fn(&dyn std::fmt::Display) -> Failure {
    move |error| Failure::new(format!("{}: {error}", file.display()))
}

fn property(word: &str) -> Result<Property, String> {
    let known = || Property::ALL.iter().map(|property| property.word()).collect::<Vec<_>>().join(", ");
    Property::of_word(word).ok_or_else(|| format!("known are {}", known()))
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err("finite and > 0".into()) }
}
