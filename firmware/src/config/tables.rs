//! One channel's tables, checked on arrival: any setpoint gives a pressure within the limits.

use fra_model::{Argument, InvalidParameter, InverseTable, TableParameters, VolumeTable};
use softlimb_protocol::{ConfigInverse, ConfigVolume, SetpointKind, TableArgument};

use super::{ChannelConfig, ConfigError, known, number, within};

/// The volume at rest may differ this much from the model's: more, and the table belongs to another actuator.
const REST_VOLUME_SHARE: f32 = 0.01;

/// Intervals between the setpoints at which a table is seen to rise.
const RISE_CHECKS: u16 = 64;

/// The volume table of a channel.
///
/// # Errors
/// [`ConfigError`] names the first field that is not accepted.
pub(super) fn volume(channel: &ChannelConfig, wire: &ConfigVolume) -> Result<VolumeTable<f32>, ConfigError> {
    let pressure_max_pa =
        within(number!(ConfigVolume, "pressure_max_pa"), wire.pressure_max_pa, 1.0..=channel.pressure_max_pa)?;
    let wrong = ConfigError::OutOfRange { field: number!(ConfigVolume, "coefficients_m3") };
    let table = VolumeTable::new(pressure_max_pa, &wire.coefficients_m3).map_err(|_| wrong)?;
    let rest_m3 = table.lookup(0.0).map_err(|_| wrong)?.volume_m3;
    let modelled_m3 = channel.rest_volume_m3;
    if (rest_m3 - modelled_m3).abs() <= REST_VOLUME_SHARE * modelled_m3 { Ok(table) } else { Err(wrong) }
}

/// The inverse table of a channel whose setpoint is a deformation.
///
/// # Errors
/// [`ConfigError`] names the first field that is not accepted.
pub(super) fn inverse(channel: &ChannelConfig, wire: &ConfigInverse) -> Result<InverseTable<f32>, ConfigError> {
    let kind = channel.setpoint_kind;
    let parameters = TableParameters {
        from: setpoint(number!(ConfigInverse, "setpoint_from"), kind, wire.setpoint_from)?,
        to: setpoint(number!(ConfigInverse, "setpoint_to"), kind, wire.setpoint_to)?,
        argument: match known(number!(ConfigInverse, "argument"), wire.argument)? {
            TableArgument::Linear => Argument::Linear,
            TableArgument::Root => Argument::Root,
        },
        steps: wire.steps,
        pressure_max_pa: within(
            number!(ConfigInverse, "pressure_max_pa"),
            wire.pressure_max_pa,
            1.0..=channel.pressure_max_pa,
        )?,
        coefficients: &wire.coefficients_pa,
    };
    let table =
        InverseTable::new(&parameters).map_err(|error| ConfigError::OutOfRange { field: wire_field(&error) })?;
    if rises(&table, &parameters) {
        Ok(table)
    } else {
        Err(ConfigError::OutOfRange { field: number!(ConfigInverse, "coefficients_pa") })
    }
}

/// A setpoint that its kind can have.
fn setpoint(field: u8, kind: SetpointKind, value: f32) -> Result<f32, ConfigError> {
    if is_in_domain(kind, value) { within(field, value, -1e6..=1e6) } else { Err(ConfigError::OutOfRange { field }) }
}

/// Whether a kind has a setpoint, in SI units.
pub(super) fn is_in_domain(kind: SetpointKind, value: f32) -> bool {
    match kind {
        SetpointKind::AxialStretch | SetpointKind::OuterRadius | SetpointKind::InnerRadius => value > 0.0,
        SetpointKind::BendAngle => value >= 0.0,
        SetpointKind::Twist | SetpointKind::Pressure => true,
    }
}

/// Whether the pressure does not fall from the first setpoint to the last, as far as a few checks tell.
fn rises(table: &InverseTable<f32>, parameters: &TableParameters<'_, f32>) -> bool {
    let mut highest_pa = 0.0;
    (0..=RISE_CHECKS).all(|index| {
        let share = f32::from(index) / f32::from(RISE_CHECKS);
        let setpoint = parameters.from + share * (parameters.to - parameters.from);
        let Ok(found) = table.lookup(setpoint) else { return false };
        let rose = found.pressure_pa >= highest_pa;
        highest_pa = found.pressure_pa;
        rose
    })
}

/// The wire's number for a field of the table.
fn wire_field(error: &InvalidParameter<f32>) -> u8 {
    match error.field {
        "from" => number!(ConfigInverse, "setpoint_from"),
        "to" => number!(ConfigInverse, "setpoint_to"),
        "steps" => number!(ConfigInverse, "steps"),
        "pressure_max_pa" => number!(ConfigInverse, "pressure_max_pa"),
        _ => number!(ConfigInverse, "coefficients_pa"),
    }
}
