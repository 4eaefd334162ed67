//! `softlimb fea run`: run CalculiX and show what it found.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::subject::{Arguments, Asked, describe};
use crate::cli::shared::{bar, quantity, show, write_if};
use crate::cli::{Failure, Outcome, note, warn};
use softlimb_fea::solid as fem;
use softlimb_fea::solid::{End, Model, Options, PointStatus, Runner};
use softlimb_scene::Quantity;

/// Run CalculiX on an actuator or a bundle, and show pressure against deformation
#[derive(Args)]
#[command(after_help = "Needs CalculiX (Debian, Ubuntu: apt-get install calculix-ccx).\n\
                  Example: softlimb fea run scenes/pick-and-place-a.toml --module shoulder --pressure 60kPa")]
pub(super) struct Run {
    #[command(flatten)]
    arguments: Arguments,
    /// The program
    #[arg(long, value_name = "PATH", default_value = "ccx")]
    ccx: PathBuf,
    /// Time after which CalculiX is ended, 0.1 to 1e6 s; results converged by then are kept
    #[arg(long, value_name = "SECONDS", default_value = "1800 s", value_parser = quantity("s", 0.1, 1e6))]
    timeout: Quantity,
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
        note(&describe(&Model::new(&subject, &options).map_err(|error| self.arguments.refused(error))?));
        let (ccx, timeout_s, keep) = (self.ccx.clone(), self.timeout.si(), self.keep.clone());
        let runner = Runner { ccx, timeout_s, threads: self.threads, keep };
        let bar = bar(1000, "ccx");
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
        show(self.json, &figures(&name, &found), || found.table())?;
        let outcome = warn(&warnings);
        write_if(self.tsv.as_ref(), || found.tsv())?;
        if let Some(folder) = &self.vtu {
            note(&format!("wrote {}", found.write_vtu(folder, &name)?.display()));
        }
        Ok(outcome)
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

/// Cause of an end of a run before the end of the load.
fn cause(run: &fem::Run) -> Option<String> {
    match &run.end {
        End::Finished => None,
        End::Diverged { diagnosis, .. } => Some(format!("CalculiX stopped before the end of the load: {diagnosis}")),
        End::TimedOut => Some("the time was up before the end of the load".to_owned()),
    }
}

/// Missing or doubtful results.
fn warnings(run: &fem::Run) -> Vec<String> {
    let mut warnings = run.model.warnings().to_vec();
    warnings.extend(cause(run));
    if run.points.iter().any(|point| matches!(point.status, PointStatus::BeyondJump { .. })) {
        warnings.push("pressures behind an abrupt growth have no figures; try smaller increments".to_owned());
    }
    warnings
}

/// The result of `--json`.
#[derive(Serialize)]
struct Figures<'a> {
    name: &'a str,
    end: &'static str,
    seconds: f64,
    increments: u32,
    iterations: u32,
    nodes: usize,
    thread_spacing_m: Option<f64>,
    points: Vec<Point>,
}

#[derive(Serialize)]
struct Point {
    pressure_pa: f64,
    status: &'static str,
    seconds: Option<f64>,
    middle: Option<Middle>,
    ends: Option<Ends>,
}

/// Deformation in the middle of the actuator.
#[derive(Serialize)]
struct Middle {
    axial_stretch: f64,
    outer_radius_m: f64,
    inner_radius_m: f64,
    twist_rate_rad_per_m: f64,
    bend_rate_rad_per_m: f64,
}

/// Deformation from end to end.
#[derive(Serialize)]
struct Ends {
    axial_stretch: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
}

fn figures<'a>(name: &'a str, run: &fem::Run) -> Figures<'a> {
    let points = run.points.iter().map(|point| Point {
        pressure_pa: point.pressure_pa,
        status: point.status.word(),
        seconds: point.seconds,
        middle: point.middle.map(|middle| Middle {
            axial_stretch: middle.axial_stretch,
            outer_radius_m: middle.outer_radius_m,
            inner_radius_m: middle.inner_radius_m,
            twist_rate_rad_per_m: middle.twist_rate_rad_per_m,
            bend_rate_rad_per_m: middle.bend_rate_rad_per_m,
        }),
        ends: point.ends.map(|ends| Ends {
            axial_stretch: ends.axial_stretch,
            twist_rad: ends.twist_rad,
            bend_angle_rad: ends.bend_angle_rad,
        }),
    });
    Figures {
        name,
        end: match &run.end {
            End::Finished => "finished",
            End::Diverged { .. } => "diverged",
            End::TimedOut => "timed_out",
        },
        seconds: run.seconds,
        increments: run.increments,
        iterations: run.iterations,
        nodes: run.model.nodes(),
        thread_spacing_m: run.model.thread_spacing_m(),
        points: points.collect(),
    }
}
