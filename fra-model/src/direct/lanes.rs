//! The direct way for several actuators side by side: the same steps for all, and a look afterwards at which were certified.

use core::marker::PhantomData;

use nalgebra::Vector3;

use super::arithmetic::{ATANH_REACH, Arithmetic};
use super::kernel::{Constants, Linearised, Norm, Rest, Unknowns};
use super::path::{CONTRACTION, CORRECTION, tolerance};
use super::{Direct, Equilibrium};
use crate::real::Real;

/// Most values side by side.
pub const LANES: usize = 8;

/// Arithmetic on several floats at once.
pub trait Lanes<T>: Arithmetic {
    /// Number of floats, at most [`LANES`].
    const COUNT: usize;

    /// The first floats of an array; `self` only tells the type.
    fn load(self, values: &[T; LANES]) -> Self;

    /// Writes to the front of an array.
    fn store(self, values: &mut [T; LANES]);
}

/// Most steps before the last one.
const MOST_PARTS: u32 = 4;
/// Evaluations that every lane gets after the last step.
const EVALUATIONS: u32 = 3;

/// Loads one field of every lane.
macro_rules! gather {
    ($token:expr, $lanes:expr, $direct:ident => $value:expr) => {
        $token.load(&$lanes.map(|$direct| $value))
    };
}

/// The equilibria at pressures `P/mu1` without load; `None` for the lanes whose way is not certified.
#[inline(always)]
pub(crate) fn forward<T: Real, V: Lanes<T>>(
    token: V,
    lanes: [&Direct<T>; LANES],
    pressures: &[T; LANES],
    found: &mut [Option<Equilibrium<T>>; LANES],
) {
    if lanes.iter().any(|direct| direct.twists_by_itself()) {
        solve::<T, V, true>(token, lanes, pressures, found);
    } else {
        solve::<T, V, false>(token, lanes, pressures, found);
    }
}

#[inline(always)]
fn solve<T: Real, V: Lanes<T>, const TWIST: bool>(
    token: V,
    lanes: [&Direct<T>; LANES],
    pressures: &[T; LANES],
    found: &mut [Option<Equilibrium<T>>; LANES],
) {
    let zero = token.of(0.0);
    let c = Constants {
        x_outer: gather!(token, lanes, a => a.constants.x_outer),
        d: gather!(token, lanes, a => a.constants.d),
        per_x_fiber: gather!(token, lanes, a => a.constants.per_x_fiber),
        sin_rho: if TWIST { gather!(token, lanes, a => a.constants.sin_rho) } else { zero },
        neutral: gather!(token, lanes, a => a.constants.neutral),
        cos: gather!(token, lanes, a => a.constants.cos),
        sin2: gather!(token, lanes, a => a.constants.sin2),
        compliance: gather!(token, lanes, a => a.constants.compliance),
        scale: gather!(token, lanes, a => a.constants.scale),
    };
    let norm =
        Norm { twist: gather!(token, lanes, a => a.norm.twist), tension: gather!(token, lanes, a => a.norm.tension) };
    let rate = Unknowns {
        e: gather!(token, lanes, a => a.rate.e),
        w: gather!(token, lanes, a => a.rate.w),
        g: if TWIST { gather!(token, lanes, a => a.rate.g) } else { zero },
        tension: gather!(token, lanes, a => a.rate.tension),
    };
    let curve = Unknowns {
        e: gather!(token, lanes, a => a.curve.e),
        w: gather!(token, lanes, a => a.curve.w),
        g: if TWIST { gather!(token, lanes, a => a.curve.g) } else { zero },
        tension: gather!(token, lanes, a => a.curve.tension),
    };
    let pressure = token.load(pressures);
    let contraction = gather!(token, lanes, a => a.contraction);
    let tolerance = token.load(&[tolerance::<T>(); LANES]);
    let in_parts = (0..LANES).any(|i| !lanes[i].is_one_step_to(pressures[i]));
    let end = Way { c: &c, norm, pressure, tolerance, scalar: PhantomData }.follow::<TWIST>(
        &rate,
        &curve,
        contraction,
        in_parts,
    );
    unpack(&end, pressures, found);
}

/// A pressure and what it acts on.
struct Way<'a, T, V> {
    c: &'a Constants<V>,
    norm: Norm<V>,
    pressure: V,
    tolerance: V,
    scalar: PhantomData<T>,
}

/// Where the lanes have arrived. Those are certified whose `margin` is positive.
struct Arrival<V> {
    at: Unknowns<V>,
    radii: (V, V),
    volume_rate: V,
    residual: V,
    margin: V,
    evaluations: u32,
}

/// A state on the way: what the last step left to be checked.
struct Stage<V> {
    at: Unknowns<V>,
    /// The pressure it belongs to.
    part: V,
    last: V,
    margin: V,
}

