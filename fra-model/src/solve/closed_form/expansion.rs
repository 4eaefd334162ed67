//! The branch at rest as a power series in the pressure.
//!
//! With every equation multiplied by the power of `lambda` that clears its denominators, the terms of order `n` are products of lower
//! ones, but for the linear part, which is the matrix at rest. So each order is one solution with that matrix.

use super::kernel::{Constants, Linearised, Norm, Rest, Unknowns};
use super::path::{CONTRACTION, CORRECTION, Path, SHARE};
use crate::number::arithmetic::Arithmetic;
use crate::number::real::{Real, epsilon, real};

/// Orders of the series in double precision.
pub(super) const ORDERS: usize = 10;
/// The same in single precision; the orders above are zero and never looked at.
const SINGLE_ORDERS: usize = 4;

/// `x(P) = z (x_1 + x_2 z + ...)` with `z = P unit`, without load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expansion<S> {
    /// Factor from a pressure to the variable of the series.
    pub(super) unit: S,
    /// Contraction factor of a step from rest, over `|z|`: 1, but for a branch without curvature.
    pub(super) contraction: S,
    /// Largest `z` to which certified steps lead.
    pub(super) reach: S,
    /// No step that leads to `z` is shorter than this times `|z|`.
    pub(super) short: S,
    /// The coefficients.
    pub(super) terms: [Unknowns<S>; ORDERS],
    /// Factors of the two coefficients before each one after the last.
    pub(super) tail: [S; 2],
}

/// The contraction factor from rest, in one step, up to which the series is worth a trial.
const REACH: f64 = 0.45;
/// Certified steps after the first.
const STEPS: u32 = 2;

/// Least share that a certified step has of the first one, both over the change of the variable.
pub(super) const LEAST: f64 = 0.0625;

/// Orders that a scalar has a use for.
fn orders<T: Real>() -> usize {
    if epsilon::<T>() > real::<T>(1e-9) { SINGLE_ORDERS } else { ORDERS }
}

impl<T: Real> Expansion<T> {
    /// At rest, linearised, with the first step certified.
    pub(super) fn new<const TWIST: bool>(c: &Constants<T>, norm: &Norm<T>, at_rest: &Linearised<T, TWIST>) -> Self {
        let (zero, one) = (T::zero(), T::one());
        let rate = at_rest.rate(c);
        let curve = at_rest.solve(c, at_rest.curvature(c, rate));
        let (over, under) = norm.contraction::<TWIST>(&rate, &curve);
        let contraction = over / under;
        // In this unit the coefficients neither vanish nor overflow.
        let is_curved = contraction > epsilon::<T>();
        let (unit, contraction) = if is_curved { (contraction, one) } else { (one, contraction) };
        let none = Unknowns { e: zero, w: zero, g: zero, tension: zero };
        let first = rate.times(one / unit);
        let mut products = Products::new(c, first, one / unit);
        products.next::<TWIST, 2>(c, at_rest);
        products.next::<TWIST, 3>(c, at_rest);
        products.next::<TWIST, 4>(c, at_rest);
        if orders::<T>() > SINGLE_ORDERS {
            products.next::<TWIST, 5>(c, at_rest);
            products.next::<TWIST, 6>(c, at_rest);
            products.next::<TWIST, 7>(c, at_rest);
            products.next::<TWIST, 8>(c, at_rest);
            products.next::<TWIST, 9>(c, at_rest);
            products.next::<TWIST, 10>(c, at_rest);
        }
        let mut terms = [none; ORDERS];
        for (n, term) in terms.iter_mut().enumerate().take(orders::<T>()) {
            *term = products.term(n + 1);
        }
        let tail = if orders::<T>() > SINGLE_ORDERS { tail::<T, TWIST>(norm, &terms) } else { [zero; 2] };
        let (reach, short) = (real::<T>(CONTRACTION) / contraction, norm.size::<TWIST>(&first));
        Self { unit, contraction, reach, short, terms, tail }
    }

