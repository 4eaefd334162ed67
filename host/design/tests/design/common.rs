//! Problems as text, and the objective of an answer by the model alone.

use fra_model::{Actuator, Load, Status};
use softlimb_design::actuators::{Answer, Geometry, Problem};

/// One extending segment with all bounds open; `{targets}` and others are replaced by the tests.
pub(crate) const EXTENSION: &str = include_str!("../problems/extension.json");

/// [`EXTENSION`] after replacements, each of which must apply.
pub(crate) fn extension(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(EXTENSION.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the problem");
        text.replace(from, to)
    })
}

/// Eq. (14) of an answer by forward solves from rest, from nothing but the numbers that are printed.
pub(crate) fn objective(problem: &Problem, answer: &Answer) -> f64 {
    let mut sum = 0.0;
    for (segment, found) in problem.segments().iter().zip(&answer.segments) {
        let geometry = Geometry {
            inner_radius_m: found.inner_radius_m,
            outer_radius_m: found.outer_radius_m,
            length_m: found.length_m,
            angle_rad: found.angle_deg.to_radians(),
        };
        let actuator = Actuator::new(&segment.parameters(&geometry)).expect("a geometry of the model");
        for (goal, phase) in segment.goals.iter().zip(&found.phases) {
            let solution = actuator.forward(phase.pressure_pa, &Load::none()).expect("a finite pressure");
            assert_eq!(solution.status, Status::Solved);
            assert!((0.0..=segment.pressure_max_pa).contains(&phase.pressure_pa));
            if let Some(goal) = goal {
                sum += goal.weight * (segment.measure(&solution.state, geometry.length_m) - goal.value).powi(2);
            }
        }
    }
    sum
}
