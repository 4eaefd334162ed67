//! `softlimb design actuators`: geometry and pressures for target deformations, eq. (14), or its terms at given points.

use std::fmt::Write;
use std::io::{BufRead, ErrorKind, Write as _, stdin, stdout};
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::candidates::angles;
use crate::cli::shared::{about, read, show};
use crate::cli::{Failure, Outcome, warn};
use crate::results::bend::two_degrees;
use softlimb_design::actuators::{Answer, Budget, Objective, PhaseAnswer, Problem, SegmentAnswer, solve};
use softlimb_fea::cross_section::BEND_TOLERANCE;

/// Find geometry and pressures for target deformations, eq. (14) of the paper
#[derive(Args)]
#[command(after_help = "Format of problems and answers: docs/reference/actuator-problem.md\n\n\
                        Example: softlimb design actuators reach.json --json")]
pub(super) struct Actuators {
    /// The problem, a JSON file
    #[arg(value_name = "FILE")]
    problem: PathBuf,
    #[command(flatten)]
    search: Search,
    /// Evaluate points of the unit box from standard input, one JSON array a line, in place of a search
    #[arg(long, conflicts_with_all = ["json", "starts", "seed"])]
    evaluate: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Options of the search of eq. (14).
#[derive(Args)]
pub(super) struct Search {
    /// Seed of the starts of the search
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Most local solves of the search for target deformations
    #[arg(long, value_name = "N", default_value_t = Budget::default().starts as u32, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
}

impl Search {
    pub(super) fn solve(&self, problem: &Problem) -> Result<Answer, Failure> {
        let default = Budget::default();
        let starts = self.starts as usize;
        // More starts than usual are a wish for more search: no bound but theirs then.
        let evaluations = if starts > default.starts { u64::MAX } else { default.evaluations };
        let effort = Budget { seed: self.seed, starts, agreeing: default.agreeing.max(starts / 8), evaluations };
        solve(problem, &effort).map_err(Failure::new)
    }
}

impl Actuators {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let problem = Problem::read(&read(&self.problem)?).map_err(|error| about(&self.problem)(&error))?;
        if self.evaluate {
            return evaluate(&problem);
        }
        let answer = self.search.solve(&problem)?;
        show(self.json, &answer, || table(&answer))?;
        let doubt = answer.disagreeing_starts().map(|starts| {
            format!(
                "{} of {} local solves agree on the least objective: there may be a better design; search longer with --starts",
                starts.agreeing, starts.made
            )
        });
        Ok(warn(&[short(&answer), doubt.into_iter().collect()].concat()))
    }
}

/// A line for each wound bender whose bends miss their targets by more than the error of a bend that is accepted, or whose model is in doubt.
pub(super) fn short(answer: &Answer) -> Vec<String> {
    let line = |segment: &SegmentAnswer| {
        let (bend, name) = (segment.bend?, &segment.name);
        let missed = segment.phases.iter().filter_map(|phase| {
            let off = phase.residual / phase.target?.max(f64::MIN_POSITIVE);
            (off.abs() > BEND_TOLERANCE).then_some((phase, off))
        });
        let farthest = missed.max_by(|(a, _), (b, _)| a.residual.abs().total_cmp(&b.residual.abs()));
        let (kpa, is_analytic) = (|phase: &PhaseAnswer| phase.pressure_pa * 1e-3, bend.model == "analytic");
        match farthest {
            Some((phase, off)) if !is_analytic => Some(format!(
                "finite elements bend `{name}` to {:.3} rad at {:.2} kPa, {:.1} % {} its target of {:.3} rad",
                phase.found,
                kpa(phase),
                100.0 * off.abs(),
                if off < 0.0 { "short of" } else { "beyond" },
                phase.target?,
            )),
            _ if is_analytic && bend.analytic_error.is_none_or(|error| error > BEND_TOLERANCE) => Some(format!(
                "finite elements have no bends of `{name}`: those of the analytic model are not confirmed"
            )),
            _ => None,
        }
    };
    answer.segments.iter().filter_map(line).collect()
}

/// The objective of eq. (14) at a point; null where the model has no equilibrium.
#[derive(Serialize)]
struct Evaluation {
    differences: Option<Vec<f64>>,
    objective: Option<f64>,
}