    /// `reach` and `short` with steps towards pressure after the first, as long as the series stays with them.
    ///
    /// Each begins before the one before it ends, so that none is short, and may be as long as the contraction factor at its beginning
    /// says.
    #[inline(always)]
    pub(super) fn certified<const TWIST: bool>(&self, path: &Path<'_, T, TWIST>) -> (T, T) {
        let (mut reach, mut short) = (self.reach, self.short);
        let is_curved = self.contraction > epsilon::<T>();
        if !is_curved {
            return (reach, short);
        }
        let (mut from, mut step) = (T::zero(), reach);
        for _ in 0..STEPS {
            let next = from + step * real(SHARE);
            let Some((longest, size)) = self.step::<TWIST>(path, next, short * (next - from)) else { break };
            // What is beyond the end of the step before it takes this one.
            let beyond = short.min(size * (T::one() - next / reach));
            if beyond < self.short * real(LEAST) {
                break;
            }
            short = beyond;
            reach = (next + longest).min(real(REACH));
            (from, step) = (next, longest);
            if reach >= real(REACH) {
                break;
            }
        }
        (reach, short)
    }

    /// Largest step from a value of the variable, and its size over its length; `None` where the sum of the series is not near
    /// an equilibrium there, or not near where the step leads.
    #[inline(always)]
    fn step<const TWIST: bool>(&self, path: &Path<'_, T, TWIST>, z: T, last: T) -> Option<(T, T)> {
        let c = path.constants;
        let at = self.at::<TWIST>(z);
        let lin = path.look(at)?;
        let off = lin.solve(c, path.rest(&lin, z / self.unit));
        (path.size(&off) <= last * real(CORRECTION)).then_some(())?;
        let rate = lin.rate(c).times(T::one() / self.unit);
        let curve = lin.solve(c, lin.curvature(c, rate));
        let longest = (real::<T>(CONTRACTION) / path.contraction(&rate, &curve)).min(real::<T>(REACH) - z);
        let size = path.size(&rate);
        for share in [0.5, 1.0] {
            let length = longest * real(share);
            let end = at.plus(off).plus(rate.plus_times(&curve, length).times(length));
            let aside = self.extrapolated::<TWIST>(z + length).plus_times(&end, -T::one());
            (path.size(&aside) <= size * length * real(CORRECTION)).then_some(())?;
        }
        Some((longest, size))
    }

    /// The state at a value of the variable, with what is beyond the last order where there are enough of them to tell.
    #[inline(always)]
    pub(super) fn extrapolated<const TWIST: bool>(&self, z: T) -> Unknowns<T> {
        let at = self.at::<TWIST>(z);
        if orders::<T>() > SINGLE_ORDERS { at.plus(self.beyond::<TWIST>(z)) } else { at }
    }

    /// The state at a value of the variable.
    #[inline(always)]
    pub(super) fn at<const TWIST: bool>(&self, z: T) -> Unknowns<T> {
        if orders::<T>() > SINGLE_ORDERS { self.sum::<TWIST>(z) } else { lower::<T, TWIST>(&self.terms, z).times(z) }
    }

    /// The change of the state with the variable, to third order.
    #[inline(always)]
    pub(super) fn slope<const TWIST: bool>(&self, z: T) -> Unknowns<T> {
        let [a, b, c, d, ..] = &self.terms;
        let (two, three, four) = (real::<T>(2.0), real::<T>(3.0), real::<T>(4.0));
        lower::<T, TWIST>(&[*a, b.times(two), c.times(three), d.times(four)], z)
    }
}

impl<S: Arithmetic> Expansion<S> {
    /// The whole series.
    #[inline(always)]
    pub(super) fn sum<const TWIST: bool>(&self, z: S) -> Unknowns<S> {
        let terms = &self.terms;
        let z4 = (z * z) * (z * z);
        let mut last = terms[8].plus_times(&terms[9], z);
        if !TWIST {
            last.g = z.of(0.0);
        }
        let high = lower::<S, TWIST>(&terms[4..8], z).plus_times(&last, z4);
        lower::<S, TWIST>(&terms[..4], z).plus_times(&high, z4).times(z)
    }

    /// Approximate sum of the terms after the last order: with `x_(n+2) = a x_(n+1) + b x_n`, shares of the last two.
    #[inline(always)]
    pub(super) fn beyond<const TWIST: bool>(&self, z: S) -> Unknowns<S> {
        let (one, [a, b], z2) = (z.of(1.0), self.tail, z * z);
        let z4 = z2 * z2;
        let (bz2, z9) = (b * z2, z * (z4 * z4));
        let next = bz2 + a * z;
        let sum = self.terms[8].times(bz2).plus_times(&self.terms[9], next * z).times(z9 / (one - next));
        if TWIST { sum } else { Unknowns { g: z.of(0.0), ..sum } }
    }
}

