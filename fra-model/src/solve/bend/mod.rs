//! Bending: a wound tube with an inextensible line along its outer face.
//!
//! The wall follows an isochoric map of the section (lengths in units of `R_o`, `k = kappa R_o`, `phi_c` from the
//! inextensible side, winding at `rho_f` which keeps its radius):
//! `(1+k)(rho_f^2 - r^2)/2 - k cos(phi_c)(rho_f^3 - r^3)/3 = (rho_f^2 - rho^2)/2`, stretch `lambda = 1 + k h`, `h = 1 - r cos(phi_c)`.
//! Work balance per length: `P pi R_f^2 R_o + M_ext + N_ext R_o = dU/dkappa`; the pressure's share is the derivative of the
//! volume inside a winding that keeps its radius. This replaces eqs. (10)-(13) of the paper, whose stretch (12) does not vary
//! around the section and whose balance leaves out the pressure carried through the wall.

mod lanes;
mod meet;

use crate::model::section::{Bent, EndLoad, Section};
use crate::number::real::{Real, epsilon, real};
use crate::number::scalar::Scalar;
use crate::parameters::{ActuatorParameters, InvalidParameter, require};
use crate::solution::{Load, Solution, State, Status, Target};

pub(crate) use lanes::{MANY, bend_many, meet_many};
use meet::Met;

/// Longest step of `k` relative to `k + 0.1`, and the largest `k` of the search.
const LONGEST_STEP: f64 = 0.5;
const LARGEST_CURVATURE: f64 = 50.0;
const MARCH_STEPS: u32 = 400;
const REFINE_STEPS: u32 = 100;

/// A bending actuator, ready to solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bender<T: Real> {
    section: Section<T>,
    straight: Bent<T>,
}

impl<T: Real> Bender<T> {
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Self {
        let section = Section::new(parameters);
        Self { straight: section.bent(T::zero(), &section.end_load(T::zero(), T::zero())), section }
    }

    /// The bend at a gauge pressure.
    pub(crate) fn forward(&self, start: Option<&State<T>>, pressure_pa: T, load: &Load<T>) -> Solution<T> {
        let wanted = pressure_pa / self.section.shear_modulus_pa() * self.section.lever() + self.end_load(load).moment;
        // A line that cannot shorten and a winding that cannot push do not bend backwards.
        if wanted < T::zero() {
            return self.solution(Status::NoSolution, self.straight, load, Some(self.straight), 0);
        }
        let end_load = self.end_load(load);
        let mut iterations = 0;
        let from =
            start.map_or(T::zero(), |state| Scalar::max(self.section.curvature(state.bend_angle_rad), T::zero()));
        // Only a moment that rises throughout has one bend for every value, so that any start leads to it.
        let rises = !self.section.may_turn();
        let met = if rises { self.meet(from, wanted, &end_load, &mut iterations) } else { None };
        match met {
            Some(met) => self.pressed(&met, pressure_pa, load, iterations),
            None => {
                let begin =
                    if rises && from > T::zero() { self.bent(from, &end_load, &mut iterations) } else { self.straight };
                let solution = self.reach(begin, wanted, load, &mut iterations);
                self.at_pressure(Solution { iterations, ..solution }, pressure_pa)
            }
        }
    }

    /// The solution at a pressure whose bend was met.
    pub(crate) fn pressed(&self, met: &Met<T>, pressure_pa: T, load: &Load<T>, iterations: u32) -> Solution<T> {
        let solution = self.solution(Status::Solved, met.bent, load, None, iterations);
        self.at_pressure(Solution { residual: met.off / self.section.lever(), ..solution }, pressure_pa)
    }

    /// A solution that was sought at a pressure.
    fn at_pressure(&self, mut solution: Solution<T>, pressure_pa: T) -> Solution<T> {
        if solution.status == Status::Solved {
            let off = (solution.state.pressure_pa - pressure_pa).abs() / self.section.shear_modulus_pa();
            solution.residual = Scalar::max(solution.residual, off);
            solution.state.pressure_pa = pressure_pa;
        }
        solution
    }

