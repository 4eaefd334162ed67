//! One problem: its answer as JSON or text.

use std::fmt::Write;

use super::Payload;
use crate::cli::{Failure, Outcome, say};
use softlimb_design::bundle::{Answer, ForceProblem, search};

pub(super) fn run(command: &Payload, problem: &ForceProblem) -> Result<Outcome, Failure> {
    let answer = search(problem, &command.effort()).map_err(Failure::new)?;
    if command.json {
        say(&serde_json::to_string(&answer).map_err(Failure::new)?)?;
    } else {
        say(&table(&answer))?;
    }
    Ok(Outcome::Done)
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
