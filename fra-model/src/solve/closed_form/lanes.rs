//! The direct way for several actuators side by side: the same steps for all, and a look afterwards at which were certified.

use super::ClosedForm;
use super::expansion::{Expansion, ORDERS};
use super::forward::limits;
use super::kernel::{Constants, Linearised, Norm, Rest, Unknowns};
use super::path::{CONTRACTION, CORRECTION, tolerance};
use crate::number::arithmetic::{ATANH_REACH, Arithmetic};
use crate::number::lanes::{Column, LANES, Lanes};
use crate::number::real::{Real, epsilon};

/// Rounds of corrections that every lane gets.
const ROUNDS: u32 = 3;

/// Data of the closed-form solver, by actuator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns<T> {
    constants: Constants<Column<T>>,
    norm: Norm<Column<T>>,
    expansion: Expansion<Column<T>>,
    /// Whether the twist rate is an unknown.
    twists: bool,
}

/// The equilibria at pressures `P/mu1`. Those are certified whose `margin` is at least zero.
pub(crate) struct Arrival<V> {
    pub(crate) at: Unknowns<V>,
    pub(crate) volume_rate: V,
    pub(crate) residual: V,
    pub(crate) margin: V,
    pub(crate) evaluations: u32,
}

/// Each of the named fields, and the same field of another.
macro_rules! pairs {
    ($f:ident, $to:expr, $from:expr, { $($field:ident),* }) => { $($f(&mut $to.$field, &$from.$field);)* };
}

/// Every field as a vector.
macro_rules! vectors {
    ($token:expr, $columns:expr, $name:ident { $($field:ident),* }) => {
        $name { $($field: $token.load(&$columns.$field)),* }
    };
}

impl<T: Real> Columns<T> {
    /// The same actuator in every lane.
    pub(crate) fn new(direct: &ClosedForm<T>) -> Self {
        let zero = [T::zero(); LANES];
        let none = Unknowns { e: zero, w: zero, g: zero, tension: zero };
        let mut new = Self {
            constants: Constants {
                x_outer: zero,
                d: zero,
                per_x_fiber: zero,
                sin_rho: zero,
                neutral: zero,
                cos: zero,
                sin2: zero,
                compliance: zero,
                scale: zero,
            },
            norm: Norm { twist: zero, tension: zero },
            expansion: Expansion {
                unit: zero,
                contraction: zero,
                reach: zero,
                short: zero,
                terms: [none; ORDERS],
                tail: [zero; 2],
            },
            twists: false,
        };
        new.set(0..LANES, direct);
        new
    }

    /// Puts an actuator in some lanes.
    #[inline(always)]
    pub(crate) fn set(&mut self, lanes: core::ops::Range<usize>, direct: &ClosedForm<T>) {
        self.twists |= direct.twists_by_itself();
        self.pairs(&direct.constants, &direct.norm, &direct.expansion, |to, from| to[lanes.clone()].fill(*from));
    }

    /// Puts a lane of others in a lane.
    #[inline(always)]
    pub(crate) fn copy(&mut self, lane: usize, from: &Self, from_lane: usize) {
        self.twists |= from.twists;
        self.pairs(&from.constants, &from.norm, &from.expansion, |to, from| to[lane] = from[from_lane]);
    }

    /// No lane counts any more for whether the twist rate is an unknown.
    pub(crate) fn clear(&mut self) {
        self.twists = false;
    }

    /// Every column with its counterpart.
    #[inline(always)]
    fn pairs<S>(
        &mut self,
        constants: &Constants<S>,
        norm: &Norm<S>,
        expansion: &Expansion<S>,
        mut f: impl FnMut(&mut Column<T>, &S),
    ) {
        pairs!(
            f,
            self.constants,
            constants,
            { x_outer, d, per_x_fiber, sin_rho, neutral, cos, sin2, compliance, scale }
        );
        pairs!(f, self.norm, norm, { twist, tension });
        pairs!(f, self.expansion, expansion, { unit, contraction, reach, short });
        for (to, from) in self.expansion.terms.iter_mut().zip(&expansion.terms) {
            pairs!(f, to, from, { e, w, g, tension });
        }
        for (to, from) in self.expansion.tail.iter_mut().zip(&expansion.tail) {
            f(to, from);
        }
    }

