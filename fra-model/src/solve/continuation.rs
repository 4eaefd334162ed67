//! Continuation of the branch of equilibria connected to zero pressure, in the lumen's volume.
//!
//! A state that is stable under pressure control and dead load has a positive definite Hessian, hence `dP/dw > 0`: along the
//! stable branch the volume grows strictly with the pressure, and it still does at the limit point where the pressure does not.
//! So every query - a pressure, a deformation, the limit itself - is a search in the one coordinate `w`, with the axial
//! strain and the twist rate settled at each `w`. Steps are bounded by what the tangent predicted, so that the search cannot
//! jump to another branch.

use nalgebra::Vector3;

use crate::number::scalar::{Scalar, dot, largest, magnitudes};
use crate::solve::energy::{Derivatives, Wall};
use crate::solve::residual::Residual;

/// Most Newton iterations to settle at one volume, or under one load.
pub(crate) const SETTLE_ITERATIONS: u32 = 40;
/// Most steps to refine a root between two states.
const REFINE_STEPS: u32 = 100;
/// Newton's steps may grow this long: stiff fibers make narrow curved valleys.
const ERRATIC_ITERATIONS: u32 = 8;
/// Newton's steps may stop shrinking only below this many units in the last place.
pub(crate) const STALL: f64 = 1e4;
/// Largest share of the volume's change in which rounding may hide the root; beyond it there is no answer.
const COARSEST: f64 = 1e-3;
/// Largest share of the change of a step that plain arithmetic may lose by rounding; beyond it the step cannot be checked.
pub(crate) const BLINDING: f64 = 0.03;
/// A root is left where the residual is this many times its rounding.
const LEFT: f64 = 4.0;
/// Farther than any step.
pub(crate) const FAR: f64 = 1e30;
/// Longest step in `ln(1 + w)`.
const LONGEST_STEP: f64 = 0.25;
/// The branch is followed within these bounds of `1 + w` and of `P/mu1`.
const LARGEST_VOLUME: f64 = 1e6;
const SMALLEST_VOLUME: f64 = 1e-6;
pub(crate) const LARGEST_PRESSURE: f64 = 1e4;

/// A state on the branch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<T> {
    /// `(e, w, g)`.
    pub(crate) at: Vector3<T>,
    /// `d(e, w, g)/dw` along the branch.
    pub(crate) tangent: Vector3<T>,
    /// `P/mu1`.
    pub(crate) pressure: T,
    /// `d(P/mu1)/dw` along the branch; positive while the branch is stable.
    pub(crate) slope: T,
    /// Largest residual of the two load equations.
    pub(crate) residual: T,
    /// Effect of the state's rounding on `pressure` ...
    pub(crate) pressure_noise: T,
    /// ... and to `(e, g)` when they are settled: stiff fibers magnify the last digit.
    pub(crate) settling_noise: Vector3<T>,
}

impl<T: Scalar> Point<T> {
    /// The same point in another scalar.
    pub(crate) fn map<U: Scalar>(&self, f: impl Fn(T) -> U) -> Point<U> {
        Point {
            at: self.at.map(&f),
            tangent: self.tangent.map(&f),
            pressure: f(self.pressure),
            slope: f(self.slope),
            residual: f(self.residual),
            pressure_noise: f(self.pressure_noise),
            settling_noise: self.settling_noise.map(&f),
        }
    }
}

/// Outcome of a search.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Outcome<T> {
    /// The residual vanishes here.
    Root(Point<T>),
    /// The branch ends at a limit point before the root.
    Limit(Point<T>),
    /// No root within the bounds of the search; the last state.
    Unreached(Point<T>),
    /// Newton's method failed; the last good state.
    Failed(Point<T>),
}

impl<T> Outcome<T> {
    /// Last point of the search.
    pub(crate) fn point(self) -> Point<T> {
        match self {
            Self::Root(point) | Self::Limit(point) | Self::Unreached(point) | Self::Failed(point) => point,
        }
    }

    pub(crate) fn map<U>(self, f: impl Fn(Point<T>) -> Point<U>) -> Outcome<U> {
        match self {
            Self::Root(point) => Outcome::Root(f(point)),
            Self::Limit(point) => Outcome::Limit(f(point)),
            Self::Unreached(point) => Outcome::Unreached(f(point)),
            Self::Failed(point) => Outcome::Failed(f(point)),
        }
    }
}

