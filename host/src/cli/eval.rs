//! `softlimb eval`: the actuator model alone.

use std::fmt::Write;
use std::fs::File;
use std::io::{self, BufReader, stdin, stdout};
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args, ValueEnum};
use serde::Serialize;

use super::shared::{limb, show};
use super::{Failure, Outcome};
use crate::query as eval;
use crate::query::{Curve, Scalar};
use crate::results::bend::{PrintedBend, of_limb, of_segments, rows};

/// Evaluate the actuator model: pressure curves of a scene's actuators, or a batch of queries
#[derive(Args)]
#[command(
    group = ArgGroup::new("question").required(true).args(["scene", "batch"]),
    after_help = "Format of queries and answers: docs/reference/eval-batch.md\n\nExamples:\n  \
                  softlimb eval scenes/single-bending.toml\n  softlimb eval --batch queries.jsonl --scalar f32"
)]
pub(super) struct Eval {
    /// The scene of the actuators
    scene: Option<PathBuf>,
    /// A file of queries, one JSON object a line (`-` for standard input)
    #[arg(long, value_name = "FILE")]
    batch: Option<PathBuf>,
    /// Precision of a batch; that of finite elements is double
    #[arg(long, value_enum, default_value_t = ScalarName::F64, conflicts_with = "scene")]
    scalar: ScalarName,
    /// Steps of a pressure curve
    #[arg(long, default_value_t = 10, conflicts_with = "batch", value_parser = clap::value_parser!(u16).range(1..=1000))]
    steps: u16,
    /// Print curves as JSON
    #[arg(long, conflicts_with = "batch")]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum ScalarName {
    /// Double precision, as on the host
    F64,
    /// Single precision, as on the MCU
    F32,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    curves: &'a [Curve],
    /// The model of each module's bend; `null` of straight modules and of benders with an ideal winding.
    bends: Vec<Option<PrintedBend>>,
    /// Those of the segments of each module; `null` of a module without.
    segment_bends: Vec<Option<Vec<Option<PrintedBend>>>>,
    warnings: &'a [String],
}

impl Eval {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match (&self.scene, &self.batch) {
            (_, Some(file)) => self.answer_batch(file),
            (Some(scene), None) => self.print_curves(scene),
            (None, None) => Err(Failure::new("give a scene or --batch FILE")),
        }
    }

    fn answer_batch(&self, file: &Path) -> Result<Outcome, Failure> {
        let scalar = match self.scalar {
            ScalarName::F64 => Scalar::F64,
            ScalarName::F32 => Scalar::F32,
        };
        let done = if file == Path::new("-") {
            eval::batch(stdin().lock(), stdout().lock(), scalar)
        } else {
            let input = File::open(file).map_err(|error| Failure::file("read", file, &error))?;
            eval::batch(BufReader::new(input), stdout().lock(), scalar)
        };
        match done {
            Ok(()) => Ok(Outcome::Done),
            // A reader that has seen enough is no failure.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(Outcome::Done),
            Err(error) => Err(Failure::file("answer", file, &error)),
        }
    }

    fn print_curves(&self, path: &Path) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(path)?;
        let curves = eval::curves(&limb, usize::from(self.steps));
        let warnings = limb.winding_warnings(&scene);
        let bends = of_limb(&limb);
        let segment_bends = limb.modules().iter().map(of_segments).collect();
        let printed = Printed { scene: scene.name(), curves: &curves, bends, segment_bends, warnings: &warnings };
        show(self.json, &printed, || {
            let tables = curves.iter().map(table).collect::<Vec<_>>().join("\n");
            rows(&limb).into_iter().fold(tables, |text, row| format!("{text}{row}\n"))
        })?;
        let complete = curves.iter().all(|curve| curve.limit_pressure_pa.is_none());
        let outcome = super::warn(&warnings);
        Ok(if complete { outcome } else { Outcome::DoneWithWarnings })
    }
}

/// A curve as a table, every line of it ended. Writing to a string cannot fail.
fn table(curve: &Curve) -> String {
    let mut text = format!("{}: {} ({})\n", curve.module, curve.motion, curve.equations);
    for [p, stretch, radius, twist, bend, volume] in
        [["pressure", "stretch", "outer r", "twist", "bend", "volume"], ["kPa", "", "mm", "deg", "deg", "mL"]]
    {
        let _ = writeln!(text, "{p:>12} {stretch:>10} {radius:>12} {twist:>12} {bend:>12} {volume:>10}");
    }
    for point in &curve.points {
        let _ = writeln!(
            text,
            "{:12.3} {:10.5} {:12.4} {:12.3} {:12.3} {:10.2}",
            point.pressure_pa * 1e-3,
            point.axial_stretch,
            point.outer_radius_m * 1e3,
            point.twist_rad.to_degrees(),
            point.bend_angle_rad.to_degrees(),
            point.volume_m3 * 1e6,
        );
    }
    if let Some(limit) = curve.limit_pressure_pa {
        let _ = writeln!(text, "   warning: the branch ends at its limit point, {:.3} kPa", limit * 1e-3);
    }
    text
}
