//! The equilibrium of a straight tube, from the equilibrium of stresses: eqs. (6)-(9) of the paper with their misprints corrected.
//!
//! `P = int (s_tt - s_rr) dr/r`, `N = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr`, `M = 2 pi int s_tz r^2 dr`, over the
//! deformed wall, with `r^2 = r_i^2 + (R^2 - R_i^2)/lambda`. A sheet is a membrane of the thickness `t R_f/(r_f lambda)`.
//! Nothing here is an energy or the derivative of one.

use fra_model::{ActuatorParameters, Families, Load, Material, Placement};

use super::number::{Dual, Number, Pair};

/// Indices of the inputs.
pub(crate) const INPUTS: usize = 12;
pub(crate) const INNER: usize = 0;
pub(crate) const OUTER: usize = 1;
pub(crate) const C1: usize = 2;
pub(crate) const ANGLE: usize = 5;
pub(crate) const MU2: usize = 6;
pub(crate) const THICKNESS: usize = 7;
pub(crate) const WINDING: usize = 8;
pub(crate) const PRESSURE: usize = 9;
pub(crate) const FORCE: usize = 10;
pub(crate) const TORQUE: usize = 11;

/// Gauss-Legendre nodes and weights on `(0, 1)`.
pub(crate) struct Rule(Vec<(Pair, Pair)>);

impl Rule {
    /// The rule of `n` points, by Newton's method on the Legendre polynomial.
    pub(crate) fn new(n: u32) -> Self {
        let one = Pair::of(1.0);
        let node = |i: u32| {
            let guess = (std::f64::consts::PI * (f64::from(i) + 0.75) / (f64::from(n) + 0.5)).cos();
            let (mut x, mut slope) = (Pair::of(guess), one);
            for _ in 0..8 {
                let (mut last, mut now) = (one, x);
                for k in 2..=n {
                    let k = f64::from(k);
                    let next = (Pair::of(2.0 * k - 1.0) * x * now - Pair::of(k - 1.0) * last) / Pair::of(k);
                    (last, now) = (now, next);
                }
                slope = Pair::of(f64::from(n)) * (x * now - last) / (x * x - one);
                x = x - now / slope;
            }
            ((one - x) * Pair::of(0.5), one / ((one - x * x) * slope * slope))
        };
        Self((0..n).map(node).collect())
    }

    /// Calls `f(t, weight)` at nodes on `(0, 1)`. The variable of the integral is `a + span t`, its nearest pole lies at
    /// `a - reach`: the panels grow with their distance from it.
    pub(crate) fn integrate<N: Number>(&self, span: f64, reach: f64, mut f: impl FnMut(N, N)) {
        // Ends of the panels as shares of the span; their differences are exact in pairs, so that no gap is left between them.
        let mut from = 0.0;
        while from < 1.0 {
            let to = (2.0 * from + reach / span).min(1.0);
            let (start, width) = (N::of(from), N::of_pair(Pair::of(to) - Pair::of(from)));
            for &(node, weight) in &self.0 {
                f(start + width * N::of_pair(node), width * N::of_pair(weight));
            }
            from = to;
        }
    }
}

/// A straight tube and its inputs, exact as the solver under test gets them.
#[derive(Clone, Debug)]
pub(crate) struct Tube {
    pub(crate) inputs: [f64; INPUTS],
    pub(crate) fiber: Option<(Placement, Families)>,
    /// Whether the twist is an unknown; else it is zero by symmetry.
    pub(crate) twists: bool,
    /// Whether the fibers lie along the axis: the rounding of a right angle shall not make them twist.
    pub(crate) axial: bool,
}

