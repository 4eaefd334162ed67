//! An actuator and the deformation compared.

use fra_model::{ActuatorParameters, Fiber, Motion, State, StateQuantity};

use softlimb_fea::cross_section::{ErrorEstimate, Options, Section, SectionError};
use softlimb_fea::solid::Rates;

/// One actuator and the pressures it is compared at.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Motion, size and material in a few words.
    pub name: String,
    /// The actuator.
    pub parameters: ActuatorParameters<f64>,
    /// Its second winding.
    pub second_fiber: Option<Fiber<f64>>,
    /// Gauge pressures, Pa, rising.
    pub pressures_pa: Vec<f64>,
}

impl Case {
    /// The finite elements of its section.
    ///
    /// # Errors
    /// [`SectionError`] of a case that is no actuator.
    pub(super) fn section(&self) -> Result<Section, SectionError> {
        let options = Options::default();
        match &self.second_fiber {
            None => Section::new(&self.parameters, &options),
            Some(second) => Section::with_two_windings(&self.parameters, second, &options),
        }
    }
}

/// The deformation that a motion is named after, with its unit of display, as in Fig. 6 of the paper.
pub fn label(motion: Motion) -> String {
    let quantity = StateQuantity::natural(motion);
    match quantity.display_unit() {
        "" => quantity.label().to_owned(),
        unit => format!("{}, {unit}", quantity.label()),
    }
}

/// A value of that deformation in SI units, in its unit of display.
fn displayed(motion: Motion, value: f64) -> f64 {
    value * StateQuantity::natural(motion).display_scale()
}

/// That deformation in a state.
pub(super) fn value(motion: Motion, state: &State<f64>) -> f64 {
    displayed(motion, StateQuantity::natural(motion).of(state))
}

/// That deformation at rest.
pub(super) fn at_rest(parameters: &ActuatorParameters<f64>) -> f64 {
    displayed(parameters.motion, StateQuantity::natural(parameters.motion).at_rest(parameters))
}

/// That deformation by rates at mid-length, over the length of an actuator, m.
pub(super) fn of_rates(motion: Motion, rates: &Rates, length_m: f64) -> f64 {
    let value = match motion {
        Motion::Extension => rates.axial_stretch,
        Motion::Expansion => rates.outer_radius_m,
        Motion::Bending => rates.bend_rate_rad_per_m * length_m,
        Motion::Twisting => rates.twist_rate_rad_per_m * length_m,
    };
    displayed(motion, value)
}

/// Error of that deformation in an estimate of the section, over the length of an actuator, m.
pub(super) fn of_error(motion: Motion, error: &ErrorEstimate, length_m: f64) -> f64 {
    let value = match motion {
        Motion::Extension => error.axial_strain,
        Motion::Expansion => error.outer_radius_m,
        Motion::Bending => error.bend_rates_rad_per_m[0] * length_m,
        Motion::Twisting => error.twist_rate_rad_per_m * length_m,
    };
    displayed(motion, value)
}
