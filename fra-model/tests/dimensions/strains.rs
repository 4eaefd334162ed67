//! Section 3, as computed: strains from rest, closed forms; section 4: the tension of a stiff sheet, inextensible fibers.

use super::*;

/// Strains of section 3 from rest: `e = lambda - 1`, `w = V/V_0 - 1`, `g = tau R_i`, at `X = (R/R_i)^2`.
#[derive(Clone, Copy)]
pub(super) struct Strains {
    pub(super) e: Ratio,
    pub(super) w: Ratio,
    pub(super) g: Ratio,
}

impl Strains {
    pub(super) fn of(tube: &Tube) -> Self {
        let inner = m(tube.p.inner_radius_m);
        let at_rest: Volume = PI * inner * inner * m(tube.p.length_m);
        Self { e: tube.stretch() - ONE, w: tube.volume / at_rest - ONE, g: tube.tau() * inner }
    }

    pub(super) fn eta(&self, x: Ratio) -> Ratio {
        (self.w / x - self.e) / (ONE + self.e)
    }

    pub(super) fn eps(&self) -> Ratio {
        self.e * (2.0 * ONE + self.e)
    }

    /// `I1-3`.
    pub(super) fn i1(&self, x: Ratio) -> Ratio {
        let (eta, eps) = (self.eta(x), self.eps());
        let (p, q) = (ONE + eta, ONE + eps);
        (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / (p * q) + self.g * self.g * x * p
    }

    /// `I4-1`.
    pub(super) fn i4(&self, x: Ratio, angle: Angle) -> Ratio {
        let (c, s, rho) = (angle.cos(), angle.sin(), x.sqrt());
        let turn = self.g * rho * s;
        c * c * self.eta(x) + (ONE + self.eta(x)) * turn * (2.0 * c + turn) + s * s * self.eps()
    }

    /// The closed form `u, u_e, u_w, u_g` of a neo-Hookean wall up to `X_o`.
    pub(super) fn neo_hookean(&self, x_outer: Ratio) -> [Ratio; 4] {
        let Self { e, w, g } = *self;
        let (lambda, d) = (ONE + e, x_outer - ONE);
        let q = d * (x_outer + ONE) / 2.0 + w * d;
        let lam = (w * d / (x_outer + w)).ln_1p();
        let twisting = g * g * q;
        [
            ((2.0 * d + w * lam + twisting) / lambda + (lambda * lambda - 3.0 * ONE) * d) / 2.0,
            (d * e * (3.0 * ONE + 3.0 * e + e * e) - (w * lam + twisting) / 2.0) / (lambda * lambda),
            (lam + w * d / ((ONE + w) * (x_outer + w)) + g * g * d) / (2.0 * lambda),
            g * q / lambda,
        ]
    }
}

/// `w = X_f [e - s^2 e (3+3e+e^2)]/c^2`, from `lambda^2 s^2 + (r_f/R_f)^2 c^2 = 1`.
pub(super) fn inextensible_volume(x_fiber: Ratio, e: Ratio, angle: Angle) -> Ratio {
    let (c, s) = (angle.cos(), angle.sin());
    x_fiber * (e - s * s * e * (3.0 * ONE + 3.0 * e + e * e)) / (c * c)
}

/// `dV/dl = pi R_f^2 (1 - 2 tan^2 a)` at rest.
pub(super) fn eq_17_lever_of_length(winding: Length, angle: Angle) -> Area {
    PI * winding * winding * (ONE - 2.0 * angle.tan() * angle.tan())
}

/// `dV/dPhi = -2 pi R_f^3 tan a` at rest.
pub(super) fn eq_17_lever_of_twist(winding: Length, angle: Angle) -> Volume {
    -TAU * winding * winding * winding * angle.tan()
}

#[test]
fn strain_forms_are_the_invariants_of_the_gradient() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let (tube, inner) = (Tube::at(&p, &state), m(p.inner_radius_m));
        let strains = Strains::of(&tube);
        for radius in [p.inner_radius_m, 0.5 * (p.inner_radius_m + p.outer_radius_m), p.outer_radius_m].map(m) {
            let (f, x) = (tube.eq_1_gradient(radius), radius * radius / (inner * inner));
            close(strains.i1(x), i1(&f) - 3.0 * ONE, 1e-13 * ONE);
            for angle in tube.fiber_angles() {
                close(strains.i4(x, angle), i4(&f, angle) - ONE, 1e-13 * ONE);
            }
            // The linear relation that makes a radius a target of the search.
            let t = (tube.eq_1_radius(radius) / radius) * (tube.eq_1_radius(radius) / radius);
            close(strains.w / x - t * strains.e, t - ONE, 1e-13 * ONE);
        }
    }
}

