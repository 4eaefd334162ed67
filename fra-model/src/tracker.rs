//! One tube with closed forms, followed from state to state: what a microcontroller needs of an actuator, and no more.

use crate::direct::{Equilibrium, Near};
use crate::goal::Goal;
use crate::parameters::{ActuatorParameters, InvalidParameter, Motion, require};
use crate::real::Real;
use crate::size::Size;
use crate::solution::{State, Target};
use crate::tube::{coordinates, goal};

/// A straight, unloaded tube whose wall has closed forms: neo-Hookean, bare or wound with a sheet.
///
/// It answers what is asked next to a known state, by the direct way of [`Actuator`](crate::Actuator) and with the same bits, in a
/// bounded number of evaluations: a program that has nothing else holds no search, no quadrature and no numbers of twice the digits.
///
/// ```
/// use fra_model::*;
/// let fiber = Fiber {
///     angle_rad: 0.05,
///     families: Families::Two,
///     modulus_pa: 0.36e9,
///     placement: Placement::Sheet,
///     thickness_m: 0.18e-3,
///     radius_m: 8e-3,
/// };
/// let parameters = ActuatorParameters {
///     motion: Motion::Extension,
///     inner_radius_m: 6e-3,
///     outer_radius_m: 8e-3,
///     length_m: 0.1,
///     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
///     fiber: Some(fiber),
/// };
/// let tracker = Tracker::new(&parameters)?.expect("a tube with closed forms");
/// let state = tracker.inverse(&tracker.rest(), Target::AxialStretch(1.01))?.expect("it is near");
/// let solution = Actuator::new(&parameters)?.forward(state.pressure_pa, &Load::none())?;
/// assert!((solution.state.axial_stretch - 1.01_f64).abs() < 1e-12);
/// # Ok::<(), InvalidParameter<f64>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Tracker<T: Real> {
    near: Near<T>,
    size: Size<T>,
    /// `R_i/L`.
    twist_rate_per_rad: T,
    shear_modulus_pa: T,
    /// That without pressure.
    compliance_m3_per_pa: T,
}

impl<T: Real> Tracker<T> {
    /// Checks the parameters; `None` for an actuator without closed forms: one that bends, of another elastomer, or with fibers
    /// that are not a sheet.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the first field that is not accepted.
    pub fn new(parameters: &ActuatorParameters<T>) -> Result<Option<Self>, InvalidParameter<T>> {
        parameters.check()?;
        if parameters.motion == Motion::Bending {
            return Ok(None);
        }
        Ok(Near::new(parameters).and_then(|near| {
            let tracker = Self {
                size: Size::of_tube(parameters, near.x_outer()),
                near,
                twist_rate_per_rad: parameters.inner_radius_m / parameters.length_m,
                shear_modulus_pa: parameters.material.shear_modulus_pa(),
                compliance_m3_per_pa: T::zero(),
            };
            let rest = tracker.answer(&tracker.rest(), &Goal::Pressure(T::zero()))?;
            Some(Self { compliance_m3_per_pa: rest.compliance_m3_per_pa, ..tracker })
        }))
    }

    /// The state without pressure.
    pub fn rest(&self) -> State<T> {
        let zero = T::zero();
        State { compliance_m3_per_pa: self.compliance_m3_per_pa, ..self.size.state(zero, zero, zero, zero, zero) }
    }

    /// The state at a gauge pressure, Pa, next to an earlier state; `None` where the way there is not certified.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the pressure is not finite.
    pub fn forward(&self, start: &State<T>, pressure_pa: T) -> Result<Option<State<T>>, InvalidParameter<T>> {
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        let found = self.answer(start, &Goal::Pressure(pressure_pa / self.shear_modulus_pa));
        Ok(found.map(|state| State { pressure_pa, ..state }))
    }

    /// The state with a deformation next to an earlier state, and its gauge pressure; `None` where the way there is not certified.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the target is out of its range or not one of a straight tube.
    pub fn inverse(&self, start: &State<T>, target: Target<T>) -> Result<Option<State<T>>, InvalidParameter<T>> {
        let goal = goal(&self.size, self.twist_rate_per_rad, target)?;
        Ok(self.answer(start, &goal))
    }

    fn answer(&self, start: &State<T>, goal: &Goal<T>) -> Option<State<T>> {
        let Equilibrium { e, w, g, pressure, volume_rate, .. } =
            self.near.answer(&coordinates(self.twist_rate_per_rad, start), goal)?;
        let state = self.size.state(e, w, g, volume_rate, pressure * self.shear_modulus_pa);
        (state.pressure_pa.is_finite() && state.volume_m3.is_finite() && state.compliance_m3_per_pa.is_finite())
            .then_some(state)
    }
}
