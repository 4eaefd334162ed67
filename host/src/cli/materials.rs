//! `softlimb materials`: castable elastomers by trade name, and the laws of a lab's own tensile tests.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::calibrate::coefficients;
use super::shared::{about, read, show, write_if};
use super::{Failure, Outcome, warn};
use softlimb_files::table::Table;
use softlimb_rig::calibrate::{RangeFit, Tension, fit_range, range_picture};
use softlimb_scene::{TENSILE_TESTS, castable_elastomer};

/// Largest root mean square and largest single residual of a law in its range, as the texts state them.
const BOUNDS: &str = "5 % rms and 10 % at each reading";

/// List castable elastomers that scenes may name, or fit the laws of tensile tests
#[derive(Args)]
#[command(
    after_help = "A scene, `eval` and `design` take these names as `material`. Each law is a Yeoh law of a virgin specimen: the first stretch. Cycled, the\n\
                  elastomer is softer. Method and source: docs/guide/choose-an-elastomer.md\n\n\
                  Examples:\n  softlimb materials\n  softlimb materials \"Dragon Skin 30\" --svg dragon-skin-30.svg\n  \
                  softlimb materials --file my-tests.csv"
)]
pub(super) struct Materials {
    /// One of them, with its readings and its table for a scene
    name: Option<String>,
    /// Tensile tests of your own: a CSV file with stretch or strain, nominal_stress_pa, _kpa or _mpa, and material where it has several
    #[arg(long, value_name = "CSV")]
    file: Option<PathBuf>,
    /// Draw the readings and the law of one
    #[arg(long, value_name = "FILE", requires = "name")]
    svg: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// A test and its law, where it has one.
struct Tested {
    name: String,
    test: Tension,
    fit: Option<RangeFit>,
}

impl Materials {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let mut all: Vec<Tested> = tests(self.file.as_deref())?
            .into_iter()
            .map(|(name, test)| Tested { fit: fit_range(&test), name, test })
            .collect();
        all.sort_by(|a, b| a.name.cmp(&b.name));
        if let Some(name) = &self.name {
            all.retain(|tested| tested.name == *name);
            let Some(one) = all.first() else { return Err(unknown(name, self.file.as_deref())) };
            write_if(self.svg.as_ref(), || range_picture(&one.name, &one.test, one.fit.as_ref()))?;
        }
        let printed: Vec<Printed<'_>> = all.iter().map(|tested| tested.printed(self.name.is_some())).collect();
        show(self.json, &printed, || {
            if self.name.is_some() { all.iter().map(Tested::whole).collect() } else { table(&all) }
        })?;
        let lawless = all.iter().filter(|tested| tested.fit.is_none());
        let warnings: Vec<String> = lawless
            .map(|tested| format!("no Yeoh law describes `{}` to twice its length within {BOUNDS}", tested.name))
            .collect();
        Ok(warn(&warnings))
    }
}

/// Tensile tests with the names of their materials: those of the library or of a file. A file without names has one test, named after the file.
fn tests(file: Option<&Path>) -> Result<Vec<(String, Tension)>, Failure> {
    let Some(file) = file else { return Tension::read_by_name(TENSILE_TESTS).map_err(Failure::new) };
    let text = read(file)?;
    let has_names = Table::cut(&text).is_ok_and(|table| table.place("material").is_some());
    if has_names {
        return Tension::read_by_name(&text).map_err(|error| about(file)(&error));
    }
    let test = Tension::read(&text, None).map_err(|error| about(file)(&error))?;
    let name = file.file_stem().map_or_else(|| "elastomer".into(), |name| name.to_string_lossy().into_owned());
    Ok(vec![(name, test)])
}

fn unknown(name: &str, file: Option<&Path>) -> Failure {
    let help = match file {
        Some(file) => format!("{} has no such material", file.display()),
        None => castable_elastomer(name).err().unwrap_or_default(),
    };
    Failure::wrong_line(format!("unknown elastomer \"{name}\": {help}"))
}

fn table(all: &[Tested]) -> String {
    let widest = all.iter().map(|tested| tested.name.chars().count()).fold(8, usize::max);
    let mut text = format!(
        "{:<widest$}  {:>9}  {:>34}  {:>11}  {:>11}",
        "material", "mu, kPa", "Yeoh C1, C2, C3, Pa", "strain, %", "rms, most, %"
    );
    for Tested { name, fit, .. } in all {
        let Some(fit) = fit else {
            let _ = write!(text, "\n{name:<widest$}  no law");
            continue;
        };
        let [c1, c2, c3] = fit.c_pa;
        let [low, high] = fit.stretch.map(|stretch| 100.0 * (stretch - 1.0));
        let _ = write!(
            text,
            "\n{name:<widest$}  {:>9.2}  {:>34}  {:>11}  {:>12}",
            2e-3 * c1,
            format!("{c1:.1}, {c2:.2}, {c3:.3}"),
            format!("{low:.0} to {high:.0}"),
            format!("{:.1}, {:.1}", 100.0 * fit.rms, 100.0 * fit.worst),
        );
    }
    text
}

impl Tested {
    /// The table for a scene, and the readings beside the law.
    fn whole(&self) -> String {
        let mut text = String::new();
        if let Some(fit) = &self.fit {
            let _ = writeln!(
                text,
                "[materials.{}]\nlaw = \"yeoh\"\n{}\nstretch_max = {}\n",
                key(&self.name),
                coefficients(&fit.material()),
                fit.stretch[1]
            );
        }
        let _ = write!(text, "stretch  measured, kPa  law, kPa  error, %");
        for [stretch, stress_pa] in self.test.points() {
            let _ = write!(text, "\n{stretch:7.3}  {:13.3}", 1e-3 * stress_pa);
            if let Some(fit) = &self.fit {
                let law_pa = fit.stress_pa(*stretch);
                let outside =
                    if (fit.stretch[0]..=fit.stretch[1]).contains(stretch) { "" } else { "  outside the range" };
                let _ = write!(text, "  {:8.3}  {:8.1}{outside}", 1e-3 * law_pa, 100.0 * (law_pa / stress_pa - 1.0));
            }
        }
        text
    }

    fn printed(&self, with_readings: bool) -> Printed<'_> {
        let readings = self.test.points().iter().map(|[stretch, stress_pa]| Reading {
            stretch: *stretch,
            nominal_stress_pa: *stress_pa,
            law_pa: self.fit.as_ref().map(|fit| fit.stress_pa(*stretch)),
        });
        Printed {
            name: &self.name,
            law: self.fit.as_ref().map(|fit| Law {
                law: "yeoh",
                c_pa: fit.c_pa,
                stretch: fit.stretch,
                rms: fit.rms,
                worst: fit.worst,
            }),
            readings: with_readings.then(|| readings.collect()),
        }
    }
}

/// A name for a table of a scene: letters, digits and dashes.
fn key(name: &str) -> String {
    let plain = name.to_lowercase().replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    let plain = plain.trim_matches('-');
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain.into() } else { format!("material-{plain}") }
}

/// A row of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    name: &'a str,
    #[serde(flatten)]
    law: Option<Law>,
    #[serde(skip_serializing_if = "Option::is_none")]
    readings: Option<Vec<Reading>>,
}

#[derive(Serialize)]
struct Law {
    law: &'static str,
    c_pa: [f64; 3],
    /// Least and largest stretch that the law describes.
    stretch: [f64; 2],
    /// Root mean square and largest of the relative residuals.
    rms: f64,
    worst: f64,
}

#[derive(Serialize)]
struct Reading {
    stretch: f64,
    nominal_stress_pa: f64,
    law_pa: Option<f64>,
}
