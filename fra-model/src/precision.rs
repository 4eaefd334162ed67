//! The scalars that actuators are solved in, and where their solvers are compiled.

use crate::actuator::Actuator;
use crate::number::real::Real;
use crate::parameters::{ActuatorParameters, InvalidParameter};
use crate::solution::{Load, PressureRange, Solution, State, Target};
use crate::{Blocked, NoDerivative, Parameter};

/// A scalar of [`Actuator`]: `f32` or `f64`.
///
/// The solvers are compiled in this crate, once, instead of in every crate that calls them. For a device, those of `f32` are compiled
/// in the calling program, with its settings: an image asks for small code.
pub trait Precision: Real + sealed::Sealed {
    entry_points!();
}

// Not generic: this is what compiles them here.
impl Precision for f32 {
    #[cfg(not(target_os = "none"))]
    entry_points!();
}

impl Precision for f64 {
    entry_points!();
}

mod sealed {
    pub trait Sealed {}

    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// The functions of [`Actuator`] behind its generic methods, in the scalar `Self`.
macro_rules! entry_points {
    () => {
        #[doc(hidden)]
        fn prepare(parameters: &ActuatorParameters<Self>) -> Result<Actuator<Self>, InvalidParameter<Self>> {
            Actuator::prepare(parameters)
        }

        #[doc(hidden)]
        fn rest(actuator: &Actuator<Self>) -> State<Self> {
            actuator.solve_rest()
        }

        #[doc(hidden)]
        fn forward(
            actuator: &Actuator<Self>,
            start: Option<&State<Self>>,
            pressure_pa: Self,
            load: &Load<Self>,
        ) -> Result<Solution<Self>, InvalidParameter<Self>> {
            actuator.solve_forward(start, pressure_pa, load)
        }

        #[doc(hidden)]
        fn forward_once(
            parameters: &ActuatorParameters<Self>,
            pressure_pa: Self,
            load: &Load<Self>,
        ) -> Result<Solution<Self>, InvalidParameter<Self>> {
            Actuator::solve_forward_once(parameters, pressure_pa, load)
        }

        #[doc(hidden)]
        fn forward_near(
            actuator: &Actuator<Self>,
            start: &State<Self>,
            pressure_pa: Self,
            load: &Load<Self>,
            budget: u32,
        ) -> Result<Solution<Self>, InvalidParameter<Self>> {
            actuator.solve_forward_near(start, pressure_pa, load, budget)
        }

        #[doc(hidden)]
        fn inverse(
            actuator: &Actuator<Self>,
            start: Option<&State<Self>>,
            range: &PressureRange<Self>,
            target: Target<Self>,
            load: &Load<Self>,
        ) -> Result<Solution<Self>, InvalidParameter<Self>> {
            actuator.solve_inverse(start, range, target, load)
        }

        #[doc(hidden)]
        fn inverse_all(
            actuator: &Actuator<Self>,
            range: &PressureRange<Self>,
            target: Target<Self>,
            load: &Load<Self>,
            each: &mut dyn FnMut(&Solution<Self>),
        ) -> Result<bool, InvalidParameter<Self>> {
            actuator.solve_inverse_all(range, target, load, each)
        }

        #[doc(hidden)]
        fn inverse_near(
            actuator: &Actuator<Self>,
            start: &State<Self>,
            target: Target<Self>,
            load: &Load<Self>,
            budget: u32,
        ) -> Result<Solution<Self>, InvalidParameter<Self>> {
            actuator.solve_inverse_near(start, target, load, budget)
        }

        #[doc(hidden)]
        fn blocked(
            actuator: &Actuator<Self>,
            pressure_pa: Self,
            axial_stretch: Self,
            twist_rad: Self,
        ) -> Result<Blocked<Self>, InvalidParameter<Self>> {
            actuator.solve_blocked(pressure_pa, axial_stretch, twist_rad)
        }

        #[doc(hidden)]
        fn sensitivity(
            actuator: &Actuator<Self>,
            state: &State<Self>,
            load: &Load<Self>,
            target: Option<Target<Self>>,
            parameter: Parameter,
        ) -> Result<State<Self>, NoDerivative<Self>> {
            actuator.derivative(state, load, target, parameter)
        }

        #[doc(hidden)]
        fn blocked_sensitivity(
            actuator: &Actuator<Self>,
            blocked: &Blocked<Self>,
            parameter: Parameter,
        ) -> Result<Load<Self>, NoDerivative<Self>> {
            actuator.blocked_derivative(blocked, parameter)
        }

        #[doc(hidden)]
        fn condition(
            actuator: &Actuator<Self>,
            state: &State<Self>,
            load: &Load<Self>,
        ) -> Result<Self, NoDerivative<Self>> {
            actuator.condition_number(state, load)
        }
    };
}
use entry_points;
