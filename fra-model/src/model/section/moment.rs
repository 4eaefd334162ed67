//! The restoring moment of the wall and its slope, point by point of the section.
//!
//! A point and its mirror image across the axis of the bend, where the cosine has the other sign, are computed side by side.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::scalar::Scalar;

/// Most rounds of the iteration for the deformed radius.
const RADIUS_ROUNDS: u32 = 60;

/// A correction of the radius as a share of it whose fifth power is below rounding: of the order of the fifth root.
const LAST_DOUBLE: f64 = 3e-4;
const LAST_SINGLE: f64 = 2e-2;

/// The same quantity at a point and at its mirror image.
#[derive(Clone, Copy)]
pub(super) struct Pair<T>([T; 2]);

macro_rules! componentwise {
    ($($operator:ident $method:ident),*) => {
        $(impl<T: Scalar> $operator for Pair<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([self.0[0].$method(other.0[0]), self.0[1].$method(other.0[1])])
            }
        }
        impl<T: Scalar> $operator<T> for Pair<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: T) -> Self {
                Self([self.0[0].$method(other), self.0[1].$method(other)])
            }
        })*
    };
}

componentwise!(Add add, Sub sub, Mul mul, Div div);

impl<T: Scalar> Neg for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self([-self.0[0], -self.0[1]])
    }
}

impl<T: Scalar> Pair<T> {
    #[inline(always)]
    fn of(value: T) -> Self {
        Self([value; 2])
    }

    #[inline(always)]
    fn both(self, what: impl Fn(T) -> bool) -> bool {
        what(self.0[0]) & what(self.0[1])
    }

    #[inline(always)]
    pub(super) fn sum(self) -> T {
        self.0[0] + self.0[1]
    }
}

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

impl<T: Scalar> Bend<T> {
    pub(super) fn new(k: T, winding: T, a: T, b: T) -> Self {
        let f2 = winding * winding;
        let neo_hookean = a == T::zero() && b == T::zero();
        Self { k, per_stretch: T::one() / (T::one() + k), f2, f3: f2 * winding, a, b, neo_hookean }
    }

    #[inline(always)]
    pub(super) fn ring(&self, square: T) -> Ring<T> {
        // r^2 = y^2 + u x (1 + y x + (y^2 + u/(4 y)) x^2 + ...), u = -2/3 (f^3 - y^3), x = cos(phi_c) k/(1+k).
        let y2 = self.f2 - (self.f2 - square) * self.per_stretch;
        let y = y2.sqrt();
        let u = (y2 * y - self.f3) * T::constant(2.0 / 3.0);
        let (first, x) = (u / y2, self.k * self.per_stretch);
        let third = y2 + u / (y * T::constant(4.0));
        Ring {
            square,
            inverse: T::one() / square,
            straight: y,
            powers: [first * x, first * x * x * y, first * x * x * x * third],
        }
    }

    /// `G = (rho_f^2 - r^2)/2 - cos (rho_f^3 - r^3)/3`, so that `r^2 = rho^2 + 2 k G(r)`.
    #[inline(always)]
    fn inward_shift(&self, r: Pair<T>, r2: Pair<T>, cos_third: Pair<T>) -> Pair<T> {
        (Pair::of(self.f2) - r2) * T::constant(0.5) - cos_third * (Pair::of(self.f3) - r2 * r)
    }