impl<T: Real, V: Lanes<T>> Way<'_, T, V> {
    /// From rest to the pressure; `in_parts` where some lanes take two steps.
    #[inline(always)]
    fn follow<const TWIST: bool>(
        &self,
        rate: &Unknowns<V>,
        curve: &Unknowns<V>,
        contraction: V,
        in_parts: bool,
    ) -> Arrival<V> {
        let Self { c, norm, pressure, .. } = *self;
        let (one, allowed) = (pressure.of(1.0), pressure.of(CONTRACTION));
        // A little less than what is allowed, so that rounding does not refuse it.
        let share = if in_parts {
            (pressure.of(0.99 * CONTRACTION) / (contraction * pressure.magnitude())).least(one)
        } else {
            one
        };
        let part = pressure * share;
        let first = rate.times(part);
        let ratio = curve.w * part / rate.w;
        let at = first.plus(curve.times(part * part / (one - ratio)));
        let margin = allowed - contraction * part.magnitude();
        let mut stage = Stage { at, part, last: norm.size::<TWIST>(&first), margin };
        let mut parts = 0;
        while parts < MOST_PARTS && in_parts && !self.has_arrived(&stage) {
            stage = self.go_on::<TWIST>(stage);
            parts += 1;
        }
        for round in 1..EVALUATIONS {
            let (lin, rest) = self.look::<TWIST>(&mut stage);
            let step = self.correct::<TWIST>(&mut stage, &lin, rest);
            if round == 1 {
                stage.at = stage.at.plus(lin.solve(c, lin.curvature(c, step)));
            }
        }
        let (lin, rest) = self.look::<TWIST>(&mut stage);
        self.correct::<TWIST>(&mut stage, &lin, rest);
        // A lane that has not arrived has its last correction from there, which is not small.
        let settled = norm.size::<TWIST>(&stage.at) * self.tolerance - stage.last;
        Arrival {
            at: stage.at,
            radii: stage.at.radii(c.x_outer),
            volume_rate: lin.rate(c).w,
            residual: rest.e.magnitude() + rest.w.magnitude() + rest.g.magnitude(),
            margin: stage.margin.least(settled),
            evaluations: EVALUATIONS + parts,
        }
    }

    /// The equations at a stage.
    #[inline(always)]
    fn look<const TWIST: bool>(&self, stage: &mut Stage<V>) -> (Linearised<V, TWIST>, Rest<V>) {
        let (at, one, zero) = (stage.at, self.pressure.of(1.0), self.pressure.of(0.0));
        let lin = Linearised::<V, TWIST>::new(self.c, at);
        let inside = (one + at.e).least(one + at.w).least(one.of(ATANH_REACH) - lin.s2);
        stage.margin = stage.margin.least(lin.stability).least(inside);
        let rest = lin.rest(self.c, zero, self.pressure, zero);
        (lin, rest)
    }

    /// Newton's correction, which must be short against the last step.
    #[inline(always)]
    fn correct<const TWIST: bool>(
        &self,
        stage: &mut Stage<V>,
        lin: &Linearised<V, TWIST>,
        rest: Rest<V>,
    ) -> Unknowns<V> {
        let step = lin.solve(self.c, rest);
        let size = self.norm.size::<TWIST>(&step);
        stage.at = stage.at.plus(step);
        // Below the tolerance, rounding decides.
        let allowed = stage.last * size.of(CORRECTION) + self.norm.size::<TWIST>(&stage.at) * self.tolerance;
        stage.margin = stage.margin.least(allowed - size);
        stage.last = size;
        step
    }

    /// Whether every lane is at its whole pressure.
    #[inline(always)]
    fn has_arrived(&self, stage: &Stage<V>) -> bool {
        let mut left = [T::zero(); LANES];
        (self.pressure - stage.part).store(&mut left);
        left.iter().all(|left| *left == T::zero())
    }

    /// From the equilibrium at a part of the pressure towards the whole.
    #[inline(always)]
    fn go_on<const TWIST: bool>(&self, mut stage: Stage<V>) -> Stage<V> {
        let (c, norm, one) = (self.c, &self.norm, self.pressure.of(1.0));
        let (lin, rest) = self.look::<TWIST>(&mut stage);
        let whole = lin.solve(c, rest);
        let (rate, left) = (lin.rate(c), self.pressure - stage.part);
        let near = whole.plus(rate.times(-left));
        let off = norm.size::<TWIST>(&near);
        let second = lin.solve(c, lin.curvature(c, whole));
        let (over, under) = norm.contraction::<TWIST>(&whole, &second);
        let share = (under * one.of(0.99 * CONTRACTION) / over).least(one);
        let step = near.plus(rate.times(left * share));
        let allowed = stage.last * one.of(CORRECTION) + norm.size::<TWIST>(&stage.at) * self.tolerance;
        Stage {
            at: stage.at.plus(step).plus(second.times(share * share)),
            // Exactly the whole where the share is.
            part: self.pressure - left * (one - share),
            last: norm.size::<TWIST>(&step),
            margin: stage.margin.least(allowed - off),
        }
    }
}

#[inline(always)]
fn unpack<T: Real, V: Lanes<T>>(end: &Arrival<V>, pressures: &[T; LANES], found: &mut [Option<Equilibrium<T>>; LANES]) {
    let spread = |value: V| {
        let mut to = [T::zero(); LANES];
        value.store(&mut to);
        to
    };
    let (e, w, g) = (spread(end.at.e), spread(end.at.w), spread(end.at.g));
    let (inner, outer) = (spread(end.radii.0), spread(end.radii.1));
    let (volume_rate, residual, margin) = (spread(end.volume_rate), spread(end.residual), spread(end.margin));
    for i in 0..V::COUNT {
        let finite = e[i].is_finite() && w[i].is_finite() && g[i].is_finite() && volume_rate[i].is_finite();
        if finite && margin[i] > T::zero() {
            found[i] = Some(Equilibrium {
                at: Vector3::new(e[i], w[i], g[i]),
                radii: (inner[i], outer[i]),
                pressure: pressures[i],
                volume_rate: volume_rate[i],
                residual: residual[i],
                evaluations: end.evaluations,
            });
        }
    }
}
