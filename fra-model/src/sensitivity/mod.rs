//! Exact derivatives of an equilibrium with respect to everything it depends on, by the implicit function theorem.
//!
//! At an equilibrium `x = (e, w, g)` the gradient of the energy balances the loads, `r(x, p) = grad u - loads = 0`, for every value of
//! an input `p`; hence `dx/dp = -H^-1 dr/dp` with the exact Hessian `H`. `dr/dp` is the same gradient, evaluated with `p` as a number
//! that carries its derivative, and so are the conversions between the units of the model and those of the user. Nothing is a
//! difference of nearby solutions.
//!
//! Straight tubes are computed in double-double arithmetic: stiff fibers make `H` ill conditioned in the scalar itself.

mod bent;
mod blocked;
mod inputs;
mod straight;

use core::fmt;

use crate::actuator::Actuator;
use crate::number::double_double::DoubleDouble;
use crate::number::dual::Dual;
use crate::number::real::Real;
use crate::number::scalar::Scalar;
use crate::parameters::{InvalidParameter, Motion};
use crate::precision::Precision;
use crate::solution::{Load, State, Target};

use bent::BentPoint;
use inputs::Inputs;
pub use inputs::Parameter;
use straight::StraightPoint;

/// A double-double number with its derivative.
type Slope<T> = Dual<DoubleDouble<T>>;

/// Why a derivative does not exist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoDerivative<T> {
    /// A value that the model cannot accept, or a target that is not one of this motion's.
    Invalid(InvalidParameter<T>),
    /// The actuator has no such parameter, or its equilibria do not depend on it; or it is the unknown of the inverse problem.
    NotAnInput(Parameter),
    /// The state does not balance its pressure and the load on this actuator.
    NotAnEquilibrium,
    /// The state is at a limit point or beyond, where derivatives at a given pressure are infinite or meaningless.
    AtLimit,
    /// The target stands still along the branch: no pressure makes up for a change of the input.
    Stationary,
}

impl<T> From<InvalidParameter<T>> for NoDerivative<T> {
    fn from(error: InvalidParameter<T>) -> Self {
        Self::Invalid(error)
    }
}

impl<T: fmt::Display> fmt::Display for NoDerivative<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid(error) => error.fmt(f),
            Self::NotAnInput(parameter) => write!(f, "{} is not an input of this actuator", parameter.name()),
            Self::NotAnEquilibrium => f.write_str("the state does not balance its pressure and the load"),
            Self::AtLimit => f.write_str("the state is at a limit point: its derivatives are infinite"),
            Self::Stationary => f.write_str("the target stands still along the branch: no pressure holds it"),
        }
    }
}

impl<T: fmt::Display + fmt::Debug> core::error::Error for NoDerivative<T> {}

/// The quantity held constant while an input changes.
#[derive(Clone, Copy, Debug)]
enum Fixed<T> {
    /// The pressure, where it is not the input itself.
    Pressure,
    /// The target of an inverse problem; its value is that of the state.
    Target(Target<T>),
}

/// A state prepared for derivatives.
enum Point<T: Real> {
    Straight(StraightPoint<T>),
    Bent(BentPoint<T>),
}

impl<T: Real> Point<T> {
    /// The change of the state with one input, and of what measures its deformation (see [`Actuator::condition`]).
    fn change(&self, of: Parameter, fixed: Fixed<T>) -> Result<Change<T>, NoDerivative<T>> {
        match self {
            Self::Straight(point) => point.change(of, fixed),
            Self::Bent(point) => point.change(of, fixed),
        }
    }

    /// The deformation itself.
    fn deformation(&self) -> [T; 3] {
        match self {
            Self::Straight(point) => point.deformation(),
            Self::Bent(point) => point.deformation(),
        }
    }
}

/// Derivatives with respect to one input.
struct Change<T> {
    state: State<T>,
    deformation: [T; 3],
}

impl<T: Precision> Actuator<T> {
    /// The inputs that the equilibria of this actuator depend on.
    ///
    /// ```
    /// use fra_model::*;
    /// let actuator = Actuator::new(&ActuatorParameters {
    ///     motion: Motion::Expansion,
    ///     inner_radius_m: 6e-3_f64,
    ///     outer_radius_m: 8e-3,
    ///     length_m: 0.1,
    ///     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
    ///     fiber: None,
    /// }).unwrap();
    /// let state = actuator.forward(20e3, &Load::none()).unwrap().state;
    /// for parameter in actuator.inputs() {
    ///     let change = actuator.sensitivity(&state, &Load::none(), parameter).unwrap();
    ///     assert!(change.outer_radius_m.is_finite());
    /// }
    /// // A bare tube has no fiber angle.
    /// let refused = actuator.sensitivity(&state, &Load::none(), Parameter::FiberAngle).unwrap_err();
    /// assert_eq!(refused.to_string(), "angle_rad is not an input of this actuator");
    /// ```
    pub fn inputs(&self) -> impl Iterator<Item = Parameter> + use<T> {
        let inputs = Inputs::new(self, T::zero(), &Load::none());
        Parameter::ALL.into_iter().filter(move |parameter| inputs.get(*parameter).is_some())
    }

