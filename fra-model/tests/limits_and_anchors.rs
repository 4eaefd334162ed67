//! Limits with known answers, and anchors computed by other methods.

use crate::common::*;
use fra_model::*;

/// Bend angles in degrees at `L = 100 mm`, `mu = 0.2 MPa`: an independent evaluation of the bending model.
#[test]
fn bending_matches_the_tabulated_angles_within_one_percent() {
    for (inner, outer, kpa, expected_deg) in [
        (6.0, 8.0, 10.0, 12.9),
        (6.0, 8.0, 30.0, 43.0),
        (6.0, 8.0, 60.0, 101.8),
        (6.0, 7.0, 30.0, 95.4),
        (6.0, 7.0, 60.0, 250.2),
        (4.0, 8.0, 60.0, 38.2),
    ] {
        let p = tube(Motion::Bending, inner, outer, neo_hookean(0.2e6));
        let solution = solve(&p, kpa * KPA);
        assert_eq!(solution.status, Status::Solved);
        let found = solution.state.bend_angle_rad.to_degrees();
        assert!(relative(found, expected_deg) < 0.005, "{inner}/{outer} mm, {kpa} kPa: {found} against {expected_deg}");
    }
}

/// At small curvature the wall is linear: the balance reduces to `P pi R_f^2 R_o = 3 mu k int h^2 dA`-like terms, so angle and
/// pressure are proportional.
#[test]
fn small_bends_are_proportional_to_the_pressure() {
    let p = tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6));
    let at = |pa: f64| solve(&p, pa).state.bend_angle_rad / pa;
    assert!(relative(at(1e-3), at(1e-6)) < 1e-7);
    assert!(relative(at(1.0), at(1e-3)) < 1e-4);
}

/// `d lambda/dP(0)` vanishes exactly at `tan^2 alpha = 1/2` and has the sign of `cos^2 - 2 sin^2`, for any modulus and placement.
#[test]
fn the_neutral_angle_neither_lengthens_nor_shortens_at_first_order() {
    let neutral_deg = 0.5_f64.sqrt().atan().to_degrees();
    for placement in [Placement::Sheet, Placement::Layer, Placement::Smeared] {
        for families in [Families::One, Families::Two] {
            for modulus_pa in [0.02e6, 1e6, 200e6] {
                let strain = |angle_deg: f64, pressure_pa: f64| {
                    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
                    let p = wound(p, angle_deg, families, modulus_pa, placement, 0.2);
                    solve(&p, pressure_pa).state.axial_stretch - 1.0
                };
                // The second-order part is even in the pressure.
                let pressure_pa = 0.5;
                let odd = |angle: f64| (strain(angle, pressure_pa) - strain(angle, -pressure_pa)) / (2.0 * pressure_pa);
                assert!(odd(neutral_deg).abs() < 1e-4 * odd(10.0).abs(), "{placement:?} {families:?} {modulus_pa}");
                assert!(odd(neutral_deg - 0.1) > 0.0 && odd(neutral_deg + 0.1) < 0.0);
            }
        }
    }
}

/// A closed tube without fibers neither lengthens nor shortens at first order.
#[test]
fn a_bare_tube_keeps_its_length_at_first_order() {
    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
    let strain = |pa: f64| solve(&p, pa).state.axial_stretch - 1.0;
    let widening = solve(&p, 0.5).state.outer_radius_m / 8e-3 - 1.0;
    assert!((strain(0.5) - strain(-0.5)).abs() < 1e-4 * widening);
}