/// `P = mu1 u_w`, `N_ext = pi R_i^2 mu1 u_e`, `M_ext = pi R_i^3 mu1 u_g`, and `u` itself against the integrated energy.
#[test]
fn closed_form_of_a_bare_wall_has_the_units_of_the_model() {
    let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
    let load = Load { force_n: 1.5, torque_nm: 0.01 };
    let state = solved(&p, 15e3, load);
    let (tube, inner, mu1) = (Tube::at(&p, &state), m(p.inner_radius_m), pa(0.2e6));
    let x_outer = m(p.outer_radius_m) * m(p.outer_radius_m) / (inner * inner);
    let [u, u_e, u_w, u_g] = Strains::of(&tube).neo_hookean(x_outer);
    let force: Force = PI * inner * inner * mu1;
    balanced(&p, (15e3, load), (mu1 * u_w, force * u_e, (force * inner * u_g).into()));
    // `u` counts a wall at rest as nothing.
    close(force * m(p.length_m) * u, tube.energy(), tube.energy() * 1e-11);
}

/// Along `e` at constant volume fibers and elastomer share the force: `T sum(d I4/de) = n - u_e`, without twist.
#[test]
fn tension_of_a_sheet_is_what_the_elastomer_leaves_of_the_force() {
    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
    let p = wound(p, 15.0, Families::Two, 5e6, Placement::Sheet, 0.2);
    let load = Load { force_n: 2.0, torque_nm: 0.0 };
    let state = solved(&p, 40e3, load);
    let (tube, inner, mu1) = (Tube::at(&p, &state), m(p.inner_radius_m), pa(0.2e6));
    let (radius, thickness) = tube.sheet().unwrap();
    let (strains, x) = (Strains::of(&tube), radius * radius / (inner * inner));
    let [c, s] = [rad(15_f64.to_radians()).cos(), rad(15_f64.to_radians()).sin()];
    let weight: Ratio = 2.0 * radius * thickness / (inner * inner);
    let tension: Ratio = weight * (tube.mu2() / mu1) * strains.i4(x, tube.fiber_angles()[0]);
    let lambda = tube.stretch();
    let slope = 2.0 * (2.0 * s * s * lambda - c * c * (ONE + strains.eta(x)) / lambda);
    let n: Ratio = Force::new::<newton>(load.force_n) / (PI * inner * inner * mu1);
    close(tension * slope, n - strains.neo_hookean(x)[1], 1e-12 * ONE);
}

/// Up to the strain that the tension `P R_f` leaves in a stiff sheet, and to the stiffness of the wall against it.
#[test]
fn stiff_winding_keeps_its_length_and_gives_the_pressure_its_lever() {
    let angle = rad(30_f64.to_radians());
    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
    let (inner, winding) = (m(p.inner_radius_m), m(p.outer_radius_m));
    let stiff = |families| wound(p, 30.0, families, 4e11, Placement::Sheet, 1.0);
    let sheet: ForcePerLength = pa(4e11) * m(1e-3);

    let state = solved(&stiff(Families::Two), 60e3, Load::none());
    let strains = Strains::of(&Tube::at(&p, &state));
    let x = winding * winding / (inner * inner);
    let fiber_strain: Ratio = pa(60e3) * winding / (4.0 * sheet);
    close(strains.w, inextensible_volume(x, strains.e, angle), 4.0 * x * fiber_strain);

    let softness: Ratio = pa(0.2e6) * (winding - inner) / sheet;
    let by_pressure = |families| Actuator::new(&stiff(families)).unwrap().blocked(0.0, 1.0, 0.0).unwrap().by_pressure;
    let [push, turn] = [by_pressure(Families::Two)[0], by_pressure(Families::One)[1]];
    let (length, twist) = (eq_17_lever_of_length(winding, angle), eq_17_lever_of_twist(winding, angle));
    close(-Area::new::<square_meter>(push), length, length * softness * 10.0);
    close(-Volume::new::<cubic_meter>(turn), twist, twist.abs() * softness * 10.0);
}
