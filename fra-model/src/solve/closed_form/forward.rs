//! From rest to a pressure, without load: the series, and a correction of third order.

use super::expansion::{Expansion, LEAST};
use super::kernel::{Linearised, Unknowns};
use super::path::{CONTRACTION, CORRECTION, End, Path};
use super::{ClosedForm, Equilibrium, equilibrium};
use crate::number::real::{Real, epsilon, real};

/// Corrections after which a state that has not settled is given up.
const CORRECTIONS: u32 = 5;
/// Contraction factor from rest above which what is beyond the last order of the series matters.
const FAR: f64 = 0.17;

/// Largest contraction factor of a last correction: its square is what the compliance loses.
const CURVED: f64 = 3e-7;
const CURVED_SINGLE: f64 = 1e-3;
/// Largest last correction, as a share of the state: its third power is below rounding.
const SHORT: f64 = 5e-6;
const SHORT_SINGLE: f64 = 1.5e-3;

/// A correction that is so small a share of the state needs no second term, and the compliance none for it.
const TINY: f64 = 2e-11;
const TINY_SINGLE: f64 = 2e-7;

/// State of the path: a state at the end of a certified step of a given size.
struct Close<T> {
    at: Unknowns<T>,
    last: T,
    /// Lower bound of the size, where `last` is an upper one.
    least: T,
    evaluations: u32,
}

impl<T: Real> ClosedForm<T> {
    /// The equilibrium at a pressure, if the steps from rest to it are certified.
    #[inline(always)]
    pub(crate) fn pressed(&self, pressure: T) -> Option<Equilibrium<T>> {
        self.equilibrium_at::<true>(pressure)
    }

    /// The same before [`certify`](Self::certify), if the steps after the first make no difference.
    #[inline(always)]
    pub(crate) fn pressed_near_rest(&self, pressure: T) -> Option<Equilibrium<T>> {
        self.equilibrium_at::<false>(pressure)
    }

    #[inline(always)]
    fn equilibrium_at<const CERTIFIED: bool>(&self, pressure: T) -> Option<Equilibrium<T>> {
        let end = if self.twists_by_itself() {
            self.rise::<true, CERTIFIED>(pressure)
        } else {
            self.rise::<false, CERTIFIED>(pressure)
        };
        Some(equilibrium(end?))
    }

    #[inline(always)]
    fn rise<const TWIST: bool, const CERTIFIED: bool>(&self, pressure: T) -> Option<End<T>> {
        let Expansion { unit, contraction, reach, short, .. } = self.expansion;
        let z = pressure * unit;
        (z <= reach && -z * contraction <= real(CONTRACTION)).then_some(())?;
        let path = self.path::<TWIST>(T::zero(), T::zero());
        let is_far = z.abs() * contraction > real(FAR);
        let at = if is_far { self.expansion.extrapolated::<TWIST>(z) } else { self.expansion.at::<TWIST>(z) };
        let last = short * z.abs();
        let least = if CERTIFIED { last } else { last * real(LEAST) };
        let close = Close { at, last, least, evaluations: 0 };
        match path.correct(&close, pressure) {
            Corrected::Settled(end) => Some(end),
            Corrected::Close(close) => path.settle(close, pressure),
            Corrected::Lost => None,
        }
    }
}

/// Result of a correction.
enum Corrected<T> {
    Settled(End<T>),
    Close(Close<T>),
    /// The correction is too large for the step before it, or may be.
    Lost,
}

impl<T: Real, const TWIST: bool> Path<'_, T, TWIST> {
    /// The equations at a state that is in their domain and stable.
    #[inline(always)]
    pub(super) fn look(&self, at: Unknowns<T>) -> Option<Linearised<T, TWIST>> {
        let inside = at.e > -T::one() && at.w > -T::one();
        let lin = Linearised::<T, TWIST>::new(self.constants, inside.then_some(at)?);
        (lin.stability > T::zero()).then_some(lin)
    }

    /// One correction of two terms.
    #[inline(always)]
    fn correct(&self, from: &Close<T>, pressure: T) -> Corrected<T> {
        let c = self.constants;
        let Some(lin) = self.look(from.at) else { return Corrected::Lost };
        let rest = self.rest(&lin, pressure);
        let first = lin.solve(c, rest);
        let (last, evaluations) = (self.size(&first), from.evaluations + 1);
        let is_short = last <= from.least * real(CORRECTION);
        if !is_short {
            return Corrected::Lost;
        }
        let rounding = (pressure.abs() + self.force.abs()) * epsilon();
        let at = from.at.plus(first);
        let strain = self.norm.strain::<TWIST>(&at);
        let [is_tiny, may_be_tiny] = [from.least, from.last].map(|before| last <= before.min(strain) * tiny::<T>());
        if is_tiny != may_be_tiny {
            return Corrected::Lost;
        }
        if is_tiny {
            // The step before it was certified: the contraction factor of this one is as much less as it is shorter.
            let residual = (rest.e.abs() + rest.w.abs() + rest.g.abs()) * tiny::<T>() + rounding;
            return Corrected::Settled(End { at, volume_rate: lin.rate(c).w, pressure, residual, evaluations });
        }
        let left = lin.curvature(c, first);
        let second = lin.solve(c, left);
        let step = first.plus(second);
        let at = from.at.plus(step);
        if !self.is_last(&first, &second, self.size(&at)) {
            return Corrected::Close(Close { at, last, least: last, evaluations });
        }
        // What the second term leaves over is at least as much smaller than what the first one does.
        let leave = left.e.abs() + left.w.abs();
        let leave = if TWIST { leave + left.g.abs() } else { leave };
        let residual = leave * real(4.0 * CURVED_SINGLE) + rounding;
        let volume_rate = lin.volume_rate_after(c, &step);
        Corrected::Settled(End { at, volume_rate, pressure, residual, evaluations })
    }

    /// Whether what two terms of a correction leave over is below rounding.
    #[inline(always)]
    fn is_last(&self, first: &Unknowns<T>, second: &Unknowns<T>, whole: T) -> bool {
        let [short, curved] = limits::<T>();
        let negligible = epsilon::<T>() * real(0.125);
        let (size, (turn, strain)) = (self.size(first), self.norm.contraction::<TWIST>(first, second));
        (size <= whole * real(short)) & (turn <= strain * real(curved)) & (turn * turn <= size * whole * negligible)
    }

    /// As many more corrections as it takes.
    #[inline(never)]
    fn settle(&self, mut close: Close<T>, pressure: T) -> Option<End<T>> {
        while close.evaluations < CORRECTIONS {
            match self.correct(&close, pressure) {
                Corrected::Settled(end) => return Some(end),
                Corrected::Close(next) => close = next,
                Corrected::Lost => return None,
            }
        }
        None
    }
}

/// `TINY` of a scalar.
#[inline(always)]
fn tiny<T: Real>() -> T {
    let single = epsilon::<T>() > real::<T>(1e-9);
    if single { real(TINY_SINGLE) } else { real(TINY) }
}

/// `SHORT` and `CURVED` of a scalar.
#[inline(always)]
pub(super) fn limits<T: Real>() -> [f64; 2] {
    let single = epsilon::<T>() > real::<T>(1e-9);
    if single { [SHORT_SINGLE, CURVED_SINGLE] } else { [SHORT, CURVED] }
}