/// Thin wall without fiber: `P R/(mu t)` has its maximum 0.7499 at a hoop stretch of 1.577.
#[test]
fn a_thin_bare_tube_has_the_membrane_limit_pressure() {
    let p = tube(Motion::Expansion, 10.0, 10.01, neo_hookean(0.2e6));
    let solution = solve(&p, 100e3);
    assert_eq!(solution.status, Status::NoSolution);
    let limit = solution.limit_pressure_pa.expect("a limit point");
    // 0.7499 belongs to R/t of the mid-surface; the exact thin-wall scale is ln(R_o/R_i).
    let scaled = limit / (0.2e6 * (10.01_f64 / 10.0).ln());
    assert!((scaled - 0.7499).abs() < 2e-3, "{scaled}");
    let hoop = solution.state.outer_radius_m / 10.01e-3;
    assert!((hoop - 1.577).abs() < 2e-2, "{hoop}");
}

/// Axial fibers of growing stiffness: `P_max/(mu ln(R_o/R_i))` tends to 1, with these values on the way.
#[test]
fn limit_pressures_of_axial_fibers() {
    for (ratio, expected) in [(1.0, 0.87), (10.0, 0.95), (100.0, 0.988), (1e4, 0.999)] {
        let mu = 0.2e6;
        let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(mu));
        let p = wound(p, 90.0, Families::Two, ratio * mu, Placement::Smeared, 0.0);
        let solution = solve(&p, 100e3);
        assert_eq!(solution.status, Status::NoSolution, "{ratio}");
        let scaled = solution.limit_pressure_pa.expect("limit") / (mu * (8.0_f64 / 6.0).ln());
        assert!((scaled - expected).abs() < 6e-3, "{ratio}: {scaled} against {expected}");
    }
}

/// Weak fibers near the axis: `P(V)` is N-shaped. The branch connected to zero pressure ends at its first limit point.
#[test]
fn the_first_limit_point_of_an_n_shaped_branch_is_respected() {
    for (angle_deg, ratio, limit_kpa) in [(75.0, 0.5, 26.122), (80.0, 1.0, 26.37)] {
        let mu = 0.1e6;
        let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(mu));
        let p = wound(p, angle_deg, Families::Two, ratio * mu, Placement::Smeared, 0.0);
        let limit = solve(&p, 40e3).limit_pressure_pa.expect("beyond the first limit point");
        assert!(relative(limit, limit_kpa * KPA) < 2e-4, "{angle_deg} deg: {limit}");
    }
}

/// Inextensible limit of a two-family sheet: `lambda^2 sin^2 + (r_f/R_f)^2 cos^2 = 1` makes the pressure explicit.
#[test]
fn stiff_sheets_tend_to_the_inextensible_solution() {
    let mu = 0.2e6;
    let (x_o, angle) = ((8.0_f64 / 6.0).powi(2), 20.0_f64.to_radians());
    let (s2, c2) = (angle.sin().powi(2), angle.cos().powi(2));
    let strain = 0.1;
    let lambda: f64 = 1.0 + strain;
    // Volume of the inextensible kinematics and its slope; the elastomer's work by central differences of its energy, which is
    // integrated here in the plain form (h = r/R).
    let volume = |l: f64| x_o * ((1.0 - l * l * s2) / c2 * l - 1.0) + 1.0;
    let energy = |l: f64| {
        let n = 20_000;
        let step = (x_o - 1.0) / f64::from(n);
        (0..n)
            .map(|i| {
                let x = 1.0 + (f64::from(i) + 0.5) * step;
                let h2 = (volume(l) + x - 1.0) / (l * x);
                0.5 * (1.0 / (h2 * l * l) + h2 + l * l - 3.0) * step
            })
            .sum::<f64>()
    };
    let d = 1e-4;
    let work = (energy(lambda + d) - energy(lambda - d)) / (2.0 * d);
    let gain = (volume(lambda + d) - volume(lambda - d)) / (2.0 * d);
    let expected = mu * work / gain;
    let mut last = f64::INFINITY;
    for modulus_pa in [1e9, 1e10, 1e11] {
        let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(mu));
        let p = wound(p, 20.0, Families::Two, modulus_pa, Placement::Sheet, 0.1);
        let solution = Actuator::new(&p).unwrap().inverse(Target::AxialStretch(lambda), &Load::none()).unwrap();
        assert_eq!(solution.status, Status::Solved);
        let error = relative(solution.state.pressure_pa, expected);
        assert!(error < 0.2 * last, "{modulus_pa}: {error}");
        last = error;
    }
    assert!(last < 1e-4, "{last}");
}

