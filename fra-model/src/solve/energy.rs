//! Strain energy of a straight tube and its derivatives.
//!
//! Coordinates `(e, w, g)`: axial strain `e = lambda - 1`, relative change of the lumen's volume `w = V/V0 - 1`, twist rate
//! `g = (Phi/L) R_i`. With `X = (R/R_i)^2` the energy per reference length, in units of `pi R_i^2 mu1`, is
//! `u = int W/mu1 dX`; its conjugate forces are
//! `u_e = N_ext/(pi R_i^2 mu1)`, `u_w = P/mu1`, `u_g = M_ext/(pi R_i^3 mu1)`,
//! which are eqs. (7) and (9) of the paper with their misprints corrected, and the torque balance it leaves out.
//!
//! A wall holds the handle of its closed-form solver; hence its place beside the solvers.
//!
//! All strains are written in forms that do not cancel when small: `p = (r/R)^2 = 1 + eta`, `q = lambda^2 = 1 + eps`.

use nalgebra::{Matrix3, Vector3};

use crate::model::quadrature::WallRule;
use crate::number::double_double::DoubleDouble;
use crate::number::real::{Real, real};
use crate::number::scalar::{Scalar, dot, magnitudes};
use crate::parameters::{ActuatorParameters, Families, Fiber, Material, Placement};
use crate::solve::closed_form::ClosedForm;

/// Rounding of a strain times `mu2/mu1` up to which plain arithmetic resolves the equilibrium.
const MAGNIFIED_ROUNDING: f64 = 2e-4;

/// Gradient and Hessian of the energy in the order `(e, w, g)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Derivatives<T> {
    pub(crate) gradient: Vector3<T>,
    pub(crate) hessian: Matrix3<T>,
    /// Sum of the magnitudes of the terms of the gradient: the scale of its rounding errors.
    pub(crate) magnitude: Vector3<T>,
}

impl<T: Scalar> Derivatives<T> {
    fn none() -> Self {
        let zero = T::zero();
        Self { gradient: Vector3::repeat(zero), hessian: Matrix3::repeat(zero), magnitude: Vector3::repeat(zero) }
    }
}

/// `v v^T`.
fn outer<T: Scalar>(v: &Vector3<T>) -> Matrix3<T> {
    Matrix3::from_fn(|row, column| v[row] * v[column])
}

/// Kinematics of one radius.
struct Ring<T> {
    lambda: T,
    /// `eta = (r/R)^2 - 1` and `eps = lambda^2 - 1`.
    eta: T,
    eps: T,
    /// Magnitude of the terms that make up `eta`.
    eta_terms: T,
    /// `d eta / d(e, w)` and the second derivatives `ee`, `ew`.
    eta_e: T,
    eta_w: T,
    eta_ee: T,
    eta_ew: T,
}

impl<T: Scalar> Ring<T> {
    fn new(e: T, w: T, x: T) -> Self {
        let one = T::one();
        let lambda = one + e;
        let eta = (w / x - e) / lambda;
        let p = one + eta;
        let eta_w = one / (lambda * x);
        Self {
            lambda,
            eta,
            eta_terms: ((w / x).abs() + e.abs()) / lambda,
            eps: e * (e + one + one),
            eta_e: -p / lambda,
            eta_w,
            eta_ee: (p + p) / (lambda * lambda),
            eta_ew: -eta_w / lambda,
        }
    }
}

/// The elastomer of the wall.
#[derive(Clone, Copy, Debug)]
enum Elastomer<T> {
    /// Its wall integrals have closed forms. The closed-form solver, if there is one, takes the room of the other elastomer's rule.
    NeoHookean(Option<ClosedForm<T>>),
    /// `2 C2/mu1` and `3 C3/mu1`: `psi' = 1/2 + a J + b J^2`.
    Yeoh { a: T, b: T, rule: WallRule<T> },
}

