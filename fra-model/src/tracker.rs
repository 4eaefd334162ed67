//! The door of a device: one tube with closed forms, tracked from state to state.

use crate::number::real::Real;
use crate::parameters::{ActuatorParameters, InvalidParameter, Motion, require};
use crate::solution::{State, Target};
use crate::solve::closed_form::{Equilibrium, WarmStart};
use crate::solve::residual::Residual;
use crate::solve::size::Size;
use crate::solve::tube::{coordinates, residual};

/// A straight, unloaded tube whose wall has closed forms: neo-Hookean, bare or wound with a sheet. The entry point of a device.
///
/// Every solve starts warm, at a known state. It runs the closed-form solver of [`Actuator`](crate::Actuator), with the same bits, in a
/// bounded number of evaluations. A program with a tracker alone links no continuation, no quadrature and no double-double arithmetic.
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
    warm_start: WarmStart<T>,
    size: Size<T>,
    /// `R_i/L`.
    twist_rate_per_rad: T,
    shear_modulus_pa: T,
    /// Compliance without pressure.
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
        Ok(WarmStart::new(parameters).and_then(|warm_start| {
            let tracker = Self {
                size: Size::of_tube(parameters, warm_start.x_outer()),
                warm_start,
                twist_rate_per_rad: parameters.inner_radius_m / parameters.length_m,
                shear_modulus_pa: parameters.material.shear_modulus_pa(),
                compliance_m3_per_pa: T::zero(),
            };
            let rest = tracker.answer(&tracker.rest(), &Residual::Pressure(T::zero()))?;
            Some(Self { compliance_m3_per_pa: rest.compliance_m3_per_pa, ..tracker })
        }))
    }

    /// The state without pressure.
    pub fn rest(&self) -> State<T> {
        let zero = T::zero();
        State { compliance_m3_per_pa: self.compliance_m3_per_pa, ..self.size.state(zero, zero, zero, zero, zero) }
    }

    /// The state at a gauge pressure, Pa, next to an earlier state; `None` if the path there is not certified.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the pressure is not finite.
    pub fn forward(&self, start: &State<T>, pressure_pa: T) -> Result<Option<State<T>>, InvalidParameter<T>> {
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        let found = self.answer(start, &Residual::Pressure(pressure_pa / self.shear_modulus_pa));
        Ok(found.map(|state| State { pressure_pa, ..state }))
    }

    /// The state with a deformation next to an earlier state, and its gauge pressure; `None` if the path there is not certified.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the target is out of its range or not one of a straight tube.
    pub fn inverse(&self, start: &State<T>, target: Target<T>) -> Result<Option<State<T>>, InvalidParameter<T>> {
        let residual = residual(&self.size, self.twist_rate_per_rad, target)?;
        Ok(self.answer(start, &residual))
    }

    fn answer(&self, start: &State<T>, residual: &Residual<T>) -> Option<State<T>> {
        let Equilibrium { e, w, g, pressure, volume_rate, .. } =
            self.warm_start.answer(&coordinates(self.twist_rate_per_rad, start), residual)?;
        let state = self.size.state(e, w, g, volume_rate, pressure * self.shear_modulus_pa);
        (state.pressure_pa.is_finite() && state.volume_m3.is_finite() && state.compliance_m3_per_pa.is_finite())
            .then_some(state)
    }
}