/// Blocked extender: the end force per pressure is `pi R_f^2 (1 - 2 tan^2 alpha)` in the inextensible limit.
#[test]
fn a_blocked_stiff_tube_pushes_with_the_fiber_radius() {
    for (angle_deg, expected_mm2) in [(1.0_f64, 200.90), (30.0, 67.03), (45.0, -200.7)] {
        let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.17e6));
        let p = wound(p, angle_deg, Families::Two, 1e5 * 0.17e6, Placement::Sheet, 0.1);
        let push_n = expected_mm2 * 1e-6 * 50e3;
        let free = solve(&p, 50e3).state.axial_stretch - 1.0;
        let blocked = solve_loaded(&p, 50e3, Load { force_n: -push_n, torque_nm: 0.0 });
        assert_eq!(blocked.status, Status::Solved);
        let left = (blocked.state.axial_stretch - 1.0) / free;
        assert!(left.abs() < 2e-3, "{angle_deg} deg: {left} of the free strain is left");
    }
}

/// A winding smeared through the wall locks as it stiffens; the same winding as a sheet does not.
#[test]
fn smeared_fibers_lock_and_a_sheet_does_not() {
    let strain = |ratio: f64, placement| {
        let mu = 0.17e6;
        let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(mu));
        let p = wound(p, 3.0, Families::Two, ratio * mu, placement, 0.2);
        solve(&p, 40e3).state.axial_stretch - 1.0
    };
    println!(
        "{} {} {}",
        strain(5.0, Placement::Smeared),
        strain(5e3, Placement::Smeared),
        strain(1e5, Placement::Smeared)
    );
    println!("{}", strain(1e5, Placement::Sheet));
    assert!(strain(1e5, Placement::Smeared) < 2e-3 * strain(1e5, Placement::Sheet));
}

/// Yeoh with `C2 = C3 = 0` is neo-Hookean: two evaluations of the same integrals, one closed, one by quadrature.
#[test]
fn yeoh_contains_neo_hookean() {
    let mu = 0.2e6;
    let yeoh = Material::Yeoh { c_pa: [0.5 * mu, 0.0, 0.0] };
    for (inner, outer) in [(6.0, 6.06), (6.0, 8.0), (6.0, 24.0)] {
        for motion in [Motion::Extension, Motion::Twisting, Motion::Bending] {
            let wind = |p| wound(p, 25.0, Families::One, 20e6, Placement::Sheet, 0.2);
            let pressure_pa = 0.2 * mu * f64::ln(outer / inner);
            let a = solve(&wind(tube(motion, inner, outer, neo_hookean(mu))), pressure_pa);
            let b = solve(&wind(tube(motion, inner, outer, yeoh)), pressure_pa);
            assert_eq!((a.status, b.status), (Status::Solved, Status::Solved));
            assert!(relative(a.state.axial_stretch - 1.0, b.state.axial_stretch - 1.0) < 1e-9);
            assert!((a.state.twist_rad - b.state.twist_rad).abs() <= 1e-9 * a.state.twist_rad.abs());
        }
    }
}

