//! One Newton step of the equilibrium of a neo-Hookean tube with a sheet of fibers, in closed form.
//!
//! Unknowns: axial strain `e`, relative change of the lumen's volume `w`, twist rate `g` (if `TWIST`), and the tension `T` of the sheet
//! per unit of `d I4`, with `u = u_NH(e, w, g) + T h - T^2/(2 K)`, `h = I4 - 1`, `K` the stiffness of the sheet. The equations
//!
//! ```text
//! u_e + T h_e = n,   u_w + T h_w = P/mu1,   u_g + T h_g = t,   scale h = compliance T
//! ```
//!
//! are as nonlinear for a stiff sheet as for a soft one, and a pressure read from the second never is a small strain times a huge modulus.
//! `(compliance, scale)` is `(1/K, 1)` or `(1, K)`, whichever is not large.
//!
//! Legend: `D = X_o - 1`, `Lam = ln(X_o (1+w)/(X_o+w))`, `M = 2 D + w Lam + g^2 Q`, `Q = D (X_o+1)/2 + w D`, `p = (r_f/R_f)^2`, `hoop = c + s g rho_f`;
//! `il`, `ii`, `io` are the inverses of `lambda`, `1 + w`, `X_o + w`.

use crate::number::arithmetic::Arithmetic;

/// The constants of a tube, all without dimension.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants<S> {
    /// `X_o = (R_o/R_i)^2`.
    pub(crate) x_outer: S,
    /// `X_o - 1`.
    pub(crate) d: S,
    /// `R_i^2/R_f^2`.
    pub(crate) per_x_fiber: S,
    /// Sine of the fiber angle times `R_f/R_i`.
    pub(crate) sin_rho: S,
    /// `2 s^2 - c^2`, which vanishes at the neutral angle.
    pub(crate) neutral: S,
    /// Cosine of the fiber angle and the square of its sine.
    pub(crate) cos: S,
    /// See `cos`.
    pub(crate) sin2: S,
    /// Coefficients of `scale h = compliance T`.
    pub(crate) compliance: S,
    /// See `compliance`.
    pub(crate) scale: S,
}

/// The unknowns, or a change of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unknowns<S> {
    /// Axial strain.
    pub(crate) e: S,
    /// Relative change of the lumen's volume.
    pub(crate) w: S,
    /// Twist rate.
    pub(crate) g: S,
    /// Tension of the sheet.
    pub(crate) tension: S,
}

/// Imbalance of the four equations: right side less left side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest<S> {
    /// Of the axial force.
    pub(crate) e: S,
    /// Of the pressure.
    pub(crate) w: S,
    /// Of the torque.
    pub(crate) g: S,
    /// Of the tension.
    pub(crate) tension: S,
}

impl<S: Arithmetic> Unknowns<S> {
    /// `self + change`.
    #[inline(always)]
    pub(crate) fn plus(self, change: Self) -> Self {
        Self {
            e: self.e + change.e,
            w: self.w + change.w,
            g: self.g + change.g,
            tension: self.tension + change.tension,
        }
    }

    /// `self + other factor`.
    #[inline(always)]
    pub(crate) fn plus_times(self, other: &Self, factor: S) -> Self {
        Self {
            e: self.e.plus_product(other.e, factor),
            w: self.w.plus_product(other.w, factor),
            g: self.g.plus_product(other.g, factor),
            tension: self.tension.plus_product(other.tension, factor),
        }
    }

    /// `self factor`.
    #[inline(always)]
    pub(crate) fn times(self, factor: S) -> Self {
        Self { e: self.e * factor, w: self.w * factor, g: self.g * factor, tension: self.tension * factor }
    }
}

/// Factors that make a twist rate and a tension comparable with a strain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Norm<S> {
    pub(crate) twist: S,
    pub(crate) tension: S,
}

