//! A certified way from one equilibrium to the one that is asked for.
//!
//! From a state on the branch, `d` is Newton's correction towards a pressure and `b` the next term of the series in that direction.
//! `|b|/|d|` is Deuflhard's contraction factor of the simplified Newton iteration, half the affine-invariant Kantorovich number: where
//! it is at most 1/4, every pressure in between has one solution nearby, and these solutions form one curve, hence one branch. Where it
//! is larger, the step goes only as far as it is not. What the next state says of its own correction checks the estimate.

use super::kernel::{Constants, Linearised, Rest, Unknowns};
use crate::goal::Goal;
use crate::real::{Real, epsilon, real};

/// Largest contraction factor of a step.
pub(super) const CONTRACTION: f64 = 0.25;
/// Largest share of the last step that a correction after it may have.
const CORRECTION: f64 = 0.25;
/// Shortest step, as a share of what is left to go.
const SHORTEST: f64 = 0.02;
/// Most that the stiffness against pressure may change in one step.
const STIFFNESS: f64 = 4.0;

/// A tube under a load.
pub(super) struct Path<'a, T, const TWIST: bool> {
    pub(super) constants: &'a Constants<T>,
    /// External force and torque.
    pub(super) force: T,
    pub(super) torque: T,
    /// What makes a twist rate and a tension comparable with a strain.
    pub(super) norm: (T, T),
}

/// Where a way stands before an evaluation.
pub(super) struct Stand<T> {
    pub(super) at: Unknowns<T>,
    /// The pressure whose equilibrium `at` is near, if that is known.
    pub(super) pressure: Option<T>,
    /// Whether the last step went all the way to the goal.
    pub(super) arrived: bool,
    /// Size of the last step.
    pub(super) last: T,
    /// Change of the measured deformation with the pressure, at the last state.
    pub(super) along: Option<T>,
}

/// An equilibrium and its change with the pressure.
pub(super) struct End<T> {
    pub(super) at: Unknowns<T>,
    pub(super) rate: Unknowns<T>,
    pub(super) pressure: T,
    pub(super) residual: T,
    pub(super) evaluations: u32,
}

/// A step: Newton's correction `d` and the next term `b`.
struct Step<T> {
    first: Unknowns<T>,
    second: Unknowns<T>,
    /// Change of the pressure.
    pressure: T,
    contraction: T,
}

pub(super) fn weighted<T: Real>(weights: &nalgebra::Vector3<T>, x: &Unknowns<T>) -> T {
    weights.x * x.e + weights.y * x.w + weights.z * x.g
}