    /// Radii of the deformed points of a ring at the angles of cosines `cos`: the root of the isochoric map.
    ///
    /// Its slope in `r^2` is `1 + k h`, at least one. The iteration is Chebyshev's, with two more corrections by the same slope, which
    /// leaves the fifth power of an error; away from the root it is Newton's.
    #[inline(always)]
    fn deformed_radius(&self, ring: &Ring<T>, cos: Pair<T>) -> Pair<T> {
        let (one, half, k) = (T::one(), T::constant(0.5), self.k);
        let cos_third = cos * T::constant(1.0 / 3.0);
        let [first, second, third] = ring.powers;
        let share = ((cos * third + second) * cos + first) * cos;
        let near = share.both(|v| v.abs() < half);
        let bow = share * half;
        let guess = (bow * (Pair::of(one) - bow * half * (Pair::of(one) - bow)) + one) * ring.straight;
        let mut r = if near { guess } else { Pair::of(ring.straight) };
        let last = T::constant(if T::epsilon() > T::constant(1e-9) { LAST_SINGLE } else { LAST_DOUBLE });
        // A derivative settles one step after what it is the derivative of.
        let mut left = T::ORDER;
        for _ in 0..RADIUS_ROUNDS {
            let bent = cos * r * k;
            let stretch = Pair::of(one + k) - bent;
            let inverse = Pair::of(half) / (r * stretch);
            let rest = |r: Pair<T>| {
                let r2 = r * r;
                self.inward_shift(r, r2, cos_third) * (k + k) + ring.square - r2
            };
            let step = rest(r) * inverse;
            let size = step / r;
            let small = size.both(|v| v.abs() < T::constant(0.1));
            if !small {
                // The root is positive; a step beyond zero is cut short.
                let (least, next) = (r * half, r + step);
                r = Pair([next.0[0].max(least.0[0]), next.0[1].max(least.0[1])]);
                continue;
            }
            r = r + step - (stretch - bent) * inverse * step * step;
            r = r + rest(r) * inverse;
            r = r + rest(r) * inverse;
            if size.both(|v| v.abs() <= last) {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
        }
        r
    }

    /// `psi'(J)/mu1 dJ/dk` and its slope in `k`, at points of a ring.
    ///
    /// `g = r_k/r`, `l = lambda_k/lambda`, `k m` the lean of the section, `k eta = p - 1`, `k eps = q - 1`. With `k` taken out of all of
    /// them nothing cancels in a slight bend: both results are sums of what is positive there.
    #[inline(always)]
    pub(super) fn density(&self, ring: &Ring<T>, cos: T, sin: T) -> (Pair<T>, Pair<T>) {
        let cos = Pair([cos, -cos]);
        let (one, two, third, k) = (T::one(), T::constant(2.0), T::constant(1.0 / 3.0), self.k);
        let r = self.deformed_radius(ring, cos);
        let r2 = r * r;
        let h = Pair::of(one) - cos * r;
        let stretch = h * k + one;
        let both = Pair::of(one) / (stretch * r);
        let (per_stretch, per_r) = (both * r, both * stretch);
        let per_r2 = per_r * per_r;
        let reach = Pair::of(self.f3) - r2 * r;
        let shift = (Pair::of(self.f2) - r2) * T::constant(0.5) - cos * third * reach;

        let g = shift * per_r2 * per_stretch;
        let (eta, eps) = (shift * (two * ring.inverse), h * (stretch + one));
        let (p, q) = (eta * k + one, stretch * stretch);
        let per_pq = per_stretch * per_stretch * per_r2 * ring.square;
        let kc = cos * k;
        let l = (h - kc * r * g) * per_stretch;
        let lean = per_stretch * sin;
        let m = lean * reach * per_r * third;
        let m_k = -(lean * r2 * g) - m * (g + l);
        let lean_k = m + m_k * k;
        // (p - 1/pq)/k and (q - 1/pq)/k.
        let by_radius = (eta * (p + one) * q + eps) * per_pq;
        let by_stretch = (eps * (q + one) * p + eta) * per_pq;
        let half_slope = (g * by_radius + l * by_stretch + m * lean_k * ring.inverse) * k;

        let sum = g + l;
        let g_k = -(g * (h * per_stretch + g + sum));
        let bow = g * g + g_k;
        let l_k = -(cos * per_stretch * r * (g * two + bow * k)) - l * l;
        let m_kk = -(lean * r2 * (g * g * two + g_k - g * l)) - m_k * sum - m * (g_k + l_k);
        let lean_kk = m_k * two + m_kk * k;
        let half_curve = (g_k * by_radius + l_k * by_stretch) * k
            + (g * g * p + l * l * q + sum * sum * per_pq) * two
            + (lean_k * lean_k + m * lean_kk * k) * ring.inverse;
        if self.neo_hookean {
            return (half_slope, half_curve);
        }
        let (eta, eps) = (eta * k, eps * k);
        let crossed = eta * eps;
        let strain = eta * eta + crossed + eps * eps + crossed * (eta + eps);
        let invariant = strain * per_pq + m * m * (k * k) * ring.inverse;
        let stiffness = (invariant * self.b + self.a) * invariant * two + one;
        let stiffening = invariant * (two * self.b) + self.a;
        (stiffness * half_slope, stiffness * half_curve + stiffening * half_slope * half_slope * T::constant(4.0))
    }

    /// `rho^2` at which the map folds, at `r = 1 + 1/k` on the side of the inextensible line.
    pub(super) fn fold(&self) -> T {
        let r = T::one() + T::one() / self.k;
        let r2 = r * r;
        let shift = self.inward_shift(Pair::of(r), Pair::of(r2), Pair::of(T::constant(1.0 / 3.0)));
        r2 - (self.k + self.k) * shift.0[0]
    }
}
