//! Sections 5 and 6: bending, bundles.

use super::*;

/// A section bent with a curvature.
#[derive(Clone, Copy)]
pub(super) struct Section {
    pub(super) inner: Length,
    pub(super) outer: Length,
    pub(super) winding: Length,
    pub(super) mu1: Pressure,
    pub(super) curvature: ReciprocalLength,
}

impl Section {
    /// `(1 + kappa R_o)(R_f^2 - r^2)/2 - kappa cos(phi_c)(R_f^3 - r^3)/3 = (R_f^2 - R^2)/2`, by Newton's method.
    pub(super) fn eq_1_radius(&self, radius: Length, around: Angle) -> Length {
        let (f, k) = (self.winding, self.curvature);
        (0..30).fold(radius, |r, _| {
            let excess: Area = (ONE + k * self.outer) * (f * f - r * r) / 2.0
                - k * around.cos() * (f * f * f - r * r * r) / 3.0
                - (f * f - radius * radius) / 2.0;
            r + excess / (r * self.eq_12_stretch(r, around))
        })
    }

    /// Corrected (12): `lambda = 1 + kappa (R_o - r cos phi_c)`.
    pub(super) fn eq_12_stretch(&self, r: Length, around: Angle) -> Ratio {
        ONE + self.curvature * (self.outer - r * around.cos())
    }

    /// `dr/dphi_c = kappa sin(phi_c)(R_f^3 - r^3)/(3 r lambda)`.
    pub(super) fn lean(&self, r: Length, around: Angle) -> Length {
        let reach: Volume = self.winding * self.winding * self.winding - r * r * r;
        self.curvature * around.sin() * reach / (3.0 * r * self.eq_12_stretch(r, around))
    }

    pub(super) fn eq_1_gradient(&self, radius: Length, around: Angle) -> Tensor {
        let (r, zero) = (self.eq_1_radius(radius, around), 0.0 * ONE);
        let lambda = self.eq_12_stretch(r, around);
        [[radius / (r * lambda), self.lean(r, around) / radius, zero], [zero, r / radius, zero], [zero, zero, lambda]]
    }

    /// `U/L`, energy per length, from both halves of the section.
    pub(super) fn energy_per_length(&self) -> Force {
        let width = self.outer - self.inner;
        mean(PANELS / 4, |share| {
            let radius = self.inner + width * share;
            let around: Pressure =
                mean(PANELS / 4, |turn| eq_2_neo_hookean(self.mu1, i1(&self.eq_1_gradient(radius, rad(PI * turn)))));
            TAU * radius * width * around
        })
    }

    /// `dU/dkappa` per length, in place of (11).
    pub(super) fn eq_11_moment(&self) -> Torque {
        let step: ReciprocalLength = ONE * STEP / self.outer;
        let moment: Energy =
            change(|k| Self { curvature: self.curvature + step * k, ..*self }.energy_per_length()) / step;
        moment.into()
    }

    /// `P pi R_f^2 R_o + M_ext + N_ext R_o`, in place of (10).
    pub(super) fn eq_10_moment(&self, pressure: Pressure, force: Force, torque: Torque) -> Torque {
        let work: Energy = PI * pressure * self.winding * self.winding * self.outer + force * self.outer;
        Torque::from(work) + torque
    }

    /// `V/L = pi R_f^2 (1 + kappa R_o)` less the wall within the winding.
    pub(super) fn lumen(&self) -> Area {
        let (f, i) = (self.winding, self.inner);
        PI * f * f * (ONE + self.curvature * self.outer) - PI * (f * f - i * i)
    }
}

/// `sqrt((lambda L)^2 - (d Phi)^2)`, the length of a bundle of helices.
pub(super) fn twisted_length(length: Length, circle: Length, twist: Angle) -> Length {
    let around: Length = circle * twist;
    (length * length - around * around).sqrt()
}

/// End of an arc: `(l/phi)(1 - cos phi)` aside and `(l/phi) sin phi` along.
pub(super) fn arc_end(length: Length, bend: Angle) -> [Length; 2] {
    let radius: Length = length / bend;
    [radius * (ONE - bend.cos()), radius * bend.sin()]
}

/// 6/8 mm, wound within its wall, 100 mm long, and its section at a bend.
pub(super) fn bender(bend_angle_rad: f64) -> (ActuatorParameters<f64>, Section) {
    let mut p =
        wound(tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6)), 0.0, Families::Two, 1e6, Placement::Sheet, 0.2);
    p.fiber.as_mut().unwrap().radius_m = 7.5e-3;
    let [inner, outer, winding] = [6e-3, 8e-3, 7.5e-3].map(m);
    (p, Section { inner, outer, winding, mu1: pa(0.2e6), curvature: rad(bend_angle_rad) / m(p.length_m) })
}

#[test]
fn map_of_a_bent_section_has_the_gradient_stated() {
    let (_, section) = bender(1.2);
    for (radius, turn) in [(6e-3, 0.4), (7e-3, 1.7), (8e-3, 2.9)] {
        let (radius, around) = (m(radius), rad(turn));
        let f = section.eq_1_gradient(radius, around);
        let (step, turn) = (radius * STEP, rad(STEP));
        close(change(|k| section.eq_1_radius(radius + step * k, around)) / step, f[0][0], 1e-10 * ONE);
        let lean: Length = change(|k| section.eq_1_radius(radius, around + turn * k)) / turn;
        close(lean / radius, f[0][1], 1e-10 * ONE);
    }
}

#[test]
fn bend_balances_the_work_of_pressure_force_and_moment() {
    for load in [Load::none(), Load { force_n: 0.4, torque_nm: -0.01 }] {
        let (p, _) = bender(0.0);
        let state = solved(&p, 50e3, load);
        let (_, section) = bender(state.bend_angle_rad);
        let (force, torque) = (Force::new::<newton>(load.force_n), Torque::new::<newton_meter>(load.torque_nm));
        let applied = section.eq_10_moment(pa(50e3), force, torque);
        close(section.eq_11_moment(), applied, applied * 1e-8);
        let volume: Volume = section.lumen() * m(p.length_m);
        close(volume, Volume::new::<cubic_meter>(state.volume_m3), volume * 1e-13);
        close(section.eq_12_stretch(m(0.0), rad(0.0)), state.axial_stretch * ONE, 1e-13 * ONE);
    }
}

#[test]
fn bundle_shortens_by_its_helices_and_bends_into_an_arc() {
    let (p, pressure_pa, load) = examples()[0];
    let state = solved(&p, pressure_pa, load);
    let circle = m(0.02);
    let bundle = Segment::of_bundle(Motion::Twisting, p.length_m, 0.02, &state).unwrap();
    let length = m(p.length_m) * state.axial_stretch;
    close(twisted_length(length, circle, rad(state.twist_rad)), m(bundle.length_m), m(1e-15));

    let (p, _) = bender(0.0);
    let state = solved(&p, 50e3, Load::none());
    let bundle = Segment::of_bundle(Motion::Bending, p.length_m, 0.02, &state).unwrap();
    let [aside, along] = arc_end(m(bundle.length_m), rad(bundle.bend_angle_rad));
    let end = bundle.pose().translation.vector;
    close(aside, m(end.x), m(1e-15));
    close(along, m(end.z), m(1e-15));
}
