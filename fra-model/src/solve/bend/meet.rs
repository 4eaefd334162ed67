//! Fast solver of the bend for a moment that rises throughout with the bend.

use super::{Bender, LARGEST_CURVATURE};
use crate::model::section::{Bent, EndLoad};
use crate::number::real::{Real, epsilon, real};
use crate::number::scalar::Scalar;

/// Most integrations of either kind.
const ROUNDS: u32 = 8;

/// Bend up to which the slope at rest is followed at first.
const FIRST: f64 = 0.5;
/// Bend from which a rough look pays.
const SLIGHT: f64 = 1e-3;
/// Share of a bend that a rough look may leave open.
const OPEN: f64 = 0.03;
/// With the bend, the length over which the moment changes its ways.
const SCALE: f64 = 0.25;

/// A bend that was met.
pub(super) struct Met<T> {
    pub(super) bent: Bent<T>,
    /// Tolerance of its moment.
    pub(super) off: T,
}

/// The bend over the moment: the cubic through two bends and their slopes.
struct Cubic<T> {
    last: (T, T),
    first_moment: T,
    /// Divided differences: of the last bend once and twice, then with the first.
    terms: [T; 3],
}

impl<T: Real> Cubic<T> {
    fn new(first: &Bent<T>, last: &Bent<T>) -> Self {
        let (one, span) = (T::one(), last.moment - first.moment);
        let chord = (last.k - first.k) / span;
        let by_last = (one / last.slope - chord) / span;
        let by_first = (chord - one / first.slope) / span;
        Self {
            last: (last.moment, last.k),
            first_moment: first.moment,
            terms: [one / last.slope, by_last, (by_last - by_first) / span],
        }
    }

    fn at(&self, moment: T) -> Bent<T> {
        let (away, whole) = (moment - self.last.0, moment - self.first_moment);
        let [slope, square, cube] = self.terms;
        let rate = slope + away * (square + square + cube * (whole + whole + away));
        Bent { k: self.last.1 + away * (slope + away * (square + cube * whole)), moment, slope: T::one() / rate }
    }
}

impl<T: Real> Bender<T> {
    /// The bend of a moment, which must rise throughout; `None` where the iteration does not converge.
    ///
    /// A cubic through the last two bends leads to the next one. The first may be rough, and then are all too large or small by the
    /// same factor, nearly. The last cubic is the answer, with its slope, where the next term of its kind, of the order of
    /// `step^2 whole^2`, and its derivative are below rounding.
    pub(super) fn meet(&self, from: T, wanted: T, load: &EndLoad<T>, iterations: &mut u32) -> Option<Met<T>> {
        if wanted == T::zero() {
            return Some(Met { bent: self.straight, off: T::zero() });
        }
        let first = if from > T::zero() { from } else { Scalar::min(wanted / self.straight.slope, real(FIRST)) };
        let double = epsilon::<T>() < real(1e-9);
        let (mut before, mut next, mut is_rough) = (self.straight, first, false);
        if double && from == T::zero() && first > real(SLIGHT) {
            (before, next) = self.look_around(first, wanted, load, iterations)?;
            is_rough = true;
        }
        for _ in 0..ROUNDS {
            let here = self.bent(next, load, iterations);
            if is_rough {
                let factor = here.moment / wanted;
                (before.moment, before.slope) = (before.moment * factor, before.slope * factor);
            }
            let found = led_on(&before, &here, wanted)?;
            if let Some(met) = arrived(&before, &here, &found).filter(|_| !is_rough) {
                return Some(met);
            }
            (before, is_rough, next) = (here, false, found.k);
        }
        None
    }

    /// A rough bend near the desired one, and the next guess.
    fn look_around(&self, first: T, wanted: T, load: &EndLoad<T>, iterations: &mut u32) -> Option<(Bent<T>, T)> {
        let (mut before, mut next) = (self.straight, first);
        for _ in 0..ROUNDS {
            *iterations += 1;
            let here = self.section.roughly_bent(next, load);
            let found = led_on(&before, &here, wanted)?;
            let settled = (found.k - next).abs() <= found.k * real(OPEN);
            (before, next) = (here, found.k);
            if settled {
                break;
            }
        }
        Some((before, next))
    }
}

/// The answer, if a cubic has found it: what it leaves out is below rounding, and the roundings of its differences are.
fn arrived<T: Real>(before: &Bent<T>, here: &Bent<T>, found: &Bent<T>) -> Option<Met<T>> {
    let (step, whole, size) = ((found.k - here.k).abs(), (found.k - before.k).abs(), found.k + real(SCALE));
    let rounding = epsilon::<T>() * found.k;
    let met = |bent: Bent<T>, left: T| Some(Met { bent, off: (left + rounding) * bent.slope });
    if step <= rounding * real(4.0) {
        let k = here.k + (found.moment - here.moment) / here.slope;
        return met(Bent { k, moment: found.moment, slope: here.slope }, T::zero());
    }
    let share = whole / size;
    let left = step * share * share;
    let is_last = left <= epsilon::<T>() * size * real(0.5) && step * found.k <= whole * whole;
    if is_last { met(*found, left * step / size) } else { None }
}

/// Bend predicted by two others; `None` unless their moments differ and rise, and the predicted bend is within bounds.
fn led_on<T: Real>(before: &Bent<T>, here: &Bent<T>, wanted: T) -> Option<Bent<T>> {
    let rises = here.moment.is_finite() && here.slope > T::zero() && here.moment != before.moment;
    if !rises {
        return None;
    }
    let found = Cubic::new(before, here).at(wanted);
    let longest = (here.k + real(FIRST)) * real(2.0);
    let sane = found.k > T::zero() && found.slope > T::zero() && found.k < longest.min(real(LARGEST_CURVATURE));
    sane.then_some(found)
}
