//! `softlimb design`: from target deformations to geometry and pressures.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::kept::read;
use super::{Failure, Outcome};
use crate::design::fit::{Answer, Effort, Problem, SegmentAnswer, Swarm, solve, swarm};

/// Find geometry and pressures for given deformations, eq. (14) of the paper
#[derive(Args)]
#[command(
    after_help = "Example: softlimb design --problem reach.json --json\n\nThe format of problems and answers: docs/design.md"
)]
pub(super) struct Design {
    /// The problem, a JSON file
    #[arg(long, value_name = "FILE")]
    problem: PathBuf,
    /// Print the answer as JSON
    #[arg(long)]
    json: bool,
    /// Seed of the starts of the search
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Most descents of the search
    #[arg(long, value_name = "N", default_value_t = Effort::default().starts as u32, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
    /// How to search
    #[arg(long, value_enum, default_value_t = Method::Projection)]
    method: Method,
    /// Objectives that the particle swarm evaluates
    #[arg(long, value_name = "N", default_value_t = Swarm::default().evaluations as u32, value_parser = clap::value_parser!(u32).range(50..=100_000_000))]
    evaluations: u32,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Pressures as explicit inverses, geometry by least squares with exact derivatives
    Projection,
    /// The particle swarm of the paper, over geometry and pressures
    Pso,
}

impl Design {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let text = read(&self.problem)?;
        let problem =
            Problem::read(&text).map_err(|error| Failure::new(format!("{}: {error}", self.problem.display())))?;
        let answer = self.answer(&problem)?;
        if self.json {
            let json = serde_json::to_string(&answer).map_err(Failure::new)?;
            super::say(&json)?;
        } else {
            super::say(&table(&answer))?;
        }
        Ok(Outcome::Done)
    }

    fn answer(&self, problem: &Problem) -> Result<Answer, Failure> {
        let answer = match self.method {
            Method::Projection => solve(problem, &self.effort()),
            Method::Pso => {
                let settings = Swarm { seed: self.seed, evaluations: self.evaluations as usize, ..Swarm::default() };
                swarm(problem, &settings, |_, _| {})
            }
        };
        answer.map_err(Failure::new)
    }

    fn effort(&self) -> Effort {
        let default = Effort::default();
        let starts = self.starts as usize;
        // More starts than usual are a wish for more search: no bound but theirs then.
        let evaluations = if starts > default.starts { u64::MAX } else { default.evaluations };
        Effort { seed: self.seed, starts, agreeing: default.agreeing.max(starts / 8), evaluations }
    }
}

/// The answer as text. Writing to a string cannot fail.
fn table(answer: &Answer) -> String {
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
