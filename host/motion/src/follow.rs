//! Whether a device follows a module by its own model: it solves tubes with closed forms, next to where they are, in single precision.

use std::fmt;

use fra_model::{State, StateQuantity, Target, Tracker};

use super::sent::Sent;
use softlimb_limb::LimbModule;

/// Largest difference of its pressures from those of the plan, as a share of the highest: about what the valves can do.
const ERROR_MAX: f64 = 3e-3;

/// Why a device does not follow a module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NotFollowed {
    /// Its actuator has no closed forms.
    NoClosedForms,
    /// Plates hold its actuators back, and the device solves one alone.
    Restrained,
    /// On the way of the plan it finds no pressure, or another one.
    EquilibriumError {
        /// Where the plan is then, gauge Pa.
        pressure_pa: f64,
    },
}

impl fmt::Display for NotFollowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoClosedForms => {
                f.write_str("the device solves straight, neo-Hookean tubes, bare or wound with a sheet")
            }
            Self::Restrained => f.write_str("the device solves an actuator alone, and plates hold these back"),
            Self::EquilibriumError { pressure_pa } => {
                write!(f, "the device loses its way at {:.2} kPa", pressure_pa * 1e-3)
            }
        }
    }
}

/// Whether a device has a model of a module at all.
///
/// # Errors
/// [`NotFollowed`] where it has none.
pub(super) fn has_model(module: &LimbModule) -> Result<(), NotFollowed> {
    if module.is_restrained() && module.kind != StateQuantity::Pressure {
        return Err(NotFollowed::Restrained);
    }
    tracker(module).map(|_| ()).ok_or(NotFollowed::NoClosedForms)
}

fn tracker(module: &LimbModule) -> Option<Tracker<f32>> {
    if module.second_fiber().is_some() || module.is_by_section() || module.is_series() {
        return None;
    }
    Tracker::new(&module.actuator.parameters().map(|value| value as f32)).ok().flatten()
}

/// Goes through the setpoints of a channel as the device does: from rest, a control period at a time, or from knot to knot where those are farther apart.
///
/// # Errors
/// [`NotFollowed`].
pub(super) fn follow(
    module: &LimbModule,
    channel: usize,
    sent: &Sent,
    control_period_us: u64,
) -> Result<(), NotFollowed> {
    let tracker = tracker(module).ok_or(NotFollowed::NoClosedForms)?;
    let mut here = tracker.rest();
    let step_us = control_period_us.max(sent.knot_period_us());
    for time_us in (0..=sent.duration_us().div_ceil(step_us)).map(|step| (step * step_us) as f64) {
        let planned = sent.states_at(time_us).get(channel).map_or(0.0, |state| state.pressure_pa);
        let lost = NotFollowed::EquilibriumError { pressure_pa: planned };
        let value = sent.values_at(time_us).get(channel).copied().unwrap_or_default();
        let found = next(&tracker, &here, module.target(value), value).ok_or(lost)?;
        let off = (f64::from(found.pressure_pa) - planned).abs();
        (off <= ERROR_MAX * module.reference_max_pa).then_some(()).ok_or(lost)?;
        here = found;
    }
    Ok(())
}

fn next(tracker: &Tracker<f32>, here: &State<f32>, target: Option<Target<f64>>, value: f64) -> Option<State<f32>> {
    let found = match target {
        None => tracker.forward(here, value as f32),
        Some(target) => tracker.inverse(here, target.map(|value| value as f32)),
    };
    found.ok().flatten()
}