    /// The restoring moment at a pressure without load, if it may be met side by side with those of others.
    pub(crate) fn moment_at(&self, pressure_pa: T) -> Option<T> {
        let is_plain = pressure_pa > T::zero() && pressure_pa.is_finite() && self.has_one_bend_a_moment();
        is_plain.then(|| pressure_pa / self.section.shear_modulus_pa() * self.section.lever())
    }

    /// The bend of a target without load, if its integral may be taken side by side with those of others.
    pub(crate) fn bend_of(&self, target: Target<T>) -> Option<T> {
        let Target::BendAngle(angle) = target else { return None };
        let k = self.section.curvature(angle);
        let is_plain = angle.is_finite() && angle >= T::zero() && k <= real(LARGEST_CURVATURE);
        (is_plain && self.has_one_bend_a_moment()).then_some(k)
    }

    /// Of a hoop winding on a wall that is neither very thick nor softens.
    fn has_one_bend_a_moment(&self) -> bool {
        !self.section.is_helical() && !self.section.may_turn()
    }

    /// The solution without load at a bend; `None` where its moment is not finite.
    pub(crate) fn bent_to(&self, bent: Bent<T>) -> Option<Solution<T>> {
        let is_finite = bent.moment.is_finite() && bent.slope.is_finite();
        is_finite.then(|| self.solution(Status::Solved, bent, &Load::none(), None, 1))
    }

    /// The pressure for a bend angle: explicit, since the balance is linear in the pressure.
    pub(crate) fn inverse(&self, target: Target<T>, load: &Load<T>) -> Result<Solution<T>, InvalidParameter<T>> {
        let Target::BendAngle(angle) = target else { return Err(not_a_bend(target)) };
        require(angle.is_finite() && angle >= T::zero(), "bend_angle_rad", angle, "finite and >= 0")?;
        let k = self.section.curvature(angle);
        let mut iterations = 0;
        let bent = self.bent(k, &self.end_load(load), &mut iterations);
        if !bent.moment.is_finite() || !bent.slope.is_finite() || k > real::<T>(LARGEST_CURVATURE) {
            return Ok(self.solution(Status::NoSolution, self.straight, load, None, iterations));
        }
        if self.section.may_turn()
            && let Some(limit) = self.limit_before(k, &self.end_load(load), &mut iterations)
        {
            return Ok(self.solution(Status::NoSolution, limit, load, Some(limit), iterations));
        }
        Ok(self.solution(Status::Solved, bent, load, None, iterations))
    }

    /// Straight, without pressure.
    pub(crate) fn rest(&self) -> State<T> {
        self.section.state(&self.straight, &self.end_load(&Load::none()))
    }

    /// First and second derivative of the volume by the bend angle, m3/rad and m3/rad2.
    pub(crate) fn volume_by_bend(&self, bend_angle_rad: T) -> Option<[T; 2]> {
        let [first, second] = self.section.growth(self.section.curvature(bend_angle_rad))?;
        let [outer_m, length_m] = self.section.size_m();
        let first_m3 = real::<T>(core::f64::consts::PI) * outer_m * outer_m * outer_m * first;
        Some([first_m3, real::<T>(core::f64::consts::PI) * outer_m * outer_m * outer_m * outer_m * second / length_m])
    }

    fn end_load(&self, load: &Load<T>) -> EndLoad<T> {
        self.section.end_load(load.force_n, load.torque_nm)
    }

    fn bent(&self, k: T, load: &EndLoad<T>, iterations: &mut u32) -> Bent<T> {
        *iterations += 1;
        self.section.bent(k, load)
    }