/// `(a, b)` that come closest to `x_(n+2) = a x_(n+1) + b x_n` at the end of the series: the two singularities nearest to rest, which
/// all unknowns have in common, make it so.
fn tail<T: Real, const TWIST: bool>(norm: &Norm<T>, terms: &[Unknowns<T>; ORDERS]) -> [T; 2] {
    let zero = T::zero();
    let (mut aa, mut ab, mut bb, mut ra, mut rb) = (zero, zero, zero, zero, zero);
    for n in [ORDERS - 1, ORDERS - 2] {
        let mut take = |x: T, a: T, b: T| {
            (aa, ab, bb) = (aa + a * a, ab + a * b, bb + b * b);
            (ra, rb) = (ra + x * a, rb + x * b);
        };
        let (x, a, b) = (&terms[n], &terms[n - 1], &terms[n - 2]);
        take(x.e, a.e, b.e);
        take(x.w, a.w, b.w);
        take(x.tension * norm.tension, a.tension * norm.tension, b.tension * norm.tension);
        if TWIST {
            take(x.g * norm.twist, a.g * norm.twist, b.g * norm.twist);
        }
    }
    let some = (aa + bb) * real(1e-9);
    let (aa, bb) = (aa + some, bb + some);
    let determinant = aa * bb - ab * ab;
    if determinant > zero { [(ra * bb - rb * ab) / determinant, (rb * aa - ra * ab) / determinant] } else { [zero; 2] }
}

/// `x_1 + x_2 z + x_3 z^2 + x_4 z^3`.
#[inline(always)]
fn lower<S: Arithmetic, const TWIST: bool>(terms: &[Unknowns<S>], z: S) -> Unknowns<S> {
    let (low, high) = (terms[0].plus_times(&terms[1], z), terms[2].plus_times(&terms[3], z));
    let sum = low.plus_times(&high, z * z);
    if TWIST { sum } else { Unknowns { g: z.of(0.0), ..sum } }
}

/// One more than the orders: entry `n` of a row belongs to `z^n`.
const ROW: usize = ORDERS + 1;

/// A series.
type Row<T> = [T; ROW];

/// The unknowns and the products of them in the equations, as far as they are known.
struct Products<T> {
    per_unit: T,
    per_x_outer: T,
    e: Row<T>,
    w: Row<T>,
    g: Row<T>,
    tension: Row<T>,
    /// `z dw/dz`.
    w_slope: Row<T>,
    /// `e^2`, `w^2`, `g^2`.
    e2: Row<T>,
    w2: Row<T>,
    g2: Row<T>,
    /// `Lam` and its derivative by `w`.
    log: Row<T>,
    log_w: Row<T>,
    /// `lambda^2 h_e`, `hoop^2` and `hoop (1 + w_f)`.
    along: Row<T>,
    hoop2: Row<T>,
    turn: Row<T>,
}

/// The sum of `a_k b_(n-k)` over `0 < k <= last`. The latest factors come last, so that the sum waits for nothing else.
#[inline(always)]
fn product<T: Real>(a: &Row<T>, b: &Row<T>, n: usize, last: usize) -> T {
    let mut sum = T::zero();
    for k in 2..last {
        sum += a[k] * b[n - k];
    }
    let end = if last > 1 { a[last] * b[n - last] } else { T::zero() };
    (sum + a[1] * b[n - 1]) + end
}

/// The same of a series with itself, up to `k = n - 1`.
#[inline(always)]
fn square<T: Real>(a: &Row<T>, n: usize) -> T {
    let mut sum = T::zero();
    for k in (1..n.div_ceil(2)).rev() {
        sum += a[k] * a[n - k];
    }
    let twice = sum + sum;
    if n.is_multiple_of(2) { twice + a[n / 2] * a[n / 2] } else { twice }
}

impl<T: Real> Products<T> {
    #[inline(always)]
    fn new(c: &Constants<T>, first: Unknowns<T>, per_unit: T) -> Self {
        let row = [T::zero(); ROW];
        let mut new = Self {
            per_unit,
            per_x_outer: T::one() / c.x_outer,
            e: row,
            w: row,
            g: row,
            tension: row,
            w_slope: row,
            e2: row,
            w2: row,
            g2: row,
            log: row,
            log_w: row,
            along: row,
            hoop2: row,
            turn: row,
        };
        new.log_w[0] = c.d * new.per_x_outer;
        (new.along[0], new.hoop2[0], new.turn[0]) = (c.neutral, c.cos * c.cos, c.cos);
        new.keep::<1>(c, first, Lower { cube: T::zero(), log: T::zero(), twist: T::zero(), sheet: T::zero() });
        new
    }

