//! The energy of a straight tube by any number of nodes, or with the closed form of the neo-Hookean wall: the equations of
//! `docs/explanation/model.md`, section 3, once more and with the choice of the integration left open.

use fra_model::{ActuatorParameters, Families, Material, Placement};

use super::ring::{Partial, Ring};
use crate::accuracy::gauss::Rule;
use crate::accuracy::number::Number;

/// How the wall is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Integration {
    /// The elastomer in closed form; whatever has none by 8 nodes.
    Closed,
    /// Everything but a sheet by this many Gauss-Legendre nodes in `ln R`.
    Nodes(u32),
}

/// Gradient and Hessian in the order `(e, w, g)`.
#[derive(Clone, Copy)]
pub(super) struct Derivatives<N> {
    pub(super) gradient: [N; 3],
    pub(super) hessian: [[N; 3]; 3],
}

/// A wall, ready to be evaluated, lengths in units of `R_i` and energies in units of `pi R_i^2 mu1`.
pub(super) struct Wall<N> {
    pub(super) x_outer: N,
    pub(super) winding: Option<Winding<N>>,
    closed: bool,
    /// `psi'(J)/mu1 = 1/2 + a J + b J^2`.
    a: N,
    b: N,
    nodes: Vec<(N, N)>,
}

pub(super) struct Winding<N> {
    pub(super) sin: N,
    pub(super) cos: N,
    modulus_ratio: N,
    pub(super) both: bool,
    /// Places and weights; one for a sheet.
    pub(super) nodes: Vec<(N, N)>,
}

impl<N: Number> Wall<N> {
    pub(super) fn new(p: &ActuatorParameters<f64>, integration: Integration) -> Self {
        let x_outer = (p.outer_radius_m / p.inner_radius_m).powi(2);
        let mu = p.material.shear_modulus_pa();
        let (a, b) = match p.material {
            Material::NeoHookean { .. } => (0.0, 0.0),
            Material::Yeoh { c_pa } => (2.0 * c_pa[1] / mu, 3.0 * c_pa[2] / mu),
        };
        let closed = integration == Integration::Closed && matches!(p.material, Material::NeoHookean { .. });
        let count = match integration {
            Integration::Closed => 8,
            Integration::Nodes(count) => count,
        };
        let winding = p.fiber.map(|fiber| {
            let x = (fiber.radius_m / p.inner_radius_m).powi(2);
            let nodes = match fiber.placement {
                Placement::Sheet => vec![(N::of(x), N::of(2.0 * x.sqrt() * fiber.thickness_m / p.inner_radius_m))],
                Placement::Layer => nodes(count, x, x_outer),
                Placement::Smeared => nodes(count, 1.0, x_outer),
            };
            let (sin, cos) = N::of(fiber.angle_rad).sin_cos();
            Winding {
                sin,
                cos,
                modulus_ratio: N::of(fiber.modulus_pa / mu),
                both: fiber.families == Families::Two,
                nodes,
            }
        });
        Self { x_outer: N::of(x_outer), winding, closed, a: N::of(a), b: N::of(b), nodes: nodes(count, 1.0, x_outer) }
    }

    /// Whether the twist is an unknown.
    pub(super) fn twists(&self) -> bool {
        self.winding.as_ref().is_some_and(|winding| !winding.both)
    }

    pub(super) fn derivatives(&self, at: [N; 3]) -> Derivatives<N> {
        let mut sum = self.elastomer(at);
        if let Some(winding) = &self.winding {
            winding.add(at, &mut sum);
        }
        sum
    }

    /// The share of the elastomer.
    pub(super) fn elastomer(&self, at: [N; 3]) -> Derivatives<N> {
        if self.closed {
            return neo_hookean(at, self.x_outer);
        }
        let mut sum = Derivatives { gradient: [N::of(0.0); 3], hessian: [[N::of(0.0); 3]; 3] };
        for &(x, weight) in &self.nodes {
            let ring = Ring::new(at, x);
            let (j, partial) = ring.first_invariant();
            let slope = N::of(0.5) + j * (self.a + self.b * j);
            let curvature = self.a + (self.b + self.b) * j;
            sum.add(&ring, &partial, weight * slope, weight * curvature);
        }
        sum
    }
}