impl<S: Arithmetic> Norm<S> {
    #[inline(always)]
    fn parts<const TWIST: bool>(&self, x: &Unknowns<S>) -> (S, S) {
        let strain = x.e.magnitude() + x.w.magnitude();
        let strain = if TWIST { strain + x.g.magnitude() * self.twist } else { strain };
        (strain, x.tension.magnitude() * self.tension)
    }

    /// The size of a state or a step.
    #[inline(always)]
    pub(crate) fn size<const TWIST: bool>(&self, x: &Unknowns<S>) -> S {
        let (strain, tension) = self.parts::<TWIST>(x);
        strain + tension
    }

    /// The same, where a tension that dominates does not hide what the strains do.
    #[inline(always)]
    pub(crate) fn strain<const TWIST: bool>(&self, x: &Unknowns<S>) -> S {
        let (strain, tension) = self.parts::<TWIST>(x);
        strain + tension.least(strain)
    }

    /// Numerator and denominator of the contraction factor of a step.
    #[inline(always)]
    pub(crate) fn contraction<const TWIST: bool>(&self, first: &Unknowns<S>, second: &Unknowns<S>) -> (S, S) {
        (self.size::<TWIST>(second), self.strain::<TWIST>(first))
    }
}

/// The adjugate of the matrix of `e`, `w` and the tension, whose last row is `scale` times the last column.
#[derive(Clone, Copy, Debug)]
struct Adjugate<S> {
    ee: S,
    ew: S,
    ww: S,
    eh: S,
    wh: S,
    hh: S,
}

/// The left sides of the equations at a state, and their derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linearised<S, const TWIST: bool> {
    /// `u_x + T h_x`.
    pub(crate) left: Unknowns<S>,
    at: Unknowns<S>,
    il: S,
    /// Square of the argument of the logarithm's series.
    pub(crate) s2: S,
    // Elastomer.
    m: S,
    m_w: S,
    m_ww: S,
    log_w: S,
    ii: S,
    io: S,
    spread: S,
    // Sheet.
    p: S,
    p_w: S,
    hoop: S,
    hoop2: S,
    h: Unknowns<S>,
    // `u_xx + T h_xx` without and with the twist eliminated.
    a_ee: S,
    a_ew: S,
    a_ww: S,
    a_eg: S,
    a_wg: S,
    inverse_gg: S,
    h_e: S,
    h_w: S,
    compliance: S,
    /// The adjugate matrix, and the inverse of the determinant.
    adjugate: Adjugate<S>,
    inverse: S,
    /// Positive where the state is stable under pressure and dead load.
    pub(crate) stability: S,
}

