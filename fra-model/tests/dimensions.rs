//! The equations of `docs/model.md`, sections 2 to 6, once in quantities with dimensions: that they compile is the audit. Each is a
//! function, named after the paper's equation it is or replaces where there is one; the tests compare its value with the crate's.
//!
//! Equations of the paper that fail the audit as printed:
//! - (1), general form: the entry `r dtheta/dTheta` is a length, the others are numbers.
//! - (6), second line: `d sigma_rt/d sigma_rt` is a number among terms in Pa/m.
//! - (11), (13): the factor `L` makes a moment N m2 and a pressure N/m (`eq_11_and_13_printed_*`).
//! - (14): adds m2 and rad2 under weights without units (`eq_14_printed_*`).
//! - (18): squares a wrench, and so adds N2 and N2 m2 (`eq_18_printed_*`).
//!
//! What is wrong with (7), (8), (9), (10) and (12) has the right dimension; other tests find that.

mod common;

use std::f64::consts::{PI, TAU};
use std::marker::PhantomData;

use common::*;
use fra_model::*;
use uom::si::angle::radian;
use uom::si::area::square_meter;
use uom::si::f64::{Angle, Area, Energy, Force, Length, Pressure, Ratio, ReciprocalLength, Torque, Volume};
use uom::si::force::newton;
use uom::si::length::{meter, millimeter};
use uom::si::pressure::pascal;
use uom::si::torque::{newton_meter, newton_millimeter};
use uom::si::volume::cubic_meter;
use uom::si::{Dimension, ISQ, Quantity, SI};
use uom::typenum::{N2, N4, P1, P2, P3, P4, Z0};

type Q<D> = Quantity<D, SI<f64>, f64>;
/// Length to the power `L`, times mass over time squared.
type Mechanical<L> = Q<ISQ<L, P1, N2, Z0, Z0, Z0, Z0>>;
/// N/m: energy per area, tension of a sheet, stiffness.
type ForcePerLength = Mechanical<Z0>;
/// N2 for `P2`, N2 m2 for `P4`.
type Squared<L> = Q<ISQ<L, P2, N4, Z0, Z0, Z0, Z0>>;
type Tensor = [[Ratio; 3]; 3];

/// Panels of Simpson's rule.
const PANELS: u32 = 200;
/// Step of the numerical derivatives, as a share of the quantity or of 1 rad.
const STEP: f64 = 1e-3;
const ONE: Ratio = Ratio { dimension: PhantomData, units: PhantomData, value: 1.0 };

fn m(value: f64) -> Length {
    Length::new::<meter>(value)
}

fn pa(value: f64) -> Pressure {
    Pressure::new::<pascal>(value)
}

fn rad(value: f64) -> Angle {
    Angle::new::<radian>(value)
}

