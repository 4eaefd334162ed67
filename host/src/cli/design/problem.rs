//! One problem: its answer as JSON or text, or eq. (14) at given points of it.

use std::fmt::Write;
use std::io::{BufRead, ErrorKind, Write as _, stdin, stdout};

use serde_json::json;

use crate::cli::{Failure, Outcome, say};
use softlimb_design::actuators::{Answer, Objective, Problem, SegmentAnswer};

/// Prints an answer.
pub(super) fn show(answer: &Answer, as_json: bool) -> Result<Outcome, Failure> {
    if as_json {
        say(&serde_json::to_string(answer).map_err(Failure::new)?)?;
    } else {
        say(&table(answer))?;
    }
    Ok(Outcome::Done)
}

/// Answers points of the unit box, one JSON array of numbers a line, with eq. (14), one JSON object a line.
pub(super) fn evaluate(problem: &Problem) -> Result<Outcome, Failure> {
    let mut objective = Objective::new(problem);
    let mut out = stdout().lock();
    for (index, line) in stdin().lock().lines().enumerate() {
        let line = line.map_err(|error| Failure::new(format!("cannot read standard input: {error}")))?;
        let point = point(&line, objective.width());
        let point = point.map_err(|message| Failure::new(format!("standard input, line {}: {message}", index + 1)))?;
        let differences = objective.differences(&point);
        let sum = differences.as_ref().map(|all| all.iter().map(|one| one * one).sum::<f64>());
        let answer = json!({"objective": sum, "differences": differences});
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
        "\n{}: inner radius {:.4} mm, outer radius {:.4} mm, length {:.3} mm, fiber angle {:.3} deg",
        segment.name,
        segment.inner_radius_m * 1e3,
        segment.outer_radius_m * 1e3,
        segment.length_m * 1e3,
        segment.angle_deg
    );
    let active = if segment.active_bounds.is_empty() { "none".into() } else { segment.active_bounds.join(", ") };
    let condition = segment.condition.map_or("-".into(), |value| format!("{value:.3}"));
    let starts = segment.starts;
    let _ = writeln!(
        text,
        "  active bounds: {active}; condition {condition}; {} of {} starts agree",
        starts.agreeing, starts.made
    );
    let _ = writeln!(text, "{:>12} {:>14} {:>14} {:>12}", "kPa", "target", "found", "difference");
    for phase in &segment.phases {
        let target = phase.target.map_or("-".into(), |value| format!("{value:.6}"));
        let bound = phase.bound.unwrap_or_default();
        let _ = writeln!(
            text,
            "{:12.3} {target:>14} {:14.6} {:12.3e} {bound}",
            phase.pressure_pa * 1e-3,
            phase.found,
            phase.residual
        );
    }
}
