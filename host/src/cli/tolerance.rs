//! `softlimb tolerance`: what do fabrication tolerances do to the tip?

use std::fmt::Write;
use std::num::NonZero;
use std::path::PathBuf;
use std::thread;

use clap::Args;
use serde_json::{Value, json};

use super::fabricate::Allowed;
use super::kept::write;
use super::{Failure, Outcome};
use softlimb_limb::Limb;
use softlimb_limb::tolerance;
use softlimb_limb::tolerance::{PhaseStatistics, Pose, Sample, Settings, Statistics, Study, Unanswerable, Varied};
use softlimb_motion as motion;
use softlimb_scene as scene;
use softlimb_scene::{WEIGHTLESS, labelled};

/// What walls, fiber angles and moduli within their tolerances do to the tip at the end of each phase
#[derive(Args)]
#[command(after_help = "Every actuator is off by its own; pressures are those of the nominal limb.\n\
                  Example: softlimb tolerance scenes/pick-and-place-a.toml --modulus 5 --svg tolerance.svg\n\n\
                  What is assumed and what the columns mean: docs/tolerance.md")]
pub(super) struct Tolerance {
    /// The scene file
    scene: PathBuf,
    #[command(flatten)]
    allowed: Allowed,
    /// All actuators of equal elastomer have one modulus, as cast from one batch [default: each its own]
    #[arg(long)]
    modulus_shared: bool,
    /// Number of limbs
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    samples: u32,
    /// Seed of the limbs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; default: as many as processors. The limbs do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Write how many limbs stay within a distance
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write the displacements of every limb in every phase, m
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl From<Unanswerable> for Failure {
    fn from(error: Unanswerable) -> Self {
        match error {
            Unanswerable::Range(error) => Self::wrong_line(error),
            error => Self::new(error),
        }
    }
}

impl Tolerance {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let limb = Limb::new(&scene)?;
        let plan = motion::plan(&scene, &limb)?;
        let pose = |phase: &motion::PlannedPhase| {
            let end_us = (phase.start_us + phase.move_us + phase.hold_us) as f64;
            let pressures_pa = plan.states_at(end_us).iter().map(|state| state.pressure_pa).collect();
            Pose { name: phase.name.clone(), pressures_pa }
        };
        let poses: Vec<Pose> = plan.phases.iter().map(pose).collect();
        let settings = Settings { tolerances: self.allowed.tolerances(), shared_modulus: self.modulus_shared };
        let study = Study::new(&limb, &poses, settings)?;
        let linear = tolerance::linear(&study)?;
        let samples = tolerance::sample(&study, &linear, self.samples as usize, self.seed, self.threads());
        let statistics = Statistics::new(&linear, &samples, limb.modules().len());
        if let Some(file) = &self.csv {
            write(file, &csv(&study, &samples))?;
        }
        if let Some(file) = &self.svg {
            write(file, &tolerance::picture(&labelled(scene.name(), true), &study, &samples))?;
        }
        let names: Vec<&str> = study.modules().collect();
        if self.json {
            super::say(&self.answer(scene.name(), &study, &statistics, &names).to_string())?;
        } else {
            super::say(&self.table(scene.name(), &study, &statistics, &names))?;
        }
        let warnings = lost(&study, &statistics, &names, samples.len());
        warnings.iter().for_each(|warning| super::note(&format!("warning: {warning}")));
        Ok(if warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn threads(&self) -> usize {
        self.threads.map_or_else(|| thread::available_parallelism().map_or(1, NonZero::get), usize::from)
    }

    fn answer(&self, scene: &str, study: &Study<'_>, statistics: &Statistics, modules: &[&str]) -> Value {
        let tolerances = self.allowed.tolerances();
        let phase = |(index, found): (usize, &PhaseStatistics)| {
            let shares = found.shares.iter().map(|share| {
                let value = json!({
                    "linear": share.linear, "sampled": share.sampled.value, "standard_error": share.sampled.error,
                });
                (name(share.varied, modules).to_owned(), value)
            });
            let lost = modules.iter().zip(&found.lost).filter(|(_, count)| **count > 0);
            json!({
                "name": study.poses()[index].name,
                "pressures_pa": study.poses()[index].pressures_pa,
                "nominal_tip_m": point(study.nominal_tip_m(index)),
                "linear_rms_m": found.linear_rms_m,
                "rms_m": found.rms_m.value,
                "rms_standard_error_m": found.rms_m.error,
                "linear_p95_m": found.p95_m[0],
                "p95_m": found.p95_m[1],
                "max_m": found.max_m,
                "mean_displacement_m": point(found.mean_m),
                "departure_m": found.departure_m,
                "linear_is_enough": found.linear_is_enough(),
                "shares": shares.collect::<serde_json::Map<_, _>>(),
                "samples": found.answered,
                "lost": lost.map(|(module, count)| ((*module).to_owned(), json!(count))).collect::<serde_json::Map<_, _>>(),
            })
        };
        json!({
            "scene": scene,
            WEIGHTLESS: true,
            "tolerances": {"wall_m": tolerances.wall_m, "angle_rad": tolerances.angle_rad, "modulus": tolerances.modulus},
            "modulus_shared": self.modulus_shared,
            "samples": self.samples,
            "seed": self.seed,
            "phases": statistics.poses.iter().enumerate().map(phase).collect::<Vec<_>>(),
        })
    }

    /// Writing to a string cannot fail.
    fn table(&self, scene: &str, study: &Study<'_>, statistics: &Statistics, modules: &[&str]) -> String {
        let mut text = String::new();
        let batch = if self.modulus_shared { "one modulus for equal elastomers" } else { "each actuator its own" };
        let scene = labelled(scene, true);
        let _ = writeln!(text, "{scene}: {}; {batch}; {} limbs, seed {}", self.allowed, self.samples, self.seed);
        let _ = writeln!(
            text,
            "\n{:16} {:>23} {:>8} {:>15} {:>8} {:>8} {:>8} {:>8}\n{:16} {:>23} {:>8} {:>15} {:>8} {:>8} {:>8} {:>8}",
            "phase",
            "nominal tip x, y, z",
            "RMS,",
            "RMS, samples",
            "95 %",
            "largest",
            "mean",
            "linear",
            "",
            "m",
            "linear",
            "mm",
            "mm",
            "mm",
            "mm",
            "off, %"
        );
        for (index, found) in statistics.poses.iter().enumerate() {
            let tip = study.nominal_tip_m(index);
            let _ = writeln!(
                text,
                "{:16} {:>23} {:8.2} {:>15} {:8.2} {:8.2} {:8.2} {:8.1}",
                study.poses()[index].name,
                // No zero has a sign.
                [tip.x, tip.y, tip.z].map(|x| format!("{:.3}", (1e3 * x).round() * 1e-3 + 0.0)).join(", "),
                1e3 * found.linear_rms_m,
                format!("{:.2} +- {:.2}", 1e3 * found.rms_m.value, 1e3 * found.rms_m.error),
                1e3 * found.p95_m[1],
                1e3 * found.max_m,
                1e3 * found.mean_m.norm(),
                100.0 * found.departure(),
            );
        }
        let _ = writeln!(text, "\nshare of the mean square, %: linear, samples");
        let _ = write!(text, "{:16}", "phase");
        let names = Varied::all(modules.len()).into_iter().map(|varied| name(varied, modules));
        names.for_each(|name| {
            let _ = write!(text, " {name:>19}");
        });
        for (pose, found) in study.poses().iter().zip(&statistics.poses) {
            let _ = write!(text, "\n{:16}", pose.name);
            for share in &found.shares {
                let sampled = format!("{:.1} +- {:.1}", 100.0 * share.sampled.value, 100.0 * share.sampled.error);
                let _ = write!(text, " {:6.1} {sampled:>12}", 100.0 * share.linear);
            }
            if found.shares.is_empty() {
                let _ = write!(text, " the tip does not move");
            }
        }
        let _ = writeln!(text, "\n\n{}", verdict(study, statistics));
        text
    }
}

fn name<'a>(varied: Varied, modules: &[&'a str]) -> &'a str {
    match varied {
        Varied::Kind(kind) => kind.word(),
        Varied::Module(index) => modules[index],
    }
}

