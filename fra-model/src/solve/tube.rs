//! Extension, expansion and twisting: a straight tube under pressure, forward and inverse.

use nalgebra::Vector3;

use crate::number::real::{Real, epsilon, real};
#[cfg(not(target_os = "none"))]
use crate::parameters::Fiber;
use crate::parameters::{ActuatorParameters, InvalidParameter, require};
use crate::solution::{Load, PressureRange, Solution, State, Status, Target};
use crate::solve::blocked::{Blocked, block};
use crate::solve::closed_form::{ClosedForm, Equilibrium};
use crate::solve::continuation::{LARGEST_PRESSURE, Outcome, Point};
use crate::solve::energy::Wall;
use crate::solve::query::{Answer, Direction, Query};
use crate::solve::residual::Residual;
use crate::solve::size::Size;

/// Newton iterations that no search of a whole branch needs.
const WHOLE_BRANCH: u32 = 1_000_000;
/// Pressure below which a solution is taken for the one without pressure, in roundings of the shear modulus.
const NO_PRESSURE: f64 = 64.0;

/// A straight tube, ready to solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube<T: Real> {
    wall: Wall<T>,
    inner_radius_m: T,
    length_m: T,
    shear_modulus_pa: T,
    size: Size<T>,
}

impl<T: Real> Tube<T> {
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Self {
        let wall = Wall::new(parameters).with_closed_form(ClosedForm::new(parameters));
        let size = Size::of_tube(parameters, wall.x_outer);
        Self {
            wall,
            inner_radius_m: parameters.inner_radius_m,
            length_m: parameters.length_m,
            shear_modulus_pa: parameters.material.shear_modulus_pa(),
            size,
        }
    }

    /// The same tube with a second winding.
    #[cfg(not(target_os = "none"))]
    pub(crate) fn with_second(self, fiber: &Fiber<T>) -> Self {
        Self { wall: self.wall.with_second(fiber), ..self }
    }

    /// The equilibrium at a gauge pressure.
    pub(crate) fn forward(&self, start: Option<&State<T>>, pressure_pa: T, load: &Load<T>) -> Solution<T> {
        if let (None, true, Some(closed_form)) = (start, load.is_none(), self.closed_form())
            && let Some(found) = closed_form.pressed(pressure_pa * self.size.per_shear_modulus)
        {
            return self.solved(&found, pressure_pa);
        }
        self.forward_in_general(start, pressure_pa, load)
    }

    /// The equilibrium at a gauge pressure without load, if the closed-form solver certifies it: [`forward`](Self::forward) of a new tube
    /// without the preparation of other queries.
    pub(crate) fn forward_once(parameters: &ActuatorParameters<T>, pressure_pa: T) -> Option<Solution<T>> {
        let mut closed_form = ClosedForm::near_rest(parameters)?;
        let size = Size::of_tube(parameters, closed_form.x_outer());
        let pressure = pressure_pa * size.per_shear_modulus;
        let found = closed_form.pressed_near_rest(pressure).or_else(|| {
            closed_form.certify();
            closed_form.pressed(pressure)
        })?;
        Some(solution(&size, &found, pressure_pa))
    }

    /// The same from another start, under a load, or without a certificate of the closed-form solver.
    #[inline(never)]
    fn forward_in_general(&self, start: Option<&State<T>>, pressure_pa: T, load: &Load<T>) -> Solution<T> {
        let query = self.query(Residual::Pressure(pressure_pa / self.shear_modulus_pa), load);
        let warm = start.map(|start| self.solve(&self.from(start, query)));
        let warm = warm.filter(|warm| warm.status == Status::Solved);
        self.at_pressure(pressure_pa, warm.unwrap_or_else(|| self.solve(&query)))
    }

    /// The equilibrium at a gauge pressure next to an earlier state, with bounded work.
    pub(crate) fn forward_near(&self, start: &State<T>, pressure_pa: T, load: &Load<T>, budget: u32) -> Solution<T> {
        let query = self.query(Residual::Pressure(pressure_pa / self.shear_modulus_pa), load);
        self.at_pressure(pressure_pa, self.solve(&self.from(start, Query { budget, ..query })))
    }

