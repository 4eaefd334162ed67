//! An actuator and the quantity compared.

use fra_model::{ActuatorParameters, Motion, State};

use softlimb_fea::cross_section::ErrorEstimate;
use softlimb_fea::solid::Rates;

/// One actuator and the pressures it is compared at.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Motion, size and material in a few words.
    pub name: String,
    /// The actuator.
    pub parameters: ActuatorParameters<f64>,
    /// Gauge pressures, Pa, rising.
    pub pressures_pa: Vec<f64>,
}

/// The deformation that a motion is measured by, as in Fig. 6 of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Axial stretch.
    Stretch,
    /// Outer radius, mm.
    Radius,
    /// Bend angle, deg.
    Bend,
    /// Twist, deg; negative for fibers at a positive angle under pressure.
    Twist,
}

impl Quantity {
    /// That of a motion.
    pub fn of(motion: Motion) -> Self {
        match motion {
            Motion::Extension => Self::Stretch,
            Motion::Expansion => Self::Radius,
            Motion::Bending => Self::Bend,
            Motion::Twisting => Self::Twist,
        }
    }

    /// Name and unit.
    pub fn label(self) -> &'static str {
        match self {
            Self::Stretch => "axial stretch",
            Self::Radius => "outer radius, mm",
            Self::Bend => "bend angle, deg",
            Self::Twist => "twist, deg",
        }
    }

    /// Its value in a state.
    pub fn value(self, state: &State<f64>) -> f64 {
        match self {
            Self::Stretch => state.axial_stretch,
            Self::Radius => state.outer_radius_m * 1e3,
            Self::Bend => state.bend_angle_rad.to_degrees(),
            Self::Twist => state.twist_rad.to_degrees(),
        }
    }

    /// Its value for rates at mid-length, over the length of an actuator, m.
    pub fn of_rates(self, rates: &Rates, length_m: f64) -> f64 {
        match self {
            Self::Stretch => rates.axial_stretch,
            Self::Radius => rates.outer_radius_m * 1e3,
            Self::Bend => (rates.bend_rate_rad_per_m * length_m).to_degrees(),
            Self::Twist => (rates.twist_rate_rad_per_m * length_m).to_degrees(),
        }
    }

    /// Its error in an estimate of the section, over the length of an actuator, m.
    pub fn of_error(self, error: &ErrorEstimate, length_m: f64) -> f64 {
        match self {
            Self::Stretch => error.axial_strain,
            Self::Radius => error.outer_radius_m * 1e3,
            Self::Bend => (error.bend_rates_rad_per_m[0] * length_m).to_degrees(),
            Self::Twist => (error.twist_rate_rad_per_m * length_m).to_degrees(),
        }
    }

    /// Its value at rest.
    pub fn at_rest(self, parameters: &ActuatorParameters<f64>) -> f64 {
        match self {
            Self::Stretch => 1.0,
            Self::Radius => parameters.outer_radius_m * 1e3,
            Self::Bend | Self::Twist => 0.0,
        }
    }
}