/// A tube under a fixed external load.
pub(crate) struct Continuation<'a, T> {
    pub(crate) wall: &'a Wall<T>,
    /// `N_ext/(pi R_i^2 mu1)`.
    pub(crate) force: T,
    /// `M_ext/(pi R_i^3 mu1)`.
    pub(crate) torque: T,
    /// Whether the twist rate is an unknown; else it is zero by symmetry.
    pub(crate) twists: bool,
    /// Newton iterations after which a search gives up.
    pub(crate) budget: u32,
}

impl<T: Scalar> Continuation<'_, T> {
    /// The state at `w`, settled from a guess of `(e, g)`; `None` when Newton fails or the state is not stable at fixed volume.
    fn settle(&self, guess: Vector3<T>, iterations: &mut u32) -> Option<Point<T>> {
        let mut at = guess;
        let mut last = T::constant(FAR);
        for round in 0..SETTLE_ITERATIONS {
            *iterations += 1;
            let d = self.wall.derivatives(at.x, at.y, at.z);
            let (de, dg) = self.solve_loads(&d, self.force - d.gradient.x, self.torque - d.gradient.z)?;
            let lambda = T::one() + at.x;
            if !de.is_finite() || !dg.is_finite() || de.abs() > lambda * T::constant(0.5) {
                return None;
            }
            at.x += de;
            at.z += dg;
            let size = de.abs().max(dg.abs());
            let scale = largest(&at);
            let floor = size <= T::rounding() * scale;
            let noise = self.settling_noise(&d, at)?;
            let rounding = size <= (T::constant(STALL) * T::rounding() * scale).max(largest(&noise));
            let stalled = size >= last * T::constant(0.5) && rounding;
            if floor || stalled {
                return self.stable_point(at);
            }
            if round >= ERRATIC_ITERATIONS && size > last * T::constant(4.0) {
                return None;
            }
            last = size;
        }
        None
    }

    /// Solves the `(e, g)` block for two right sides; `None` unless it is positive definite.
    pub(crate) fn solve_loads(&self, d: &Derivatives<T>, by_e: T, by_g: T) -> Option<(T, T)> {
        let (ee, eg, gg) = (d.hessian[(0, 0)], d.hessian[(0, 2)], d.hessian[(2, 2)]);
        let ee = positive(ee)?;
        if !self.twists {
            return Some((by_e / ee, T::zero()));
        }
        let rest = positive(gg - eg * (eg / ee))?;
        let dg = (by_g - eg / ee * by_e) / rest;
        Some(((by_e - eg * dg) / ee, dg))
    }

    fn stable_point(&self, at: Vector3<T>) -> Option<Point<T>> {
        let d = self.wall.derivatives(at.x, at.y, at.z);
        let (e_w, g_w) = self.solve_loads(&d, -d.hessian[(0, 1)], -d.hessian[(2, 1)])?;
        let slope = d.hessian[(1, 1)] + d.hessian[(0, 1)] * e_w + d.hessian[(2, 1)] * g_w;
        let torque_rest = if self.twists { d.gradient.z - self.torque } else { T::zero() };
        let residual = (d.gradient.x - self.force).abs().max(torque_rest.abs());
        let settling_noise = self.settling_noise(&d, at)?;
        let coupling = magnitudes(&d.hessian.column(1).into_owned());
        let plain = (d.gradient.y, gradient_noise(&d, at).y + dot(&coupling, &settling_noise));
        let torque = if self.twists { Some(self.torque) } else { None };
        let by_tension = self.wall.pressure_by_tension(at, self.force, torque, &settling_noise);
        let (pressure, pressure_noise) = by_tension.filter(|(_, noise)| *noise < plain.1).unwrap_or(plain);
        let finite = slope.is_finite() && pressure.is_finite() && residual.is_finite();
        let tangent = Vector3::new(e_w, T::one(), g_w);
        finite.then_some(Point { at, tangent, pressure, slope, residual, pressure_noise, settling_noise })
    }

    /// Error of `(e, g)` left by the rounding of the load equations.
    pub(crate) fn settling_noise(&self, d: &Derivatives<T>, at: Vector3<T>) -> Option<Vector3<T>> {
        let noise = gradient_noise(d, at);
        let (by_force, by_torque) =
            (self.solve_loads(d, noise.x, T::zero())?, self.solve_loads(d, T::zero(), noise.z)?);
        Some(Vector3::new(by_force.0.abs() + by_torque.0.abs(), T::zero(), by_force.1.abs() + by_torque.1.abs()))
    }

    /// A state known to be an equilibrium; falls back to a flat tangent where the block is singular.
    pub(crate) fn point(&self, at: Vector3<T>) -> Point<T> {
        self.stable_point(at).unwrap_or_else(|| Point {
            at,
            tangent: Vector3::new(T::zero(), T::one(), T::zero()),
            pressure: T::zero(),
            slope: T::zero(),
            residual: T::zero(),
            pressure_noise: T::zero(),
            settling_noise: Vector3::repeat(T::zero()),
        })
    }

    /// A state given from outside, settled at its volume; failed when it is not near the branch or not stable.
    pub(crate) fn resume(&self, at: Vector3<T>, iterations: &mut u32) -> Outcome<T> {
        let inside = at.x > -T::one() && at.y > -T::one();
        let point = if inside { self.settle(at, iterations) } else { None };
        let stable = point.filter(|point| point.slope > T::zero());
        stable.map_or_else(|| Outcome::Failed(self.point(at)), Outcome::Root)
    }

    /// The state at `w`, predicted along the tangent of `from`.
    fn advance(&self, from: &Point<T>, w: T, iterations: &mut u32) -> Option<Point<T>> {
        let mut guess = from.at + from.tangent * (w - from.at.y);
        guess.y = w;
        (guess.x > -T::one()).then_some(())?;
        self.settle(guess, iterations)
    }

    /// The state at `w`, or on a part of the way there where Newton fails on the whole of it.
    fn advance_part(&self, from: &Point<T>, w: T, iterations: &mut u32) -> Option<Point<T>> {
        let mut way = w - from.at.y;
        for _ in 0..8 {
            if let Some(point) = self.advance(from, from.at.y + way, iterations) {
                return Some(point);
            }
            way *= T::constant(0.25);
        }
        None
    }

    /// The first state past a root at which rounding no longer explains the residual.
    pub(crate) fn leave(
        &self,
        root: Point<T>,
        residual: &Residual<T>,
        outwards: bool,
        iterations: &mut u32,
    ) -> Outcome<T> {
        let mut share = T::rounding().sqrt();
        while share < T::constant(LONGEST_STEP) {
            let way = share * (T::one() + root.at.y);
            let w = root.at.y + if outwards { way } else { -way };
            let Some(there) = self.advance(&root, w, iterations) else { return Outcome::Failed(root) };
            if there.slope <= T::zero() {
                return Outcome::Limit(root);
            }
            let (value, rate) = residual.measure(&there);
            let seen = value.abs() > T::constant(LEFT) * residual.noise(&there);
            if seen && (value / rate).abs() > T::constant(STALL) * T::rounding() * there.at.y.abs() {
                return Outcome::Root(there);
            }
            share *= T::constant(4.0);
        }
        Outcome::Failed(root)
    }

    /// Follows the branch from `start`, towards larger volume if `outwards`, until the goal is met, the branch ends, or the
    /// pressure exceeds `within` either way.
    pub(crate) fn search(
        &self,
        start: Point<T>,
        residual: &Residual<T>,
        outwards: bool,
        within: T,
        iterations: &mut u32,
    ) -> Outcome<T> {
        let longest = T::constant(LONGEST_STEP);
        let (mut here, mut step) = (start, longest);
        let mut last_wanted = T::constant(FAR);
        // A start at the root may lie behind it by its rounding.
        let (value, rate) = residual.measure(&here);
        if value.abs() <= residual.noise(&here) && is_tolerable(value / rate, &here) {
            return Outcome::Root(here);
        }
        while *iterations < self.budget {
            let (value, rate) = residual.measure(&here);
            let wanted = -value / rate;
            let size = wanted.abs();
            // At the root: exactly, within the last digit, or where rounding keeps Newton's steps from shrinking further.
            let last_digit = T::epsilon() * here.at.y.abs();
            let stalls = T::constant(STALL) * T::rounding() * here.at.y.abs();
            let rounding = size <= stalls || (value.abs() <= residual.noise(&here) && is_tolerable(size, &here));
            let stalled = size >= last_wanted * T::constant(0.5) && rounding;
            if value == T::zero() || size <= last_digit || stalled {
                return Outcome::Root(here);
            }
            last_wanted = size;
            let change = (here.slope * (T::one() + here.at.y)).max(here.pressure.abs());
            if is_plain::<T>() && here.pressure_noise > T::constant(BLINDING) * change {
                return Outcome::Failed(here);
            }
            let mut dw = stride(&here, wanted, outwards, step);
            let there = loop {
                if let Some(there) = self.step(&here, dw, iterations) {
                    break there;
                }
                if *iterations >= self.budget {
                    return Outcome::Failed(here);
                }
                dw *= T::constant(0.5);
                step = (dw / (T::one() + here.at.y)).abs();
                if step < T::constant(64.0) * T::rounding() {
                    return if rounding { Outcome::Root(here) } else { Outcome::Failed(here) };
                }
            };
            if there.slope <= T::zero() {
                return self.near_limit(here, there, residual, iterations);
            }
            if let Some(found) = self.between(&here, &there, residual, outwards, iterations) {
                return found;
            }
            if out_of_bounds(&there, within) {
                return Outcome::Unreached(there);
            }
            here = there;
            step = (step * T::constant(2.0)).min(longest);
        }
        Outcome::Failed(here)
    }

    /// One step; `None` when it is not to be trusted and a shorter one shall be tried.
    fn step(&self, here: &Point<T>, dw: T, iterations: &mut u32) -> Option<Point<T>> {
        let there = self.advance(here, here.at.y + dw, iterations)?;
        let (half, tenth) = (T::constant(0.5), T::constant(0.1));
        let off_tangent = largest(&(there.at - here.at - here.tangent * dw));
        let scale = T::one() + here.at.x.min(here.at.y);
        let straight = off_tangent <= tenth * scale.min(T::one());
        // The slope may halve or treble in a step; only a short one may cross the limit point, however sharp that is.
        let fall = here.slope - there.slope;
        let short = dw.abs() <= (T::one() + here.at.y) * T::constant(0.01);
        let crosses = there.slope <= T::zero();
        let gentle = if crosses { short } else { fall <= half * here.slope && -fall <= T::constant(2.0) * here.slope };
        let along = (there.pressure - here.pressure - half * (here.slope + there.slope) * dw).abs();
        let rounding = T::constant(4.0) * (here.pressure_noise + there.pressure_noise);
        let resolved = along <= tenth * dw.abs() * here.slope.max(there.slope.abs()) + rounding;
        (straight && gentle && resolved).then_some(there)
    }

    /// Looks for the goal between two stable states: a change of sign, or an extremum that reaches across.
    fn between(
        &self,
        a: &Point<T>,
        b: &Point<T>,
        residual: &Residual<T>,
        outwards: bool,
        iterations: &mut u32,
    ) -> Option<Outcome<T>> {
        let ((value_a, rate_a), (value_b, rate_b)) = (residual.measure(a), residual.measure(b));
        if (value_a > T::zero()) != (value_b > T::zero()) {
            return Some(self.refine(*a, *b, |p| residual.measure(p), iterations));
        }
        let way = if outwards { T::one() } else { -T::one() };
        let (approach_a, approach_b) = (value_a * rate_a * way, value_b * rate_b * way);
        if !(approach_a < T::zero() && approach_b > T::zero()) {
            return None;
        }
        let nearest = match self.refine(*a, *b, |p| (residual.measure(p).1, T::zero()), iterations) {
            Outcome::Root(point) => point,
            failed => return Some(failed),
        };
        let crossed = (residual.measure(&nearest).0 > T::zero()) != (value_a > T::zero());
        crossed.then(|| self.refine(*a, nearest, |p| residual.measure(p), iterations))
    }

    /// The branch turns between `a` (stable) and `b` (not): the goal before the limit point, or the limit point.
    fn near_limit(&self, a: Point<T>, b: Point<T>, residual: &Residual<T>, iterations: &mut u32) -> Outcome<T> {
        let limit = match self.refine(a, b, |p| (p.slope, T::zero()), iterations) {
            Outcome::Root(point) => point,
            failed => return failed,
        };
        let outwards = b.at.y > a.at.y;
        self.between(&a, &limit, residual, outwards, iterations).unwrap_or(Outcome::Limit(limit))
    }

    /// The root of `measure` between two states at which it has opposite signs: Newton where a rate is given and it stays
    /// inside, else the secant or bisection.
    fn refine(
        &self,
        a: Point<T>,
        b: Point<T>,
        measure: impl Fn(&Point<T>) -> (T, T),
        iterations: &mut u32,
    ) -> Outcome<T> {
        let (mut low, mut high) = (a, b);
        let (mut low_value, mut high_value) = (measure(&low).0, measure(&high).0);
        let mut width = (high.at.y - low.at.y).abs();
        for round in 0..REFINE_STEPS {
            let low_is_nearer = low_value.abs() <= high_value.abs();
            let (nearest, value) = if low_is_nearer { (low, low_value) } else { (high, high_value) };
            let rate = measure(&nearest).1;
            let newton = nearest.at.y - value / rate;
            let secant = low.at.y - low_value * (high.at.y - low.at.y) / (high_value - low_value);
            let middle = (low.at.y + high.at.y) * T::constant(0.5);
            let inside = |w: T| (w - low.at.y) * (w - high.at.y) < T::zero();
            // Every third round halves the bracket, so that a one-sided approach cannot stall.
            let w = match round % 3 {
                2 => middle,
                _ if inside(newton) => newton,
                _ if inside(secant) => secant,
                _ => middle,
            };
            let tolerance = T::constant(2.0) * T::rounding() * nearest.at.y.abs();
            if value == T::zero() || (newton - nearest.at.y).abs() <= tolerance || !inside(w) || width <= tolerance {
                return Outcome::Root(nearest);
            }
            let within = *iterations < self.budget;
            let next = if within { self.advance_part(&nearest, w, iterations) } else { None };
            let Some(next) = next else { return Outcome::Failed(nearest) };
            let next_value = measure(&next).0;
            if (next_value > T::zero()) == (low_value > T::zero()) {
                (low, low_value) = (next, next_value);
            } else {
                (high, high_value) = (next, next_value);
            }
            width = (high.at.y - low.at.y).abs();
        }
        Outcome::Root(if low_value.abs() <= high_value.abs() { low } else { high })
    }
}