    /// A solution at exactly the requested pressure.
    fn at_pressure(&self, pressure_pa: T, mut solution: Solution<T>) -> Solution<T> {
        if solution.status == Status::Solved {
            let error = (solution.state.pressure_pa - pressure_pa).abs() / self.shear_modulus_pa;
            solution.residual = solution.residual.max(error);
            solution.state.pressure_pa = pressure_pa;
        }
        solution
    }

    /// The first pressure in a range, on the way up, that reaches a target; the first vacuum in it, on the way down, where no pressure does.
    pub(crate) fn inverse(
        &self,
        start: Option<&State<T>>,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        let query = self.query(self.residual(target)?, load);
        if let Some(start) = start {
            let warm = self.solve(&self.from(start, query));
            if warm.status == Status::Solved && range.contains(warm.state.pressure_pa) {
                return Ok(warm);
            }
        }
        let pressed = self.each(&query, Direction::Outwards, range, &mut |_| false);
        if pressed.status != Status::NoSolution || !self.has_vacuums(&query, range) {
            return Ok(pressed);
        }
        let evacuated = self.each(&query, Direction::Inwards, range, &mut |_| false);
        let iterations = pressed.iterations.saturating_add(evacuated.iterations);
        let answer = if evacuated.status == Status::NoSolution { pressed } else { evacuated };
        Ok(Solution { iterations, ..answer })
    }

    /// Every solution in a range, pressures first, each time from the one next to zero; whether the search came to its end.
    pub(crate) fn inverse_all(
        &self,
        range: &PressureRange<T>,
        target: Target<T>,
        load: &Load<T>,
        each: &mut dyn FnMut(&Solution<T>),
    ) -> Result<bool, InvalidParameter<T>> {
        let query = self.query(self.residual(target)?, load);
        let mut at_zero = false;
        let pressed = self.each(&query, Direction::Outwards, range, &mut |solution| {
            at_zero |= solution.state.pressure_pa == T::zero();
            each(solution);
            true
        });
        let mut complete = pressed.status == Status::NoSolution;
        if self.has_vacuums(&query, range) {
            // The solution without pressure, met again, is that of both ways.
            let rounding = real::<T>(NO_PRESSURE) * epsilon::<T>() * self.shear_modulus_pa;
            let evacuated = self.each(&query, Direction::Inwards, range, &mut |solution| {
                if !at_zero || solution.state.pressure_pa < -rounding {
                    each(solution);
                }
                true
            });
            complete &= evacuated.status == Status::NoSolution;
        }
        Ok(complete)
    }

    /// Whether the range has vacuums, and one could reach the target: a tube that does not twist cannot be made to.
    fn has_vacuums(&self, query: &Query<T>, range: &PressureRange<T>) -> bool {
        let twist = match query.residual {
            Residual::Deformation { weights, .. } => weights.z != T::zero(),
            Residual::Pressure(_) => false,
        };
        range.least_pa < T::zero() && (query.twists || !twist)
    }

    /// Follows the branch from rest in one direction, and calls `goes_on` with every solution in the range. Returns the solution at which
    /// `goes_on` was false, or the reason for which the search ended.
    fn each(
        &self,
        query: &Query<T>,
        direction: Direction,
        range: &PressureRange<T>,
        goes_on: &mut dyn FnMut(&Solution<T>) -> bool,
    ) -> Solution<T> {
        let zero = T::zero();
        let outwards = direction == Direction::Outwards;
        let end_pa = if outwards { range.most_pa.max(zero) } else { -range.least_pa.min(zero) };
        let within = (end_pa / self.shear_modulus_pa).min(real(LARGEST_PRESSURE));
        let query = Query { direction, within, ..*query };
        let mut solution = self.solve(&query);
        let mut iterations = solution.iterations;
        while solution.status == Status::Solved {
            solution = Solution { iterations, ..solution }.sound();
            if solution.status != Status::Solved {
                return solution;
            }
            // Rounding may put a solution without pressure on the wrong side of zero.
            let found_pa = solution.state.pressure_pa;
            let pressure_pa = if outwards { found_pa.max(zero) } else { found_pa.min(zero) };
            solution.state.pressure_pa = pressure_pa;
            if pressure_pa.abs() > end_pa {
                return Solution { status: Status::NoSolution, ..solution };
            }
            if range.contains(pressure_pa) && !goes_on(&solution) {
                return solution;
            }
            let next = Query { is_left: true, ..self.from(&solution.state, query) };
            solution = self.searched(&next);
            iterations = iterations.saturating_add(solution.iterations);
        }
        Solution { iterations, ..solution }
    }

