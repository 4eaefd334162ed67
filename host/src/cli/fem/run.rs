//! `softlimb fem run`: run CalculiX and show what it found.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::subject::{Arguments, Asked, describe, told};
use super::values::seconds;
use crate::cli::{Failure, Outcome, note, say};
use softlimb_fea::solid as fem;
use softlimb_fea::solid::{End, Model, Options, PointStatus, Runner};

/// Run CalculiX on an actuator or a bundle, and show pressure against deformation
#[derive(Args)]
#[command(after_help = "Needs CalculiX (Debian, Ubuntu: apt-get install calculix-ccx).\n\
                  Example: softlimb fem run scenes/pick-and-place-a.toml --module shoulder --pressure-kpa 60")]
pub(super) struct Run {
    #[command(flatten)]
    arguments: Arguments,
    /// The program
    #[arg(long, value_name = "PATH", default_value = "ccx")]
    ccx: PathBuf,
    /// End the run after so many seconds, 0.1 to 1000000; what had converged by then stands
    #[arg(long, value_name = "SECONDS", default_value_t = Runner::default().timeout_s, allow_negative_numbers = true,
        value_parser = seconds)]
    timeout_s: f64,
    /// Threads CalculiX may use, 1 to 64
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    threads: u32,
    /// Keep deck and output of CalculiX in this folder
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Write the deformed meshes for ParaView to this folder
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,
    /// Write the figures as tab-separated values
    #[arg(long, value_name = "FILE")]
    tsv: Option<PathBuf>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

impl Run {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let Asked { name, subject, options, pressures_pa } = self.arguments.read()?;
        let options = Options { all_nodes: self.vtu.is_some(), ..options };
        note(&describe(&Model::new(&subject, &options).map_err(told)?));
        let runner =
            Runner { ccx: self.ccx.clone(), timeout_s: self.timeout_s, threads: self.threads, keep: self.keep.clone() };
        let bar = bar();
        let begin = Instant::now();
        let clock = || begin.elapsed().as_secs_f64();
        let found = fem::run(&subject, &options, &pressures_pa, &runner, &clock, &mut |now| {
            bar.set_position((1e3 * now.share) as u64);
            bar.set_message(format!("{} increments, {} iterations", now.increments, now.iterations));
        });
        bar.finish_and_clear();
        let found = found?;
        let warnings = warnings(&found);
        if found.points.iter().all(|point| point.middle.is_none()) {
            return Err(nothing(&found));
        }
        // Before any file that may not be written: the figures took their time.
        say(&if self.json { figures(&name, &found).to_string() } else { found.table() })?;
        warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
        if let Some(file) = &self.tsv {
            softlimb_files::write_whole(file, &found.tsv()).map_err(Failure::new)?;
            note(&format!("wrote {}", file.display()));
        }
        if let Some(folder) = &self.vtu {
            note(&format!("wrote {}", found.write_vtu(folder, &name)?.display()));
        }
        Ok(if warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}

/// Why a run has no figures: how far it came, and what ended it.
fn nothing(run: &fem::Run) -> Failure {
    let first = run.points[0];
    let kpa = |pa: f64| format!("{:.3} kPa", 1e-3 * pa);
    let asked = format!("the first pressure asked for, {}", kpa(first.pressure_pa));
    let found = match first.status {
        PointStatus::NotReached { reached_pa } if reached_pa > 0.0 => {
            format!(
                "the run ended at {}, before {asked} (more --points have figures on the way there)",
                kpa(reached_pa)
            )
        }
        PointStatus::BeyondJump { between_pa: [low, high] } => {
            format!(
                "the lumen grew abruptly between {} and {}, before {asked}: a limit point is near",
                kpa(low),
                kpa(high)
            )
        }
        _ => "no increment converged".to_owned(),
    };
    Failure::new(cause(run).map_or(found.clone(), |cause| format!("{found}: {cause}")))
}

/// What ended a run before the end of the load.
fn cause(run: &fem::Run) -> Option<String> {
    match &run.end {
        End::Finished => None,
        End::Diverged { diagnosis, .. } => Some(format!("CalculiX stopped before the end of the load: {diagnosis}")),
        End::TimedOut => Some("the time was up before the end of the load".to_owned()),
    }
}

/// What is missing or doubtful.
fn warnings(run: &fem::Run) -> Vec<String> {
    let mut warnings = run.model.warnings().to_vec();
    warnings.extend(cause(run));
    if run.points.iter().any(|point| matches!(point.status, PointStatus::BeyondJump { .. })) {
        warnings.push("pressures behind an abrupt growth have no figures; try smaller increments".to_owned());
    }
    warnings
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    let style = ProgressStyle::with_template("ccx [{bar:40}] {percent:>3} %  {elapsed_precise}  {msg}");
    bar.set_style(style.map_or_else(|_| ProgressStyle::default_bar(), |style| style.progress_chars("=> ")));
    bar
}

fn figures(name: &str, run: &fem::Run) -> Value {
    let points = run.points.iter().map(|point| {
        json!({
            "pressure_pa": point.pressure_pa, "status": point.status.word(), "seconds": point.seconds,
            "middle": point.middle.map(|middle| json!({
                "axial_stretch": middle.axial_stretch, "outer_radius_m": middle.outer_radius_m,
                "inner_radius_m": middle.inner_radius_m, "twist_rate_rad_per_m": middle.twist_rate_rad_per_m,
                "bend_rate_rad_per_m": middle.bend_rate_rad_per_m,
            })),
            "ends": point.ends.map(|ends| json!({
                "axial_stretch": ends.axial_stretch, "twist_rad": ends.twist_rad, "bend_angle_rad": ends.bend_angle_rad,
            })),
        })
    });
    let end = match &run.end {
        End::Finished => "finished",
        End::Diverged { .. } => "diverged",
        End::TimedOut => "timed_out",
    };
    json!({
        "name": name, "end": end, "seconds": run.seconds, "increments": run.increments, "iterations": run.iterations,
        "nodes": run.model.nodes(), "thread_spacing_m": run.model.thread_spacing_m(), "points": points.collect::<Vec<_>>(),
    })
}
