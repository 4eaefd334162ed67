//! The model's types in another precision.

use fra_model::{ActuatorParameters, InvalidParameter, Load, Real, SeriesTarget, State, Target};
use nalgebra::{convert, try_convert};

/// The parameters rounded to another scalar.
pub(super) fn parameters<T: Real>(p: &ActuatorParameters<f64>) -> ActuatorParameters<T> {
    p.map(convert)
}

pub(super) fn load<T: Real>(load: &Load<f64>) -> Load<T> {
    Load { force_n: convert(load.force_n), torque_nm: convert(load.torque_nm) }
}

pub(super) fn target<T: Real>(target: Target<f64>) -> Target<T> {
    match target {
        Target::AxialStretch(v) => Target::AxialStretch(convert(v)),
        Target::OuterRadius(v) => Target::OuterRadius(convert(v)),
        Target::InnerRadius(v) => Target::InnerRadius(convert(v)),
        Target::Twist(v) => Target::Twist(convert(v)),
        Target::BendAngle(v) => Target::BendAngle(convert(v)),
    }
}

/// A number of the model as `f64`, which holds every `f32` exactly.
pub(super) fn wide<T: Real>(value: T) -> f64 {
    try_convert(value).unwrap_or(f64::NAN)
}

pub(super) fn state<T: Real>(state: &State<T>) -> State<f64> {
    State::combine([state], |[value]| wide(value))
}

pub(super) fn series_target<T: Real>(target: SeriesTarget<f64>) -> SeriesTarget<T> {
    match target {
        SeriesTarget::Extension(v) => SeriesTarget::Extension(convert(v)),
        SeriesTarget::Twist(v) => SeriesTarget::Twist(convert(v)),
        SeriesTarget::BendAngle(v) => SeriesTarget::BendAngle(convert(v)),
    }
}

pub(super) fn invalid<T: Real>(error: InvalidParameter<T>) -> InvalidParameter<f64> {
    InvalidParameter { field: error.field, value: wide(error.value), allowed: error.allowed }
}
