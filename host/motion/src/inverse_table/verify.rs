//! The comparison of a device's tables with the model.

use fra_model::{Argument, InverseTable, TableParameters, VolumeTable};

use super::{DenseTable, InverseFit, Subject, VolumeFit};

/// Largest error of a volume table, as a share of the air that a pressure change takes: a tenth of what the pressure loop learns away.
pub const AIR_ERROR_MAX: f64 = 1e-3;

/// By how much the device's own rounding may shift an argument, relative: a few units in the last place.
const ARGUMENT_ROUNDING: f64 = 1.0 / (1u32 << 20) as f64;

/// Exponent of the polytropic change of state with which the pressure loop weighs the compliance.
const POLYTROPIC_EXPONENT: f64 = 1.2;

/// Pressures at which a volume table is compared.
const VOLUME_CHECKS: u32 = 4096;

/// What a comparison has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verified {
    /// Largest difference from the model over all single-precision setpoints in the range, as a share of the highest pressure.
    pub error: f64,
    /// Whether the pressure never falls from one setpoint to the next.
    pub rises: bool,
}

/// Compares an inverse table with the model at every value it has.
///
/// The table is a staircase, the model runs one way: over each stair the difference is largest at its two ends. The model is taken from
/// `exact`, whose own error is added.
///
/// `None` if the device would not accept the table.
pub fn verify(fit: &InverseFit, exact: &DenseTable) -> Option<Verified> {
    let table = inverse_table(fit)?;
    let (from, to) = (f64::from(fit.from), f64::from(fit.to));
    let steps = f64::from(fit.steps);
    let highest_pa = f64::from(fit.pressure_max_pa);
    let model_pa = |argument: f64| {
        let u = argument.clamp(0.0, 1.0);
        let share = if fit.argument == Argument::Root { u * u } else { u };
        exact.pressure_pa(from + (to - from) * share).unwrap_or(f64::NAN)
    };
    let (mut error_pa, mut rises, mut before) = (0.0_f64, true, 0.0_f32);
    for step in 0..=fit.steps {
        let value = table.at_step(step);
        rises &= value >= before;
        before = value;
        let edge = |side: f64| model_pa((f64::from(step) + 0.5 * side) / steps * (1.0 + side * ARGUMENT_ROUNDING));
        for model in [edge(-1.0), edge(1.0)] {
            let difference = (f64::from(value) - model).abs();
            // A model without an answer is no table's fault, but no proof of it either.
            error_pa = if difference.is_nan() { f64::INFINITY } else { error_pa.max(difference) };
        }
    }
    Some(Verified { error: (error_pa + exact.error_pa()) / highest_pa, rises })
}

/// Largest error of a volume table at many pressures: that of the air needed for a pressure change, `V + n P dV/dP` with `P` absolute.
/// `None` if the device would not accept the table.
pub(super) fn air_error(fit: &VolumeFit, subject: &Subject, atmosphere_pa: f64) -> Option<f64> {
    let table = VolumeTable::new(fit.pressure_max_pa, &fit.coefficients_m3).ok()?;
    let highest_pa = subject.curve.pressure_max_pa();
    let errors = (0..=VOLUME_CHECKS).map(|check| {
        let pressure_pa = highest_pa * f64::from(check) / f64::from(VOLUME_CHECKS);
        let state = subject.curve.at(pressure_pa);
        let Ok(found) = table.lookup(pressure_pa as f32) else { return f64::INFINITY };
        let weight_pa = POLYTROPIC_EXPONENT * (atmosphere_pa + pressure_pa);
        let volume_m3 = (f64::from(found.volume_m3) - state.volume_m3).abs();
        let compliance = (f64::from(found.compliance_m3_per_pa) - state.compliance_m3_per_pa).abs();
        (volume_m3 + weight_pa * compliance) / (state.volume_m3 + weight_pa * state.compliance_m3_per_pa)
    });
    Some(errors.fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { f64::max(most, error) }))
}

/// The table as the device builds it.
pub(super) fn inverse_table(fit: &InverseFit) -> Option<InverseTable<f32>> {
    let parameters = TableParameters {
        from: fit.from,
        to: fit.to,
        argument: fit.argument,
        steps: fit.steps,
        pressure_max_pa: fit.pressure_max_pa,
        coefficients: &fit.coefficients_pa,
    };
    InverseTable::new(&parameters).ok()
}