impl<S: Arithmetic, const TWIST: bool> Linearised<S, TWIST> {
    /// At a state; needs `e > -1`, `w > -1`.
    #[inline(always)]
    pub(crate) fn new(c: &Constants<S>, at: Unknowns<S>) -> Self {
        let Unknowns { e, w, g, tension } = at;
        let k = |value: f64| e.of(value);
        let (half, one, two, three) = (k(0.5), k(1.0), k(2.0), k(3.0));
        let wd = w * c.d;
        let (inner, outer) = (one + w, c.x_outer + w);
        let (s, [il, ii, io]) = wd.over_and_inverses(two * outer + wd, [one + e, inner, outer]);
        let il2 = il * il;

        // The elastomer.
        let s2 = s * s;
        let log = two * s * s.atanh_over(s2);
        let log_w = c.d * ii * io;
        let w_log = w * log;
        let s_w = log + w * log_w;
        let spread = ii + c.x_outer * io;
        let m_ww = log_w * spread;
        let (mut m_rest, mut m_w) = (w_log, s_w);
        let q = c.d * (half * (c.x_outer + one) + w);
        if TWIST {
            let g2 = g * g;
            m_rest = m_rest + g2 * q;
            m_w = m_w + g2 * c.d;
        }
        let m = c.d + c.d + m_rest;
        let u_e = il2 * (c.d * e * (three + e * (three + e)) - half * m_rest);
        let u_w = half * il * m_w;

        // The sheet, in forms that keep their digits where the strains are small and where the angle is neutral.
        let cos2 = c.cos * c.cos;
        let w_f = w * c.per_x_fiber;
        let eta = (w_f - e) * il;
        let p = one + eta;
        let (p_e, p_w) = (-(p * il), il * c.per_x_fiber);
        let mut hoop = c.cos;
        let mut hoop2 = cos2;
        let mut h = cos2 * w_f * il + e * (c.neutral + e * (cos2 * il + c.sin2));
        let mut h_e = c.neutral + two * c.sin2 * e + cos2 * (e - eta) * il;
        if TWIST {
            let shear = c.sin_rho * g;
            hoop = hoop + shear;
            let turned = shear * (c.cos + hoop);
            hoop2 = hoop2 + turned;
            h = h + p * turned;
            h_e = h_e + turned * p_e;
        }
        let h_w = hoop2 * p_w;

        // Second derivatives.
        let zero = k(0.0);
        let left = Unknowns { e: u_e + tension * h_e, w: u_w + tension * h_w, g: zero, tension: h };
        let a_ee = il2 * il * m + c.d + tension * (two * (c.sin2 - hoop2 * p_e * il));
        // All of the pressure is inverse to lambda.
        let a_ew = -(left.w * il);
        let a_ww = half * il * m_ww;
        let mut sum = Self {
            left,
            at,
            il,
            s2,
            m,
            m_w,
            m_ww,
            log_w,
            ii,
            io,
            spread,
            p,
            p_w,
            hoop,
            hoop2,
            h: Unknowns { e: h_e, w: h_w, g: zero, tension: zero },
            a_ee,
            a_ew,
            a_ww,
            a_eg: zero,
            a_wg: zero,
            inverse_gg: zero,
            h_e,
            h_w,
            compliance: c.compliance,
            adjugate: Adjugate { ee: zero, ew: zero, ww: zero, eh: zero, wh: zero, hh: zero },
            inverse: zero,
            stability: zero,
        };
        let mut stability_gg = one;
        if TWIST {
            let hoop_g = two * hoop * c.sin_rho;
            let h_g = p * hoop_g;
            let a_gg = il * q + tension * two * p * c.sin_rho * c.sin_rho;
            let i = one / a_gg;
            stability_gg = a_gg;
            sum.left.g = g * q * il + tension * h_g;
            sum.h.g = h_g;
            sum.a_eg = tension * hoop_g * p_e - il2 * g * q;
            sum.a_wg = tension * hoop_g * p_w + il * g * c.d;
            let (ie, iw, ih) = (sum.a_eg * i, sum.a_wg * i, h_g * i);
            sum.inverse_gg = i;
            sum.a_ee = a_ee - sum.a_eg * ie;
            sum.a_ew = a_ew - sum.a_eg * iw;
            sum.a_ww = a_ww - sum.a_wg * iw;
            sum.h_e = h_e - sum.a_eg * ih;
            sum.h_w = h_w - sum.a_wg * ih;
            sum.compliance = c.compliance + c.scale * h_g * ih;
        }
        sum.factor(c.scale, stability_gg)
    }

    #[inline(always)]
    fn factor(mut self, scale: S, stability_gg: S) -> Self {
        let one = scale.of(1.0);
        let Self { a_ee, a_ew, a_ww, h_e, h_w, compliance, .. } = self;
        let (eh, wh) = (a_ww * h_e - a_ew * h_w, a_ee * h_w - a_ew * h_e);
        let determinant = a_ee * a_ww - a_ew * a_ew;
        let (sh_e, sh_w) = (scale * h_e, scale * h_w);
        let bordered = compliance * determinant + (sh_e * eh + sh_w * wh);
        self.adjugate = Adjugate {
            ee: compliance * a_ww + sh_w * h_w,
            ew: -(compliance * a_ew + sh_e * h_w),
            ww: compliance * a_ee + sh_e * h_e,
            eh,
            wh,
            hh: -determinant,
        };
        self.inverse = one / bordered;
        self.stability = stability_gg.least(bordered).least(self.adjugate.ww);
        self
    }

