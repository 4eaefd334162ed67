//! Invariants at one radius and their derivatives.

use crate::accuracy::number::Number;

/// Derivatives of an invariant by `p = (r/R)^2`, `q = lambda^2` and `g`.
pub(super) struct Partial<N> {
    pub(super) p: N,
    pub(super) q: N,
    pub(super) g: N,
    pub(super) pp: N,
    pub(super) pq: N,
    pub(super) qq: N,
    pub(super) pg: N,
    pub(super) gg: N,
}

/// One radius: `eta = p - 1`, `eps = q - 1`, and how `p` and `q` depend on `(e, w)`.
pub(super) struct Ring<N> {
    pub(super) x: N,
    pub(super) g: N,
    pub(super) eta: N,
    pub(super) eps: N,
    pub(super) p_e: N,
    pub(super) p_w: N,
    pub(super) p_ee: N,
    pub(super) p_ew: N,
    pub(super) q_e: N,
}

impl<N: Number> Ring<N> {
    pub(super) fn new([e, w, g]: [N; 3], x: N) -> Self {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let per_lambda = one / (one + e);
        let eta = (w / x - e) * per_lambda;
        let p = one + eta;
        let p_w = per_lambda / x;
        Self {
            x,
            g,
            eta,
            eps: e * (two + e),
            p_e: -p * per_lambda,
            p_w,
            p_ee: two * p * per_lambda * per_lambda,
            p_ew: -p_w * per_lambda,
            q_e: two * (one + e),
        }
    }

    /// `I1 - 3` in strain form.
    pub(super) fn first_invariant(&self) -> (N, Partial<N>) {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let Self { x, g, eta, eps, .. } = *self;
        let (p, q) = (one + eta, one + eps);
        let (per_p, per_q) = (one / p, one / q);
        let per_pq = per_p * per_q;
        let twist = g * g * x;
        let value = (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) * per_pq + twist * p;
        let partial = Partial {
            p: (eta * (two + eta) * q + eps) * per_p * per_pq + twist,
            q: (eps * (two + eps) * p + eta) * per_q * per_pq,
            g: two * g * x * p,
            pp: two * per_p * per_p * per_pq,
            pq: per_pq * per_pq,
            qq: two * per_q * per_q * per_pq,
            pg: two * g * x,
            gg: two * x * p,
        };
        (value, partial)
    }

    /// `I4 - 1 = c^2 eta + p g rho s (2c + g rho s) + s^2 eps`.
    pub(super) fn fiber(&self, cos: N, sin: N) -> (N, Partial<N>) {
        let two = N::of(2.0);
        let lever = sin * self.x.sqrt();
        let shear = self.g * lever;
        let hoop = cos + shear;
        let p = N::of(1.0) + self.eta;
        let value = cos * cos * self.eta + p * shear * (cos + hoop) + sin * sin * self.eps;
        let zero = N::of(0.0);
        let partial = Partial {
            p: hoop * hoop,
            q: sin * sin,
            g: two * p * hoop * lever,
            pp: zero,
            pq: zero,
            qq: zero,
            pg: two * hoop * lever,
            gg: two * p * lever * lever,
        };
        (value, partial)
    }
}
