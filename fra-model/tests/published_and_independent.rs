//! Equilibria, limit pressures and bends computed by independent programs.
//!
//! Straight tube: Cauchy stress differences of the wall and the winding integrated to `P`, `N` and `M` with 48 Gauss nodes in
//! 64-bit-mantissa arithmetic, tangents by complex differentiation, the branch followed from rest by pseudo-arclength steps (load
//! first, then pressure) and limit points located as zeros of the tangent's pressure component. Bending: the section's energy by
//! 48 x 128 nodes on the isochoric map, its derivative by a complex step. Neither uses the energy's derivatives of this crate.

use crate::common::*;
use fra_model::*;

/// What the stress program found; lengths in m, angles in rad.
struct Found {
    axial_stretch: f64,
    inner_radius_m: f64,
    outer_radius_m: f64,
    twist_rad: f64,
}

/// A tube of length 100 mm whose winding, unlike that of the other tests, may lie at any radius.
fn actuator(radii_mm: (f64, f64), material: Material<f64>, fiber: Option<Fiber<f64>>) -> ActuatorParameters<f64> {
    ActuatorParameters { fiber, ..tube(Motion::Extension, radii_mm.0, radii_mm.1, material) }
}

fn fiber(angle_deg: f64, families: Families, modulus_pa: f64, place: (Placement, f64)) -> Option<Fiber<f64>> {
    let (placement, radius_mm) = place;
    let angle_rad = angle_deg.to_radians();
    Some(Fiber { angle_rad, families, modulus_pa, placement, thickness_m: 0.178 * MM, radius_m: radius_mm * MM })
}

fn load(force_n: f64, torque_nm: f64) -> Load<f64> {
    Load { force_n, torque_nm }
}

type Case = (ActuatorParameters<f64>, f64, Load<f64>, Found);

fn cases() -> Vec<Case> {
    let found = |axial_stretch, inner_radius_m, outer_radius_m, twist_rad| Found {
        axial_stretch,
        inner_radius_m,
        outer_radius_m,
        twist_rad,
    };
    let (soft, firm) = (neo_hookean(0.2e6), neo_hookean(0.2226e6));
    let thread = |radius_mm| (Placement::Sheet, radius_mm);
    let layer = |radius_mm| (Placement::Layer, radius_mm);
    let smeared = (Placement::Smeared, 8.0);
    use Families::{One, Two};
    vec![
        (
            actuator((6.0, 8.0), soft, None),
            20e3,
            load(0.0, 0.0),
            found(1.00758416808274, 0.00686470133311201, 0.00865525078277539, 0.0),
        ),
        (
            actuator((6.0, 8.0), soft, None),
            -30e3,
            load(2.0, 0.01),
            found(1.04859139283891, 0.00504517500214035, 0.00722193046737499, 1.46478545256552),
        ),
        (
            actuator((6.0, 8.0), firm, fiber(3.0, Two, 361e6, thread(8.0))),
            60e3,
            load(0.0, 0.0),
            found(1.16966589253233, 0.0063319929429134, 0.00800203689529855, 0.0),
        ),
        (
            actuator((6.0, 8.0), firm, fiber(3.0, Two, 361e6, thread(8.0))),
            100e3,
            load(-5.0, 0.0),
            found(1.22903380171394, 0.0064281308171884, 0.0080064342512626, 0.0),
        ),
        (
            actuator((6.0, 8.0), DRAGONSKIN_30, fiber(30.0, One, 361e6, thread(7.5))),
            50e3,
            load(3.0, -0.02),
            found(1.13567485589809, 0.00782517130388136, 0.00926759137843548, -4.55614222354878),
        ),
        (
            actuator((6.0, 8.0), DRAGONSKIN_30, fiber(-40.0, One, 20e6, layer(7.0))),
            -20e3,
            load(0.0, 0.01),
            found(1.01624814493907, 0.00556947256082861, 0.00765319217206417, -0.578836639527453),
        ),
        (
            actuator((6.0, 9.0), DRAGONSKIN_30, fiber(25.0, One, 1e6, smeared)),
            40e3,
            load(0.0, 0.0),
            found(1.03164917729786, 0.0065842168786434, 0.00932584533803677, -1.3265685703988),
        ),
        (
            actuator((6.0, 8.0), soft, fiber(70.0, Two, 0.5e6, smeared)),
            30e3,
            load(1.0, 0.03),
            found(0.984425741241884, 0.00741837549910003, 0.00913648035895689, 0.608451687583225),
        ),
        (
            actuator((6.0, 6.3), soft, fiber(55.0, One, 5e6, layer(6.1))),
            4e3,
            load(0.0, 0.0),
            found(0.98778397349908, 0.00679529416687889, 0.00706481828682302, -0.949033387032215),
        ),
        (
            actuator((6.0, 14.0), DRAGONSKIN_30, fiber(15.0, Two, 10e6, layer(13.0))),
            80e3,
            load(0.0, 0.0),
            found(1.07912116652509, 0.0068915039749827, 0.013991484076122, 0.0),
        ),
    ]
}