    /// The change of the unknowns that removes a rest, to first order.
    #[inline(always)]
    pub(crate) fn solve(&self, c: &Constants<S>, rest: Rest<S>) -> Unknowns<S> {
        self.solve_with::<true>(c, rest)
    }

    /// The same at the pressure of the state: the second equation lacks nothing, whatever `rest` says.
    #[inline(always)]
    pub(crate) fn solve_at_pressure(&self, c: &Constants<S>, rest: Rest<S>) -> Unknowns<S> {
        self.solve_with::<false>(c, rest)
    }

    #[inline(always)]
    fn solve_with<const PRESSURE: bool>(&self, c: &Constants<S>, rest: Rest<S>) -> Unknowns<S> {
        let Rest { mut e, mut w, mut tension, .. } = rest;
        if TWIST {
            let i = self.inverse_gg * rest.g;
            let turned = self.a_wg * i;
            e = e - self.a_eg * i;
            w = if PRESSURE { w - turned } else { -turned };
            tension = tension - c.scale * self.h.g * i;
        }
        let (a, i) = (&self.adjugate, self.inverse);
        if !TWIST && !PRESSURE {
            let de = (a.ee * e).plus_product(a.eh, tension) * i;
            let dw = (a.ew * e).plus_product(a.wh, tension) * i;
            let dt = (a.hh * tension).plus_product(c.scale, a.eh * e) * i;
            return Unknowns { e: de, w: dw, g: e.of(0.0), tension: dt };
        }
        let de = (a.ee * e).plus_product(a.ew, w).plus_product(a.eh, tension) * i;
        let dw = (a.ew * e).plus_product(a.ww, w).plus_product(a.wh, tension) * i;
        let dt = (a.hh * tension).plus_product(c.scale, (a.eh * e).plus_product(a.wh, w)) * i;
        let mut dg = rest.g.of(0.0);
        if TWIST {
            dg = (rest.g - self.a_eg * de - self.a_wg * dw - self.h.g * dt) * self.inverse_gg;
        }
        Unknowns { e: de, w: dw, g: dg, tension: dt }
    }

    /// Half the second derivative of the left sides along a direction, negated: what a step in that direction leaves over.
    #[inline(always)]
    pub(crate) fn curvature(&self, c: &Constants<S>, d: Unknowns<S>) -> Rest<S> {
        let bend = self.bend(c, d);
        Rest { tension: c.scale * bend.tension, ..bend }
    }