impl<T: Real, const TWIST: bool> Path<'_, T, TWIST> {
    fn norm(&self, x: &Unknowns<T>) -> (T, T) {
        let strain = x.e.abs() + x.w.abs();
        let strain = if TWIST { strain + x.g.abs() * self.norm.0 } else { strain };
        (strain, x.tension.abs() * self.norm.1)
    }

    /// The contraction factor of a step. A tension that dominates must not hide what the strains do.
    pub(super) fn contraction(&self, first: &Unknowns<T>, second: &Unknowns<T>) -> T {
        let (first, second) = (self.norm(first), self.norm(second));
        (second.0 + second.1) / (first.0 + first.1.min(first.0))
    }

    pub(super) fn size(&self, x: &Unknowns<T>) -> T {
        let (strain, tension) = self.norm(x);
        strain + tension
    }

    /// What the equations lack at a state, at a pressure.
    fn rest(&self, lin: &Linearised<T, TWIST>, pressure: T) -> Rest<T> {
        Rest {
            e: self.force - lin.left.e,
            w: pressure - lin.left.w,
            g: if TWIST { self.torque - lin.left.g } else { T::zero() },
            tension: lin.tension_rest(self.constants),
        }
    }

    pub(super) fn rate(&self, lin: &Linearised<T, TWIST>) -> Unknowns<T> {
        let zero = T::zero();
        lin.solve(self.constants, Rest { e: zero, w: T::one(), g: zero, tension: zero })
    }

    /// The way from a state onwards, to the state that meets the goal.
    pub(super) fn follow(&self, mut stand: Stand<T>, goal: &Goal<T>, spent: u32, budget: u32) -> Option<End<T>> {
        let mut evaluations = spent;
        let c = self.constants;
        while evaluations < budget {
            evaluations += 1;
            let at = stand.at;
            let inside = at.e > -T::one() && at.w > -T::one();
            let lin = Linearised::<T, TWIST>::new(c, inside.then_some(at)?);
            (lin.stability > T::zero()).then_some(())?;
            let step = self.whole_step(&lin, &mut stand, goal)?;
            let size = self.size(&step.first);
            let settled = size <= stand.last * real(CORRECTION);
            let end = at.plus(step.first);
            if size <= tolerance::<T>() * self.size(&end) && settled {
                return Some(self.end(&lin, goal, end, step.pressure, evaluations));
            }
            let near = if stand.arrived { settled } else { self.is_near(&lin, &stand) };
            if !near {
                return None;
            }
            if step.contraction <= real(CONTRACTION) {
                let at = end.plus(step.second);
                stand = Stand { at, arrived: true, last: size, ..stand };
            } else if stand.arrived {
                return None;
            } else {
                stand = self.part_of_step(&lin, stand, &step)?;
            }
        }
        None
    }

    /// The step that meets the goal.
    #[inline(always)]
    fn whole_step(&self, lin: &Linearised<T, TWIST>, stand: &mut Stand<T>, goal: &Goal<T>) -> Option<Step<T>> {
        let c = self.constants;
        match goal {
            Goal::Pressure(wanted) => {
                let first = lin.solve(c, self.rest(lin, *wanted));
                let second = lin.solve(c, lin.curvature(c, first));
                let contraction = self.contraction(&first, &second);
                Some(Step { first, second, pressure: *wanted - lin.left.w, contraction })
            }
            Goal::Deformation { weights, value, .. } => {
                let base = lin.solve(c, self.rest(lin, lin.left.w));
                let rate = self.rate(lin);
                let along = weighted(weights, &rate);
                if !stand.along.is_none_or(|before| is_monotone(before, along)) {
                    return None;
                }
                stand.along = Some(along);
                let change = (*value - weighted(weights, &stand.at) - weighted(weights, &base)) / along;
                let first = base.plus(rate.times(change));
                let free = lin.solve(c, lin.curvature(c, first));
                let bend = weighted(weights, &free);
                let second = free.plus(rate.times(-(bend / along)));
                let contraction = self.contraction(&first, &second);
                // A correction as small as rounding says nothing about the curve.
                let bent = if stand.arrived { T::zero() } else { (bend / (along * change)).abs() };
                Some(Step { first, second, pressure: change, contraction: contraction.max(bent) })
            }
        }
    }

    /// As much of a step as the contraction factor allows.
    #[cold]
    fn part_of_step(&self, lin: &Linearised<T, TWIST>, stand: Stand<T>, step: &Step<T>) -> Option<Stand<T>> {
        let c = self.constants;
        let share = part(step.contraction)?;
        let from = stand.pressure.unwrap_or(lin.left.w);
        let change = (lin.left.w + step.pressure - from) * share;
        let base = lin.solve(c, self.rest(lin, from));
        let first = base.plus(self.rate(lin).times(change));
        let second = lin.solve(c, lin.curvature(c, first));
        (self.contraction(&first, &second) <= real(CONTRACTION)).then_some(())?;
        let at = stand.at.plus(first).plus(second);
        Some(Stand { at, pressure: Some(from + change), last: self.size(&first), ..stand })
    }

    /// Whether the state is as near its equilibrium as the last step promised.
    #[cold]
    fn is_near(&self, lin: &Linearised<T, TWIST>, stand: &Stand<T>) -> bool {
        let Some(pressure) = stand.pressure else { return true };
        let base = lin.solve(self.constants, self.rest(lin, pressure));
        self.size(&base) <= stand.last * real(CORRECTION)
    }

    fn end(&self, lin: &Linearised<T, TWIST>, goal: &Goal<T>, at: Unknowns<T>, change: T, evaluations: u32) -> End<T> {
        let rest = self.rest(lin, lin.left.w);
        let loads = rest.e.abs().max(rest.g.abs());
        let (pressure, residual) = match goal {
            Goal::Pressure(wanted) => (*wanted, loads.max(change.abs())),
            Goal::Deformation { .. } => (lin.left.w + change, loads),
        };
        End { at, rate: self.rate(lin), pressure, residual, evaluations }
    }
}

/// The share of a step that a contraction factor allows; `None` where that is too small to be worth it.
pub(super) fn part<T: Real>(contraction: T) -> Option<T> {
    let share = real::<T>(0.8 * CONTRACTION) / contraction;
    (share >= real(SHORTEST)).then_some(share)
}

/// Whether a deformation kept changing with the pressure in one direction.
fn is_monotone<T: Real>(before: T, after: T) -> bool {
    let ratio = after / before;
    ratio * real(STIFFNESS) >= T::one() && ratio <= real(STIFFNESS)
}

/// A correction that is followed by one below rounding.
fn tolerance<T: Real>() -> T {
    let single = epsilon::<T>() > real::<T>(1e-9);
    if single { real(1e-4) } else { real(1e-9) }
}
