//! The model's types in another precision.

use fra_model::{
    ActuatorParameters, Fiber, InvalidParameter, Load, PressureRange, Real, SeriesTarget, Solution, State, Target,
};
use nalgebra::{convert, try_convert};

/// The parameters rounded to another scalar.
pub(super) fn parameters<T: Real>(p: &ActuatorParameters<f64>) -> ActuatorParameters<T> {
    p.map(convert)
}

pub(super) fn fiber<T: Real>(fiber: &Fiber<f64>) -> Fiber<T> {
    let Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m } = *fiber;
    let [angle_rad, modulus_pa, thickness_m, radius_m] = [angle_rad, modulus_pa, thickness_m, radius_m].map(convert);
    Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m }
}

pub(super) fn load<T: Real>(load: &Load<f64>) -> Load<T> {
    Load { force_n: convert(load.force_n), torque_nm: convert(load.torque_nm) }
}

/// The range in another scalar; an end beyond its largest number excludes nothing.
pub(super) fn range<T: Real>(range: &PressureRange<f64>) -> PressureRange<T> {
    let largest = T::max_value().map_or(f64::MAX, wide);
    let end = |value: f64| convert(if value.is_finite() { value.clamp(-largest, largest) } else { value });
    PressureRange { least_pa: end(range.least_pa), most_pa: end(range.most_pa) }
}

/// A solution whose numbers are those of another scalar.
pub(super) fn solution<T: Real>(solution: &Solution<T>) -> Solution<f64> {
    Solution {
        status: solution.status,
        state: state(&solution.state),
        limit_pressure_pa: solution.limit_pressure_pa.map(wide),
        residual: wide(solution.residual),
        iterations: solution.iterations,
    }
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
