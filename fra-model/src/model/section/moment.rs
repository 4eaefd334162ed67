//! The restoring moment of the wall and its slope, point by point of the section.
//!
//! Points and their mirror images across the axis of the bend, where the cosine has the other sign, are computed side by side.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::arithmetic::Arithmetic;

/// Most rounds of the iteration for the deformed radius.
const RADIUS_ROUNDS: u32 = 60;

/// A correction of the radius as a share of it whose fifth power is below rounding: of the order of the fifth root.
const LAST_DOUBLE: f64 = 3e-4;
const LAST_SINGLE: f64 = 2e-2;

/// The same quantity at several points: some and their mirror images.
pub(super) trait Points<S>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<S, Output = Self>
    + Mul<S, Output = Self>
{
    /// The same at all points.
    fn of(value: S) -> Self;

    /// Cosines and sines at angles, and at their mirror images.
    fn around(angles: &[(S, S)]) -> (Self, Self);

    /// `self + a b`.
    fn plus_product(self, a: Self, b: Self) -> Self;

    /// `self - a b`.
    fn minus_product(self, a: Self, b: Self) -> Self;

    /// Whether the magnitudes are at most those of a limit.
    fn is_within(self, limit: Self) -> bool;

    fn greatest(self, other: Self) -> Self;

    fn sum(self) -> S;
}

/// At an angle and its mirror image.
#[derive(Clone, Copy)]
pub(super) struct Pair<S>([S; 2]);

/// At two angles and their mirror images.
#[derive(Clone, Copy)]
pub(super) struct Four<S>([S; 4]);

/// At four angles and their mirror images, which hide each other's latency.
#[derive(Clone, Copy)]
pub(super) struct Eight<S>([S; 8]);

// Closures and loops would not be compiled for the vector registers of the caller.
macro_rules! points {
    ($name:ident, $($i:literal $angle:literal $sign:tt),*) => {
        points!(@operators $name, Add add, Sub sub, Mul mul, Div div; $($i),*);

        impl<S: Arithmetic> Neg for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self([$(-self.0[$i]),*])
            }
        }

        impl<S: Arithmetic> Points<S> for $name<S> {
            #[inline(always)]
            fn of(value: S) -> Self {
                Self([value; [$($i),*].len()])
            }

            #[inline(always)]
            fn around(angles: &[(S, S)]) -> (Self, Self) {
                (Self([$(points!(@signed $sign angles[$angle].0)),*]), Self([$(angles[$angle].1),*]))
            }

            #[inline(always)]
            fn plus_product(self, a: Self, b: Self) -> Self {
                Self([$(self.0[$i].plus_product(a.0[$i], b.0[$i])),*])
            }

            #[inline(always)]
            fn minus_product(self, a: Self, b: Self) -> Self {
                Self([$(self.0[$i].minus_product(a.0[$i], b.0[$i])),*])
            }

            #[inline(always)]
            fn is_within(self, limit: Self) -> bool {
                true $(& self.0[$i].magnitude().is_at_most(limit.0[$i]))*
            }

            #[inline(always)]
            fn greatest(self, other: Self) -> Self {
                Self([$(self.0[$i].greatest(other.0[$i])),*])
            }

            #[inline(always)]
            fn sum(self) -> S {
                let mut sum = self.0[0] + self.0[1];
                $(if $i > 1 {
                    sum = sum + self.0[$i];
                })*
                sum
            }
        }
    };
    (@signed + $value:expr) => { $value };
    (@signed - $value:expr) => { -$value };
    (@operators $name:ident, $($operator:ident $method:ident),*; $($i:literal),*) => {
        points!(@each $name [$($i),*] $($operator $method)*);
    };
    (@each $name:ident $i:tt) => {};
    (@each $name:ident [$($i:literal),*] $operator:ident $method:ident $($others:ident)*) => {
        impl<S: Arithmetic> $operator for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([$(self.0[$i].$method(other.0[$i])),*])
            }
        }
        impl<S: Arithmetic> $operator<S> for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: S) -> Self {
                Self([$(self.0[$i].$method(other)),*])
            }
        }
        points!(@each $name [$($i),*] $($others)*);
    };
}

points!(Pair, 0 0 +, 1 0 -);
points!(Four, 0 0 +, 1 0 -, 2 1 +, 3 1 -);
points!(Eight, 0 0 +, 1 0 -, 2 1 +, 3 1 -, 4 2 +, 5 2 -, 6 3 +, 7 3 -);

