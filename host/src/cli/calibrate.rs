//! `softlimb calibrate`: parameters from measurements.

mod creep;
mod pressure;
mod print;
mod run;
mod specimens;
mod tension;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use fra_model::Material;
use serde::Serialize;

use super::shared::{above_zero, show, write};
use super::{Failure, Outcome, warn};
use softlimb_rig::calibrate::{Noise, Property, Settings};
use softlimb_scene::{Quantity, RewriteError, Scene, WoundActuator, recast, rewritten};
pub(super) use tension::coefficients;

/// Remedy for values far from those of elastomers.
const CHECK_UNITS: &str = "check the units of the columns";

/// Fit parameters to measurements: materials, fibers, walls, sensors, creep
#[derive(Args)]
#[command(after_help = "Files and method: docs/guide/calibrate.md\n\nExamples:\n  \
                  softlimb calibrate tension silicone.csv --law yeoh\n  \
                  softlimb calibrate pressure finger.csv --scene scenes/single-bending.toml --fit shear_modulus,pressure_offset\n  \
                  softlimb calibrate run run.mcap --fit shear_modulus --per module --write fitted.toml")]
pub(super) struct Calibrate {
    #[command(subcommand)]
    mode: Mode,
}

#[derive(Subcommand)]
enum Mode {
    Tension(tension::TensionMode),
    Pressure(pressure::Pressure),
    Creep(creep::Creep),
    Run(run::Run),
}

impl Calibrate {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.mode {
            Mode::Tension(mode) => mode.run(),
            Mode::Pressure(mode) => mode.run(),
            Mode::Creep(mode) => mode.run(),
            Mode::Run(mode) => mode.run(),
        }
    }
}

/// Options of every fit.
#[derive(Args)]
struct Fitting {
    /// Accuracy of a measurement over the largest one of its kind; a parameter that the data do not determine this well is refused
    #[arg(long, value_name = "RATIO", default_value = "0.002", value_parser = above_zero("1", f64::INFINITY))]
    accuracy: Quantity,
    /// Share of intervals that hold the true value
    #[arg(long, value_name = "RATIO", default_value = "0.95", value_parser = above_zero("1", f64::INFINITY))]
    confidence: Quantity,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Fitting {
    fn settings(&self) -> Settings {
        Settings { noise: Noise::FromResiduals, confidence: self.confidence.si() }
    }
}

/// Files of a fit.
#[derive(Args)]
struct Files {
    /// Draw measurements, model and residuals
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write the scene with the values found; its comments stay
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

/// Unknowns of a fit of pressures and deformations.
#[derive(Args)]
struct Unknowns {
    #[arg(
        long,
        help = format!("Parameters to find: {}", properties()),
        value_name = "WHAT",
        required = true,
        value_delimiter = ',',
        num_args = 1,
        value_parser = property
    )]
    fit: Vec<Property>,
    /// One value for all modules of a material or winding, or one for each module
    #[arg(long, value_enum, default_value_t = Per::Part)]
    per: Per,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Per {
    /// One for each material and winding, for sizes and sensors one for each module
    Part,
    /// One for each module
    Module,
    /// One for each actuator of an extending module, as far as a run under weight tells them apart
    Actuator,
}

/// Result of a fit.
struct Fitted<T> {
    table: String,
    json: T,
    svg: String,
    /// Scene and what is to be written into it.
    scene: Option<(Scene, Wanted)>,
    warnings: Vec<String>,
}

/// What a fit changes in a scene.
enum Wanted {
    /// The actuators of all modules, with the sheets that the fit took.
    Actuators(Vec<WoundActuator>),
    /// The materials of all modules. The sheets of threads follow from them.
    Materials(Vec<Material<f64>>),
}

impl Wanted {
    fn written(&self, scene: &Scene) -> Result<(String, Vec<String>), RewriteError> {
        match self {
            Self::Actuators(wanted) => rewritten(scene, wanted),
            Self::Materials(wanted) => recast(scene, wanted),
        }
    }
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a, T> {
    #[serde(flatten)]
    fit: &'a T,
    scene_changes: &'a [String],
    warnings: &'a [String],
}

impl<T: Serialize> Fitted<T> {
    fn finish(&self, fitting: &Fitting, files: &Files) -> Result<Outcome, Failure> {
        let written = match (&self.scene, &files.write) {
            (Some((scene, wanted)), _) => Some(wanted.written(scene).map_err(|error| not_written(&error))?),
            (None, Some(_)) => {
                return Err(Failure::wrong_line("--write needs a scene, and a fit of properties that a scene has"));
            }
            (None, None) => None,
        };
        let changes = written.as_ref().map_or(&[][..], |(_, changes)| changes);
        show(fitting.json, &Printed { fit: &self.json, scene_changes: changes, warnings: &self.warnings }, || {
            let list = changes.iter().map(|line| format!("  {line}\n")).collect::<String>();
            let list = if list.is_empty() { list } else { format!("\nin the scene:\n{list}") };
            format!("{}{list}", self.table)
        })?;
        if let Some(file) = &files.svg {
            write(file, &self.svg)?;
        }
        if let (Some(file), Some((text, _))) = (&files.write, &written) {
            write(file, text)?;
        }
        Ok(warn(&self.warnings))
    }
}

/// A failure to write fitted values into a scene. The line of a value that is refused is one of no file, and is left out.
fn not_written(error: &RewriteError) -> Failure {
    let RewriteError::Refused(refused) = error else { return Failure::new(error) };
    let told = refused.diagnostics().into_iter().map(|problem| match problem.label {
        Some(label) => format!("{}: {label}", problem.message),
        None => problem.message,
    });
    let told = told.collect::<Vec<_>>().join("; ");
    Failure::new(format!("the scene does not take the fitted values: {told}: {CHECK_UNITS}"))
}

fn property(word: &str) -> Result<Property, String> {
    Property::of_word(word).ok_or_else(|| format!("known are {}", properties()))
}

/// The words of all properties, for help and errors.
fn properties() -> String {
    Property::ALL.iter().map(|property| property.word()).collect::<Vec<_>>().join(", ")
}
