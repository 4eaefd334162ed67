//! `softlimb calibrate tension`: the law of a material from a tensile test.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fra_model::Material;
use serde::Serialize;

use super::super::shared::{about, above_zero, read};
use super::super::{Failure, Outcome};
use super::{CHECK_UNITS, Files, Fitted, Fitting, Wanted};
use softlimb_limb::{Limb, largest_stretch};
use softlimb_rig::calibrate::{Law, Tension, TensionFit, fit_tension, tension_picture};
use softlimb_scene as scene;
use softlimb_scene::{Quantity, Scene, check_law};

/// Fit the law of a material to a tensile test
#[derive(Args)]
#[command(
    name = "tension",
    after_help = "Files and method: docs/guide/calibrate.md\n\n\
                        Example: softlimb calibrate tension silicone.csv --law yeoh"
)]
pub(super) struct TensionMode {
    /// The test, a CSV file with stretch or strain and nominal_stress_pa or force_n
    #[arg(value_name = "FILE")]
    test: PathBuf,
    /// The scene whose material is replaced
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// The law
    #[arg(long, value_enum, default_value_t = LawWord::Yeoh)]
    law: LawWord,
    /// Undeformed cross-section of the specimen, for a test with forces, m2
    #[arg(long, value_name = "M2", value_parser = above_zero("m2", 1.0))]
    section: Option<Quantity>,
    /// Largest stretch of the test that is used
    #[arg(long, value_name = "STRETCH", value_parser = above_zero("1", f64::INFINITY))]
    up_to: Option<Quantity>,
    /// The material of the scene [default: the only one]
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    #[command(flatten)]
    fitting: Fitting,
    #[command(flatten)]
    files: Files,
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

impl TensionMode {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let about = about(&self.test);
        let section_m2 = self.section.as_ref().map(Quantity::si);
        let test = Tension::read(&read(&self.test)?, section_m2).map_err(|error| about(&error))?;
        let test = self.kept(test).map_err(|error| about(&error))?;
        let fit = fit_tension(&test, self.law.into(), self.fitting.accuracy.si(), &self.fitting.settings());
        let fit = fit.map_err(|error| about(&error))?;
        let scene = self.scene.as_ref().map(scene::load).transpose()?;
        let mut warnings = warnings(&fit);
        let wanted = match &scene {
            Some(scene) => Some(self.with_material(scene, &fit, &mut warnings)?),
            None => {
                // A scene refuses the law itself.
                warnings.extend(check_law(&fit.material).err().map(|error| format!("{error}: {CHECK_UNITS}")));
                None
            }
        };
        let fitted = Fitted {
            table: table(&test, &fit, self.fitting.confidence.si()),
            json: printed(&test, &fit),
            svg: tension_picture(&test, &fit),
            scene: scene.zip(wanted),
            warnings,
        };
        fitted.finish(&self.fitting, &self.files)
    }

    /// The rows up to `--up-to`. Rows without stress fit no law.
    fn kept(&self, test: Tension) -> Result<Tension, String> {
        let Some(up_to) = &self.up_to else { return Ok(test) };
        let kept = test.up_to(up_to.si());
        let is_loaded = |point: &&[f64; 2]| point[1] != 0.0;
        let loaded = || test.points().iter().filter(is_loaded).map(|point| point[0]);
        if kept.points().iter().any(|point| is_loaded(&point)) || loaded().next().is_none() {
            return Ok(kept);
        }
        let [low, high] = [loaded().fold(f64::INFINITY, f64::min), loaded().fold(0.0, f64::max)];
        Err(format!(
            "`--up-to {up_to}` keeps no row of the test that has a stress: their stretches are {low} to {high}, give a stretch in this range"
        ))
    }