/// The winding: `cos` and `sin` of its angle, `mu2/mu1`, families and where it sits.
#[derive(Clone, Copy, Debug)]
struct Winding<T> {
    cos: T,
    sin: T,
    modulus_ratio: T,
    families: Families,
    is_sheet: bool,
    rule: WallRule<T>,
}

/// A straight tube, ready to be evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall<T> {
    parameters: ActuatorParameters<T>,
    /// `X_o = (R_o/R_i)^2`.
    pub(crate) x_outer: T,
    elastomer: Elastomer<T>,
    winding: Option<Winding<T>>,
    /// Devices take one winding: this one would cost them memory and time.
    #[cfg(not(target_os = "none"))]
    second: Option<(Fiber<T>, Winding<T>)>,
}

impl<T: Scalar> Wall<T> {
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Self {
        let ratio = parameters.outer_radius_m / parameters.inner_radius_m;
        let x_outer = ratio * ratio;
        let mu1 = parameters.material.shear_modulus_pa();
        let elastomer = match parameters.material {
            Material::NeoHookean { .. } => Elastomer::NeoHookean(None),
            Material::Yeoh { c_pa } => Elastomer::Yeoh {
                a: T::constant(2.0) * c_pa[1] / mu1,
                b: T::constant(3.0) * c_pa[2] / mu1,
                rule: WallRule::new(T::one(), x_outer),
            },
        };
        let winding = parameters.fiber.as_ref().filter(|fiber| fiber.modulus_pa > T::zero());
        let winding = winding.map(|fiber| Winding::new(fiber, parameters.inner_radius_m, x_outer, mu1));
        Self {
            parameters: *parameters,
            x_outer,
            elastomer,
            winding,
            #[cfg(not(target_os = "none"))]
            second: None,
        }
    }

    /// The same wall with a second winding. Two windings have no closed forms.
    #[cfg(not(target_os = "none"))]
    pub(crate) fn with_second(self, fiber: &Fiber<T>) -> Self {
        let Self { parameters, x_outer, .. } = self;
        let mu1 = parameters.material.shear_modulus_pa();
        let stiff = fiber.modulus_pa > T::zero();
        let second = stiff.then(|| (*fiber, Winding::new(fiber, parameters.inner_radius_m, x_outer, mu1)));
        Self { second, ..self }.with_closed_form(None)
    }

    #[cfg(not(target_os = "none"))]
    fn second(&self) -> Option<&Winding<T>> {
        self.second.as_ref().map(|(_, winding)| winding)
    }

    #[cfg(target_os = "none")]
    #[inline(always)]
    fn second(&self) -> Option<&Winding<T>> {
        None
    }

    /// The same wall with a closed-form solver, or without one.
    pub(crate) fn with_closed_form(mut self, solver: Option<ClosedForm<T>>) -> Self {
        if let Elastomer::NeoHookean(kept) = &mut self.elastomer {
            *kept = solver;
        }
        self
    }

    /// The closed-form solver, if the wall has one.
    pub(crate) fn closed_form(&self) -> Option<&ClosedForm<T>> {
        match &self.elastomer {
            Elastomer::NeoHookean(solver) => solver.as_ref(),
            Elastomer::Yeoh { .. } => None,
        }
    }

    /// `true` when the tube can twist without an external torque.
    pub(crate) fn twists_by_itself(&self) -> bool {
        let one = |winding: Option<&Winding<T>>| winding.is_some_and(|winding| winding.families == Families::One);
        one(self.winding.as_ref()) || one(self.second())
    }

    /// Gradient and Hessian at `(e, w, g)`; `1 + e > 0` and `1 + w > 0`.
    pub(crate) fn derivatives(&self, e: T, w: T, g: T) -> Derivatives<T> {
        let mut sum = self.elastomer_derivatives(e, w, g);
        if let Some(winding) = &self.winding {
            winding.add(e, w, g, &mut sum);
        }
        if let Some(winding) = self.second() {
            winding.add(e, w, g, &mut sum);
        }
        sum
    }

