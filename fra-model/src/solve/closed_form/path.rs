//! A certified path from one equilibrium to the requested one.
//!
//! From a state on the branch, `d` is Newton's correction towards a pressure and `b` the next term of the series in that direction.
//! `|b|/|d|` is Deuflhard's contraction factor of the simplified Newton iteration, half the affine-invariant Kantorovich number: where
//! it is at most 1/4, every pressure in between has one solution nearby, and these solutions form one curve, hence one branch. Where it
//! is larger, the step goes only as far as it is not. The correction at the next state checks the estimate.
//!
//! In single precision a short step towards a deformation is Newton's alone: the correction after it is `b` as it turned out to be, and
//! certifies the step where it is as much shorter. Otherwise the path restarts with the estimate.

use super::kernel::{Constants, Linearised, Norm, Rest, Unknowns};
use crate::number::real::{Real, epsilon, real};
use crate::solve::residual::Residual;

/// Largest contraction factor of a step.
pub(super) const CONTRACTION: f64 = 0.25;
/// Largest share of the last step that a correction after it may have.
pub(super) const CORRECTION: f64 = 0.25;
/// Share of the largest contraction factor that a step takes which cannot go all the way.
pub(super) const SHARE: f64 = 0.8;
/// Shortest step, as a fraction of the remaining path.
const SHORTEST: f64 = 0.02;
/// Most that the stiffness against pressure may change in one step.
const STIFFNESS: f64 = 4.0;
/// Longest step that is Newton's alone, as a share of the state, in single precision.
const PLAIN: f64 = 1.0 / 32.0;

/// A tube under a load.
pub(super) struct Path<'a, T, const TWIST: bool> {
    pub(super) constants: &'a Constants<T>,
    /// External force and torque.
    pub(super) force: T,
    pub(super) torque: T,
    pub(super) norm: Norm<T>,
    /// A size of a state below which a correction is compared with this in its place: zero where every digit of a tiny state counts.
    pub(super) floor: T,
}

/// State of the path before an evaluation.
#[derive(Clone, Copy)]
pub(super) struct Stand<T> {
    pub(super) at: Unknowns<T>,
    /// The pressure whose equilibrium `at` is near, if that is known.
    pub(super) pressure: Option<T>,
    /// Whether the last step reached the root to first order.
    pub(super) arrived: bool,
    /// Size of the last step.
    pub(super) last: T,
    /// Change of the measured deformation with the pressure, at the last state.
    pub(super) along: Option<T>,
    /// Change of the pressure with the last step, if that was Newton's alone.
    pub(super) plain: Option<T>,
}

/// Result of one evaluation.
enum Next<T> {
    Arrived(End<T>),
    On(Stand<T>),
}

/// An equilibrium.
pub(super) struct End<T> {
    pub(super) at: Unknowns<T>,
    pub(super) volume_rate: T,
    pub(super) pressure: T,
    pub(super) residual: T,
    pub(super) evaluations: u32,
}

/// Newton's step towards the root of a residual.
#[derive(Clone, Copy)]
struct Step<T> {
    first: Unknowns<T>,
    /// Change of the pressure.
    pressure: T,
    /// Change of the state with the pressure, and that of the measured deformation.
    rate: Unknowns<T>,
    along: Option<T>,
}

pub(super) fn weighted<T: Real>(weights: &nalgebra::Vector3<T>, x: &Unknowns<T>) -> T {
    weights.x * x.e + weights.y * x.w + weights.z * x.g
}

