//! Extension, expansion and twisting: a straight tube under pressure, forward and inverse.

use nalgebra::Vector3;

use crate::branch::{Branch, Found, Goal, LARGEST_PRESSURE, Point};
use crate::energy::Wall;
use crate::held::{Held, hold};
use crate::parameters::{ActuatorParameters, InvalidParameter, require};
use crate::real::{Real, epsilon, real};
use crate::refine::{Loads, Wanted, refined};
use crate::solution::{Load, Solution, State, Status, Target};

/// Newton iterations that no search of a whole branch needs.
const WHOLE_BRANCH: u32 = 100_000;

/// A straight tube, ready to solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube<T: Real> {
    wall: Wall<T>,
    inner_radius_m: T,
    outer_radius_m: T,
    length_m: T,
    shear_modulus_pa: T,
}

/// Forward problem: `u_w` equals `P/mu1`.
struct AtPressure<T>(T);

impl<T: Real> Goal<T> for AtPressure<T> {
    fn measure(&self, point: &Point<T>) -> (T, T) {
        (point.pressure - self.0, point.slope)
    }

    fn noise(&self, point: &Point<T>) -> T {
        point.pressure_noise
    }

    fn wanted(&self) -> Wanted<T> {
        Wanted::Pressure(self.0)
    }
}

/// Inverse problem: a linear function of `(e, w, g)` reaches a value. Every target of a straight tube has this form.
struct AtDeformation<T: Real> {
    weights: Vector3<T>,
    value: T,
    /// What the last digit of the target is worth in `value`.
    last_digit: T,
}

impl<T: Real> Goal<T> for AtDeformation<T> {
    fn measure(&self, point: &Point<T>) -> (T, T) {
        (self.weights.dot(&point.at) - self.value, self.weights.dot(&point.tangent))
    }

    fn noise(&self, point: &Point<T>) -> T {
        let rounding = point.at.abs() * (real::<T>(8.0) * epsilon::<T>());
        self.weights.abs().dot(&(rounding + point.settling_noise)) + self.last_digit
    }

    fn wanted(&self) -> Wanted<T> {
        Wanted::Deformation(self.weights, self.value)
    }
}

impl<T: Real> AtDeformation<T> {
    /// Whether the goal lies towards larger volume, to first order.
    fn approached_outwards(&self, from: &Point<T>) -> bool {
        let (value, rate) = self.measure(from);
        -value / rate > T::zero()
    }
}

impl<T: Real> Tube<T> {
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Self {
        Self {
            wall: Wall::new(parameters),
            inner_radius_m: parameters.inner_radius_m,
            outer_radius_m: parameters.outer_radius_m,
            length_m: parameters.length_m,
            shear_modulus_pa: parameters.material.shear_modulus_pa(),
        }
    }

    /// The equilibrium at a gauge pressure.
    pub(crate) fn forward(&self, start: Option<&State<T>>, pressure_pa: T, load: &Load<T>) -> Solution<T> {
        let wanted = pressure_pa / self.shear_modulus_pa;
        let goal = AtPressure(wanted);
        let branch = self.branch(load, WHOLE_BRANCH);
        let towards = |from: &Point<T>| wanted > from.pressure;
        let anywhere = real(LARGEST_PRESSURE);
        let mut solution = match start.map(|start| self.search_from(&branch, start, &goal, towards)) {
            Some(warm) if warm.status == Status::Solved => warm,
            _ => self.search(&branch, &goal, towards, anywhere),
        };
        if solution.status == Status::Solved {
            let error = (solution.state.pressure_pa - pressure_pa).abs() / self.shear_modulus_pa;
            solution.residual = solution.residual.max(error);
            solution.state.pressure_pa = pressure_pa;
        }
        solution
    }

    /// The first pressure on the way up that reaches a target; a vacuum where no pressure does, or where it takes less and the
    /// pressure exceeds the shear modulus, beyond the work of an actuator.
    pub(crate) fn inverse(
        &self,
        start: Option<&State<T>>,
        target: Target<T>,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        let goal = self.goal(target)?;
        if let Some(start) = start {
            let branch = self.branch(load, WHOLE_BRANCH);
            let solution = self.search_from(&branch, start, &goal, |from| goal.approached_outwards(from));
            if solution.status == Status::Solved {
                return Ok(solution);
            }
        }
        let branch = self.branch(load, WHOLE_BRANCH);
        let pressed = self.search(&branch, &goal, |_| true, real(LARGEST_PRESSURE));
        if goal.weights.z != T::zero() && !branch.twists {
            return Ok(pressed);
        }
        let solved = pressed.status == Status::Solved;
        if solved && pressed.state.pressure_pa <= self.shear_modulus_pa {
            return Ok(pressed);
        }
        let within = if solved { pressed.state.pressure_pa / self.shear_modulus_pa } else { real(LARGEST_PRESSURE) };
        let evacuated = self.search(&branch, &goal, |_| false, within);
        let iterations = pressed.iterations + evacuated.iterations;
        let answer = if evacuated.status == Status::Solved { evacuated } else { pressed };
        Ok(Solution { iterations, ..answer })
    }