impl<N: Number> Wall<N> {
    /// `P/mu1` by (7) with its map corrected and (8) as printed, without `mu1 (r^2/R^2 + (r Phi/L)^2)`: of the elastomer's stress
    /// difference only `-mu1 R^2/(r lambda)^2` is left. `dr/r = dX/(2 lambda p X)`.
    pub(super) fn printed_pressure(&self, at: [N; 3]) -> N {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let fibers = self.derivatives(at).gradient[1] - self.elastomer(at).gradient[1];
        let lambda = one + at[0];
        self.nodes.iter().fold(fibers, |sum, &(x, weight)| {
            let ring = Ring::new(at, x);
            let j = ring.first_invariant().0;
            let modulus = one + two * j * (self.a + self.b * j);
            let p = one + ring.eta;
            sum - weight / (two * lambda * p * x) * modulus / (p * lambda * lambda)
        })
    }
}

impl<N: Number> Winding<N> {
    fn add(&self, at: [N; 3], sum: &mut Derivatives<N>) {
        let both = [self.cos, -self.cos];
        let families = if self.both { &both[..] } else { &both[..1] };
        for &(x, weight) in &self.nodes {
            let ring = Ring::new(at, x);
            let stiffness = weight * self.modulus_ratio;
            for &cos in families {
                let (strain, partial) = ring.fiber(cos, self.sin);
                sum.add(&ring, &partial, stiffness * strain, stiffness);
            }
        }
    }
}

impl<N: Number> Derivatives<N> {
    /// Adds an energy of one invariant with its first and second derivative by that invariant.
    fn add(&mut self, ring: &Ring<N>, f: &Partial<N>, slope: N, curvature: N) {
        let (p_e, p_w, q_e, two) = (ring.p_e, ring.p_w, ring.q_e, N::of(2.0));
        let first = [f.p * p_e + f.q * q_e, f.p * p_w, f.g];
        let ee = f.pp * p_e * p_e + two * f.pq * p_e * q_e + f.qq * q_e * q_e + f.p * ring.p_ee + two * f.q;
        let ew = f.pp * p_e * p_w + f.pq * p_w * q_e + f.p * ring.p_ew;
        let second = [[ee, ew, f.pg * p_e], [ew, f.pp * p_w * p_w, f.pg * p_w], [f.pg * p_e, f.pg * p_w, f.gg]];
        for row in 0..3 {
            self.gradient[row] = self.gradient[row] + slope * first[row];
            for column in 0..3 {
                self.hessian[row][column] =
                    self.hessian[row][column] + slope * second[row][column] + curvature * first[row] * first[column];
            }
        }
    }
}

/// The closed form of the neo-Hookean wall.
fn neo_hookean<N: Number>([e, w, g]: [N; 3], x_outer: N) -> Derivatives<N> {
    let (half, one, three) = (N::of(0.5), N::of(1.0), N::of(3.0));
    let per_lambda = one / (one + e);
    let square = per_lambda * per_lambda;
    let d = x_outer - one;
    let (inner, outer) = (one + w, x_outer + w);
    let log = (w * d / outer).ln_1p();
    let log_w = d / (inner * outer);
    let q = d * (half * (x_outer + one) + w);
    let s_w = log + w * log_w + g * g * d;
    let (ew, eg, wg) = (-half * square * s_w, -square * g * q, per_lambda * g * d);
    let ee = square * per_lambda * (d + d + w * log + g * g * q) + d;
    let ww = half * per_lambda * log_w * (one / inner + x_outer / outer);
    Derivatives {
        gradient: [
            square * (d * e * (three + three * e + e * e) - half * (w * log + g * g * q)),
            half * per_lambda * s_w,
            per_lambda * g * q,
        ],
        hessian: [[ee, ew, eg], [ew, ww, wg], [eg, wg, per_lambda * q]],
    }
}

/// Nodes and weights of `int dX` from `a` to `b`, Gauss-Legendre in `ln X`.
fn nodes<N: Number>(count: u32, a: f64, b: f64) -> Vec<(N, N)> {
    let half = 0.5 * (b / a).ln();
    let place = |&(x, weight): &(f64, f64)| {
        let at = a * (half * (1.0 + x)).exp();
        (N::of(at), N::of(weight * half * at))
    };
    Rule::<f64>::new(count).nodes().iter().map(place).collect()
}
