//! Derivatives of a bend, in plain arithmetic: it has no stiff fibers whose rounding would be magnified.

use crate::bending::not_a_bend;
use crate::jet::Jet;
use crate::real::{Real, epsilon, real};
use crate::scalar::Scalar;
use crate::section::Section;
use crate::solution::{State, Target};

use super::inputs::{Inputs, Parameter};
use super::{Change, Held, NoDerivative, slopes};

/// What the pressure may be off by, as a share of it or of what it changes with the bend.
const MOST_OFF: f64 = 0.01;

/// A bend in balance, `P lever + load moment = dU/dk`.
pub(super) struct BentPoint<T: Real> {
    inputs: Inputs<T>,
    k: T,
    bend_angle_rad: T,
    /// Whether the derivatives at constant pressure are infinite.
    at_limit: bool,
}

/// The pressure that balances a bend, and its slope along the branch.
fn balance<S: Scalar>(inputs: &Inputs<S>, k: S) -> (State<S>, S) {
    let section = Section::new(&inputs.parameters);
    let bent = section.bent(k);
    let state = section.state(&bent, section.load_moment(inputs.force_n, inputs.torque_nm));
    (state, section.pressure_slope(&bent))
}

impl<T: Real> BentPoint<T> {
    pub(super) fn new(inputs: Inputs<T>, state: &State<T>) -> Result<Self, NoDerivative<T>> {
        let k = state.axial_strain;
        let forwards = k >= T::zero();
        if !forwards {
            return Err(NoDerivative::NotAnEquilibrium);
        }
        let (balanced, slope) = balance(&inputs.map(Jet::fixed), Jet::variable(k));
        let error = (balanced.pressure_pa.value - inputs.pressure_pa).abs();
        let scale = inputs.pressure_pa.abs() + slope.value.abs() * k;
        let rounding = real::<T>(4.0) * epsilon::<T>();
        let noise = inputs.parameters.material.shear_modulus_pa() * rounding;
        // The negation also refuses a NaN.
        let balanced_by_it = error <= real::<T>(MOST_OFF) * scale + noise;
        if !balanced_by_it {
            return Err(NoDerivative::NotAnEquilibrium);
        }
        let stable = slope.value > slope.slope.abs() * k * rounding;
        Ok(Self { inputs, k, bend_angle_rad: state.bend_angle_rad, at_limit: !stable })
    }

    pub(super) fn deformation(&self) -> [T; 3] {
        [self.bend_angle_rad, T::zero(), T::zero()]
    }

    pub(super) fn change(&self, of: Parameter, held: Held<T>) -> Result<Change<T>, NoDerivative<T>> {
        let inputs = self.inputs.varied(of).ok_or(NoDerivative::NotAnInput(of))?;
        let (at_bend, slope) = balance(&inputs, Jet::fixed(self.k));
        let dk = match held {
            Held::Pressure if self.at_limit => return Err(NoDerivative::AtLimit),
            Held::Pressure => (inputs.pressure_pa.slope - at_bend.pressure_pa.slope) / slope.value,
            // The angle is k L/R_o.
            Held::Target(Target::BendAngle(_)) => {
                let section = Section::new(&inputs.parameters);
                -at_bend.bend_angle_rad.slope * section.curvature(Jet::one()).value
            }
            Held::Target(other) => return Err(NoDerivative::Invalid(not_a_bend(other))),
        };
        let (changed, _) = balance(&inputs, Jet::new(self.k, dk));
        let state = slopes(&changed, |slope| slope).ok_or(NoDerivative::AtLimit)?;
        let state = match held {
            Held::Pressure => State { pressure_pa: inputs.pressure_pa.slope, ..state },
            Held::Target(_) => State { bend_angle_rad: T::zero(), ..state },
        };
        Ok(Change { state, deformation: [state.bend_angle_rad, T::zero(), T::zero()] })
    }
}
