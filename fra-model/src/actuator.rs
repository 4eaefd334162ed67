//! The door of a host: one actuator, parameters in, equilibria out.

use crate::number::real::Real;
#[cfg(not(target_os = "none"))]
use crate::parameters::Fiber;
use crate::parameters::{ActuatorParameters, InvalidParameter, Motion, require};
use crate::precision::Precision;
use crate::solution::{Load, PressureRange, Solution, State, Status, Target};
use crate::solve::bend::Bender;
use crate::solve::blocked::Blocked;
use crate::solve::tube::Tube;

/// One actuator, checked and ready to solve. The entry point of a host; a device has [`Tracker`](crate::Tracker).
///
/// Every solution lies on the branch of stable equilibria connected to zero pressure. Beyond that branch's limit point the only
/// result is the limit pressure.
#[derive(Clone, Copy, Debug)]
pub struct Actuator<T: Real> {
    parameters: ActuatorParameters<T>,
    #[cfg(not(target_os = "none"))]
    second_fiber: Option<Fiber<T>>,
    body: Body<T>,
}

#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "no heap to box the larger one on")]
enum Body<T: Real> {
    Straight(Tube<T>),
    Bending(Bender<T>),
}

impl<T: Precision> Actuator<T> {
    /// Checks the parameters and prepares the solver.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the first field that is not accepted.
    pub fn new(parameters: &ActuatorParameters<T>) -> Result<Self, InvalidParameter<T>> {
        T::prepare(parameters)
    }

    /// The state without pressure and load.
    pub fn rest(&self) -> State<T> {
        T::rest(self)
    }

    /// The equilibrium at a gauge pressure, Pa, reached from rest by first applying the load, then the pressure.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the pressure or the load is not finite.
    pub fn forward(&self, pressure_pa: T, load: &Load<T>) -> Result<Solution<T>, InvalidParameter<T>> {
        T::forward(self, None, pressure_pa, load)
    }

    /// [`new`](Self::new) and [`forward`](Self::forward) for a single query, with the same result. Of an unloaded straight actuator it
    /// prepares only the parts of the solver that the query needs.
    ///
    /// # Errors
    /// As [`new`](Self::new) and [`forward`](Self::forward).
    pub fn forward_once(
        parameters: &ActuatorParameters<T>,
        pressure_pa: T,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        T::forward_once(parameters, pressure_pa, load)
    }

    /// [`forward`](Self::forward), started from an earlier state of this actuator under the same load; from rest where that fails.
    ///
    /// # Errors
    /// As [`forward`](Self::forward).
    pub fn forward_from(
        &self,
        start: &State<T>,
        pressure_pa: T,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        T::forward(self, Some(start), pressure_pa, load)
    }

    /// [`forward_from`](Self::forward_from) without the restart from rest, and with bounded work as
    /// [`inverse_near`](Self::inverse_near).
    ///
    /// # Errors
    /// As [`forward`](Self::forward).
    pub fn forward_near(
        &self,
        start: &State<T>,
        pressure_pa: T,
        load: &Load<T>,
        budget: u32,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        T::forward_near(self, start, pressure_pa, load, budget)
    }

    /// The gauge pressure at which the actuator reaches a deformation, and the state there.
    ///
    /// Of several such pressures, the answer is the first on raising the pressure from zero. The result is a vacuum only if no pressure
    /// reaches the target, and never below [`PressureRange::physical`].
    ///
    /// # Errors
    /// [`InvalidParameter`] when the target is out of its range or not one of this motion's, or the load is not finite.
    pub fn inverse(&self, target: Target<T>, load: &Load<T>) -> Result<Solution<T>, InvalidParameter<T>> {
        self.inverse_within(&PressureRange::physical(), target, load)
    }

    /// [`inverse`](Self::inverse) restricted to a range of pressures. There is no solution if nothing in the range reaches the target.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse), and when the range is not finite or empty.
    pub fn inverse_within(
        &self,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        T::inverse(self, None, range, target, load)
    }

    /// Calls `each` with every equilibrium of the branch that has a deformation and whose pressure lies in a range: first the pressures,
    /// upwards from zero, then the vacuums, downwards. Returns whether the search reached the ends of the branch or of the range.
    ///
    /// # Errors
    /// As [`inverse_within`](Self::inverse_within).
    pub fn inverse_all(
        &self,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
        each: &mut dyn FnMut(&Solution<T>),
    ) -> Result<bool, InvalidParameter<T>> {
        T::inverse_all(self, range, target, load, each)
    }

    /// [`inverse`](Self::inverse), started from an earlier state of this actuator under the same load: of several pressures
    /// it finds the one next to that state. From rest where that fails.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse).
    pub fn inverse_from(
        &self,
        start: &State<T>,
        target: Target<T>,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        T::inverse(self, Some(start), &PressureRange::physical(), target, load)
    }

