//! `softlimb design bundle`: a bundle of actuators for target forces, eq. (18).

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;

use crate::cli::shared::{about, read, show};
use crate::cli::{Failure, Outcome};
use softlimb_design::bundle::{Answer, Budget, ForceProblem, search};

/// Design a bundle of actuators for target forces and moments, eq. (18) of the paper
#[derive(Args)]
#[command(after_help = "Format of problems and answers: docs/reference/bundle-problem.md\n\n\
                        Example: softlimb design bundle forces.json --json")]
pub(super) struct Bundle {
    /// The problem, a JSON file
    #[arg(value_name = "FILE")]
    problem: PathBuf,
    /// Seed of the starts after the first, which is the middle of the bounds
    #[arg(long, default_value_t = Budget::default().seed)]
    seed: u64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Bundle {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let problem = ForceProblem::read(&read(&self.problem)?).map_err(|error| about(&self.problem)(&error))?;
        let effort = Budget { seed: self.seed, ..Budget::default() };
        let answer = search(&problem, &effort).map_err(Failure::new)?;
        show(self.json, &answer, || table(&answer))?;
        Ok(Outcome::Done)
    }
}

/// The answer as text. Writing to a string cannot fail.
fn table(answer: &Answer) -> String {
    let mut text = format!("{}: objective {:.6e}\n", answer.status.replace('_', " "), answer.objective);
    for (index, sample) in answer.samples.iter().enumerate() {
        let _ = writeln!(text, "\nsample {index}: wanted and found, N and N m");
        for wrench in [&sample.target, &sample.found] {
            let _ = writeln!(text, "  {}", wrench.map(|value| format!("{value:12.6}")).join(" "));
        }
    }
    for actuator in &answer.actuators {
        let _ = writeln!(
            text,
            "\n{}: inner radius {:.4} mm, outer radius {:.4} mm, length {:.3} mm, fiber angle {:.3} deg",
            actuator.name,
            actuator.inner_radius_m * 1e3,
            actuator.outer_radius_m * 1e3,
            actuator.length_m * 1e3,
            actuator.angle_deg
        );
        let millimetres = actuator.point_m.map(|x| format!("{:.3}", x * 1e3)).join(", ");
        let axis = actuator.axis.map(|x| format!("{x:.4}")).join(", ");
        let _ = writeln!(text, "  at ({millimetres}) mm along ({axis})");
        let active = if actuator.active_bounds.is_empty() { "none".into() } else { actuator.active_bounds.join(", ") };
        let _ = writeln!(text, "  active bounds: {active}");
        for (pressure, push) in actuator.pressures_pa.iter().zip(&actuator.pushes_n) {
            let _ = writeln!(text, "  {:10.3} kPa  push {push:10.4} N", pressure * 1e-3);
        }
    }
    let _ = writeln!(
        text,
        "\ncost: {} evaluations, {} Jacobians; {} of {} starts agree",
        answer.evaluations, answer.jacobians, answer.agreeing, answer.starts
    );
    text
}