/// Mean over a range of which shares from 0 to 1 are given, by Simpson's rule; times the range it is the integral.
fn mean<D>(panels: u32, f: impl Fn(f64) -> Q<D>) -> Q<D>
where
    D: Dimension<Kind = dyn uom::Kind> + ?Sized,
{
    let weighted = |i: u32| {
        let weight = if i == 0 || i == 2 * panels { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        f(f64::from(i) / f64::from(2 * panels)) * (weight / f64::from(6 * panels))
    };
    (1..=2 * panels).fold(weighted(0), |sum, i| sum + weighted(i))
}

/// Change of `f` over one step, from values up to two steps away; over the step it is the derivative.
fn change<D>(f: impl Fn(f64) -> Q<D>) -> Q<D>
where
    D: Dimension<Kind = dyn uom::Kind> + ?Sized,
{
    (f(1.0) - f(-1.0)) * (2.0 / 3.0) - (f(2.0) - f(-2.0)) * (1.0 / 12.0)
}

#[track_caller]
fn close<D: Dimension + ?Sized>(found: Q<D>, expected: Q<D>, tolerance: Q<D>) {
    let error = (found.value - expected.value).abs();
    assert!(error <= tolerance.value, "{} against {}: off by {error:e}", found.value, expected.value);
}

// Section 2: materials and winding.

/// Energy per volume of a neo-Hookean wall.
fn eq_2_neo_hookean(mu1: Pressure, i1: Ratio) -> Pressure {
    mu1 / 2.0 * (i1 - 3.0 * ONE)
}

fn yeoh(c: [Pressure; 3], i1: Ratio) -> Pressure {
    let j = i1 - 3.0 * ONE;
    c[0] * j + c[1] * j * j + c[2] * j * j * j
}

fn yeoh_slope(c: [Pressure; 3], i1: Ratio) -> Pressure {
    let j = i1 - 3.0 * ONE;
    c[0] + 2.0 * c[1] * j + 3.0 * c[2] * j * j
}

/// Energy per volume of one fiber family.
fn eq_3_fiber(mu2: Pressure, i4: Ratio) -> Pressure {
    mu2 / 2.0 * (i4 - ONE) * (i4 - ONE)
}

/// Energy per area of one family in a sheet.
fn sheet_energy(thickness: Length, mu2: Pressure, i4: Ratio) -> ForcePerLength {
    thickness * eq_3_fiber(mu2, i4)
}

/// `4 mu2 thickness = E A/p`: tension per width and strain of threads `p` apart.
fn thread_to_sheet(thread_modulus: Pressure, thread_area: Area, spacing: Length) -> ForcePerLength {
    thread_modulus * thread_area / spacing
}

/// (4): energy per volume of the elastomer, by its law.
fn elastomer_energy(material: &Material<f64>, i1: Ratio) -> Pressure {
    match *material {
        Material::NeoHookean { shear_modulus_pa } => eq_2_neo_hookean(pa(shear_modulus_pa), i1),
        Material::Yeoh { c_pa } => yeoh(c_pa.map(pa), i1),
    }
}

/// `2 W'`, the modulus in the stresses.
fn elastomer_modulus(material: &Material<f64>, i1: Ratio) -> Pressure {
    match *material {
        Material::NeoHookean { shear_modulus_pa } => pa(shear_modulus_pa),
        Material::Yeoh { c_pa } => 2.0 * yeoh_slope(c_pa.map(pa), i1),
    }
}

/// `I1 = tr F F^T`.
fn i1(f: &Tensor) -> Ratio {
    f.iter().flatten().fold(0.0 * ONE, |sum, &entry| sum + entry * entry)
}

/// `I4 = |F S|^2`, `S = (0, cos a, sin a)`.
fn i4(f: &Tensor, angle: Angle) -> Ratio {
    f.iter().map(|row| row[1] * angle.cos() + row[2] * angle.sin()).fold(0.0 * ONE, |sum, s| sum + s * s)
}

// Section 3: extension, expansion and twisting.

/// A tube in a shape `l`, `V`, `Phi`.
#[derive(Clone, Copy)]
struct Tube<'a> {
    p: &'a ActuatorParameters<f64>,
    length: Length,
    volume: Volume,
    twist: Angle,
}

impl<'a> Tube<'a> {
    fn at(p: &'a ActuatorParameters<f64>, state: &State<f64>) -> Self {
        let length = m(p.length_m) * state.axial_stretch;
        Self {
            p,
            length,
            volume: PI * m(state.inner_radius_m) * m(state.inner_radius_m) * length,
            twist: rad(state.twist_rad),
        }
    }

    fn stretch(&self) -> Ratio {
        self.length / m(self.p.length_m)
    }

    fn tau(&self) -> ReciprocalLength {
        self.twist / m(self.p.length_m)
    }

    fn mu2(&self) -> Pressure {
        pa(self.p.fiber.map_or(0.0, |fiber| fiber.modulus_pa))
    }

    /// Winding radius and thickness of a sheet.
    fn sheet(&self) -> Option<(Length, Length)> {
        let fiber = self.p.fiber.filter(|fiber| fiber.placement == Placement::Sheet)?;
        Some((m(fiber.radius_m), m(fiber.thickness_m)))
    }

    /// Signed angles of the fiber families.
    fn fiber_angles(&self) -> Vec<Angle> {
        let two = |fiber: Fiber<f64>| (fiber.families == Families::Two).then_some(rad(-fiber.angle_rad));
        self.p.fiber.map_or(vec![], |fiber| [Some(rad(fiber.angle_rad)), two(fiber)].into_iter().flatten().collect())
    }

