//! The closed-form solver started at a known state.

use nalgebra::Vector3;

use super::kernel::{Constants, Norm};
use super::path::{Path, tolerance};
use super::{EVALUATIONS, Equilibrium, earlier, equilibrium, twists};
use crate::number::real::{Real, epsilon, real};
use crate::number::scalar::Scalar;
use crate::parameters::{ActuatorParameters, Families, Material, Placement};
use crate::solve::continuation::LARGEST_PRESSURE;
use crate::solve::residual::Residual;

/// The closed-form solver without the expansion at rest: it starts at a known state, in a third of the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WarmStart<T> {
    pub(super) constants: Constants<T>,
    pub(super) families: Option<Families>,
    pub(super) norm: Norm<T>,
    /// That of the sheet, `scale/compliance`.
    pub(super) stiffness: T,
}

impl<T: Real> WarmStart<T> {
    /// `None` for a wall without closed forms.
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Option<Self> {
        let Material::NeoHookean { shear_modulus_pa } = parameters.material else { return None };
        let (zero, one) = (T::zero(), T::one());
        let ratio = parameters.outer_radius_m / parameters.inner_radius_m;
        let x_outer = ratio * ratio;
        let mut constants = Constants {
            x_outer,
            // A thin wall keeps its digits.
            d: (parameters.outer_radius_m - parameters.inner_radius_m)
                * (parameters.outer_radius_m + parameters.inner_radius_m)
                / (parameters.inner_radius_m * parameters.inner_radius_m),
            per_x_fiber: one,
            sin_rho: zero,
            neutral: zero,
            cos: zero,
            sin2: zero,
            compliance: one,
            scale: zero,
        };
        let mut stiffness = zero;
        let fiber = parameters.fiber.filter(|fiber| fiber.modulus_pa > zero);
        if let Some(fiber) = fiber {
            if fiber.placement != Placement::Sheet {
                return None;
            }
            let radius = fiber.radius_m / parameters.inner_radius_m;
            let (sin, cos) = Scalar::sin_cos(fiber.angle_rad);
            // At exactly a quarter turn the fibers are axial: the rounding of pi/2 shall not make them twist.
            constants.cos = if cos.abs() <= epsilon::<T>() { zero } else { cos };
            constants.sin2 = sin * sin;
            constants.neutral = neutral(fiber.angle_rad);
            constants.sin_rho = if fiber.families == Families::One { sin * radius } else { zero };
            constants.per_x_fiber = one / (radius * radius);
            let families = if fiber.families == Families::Two { real::<T>(2.0) } else { one };
            let area = real::<T>(2.0) * radius * fiber.thickness_m / parameters.inner_radius_m;
            stiffness = families * area * (fiber.modulus_pa / shear_modulus_pa);
            (constants.compliance, constants.scale) =
                if stiffness > one { (one / stiffness, one) } else { (one, stiffness) };
        }
        let families = fiber.map(|fiber| fiber.families);
        let norm = Norm { twist: ratio, tension: one / constants.d };
        Some(Self { constants, families, norm, stiffness })
    }

    /// `(R_o/R_i)^2`.
    pub(crate) fn x_outer(&self) -> T {
        self.constants.x_outer
    }

    /// The unloaded equilibrium with a vanishing residual, if the path to it from the state `(e, w, g)` is certified.
    pub(crate) fn answer(&self, start: &Vector3<T>, residual: &Residual<T>) -> Option<Equilibrium<T>> {
        if twists(self.families) { self.solve::<true>(start, residual) } else { self.solve::<false>(start, residual) }
    }

    fn solve<const TWIST: bool>(&self, start: &Vector3<T>, residual: &Residual<T>) -> Option<Equilibrium<T>> {
        let zero = T::zero();
        let (constants, norm, floor) = (&self.constants, self.norm, tolerance());
        let path = Path::<T, TWIST> { constants, force: zero, torque: zero, norm, floor };
        let end = path.follow(earlier(&self.constants, self.stiffness, start), residual, 0, EVALUATIONS)?;
        (end.pressure.abs() <= real(LARGEST_PRESSURE)).then(|| equilibrium(end))
    }
}

/// `2 sin^2 - cos^2` of a fiber angle: three times the product of the sines of its sum with and its difference from the neutral angle,
/// which is taken in two parts.
fn neutral<T: Real>(angle_rad: T) -> T {
    let (high, low) = (real::<T>(0.615_479_707_717_895_5), real::<T>(9.524_918_332_549_646e-10));
    let angle = angle_rad.abs();
    let (sum, difference) = ((angle + high) + low, (angle - high) - low);
    real::<T>(3.0) * Scalar::sin(sum) * Scalar::sin(difference)
}