/// The same under vacuum that all but closes the lumen, where the integrands are steepest.
#[test]
fn the_two_agree_when_the_lumen_closes() {
    let mu = 0.2e6;
    let yeoh = Material::Yeoh { c_pa: [0.5 * mu, 0.0, 0.0] };
    for (inner, outer) in [(6.0, 6.5), (6.0, 8.0), (4.0, 16.0)] {
        for pressure in [-0.05, -0.3, -1.0, -2.0] {
            let pressure_pa = pressure * mu * f64::ln(outer / inner);
            let wind = |p| wound(p, 60.0, Families::One, 0.5e6, Placement::Sheet, 0.2);
            let a = solve(&wind(tube(Motion::Extension, inner, outer, neo_hookean(mu))), pressure_pa);
            let b = solve(&wind(tube(Motion::Extension, inner, outer, yeoh)), pressure_pa);
            assert_eq!((a.status, b.status), (Status::Solved, Status::Solved), "{inner}/{outer} {pressure}");
            let off = relative(b.state.inner_radius_m, a.state.inner_radius_m);
            assert!(off < 1e-10, "{inner}/{outer} mm, {pressure}: r_i {} m, {off:.1e}", a.state.inner_radius_m);
        }
    }
}

/// Neo-Hookean and Yeoh fits of DragonSkin 30 with nearly axial fibers: limit pressures of an expansion actuator.
#[test]
fn limit_pressures_of_dragonskin_expansion() {
    for (material, expected_kpa) in [(neo_hookean(0.2226e6), 63.5), (DRAGONSKIN_30, 70.5)] {
        let p = tube(Motion::Expansion, 6.0, 8.0, material);
        let p = wound(p, 90.0, Families::Two, 361e6, Placement::Sheet, 0.178);
        let limit = solve(&p, 100e3).limit_pressure_pa.expect("no equilibrium at 100 kPa");
        assert!(relative(limit, expected_kpa * KPA) < 0.02, "{limit} against {expected_kpa} kPa");
    }
}

#[test]
fn twist_of_a_sheet_is_negative_and_mirrors_with_the_angle() {
    for angle_deg in [5.0, 20.0, 30.0, 45.0, 60.0, 85.0] {
        let twist = |angle: f64| {
            let p = tube(Motion::Twisting, 6.35, 8.35, neo_hookean(0.24e6));
            let p = wound(p, angle, Families::One, 361e6, Placement::Sheet, 0.178);
            solve(&p, 20e3).state.twist_rad
        };
        assert!(twist(angle_deg) < 0.0, "{angle_deg}");
        assert!(relative(-twist(-angle_deg), twist(angle_deg)) < 1e-9);
    }
}

#[test]
fn a_torque_twists_a_bare_tube_like_a_shaft() {
    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
    let torque_nm = 1e-7;
    let solution = solve_loaded(&p, 0.0, Load { force_n: 0.0, torque_nm });
    let polar = std::f64::consts::FRAC_PI_2 * (8e-3_f64.powi(4) - 6e-3_f64.powi(4));
    assert!(relative(solution.state.twist_rad, torque_nm * 0.1 / (0.2e6 * polar)) < 1e-6);
}

/// The section rule of single precision is coarser; what it leaves out is below what the scalar can tell at the sizes that are
/// cast, and small beyond them.
#[test]
fn bends_in_single_precision_agree_with_double() {
    for (inner, outer, bound) in [(10.0, 14.0, 3e-6), (6.0, 7.0, 3e-6), (6.0, 12.0, 1e-5), (4.0, 16.0, 2e-4)] {
        let p = tube(Motion::Bending, inner, outer, neo_hookean(0.2e6));
        let exact = Actuator::new(&p).unwrap();
        let coarse = Actuator::new(&single(&p)).unwrap();
        for angle_deg in [1e-3_f64, 1.0, 30.0, 90.0, 180.0, 360.0] {
            let a = exact.inverse(Target::BendAngle(angle_deg.to_radians()), &Load::none()).unwrap();
            let b = coarse.inverse(Target::BendAngle(angle_deg.to_radians() as f32), &Load::none()).unwrap();
            let off = relative(f64::from(b.state.pressure_pa), a.state.pressure_pa);
            assert!(off < bound, "{inner}/{outer} mm, {angle_deg} deg: {off:.1e}");
        }
    }
}