    /// The pressure next to an earlier state that reaches a target, with bounded work.
    pub(crate) fn inverse_near(
        &self,
        start: &State<T>,
        target: Target<T>,
        load: &Load<T>,
        budget: u32,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        let goal = self.goal(target)?;
        let branch = self.branch(load, budget);
        Ok(self.search_from(&branch, start, &goal, |from| goal.approached_outwards(from)))
    }

    /// The loads that hold a stretch and a twist at a gauge pressure.
    pub(crate) fn held(&self, pressure_pa: T, axial_stretch: T, twist_rad: T) -> Held<T> {
        let mu = self.shear_modulus_pa;
        let (radius, length) = (self.inner_radius_m, self.length_m);
        let point = hold(&self.wall, axial_stretch - T::one(), twist_rad * radius / length, pressure_pa / mu);
        // N = pi R_i^2 mu u_e, M = pi R_i^3 mu u_g, l = L (1 + e), Phi = g L/R_i.
        let area = T::pi() * radius * radius;
        let [by_e, by_g] = [T::one() / length, radius / length];
        let k = point.stiffness * (mu * area);
        Held {
            status: point.status,
            state: State { pressure_pa, ..self.state_at(&point.at, pressure_pa / mu, point.slope) },
            force_n: mu * area * point.loads.x,
            torque_nm: mu * area * radius * point.loads.y,
            by_pressure: [area * point.by_pressure.x, area * radius * point.by_pressure.y],
            stiffness: [[k[(0, 0)] * by_e, k[(0, 1)] * by_g], [k[(1, 0)] * radius * by_e, k[(1, 1)] * radius * by_g]],
            iterations: point.iterations,
        }
    }

    /// Undeformed, without pressure.
    pub(crate) fn rest(&self) -> State<T> {
        let mut iterations = 0;
        match self.branch(&Load::none(), WHOLE_BRANCH).at_rest(&mut iterations) {
            Found::Root(point) | Found::Limit(point) | Found::Unreached(point) | Found::Failed(point) => {
                self.state(&point)
            }
        }
    }

    fn twists(&self, load: &Load<T>) -> bool {
        self.wall.twists_by_itself() || load.torque_nm != T::zero()
    }