    /// The same with the fourth equation divided by `scale`: the equations are then derivatives of one function.
    #[inline(always)]
    fn bend(&self, c: &Constants<S>, d: Unknowns<S>) -> Rest<S> {
        let k = |value: f64| d.e.of(value);
        let (half, two, four) = (k(0.5), k(2.0), k(4.0));
        let Self { il, ii, io, p, p_w, m_w, m_ww, .. } = *self;
        let tension = self.at.tension;
        // r = d ln lambda makes every power of 1/lambda a factor.
        let r = d.e * il;

        // The elastomer: M and its derivative by w, to first and second order.
        let m_www = -(self.log_w * ((ii + io) * self.spread + ii * ii + c.x_outer * io * io));
        let (mut dm, mut dm_w, mut ddm_w) = (m_w * d.w, m_ww * d.w, m_www * d.w * d.w);
        let mut ddm = dm_w * d.w;

        // The sheet: p to first order, and how its share in the axial force changes.
        let (stretch, shrink) = (p_w * d.w, p * r);
        let dp = stretch - shrink;
        let dp_e = -(il * (dp - shrink));
        let tightened = tension * r;
        let slack = tightened - d.tension;
        let mut sheet_e = self.hoop2 * (il * tightened * dp - slack * dp_e) + two * c.sin2 * d.e * d.tension;
        let mut sheet_w = self.h.w * r * slack;
        let mut sheet_h = c.sin2 * d.e * d.e - self.hoop2 * r * dp;
        let mut twist = k(0.0);
        if TWIST {
            let (g, dg) = (self.at.g, d.g);
            let (q, gdg) = (c.d * (half * (c.x_outer + k(1.0)) + self.at.w), g * dg);
            let dg2 = dg * dg;
            let widened = two * c.d * gdg;
            dm = dm + two * gdg * q;
            ddm = ddm + two * (q * dg2 + widened * d.w);
            dm_w = dm_w + widened;
            ddm_w = ddm_w + two * c.d * dg2;
            // The square of the hoop to first order, and half of its second.
            let turn = two * c.sin_rho;
            let (wound, rewound) = (turn * self.hoop * dg, c.sin_rho * c.sin_rho * dg2);
            let pull = tension * rewound + d.tension * wound;
            sheet_e = sheet_e + tension * wound * dp_e - p * il * pull;
            sheet_w = sheet_w + p_w * (pull - tightened * wound);
            sheet_h = sheet_h + dp * wound + p * rewound;
            let hoop_rate = turn * self.hoop;
            let (h_g1, h_g2) =
                (dp * hoop_rate + p * turn * c.sin_rho * dg, dp * (turn * c.sin_rho * dg - r * hoop_rate));
            let gq1 = q * dg + g * c.d * d.w;
            let elastomer = il * (c.d * d.w * dg - r * (gq1 - g * q * r));
            twist = -(elastomer + tension * h_g2 + d.tension * h_g1);
        }
        let quarter = k(0.25) * il;
        Rest {
            e: quarter * il * (ddm - r * (four * dm - k(6.0) * self.m * r)) - sheet_e,
            w: -(quarter * (ddm_w - two * r * (dm_w - m_w * r)) + sheet_w),
            g: twist,
            tension: -sheet_h,
        }
    }

    /// Imbalance of the equations at a pressure and under loads.
    #[inline(always)]
    pub(crate) fn rest(&self, c: &Constants<S>, force: S, pressure: S, torque: S) -> Rest<S> {
        Rest {
            e: force - self.left.e,
            w: pressure - self.left.w,
            g: if TWIST { torque - self.left.g } else { force.of(0.0) },
            tension: c.compliance * self.at.tension - c.scale * self.left.tension,
        }
    }

    /// Change of the state with the pressure: [`solve`](Self::solve) for a rest of one in the second equation.
    #[inline(always)]
    pub(crate) fn rate(&self, c: &Constants<S>) -> Unknowns<S> {
        let (a, i) = (&self.adjugate, self.inverse);
        let (e, w, tension) = (a.ew * i, a.ww * i, c.scale * a.wh * i);
        let mut g = c.scale.of(0.0);
        if TWIST {
            g = -((self.a_eg * e + self.a_wg * w + self.h.g * tension) * self.inverse_gg);
        }
        Unknowns { e, w, g, tension }
    }

    /// Change of the volume with the pressure a small step away, to first order in the step.
    ///
    /// The rate is `b A^-1 b` with the symmetric matrix `A` of the second derivatives of one function, so it changes by the third
    /// derivatives twice along the rate and once along the step, negated.
    #[inline(always)]
    pub(crate) fn volume_rate_after(&self, c: &Constants<S>, step: &Unknowns<S>) -> S {
        let rate = self.rate(c);
        let bend = self.bend(c, rate);
        let mut change = bend.e * step.e + bend.w * step.w + bend.tension * step.tension;
        if TWIST {
            change = change + bend.g * step.g;
        }
        rate.w + change + change
    }
}