#[test]
fn forward_equals_the_integrated_stresses() {
    for (p, pressure_pa, load, expected) in cases() {
        let solution = solve_loaded(&p, pressure_pa, load);
        assert_eq!(solution.status, Status::Solved);
        let state = solution.state;
        for (value, reference) in [
            (state.axial_stretch, expected.axial_stretch),
            (state.inner_radius_m, expected.inner_radius_m),
            (state.outer_radius_m, expected.outer_radius_m),
        ] {
            assert!(relative(value, reference) < 1e-11, "{p:?} at {pressure_pa} Pa: {value} against {reference}");
        }
        let twist_error = (state.twist_rad - expected.twist_rad).abs();
        assert!(twist_error < 1e-10, "{p:?} at {pressure_pa} Pa: {} rad", state.twist_rad);
    }
}

/// The same answers in single precision, within a small multiple of its rounding times the sensitivity of such actuators.
#[test]
fn forward_in_single_precision_equals_the_integrated_stresses() {
    for (p, pressure_pa, load, expected) in cases() {
        let load = Load { force_n: load.force_n as f32, torque_nm: load.torque_nm as f32 };
        let actuator = Actuator::new(&single(&p)).expect("valid");
        let solution = actuator.forward(pressure_pa as f32, &load).expect("finite");
        assert_eq!(solution.status, Status::Solved);
        for (value, reference) in [
            (solution.state.axial_stretch, expected.axial_stretch),
            (solution.state.inner_radius_m, expected.inner_radius_m),
            (solution.state.outer_radius_m, expected.outer_radius_m),
        ] {
            assert!(relative(f64::from(value), reference) < 1e-5, "{p:?}: {value} against {reference}");
        }
    }
}

#[test]
fn limit_pressures_equal_the_folds_of_the_traced_branch() {
    let smeared = fiber(75.0, Families::Two, 0.05e6, (Placement::Smeared, 8.0));
    let layer = fiber(88.0, Families::One, 1e6, (Placement::Layer, 7.2));
    for (p, expected_pa) in [
        (actuator((6.0, 8.0), neo_hookean(0.2e6), None), 43129.5326225763),
        (actuator((6.0, 9.0), DRAGONSKIN_30, None), 73081.1719565719),
        (actuator((6.0, 8.0), neo_hookean(0.1e6), smeared), 26121.5681741712),
        (actuator((6.0, 8.0), DRAGONSKIN_30, layer), 63332.4579992495),
    ] {
        let limit = solve(&p, 1e6).limit_pressure_pa.expect("the branch ends");
        assert!(relative(limit, expected_pa) < 1e-11, "{limit} against {expected_pa} Pa");
        assert_eq!(solve(&p, expected_pa * (1.0 - 1e-6)).status, Status::Solved);
        assert_eq!(solve(&p, expected_pa * (1.0 + 1e-6)).status, Status::NoSolution);
    }
}

#[test]
fn bends_equal_the_slope_of_the_section_energy() {
    for (radii_mm, material, winding_mm, angle, load, expected_pa) in [
        ((6.0, 8.0), neo_hookean(0.2e6), 8.0, 1.0, load(0.0, 0.0), 38218.7751052344),
        ((6.0, 8.0), neo_hookean(0.2e6), 7.0, 2.0, load(1.0, 0.0), 69187.375582628),
        ((6.0, 7.0), DRAGONSKIN_30, 6.5, 1.5, load(0.0, 0.01), 15924.3688640635),
        ((4.0, 8.0), DRAGONSKIN_30, 8.0, 0.5, load(-1.0, 0.0), 46149.7100020787),
        ((5.0, 6.0), neo_hookean(0.1e6), 6.0, 6.0, load(0.0, 0.0), 38586.298604646),
    ] {
        let winding = fiber(0.0, Families::Two, 0.0, (Placement::Sheet, winding_mm));
        let p = ActuatorParameters { motion: Motion::Bending, ..actuator(radii_mm, material, winding) };
        let inverse = Actuator::new(&p).expect("valid").inverse(Target::BendAngle(angle), &load).expect("a bend");
        assert_eq!(inverse.status, Status::Solved);
        let found_pa = inverse.state.pressure_pa;
        assert!(relative(found_pa, expected_pa) < 1e-9, "{found_pa} against {expected_pa} Pa at {angle} rad");
        let bend = solve_loaded(&p, expected_pa, load).state.bend_angle_rad;
        assert!(relative(bend, angle) < 1e-9, "{bend} against {angle} rad at {expected_pa} Pa");
    }
}

/// Bends of thick walls: the same oracle as above, where the material moves far within the section.
#[test]
fn bends_of_thick_walls_equal_the_section_energy() {
    for (inner_mm, angle_rad, expected_pa) in [(1.0, 6.25, 432_306.59), (2.0, 12.5, 493_642.57)] {
        let p = tube(Motion::Bending, inner_mm, 8.0, neo_hookean(0.2e6));
        let solution = Actuator::new(&p).unwrap().inverse(Target::BendAngle(angle_rad), &Load::none()).unwrap();
        assert_eq!(solution.status, Status::Solved);
        assert!(relative(solution.state.pressure_pa, expected_pa) < 2e-8, "{}", solution.state.pressure_pa);
    }
}
