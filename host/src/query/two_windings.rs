//! Questions about an actuator with two windings.

use fra_model::{Actuator, ActuatorParameters, Fiber, InvalidParameter, Motion, Precision, Solution};

use super::batch::{Scalar, as_written};
use super::convert;
use super::request::{Case, Model, Question};

/// Whether finite elements answer. Of a bending actuator with two windings they alone have a model: it twists, too.
///
/// # Errors
/// A message if the analytic model is to bend it.
pub(super) fn is_by_section(case: &Case) -> Result<bool, String> {
    let bends = case.parameters.motion == Motion::Bending;
    if bends && case.model == Model::Analytic {
        return Err("fiber, second winding: `motion` \"bending\" with `model` \"analytic\" takes one winding".into());
    }
    Ok(case.model == Model::SectionFe || bends)
}

/// The tube of a question, with its second winding where it has one. A bending actuator has the first alone.
pub(super) fn tube(case: &Case) -> Result<Actuator<f64>, InvalidParameter<f64>> {
    match case.second_fiber.filter(|_| case.parameters.motion != Motion::Bending) {
        None => Actuator::new(&case.parameters),
        Some(second) => wound(&case.parameters, &second),
    }
}

/// The answer of the analytic model.
///
/// # Errors
/// A message with the winding, the field and the allowed values.
pub(super) fn answer(case: &Case, second: &Fiber<f64>, scalar: Scalar) -> Result<Solution<f64>, String> {
    // Checked first in the precision and unit it is written in, so that a message quotes the value as written.
    let double = wound(&case.parameters, second).map_err(in_winding)?;
    match scalar {
        Scalar::F64 => solve(&double, case).map_err(in_winding),
        Scalar::F32 => {
            let parameters: ActuatorParameters<f32> = convert::parameters(&case.parameters);
            let second = convert::fiber(second);
            let invalid = |error| in_winding(convert::invalid(error));
            let single = wound(&parameters, &second).map_err(invalid)?;
            solve(&single, case).map(|solution| convert::solution(&solution)).map_err(invalid)
        }
    }
}

pub(super) fn wound<T: Precision>(
    parameters: &ActuatorParameters<T>,
    second: &Fiber<T>,
) -> Result<Actuator<T>, InvalidParameter<T>> {
    Actuator::new(parameters)?.with_second_fiber(second)
}

fn solve<T: Precision>(tube: &Actuator<T>, case: &Case) -> Result<Solution<T>, InvalidParameter<T>> {
    let load = convert::load(&case.load);
    match case.question {
        Question::Forward { pressure_pa } => tube.forward(nalgebra::convert(pressure_pa), &load),
        Question::Inverse { target } => {
            tube.inverse_within(&convert::range(&case.range), convert::target(target), &load)
        }
    }
}

/// The error as a message that names the winding.
pub(super) fn in_winding(error: InvalidParameter<f64>) -> String {
    let (winding, field) = match (error.field.strip_prefix("second_fiber."), error.field) {
        (Some(field), _) => ("second", field),
        (None, "angle_rad" | "modulus_pa" | "thickness_m" | "radius_m") => ("first", error.field),
        (None, _) => return error.to_string(),
    };
    of_winding(winding, InvalidParameter { field, ..error })
}

/// The error of a field of one of the windings.
pub(super) fn of_winding(winding: &str, error: InvalidParameter<f64>) -> String {
    let message = as_written(error).to_string();
    format!("fiber, {winding} winding: {}", message.trim_start_matches("fiber."))
}
