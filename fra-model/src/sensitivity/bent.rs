//! Derivatives of a bend, in plain arithmetic: it has no stiff fibers whose rounding would be magnified.

use crate::model::section::{Bent, Section};
use crate::number::dual::Dual;
use crate::number::real::{Real, epsilon, real};
use crate::number::scalar::Scalar;
use crate::solution::{State, Target};
use crate::solve::bend::not_a_bend;

use super::inputs::{Inputs, Parameter};
use super::{Change, Fixed, NoDerivative, slopes};

/// Tolerance of the pressure, as a fraction of it or of its change with the bend.
const MOST_OFF: f64 = 0.01;

/// A bend in balance, `P lever + load moment = dU/dk`.
pub(super) struct BentPoint<T: Real> {
    inputs: Inputs<T>,
    k: T,
    bend_angle_rad: T,
    /// The moment and its slope, with their derivatives by `k`.
    bent: Bent<Dual<T>>,
    /// `dP/dk`.
    pressure_slope: T,
    /// Whether the derivatives at constant pressure are infinite.
    at_limit: bool,
}

/// The state of a bend with the pressure that balances it.
fn balanced<S: Scalar>(section: &Section<S>, inputs: &Inputs<S>, bent: &Bent<S>) -> State<S> {
    section.state(bent, &section.end_load(inputs.force_n, inputs.torque_nm))
}

impl<T: Real> BentPoint<T> {
    pub(super) fn new(inputs: Inputs<T>, state: &State<T>) -> Result<Self, NoDerivative<T>> {
        let fixed = inputs.map(Dual::fixed);
        let section = Section::new(&fixed.parameters);
        // The strain of the axis of a hoop is `k` to the last digit.
        let k = if section.is_helical() {
            section.curvature(Dual::fixed(state.bend_angle_rad)).value
        } else {
            state.axial_strain
        };
        let forwards = k >= T::zero();
        if !forwards {
            return Err(NoDerivative::NotAnEquilibrium);
        }
        let bent = section.bent(Dual::variable(k), &section.end_load(fixed.force_n, fixed.torque_nm));
        let (found, slope) = (balanced(&section, &fixed, &bent).pressure_pa, section.pressure_slope(&bent));
        let error = (found.value - inputs.pressure_pa).abs();
        let scale = inputs.pressure_pa.abs() + slope.value.abs() * k;
        let rounding = real::<T>(4.0) * epsilon::<T>();
        let noise = inputs.parameters.material.shear_modulus_pa() * rounding;
        // The negation also refuses a NaN.
        let balanced_by_it = error <= real::<T>(MOST_OFF) * scale + noise;
        if !balanced_by_it {
            return Err(NoDerivative::NotAnEquilibrium);
        }
        let stable = slope.value > slope.slope.abs() * k * rounding;
        let bend_angle_rad = state.bend_angle_rad;
        Ok(Self { inputs, k, bend_angle_rad, bent, pressure_slope: slope.value, at_limit: !stable })
    }

    pub(super) fn deformation(&self) -> [T; 3] {
        [self.bend_angle_rad, T::zero(), T::zero()]
    }

    pub(super) fn change(&self, of: Parameter, fixed: Fixed<T>) -> Result<Change<T>, NoDerivative<T>> {
        let inputs = self.inputs.varied(of).ok_or(NoDerivative::NotAnInput(of))?;
        let section = Section::new(&inputs.parameters);
        let still = self.while_still(&section, &inputs);
        let at_bend = balanced(&section, &inputs, &still);
        let dk = match fixed {
            Fixed::Pressure if self.at_limit => return Err(NoDerivative::AtLimit),
            Fixed::Pressure => (inputs.pressure_pa.slope - at_bend.pressure_pa.slope) / self.pressure_slope,
            // The angle is k L/R_o.
            Fixed::Target(Target::BendAngle(_)) => -at_bend.bend_angle_rad.slope * section.curvature(Dual::one()).value,
            Fixed::Target(other) => return Err(NoDerivative::Invalid(not_a_bend(other))),
        };
        let by_bend = |value: Dual<T>| Dual::new(T::zero(), value.slope * dk);
        let moved = Bent {
            k: Dual::new(self.k, dk),
            moment: still.moment + by_bend(self.bent.moment),
            slope: still.slope + by_bend(self.bent.slope),
        };
        let state = slopes(&balanced(&section, &inputs, &moved), |slope| slope).ok_or(NoDerivative::AtLimit)?;
        let state = match fixed {
            Fixed::Pressure => State { pressure_pa: inputs.pressure_pa.slope, ..state },
            Fixed::Target(_) => State { bend_angle_rad: T::zero(), ..state },
        };
        Ok(Change { state, deformation: [state.bend_angle_rad, T::zero(), T::zero()] })
    }

    /// The moment and its slope with their derivatives by an input, the bend unchanged.
    fn while_still(&self, section: &Section<Dual<T>>, inputs: &Inputs<Dual<T>>) -> Bent<Dual<T>> {
        let k = Dual::fixed(self.k);
        if section.keeps_its_shape() {
            let [moment, slope] = [self.bent.moment, self.bent.slope].map(|dual| Dual::fixed(dual.value));
            return Bent { k, moment, slope };
        }
        section.bent(k, &section.end_load(inputs.force_n, inputs.torque_nm))
    }
}