    /// Derivatives of every field of an equilibrium with respect to one input, the others unchanged: per unit of the input, so
    /// `volume_m3` of the answer is m3/rad for [`Parameter::FiberAngle`]. At a given pressure: `pressure_pa` of the answer is 0, or 1
    /// for the pressure itself.
    ///
    /// `state` is an equilibrium of this actuator under `load`, as [`forward`](Self::forward) and [`inverse`](Self::inverse) return it.
    /// Towards a limit point the derivatives grow without bound.
    ///
    /// # Errors
    /// [`NoDerivative`], as its variants say.
    pub fn sensitivity(
        &self,
        state: &State<T>,
        load: &Load<T>,
        parameter: Parameter,
    ) -> Result<State<T>, NoDerivative<T>> {
        T::sensitivity(self, state, load, None, parameter)
    }

    /// The counterpart of [`sensitivity`](Self::sensitivity) for the inverse problem: the change with an input when the pressure is
    /// adapted so that the target stays reached. `pressure_pa` of the answer is `dP/dp = -(dq/dp)/(dq/dP)` for a target `q`.
    ///
    /// Only the kind of `target` counts: its value is that of `state`. Limit points are no obstacle here: at one, `dP/dp` is the
    /// derivative of the limit pressure.
    ///
    /// # Errors
    /// [`NoDerivative`], as its variants say.
    pub fn inverse_sensitivity(
        &self,
        state: &State<T>,
        load: &Load<T>,
        target: Target<T>,
        parameter: Parameter,
    ) -> Result<State<T>, NoDerivative<T>> {
        T::sensitivity(self, state, load, Some(target), parameter)
    }

    /// Condition number of the forward problem at an equilibrium: `sum over all inputs p of |p| max|dd/dp| / max|d|`, where `d` is the
    /// deformation, `(axial_strain, volume_strain, twist_rad R_i/L)` of a straight actuator and the bend angle of a bending one.
    ///
    /// A relative error `x` of every input changes the deformation by at most `x` times this number, relative to its largest
    /// component. So no solver can promise more than a small multiple of it times the rounding of `T`. Zero where nothing is deformed.
    ///
    /// # Errors
    /// [`NoDerivative`], as its variants say.
    pub fn condition(&self, state: &State<T>, load: &Load<T>) -> Result<T, NoDerivative<T>> {
        T::condition(self, state, load)
    }
}

impl<T: Real> Actuator<T> {
    /// [`Actuator::sensitivity`], or [`Actuator::inverse_sensitivity`] for a target; called by [`Precision`] alone, as the next.
    pub(crate) fn derivative(
        &self,
        state: &State<T>,
        load: &Load<T>,
        target: Option<Target<T>>,
        parameter: Parameter,
    ) -> Result<State<T>, NoDerivative<T>> {
        if target.is_some() && parameter == Parameter::Pressure {
            return Err(NoDerivative::NotAnInput(parameter));
        }
        let fixed = target.map_or(Fixed::Pressure, Fixed::Target);
        Ok(self.point(state, load)?.change(parameter, fixed)?.state)
    }

    pub(crate) fn condition_number(&self, state: &State<T>, load: &Load<T>) -> Result<T, NoDerivative<T>> {
        let point = self.point(state, load)?;
        let deformation = largest(point.deformation());
        if deformation == T::zero() {
            return Ok(T::zero());
        }
        let inputs = Inputs::new(self, state.pressure_pa, load);
        let mut sum = T::zero();
        for parameter in Parameter::ALL {
            let value = Scalar::abs(inputs.get(parameter).unwrap_or(T::zero()));
            if value > T::zero() {
                sum += value * largest(point.change(parameter, Fixed::Pressure)?.deformation);
            }
        }
        Ok(sum / deformation)
    }

    fn point(&self, state: &State<T>, load: &Load<T>) -> Result<Point<T>, NoDerivative<T>> {
        load.check()?;
        let inputs = Inputs::new(self, state.pressure_pa, load);
        Ok(match self.parameters().motion {
            Motion::Bending => Point::Bent(BentPoint::new(inputs, state)?),
            Motion::Extension | Motion::Expansion | Motion::Twisting => {
                Point::Straight(StraightPoint::new(inputs.map(DoubleDouble::from), state)?)
            }
        })
    }
}

fn largest<T: Real>(deformation: [T; 3]) -> T {
    deformation.into_iter().fold(T::zero(), |most, d| Scalar::max(most, Scalar::abs(d)))
}

/// The slopes of a state, rounded; `None` where one is not finite.
fn slopes<S: Scalar, T: Real>(state: &State<Dual<S>>, round: impl Fn(S) -> T) -> Option<State<T>> {
    let mut finite = true;
    let slopes = State::combine([state], |[field]| {
        let slope = round(field.slope);
        finite &= Scalar::is_finite(slope);
        slope
    });
    finite.then_some(slopes)
}
