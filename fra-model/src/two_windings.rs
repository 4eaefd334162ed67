//! A straight tube wound twice: two angles, stiffnesses or places, such as a helix and an axial thread.

use crate::parameters::{ActuatorParameters, Fiber, InvalidParameter, Motion, require};
use crate::precision::Precision;
use crate::solution::{Load, PressureRange, Solution, State, Target};
use crate::solve::tube::Tube;

/// A straight actuator with a second winding, for a host. It is a separate type: functions for one winding do not accept it.
///
/// The energies of both windings add up; each has its own signed angle, families, modulus, thickness and place. Solutions lie on the
/// branch of stable equilibria connected to zero pressure, as those of [`Actuator`](crate::Actuator).
///
/// ```
/// use fra_model::*;
/// let helix = Fiber {
///     angle_rad: 30.0_f64.to_radians(),
///     families: Families::One,
///     modulus_pa: 200e6,
///     placement: Placement::Sheet,
///     thickness_m: 1e-4,
///     radius_m: 8e-3,
/// };
/// let parameters = ActuatorParameters {
///     motion: Motion::Twisting,
///     inner_radius_m: 6e-3,
///     outer_radius_m: 8e-3,
///     length_m: 0.1,
///     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
///     fiber: Some(helix),
/// };
/// let axial = Fiber { angle_rad: 90.0_f64.to_radians(), ..helix };
/// let solution = TwoWindings::new(&parameters, &axial)?.forward(30e3, &Load::none())?;
/// assert_eq!(solution.status, Status::Solved);
/// assert!(solution.state.axial_strain < 1e-3);
/// # Ok::<(), InvalidParameter<f64>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TwoWindings<T: Precision> {
    parameters: ActuatorParameters<T>,
    second_fiber: Fiber<T>,
    tube: Tube<T>,
}

impl<T: Precision> TwoWindings<T> {
    /// Checks the parameters and prepares the solver. The first winding is `parameters.fiber`.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the first field that is not accepted, those of the second winding as `second_fiber.*`. A bending
    /// actuator is not accepted: finite elements of the section answer for it.
    pub fn new(parameters: &ActuatorParameters<T>, second_fiber: &Fiber<T>) -> Result<Self, InvalidParameter<T>> {
        parameters.check()?;
        let straight = parameters.motion != Motion::Bending;
        let allowed = "straight actuators only: a bending one has one winding";
        require(straight, "second_fiber.angle_rad", second_fiber.angle_rad, allowed)?;
        let of_second = ActuatorParameters { fiber: Some(*second_fiber), ..*parameters };
        of_second.check().map_err(|error| InvalidParameter { field: field_of_second(error.field), ..error })?;
        let tube = Tube::new(parameters).with_second(second_fiber);
        Ok(Self { parameters: *parameters, second_fiber: *second_fiber, tube })
    }

    /// The parameters with the first winding.
    pub fn parameters(&self) -> &ActuatorParameters<T> {
        &self.parameters
    }

    /// The second winding.
    pub fn second_fiber(&self) -> &Fiber<T> {
        &self.second_fiber
    }

    /// The state without pressure and load.
    pub fn rest(&self) -> State<T> {
        self.tube.rest()
    }

    /// The equilibrium at a gauge pressure, Pa, as [`Actuator::forward`](crate::Actuator::forward).
    ///
    /// # Errors
    /// [`InvalidParameter`] when the pressure or the load is not finite.
    pub fn forward(&self, pressure_pa: T, load: &Load<T>) -> Result<Solution<T>, InvalidParameter<T>> {
        load.check()?;
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        Ok(self.tube.forward(None, pressure_pa, load).sound())
    }

    /// The gauge pressure in a range at which the actuator reaches a deformation, as [`Actuator::inverse_within`](crate::Actuator::inverse_within).
    ///
    /// # Errors
    /// [`InvalidParameter`] when the target is out of its range or not one of this motion's, or the load or the range is not finite.
    pub fn inverse_within(
        &self,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        load.check()?;
        range.check()?;
        self.tube.inverse(None, range, target, load).map(Solution::sound)
    }
}

/// Name of a field of the second winding.
fn field_of_second(field: &'static str) -> &'static str {
    match field {
        "angle_rad" => "second_fiber.angle_rad",
        "modulus_pa" => "second_fiber.modulus_pa",
        "thickness_m" => "second_fiber.thickness_m",
        "radius_m" => "second_fiber.radius_m",
        other => other,
    }
}