    /// Raises the curvature from `begin` until the moment is `wanted`, or to the limit point before it.
    fn reach(&self, begin: Bent<T>, wanted: T, load: &Load<T>, iterations: &mut u32) -> Solution<T> {
        let end_load = self.end_load(load);
        let mut here = begin;
        // A bend that no pressure balances.
        let mut beyond = None;
        for _ in 0..MARCH_STEPS {
            let newton = (wanted - here.moment) / here.slope;
            if newton.abs() <= epsilon::<T>() * here.k {
                return self.solution(Status::Solved, here, load, None, 0);
            }
            let mut longest = real::<T>(LONGEST_STEP) * (here.k + real::<T>(0.1));
            if let Some(beyond) = beyond {
                longest = longest.min((beyond - here.k) * real(0.5));
                if longest <= epsilon::<T>() * (here.k + real(0.1)) {
                    return self.solution(Status::NoSolution, here, load, None, 0);
                }
            }
            let there = self.bent((here.k + newton.min(longest)).max(T::zero()), &end_load, iterations);
            if !there.moment.is_finite() || !there.slope.is_finite() {
                if !self.section.is_helical() {
                    break;
                }
                beyond = Some(there.k);
                continue;
            }
            if there.slope <= T::zero() {
                let limit = self.refine(here, there, |b| b.slope, &end_load, iterations);
                let found = wanted <= limit.moment;
                let bent =
                    if found { self.refine(here, limit, |b| b.moment - wanted, &end_load, iterations) } else { limit };
                let status = if found { Status::Solved } else { Status::NoSolution };
                return self.solution(status, bent, load, (!found).then_some(limit), 0);
            }
            if there.k > real::<T>(LARGEST_CURVATURE) {
                return self.solution(Status::NoSolution, there, load, None, 0);
            }
            // The moment rises here: a change of sign brackets the answer.
            if (there.moment - wanted > T::zero()) != (here.moment - wanted > T::zero()) {
                let bent = self.refine(here, there, |b| b.moment - wanted, &end_load, iterations);
                return self.solution(Status::Solved, bent, load, None, 0);
            }
            here = there;
        }
        self.solution(Status::NotConverged, here, load, None, 0)
    }

    /// The first limit point below `k`, where the moment stops rising.
    fn limit_before(&self, k: T, load: &EndLoad<T>, iterations: &mut u32) -> Option<Bent<T>> {
        let mut here = self.straight;
        while here.k < k {
            let step = real::<T>(0.2 * LONGEST_STEP) * (here.k + real::<T>(0.1));
            let there = self.bent((here.k + step).min(k), load, iterations);
            if there.slope <= T::zero() {
                return Some(self.refine(here, there, |b| b.slope, load, iterations));
            }
            here = there;
        }
        None
    }

    /// The zero of `measure` between two bends at which it has opposite signs: secant and bisection in turn.
    fn refine(
        &self,
        a: Bent<T>,
        b: Bent<T>,
        measure: impl Fn(&Bent<T>) -> T,
        load: &EndLoad<T>,
        iterations: &mut u32,
    ) -> Bent<T> {
        let (mut low, mut high) = (a, b);
        for round in 0..REFINE_STEPS {
            let (at_low, at_high) = (measure(&low), measure(&high));
            let nearest = if at_low.abs() <= at_high.abs() { low } else { high };
            let width = (high.k - low.k).abs();
            if at_low == T::zero() || at_high == T::zero() || width <= epsilon::<T>() * nearest.k {
                return nearest;
            }
            let secant = low.k - at_low * (high.k - low.k) / (at_high - at_low);
            let inside = (secant - low.k) * (secant - high.k) < T::zero();
            let k = if inside && round % 3 != 2 { secant } else { (low.k + high.k) * real::<T>(0.5) };
            if (k - low.k) * (k - high.k) >= T::zero() {
                return nearest;
            }
            let next = self.bent(k, load, iterations);
            if (measure(&next) > T::zero()) == (at_low > T::zero()) { low = next } else { high = next }
        }
        low
    }

    fn solution(
        &self,
        status: Status,
        bent: Bent<T>,
        load: &Load<T>,
        limit: Option<Bent<T>>,
        iterations: u32,
    ) -> Solution<T> {
        let load = self.end_load(load);
        let limit_pressure_pa = limit.map(|limit| self.section.pressure(&limit, &load));
        Solution { status, state: self.section.state(&bent, &load), limit_pressure_pa, residual: T::zero(), iterations }
    }
}

pub(crate) fn not_a_bend<T: Real>(target: Target<T>) -> InvalidParameter<T> {
    let (field, value) = match target {
        Target::AxialStretch(value) => ("axial_stretch", value),
        Target::OuterRadius(value) => ("outer_radius_m", value),
        Target::InnerRadius(value) => ("inner_radius_m", value),
        Target::Twist(value) => ("twist_rad", value),
        Target::BendAngle(value) => ("bend_angle_rad", value),
    };
    InvalidParameter { field, value, allowed: "not a target of bending actuators: give bend_angle_rad" }
}