impl Tube {
    pub(crate) fn new(p: &ActuatorParameters<f64>, pressure_pa: f64, load: &Load<f64>) -> Self {
        let c = match p.material {
            Material::NeoHookean { shear_modulus_pa } => [0.5 * shear_modulus_pa, 0.0, 0.0],
            Material::Yeoh { c_pa } => c_pa,
        };
        let mut inputs = [0.0; INPUTS];
        (inputs[INNER], inputs[OUTER]) = (p.inner_radius_m, p.outer_radius_m);
        inputs[C1..C1 + 3].copy_from_slice(&c);
        if let Some(f) = p.fiber {
            (inputs[ANGLE], inputs[MU2]) = (f.angle_rad, f.modulus_pa);
            (inputs[THICKNESS], inputs[WINDING]) = (f.thickness_m, f.radius_m);
        }
        (inputs[PRESSURE], inputs[FORCE], inputs[TORQUE]) = (pressure_pa, load.force_n, load.torque_nm);
        let fiber = p.fiber.map(|f| (f.placement, f.families));
        let twists = load.torque_nm != 0.0 || p.fiber.is_some_and(|f| f.families == Families::One);
        Self { inputs, fiber, twists, axial: false }
    }

    /// Shear modulus at small strain, Pa.
    pub(crate) fn mu1(&self) -> f64 {
        2.0 * self.inputs[C1]
    }

    /// End force per `pi R_i^2`, pressure and torque per `pi R_i^3` that hold the state `(e, w, g)`; Pa.
    pub(crate) fn loads<N: Number>(&self, rule: &Rule, inputs: &[N; INPUTS], state: [N; 3]) -> [N; 3] {
        let (inner, outer) = (inputs[INNER], inputs[OUTER]);
        let winding = Winding::new(self, inputs);
        let ratio = |from: N, to: N| (to - from) * (to + from) / (inner * inner);
        let span = ratio(inner, outer);
        let w = state[1].value();
        let mut sum = [N::of(0.0); 3];
        let smeared = winding.as_ref().filter(|winding| winding.placement == Placement::Smeared);
        rule.integrate(span.value(), 1.0 + w.min(0.0), |t, weight| {
            let ring = Ring::new(state, N::of(1.0) + span * t);
            let mut stress = ring.elastomer(&inputs[C1..C1 + 3]);
            if let Some(winding) = smeared {
                stress = add(stress, winding.stress(&ring));
            }
            sum = add(sum, ring.share(stress, span * weight));
        });
        let Some(winding) = &winding else { return sum };
        let at = inputs[WINDING] / inner;
        match winding.placement {
            Placement::Smeared => sum,
            Placement::Layer => {
                let (x, span) = (at * at, ratio(inputs[WINDING], outer));
                rule.integrate(span.value(), x.value() + w.min(0.0), |t, weight| {
                    let ring = Ring::new(state, x + span * t);
                    sum = add(sum, ring.share(winding.stress(&ring), span * weight));
                });
                sum
            }
            Placement::Sheet => add(sum, winding.membrane(&Ring::new(state, at * at), inputs)),
        }
    }

    /// [`loads`](Self::loads) and their derivatives by `(e, w, g)`; row: load.
    pub(crate) fn linearised(&self, rule: &Rule, state: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let inputs = self.inputs.map(Dual::<3>::of);
        let at = [0, 1, 2].map(|i| Dual::variable(state[i], i));
        let loads = self.loads(rule, &inputs, at);
        let mut slopes = loads.map(|l| l.slopes);
        let mut values = loads.map(|l| l.value);
        if !self.twists {
            values[2] = 0.0;
            let scale = slopes[0][0];
            slopes[2] = [0.0, 0.0, scale];
            (slopes[0][2], slopes[1][2]) = (0.0, 0.0);
        }
        (values, slopes)
    }

    /// The loads of the inputs, Pa: `N/(pi R_i^2)`, `P`, `M/(pi R_i^3)`.
    pub(crate) fn applied<N: Number>(inputs: &[N; INPUTS], pi: N) -> [N; 3] {
        let area = pi * inputs[INNER] * inputs[INNER];
        [inputs[FORCE] / area, inputs[PRESSURE], inputs[TORQUE] / (area * inputs[INNER])]
    }
}