/// Quantities common to all points of a bent section.
#[derive(Clone, Copy)]
pub(super) struct Bend<T> {
    k: T,
    /// `1/(1+k)`.
    per_stretch: T,
    /// `rho_f^2` and `rho_f^3`.
    f2: T,
    f3: T,
    /// `psi'(J)/mu1 = 1/2 + a J + b J^2`.
    a: T,
    b: T,
    neo_hookean: bool,
}

/// Quantities common to all angles of one radius.
#[derive(Clone, Copy)]
pub(super) struct Ring<T> {
    /// `rho^2` and its inverse.
    square: T,
    inverse: T,
    /// The radius of a tube that only lengthens, and the powers of `x` of the radius squared as a share of its square.
    straight: T,
    powers: [T; 3],
}

impl<T: Arithmetic> Bend<T> {
    #[inline(always)]
    pub(super) fn new(k: T, winding: T, a: T, b: T) -> Self {
        let (f2, one, zero) = (winding * winding, k.of(1.0), k.of(0.0));
        let neo_hookean = a.magnitude().is_at_most(zero) && b.magnitude().is_at_most(zero);
        Self { k, per_stretch: one / (one + k), f2, f3: f2 * winding, a, b, neo_hookean }
    }

    #[inline(always)]
    pub(super) fn ring(&self, square: T) -> Ring<T> {
        // r^2 = y^2 + u x (1 + y x + (y^2 + u/(4 y)) x^2 + ...), u = -2/3 (f^3 - y^3), x = cos(phi_c) k/(1+k).
        let y2 = self.f2 - (self.f2 - square) * self.per_stretch;
        let y = y2.root();
        let u = (y2 * y - self.f3) * y.of(2.0 / 3.0);
        let (first, x) = (u / y2, self.k * self.per_stretch);
        let third = y2 + u / (y * y.of(4.0));
        Ring {
            square,
            inverse: y.of(1.0) / square,
            straight: y,
            powers: [first * x, first * x * x * y, first * x * x * x * third],
        }
    }

    /// `G = (rho_f^2 - r^2)/2 - cos (rho_f^3 - r^3)/3`, so that `r^2 = rho^2 + 2 k G(r)`.
    #[inline(always)]
    fn inward_shift<P: Points<T>>(&self, r: P, r2: P, cos_third: P) -> P {
        let within = (P::of(self.f2) - r2) * self.k.of(0.5);
        within.minus_product(cos_third, P::of(self.f3).minus_product(r2, r))
    }

    /// Imbalance of the isochoric map, `rho^2 + 2 k G(r) - r^2`.
    #[inline(always)]
    fn off<P: Points<T>>(&self, ring: &Ring<T>, r: P, cos_third: P) -> P {
        let r2 = r * r;
        P::of(ring.square).plus_product(self.inward_shift(r, r2, cos_third), P::of(self.k + self.k)) - r2
    }