    /// `r^2 = r_i^2 + (R^2 - R_i^2)/lambda`, with `V = pi r_i^2 l`.
    fn eq_1_radius(&self, radius: Length) -> Length {
        let inner = m(self.p.inner_radius_m);
        let inner_deformed_square: Area = self.volume / (PI * self.length);
        (inner_deformed_square + (radius * radius - inner * inner) / self.stretch()).sqrt()
    }

    fn eq_1_gradient(&self, radius: Length) -> Tensor {
        let (r, lambda, zero) = (self.eq_1_radius(radius), self.stretch(), 0.0 * ONE);
        [[radius / (r * lambda), zero, zero], [zero, r / radius, r * self.tau()], [zero, zero, lambda]]
    }

    /// (8) and its neighbours, elastomer: `s_tt - s_rr`, `s_zz - s_rr`, `s_tz`.
    fn eq_8_elastomer(&self, radius: Length) -> [Pressure; 3] {
        let (r, lambda, tau) = (self.eq_1_radius(radius), self.stretch(), self.tau());
        let modulus = elastomer_modulus(&self.p.material, i1(&self.eq_1_gradient(radius)));
        let radial: Ratio = radius * radius / (r * r * lambda * lambda);
        let hoop: Ratio = r * r / (radius * radius) + r * r * tau * tau;
        [modulus * (hoop - radial), modulus * (lambda * lambda - radial), modulus * (r * tau * lambda)]
    }

    /// The same of the fibers.
    fn eq_8_fibers(&self, radius: Length) -> [Pressure; 3] {
        let (r, lambda) = (self.eq_1_radius(radius), self.stretch());
        self.fiber_angles().iter().fold([pa(0.0); 3], |sum, angle| {
            let hoop: Ratio = angle.cos() * r / radius + angle.sin() * (r * self.tau());
            let axial: Ratio = angle.sin() * lambda;
            let stress = 2.0 * self.mu2() * (hoop * hoop + axial * axial - ONE);
            [sum[0] + stress * hoop * hoop, sum[1] + stress * axial * axial, sum[2] + stress * hoop * axial]
        })
    }

    /// Sum of `f(R, dR, stresses)` over the wall; a sheet is one layer of its thickness.
    fn integral<D>(&self, f: impl Fn(Length, Length, [Pressure; 3]) -> Q<D>) -> Q<D>
    where
        D: Dimension<Kind = dyn uom::Kind> + ?Sized,
    {
        let (inner, width) = (m(self.p.inner_radius_m), m(self.p.outer_radius_m - self.p.inner_radius_m));
        let wall = mean(PANELS, |share| {
            let radius = inner + width * share;
            let (mut stress, fibers) = (self.eq_8_elastomer(radius), self.eq_8_fibers(radius));
            if self.sheet().is_none() {
                stress = [0, 1, 2].map(|i| stress[i] + fibers[i]);
            }
            f(radius, width, stress)
        });
        self.sheet().map_or(wall, |(radius, thickness)| wall + f(radius, thickness, self.eq_8_fibers(radius)))
    }

    /// `P = int (s_tt - s_rr) R dR/(R^2 - R_i^2 + lambda r_i^2)`.
    fn eq_7_pressure(&self) -> Pressure {
        let inner = m(self.p.inner_radius_m);
        let inner_deformed = self.eq_1_radius(inner);
        let offset: Area = self.stretch() * inner_deformed * inner_deformed - inner * inner;
        self.integral(|radius, dr, [hoop, _, _]| hoop * radius * dr / (radius * radius + offset))
    }

    /// `N_ext = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr`, with `r dr = R dR/lambda`.
    fn eq_9_force(&self) -> Force {
        self.integral(|radius, dr, [hoop, axial, _]| PI * (2.0 * axial - hoop) * radius * dr / self.stretch())
    }