    /// The equilibria at pressures `P/mu1` without load; where `ONCE`, those alone that take one correction.
    #[inline(always)]
    pub(crate) fn forward<V: Lanes<T>, const ONCE: bool>(&self, pressure: V) -> Arrival<V> {
        if self.twists { self.solve::<V, true, ONCE>(pressure) } else { self.solve::<V, false, ONCE>(pressure) }
    }

    #[inline(always)]
    fn solve<V: Lanes<T>, const TWIST: bool, const ONCE: bool>(&self, pressure: V) -> Arrival<V> {
        let expansion = &self.expansion;
        let mut terms = [Unknowns { e: pressure, w: pressure, g: pressure, tension: pressure }; ORDERS];
        for (term, columns) in terms.iter_mut().zip(&expansion.terms) {
            let zero = pressure.of(0.0);
            *term = Unknowns {
                e: pressure.load(&columns.e),
                w: pressure.load(&columns.w),
                g: if TWIST { pressure.load(&columns.g) } else { zero },
                tension: pressure.load(&columns.tension),
            };
        }
        let expansion = Expansion {
            unit: pressure.load(&expansion.unit),
            contraction: pressure.load(&expansion.contraction),
            reach: pressure.load(&expansion.reach),
            short: pressure.load(&expansion.short),
            terms,
            tail: [pressure.load(&expansion.tail[0]), pressure.load(&expansion.tail[1])],
        };
        let constants = vectors!(
            pressure,
            self.constants,
            Constants { x_outer, d, per_x_fiber, sin_rho, neutral, cos, sin2, compliance, scale }
        );
        let norm = vectors!(pressure, self.norm, Norm { twist, tension });
        let digits = [tolerance::<T>(), epsilon::<T>()].map(|digits| pressure.load(&[digits; LANES]));
        let way = Way {
            c: &constants,
            norm,
            pressure,
            tolerance: digits[0],
            epsilon: digits[1],
            limits: limits::<T>().map(|v| pressure.of(v)),
        };
        if ONCE { way.rise_once::<TWIST>(&expansion) } else { way.rise::<T, TWIST>(&expansion) }
    }
}

/// Pressures and what they act on.
struct Way<'a, V> {
    c: &'a Constants<V>,
    norm: Norm<V>,
    pressure: V,
    tolerance: V,
    epsilon: V,
    /// Of the last correction: its length as a share of the state, and its contraction factor.
    limits: [V; 2],
}

/// A state on the way: what the last step left to be checked.
#[derive(Clone, Copy)]
struct Stage<V> {
    at: Unknowns<V>,
    last: V,
    margin: V,
}

/// A correction that was made.
struct Round<V> {
    /// Rest after its first term.
    left: Rest<V>,
    volume_rate: V,
    /// Negative where it was not the last.
    open: V,
}

#[inline(always)]
fn has<T: Real, V: Lanes<T>>(values: V, what: impl Fn(T) -> bool) -> bool {
    let mut stored = [T::zero(); LANES];
    values.store(&mut stored);
    stored.iter().take(V::COUNT).any(|value| what(*value))
}