fn point(of: nalgebra::Vector3<f64>) -> [f64; 3] {
    of.into()
}

fn verdict(study: &Study<'_>, statistics: &Statistics) -> String {
    let phases = study.poses().iter().zip(&statistics.poses);
    let short: Vec<String> =
        phases.filter(|(_, found)| !found.linear_is_enough()).map(|(pose, _)| format!("`{}`", pose.name)).collect();
    if short.is_empty() {
        "The linear route is enough in every phase: it is within a tenth of the displacement, RMS over limbs."
            .to_owned()
    } else {
        format!("The linear route is not enough in {}: take the figures of the samples.", short.join(", "))
    }
}

/// What is said of samples without an answer.
fn lost(study: &Study<'_>, statistics: &Statistics, modules: &[&str], samples: usize) -> Vec<String> {
    let phases = study.poses().iter().zip(&statistics.poses).filter(|(_, found)| found.lost_in_all() > 0);
    let say = |(pose, found): (&Pose, &PhaseStatistics)| {
        let each = modules.iter().zip(&found.lost).filter(|(_, count)| **count > 0);
        let each: Vec<String> = each.map(|(module, count)| format!("{count} at `{module}`")).collect();
        format!(
            "phase `{}`: {} of {samples} limbs have no equilibrium at the pressures of the nominal one ({}); its figures are those of the others",
            pose.name,
            found.lost_in_all(),
            each.join(", "),
        )
    };
    phases.map(say).collect()
}

fn csv(study: &Study<'_>, samples: &[Sample]) -> String {
    let names: Vec<&str> = study.modules().collect();
    let mut text = String::from("limb,phase,dx_m,dy_m,dz_m,linear_dx_m,linear_dy_m,linear_dz_m,no_equilibrium_at\n");
    for (number, sample) in samples.iter().enumerate() {
        for (pose, deviation) in study.poses().iter().zip(sample) {
            let (found, lost) = match deviation.displacement_m {
                Ok(by) => (format!("{:.9},{:.9},{:.9}", by.x, by.y, by.z), ""),
                Err(module) => (",,".to_owned(), names[module]),
            };
            let by = deviation.linear_m;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{number},{},{found},{:.9},{:.9},{:.9},{lost}", pose.name, by.x, by.y, by.z);
        }
    }
    text
}
