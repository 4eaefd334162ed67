//! Straight tubes from the equilibrium of stresses, in the textbook form: no energy, no strain form, no closed form.
//!
//! `P = int (s_tt - s_rr) dr/r`, `N = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr`, `M = 2 pi int s_tz r^2 dr` over the wall;
//! a sheet is a membrane with the resultants `N_ij = s_ij t R/(r lambda)`.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Placement};

use crate::accuracy::gauss::Rule;
use crate::accuracy::number::Number;

/// One tube in the numbers of the reference.
pub(super) struct Tube<'a, N> {
    rule: &'a Rule<N>,
    inner: N,
    outer: N,
    mu: f64,
    /// Yeoh coefficients; the first alone for neo-Hookean.
    c: [N; 3],
    winding: Option<Winding<N>>,
}

struct Winding<N> {
    modulus: N,
    sin_cos: (N, N),
    families: Families,
    placement: Placement,
    radius: N,
    thickness: N,
}

/// `(e, w, g)`: axial strain, relative change of the lumen's volume, twist rate times `R_i`.
pub(super) type State<N> = [N; 3];

impl<'a, N: Number> Tube<'a, N> {
    pub(super) fn new(p: &ActuatorParameters<f64>, rule: &'a Rule<N>) -> Self {
        let c = match p.material {
            Material::NeoHookean { shear_modulus_pa } => [0.5 * shear_modulus_pa, 0.0, 0.0],
            Material::Yeoh { c_pa } => c_pa,
        };
        Self {
            rule,
            inner: N::of(p.inner_radius_m),
            outer: N::of(p.outer_radius_m),
            mu: 2.0 * c[0],
            c: c.map(N::of),
            winding: p.fiber.as_ref().map(Winding::new),
        }
    }

    /// Whether the tube twists under pressure.
    pub(super) fn twists(&self) -> bool {
        self.winding.as_ref().is_some_and(|winding| winding.families == Families::One)
    }

    /// `P/mu`, `N/(pi R_i^2 mu)` and `M/(pi R_i^3 mu)` of a state.
    pub(super) fn loads(&self, [e, w, g]: State<N>) -> [N; 3] {
        let one = N::of(1.0);
        let lambda = one + e;
        let inner_square = self.inner * self.inner * (one + w) / lambda;
        let at = Deformed { lambda, tau: g / self.inner, undeformed: self.inner, inner_square };
        let wall = self.rule.integrate(self.inner, self.outer, |radius| {
            let ring = at.ring(radius);
            at.integrand(&ring, self.elastomer(&ring, lambda))
        });
        let fibers = self.winding.as_ref().map_or([N::of(0.0); 3], |winding| match winding.placement {
            Placement::Sheet => at.membrane(winding),
            Placement::Layer => self.fibers(&at, winding, winding.radius),
            Placement::Smeared => self.fibers(&at, winding, self.inner),
        });
        let mu = N::of(self.mu);
        let area = N::pi() * self.inner * self.inner * mu;
        [(wall[0] + fibers[0]) / mu, (wall[1] + fibers[1]) / area, (wall[2] + fibers[2]) / (area * self.inner)]
    }

    fn fibers(&self, at: &Deformed<N>, winding: &Winding<N>, from: N) -> [N; 3] {
        self.rule.integrate(from, self.outer, |radius| {
            let ring = at.ring(radius);
            at.integrand(&ring, winding.stress(&ring, at.lambda))
        })
    }

    /// Stress differences `(tt - rr, zz - rr, tz)` of the elastomer.
    fn elastomer(&self, ring: &Ring<N>, lambda: N) -> [N; 3] {
        let (hoop, shear) = (ring.r / ring.radius, ring.shear);
        let radial = ring.radius / (ring.r * lambda);
        let [rr, tt, zz] = [radial * radial, hoop * hoop + shear * shear, lambda * lambda];
        let excess = rr + tt + zz - N::of(3.0);
        let modulus =
            N::of(2.0) * (self.c[0] + N::of(2.0) * self.c[1] * excess + N::of(3.0) * self.c[2] * excess * excess);
        [modulus * (tt - rr), modulus * (zz - rr), modulus * shear * lambda]
    }
}

/// The kinematics of a state.
struct Deformed<N> {
    lambda: N,
    tau: N,
    undeformed: N,
    inner_square: N,
}

/// One undeformed radius, where it goes, and `r tau`.
struct Ring<N> {
    radius: N,
    r: N,
    shear: N,
}

impl<N: Number> Deformed<N> {
    fn ring(&self, radius: N) -> Ring<N> {
        let square = self.inner_square + (radius * radius - self.undeformed * self.undeformed) / self.lambda;
        let r = square.sqrt();
        Ring { radius, r, shear: r * self.tau }
    }

    /// Contributions to `P`, `N` and `M` per undeformed radius.
    fn integrand(&self, ring: &Ring<N>, [hoop, axial, shear]: [N; 3]) -> [N; 3] {
        let dr = ring.radius / (self.lambda * ring.r);
        let two = N::of(2.0);
        let around = N::pi() * ring.r * dr;
        [hoop / ring.r * dr, around * (two * axial - hoop), two * around * ring.r * shear]
    }

    fn membrane(&self, winding: &Winding<N>) -> [N; 3] {
        let ring = self.ring(winding.radius);
        let thickness = winding.thickness * winding.radius / (ring.r * self.lambda);
        let [tt, zz, tz] = winding.stress(&ring, self.lambda).map(|stress| stress * thickness);
        let two = N::of(2.0);
        let around = N::pi() * ring.r;
        [tt / ring.r, around * (two * zz - tt), two * around * ring.r * tz]
    }
}

impl<N: Number> Winding<N> {
    fn new(fiber: &Fiber<f64>) -> Self {
        Self {
            modulus: N::of(fiber.modulus_pa),
            sin_cos: N::of(fiber.angle_rad).sin_cos(),
            families: fiber.families,
            placement: fiber.placement,
            radius: N::of(fiber.radius_m),
            thickness: N::of(fiber.thickness_m),
        }
    }

    /// `2 mu2 (I4-1) FS (x) FS` summed over the families: `(tt, zz, tz)`.
    fn stress(&self, ring: &Ring<N>, lambda: N) -> [N; 3] {
        let (sin, cos) = self.sin_cos;
        let mut sum = [N::of(0.0); 3];
        let both = [cos, -cos];
        let families = if self.families == Families::Two { &both[..] } else { &both[..1] };
        for &cos in families {
            let (hoop, axial) = (cos * ring.r / ring.radius + sin * ring.shear, sin * lambda);
            let stress = N::of(2.0) * self.modulus * (hoop * hoop + axial * axial - N::of(1.0));
            sum = [sum[0] + stress * hoop * hoop, sum[1] + stress * axial * axial, sum[2] + stress * hoop * axial];
        }
        sum
    }
}
