//! The energy model against the equilibrium of stresses, in the textbook form and with its own quadrature.
//!
//! Wall: `P = int (s_tt - s_rr) dr/r`, `N = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr`, `M = 2 pi int s_tz r^2 dr`.
//! A sheet is a membrane with resultants `N_ij = s_ij t R/(r lambda)`: it adds `N_tt/r`, `pi r (2 N_zz - N_tt)`, `2 pi r^2 N_tz`.

mod common;

use common::*;
use fra_model::*;

struct Resultants {
    pressure_pa: f64,
    force_n: f64,
    torque_nm: f64,
}

/// Stress differences `(tt - rr, zz - rr, tz)` of the elastomer.
fn elastomer_stress(material: &Material<f64>, h: f64, lambda: f64, r_tau: f64) -> [f64; 3] {
    let radial = 1.0 / (h * lambda).powi(2);
    let i1 = radial + h * h + r_tau * r_tau + lambda * lambda;
    let modulus = match *material {
        Material::NeoHookean { shear_modulus_pa } => shear_modulus_pa,
        Material::Yeoh { c_pa: [c1, c2, c3] } => {
            2.0 * (c1 + 2.0 * c2 * (i1 - 3.0) + 3.0 * c3 * (i1 - 3.0) * (i1 - 3.0))
        }
    };
    [modulus * (h * h + r_tau * r_tau - radial), modulus * (lambda * lambda - radial), modulus * r_tau * lambda]
}

fn fiber_stress(fiber: &Fiber<f64>, h: f64, lambda: f64, r_tau: f64) -> [f64; 3] {
    let signs: &[f64] = if fiber.families == Families::Two { &[1.0, -1.0] } else { &[1.0] };
    let mut sum = [0.0; 3];
    for sign in signs {
        let (c, s) = (sign * fiber.angle_rad.cos(), fiber.angle_rad.sin());
        let (hoop, axial) = (c * h + s * r_tau, s * lambda);
        let stress = 2.0 * fiber.modulus_pa * (hoop * hoop + axial * axial - 1.0);
        sum[0] += stress * hoop * hoop;
        sum[1] += stress * axial * axial;
        sum[2] += stress * hoop * axial;
    }
    sum
}

/// Composite Simpson from `a` to `b`.
fn simpson(a: f64, b: f64, f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let n = 4000;
    let step = (b - a) / f64::from(n);
    let mut sum = [0.0; 3];
    for i in 0..=n {
        let weight = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        let value = f(a + step * f64::from(i));
        for (total, v) in sum.iter_mut().zip(value) {
            *total += v * weight * step / 3.0;
        }
    }
    sum
}

fn resultants(p: &ActuatorParameters<f64>, state: &State<f64>) -> Resultants {
    let lambda = state.axial_stretch;
    let tau = state.twist_rad / p.length_m;
    let inner = p.inner_radius_m;
    let deformed = |radius: f64| (state.inner_radius_m.powi(2) + (radius * radius - inner * inner) / lambda).sqrt();
    let integrand = |radius: f64, stress: [f64; 3]| {
        let r = deformed(radius);
        let dr = radius / (lambda * r);
        let pi = std::f64::consts::PI;
        let [hoop, axial, shear] = stress;
        [hoop / r * dr, pi * (2.0 * axial - hoop) * r * dr, 2.0 * pi * shear * r * r * dr]
    };
    let wall = simpson(inner, p.outer_radius_m, |radius| {
        let r = deformed(radius);
        integrand(radius, elastomer_stress(&p.material, r / radius, lambda, r * tau))
    });
    let winding = p.fiber.map_or([0.0; 3], |fiber| {
        let smeared = |from: f64| {
            simpson(from, p.outer_radius_m, |radius| {
                let r = deformed(radius);
                integrand(radius, fiber_stress(&fiber, r / radius, lambda, r * tau))
            })
        };
        match fiber.placement {
            Placement::Smeared => smeared(inner),
            Placement::Layer => smeared(fiber.radius_m),
            Placement::Sheet => {
                let r = deformed(fiber.radius_m);
                let thickness = fiber.thickness_m * fiber.radius_m / (r * lambda);
                let [tt, zz, tz] = fiber_stress(&fiber, r / fiber.radius_m, lambda, r * tau).map(|s| s * thickness);
                let pi = std::f64::consts::PI;
                [tt / r, pi * r * (2.0 * zz - tt), 2.0 * pi * r * r * tz]
            }
        }
    });
    Resultants { pressure_pa: wall[0] + winding[0], force_n: wall[1] + winding[1], torque_nm: wall[2] + winding[2] }
}

/// Solves and compares all three resultants with what was applied.
fn check(p: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>) {
    let solution = solve_loaded(p, pressure_pa, load);
    assert_eq!(solution.status, Status::Solved, "{p:?} at {pressure_pa} Pa: {solution:?}");
    let found = resultants(p, &solution.state);
    let area = std::f64::consts::PI * p.outer_radius_m.powi(2);
    let stiffness = p.fiber.map_or(1.0, |f| 1.0 + f.modulus_pa / p.material.shear_modulus_pa());
    let scale = p.material.shear_modulus_pa() * (1.0 + 1e-3 * stiffness);
    assert!((found.pressure_pa - pressure_pa).abs() < 1e-9 * scale, "P: {} {pressure_pa} {p:?}", found.pressure_pa);
    assert!((found.force_n - load.force_n).abs() < 1e-9 * scale * area, "N: {} {p:?}", found.force_n);
    let torque_scale = scale * area * p.outer_radius_m;
    assert!((found.torque_nm - load.torque_nm).abs() < 1e-9 * torque_scale, "M: {} {p:?}", found.torque_nm);
}

#[test]
fn every_placement_family_and_law_balances_the_stresses() {
    for material in [neo_hookean(0.2e6), DRAGONSKIN_30] {
        for placement in [Placement::Sheet, Placement::Layer, Placement::Smeared] {
            for families in [Families::One, Families::Two] {
                for angle_deg in [0.0, 3.0, 20.0, 35.0, 50.0, 80.0, 90.0] {
                    for modulus_pa in [0.1e6, 1e6, 50e6] {
                        let p = tube(Motion::Extension, 6.0, 8.0, material);
                        let p = wound(p, angle_deg, families, modulus_pa, placement, 0.2);
                        for pressure_pa in [-20e3, 1.0, 10e3, 24e3] {
                            check(&p, pressure_pa, Load::none());
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn external_force_and_torque_are_balanced() {
    for families in [Families::One, Families::Two] {
        let p = tube(Motion::Twisting, 10.0, 14.0, neo_hookean(0.22e6));
        let p = wound(p, 28.0, families, 361e6, Placement::Sheet, 0.178);
        for (force_n, torque_nm) in [(5.0, 0.0), (-5.0, 0.0), (0.0, 0.02), (0.0, -0.02), (3.0, 0.01)] {
            check(&p, 30e3, Load { force_n, torque_nm });
        }
    }
}

#[test]
fn a_bare_tube_balances_below_its_limit() {
    let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
    for pressure_pa in [-60e3, -1.0, 1e-3, 20e3, 40e3, 43e3] {
        check(&p, pressure_pa, Load::none());
    }
}
