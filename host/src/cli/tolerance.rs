//! `softlimb tolerance`: displacement of the tip by fabrication tolerances.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::fabricate::Allowed;
use super::shared::{limb, show_of, threads, write_if};
use super::{Failure, Outcome, warn};
use softlimb_chart::labelled;
use softlimb_limb::fabricate::Tolerances;
use softlimb_limb::tolerance;
use softlimb_limb::tolerance::{PhaseStatistics, Pose, Sample, Settings, Statistics, Study, ToleranceError, Varied};
use softlimb_motion as motion;

/// Displacement of the tip by tolerances of walls, fiber angles and moduli, at the end of each phase
#[derive(Args)]
#[command(after_help = "Every actuator has its own deviations; pressures are those of the nominal limb.\n\
                  Assumptions and columns: docs/explanation/tolerance.md\n\n\
                  Example: softlimb tolerance scenes/pick-and-place-a.toml --modulus 5 --svg tolerance.svg")]
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
    /// Threads; the limbs do not depend on it [default: one for each processor]
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

impl From<ToleranceError> for Failure {
    fn from(error: ToleranceError) -> Self {
        match error {
            ToleranceError::Range(error) => Self::wrong_line(error),
            error => Self::new(error),
        }
    }
}

impl Tolerance {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        scene.require_no_segments("`tolerance`")?;
        let wall = &self.allowed.wall;
        for module in limb.modules() {
            let parameters = module.actuator.parameters();
            let thickness_m = parameters.outer_radius_m - parameters.inner_radius_m;
            if wall.si() >= thickness_m {
                let (name, most) = (&module.name, wall.shown(thickness_m));
                let text = format!("--wall {wall} is not allowed: less than the wall of `{name}`, {most}");
                return Err(Failure::wrong_line(text));
            }
        }
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
        let samples = tolerance::sample(&study, &linear, self.samples as usize, self.seed, threads(self.threads));
        let statistics = Statistics::new(&linear, &samples, limb.modules().len());
        write_if(self.csv.as_ref(), || csv(&study, &samples))?;
        write_if(self.svg.as_ref(), || tolerance::picture(&labelled(scene.name(), true), &study, &samples))?;
        let names: Vec<&str> = study.modules().collect();
        show_of(self.json, &limb, &self.printed(scene.name(), &study, &statistics, &names), || {
            self.table(scene.name(), &study, &statistics, &names)
        })?;
        Ok(warn(&lost(&study, &statistics, &names, samples.len())))
    }

    fn printed<'a>(
        &self,
        scene: &'a str,
        study: &'a Study<'_>,
        statistics: &Statistics,
        modules: &[&'a str],
    ) -> Printed<'a> {
        let phase = |(pose, (index, found)): (&'a Pose, (usize, &PhaseStatistics))| {
            let shares = found.shares.iter().map(|share| {
                let (sampled, standard_error) = (share.sampled.value, share.sampled.error);
                (name(share.varied, modules), PrintedShare { linear: share.linear, sampled, standard_error })
            });
            let lost = modules.iter().zip(&found.lost).filter(|(_, count)| **count > 0);
            PrintedPhase {
                name: &pose.name,
                pressures_pa: &pose.pressures_pa,
                nominal_tip_m: study.nominal_tip_m(index).into(),
                linear_rms_m: found.linear_rms_m,
                rms_m: found.rms_m.value,
                rms_standard_error_m: found.rms_m.error,
                linear_p95_m: found.p95_m[0],
                p95_m: found.p95_m[1],
                max_m: found.max_m,
                mean_displacement_m: found.mean_m.into(),
                departure_m: found.departure_m,
                linear_is_enough: found.linear_is_enough(),
                shares: shares.collect(),
                samples: found.answered,
                lost: lost.map(|(module, count)| (*module, *count)).collect(),
            }
        };
        let Tolerances { wall_m, angle_rad, modulus } = self.allowed.tolerances();
        Printed {
            scene,
            weightless: true,
            tolerances: PrintedTolerances { wall_m, angle_rad, modulus },
            modulus_shared: self.modulus_shared,
            samples: self.samples,
            seed: self.seed,
            phases: study.poses().iter().zip(statistics.poses.iter().enumerate()).map(phase).collect(),
        }
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

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    weightless: bool,
    tolerances: PrintedTolerances,
    modulus_shared: bool,
    samples: u32,
    seed: u64,
    phases: Vec<PrintedPhase<'a>>,
}

#[derive(Serialize)]
struct PrintedTolerances {
    wall_m: f64,
    angle_rad: f64,
    modulus: f64,
}

#[derive(Serialize)]
struct PrintedPhase<'a> {
    name: &'a str,
    pressures_pa: &'a [f64],
    nominal_tip_m: [f64; 3],
    linear_rms_m: f64,
    rms_m: f64,
    rms_standard_error_m: f64,
    linear_p95_m: f64,
    p95_m: f64,
    max_m: f64,
    mean_displacement_m: [f64; 3],
    departure_m: f64,
    linear_is_enough: bool,
    shares: BTreeMap<&'a str, PrintedShare>,
    samples: usize,
    lost: BTreeMap<&'a str, usize>,
}

#[derive(Serialize)]
struct PrintedShare {
    linear: f64,
    sampled: f64,
    standard_error: f64,
}

fn name<'a>(varied: Varied, modules: &[&'a str]) -> &'a str {
    match varied {
        Varied::Kind(kind) => kind.word(),
        Varied::Module(index) => modules[index],
    }
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

/// Text about samples without an answer.
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