    fn term(&self, n: usize) -> Unknowns<T> {
        Unknowns { e: self.e[n], w: self.w[n], g: self.g[n], tension: self.tension[n] }
    }

    /// The terms of order `N`, once the lower ones are known.
    #[inline(always)]
    fn next<const TWIST: bool, const N: usize>(&mut self, c: &Constants<T>, at_rest: &Linearised<T, TWIST>) {
        let (half, two, three) = (real::<T>(0.5), real::<T>(2.0), real::<T>(3.0));
        let before = N - 1;
        self.e2[N] = square(&self.e, N);
        self.w2[N] = square(&self.w, N);
        let e3 = if N > 2 { product(&self.e, &self.e2, N, N - 2) } else { T::zero() };
        let cube = three * self.e2[N] + e3;
        let w_log = product(&self.w, &self.log, N, before);
        let w_log_w = product(&self.w, &self.log_w, N, before);
        let log = product(&self.w_slope, &self.log_w, N, before) * real::<T>(1.0 / N as f64);
        let mut lower = Lower { cube, log, twist: T::zero(), sheet: T::zero() };
        let mut e = c.d * cube - half * w_log + product(&self.tension, &self.along, N, before);
        let mut w = half * (log + w_log_w) - self.e[before] * self.per_unit;
        let mut g = T::zero();
        if TWIST {
            self.g2[N] = square(&self.g, N);
            lower.twist = product(&self.g, &self.w, N, before);
            let turned = c.sin_rho * c.sin_rho * self.g2[N];
            lower.sheet = turned + c.per_x_fiber * product(&self.w, &self.hoop2, N, before);
            let q = half * c.d * (c.x_outer + T::one());
            e -= half * (q * self.g2[N] + c.d * product(&self.w, &self.g2, N, before));
            w += half * c.d * self.g2[N] + c.per_x_fiber * product(&self.tension, &self.hoop2, N, before);
            g = c.d * lower.twist + two * c.sin_rho * product(&self.tension, &self.turn, N, before);
        }
        let tension =
            c.scale * (lower.sheet + c.sin2 * cube) - c.compliance * product(&self.e, &self.tension, N, before);
        let x = at_rest.solve(c, Rest { e: -e, w: -w, g: -g, tension: -tension });
        self.keep::<N>(c, x, lower);
    }

    /// Takes in the terms of order `N` and what follows from them.
    #[inline(always)]
    fn keep<const N: usize>(&mut self, c: &Constants<T>, x: Unknowns<T>, lower: Lower<T>) {
        let (one, two, three) = (T::one(), real::<T>(2.0), real::<T>(3.0));
        (self.e[N], self.w[N], self.g[N], self.tension[N]) = (x.e, x.w, x.g, x.tension);
        self.w_slope[N] = real::<T>(N as f64) * x.w;
        self.log[N] = lower.log + x.w * self.log_w[0];
        // Lam' (1 + w)(X_o + w) = D.
        let mut log_w = T::zero();
        for k in 1..=N {
            log_w += ((c.x_outer + one) * self.w[k] + self.w2[k]) * self.log_w[N - k];
        }
        self.log_w[N] = -(log_w * self.per_x_outer);
        let shear = c.sin_rho * x.g;
        self.hoop2[N] = two * c.cos * shear + c.sin_rho * c.sin_rho * self.g2[N];
        let sheet = two * c.cos * shear + c.per_x_fiber * x.w * c.cos * c.cos + lower.sheet;
        self.along[N] = two * c.sin2 * (three * x.e + lower.cube) - sheet;
        self.turn[N] = shear + c.per_x_fiber * (x.w * c.cos + c.sin_rho * lower.twist);
    }
}

/// Of some products, the terms of an order that lower orders make.
struct Lower<T> {
    /// `lambda^3 - 1` and `Lam`.
    cube: T,
    log: T,
    /// `g w` and `hoop^2 (1 + w_f)`.
    twist: T,
    sheet: T,
}