    /// The pressure next to an earlier state that reaches a target, with bounded work.
    pub(crate) fn inverse_near(
        &self,
        start: &State<T>,
        target: Target<T>,
        load: &Load<T>,
        budget: u32,
    ) -> Result<Solution<T>, InvalidParameter<T>> {
        let query = Query { budget, ..self.query(self.residual(target)?, load) };
        Ok(self.solve(&self.from(start, query)))
    }

    /// The blocked loads at a stretch, a twist and a gauge pressure.
    pub(crate) fn blocked(&self, pressure_pa: T, axial_stretch: T, twist_rad: T) -> Blocked<T> {
        let mu = self.shear_modulus_pa;
        let (radius, length) = (self.inner_radius_m, self.length_m);
        let point = block(&self.wall, axial_stretch - T::one(), twist_rad * radius / length, pressure_pa / mu);
        // N = pi R_i^2 mu u_e, M = pi R_i^3 mu u_g, l = L (1 + e), Phi = g L/R_i.
        let area = T::pi() * radius * radius;
        let [by_e, by_g] = [T::one() / length, radius / length];
        let k = point.stiffness * (mu * area);
        Blocked {
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
        let query = self.query(Residual::Pressure(T::zero()), &Load::none());
        self.solve(&query).state
    }

    /// The query for the root of a residual under a load, from rest.
    fn query(&self, residual: Residual<T>, load: &Load<T>) -> Query<T> {
        let area = T::pi() * self.inner_radius_m * self.inner_radius_m;
        Query {
            force: load.force_n / (area * self.shear_modulus_pa),
            torque: load.torque_nm / (area * self.inner_radius_m * self.shear_modulus_pa),
            twists: self.wall.twists_by_itself() || load.torque_nm != T::zero(),
            budget: WHOLE_BRANCH,
            residual,
            start: None,
            is_left: false,
            direction: Direction::Towards,
            within: real(LARGEST_PRESSURE),
        }
    }

    /// The same query from an earlier state.
    fn from(&self, start: &State<T>, query: Query<T>) -> Query<T> {
        Query { start: Some(self.coordinates(start)), ..query }
    }

    fn residual(&self, target: Target<T>) -> Result<Residual<T>, InvalidParameter<T>> {
        residual(&self.size, self.twist_rate_per_rad(), target)
    }

    /// The same tube without the closed-form solver: every query is answered by continuation.
    pub(crate) fn by_search(self) -> Self {
        Self { wall: self.wall.with_closed_form(None), ..self }
    }

    /// The closed-form solution where it is certified, else that of the continuation.
    fn solve(&self, query: &Query<T>) -> Solution<T> {
        if let Some(found) = self.closed_form().and_then(|solver| solver.answer(query)) {
            return self.solved(&found, found.pressure * self.shear_modulus_pa);
        }
        self.searched(query)
    }

    /// The solution of the continuation.
    fn searched(&self, query: &Query<T>) -> Solution<T> {
        let Answer { found, iterations } = query.answer(&self.wall);
        let (status, point, limit) = match found {
            Outcome::Root(point) => (Status::Solved, point, None),
            Outcome::Limit(point) => (Status::NoSolution, point, Some(point.pressure * self.shear_modulus_pa)),
            Outcome::Unreached(point) => (Status::NoSolution, point, None),
            Outcome::Failed(point) => (Status::NotConverged, point, None),
        };
        let state = self.state(&point);
        Solution { status, state, limit_pressure_pa: limit, residual: point.residual, iterations }
    }

    /// The closed-form solver, if the wall has closed forms.
    pub(crate) fn closed_form(&self) -> Option<&ClosedForm<T>> {
        self.wall.closed_form()
    }

    /// Dimensions that convert strains.
    pub(crate) fn size(&self) -> Size<T> {
        self.size
    }

    /// The solution of the closed-form solver at a pressure.
    #[inline(always)]
    pub(crate) fn solved(&self, found: &Equilibrium<T>, pressure_pa: T) -> Solution<T> {
        solution(&self.size, found, pressure_pa)
    }

    /// The state at `(e, w, g)` with `dw/d(P/mu1)`.
    #[inline(always)]
    fn stretched(&self, e: T, w: T, g: T, volume_rate: T, pressure_pa: T) -> State<T> {
        self.size.state(e, w, g, volume_rate, pressure_pa)
    }

    fn state(&self, point: &Point<T>) -> State<T> {
        self.state_at(&point.at, point.pressure, point.slope)
    }

    /// The state at `(e, w, g)` with `P/mu1` and `d(P/mu1)/dw`.
    fn state_at(&self, at: &Vector3<T>, pressure: T, slope: T) -> State<T> {
        self.stretched(at.x, at.y, at.z, T::one() / slope, pressure * self.shear_modulus_pa)
    }

    fn coordinates(&self, state: &State<T>) -> Vector3<T> {
        coordinates(self.twist_rate_per_rad(), state)
    }

    fn twist_rate_per_rad(&self) -> T {
        self.inner_radius_m / self.length_m
    }
}

/// The solution of the closed-form solver at a pressure, for a tube of a size.
#[inline(always)]
fn solution<T: Real>(size: &Size<T>, found: &Equilibrium<T>, pressure_pa: T) -> Solution<T> {
    let Equilibrium { e, w, g, volume_rate, residual, evaluations, .. } = *found;
    let state = size.state(e, w, g, volume_rate, pressure_pa);
    Solution { status: Status::Solved, state, limit_pressure_pa: None, residual, iterations: evaluations }
}

/// The residual of a target: a straight tube's size and its twist rate, `R_i/L`, for a twist of 1 rad.
pub(crate) fn residual<T: Real>(
    size: &Size<T>,
    twist_rate_per_rad: T,
    target: Target<T>,
) -> Result<Residual<T>, InvalidParameter<T>> {
    let one = T::one();
    let positive = |field, v: T| require(v.is_finite() && v > T::zero(), field, v, "finite and > 0");
    // (r/R)^2 = (w + X)/(lambda X) = t  <=>  w/X - t e = t - 1
    let radius = |r: T, undeformed: T, x: T| {
        let excess = (r - undeformed) * (r + undeformed) / (undeformed * undeformed);
        let weights = Vector3::new(-(one + excess), one / x, T::zero());
        Residual::Deformation { weights, value: excess, last_digit: epsilon::<T>() * (one + excess) }
    };
    match target {
        Target::AxialStretch(stretch) => {
            positive("axial_stretch", stretch)?;
            let last_digit = epsilon::<T>() * stretch;
            Ok(Residual::Deformation { weights: Vector3::x(), value: stretch - one, last_digit })
        }
        Target::OuterRadius(r) => {
            positive("outer_radius_m", r)?;
            Ok(radius(r, size.outer_radius_m, size.x_outer))
        }
        Target::InnerRadius(r) => {
            positive("inner_radius_m", r)?;
            Ok(radius(r, size.inner_radius_m, one))
        }
        Target::Twist(twist) => {
            require(twist.is_finite(), "twist_rad", twist, "finite")?;
            let value = twist * twist_rate_per_rad;
            Ok(Residual::Deformation { weights: Vector3::z(), value, last_digit: epsilon::<T>() * value.abs() })
        }
        Target::BendAngle(angle) => Err(InvalidParameter {
            field: "bend_angle_rad",
            value: angle,
            allowed: "a target of bending actuators only",
        }),
    }
}

/// `(e, w, g)` of a state of a straight tube.
pub(crate) fn coordinates<T: Real>(twist_rate_per_rad: T, state: &State<T>) -> Vector3<T> {
    Vector3::new(state.axial_strain, state.volume_strain, state.twist_rad * twist_rate_per_rad)
}