    /// Radii of the deformed points of a ring at the angles of cosines `cos`: the root of the isochoric map.
    ///
    /// Its slope in `r^2` is `1 + k h`, at least one. The iteration is Chebyshev's, with two more corrections by the same slope, which
    /// leaves the fifth power of an error; away from the root it is Newton's.
    #[inline(always)]
    fn deformed_radius<P: Points<T>>(&self, ring: &Ring<T>, cos: P) -> P {
        let k = self.k;
        let (one, half) = (k.of(1.0), k.of(0.5));
        let cos_third = cos * k.of(1.0 / 3.0);
        let [first, second, third] = ring.powers;
        let share = P::of(second).plus_product(cos, P::of(third));
        let share = P::of(first).plus_product(share, cos) * cos;
        let near = share.is_within(P::of(half));
        let (bow, whole) = (share * half, P::of(one));
        let guess = whole.plus_product(bow, whole.minus_product(bow * half, whole - bow)) * ring.straight;
        let mut r = if near { guess } else { P::of(ring.straight) };
        let last = k.of(if k.is_single() { LAST_SINGLE } else { LAST_DOUBLE });
        // A derivative settles one step after what it is the derivative of.
        let mut left = T::DERIVATIVES;
        for _ in 0..RADIUS_ROUNDS {
            let bent = cos * r * k;
            let stretch = P::of(one + k) - bent;
            let inverse = P::of(half) / (r * stretch);
            let step = self.off(ring, r, cos_third) * inverse;
            let small = step.is_within(r * k.of(0.1));
            if !small {
                // The root is positive; a step beyond zero is cut short.
                let (least, next) = (r * half, r + step);
                r = next.greatest(least);
                continue;
            }
            let is_last = step.is_within(r * last);
            r = (r + step).minus_product((stretch - bent) * inverse * step, step);
            r = r.plus_product(self.off(ring, r, cos_third), inverse);
            r = r.plus_product(self.off(ring, r, cos_third), inverse);
            if is_last {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
        }
        r
    }

    /// [`density`](Self::density) at the first of some angles and their mirror images, summed.
    #[inline(always)]
    pub(super) fn summed<P: Points<T>>(&self, ring: &Ring<T>, angles: &[(T, T)]) -> (T, T) {
        let (density, curve): (P, P) = self.density(ring, P::around(angles));
        (density.sum(), curve.sum())
    }

    /// `psi'(J)/mu1 dJ/dk` and its slope in `k`, at points of a ring.
    ///
    /// `g = r_k/r`, `l = lambda_k/lambda`, `k m` the lean of the section, `k eta = p - 1`, `k eps = q - 1`. With `k` taken out of all of
    /// them nothing cancels in a slight bend: both results are sums of what is positive there.
    #[inline(always)]
    fn density<P: Points<T>>(&self, ring: &Ring<T>, (cos, sin): (P, P)) -> (P, P) {
        let k = self.k;
        let (one, two, third) = (k.of(1.0), k.of(2.0), k.of(1.0 / 3.0));
        let (whole, by_k, by_two, by_square) = (P::of(one), P::of(k), P::of(two), P::of(ring.inverse));
        let r = self.deformed_radius(ring, cos);
        let r2 = r * r;
        let h = whole.minus_product(cos, r);
        let stretch = whole.plus_product(h, by_k);
        let both = whole / (stretch * r);
        let (per_stretch, per_r) = (both * r, both * stretch);
        let per_r2 = per_r * per_r;
        let reach = P::of(self.f3).minus_product(r2, r);
        let shift = ((P::of(self.f2) - r2) * k.of(0.5)).minus_product(cos * third, reach);

        let g = shift * per_r2 * per_stretch;
        let (eta, eps) = (shift * (two * ring.inverse), h * (stretch + one));
        let (p, q) = (whole.plus_product(eta, by_k), stretch * stretch);
        let per_pq = per_stretch * per_stretch * per_r2 * ring.square;
        let kc = cos * k;
        let l = h.minus_product(kc * r, g) * per_stretch;
        let lean = per_stretch * sin;
        let m = lean * reach * per_r * third;
        let sum = g + l;
        let m_k = (-(lean * r2 * g)).minus_product(m, sum);
        let lean_k = m.plus_product(m_k, by_k);
        // (p - 1/pq)/k and (q - 1/pq)/k.
        let by_radius = eps.plus_product(eta * (p + one), q) * per_pq;
        let by_stretch = eta.plus_product(eps * (q + one), p) * per_pq;
        let half_slope = (g * by_radius).plus_product(l, by_stretch).plus_product(m * lean_k, by_square) * k;

        let g_k = -(g * (g.plus_product(h, per_stretch) + sum));
        let bow = g_k.plus_product(g, g);
        let turn = (g * two).plus_product(bow, by_k);
        let l_k = (-(cos * per_stretch * r * turn)).minus_product(l, l);
        let swing = g_k.plus_product(g * g, by_two).minus_product(g, l);
        let m_kk = (-(lean * r2 * swing)).minus_product(m_k, sum).minus_product(m, g_k + l_k);
        let lean_kk = (m_k * two).plus_product(m_kk, by_k);
        let strains = (g * g * p).plus_product(l * l, q).plus_product(sum * sum, per_pq);
        let half_curve = ((g_k * by_radius).plus_product(l_k, by_stretch) * k)
            .plus_product(strains, by_two)
            .plus_product((lean_k * lean_k).plus_product(m * lean_kk, by_k), by_square);
        if self.neo_hookean {
            return (half_slope, half_curve);
        }
        let (eta, eps) = (eta * k, eps * k);
        let crossed = eta * eps;
        let strain = eta * eta + crossed + eps * eps + crossed * (eta + eps);
        let invariant = strain * per_pq + m * m * (k * k) * ring.inverse;
        let stiffness = (invariant * self.b + self.a) * invariant * two + one;
        let stiffening = invariant * (two * self.b) + self.a;
        (stiffness * half_slope, stiffness * half_curve + stiffening * half_slope * half_slope * k.of(4.0))
    }

    /// `rho^2` at which the map folds, at `r = 1 + 1/k` on the side of the inextensible line.
    #[inline(always)]
    pub(super) fn fold(&self) -> T {
        let one = self.k.of(1.0);
        let r = one + one / self.k;
        let r2 = r * r;
        let shift = self.inward_shift(Pair::of(r), Pair::of(r2), Pair::of(r.of(1.0 / 3.0)));
        r2 - (self.k + self.k) * shift.0[0]
    }
}