fn add<N: Number>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The deformation at one radius: `p = (r/R)^2 = 1 + eta`, `q = lambda^2 = 1 + eps`, written so that small strains keep their digits.
struct Ring<N> {
    lambda: N,
    eta: N,
    eps: N,
    p: N,
    q: N,
    /// `r/R` and `r/R_i`.
    hoop: N,
    radius: N,
    /// `r tau`.
    shear: N,
    /// `r^2 lambda/R_i^2`.
    x_plus_w: N,
}

impl<N: Number> Ring<N> {
    fn new([e, w, g]: [N; 3], x: N) -> Self {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let lambda = one + e;
        let eta = (w / x - e) / lambda;
        let eps = e * (two + e);
        let (p, q) = (one + eta, one + eps);
        let hoop = p.sqrt();
        let radius = hoop * x.sqrt();
        Self { lambda, eta, eps, p, q, hoop, radius, shear: g * radius, x_plus_w: x + w }
    }

    /// `s_tt - s_rr`, `s_zz - s_rr`, `s_tz` of the elastomer.
    fn elastomer(&self, c: &[N]) -> [N; 3] {
        let Self { eta, eps, p, q, shear, .. } = *self;
        let two = N::of(2.0);
        let pq = p * q;
        let invariant = (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / pq + shear * shear;
        let modulus = two * (c[0] + invariant * (two * c[1] + N::of(3.0) * c[2] * invariant));
        let hoop = (eta * (two + eta) * q + eps) / pq + shear * shear;
        [modulus * hoop, modulus * (eps * (two + eps) * p + eta) / pq, modulus * shear * self.lambda]
    }

    /// What the stresses of this ring add to the loads.
    fn share(&self, [hoop, axial, shear]: [N; 3], dx: N) -> [N; 3] {
        let two = N::of(2.0);
        [
            (two * axial - hoop) * dx / (two * self.lambda),
            hoop * dx / (two * self.x_plus_w),
            shear * self.radius * dx / self.lambda,
        ]
    }
}

struct Winding<N> {
    placement: Placement,
    /// Cosines of the angles of the families, of which there are `count`.
    cosines: [N; 2],
    count: usize,
    sine: N,
    mu2: N,
}

impl<N: Number> Winding<N> {
    fn new(tube: &Tube, inputs: &[N; INPUTS]) -> Option<Self> {
        let (placement, families) = tube.fiber?;
        let (cos, sine) = inputs[ANGLE].cos_sin();
        let cos = if tube.axial { N::of(0.0) } else { cos };
        let count = if families == Families::Two { 2 } else { 1 };
        Some(Self { placement, cosines: [cos, -cos], count, sine, mu2: inputs[MU2] })
    }

    fn stress(&self, ring: &Ring<N>) -> [N; 3] {
        let two = N::of(2.0);
        let sine = self.sine;
        let turned = sine * ring.shear;
        self.cosines[..self.count].iter().fold([N::of(0.0); 3], |sum, &cos| {
            let (hoop, axial) = (cos * ring.hoop + turned, sine * ring.lambda);
            let strain = cos * cos * ring.eta + turned * (two * cos * ring.hoop + turned) + sine * sine * ring.eps;
            let stress = two * self.mu2 * strain;
            add(sum, [stress * hoop * hoop, stress * axial * axial, stress * hoop * axial])
        })
    }

    fn membrane(&self, ring: &Ring<N>, inputs: &[N; INPUTS]) -> [N; 3] {
        let [hoop, axial, shear] = self.stress(ring);
        let two = N::of(2.0);
        let (thickness, at, inner) = (inputs[THICKNESS] / ring.lambda, inputs[WINDING], inputs[INNER]);
        let area = thickness * at / (inner * inner);
        // r_f = R_f hoop: the pressure carried is N_tt/r.
        [(two * axial - hoop) * area, hoop * thickness / (at * ring.p), two * shear * area * ring.radius]
    }
}