    fn elastomer_derivatives(&self, e: T, w: T, g: T) -> Derivatives<T> {
        let mut sum = match &self.elastomer {
            Elastomer::NeoHookean(_) => neo_hookean(e, w, g, self.x_outer),
            Elastomer::Yeoh { a, b, rule } => yeoh(e, w, g, *a, *b, rule),
        };
        // The elastomer's stiffness is of the order of X_o - 1 in every coordinate, also where its terms cancel.
        let thickness = self.x_outer - T::one();
        sum.magnitude = Vector3::repeat(thickness * (e.abs() + w.abs() + g.abs()));
        if !self.twists_by_itself() {
            // The torque is proportional to the twist.
            sum.magnitude.z = thickness * self.x_outer * g.abs();
        }
        sum
    }
}

impl<T: Real> Wall<T> {
    /// Whether the rounding of the fibers' strains, magnified by their modulus, would hide how the elastomer deforms. A sheet's tension
    /// follows from the loads instead.
    pub(crate) fn is_too_stiff_for_plain_arithmetic(&self) -> bool {
        let stiff = |winding: &Winding<T>| winding.modulus_ratio * T::default_epsilon() > real::<T>(MAGNIFIED_ROUNDING);
        if let Some(second) = self.second() {
            // The loads do not tell the tensions of two windings apart.
            return stiff(second) || self.winding.as_ref().is_some_and(stiff);
        }
        self.winding.as_ref().is_some_and(|winding| !winding.is_sheet && stiff(winding))
    }

    /// The same wall in double-double arithmetic, nodes and parameters included: the nodes of a thin wall keep their distances.
    pub(crate) fn in_double_double(&self) -> Wall<DoubleDouble<T>> {
        let wall = Wall::new(&self.parameters.map(DoubleDouble::from));
        #[cfg(not(target_os = "none"))]
        if let Some((fiber, _)) = &self.second {
            return wall.with_second(&fiber.map(DoubleDouble::from));
        }
        wall
    }
}

impl<T: Scalar> Wall<T> {
    /// `u_w` at an equilibrium of a tube wound with a sheet, and its rounding error.
    ///
    /// The tension of a stiff sheet is a tiny strain times a huge modulus, and the rounding of the strain comes out magnified. At
    /// equilibrium the tension also follows from what the elastomer leaves of the loads, without the modulus: of the three, the one
    /// with the least rounding is used. `None` where families or windings carry different tensions, or the fibers are not a sheet.
    pub(crate) fn pressure_by_tension(
        &self,
        at: Vector3<T>,
        force: T,
        torque: Option<T>,
        settling_noise: &Vector3<T>,
    ) -> Option<(T, T)> {
        if self.second().is_some() {
            return None;
        }
        let winding = self.winding.as_ref().filter(|winding| winding.is_sheet)?;
        let Sheet { first, cancelling, strain, terms, stiffness } = winding.sheet(at.x, at.y, at.z)?;
        let bare = self.elastomer_derivatives(at.x, at.y, at.z);
        let rounding = T::constant(8.0) * T::rounding();
        // What the elastomer's share of an equation is off by, through rounding and through the state.
        let off = |axis: usize| {
            let state = dot(&magnitudes(&bare.hessian.column(axis).into_owned()), settling_noise);
            (bare.magnitude[axis] + bare.gradient[axis].abs()) * rounding + state
        };
        let mut tension =
            (stiffness * strain, stiffness * (terms * rounding + dot(&magnitudes(&first), settling_noise)));
        for (axis, load) in [(0, Some(force)), (2, torque)] {
            let Some(load) = load else { continue };
            let by_load = (load - bare.gradient[axis]) / first[axis];
            let lever = if axis == 0 { cancelling * by_load.abs() } else { T::zero() };
            let noise = (off(axis) + (load.abs() + lever) * rounding) / first[axis].abs();
            if noise < tension.1 {
                tension = (by_load, noise);
            }
        }
        Some((bare.gradient.y + first.y * tension.0, off(1) + first.y.abs() * tension.1))
    }
}