impl<V: Arithmetic> Way<'_, V> {
    /// The sum of the series, where the steps to it are certified.
    #[inline(always)]
    fn leave<const TWIST: bool>(&self, expansion: &Expansion<V>) -> Stage<V> {
        let z = self.pressure * expansion.unit;
        let at = expansion.sum::<TWIST>(z).plus(expansion.beyond::<TWIST>(z));
        let margin = (expansion.reach - z).least(z.of(CONTRACTION).plus_product(z, expansion.contraction));
        Stage { at, last: expansion.short * z.magnitude(), margin }
    }

    /// One correction.
    #[inline(always)]
    fn rise_once<const TWIST: bool>(&self, expansion: &Expansion<V>) -> Arrival<V> {
        let mut stage = self.leave::<TWIST>(expansion);
        let round = self.round::<TWIST>(&mut stage);
        self.arrive::<TWIST>(stage, round, 1)
    }

    /// As many as it takes.
    #[inline(always)]
    fn rise<T: Real, const TWIST: bool>(&self, expansion: &Expansion<V>) -> Arrival<V>
    where
        V: Lanes<T>,
    {
        let mut stage = self.leave::<TWIST>(expansion);
        let mut evaluations = 0;
        loop {
            evaluations += 1;
            let round = self.round::<TWIST>(&mut stage);
            let is_open = has::<T, V>(round.open, |open| open < T::zero());
            if !is_open || evaluations >= ROUNDS {
                return self.arrive::<TWIST>(stage, round, evaluations);
            }
        }
    }

    /// One correction of two terms.
    #[inline(always)]
    fn round<const TWIST: bool>(&self, stage: &mut Stage<V>) -> Round<V> {
        let (lin, rest) = self.look::<TWIST>(stage, self.pressure);
        let first = lin.solve(self.c, rest);
        let left = lin.curvature(self.c, first);
        let second = lin.solve(self.c, left);
        let step = first.plus(second);
        let open = self.correct::<TWIST>(stage, &first, &second, &step);
        Round { left, volume_rate: lin.volume_rate_after(self.c, &step), open }
    }

    /// After the last correction.
    #[inline(always)]
    fn arrive<const TWIST: bool>(&self, stage: Stage<V>, round: Round<V>, evaluations: u32) -> Arrival<V> {
        let Round { left, volume_rate, open } = round;
        let leave = left.e.magnitude() + left.w.magnitude();
        let leave = if TWIST { leave + left.g.magnitude() } else { leave };
        let rounding = self.pressure.magnitude() * self.epsilon;
        Arrival {
            at: stage.at,
            volume_rate,
            residual: leave * leave.of(4e-3) + rounding,
            margin: stage.margin.least(open),
            evaluations,
        }
    }

    /// The equations at the state of a stage, which must be in their domain and stable.
    #[inline(always)]
    fn look<const TWIST: bool>(&self, stage: &mut Stage<V>, pressure: V) -> (Linearised<V, TWIST>, Rest<V>) {
        let (at, one, zero) = (stage.at, pressure.of(1.0), pressure.of(0.0));
        let lin = Linearised::<V, TWIST>::new(self.c, at);
        let inside = (one + at.e).least(one + at.w).least(one.of(ATANH_REACH) - lin.s2);
        stage.margin = stage.margin.least(lin.stability).least(inside);
        let rest = lin.rest(self.c, zero, pressure, zero);
        (lin, rest)
    }

    /// A correction, which must be short against the last step; negative where it was not the last.
    #[inline(always)]
    fn correct<const TWIST: bool>(
        &self,
        stage: &mut Stage<V>,
        first: &Unknowns<V>,
        second: &Unknowns<V>,
        step: &Unknowns<V>,
    ) -> V {
        let (size, (turn, strain)) = (self.norm.size::<TWIST>(first), self.norm.contraction::<TWIST>(first, second));
        stage.at = stage.at.plus(*step);
        let whole = self.norm.size::<TWIST>(&stage.at);
        // Below the tolerance, rounding decides.
        let allowed = stage.last * size.of(CORRECTION) + whole * self.tolerance;
        stage.margin = stage.margin.least(allowed - size);
        stage.last = size;
        let [short, curved] = self.limits;
        let left = size * whole * self.epsilon * size.of(0.125) - turn * turn;
        (whole * short - size).least(strain * curved - turn).least(left)
    }
}
