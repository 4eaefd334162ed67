//! Fast solver of the bend for a moment that rises throughout with the bend.

use super::{Bender, LARGEST_CURVATURE};
use crate::model::section::{Bent, Digits, EndLoad};
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
pub(crate) struct Met<T> {
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

/// Root search for the bend of a moment that rises throughout.
///
/// A cubic through the last two bends leads to the next one. The first may be rough, and then are all too large or small by the
/// same factor, nearly. The last cubic is the answer, with its slope, where the next term of its kind, of the order of
/// `step^2 whole^2`, and its derivative are below rounding.
#[derive(Clone, Copy)]
pub(super) struct Meeting<T> {
    wanted: T,
    before: Bent<T>,
    /// Bend of the next integral.
    pub(super) next: T,
    stage: Stage,
    rounds: u32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Rough,
    /// The first integral to all digits after rough ones: it scales the last of them.
    Rescale,
    Refine,
}

/// Outcome of an integral.
pub(super) enum Turn<T> {
    Again,
    Met(Met<T>),
    Lost,
}

impl<T: Real> Meeting<T> {
    /// From the straight bender, or from a bend near the desired one.
    pub(super) fn new(straight: &Bent<T>, from: T, wanted: T) -> Self {
        let next = if from > T::zero() { from } else { Scalar::min(wanted / straight.slope, real(FIRST)) };
        let double = epsilon::<T>() < real(1e-9);
        let looks_around = double && from == T::zero() && next > real(SLIGHT);
        let stage = if looks_around { Stage::Rough } else { Stage::Refine };
        Self { wanted, before: *straight, next, stage, rounds: 0 }
    }

    /// Required accuracy of the next integral.
    pub(super) fn digits(&self) -> Digits {
        if self.stage == Stage::Rough { Digits::Few } else { Digits::All }
    }

    /// Takes the integral at `next`.
    pub(super) fn take(&mut self, here: Bent<T>) -> Turn<T> {
        if self.stage == Stage::Rescale {
            let factor = here.moment / self.wanted;
            (self.before.moment, self.before.slope) = (self.before.moment * factor, self.before.slope * factor);
        }
        let Some(found) = led_on(&self.before, &here, self.wanted) else { return Turn::Lost };
        self.rounds += 1;
        match self.stage {
            Stage::Rough => {
                let settled = (found.k - self.next).abs() <= found.k * real(OPEN);
                if settled || self.rounds == ROUNDS {
                    (self.stage, self.rounds) = (Stage::Rescale, 0);
                }
            }
            Stage::Rescale => self.stage = Stage::Refine,
            Stage::Refine => {
                if let Some(met) = arrived(&self.before, &here, &found) {
                    return Turn::Met(met);
                }
            }
        }
        if self.rounds == ROUNDS {
            return Turn::Lost;
        }
        (self.before, self.next) = (here, found.k);
        Turn::Again
    }
}

impl<T: Real> Bender<T> {
    /// The bend of a moment, which must rise throughout; `None` where the iteration does not converge.
    pub(super) fn meet(&self, from: T, wanted: T, load: &EndLoad<T>, iterations: &mut u32) -> Option<Met<T>> {
        if wanted == T::zero() {
            return Some(Met { bent: self.straight, off: T::zero() });
        }
        let mut meeting = Meeting::new(&self.straight, from, wanted);
        loop {
            *iterations += 1;
            let here = self.section.sampled(meeting.next, load, meeting.digits());
            match meeting.take(here) {
                Turn::Again => {}
                Turn::Met(met) => return Some(met),
                Turn::Lost => return None,
            }
        }
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