/// Closed form of the neo-Hookean wall integrals: `Lam = ln(X_o (1+w)/(X_o+w))`, `S = 2 D + w Lam`, `Q = D (X_o+1)/2 + w D`.
fn neo_hookean<T: Scalar>(e: T, w: T, g: T, x_outer: T) -> Derivatives<T> {
    let one = T::one();
    let half = T::constant(0.5);
    let lambda = one + e;
    let d = x_outer - one;
    let (inner, outer) = (one + w, x_outer + w);
    let lam = (w * d / outer).ln_1p();
    let lam_w = d / (inner * outer);
    let q = d * (half * (x_outer + one) + w);
    let s_w = lam + w * lam_w;
    // 2 Lam_w + w Lam_ww, without the cancellation of its terms at large w.
    let s_ww = lam_w * (one / inner + x_outer / outer);
    let per_lambda = one / lambda;
    let per_lambda2 = per_lambda * per_lambda;
    let three = T::constant(3.0);
    let u_e = per_lambda2 * (d * e * (three + three * e + e * e) - half * (w * lam + g * g * q));
    let u_w = half * per_lambda * (s_w + g * g * d);
    let u_g = per_lambda * g * q;
    let u_ee = per_lambda2 * per_lambda * (d + d + w * lam + g * g * q) + d;
    let u_ew = -half * per_lambda2 * (s_w + g * g * d);
    let u_eg = -per_lambda2 * g * q;
    let u_ww = half * per_lambda * s_ww;
    let u_wg = per_lambda * g * d;
    let u_gg = per_lambda * q;
    Derivatives {
        gradient: Vector3::new(u_e, u_w, u_g),
        hessian: Matrix3::new(u_ee, u_ew, u_eg, u_ew, u_ww, u_wg, u_eg, u_wg, u_gg),
        ..Derivatives::none()
    }
}

/// Yeoh wall integrals by quadrature: `psi'(J) = 1/2 + a J + b J^2` with `J = I1 - 3`.
fn yeoh<T: Scalar>(e: T, w: T, g: T, a: T, b: T, rule: &WallRule<T>) -> Derivatives<T> {
    let mut sum = Derivatives::none();
    rule.for_each(w, |x, weight| {
        let (invariant, first, second) = first_invariant(&Ring::new(e, w, x), g, x);
        let slope = T::constant(0.5) + invariant * (a + b * invariant);
        let curvature = a + (b + b) * invariant;
        sum.gradient += first * (weight * slope);
        sum.hessian += second * (weight * slope) + outer(&first) * (weight * curvature);
    });
    sum
}

