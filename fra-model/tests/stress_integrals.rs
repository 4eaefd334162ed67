//! The energy model against the equilibrium of stresses.

use crate::common::stresses::resultants;
use crate::common::*;
use fra_model::*;

/// Solves and compares all three resultants with what was applied.
fn check(p: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>) {
    let solution = solve_loaded(p, pressure_pa, load);
    assert_eq!(solution.status, Status::Solved, "{p:?} at {pressure_pa} Pa: {solution:?}");
    let state = solution.state;
    let found = resultants(p, [state.axial_stretch, state.inner_radius_m, state.twist_rad]);
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