impl<T: Real, const TWIST: bool> Path<'_, T, TWIST> {
    /// The contraction factor of a step.
    #[inline(always)]
    pub(super) fn contraction(&self, first: &Unknowns<T>, second: &Unknowns<T>) -> T {
        let (over, under) = self.norm.contraction::<TWIST>(first, second);
        over / under
    }

    #[inline(always)]
    pub(super) fn size(&self, x: &Unknowns<T>) -> T {
        self.norm.size::<TWIST>(x)
    }

    /// The imbalance of the equations at a state and a pressure.
    #[inline(always)]
    pub(super) fn rest(&self, lin: &Linearised<T, TWIST>, pressure: T) -> Rest<T> {
        lin.rest(self.constants, self.force, pressure, self.torque)
    }

    /// The path from a state to the root of the residual.
    #[inline(always)]
    pub(super) fn follow(&self, begun: Stand<T>, residual: &Residual<T>, spent: u32, budget: u32) -> Option<End<T>> {
        let mut may_be_plain =
            is_single::<T>() && begun.pressure.is_none() && matches!(residual, Residual::Deformation { .. });
        let (mut stand, mut evaluations) = (begun, spent);
        while evaluations < budget {
            evaluations += 1;
            stand = match self.advance(&stand, residual, may_be_plain, evaluations) {
                Some(Next::Arrived(end)) => return Some(end),
                Some(Next::On(next)) => next,
                None => {
                    stand.plain?;
                    may_be_plain = false;
                    begun
                }
            };
        }
        None
    }

    /// One evaluation; `None` where the step is not certified.
    #[inline(always)]
    fn advance(
        &self,
        stand: &Stand<T>,
        residual: &Residual<T>,
        may_be_plain: bool,
        evaluations: u32,
    ) -> Option<Next<T>> {
        let at = stand.at;
        let inside = at.e > -T::one() && at.w > -T::one();
        let lin = Linearised::<T, TWIST>::new(self.constants, inside.then_some(at)?);
        (lin.stability > T::zero()).then_some(())?;
        let step = self.whole_step(&lin, stand, residual)?;
        let (size, end) = (self.size(&step.first), at.plus(step.first));
        let settled = size <= stand.last * real(CORRECTION) && is_less(step.pressure, stand.plain);
        let whole = self.size(&end);
        if size <= tolerance::<T>() * (whole + self.floor) && settled {
            return Some(Next::Arrived(self.end(&lin, residual, end, &step, evaluations)));
        }
        if stand.arrived {
            // What Newton's step leaves over is below the tolerance: the second term would not be worth its price.
            let last_but_one = size * size <= tolerance::<T>() * whole * whole;
            settled.then_some(())?;
            let at = if last_but_one { end } else { end.plus(self.second(&lin, residual, &step).0) };
            return Some(Next::On(Stand { at, last: size, along: step.along, plain: None, ..*stand }));
        }
        if let Some(pressure) = stand.pressure {
            self.is_near(&{ lin }, pressure, stand.last).then_some(())?;
        }
        let next = Stand { at: end, arrived: true, last: size, along: step.along, ..*stand };
        if may_be_plain && size <= whole * real(PLAIN) {
            let last = self.norm.strain::<TWIST>(&step.first);
            return Some(Next::On(Stand { last, plain: Some(step.pressure), ..next }));
        }
        let (second, contraction) = self.second(&lin, residual, &step);
        if contraction <= real(CONTRACTION) {
            return Some(Next::On(Stand { at: end.plus(second), ..next }));
        }
        // Copies, so that what is rarely asked for does not keep everything in memory.
        self.part_of_step(&{ lin }, Stand { along: step.along, ..*stand }, &{ step }, contraction).map(Next::On)
    }

    /// The step to the root, to first order.
    #[inline(always)]
    fn whole_step(&self, lin: &Linearised<T, TWIST>, stand: &Stand<T>, residual: &Residual<T>) -> Option<Step<T>> {
        let c = self.constants;
        match residual {
            Residual::Pressure(wanted) => {
                let first = lin.solve(c, self.rest(lin, *wanted));
                Some(Step { first, pressure: *wanted - lin.left.w, rate: first, along: None })
            }
            Residual::Deformation { weights, value, .. } => {
                let base = lin.solve_at_pressure(c, self.rest(lin, lin.left.w));
                let rate = lin.rate(c);
                let along = weighted(weights, &rate);
                stand.along.is_none_or(|before| is_monotone(before, along)).then_some(())?;
                let change = (*value - weighted(weights, &stand.at) - weighted(weights, &base)) / along;
                Some(Step { first: base.plus(rate.times(change)), pressure: change, rate, along: Some(along) })
            }
        }
    }

    /// The second term of a step, and the contraction factor: that of the state, and for a deformation also that of the measured quantity.
    #[inline(always)]
    fn second(&self, lin: &Linearised<T, TWIST>, residual: &Residual<T>, step: &Step<T>) -> (Unknowns<T>, T) {
        let c = self.constants;
        let free = lin.solve(c, lin.curvature(c, step.first));
        match (residual, step.along) {
            (Residual::Deformation { weights, .. }, Some(along)) => {
                let bend = weighted(weights, &free) / along;
                let second = free.plus(step.rate.times(-bend));
                let contraction = self.contraction(&step.first, &second);
                (second, contraction.max((bend / step.pressure).abs()))
            }
            _ => (free, self.contraction(&step.first, &free)),
        }
    }

    /// As much of a step as the contraction factor allows.
    #[cold]
    #[inline(never)]
    fn part_of_step(
        &self,
        lin: &Linearised<T, TWIST>,
        stand: Stand<T>,
        step: &Step<T>,
        contraction: T,
    ) -> Option<Stand<T>> {
        let c = self.constants;
        let share = part(contraction)?;
        let from = stand.pressure.unwrap_or(lin.left.w);
        let change = (lin.left.w + step.pressure - from) * share;
        let base = lin.solve(c, self.rest(lin, from));
        let first = base.plus(lin.rate(c).times(change));
        let second = lin.solve(c, lin.curvature(c, first));
        (self.contraction(&first, &second) <= real(CONTRACTION)).then_some(())?;
        let at = stand.at.plus(first).plus(second);
        Some(Stand { at, pressure: Some(from + change), last: self.size(&first), ..stand })
    }

    /// Whether the state is as near its equilibrium at a pressure as the last step promised.
    #[cold]
    #[inline(never)]
    fn is_near(&self, lin: &Linearised<T, TWIST>, pressure: T, last: T) -> bool {
        let base = lin.solve(self.constants, self.rest(lin, pressure));
        self.size(&base) <= last * real(CORRECTION)
    }

    #[inline(always)]
    fn end(
        &self,
        lin: &Linearised<T, TWIST>,
        residual: &Residual<T>,
        at: Unknowns<T>,
        step: &Step<T>,
        evaluations: u32,
    ) -> End<T> {
        let rest = self.rest(lin, lin.left.w);
        let loads = rest.e.abs().max(rest.g.abs());
        let (pressure, imbalance) = match residual {
            Residual::Pressure(wanted) => (*wanted, loads.max(step.pressure.abs())),
            Residual::Deformation { .. } => (lin.left.w + step.pressure, loads),
        };
        End {
            at,
            volume_rate: lin.volume_rate_after(self.constants, &step.first),
            pressure,
            residual: imbalance,
            evaluations,
        }
    }
}

/// The share of a step that a contraction factor allows; `None` where that is too small to be worth it.
pub(super) fn part<T: Real>(contraction: T) -> Option<T> {
    let share = real::<T>(SHARE * CONTRACTION) / contraction;
    (share >= real(SHORTEST)).then_some(share)
}

/// Whether a deformation kept changing with the pressure in one direction.
fn is_monotone<T: Real>(before: T, after: T) -> bool {
    let (least, most) = if before.abs() < after.abs() { (before, after) } else { (after, before) };
    before * after > T::zero() && most.abs() <= least.abs() * real(STIFFNESS)
}

/// Whether a correction of the pressure is as much less than the change before it as certifies that, where that is to be looked at.
fn is_less<T: Real>(correction: T, before: Option<T>) -> bool {
    before.is_none_or(|before| correction.abs() <= before.abs() * real(CORRECTION))
}

/// A correction that is followed by one below rounding.
pub(super) fn tolerance<T: Real>() -> T {
    if is_single::<T>() { real(1e-4) } else { real(1e-9) }
}

fn is_single<T: Real>() -> bool {
    epsilon::<T>() > real::<T>(1e-9)
}