    /// [`inverse_from`](Self::inverse_from) without the restart from rest, in bounded time: about `budget`
    /// Newton iterations. Some tens more finish the last search, or run in double-double arithmetic for stiff layers or smeared
    /// fibers. The status reports a budget that was too small and a target out of reach from that state. A bending actuator has a
    /// bounded inverse of its own and takes no budget.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse).
    pub fn inverse_near(
        &self,
        start: &State<T>,
        target: Target<T>,
        load: &Load<T>,
        budget: u32,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        T::inverse_near(self, start, target, load, budget)
    }

    /// Blocked force and torque of a straight actuator at an axial stretch, a twist, rad, and a gauge pressure, Pa, with its
    /// stiffness and the lever arms of the pressure.
    ///
    /// This replaces `N = P pi r_i^2` of eq. (9), which is the force of the wall and not that of the actuator.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a value is not finite, the stretch is not positive, or the actuator bends.
    pub fn blocked(&self, pressure_pa: T, axial_stretch: T, twist_rad: T) -> Result<Blocked<T>, InvalidParameter<T>> {
        T::blocked(self, pressure_pa, axial_stretch, twist_rad)
    }
}

impl<T: Real> Actuator<T> {
    /// The same actuator, solved by continuation alone: slower, for comparison.
    #[doc(hidden)]
    pub fn by_search(self) -> Self {
        let body = match self.body {
            Body::Straight(tube) => Body::Straight(tube.by_search()),
            bending => bending,
        };
        Self { body, ..self }
    }

    /// The parameters it was built from, without a second winding.
    pub fn parameters(&self) -> &ActuatorParameters<T> {
        &self.parameters
    }

    /// The same actuator with a second winding, on a host: a straight one wound twice, at two angles or in two places, such as a helix and
    /// an axial thread.
    ///
    /// The energies of both windings add up; each has its own signed angle, families, modulus, thickness and place.
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
    /// let solution = Actuator::new(&parameters)?.with_second_fiber(&axial)?.forward(30e3, &Load::none())?;
    /// assert_eq!(solution.status, Status::Solved);
    /// assert!(solution.state.axial_strain < 1e-3);
    /// # Ok::<(), InvalidParameter<f64>>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidParameter`] names the first field that is not accepted as `second_fiber.*`. A bending actuator is not accepted: finite
    /// elements of the section answer for it.
    #[cfg(not(target_os = "none"))]
    pub fn with_second_fiber(self, fiber: &Fiber<T>) -> Result<Self, InvalidParameter<T>> {
        let Body::Straight(tube) = self.body else {
            let allowed = "straight actuators only: a bending one has one winding";
            return Err(InvalidParameter { field: "second_fiber.angle_rad", value: fiber.angle_rad, allowed });
        };
        let alone = ActuatorParameters { fiber: Some(*fiber), ..self.parameters };
        alone.check().map_err(|error| InvalidParameter { field: field_of_second(error.field), ..error })?;
        Ok(Self { second_fiber: Some(*fiber), body: Body::Straight(tube.with_second(fiber)), ..self })
    }

    /// The second winding.
    #[cfg(not(target_os = "none"))]
    pub fn second_fiber(&self) -> Option<&Fiber<T>> {
        self.second_fiber.as_ref()
    }

    /// First and second derivative of a bending actuator's lumen volume by its bend angle, m3/rad and m3/rad2.
    ///
    /// A bender that is held at an angle by a load exerts the moment `(P - P_0) dV/dtheta` at the gauge pressure `P`. `P_0` is the pressure that
    /// holds the angle without load. `None` for a straight actuator, for an angle that is not finite and >= 0, and for one beyond the winding's reach.
    pub fn volume_by_bend(&self, bend_angle_rad: T) -> Option<[T; 2]> {
        match &self.body {
            Body::Bending(bender) if bend_angle_rad.is_finite() && bend_angle_rad >= T::zero() => {
                bender.volume_by_bend(bend_angle_rad)
            }
            Body::Bending(_) | Body::Straight(_) => None,
        }
    }

    /// The tube of a straight actuator.
    pub(crate) fn tube(&self) -> Option<&Tube<T>> {
        match &self.body {
            Body::Straight(tube) => Some(tube),
            Body::Bending(_) => None,
        }
    }

    /// The bender of a bending actuator.
    pub(crate) fn bender(&self) -> Option<&Bender<T>> {
        match &self.body {
            Body::Straight(_) => None,
            Body::Bending(bender) => Some(bender),
        }
    }

