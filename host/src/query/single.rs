//! A file that holds one question about one actuator, for commands that need an actuator and a pressure.

use serde_json::Value;

use super::batch::{as_written, parsed};
use super::request::{Question, Request};
use softlimb_scene::WoundActuator;

/// The actuator, its second winding and the gauge pressure, Pa, of a forward question without load, written as a line of a batch; line breaks may stand
/// anywhere in it.
///
/// # Errors
/// What is wrong with it, naming field, value and range.
pub fn actuator(json: &[u8]) -> Result<(WoundActuator, f64), String> {
    let message = |(_, message): (Value, String)| message;
    let request: Request = parsed(json).map_err(message)?;
    let case = request.case()?;
    let Question::Forward { pressure_pa } = case.question else {
        return Err("`problem` must be \"forward\" here: the pressure is given".into());
    };
    for (field, value) in [("external_force_n", case.load.force_n), ("external_torque_nm", case.load.torque_nm)] {
        if value != 0.0 {
            return Err(format!("{field} = {value} is not allowed here: 0"));
        }
    }
    if !(pressure_pa > 0.0 && pressure_pa.is_finite()) {
        return Err(format!("pressure_pa = {pressure_pa} is not allowed here: finite and > 0"));
    }
    case.parameters.check().map_err(|error| as_written(error).to_string())?;
    Ok(((case.parameters, case.second_fiber), pressure_pa))
}