/// `I1 - 3` and its derivatives.
fn first_invariant<T: Scalar>(ring: &Ring<T>, g: T, x: T) -> (T, Vector3<T>, Matrix3<T>) {
    let one = T::one();
    let two = one + one;
    let Ring { lambda, eta, eps, .. } = *ring;
    let (p, q) = (one + eta, one + eps);
    let pq = p * q;
    let g2x = g * g * x;
    let value = (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / pq + g2x * p;
    let by_p = (eta * (two + eta) * q + eps) / (p * pq) + g2x;
    let by_q = (eps * (two + eps) * p + eta) / (q * pq);
    let by_pp = two / (p * p * pq);
    let by_pq = one / (pq * pq);
    let by_qq = two / (q * q * pq);
    let by_g = two * g * x * p;
    let by_pg = two * g * x;
    let (q_e, q_ee) = (two * lambda, two);
    let (p_e, p_w) = (ring.eta_e, ring.eta_w);
    let gradient = Vector3::new(by_p * p_e + by_q * q_e, by_p * p_w, by_g);
    let ee = by_pp * p_e * p_e + two * by_pq * p_e * q_e + by_qq * q_e * q_e + by_p * ring.eta_ee + by_q * q_ee;
    let ew = by_pp * p_e * p_w + by_pq * p_w * q_e + by_p * ring.eta_ew;
    let ww = by_pp * p_w * p_w;
    let (eg, wg, gg) = (by_pg * p_e, by_pg * p_w, two * x * p);
    (value, gradient, Matrix3::new(ee, ew, eg, ew, ww, wg, eg, wg, gg))
}

impl<T: Scalar> Winding<T> {
    fn new(fiber: &Fiber<T>, inner_radius_m: T, x_outer: T, mu1: T) -> Self {
        let radius = fiber.radius_m / inner_radius_m;
        let x = radius * radius;
        let rule = match fiber.placement {
            Placement::Sheet => WallRule::point(x, T::constant(2.0) * radius * fiber.thickness_m / inner_radius_m),
            Placement::Layer => WallRule::new(x, x_outer),
            Placement::Smeared => WallRule::new(T::one(), x_outer),
        };
        // At exactly a quarter turn the fibers are axial: the rounding of pi/2 shall not make them twist.
        let (sin, cos) = fiber.angle_rad.sin_cos();
        let cos = if cos.abs() <= T::epsilon() { cos.without_value() } else { cos };
        Self {
            cos,
            sin,
            modulus_ratio: fiber.modulus_pa / mu1,
            families: fiber.families,
            is_sheet: fiber.placement == Placement::Sheet,
            rule,
        }
    }

    /// `None` where the families are not strained alike.
    fn sheet(&self, e: T, w: T, g: T) -> Option<Sheet<T>> {
        if self.families == Families::Two && g != T::zero() {
            return None;
        }
        let mut found = None;
        self.rule.for_each(w, |x, weight| {
            let strain = self.strain(&Ring::new(e, w, x), g, x.sqrt(), self.cos);
            let both = T::constant(2.0);
            let (first, cancelling) = match self.families {
                Families::One => (strain.first, strain.cancelling),
                Families::Two => {
                    let sum = Vector3::new(both * strain.first.x, both * strain.first.y, T::zero());
                    (sum, both * strain.cancelling)
                }
            };
            let (strain, terms) = (strain.value, strain.terms);
            found = Some(Sheet { first, cancelling, strain, terms, stiffness: weight * self.modulus_ratio });
        });
        found
    }

    /// Adds `int mu2/(2 mu1) (I4-1)^2 dX` of every family.
    fn add(&self, e: T, w: T, g: T, sum: &mut Derivatives<T>) {
        self.rule.for_each(w, |x, weight| {
            let ring = Ring::new(e, w, x);
            let rho = x.sqrt();
            let stiffness = weight * self.modulus_ratio;
            match self.families {
                Families::One => self.strain(&ring, g, rho, self.cos).add_to(sum, stiffness),
                // (A+B)^2 + (A-B)^2 = 2 A^2 + 2 B^2: the torques of the two families would cancel, all but a tiny twist's.
                Families::Two => {
                    let both = stiffness + stiffness;
                    self.even(&ring, g, rho).add_to(sum, both);
                    self.odd(&ring, g, rho).add_to(sum, both);
                }
            }
        });
    }

    /// The common part of the strains of two mirrored families: `c^2 eta + p (g rho s)^2 + s^2 eps`.
    fn even(&self, ring: &Ring<T>, g: T, rho: T) -> FiberStrain<T> {
        let two = T::constant(2.0);
        let (sin, cos) = (self.sin, self.cos);
        let per_g = rho * sin;
        let shear = g * per_g;
        let p = T::one() + ring.eta;
        let by_p = cos * cos + shear * shear;
        let by_pg = two * shear * per_g;
        let twist = p * shear * shear;
        FiberStrain {
            value: cos * cos * ring.eta + twist + sin * sin * ring.eps,
            terms: cos * cos * ring.eta_terms + twist.abs() + sin * sin * ring.eps.abs(),
            first: Vector3::new(by_p * ring.eta_e + two * sin * sin * ring.lambda, by_p * ring.eta_w, by_pg * p),
            cancelling: (by_p * ring.eta_e).abs(),
            second: Matrix3::new(
                by_p * ring.eta_ee + two * sin * sin,
                by_p * ring.eta_ew,
                by_pg * ring.eta_e,
                by_p * ring.eta_ew,
                T::zero(),
                by_pg * ring.eta_w,
                by_pg * ring.eta_e,
                by_pg * ring.eta_w,
                two * p * per_g * per_g,
            ),
        }
    }

    /// The difference of each strain from it: `2 c p g rho s`.
    fn odd(&self, ring: &Ring<T>, g: T, rho: T) -> FiberStrain<T> {
        let by_pg = T::constant(2.0) * self.cos * rho * self.sin;
        let p = T::one() + ring.eta;
        let by_p = by_pg * g;
        let value = by_p * p;
        let (eg, wg) = (by_pg * ring.eta_e, by_pg * ring.eta_w);
        let (ee, ew, zero) = (by_p * ring.eta_ee, by_p * ring.eta_ew, T::zero());
        FiberStrain {
            value,
            terms: value.abs(),
            first: Vector3::new(by_p * ring.eta_e, by_p * ring.eta_w, by_pg * p),
            cancelling: (by_p * ring.eta_e).abs(),
            second: Matrix3::new(ee, ew, eg, ew, zero, wg, eg, wg, zero),
        }
    }

    /// One family at one radius: `I4 - 1 = c^2 eta + p g rho s (2c + g rho s) + s^2 eps`.
    fn strain(&self, ring: &Ring<T>, g: T, rho: T, cos: T) -> FiberStrain<T> {
        let two = T::constant(2.0);
        let sin = self.sin;
        let shear = g * rho * sin;
        let hoop = cos + shear;
        let p = T::one() + ring.eta;
        let by_p = hoop * hoop;
        let by_pg = two * hoop * sin * rho;
        let first = Vector3::new(by_p * ring.eta_e + two * sin * sin * ring.lambda, by_p * ring.eta_w, by_pg * p);
        let ee = by_p * ring.eta_ee + two * sin * sin;
        let ew = by_p * ring.eta_ew;
        let (eg, wg) = (by_pg * ring.eta_e, by_pg * ring.eta_w);
        let gg = two * p * sin * sin * rho * rho;
        FiberStrain {
            value: cos * cos * ring.eta + p * shear * (cos + hoop) + sin * sin * ring.eps,
            terms: cos * cos * ring.eta_terms + (p * shear * (cos + hoop)).abs() + sin * sin * ring.eps.abs(),
            first,
            cancelling: (by_p * ring.eta_e).abs(),
            second: Matrix3::new(ee, ew, eg, ew, T::zero(), wg, eg, wg, gg),
        }
    }
}

impl<T: Scalar> FiberStrain<T> {
    /// Adds the energy `stiffness/2 value^2`.
    fn add_to(&self, sum: &mut Derivatives<T>, stiffness: T) {
        let first = self.first;
        sum.magnitude += first.map(T::abs) * (stiffness * self.terms);
        // At the neutral angle the two parts of d I4/de cancel, and with them what they have in common.
        sum.magnitude.x += self.cancelling * (stiffness * self.value.abs());
        sum.gradient += first * (stiffness * self.value);
        sum.hessian += self.second * (stiffness * self.value) + outer(&first) * stiffness;
    }
}

/// A sheet whose families are strained alike.
struct Sheet<T> {
    /// Sum of the families' `d I4/d(e, w, g)`, and the larger of the two parts that make up its first component.
    first: Vector3<T>,
    cancelling: T,
    /// `I4 - 1` and the magnitude of its terms.
    strain: T,
    terms: T,
    /// Tension per strain.
    stiffness: T,
}

/// `I4 - 1` of one family at one radius, the magnitude of its terms, and its derivatives by `(e, w, g)`.
struct FiberStrain<T> {
    value: T,
    terms: T,
    first: Vector3<T>,
    /// The larger of the two parts that make up `first.x`.
    cancelling: T,
    second: Matrix3<T>,
}