    /// `M_ext = 2 pi int s_tz r^2 dr`.
    fn torque(&self) -> Torque {
        let moment: Energy = self.integral(|radius, dr, [_, _, shear]| {
            TAU * shear * self.eq_1_radius(radius) * radius * dr / self.stretch()
        });
        moment.into()
    }

    /// `U = L int 2 pi R W dR`, with the energy per area of a sheet.
    fn energy(&self) -> Energy {
        let (inner, width) = (m(self.p.inner_radius_m), m(self.p.outer_radius_m - self.p.inner_radius_m));
        let length = m(self.p.length_m);
        let sum = |f: Tensor, energy: &dyn Fn(Ratio) -> Pressure| {
            self.fiber_angles().iter().fold(pa(0.0), |sum, &angle| sum + energy(i4(&f, angle)))
        };
        let wall: Energy = mean(PANELS, |share| {
            let radius = inner + width * share;
            let f = self.eq_1_gradient(radius);
            let fibers = sum(f, &|i4| eq_3_fiber(self.mu2(), i4));
            let smeared = if self.sheet().is_none() { fibers } else { pa(0.0) };
            TAU * radius * width * length * (elastomer_energy(&self.p.material, i1(&f)) + smeared)
        });
        let Some((radius, thickness)) = self.sheet() else { return wall };
        let f = self.eq_1_gradient(radius);
        let area: Area = TAU * radius * length;
        self.fiber_angles().iter().fold(wall, |sum, &a| sum + area * sheet_energy(thickness, self.mu2(), i4(&f, a)))
    }

    /// `P = dU/dV`, `N_ext = dU/dl`, `M_ext = dU/dPhi`.
    fn energy_gradient(&self) -> (Pressure, Force, Torque) {
        let (volume, length, twist) = (self.volume * STEP, self.length * STEP, rad(STEP));
        let pressure = change(|k| Self { volume: self.volume + volume * k, ..*self }.energy()) / volume;
        let force = change(|k| Self { length: self.length + length * k, ..*self }.energy()) / length;
        let torque: Energy = change(|k| Self { twist: self.twist + twist * k, ..*self }.energy()) / twist;
        (pressure, force, torque.into())
    }
}

/// Strains of section 3 from rest: `e = lambda - 1`, `w = V/V_0 - 1`, `g = tau R_i`, at `X = (R/R_i)^2`.
#[derive(Clone, Copy)]
struct Strains {
    e: Ratio,
    w: Ratio,
    g: Ratio,
}

impl Strains {
    fn of(tube: &Tube) -> Self {
        let inner = m(tube.p.inner_radius_m);
        let at_rest: Volume = PI * inner * inner * m(tube.p.length_m);
        Self { e: tube.stretch() - ONE, w: tube.volume / at_rest - ONE, g: tube.tau() * inner }
    }

    fn eta(&self, x: Ratio) -> Ratio {
        (self.w / x - self.e) / (ONE + self.e)
    }

    fn eps(&self) -> Ratio {
        self.e * (2.0 * ONE + self.e)
    }