    fn branch(&self, load: &Load<T>, budget: u32) -> Branch<'_, T> {
        let area = T::pi() * self.inner_radius_m * self.inner_radius_m;
        Branch {
            wall: &self.wall,
            force: load.force_n / (area * self.shear_modulus_pa),
            torque: load.torque_nm / (area * self.inner_radius_m * self.shear_modulus_pa),
            twists: self.twists(load),
            budget,
        }
    }

    fn goal(&self, target: Target<T>) -> Result<AtDeformation<T>, InvalidParameter<T>> {
        let one = T::one();
        let positive = |field, v: T| require(v.is_finite() && v > T::zero(), field, v, "finite and > 0");
        // (r/R)^2 = (w + X)/(lambda X) = t  <=>  w/X - t e = t - 1
        let radius = |r: T, undeformed: T, x: T| {
            let excess = (r - undeformed) * (r + undeformed) / (undeformed * undeformed);
            let weights = Vector3::new(-(one + excess), one / x, T::zero());
            AtDeformation { weights, value: excess, last_digit: epsilon::<T>() * (one + excess) }
        };
        match target {
            Target::AxialStretch(stretch) => {
                positive("axial_stretch", stretch)?;
                let last_digit = epsilon::<T>() * stretch;
                Ok(AtDeformation { weights: Vector3::x(), value: stretch - one, last_digit })
            }
            Target::OuterRadius(r) => {
                positive("outer_radius_m", r)?;
                Ok(radius(r, self.outer_radius_m, self.wall.x_outer))
            }
            Target::InnerRadius(r) => {
                positive("inner_radius_m", r)?;
                Ok(radius(r, self.inner_radius_m, one))
            }
            Target::Twist(twist) => {
                require(twist.is_finite(), "twist_rad", twist, "finite")?;
                let value = twist * self.inner_radius_m / self.length_m;
                Ok(AtDeformation { weights: Vector3::z(), value, last_digit: epsilon::<T>() * value.abs() })
            }
            Target::BendAngle(angle) => Err(InvalidParameter {
                field: "bend_angle_rad",
                value: angle,
                allowed: "a target of bending actuators only",
            }),
        }
    }

    /// Searches from rest under the load, up to a pressure of `within` either way.
    fn search<G: Goal<T>>(
        &self,
        branch: &Branch<'_, T>,
        goal: &G,
        outwards: impl Fn(&Point<T>) -> bool,
        within: T,
    ) -> Solution<T> {
        let mut iterations = 0;
        let found = match branch.at_rest(&mut iterations) {
            Found::Root(point) if point.slope > T::zero() => {
                branch.search(point, goal, outwards(&point), within, &mut iterations)
            }
            // The load alone has no stable equilibrium: no pressure is to blame.
            Found::Root(point) | Found::Limit(point) => Found::Unreached(point),
            ended => ended,
        };
        self.solution(branch, goal, found, iterations)
    }

    /// Searches from an earlier state; not converged where that is not on the branch.
    fn search_from<G: Goal<T>>(
        &self,
        branch: &Branch<'_, T>,
        start: &State<T>,
        goal: &G,
        outwards: impl Fn(&Point<T>) -> bool,
    ) -> Solution<T> {
        let mut iterations = 0;
        match branch.resume(self.coordinates(start), &mut iterations) {
            Some(point) => {
                let anywhere = real(LARGEST_PRESSURE);
                let found = branch.search(point, goal, outwards(&point), anywhere, &mut iterations);
                self.solution(branch, goal, found, iterations)
            }
            None => Solution {
                status: Status::NotConverged,
                state: *start,
                limit_pressure_pa: None,
                residual: T::zero(),
                iterations,
            },
        }
    }

    fn solution<G: Goal<T>>(&self, branch: &Branch<'_, T>, goal: &G, found: Found<T>, iterations: u32) -> Solution<T> {
        let loads = Loads { force: branch.force, torque: branch.twists.then_some(branch.torque) };
        let refine = |point: Point<T>, wanted| refined(&self.wall, loads, wanted, &point).unwrap_or(point);
        let (status, point, limit) = match found {
            Found::Root(point) => (Status::Solved, refine(point, goal.wanted()), None),
            Found::Limit(point) => {
                let point = refine(point, Wanted::Volume);
                (Status::NoSolution, point, Some(point.pressure * self.shear_modulus_pa))
            }
            Found::Unreached(point) => (Status::NoSolution, point, None),
            Found::Failed(point) => (Status::NotConverged, point, None),
        };
        Solution { status, state: self.state(&point), limit_pressure_pa: limit, residual: point.residual, iterations }
    }

    fn state(&self, point: &Point<T>) -> State<T> {
        self.state_at(&point.at, point.pressure, point.slope)
    }

    /// The state at `(e, w, g)` with `P/mu1` and `d(P/mu1)/dw`.
    fn state_at(&self, at: &Vector3<T>, pressure: T, slope: T) -> State<T> {
        let one = T::one();
        let (e, w, g) = (at.x, at.y, at.z);
        let lambda = one + e;
        let x_outer = self.wall.x_outer;
        let rest_volume = T::pi() * self.inner_radius_m * self.inner_radius_m * self.length_m;
        State {
            pressure_pa: pressure * self.shear_modulus_pa,
            axial_stretch: lambda,
            axial_strain: e,
            inner_radius_m: self.inner_radius_m * ((one + w) / lambda).sqrt(),
            outer_radius_m: self.outer_radius_m * ((x_outer + w) / (lambda * x_outer)).sqrt(),
            twist_rad: g * self.length_m / self.inner_radius_m,
            bend_angle_rad: T::zero(),
            volume_m3: rest_volume * (one + w),
            volume_strain: w,
            compliance_m3_per_pa: rest_volume / (self.shear_modulus_pa * slope),
        }
    }

    fn coordinates(&self, state: &State<T>) -> Vector3<T> {
        Vector3::new(state.axial_strain, state.volume_strain, state.twist_rad * self.inner_radius_m / self.length_m)
    }
}