    /// The scene's materials with the fitted one, and a warning where the limb stretches it further than the test did.
    fn with_material(&self, scene: &Scene, fit: &TensionFit, warnings: &mut Vec<String>) -> Result<Wanted, Failure> {
        let names: Vec<_> = (0..scene.modules().len()).filter_map(|k| scene.part_name(k, "material")).collect();
        let name = match (&self.material, &names[..]) {
            (Some(name), _) => name.clone(),
            (None, [first, rest @ ..]) if rest.iter().all(|other| other == first) => first.clone(),
            _ => {
                return Err(Failure::wrong_line(format!(
                    "which material? --material with one of {}",
                    names.join(", ")
                )));
            }
        };
        if !names.contains(&name) {
            return Err(Failure::new(format!("no module is made of `{name}`; known materials: {}", names.join(", "))));
        }
        scene.require_no_segments("`calibrate`")?;
        let limb = Limb::new(scene)?;
        let mut wanted = Vec::new();
        for (index, (module, built)) in scene.modules().iter().zip(limb.modules()).enumerate() {
            let mut actuator = module.actuator();
            if names[index] == name {
                actuator.material = fit.material;
                let most =
                    built.curve.states().iter().map(|state| largest_stretch(&actuator, state)).fold(1.0, f64::max);
                if most > fit.tested[1] {
                    let tested = fit.tested[1];
                    warnings.push(format!(
                        "module `{}` stretches its wall up to {most:.2}, and the test went to {tested:.2}: the law is a guess beyond it",
                        *module.name
                    ));
                }
            }
            wanted.push(actuator.material);
        }
        Ok(Wanted::Materials(wanted))
    }
}

fn warnings(fit: &TensionFit) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(stretch) = fit.softens_at {
        warnings.push(format!(
            "beyond a stretch of {stretch:.2} the law gives way, which rubber does not: do not use it there"
        ));
    }
    warnings
}

fn table(test: &Tension, fit: &TensionFit, confidence: f64) -> String {
    let most_pa = test.points().iter().map(|point| point[1].abs()).fold(0.0, f64::max);
    let mut text = format!(
        "{}, {} points, stretch {:.3} to {:.3}; residual {:.3} kPa, {:.2} % of the largest stress\n\n{:<20} {:>14} {:>27}\n",
        fit.law.word(),
        test.points().len(),
        fit.tested[0],
        fit.tested[1],
        fit.rms_pa * 1e-3,
        100.0 * fit.rms_pa / most_pa,
        "MPa",
        "value",
        format!("{} % interval", 100.0 * confidence),
    );
    for value in &fit.values {
        let [low, high] = value.interval.map(|end| end * 1e-6);
        let name = value.name.trim_end_matches("_pa");
        let _ = writeln!(text, "{name:<20} {:>14.7} {low:>12.7} to {high:>11.7}", value.value * 1e-6);
    }
    let _ = write!(text, "\n[materials.NAME]\nlaw = \"{}\"\n{}\n", fit.law.word(), coefficients(&fit.material));
    text
}

/// The coefficients as a scene has them.
pub(in crate::cli) fn coefficients(material: &Material<f64>) -> String {
    match material {
        Material::NeoHookean { shear_modulus_pa } => format!("shear_modulus = \"{:.7} MPa\"", shear_modulus_pa * 1e-6),
        Material::Yeoh { c_pa } => {
            let [c1, c2, c3] = c_pa.map(|c| c * 1e-6);
            format!("c = [\"{c1:.8} MPa\", \"{c2:.8} MPa\", \"{c3:.8} MPa\"]")
        }
    }
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed {
    law: &'static str,
    estimates: Vec<Estimate>,
    rms_pa: f64,
    tested_stretch: [f64; 2],
    softens_at_stretch: Option<f64>,
    points: Vec<Point>,
}

#[derive(Serialize)]
struct Estimate {
    name: String,
    value: f64,
    standard_deviation: f64,
    interval: [f64; 2],
}

#[derive(Serialize)]
struct Point {
    stretch: f64,
    nominal_stress_pa: f64,
    law_pa: f64,
}

fn printed(test: &Tension, fit: &TensionFit) -> Printed {
    let estimates = fit.values.iter().map(|value| Estimate {
        name: value.name.to_string(),
        value: value.value,
        standard_deviation: value.standard_deviation,
        interval: value.interval,
    });
    let points = test.points().iter().zip(&fit.modelled_pa);
    let points =
        points.map(|([stretch, stress], law)| Point { stretch: *stretch, nominal_stress_pa: *stress, law_pa: *law });
    Printed {
        law: fit.law.word(),
        estimates: estimates.collect(),
        rms_pa: fit.rms_pa,
        tested_stretch: fit.tested,
        softens_at_stretch: fit.softens_at,
        points: points.collect(),
    }
}
