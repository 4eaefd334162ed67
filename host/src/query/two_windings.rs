//! Questions about a straight tube with two windings.

use fra_model::{ActuatorParameters, Fiber, InvalidParameter, Motion, Precision, Solution, TwoWindings};

use super::batch::{Scalar, as_written};
use super::convert;
use super::request::{Case, Model, Question};

/// The answer of the analytic model.
///
/// # Errors
/// A message with the winding, the field and the allowed values.
pub(super) fn answer(case: &Case, second: &Fiber<f64>, scalar: Scalar) -> Result<Solution<f64>, String> {
    let refused = [
        (case.parameters.motion == Motion::Bending, "`motion` \"bending\""),
        (case.model == Model::SectionFe, "`model` \"section-fe\""),
        (case.all, "`solutions` \"all\""),
        (case.errors, "`errors`"),
    ];
    if let Some((_, field)) = refused.iter().find(|(is_refused, _)| *is_refused) {
        return Err(format!("fiber, second winding: {field} takes one winding"));
    }
    // Checked first in the precision and unit it is written in, so that a message quotes the value as written.
    let double = TwoWindings::new(&case.parameters, second).map_err(in_winding)?;
    match scalar {
        Scalar::F64 => solve(&double, case).map_err(in_winding),
        Scalar::F32 => {
            let parameters: ActuatorParameters<f32> = convert::parameters(&case.parameters);
            let second = convert::fiber(second);
            let invalid = |error| in_winding(convert::invalid(error));
            let single = TwoWindings::new(&parameters, &second).map_err(invalid)?;
            solve(&single, case).map(|solution| convert::solution(&solution)).map_err(invalid)
        }
    }
}

fn solve<T: Precision>(tube: &TwoWindings<T>, case: &Case) -> Result<Solution<T>, InvalidParameter<T>> {
    let load = convert::load(&case.load);
    match case.question {
        Question::Forward { pressure_pa } => tube.forward(nalgebra::convert(pressure_pa), &load),
        Question::Inverse { target } => {
            tube.inverse_within(&convert::range(&case.range), convert::target(target), &load)
        }
    }
}

/// The error as a message that names the winding.
fn in_winding(error: InvalidParameter<f64>) -> String {
    let (winding, field) = match (error.field.strip_prefix("second_fiber."), error.field) {
        (Some(field), _) => ("second", field),
        (None, "angle_rad" | "modulus_pa" | "thickness_m" | "radius_m") => ("first", error.field),
        (None, _) => return error.to_string(),
    };
    let message = as_written(InvalidParameter { field, ..error }).to_string();
    format!("fiber, {winding} winding: {}", message.trim_start_matches("fiber."))
}
