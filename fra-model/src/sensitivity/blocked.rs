//! Derivatives of the blocked loads of an actuator at a stretch, a twist and a pressure.
//!
//! The volume follows the input so that the pressure stays balanced, `d(u_w - P/mu1) = 0`; then `N = pi R_i^2 mu1 u_e` and
//! `M = pi R_i^3 mu1 u_g` with the derivative of every factor.

use crate::actuator::Actuator;
use crate::number::dual::Dual;
use crate::number::real::Real;
use crate::number::scalar::Scalar;
use crate::parameters::{InvalidParameter, Motion};
use crate::precision::Precision;
use crate::solution::{Load, Status};
use crate::solve::blocked::Blocked;

use super::NoDerivative;
use super::inputs::{Inputs, Parameter};

impl<T: Precision> Actuator<T> {
    /// Derivatives of the blocked loads with respect to one input; `blocked` is a result of [`Actuator::blocked`],
    /// at constant axial stretch and twist: N and N m per unit of the input. By the pressure it is `blocked.by_pressure`.
    ///
    /// # Errors
    /// [`NoDerivative`]: an input that the loads do not depend on (force and torque are answers here), an actuator that bends, or a
    /// blocked state without balance.
    pub fn blocked_sensitivity(&self, blocked: &Blocked<T>, parameter: Parameter) -> Result<Load<T>, NoDerivative<T>> {
        T::blocked_sensitivity(self, blocked, parameter)
    }
}

impl<T: Real> Actuator<T> {
    /// Called by [`Precision`] alone.
    pub(crate) fn blocked_derivative(
        &self,
        blocked: &Blocked<T>,
        parameter: Parameter,
    ) -> Result<Load<T>, NoDerivative<T>> {
        if blocked.status != Status::Solved {
            return Err(NoDerivative::NotAnEquilibrium);
        }
        if self.parameters().motion == Motion::Bending {
            let value = blocked.state.axial_stretch;
            let allowed = "straight actuators only: a bending one is blocked by its load";
            return Err(NoDerivative::Invalid(InvalidParameter { field: "axial_stretch", value, allowed }));
        }
        if matches!(parameter, Parameter::Force | Parameter::Torque) {
            return Err(NoDerivative::NotAnInput(parameter));
        }
        let inputs = Inputs::new(self, blocked.state.pressure_pa, &Load::none());
        let inputs = inputs.varied(parameter).ok_or(NoDerivative::NotAnInput(parameter))?;
        let (radius, mu1) = (inputs.parameters.inner_radius_m, inputs.parameters.material.shear_modulus_pa());
        let state = &blocked.state;
        let twist = Dual::fixed(state.twist_rad) * radius / inputs.parameters.length_m;
        let (e, w) = (Dual::fixed(state.axial_strain), Dual::fixed(state.volume_strain));
        let d = inputs.wall().derivatives(e, w, twist);
        let pressure = inputs.pressure_pa / mu1;
        let stiffness = d.hessian[(1, 1)].value;
        let balanced = stiffness > T::zero();
        if !balanced {
            return Err(NoDerivative::AtLimit);
        }
        let volume = (pressure.slope - d.gradient.y.slope) / stiffness;
        let following = |row: usize| {
            let u = d.gradient[row];
            Dual::new(u.value, u.slope + d.hessian[(row, 1)].value * volume)
        };
        let force = <Dual<T> as Scalar>::constant(core::f64::consts::PI) * radius * radius * mu1;
        let load = Load { force_n: (force * following(0)).slope, torque_nm: (force * radius * following(2)).slope };
        let finite = Scalar::is_finite(load.force_n) && Scalar::is_finite(load.torque_nm);
        if finite { Ok(load) } else { Err(NoDerivative::AtLimit) }
    }
}