    /// [`Actuator::new`]; this and the following are called by [`Precision`] alone.
    pub(crate) fn prepare(parameters: &ActuatorParameters<T>) -> Result<Self, InvalidParameter<T>> {
        parameters.check()?;
        let body = match parameters.motion {
            Motion::Bending => Body::Bending(Bender::new(parameters)),
            Motion::Extension | Motion::Expansion | Motion::Twisting => Body::Straight(Tube::new(parameters)),
        };
        Ok(Self {
            parameters: *parameters,
            #[cfg(not(target_os = "none"))]
            second_fiber: None,
            body,
        })
    }

    pub(crate) fn solve_forward_once(
        parameters: &ActuatorParameters<T>,
        pressure_pa: T,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        parameters.check()?;
        load.check()?;
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        let is_plain = parameters.motion != Motion::Bending && load.is_none();
        let found = if is_plain { Tube::forward_once(parameters, pressure_pa) } else { None };
        found.map_or_else(
            || Self::prepare(parameters)?.solve_forward(None, pressure_pa, load),
            |found| Ok(found.sound()),
        )
    }

    pub(crate) fn solve_rest(&self) -> State<T> {
        match &self.body {
            Body::Straight(tube) => tube.rest(),
            Body::Bending(bender) => bender.rest(),
        }
    }

    pub(crate) fn solve_forward(
        &self,
        start: Option<&State<T>>,
        pressure_pa: T,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        load.check()?;
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        let solution = match &self.body {
            Body::Straight(tube) => tube.forward(start, pressure_pa, load),
            Body::Bending(bender) => bender.forward(start, pressure_pa, load),
        };
        Ok(solution.sound())
    }

    pub(crate) fn solve_forward_near(
        &self,
        start: &State<T>,
        pressure_pa: T,
        load: &Load<T>,
        budget: u32,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        load.check()?;
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        Ok(match &self.body {
            Body::Straight(tube) => tube.forward_near(start, pressure_pa, load, budget),
            Body::Bending(bender) => bender.forward(Some(start), pressure_pa, load),
        })
    }

    pub(crate) fn solve_inverse(
        &self,
        start: Option<&State<T>>,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        load.check()?;
        range.check()?;
        let solution = match &self.body {
            Body::Straight(tube) => tube.inverse(start, range, target, load),
            Body::Bending(bender) => bender.inverse(target, load).map(|solution| within(range, solution)),
        };
        solution.map(Solution::sound)
    }

    pub(crate) fn solve_inverse_all(
        &self,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
        each: &mut dyn FnMut(&Solution<T>),
    ) -> Result<bool, InvalidParameter<T>> {
        load.check()?;
        range.check()?;
        match &self.body {
            Body::Straight(tube) => tube.inverse_all(range, target, load, each),
            Body::Bending(bender) => {
                let solution = within(range, bender.inverse(target, load)?).sound();
                if solution.status == Status::Solved {
                    each(&solution);
                }
                Ok(solution.status != Status::NotConverged)
            }
        }
    }

    pub(crate) fn solve_inverse_near(
        &self,
        start: &State<T>,
        target: Target<T>,
        load: &Load<T>,
        budget: u32,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        load.check()?;
        match &self.body {
            Body::Straight(tube) => tube.inverse_near(start, target, load, budget),
            Body::Bending(bender) => bender.inverse(target, load),
        }
    }

    pub(crate) fn solve_blocked(
        &self,
        pressure_pa: T,
        axial_stretch: T,
        twist_rad: T,
    ) -> Result<Blocked<T>, InvalidParameter<T>> {
        require(pressure_pa.is_finite(), "pressure_pa", pressure_pa, "finite")?;
        let positive = axial_stretch.is_finite() && axial_stretch > T::zero();
        require(positive, "axial_stretch", axial_stretch, "finite and > 0")?;
        require(twist_rad.is_finite(), "twist_rad", twist_rad, "finite")?;
        match &self.body {
            Body::Straight(tube) => Ok(tube.blocked(pressure_pa, axial_stretch, twist_rad)),
            Body::Bending(_) => Err(InvalidParameter {
                field: "axial_stretch",
                value: axial_stretch,
                allowed: "straight actuators only: a bending one is held by its load",
            }),
        }
    }
}

/// Name of a field of the second winding.
#[cfg(not(target_os = "none"))]
fn field_of_second(field: &'static str) -> &'static str {
    match field {
        "angle_rad" => "second_fiber.angle_rad",
        "modulus_pa" => "second_fiber.modulus_pa",
        "thickness_m" => "second_fiber.thickness_m",
        "radius_m" => "second_fiber.radius_m",
        other => other,
    }
}

/// The one solution of a bend, if its pressure lies in the range.
pub(crate) fn within<T: Real>(range: &PressureRange<T>, solution: Solution<T>) -> Solution<T> {
    let outside = solution.status == Status::Solved && !range.contains(solution.state.pressure_pa);
    if outside { Solution { status: Status::NoSolution, ..solution } } else { solution }
}