/// Newton's own step where it goes the way of the search and is not too long, else the longest step allowed.
fn stride<T: Scalar>(here: &Point<T>, wanted: T, outwards: bool, longest: T) -> T {
    let growth = if outwards { longest } else { -longest };
    let reach = (T::one() + here.at.y) * (growth.exp() - T::one());
    let newton = wanted.is_finite() && (wanted > T::zero()) == outwards && wanted.abs() < reach.abs();
    if newton { wanted } else { reach }
}

/// Effect of one rounding of each coordinate and of each term on the gradient, with a margin.
pub(crate) fn gradient_noise<T: Scalar>(d: &Derivatives<T>, at: Vector3<T>) -> Vector3<T> {
    let reach = magnitudes(&at);
    let row = |axis: usize| dot(&magnitudes(&d.hessian.column(axis).into_owned()), &reach);
    (Vector3::new(row(0), row(1), row(2)) + d.magnitude) * (T::constant(8.0) * T::rounding())
}

/// Whether a change of the volume that rounding hides is small enough for an answer.
fn is_tolerable<T: Scalar>(change: T, here: &Point<T>) -> bool {
    change.abs() <= T::constant(COARSEST) * here.at.y.abs()
}

/// Whether the arithmetic has no more digits than the answers. The effect of rounding on more digits is estimated far too high.
pub(crate) fn is_plain<T: Scalar>() -> bool {
    T::rounding() >= T::epsilon()
}

/// The number where it is positive; this refuses a NaN, too.
pub(crate) fn positive<T: Scalar>(x: T) -> Option<T> {
    (x > T::zero()).then_some(x)
}

fn out_of_bounds<T: Scalar>(point: &Point<T>, within: T) -> bool {
    let volume = T::one() + point.at.y;
    volume > T::constant(LARGEST_VOLUME) || volume < T::constant(SMALLEST_VOLUME) || point.pressure.abs() > within
}