    /// `I1-3`.
    fn i1(&self, x: Ratio) -> Ratio {
        let (eta, eps) = (self.eta(x), self.eps());
        let (p, q) = (ONE + eta, ONE + eps);
        (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / (p * q) + self.g * self.g * x * p
    }

    /// `I4-1`.
    fn i4(&self, x: Ratio, angle: Angle) -> Ratio {
        let (c, s, rho) = (angle.cos(), angle.sin(), x.sqrt());
        let turn = self.g * rho * s;
        c * c * self.eta(x) + (ONE + self.eta(x)) * turn * (2.0 * c + turn) + s * s * self.eps()
    }

    /// The closed form `u, u_e, u_w, u_g` of a neo-Hookean wall up to `X_o`.
    fn neo_hookean(&self, x_outer: Ratio) -> [Ratio; 4] {
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

// Section 4: inextensible fibers.

/// `w = X_f [e - s^2 e (3+3e+e^2)]/c^2`, from `lambda^2 s^2 + (r_f/R_f)^2 c^2 = 1`.
fn inextensible_volume(x_fiber: Ratio, e: Ratio, angle: Angle) -> Ratio {
    let (c, s) = (angle.cos(), angle.sin());
    x_fiber * (e - s * s * e * (3.0 * ONE + 3.0 * e + e * e)) / (c * c)
}

/// `dV/dl = pi R_f^2 (1 - 2 tan^2 a)` at rest.
fn eq_17_lever_of_length(winding: Length, angle: Angle) -> Area {
    PI * winding * winding * (ONE - 2.0 * angle.tan() * angle.tan())
}

/// `dV/dPhi = -2 pi R_f^3 tan a` at rest.
fn eq_17_lever_of_twist(winding: Length, angle: Angle) -> Volume {
    -TAU * winding * winding * winding * angle.tan()
}

// Section 5: bending.

/// A section bent with a curvature.
#[derive(Clone, Copy)]
struct Section {
    inner: Length,
    outer: Length,
    winding: Length,
    mu1: Pressure,
    curvature: ReciprocalLength,
}

impl Section {
    /// `(1 + kappa R_o)(R_f^2 - r^2)/2 - kappa cos(phi_c)(R_f^3 - r^3)/3 = (R_f^2 - R^2)/2`, by Newton's method.
    fn eq_1_radius(&self, radius: Length, around: Angle) -> Length {
        let (f, k) = (self.winding, self.curvature);
        (0..30).fold(radius, |r, _| {
            let excess: Area = (ONE + k * self.outer) * (f * f - r * r) / 2.0
                - k * around.cos() * (f * f * f - r * r * r) / 3.0
                - (f * f - radius * radius) / 2.0;
            r + excess / (r * self.eq_12_stretch(r, around))
        })
    }

    /// Corrected (12): `lambda = 1 + kappa (R_o - r cos phi_c)`.
    fn eq_12_stretch(&self, r: Length, around: Angle) -> Ratio {
        ONE + self.curvature * (self.outer - r * around.cos())
    }

    /// `dr/dphi_c = kappa sin(phi_c)(R_f^3 - r^3)/(3 r lambda)`.
    fn lean(&self, r: Length, around: Angle) -> Length {
        let reach: Volume = self.winding * self.winding * self.winding - r * r * r;
        self.curvature * around.sin() * reach / (3.0 * r * self.eq_12_stretch(r, around))
    }

    fn eq_1_gradient(&self, radius: Length, around: Angle) -> Tensor {
        let (r, zero) = (self.eq_1_radius(radius, around), 0.0 * ONE);
        let lambda = self.eq_12_stretch(r, around);
        [[radius / (r * lambda), self.lean(r, around) / radius, zero], [zero, r / radius, zero], [zero, zero, lambda]]
    }

    /// `U/L`, energy per length, from both halves of the section.
    fn energy_per_length(&self) -> Force {
        let width = self.outer - self.inner;
        mean(PANELS / 4, |share| {
            let radius = self.inner + width * share;
            let around: Pressure =
                mean(PANELS / 4, |turn| eq_2_neo_hookean(self.mu1, i1(&self.eq_1_gradient(radius, rad(PI * turn)))));
            TAU * radius * width * around
        })
    }

    /// `dU/dkappa` per length, in place of (11).
    fn eq_11_moment(&self) -> Torque {
        let step: ReciprocalLength = ONE * STEP / self.outer;
        let moment: Energy =
            change(|k| Self { curvature: self.curvature + step * k, ..*self }.energy_per_length()) / step;
        moment.into()
    }

    /// `P pi R_f^2 R_o + M_ext + N_ext R_o`, in place of (10).
    fn eq_10_moment(&self, pressure: Pressure, force: Force, torque: Torque) -> Torque {
        let work: Energy = PI * pressure * self.winding * self.winding * self.outer + force * self.outer;
        Torque::from(work) + torque
    }

    /// `V/L = pi R_f^2 (1 + kappa R_o)` less the wall within the winding.
    fn lumen(&self) -> Area {
        let (f, i) = (self.winding, self.inner);
        PI * f * f * (ONE + self.curvature * self.outer) - PI * (f * f - i * i)
    }
}

// Section 6: bundles.

/// `sqrt((lambda L)^2 - (d Phi)^2)`, the length of a bundle of helices.
fn twisted_length(length: Length, circle: Length, twist: Angle) -> Length {
    let around: Length = circle * twist;
    (length * length - around * around).sqrt()
}

/// End of an arc: `(l/phi)(1 - cos phi)` aside and `(l/phi) sin phi` along.
fn arc_end(length: Length, bend: Angle) -> [Length; 2] {
    let radius: Length = length / bend;
    [radius * (ONE - bend.cos()), radius * bend.sin()]
}

// The paper's equations as printed.

/// (10): `2 P int [R_i (1 - cos phi) + b] R_i^2 sin^2 phi dphi`.
fn eq_10_printed(pressure: Pressure, inner: Length, wall: Length) -> Energy {
    2.0 * PI * pressure * eq_13_denominator(inner, wall)
}

fn eq_13_denominator(inner: Length, wall: Length) -> Volume {
    mean(PANELS, |turn| {
        let around = rad(PI * turn);
        (inner * (ONE - around.cos()) + wall) * inner * inner * around.sin() * around.sin()
    })
}

/// (11) with (12), its factor `L` aside: `2 int int s_zz/lambda (R_i + t)(R_i + b - (R_i + t) cos phi) dphi dt`.
fn eq_11_printed_without_length(mu: Pressure, inner: Length, wall: Length, curvature: ReciprocalLength) -> Energy {
    mean(PANELS, |share| {
        let radius = inner + wall * share;
        let stretch: Ratio = ONE + curvature * wall * (1.0 - share);
        let stress: Pressure = mu * (stretch * stretch - ONE / (stretch * stretch));
        let arm: Length = mean(PANELS, |turn| inner + wall - radius * rad(PI * turn).cos());
        TAU * stress / stretch * radius * arm * wall
    })
}

// The tests.

/// One stiff family that twists, under force and torque; two soft families smeared through a Yeoh wall.
fn examples() -> [(ActuatorParameters<f64>, f64, Load<f64>); 2] {
    let sheet = tube(Motion::Twisting, 10.0, 14.0, neo_hookean(0.22e6));
    let sheet = wound(sheet, 28.0, Families::One, 361e6, Placement::Sheet, 0.178);
    let smeared = tube(Motion::Extension, 6.0, 8.0, DRAGONSKIN_30);
    let smeared = wound(smeared, 20.0, Families::Two, 1e6, Placement::Smeared, 0.0);
    [(sheet, 30e3, Load { force_n: 3.0, torque_nm: 0.01 }), (smeared, 24e3, Load { force_n: -0.5, torque_nm: 0.004 })]
}

fn solved(p: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>) -> State<f64> {
    let solution = solve_loaded(p, pressure_pa, load);
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    solution.state
}

/// What a solved state has to balance, against what was applied.
#[track_caller]
fn balanced(p: &ActuatorParameters<f64>, applied: (f64, Load<f64>), found: (Pressure, Force, Torque)) {
    let (pressure_pa, Load { force_n, torque_nm }) = applied;
    // A share of the shear modulus; over the section; over the section at its radius. Differences of the energy of a stiff sheet
    // leave a tenth of it, the integrals less.
    let (pressure, outer) = (pa(p.material.shear_modulus_pa()) * 2e-9, m(p.outer_radius_m));
    let force: Force = PI * outer * outer * pressure;
    close(found.0, pa(pressure_pa), pressure);
    close(found.1, Force::new::<newton>(force_n), force);
    close(found.2, Torque::new::<newton_meter>(torque_nm), Torque::from(force * outer));
}

#[test]
fn pressure_force_and_torque_are_integrals_of_the_stresses() {
    for (p, pressure_pa, load) in examples() {
        let shape = solved(&p, pressure_pa, load);
        let tube = Tube::at(&p, &shape);
        balanced(&p, (pressure_pa, load), (tube.eq_7_pressure(), tube.eq_9_force(), tube.torque()));
    }
}

#[test]
fn pressure_force_and_torque_are_the_gradient_of_the_energy() {
    for (p, pressure_pa, load) in examples() {
        let shape = solved(&p, pressure_pa, load);
        balanced(&p, (pressure_pa, load), Tube::at(&p, &shape).energy_gradient());
    }
}

#[test]
fn radii_volume_and_compliance_are_those_of_the_radius_map() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let tube = Tube::at(&p, &state);
        close(tube.eq_1_radius(m(p.outer_radius_m)), m(state.outer_radius_m), m(1e-15));
        close(tube.volume, Volume::new::<cubic_meter>(state.volume_m3), tube.volume * 1e-13);
        let step = pa(10.0);
        let volume = |k: f64| Tube::at(&p, &solved(&p, pressure_pa + k * step.get::<pascal>(), load)).volume;
        let compliance = change(volume) / step;
        let expected = Volume::new::<cubic_meter>(state.compliance_m3_per_pa) / pa(1.0);
        close(compliance, expected, expected * 1e-7);
    }
}

/// At rest and in tension along its axial threads a tube is as stiff as rubber (`3 mu1` over the wall) and threads together.
#[test]
fn a_winding_of_threads_has_the_stiffness_of_its_threads() {
    let (radius, modulus, spacing) = (m(0.0889e-3), pa(31.067e9), m(3e-3));
    let tension = thread_to_sheet(modulus, PI * radius * radius, spacing);
    let thickness = m(0.178e-3);
    let mu2: Pressure = tension / (4.0 * thickness);
    let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
    let p = wound(p, 90.0, Families::One, mu2.get::<pascal>(), Placement::Sheet, 1e3 * thickness.get::<meter>());
    let (inner, outer, length) = (m(p.inner_radius_m), m(p.outer_radius_m), m(p.length_m));
    let wall: Force = 3.0 * pa(0.2e6) * PI * (outer * outer - inner * inner);
    let threads: Force = tension * TAU * outer;
    let expected: ForcePerLength = (wall + threads) / length;
    let held = Actuator::new(&p).unwrap().held(0.0, 1.0, 0.0).unwrap();
    let found: ForcePerLength = Force::new::<newton>(held.stiffness[0][0]) / m(1.0);
    close(found, expected, wall / length * 1e-9);
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
fn the_closed_form_of_a_bare_wall_has_the_units_of_the_model() {
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
fn the_tension_of_a_sheet_is_what_the_elastomer_leaves_of_the_force() {
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
fn a_stiff_winding_keeps_its_length_and_gives_the_pressure_its_lever() {
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
    let by_pressure = |families| Actuator::new(&stiff(families)).unwrap().held(0.0, 1.0, 0.0).unwrap().by_pressure;
    let [push, turn] = [by_pressure(Families::Two)[0], by_pressure(Families::One)[1]];
    let (length, twist) = (eq_17_lever_of_length(winding, angle), eq_17_lever_of_twist(winding, angle));
    close(-Area::new::<square_meter>(push), length, length * softness * 10.0);
    close(-Volume::new::<cubic_meter>(turn), twist, twist.abs() * softness * 10.0);
}

/// 6/8 mm, wound within its wall, 100 mm long, and its section at a bend.
fn bender(bend_angle_rad: f64) -> (ActuatorParameters<f64>, Section) {
    let mut p =
        wound(tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6)), 0.0, Families::Two, 1e6, Placement::Sheet, 0.2);
    p.fiber.as_mut().unwrap().radius_m = 7.5e-3;
    let [inner, outer, winding] = [6e-3, 8e-3, 7.5e-3].map(m);
    (p, Section { inner, outer, winding, mu1: pa(0.2e6), curvature: rad(bend_angle_rad) / m(p.length_m) })
}

#[test]
fn the_map_of_a_bent_section_has_the_gradient_stated() {
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
fn a_bend_balances_the_work_of_pressure_force_and_moment() {
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
fn a_bundle_shortens_by_its_helices_and_bends_into_an_arc() {
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

/// (10) is a moment, (11) a moment times the length, (13) a pressure times the length. At a given curvature every piece of an
/// actuator needs the same pressure; printed, a piece twice as long needs twice as much. Without the factor the dimension is right
/// and the bend is not: (12) makes it more than six times too large.
#[test]
fn eq_11_and_13_printed_have_a_length_too_many() {
    let (inner, wall, mu) = (m(6e-3), m(2e-3), pa(0.2e6));
    let curvature = rad(0.7) / m(0.1);
    let pressures = [m(0.1), m(0.2)].map(|length| {
        let mut p = tube(Motion::Bending, 6.0, 8.0, neo_hookean(mu.get::<pascal>()));
        p.length_m = length.get::<meter>();
        let target = Target::BendAngle(Angle::from(curvature * length).get::<radian>());
        let pressure = pa(Actuator::new(&p).unwrap().inverse(target, &Load::none()).unwrap().state.pressure_pa);
        let moment: Mechanical<P3> = eq_11_printed_without_length(mu, inner, wall, curvature) * length;
        let printed: ForcePerLength = moment / (2.0 * PI * eq_13_denominator(inner, wall));
        (pressure, printed)
    });
    let [(once, printed_once), (twice, printed_twice)] = pressures;
    close(twice, once, once * 1e-12);
    close(printed_twice, 2.0 * printed_once, printed_once * 1e-12);

    let cap: Energy = eq_10_printed(once, inner, wall);
    close(cap, PI * once * inner * inner * (inner + wall), cap * 1e-12);
    assert!(eq_11_printed_without_length(mu, inner, wall, 6.0 * curvature) < cap);
}

/// (14) with weights that are numbers: lengths and angles off their goals, as numbers in some unit.
fn eq_14_printed(length_off: f64, bend_off: f64) -> f64 {
    length_off * length_off + bend_off * bend_off
}

/// Of two designs, one with an error in length and one in bend, the first is better in meters and the second in millimeters. Weights
/// that carry units settle it: 1 mm is as bad as 0.01 rad.
#[test]
fn eq_14_printed_prefers_another_design_in_another_unit() {
    let designs = [(m(4e-3), rad(0.0)), (m(0.0), rad(0.1))];
    let [long, bent] = designs.map(|(off, bend)| eq_14_printed(off.get::<meter>(), bend.get::<radian>()));
    assert!(long < bent);
    let [long, bent] = designs.map(|(off, bend)| eq_14_printed(off.get::<millimeter>(), bend.get::<radian>()));
    assert!(long > bent);

    let [long, bent] = designs.map(|(off, bend)| {
        let (length_square, bend_square): (Area, Ratio) = (off * off, bend * bend);
        length_square / (m(1e-3) * m(1e-3)) + bend_square / (rad(0.01) * rad(0.01))
    });
    close(long, 16.0 * ONE, 1e-12 * ONE);
    close(bent, 100.0 * ONE, 1e-12 * ONE);
}

/// (18): a wrench off its goal, squared: the force in N, the moment in N times some unit of length.
fn eq_18_printed(force_off: f64, moment_off: f64) -> f64 {
    force_off * force_off + moment_off * moment_off
}

/// As for (14). A length that compares moments with forces settles it: here 1 N m at an arm of 0.1 m is as bad as 10 N.
#[test]
fn eq_18_printed_prefers_another_design_in_another_unit() {
    let designs = [(0.5, 0.0), (0.0, 0.1)].map(|(f, t)| (Force::new::<newton>(f), Torque::new::<newton_meter>(t)));
    let [pulled, turned] = designs.map(|(f, t)| eq_18_printed(f.get::<newton>(), t.get::<newton_meter>()));
    assert!(pulled > turned);
    let [pulled, turned] = designs.map(|(f, t)| eq_18_printed(f.get::<newton>(), t.get::<newton_millimeter>()));
    assert!(pulled < turned);

    let [pulled, turned] = designs.map(|(f, t)| {
        let (force_square, moment_square): (Squared<P2>, Squared<P4>) = (f * f, t * t);
        force_square + moment_square / (m(0.1) * m(0.1))
    });
    let unit = Force::new::<newton>(1.0) * Force::new::<newton>(1.0);
    close(pulled, 0.25 * unit, 1e-12 * unit);
    close(turned, 1.0 * unit, 1e-12 * unit);
}