/// Answers points of the unit box, one JSON array of numbers a line, with eq. (14), one JSON object a line.
fn evaluate(problem: &Problem) -> Result<Outcome, Failure> {
    let mut objective = Objective::new(problem);
    let mut out = stdout().lock();
    for (index, line) in stdin().lock().lines().enumerate() {
        let line = line.map_err(|error| Failure::new(format!("cannot read standard input: {error}")))?;
        let point = point(&line, objective.width());
        let point = point.map_err(|message| Failure::new(format!("standard input, line {}: {message}", index + 1)))?;
        let differences = objective.differences(&point);
        let sum = differences.as_ref().map(|all| all.iter().map(|one| one * one).sum::<f64>());
        let answer = serde_json::to_string(&Evaluation { objective: sum, differences }).map_err(Failure::new)?;
        match writeln!(out, "{answer}").and_then(|()| out.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => break,
            Err(error) => return Err(Failure::new(format!("cannot write to standard output: {error}"))),
            Ok(()) => {}
        }
    }
    Ok(Outcome::Done)
}

/// A point of the box, or what is wrong with it.
fn point(line: &str, width: usize) -> Result<Vec<f64>, String> {
    let point: Vec<f64> = serde_json::from_str(line).map_err(|error| format!("no array of numbers: {error}"))?;
    if point.len() != width {
        return Err(format!(
            "[{} numbers] is not allowed: {width}, those of the geometries and a share for each pressure",
            point.len()
        ));
    }
    match point.iter().position(|x| !(0.0..=1.0).contains(x)) {
        Some(axis) => Err(format!("[{axis}] = {} is not allowed: 0 to 1", point[axis])),
        None => Ok(point),
    }
}

/// The answer as text. Writing to a string cannot fail.
pub(super) fn table(answer: &Answer) -> String {
    let mut text = format!("{}: objective {:.6e}\n", answer.status.replace('_', " "), answer.objective);
    let terms = &answer.terms;
    let _ = writeln!(
        text,
        "terms: length {:.3e}, outer radius {:.3e}, bend angle {:.3e}, twist {:.3e}",
        terms.length, terms.outer_radius, terms.bend_angle, terms.twist
    );
    if let Some(effort) = terms.effort {
        let _ = writeln!(text, "effort {effort:.3e}");
    }
    answer.segments.iter().for_each(|segment| one(&mut text, segment));
    let cost = &answer.cost;
    let _ = writeln!(
        text,
        "\ncost: {} model solves, {} derivatives, {} evaluations",
        cost.solves, cost.derivatives, cost.evaluations
    );
    text
}

fn one(text: &mut String, segment: &SegmentAnswer) {
    let _ = writeln!(
        text,
        "\n{}: inner radius {:.4} mm, outer radius {:.4} mm, length {:.3} mm, fiber {}",
        segment.name,
        segment.inner_radius_m * 1e3,
        segment.outer_radius_m * 1e3,
        segment.length_m * 1e3,
        angles(segment.angle_deg, segment.windings_deg.iter().copied())
    );
    let active = if segment.active_bounds.is_empty() { "none".into() } else { segment.active_bounds.join(", ") };
    let condition = segment.condition.map_or("-".into(), |value| format!("{value:.3}"));
    let starts = segment.starts;
    let _ = writeln!(
        text,
        "  active bounds: {active}; condition {condition}; {} of {} local solves agree",
        starts.agreeing, starts.made
    );
    let is_by_section = segment.bend.is_some_and(|bend| bend.model != "analytic");
    if let Some(bend) = segment.bend {
        let errs =
            bend.analytic_error.map_or("is not known".into(), |error| format!("is up to {:.1} %", 100.0 * error));
        let model = if is_by_section { "finite elements" } else { "the analytic model" };
        let off = bend.winding_2deg.map_or(String::new(), two_degrees);
        let _ = writeln!(text, "  bends by {model}; the error of the analytic model {errs}{off}");
    }
    let last = if is_by_section { "       analytic" } else { "" };
    let _ = writeln!(text, "{:>12} {:>14} {:>14} {:>12}{last}", "kPa", "target", "found", "difference");
    for phase in &segment.phases {
        let target = phase.target.map_or("-".into(), |value| format!("{value:.6}"));
        let bound = phase.bound.unwrap_or_default();
        let analytic = match phase.analytic {
            Some(bend) => format!("{bend:14.6} "),
            None if is_by_section => format!("{:>14} ", "-"),
            None => String::new(),
        };
        let _ = writeln!(
            text,
            "{:12.3} {target:>14} {:14.6} {:12.3e} {analytic}{bound}",
            phase.pressure_pa * 1e-3,
            phase.found,
            phase.residual
        );
    }
}
