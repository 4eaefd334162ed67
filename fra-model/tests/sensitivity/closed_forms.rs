//! Derivatives in the limits that have closed forms: small pressure, thin walls, inextensible fibers, limit points.

use super::*;

/// At rest a bare tube of incompressible rubber is Lame's: `w = P/(mu (1 - R_i^2/R_o^2))`, without axial strain.
#[test]
fn at_rest_a_bare_tube_is_that_of_lame() {
    let (inner, outer, mu) = (6e-3, 8e-3, 0.2e6);
    let case = Case::new(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(mu)), 0.0, 0.0, 0.0);
    let share = 1.0 - (inner / outer) * (inner / outer);
    let rest_volume = std::f64::consts::PI * inner * inner * 0.1;
    let compliance = rest_volume / (mu * share);
    let by_pressure = case.by(Parameter::Pressure);
    close(by_pressure.volume_strain, 1.0 / (mu * share), 1e-13 / mu, "w");
    close(by_pressure.axial_strain, 0.0, 1e-15 / mu, "e");
    // 2 u/R_i = w, and the area between the radii is kept.
    close(by_pressure.inner_radius_m, inner / 2.0 / (mu * share), 1e-13 * inner / mu, "r_i");
    close(by_pressure.outer_radius_m, inner * inner / outer / 2.0 / (mu * share), 1e-13 * inner / mu, "r_o");
    // Derivatives of pi R_i^2 L/(mu (1 - R_i^2/R_o^2)).
    close(case.by(Parameter::ShearModulus).compliance_m3_per_pa, -compliance / mu, 1e-12 * compliance / mu, "C by mu");
    close(case.by(Parameter::Length).compliance_m3_per_pa, compliance / 0.1, 1e-12 * compliance / 0.1, "C by L");
    let by_outer = -compliance / share * 2.0 * inner * inner / (outer * outer * outer);
    close(case.by(Parameter::OuterRadius).compliance_m3_per_pa, by_outer, 1e-12 * by_outer.abs(), "C by R_o");
    let by_inner = 2.0 * compliance / inner * (1.0 + inner * inner / (outer * outer) / share);
    close(case.by(Parameter::InnerRadius).compliance_m3_per_pa, by_inner, 1e-12 * by_inner, "C by R_i");
    // Tension 3 mu A dl/L, torsion mu J Phi/L.
    let area = std::f64::consts::PI * (outer * outer - inner * inner);
    close(case.by(Parameter::Force).axial_strain, 1.0 / (3.0 * mu * area), 1e-13 / (mu * area), "e by N");
    let polar = std::f64::consts::PI / 2.0 * (outer.powi(4) - inner.powi(4));
    close(case.by(Parameter::Torque).twist_rad, 0.1 / (mu * polar), 1e-12 / (mu * polar), "Phi by M");
}

/// The condition of that problem: `w` is in proportion to the pressure and to `1/mu`, and depends on both radii by
/// `2 q/(1 - q)`, `q = R_i^2/R_o^2`.
#[test]
fn the_condition_of_a_small_inflation_is_known() {
    let case = Case::new(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)), 1e-3, 0.0, 0.0);
    let condition = case.actuator.condition(&case.state, &case.load).unwrap();
    let q: f64 = 36.0 / 64.0;
    close(condition, 2.0 + 4.0 * q / (1.0 - q), 1e-6, "condition");
    let rest = Case::new(case.p, 0.0, 0.0, 0.0);
    assert_eq!(rest.actuator.condition(&rest.state, &rest.load), Ok(0.0));
}

/// Bends are in proportion to `P L/mu` at first, and their other inputs at rest do nothing.
#[test]
fn the_condition_of_a_small_bend_counts_pressure_modulus_length_and_radii() {
    let case = Case::new(tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6)), 1e-3, 0.0, 0.0);
    let condition = case.actuator.condition(&case.state, &case.load).unwrap();
    let angle = case.state.bend_angle_rad;
    let by = |parameter: Parameter| case.by(parameter).bend_angle_rad * case.value(parameter) / angle;
    for (parameter, expected) in [(Parameter::Pressure, 1.0), (Parameter::ShearModulus, -1.0), (Parameter::Length, 1.0)]
    {
        close(by(parameter), expected, 1e-6, parameter);
    }
    // All lengths together do nothing.
    close(by(Parameter::InnerRadius) + by(Parameter::OuterRadius), -1.0, 1e-6, "radii");
    close(condition, 3.0 + by(Parameter::InnerRadius).abs() + by(Parameter::OuterRadius).abs(), 1e-7, "condition");
}

/// At rest `d lambda/dP` has the sign of `c^2 - 2 s^2`, zero at the neutral angle for every modulus, placement and family.
#[test]
fn at_rest_the_neutral_angle_has_no_axial_strain() {
    for placement in [Placement::Sheet, Placement::Layer, Placement::Smeared] {
        for families in [Families::One, Families::Two] {
            for modulus_pa in [1e5, 1e7, 1e9] {
                let strain = |angle_deg: f64| {
                    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
                    let p = wound(p, angle_deg, families, modulus_pa, placement, 0.2);
                    Case::new(p, 0.0, 0.0, 0.0).by(Parameter::Pressure).axial_strain
                };
                let neutral = 0.5_f64.sqrt().atan().to_degrees();
                assert!(strain(neutral - 3.0) > 0.0 && strain(neutral + 3.0) < 0.0);
                close(strain(neutral), 0.0, 1e-12 * strain(neutral - 3.0), (placement, families, modulus_pa));
            }
        }
    }
}

/// A thin bare tube is a membrane: `2 lambda^2 = h^2 + 1/(h lambda)^2`, `P R/(mu t) = (1 - h^-4 lambda^-2)/lambda`, `h = r/R`.
#[test]
fn a_thin_bare_tube_is_a_membrane() {
    let wall = 1e-6;
    let p = tube(Motion::Expansion, 6.0, 6.0 * (1.0 + wall), neo_hookean(0.2e6));
    let h: f64 = 1.3;
    // y = lambda^2: 2 y^2 - h^2 y - h^-2 = 0.
    let root = (h.powi(4) + 8.0 / (h * h)).sqrt();
    let lambda = ((h * h + root) / 4.0).sqrt();
    let lambda_h = (2.0 * h + (4.0 * h.powi(3) - 16.0 / h.powi(3)) / (2.0 * root)) / (8.0 * lambda);
    let load = 0.2e6 * wall;
    let pressure = load * (1.0 - h.powi(-4) / (lambda * lambda)) / lambda;
    let by_lambda = load * (-1.0 / (lambda * lambda) + 3.0 * h.powi(-4) / lambda.powi(4));
    let by_h = load * 4.0 * h.powi(-5) / lambda.powi(3) + by_lambda * lambda_h;
    let case = Case::new(p, pressure, 0.0, 0.0);
    close(case.state.inner_radius_m, 6e-3 * h, 1e-7, "h itself");
    let by_pressure = case.by(Parameter::Pressure);
    close(by_pressure.inner_radius_m * by_h / 6e-3, 1.0, 1e-5, "h");
    close(by_pressure.axial_stretch * by_h / lambda_h, 1.0, 1e-5, "lambda");
    // P is in proportion to the wall and to 1/R.
    let by_outer = case.inverse_by(Target::AxialStretch(1.0), Parameter::OuterRadius).pressure_pa;
    close(by_outer * (6e-3 * wall) / pressure, 1.0, 1e-5, "P by R_o");
    let by_inner = case.inverse_by(Target::AxialStretch(1.0), Parameter::InnerRadius).pressure_pa;
    close(by_inner * (6e-3 * wall) / pressure, -1.0, 1e-5, "P by R_i");
}

/// `w = X_f (e - s^2 e (3 + 3e + e^2))/c^2` for inextensible fibers, so what one strain does the other has to follow; and the fiber's
/// modulus and the sheet's thickness no longer matter.
#[test]
fn stiff_sheets_follow_the_inextensible_relation() {
    for (angle_deg, pressure_pa) in [(3.0, 60e3), (25.0, 40e3), (50.0, 20e3), (-70.0, 10e3)] {
        let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6));
        let p = wound(p, angle_deg, Families::Two, 2e13, Placement::Sheet, 0.2);
        let case = Case::new(p, pressure_pa, 0.0, 0.0);
        let e = case.state.axial_strain;
        let (x, s, c) = (64.0 / 36.0, angle_deg.to_radians().sin(), angle_deg.to_radians().cos());
        let path = e * (3.0 + 3.0 * e + e * e);
        let w = x * (e - s * s * path) / (c * c);
        let by_e = x * (1.0 - 3.0 * s * s * (1.0 + e) * (1.0 + e)) / (c * c);
        // d/da of (e - s^2 path)/c^2 at constant e, by s ds = s c da, c dc = -s c da.
        let by_angle = x * 2.0 * s * (e - path) / (c * c * c);
        let by_winding = 2.0 * w / 8e-3;
        close(case.state.volume_strain, w, 1e-6 * w.abs(), angle_deg);
        for (parameter, direct) in [
            (Parameter::Pressure, 0.0),
            (Parameter::ShearModulus, 0.0),
            (Parameter::OuterRadius, 0.0),
            (Parameter::Force, 0.0),
            (Parameter::FiberAngle, by_angle),
            (Parameter::WindingRadius, by_winding),
            (Parameter::InnerRadius, -2.0 * w / 6e-3),
        ] {
            let change = case.by(parameter);
            let expected = by_e * change.axial_strain + direct;
            let size = (by_e * change.axial_strain).abs() + direct.abs();
            close(change.volume_strain, expected, 1e-5 * size, (parameter, angle_deg));
        }
        for parameter in [Parameter::FiberModulus, Parameter::SheetThickness] {
            let change = case.by(parameter).axial_strain * case.value(parameter);
            assert!(change.abs() < 1e-6 * e.abs(), "{parameter:?} {change}");
        }
    }
}

/// At exactly 0 and 90 deg one family does not twist, and the slightest change of the angle makes it: what the derivative says.
#[test]
fn hoops_and_lengthwise_fibers_twist_as_soon_as_they_are_inclined() {
    for (angle_deg, pressure_pa) in [(0.0_f64, 30e3), (90.0, 20e3), (-90.0, 20e3)] {
        let p = tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.2e6));
        let wound = |angle_deg: f64| wound(p, angle_deg, Families::One, 5e6, Placement::Sheet, 0.2);
        let case = Case::new(wound(angle_deg), pressure_pa, 0.0, 0.0);
        assert_eq!(case.state.twist_rad, 0.0);
        let by_angle = case.by(Parameter::FiberAngle);
        // The twist is odd in the inclination, the strains are even.
        let inclined = if angle_deg > 0.0 { angle_deg - 1e-3 } else { angle_deg + 1e-3 };
        let twist = Case::new(wound(inclined), pressure_pa, 0.0, 0.0).state.twist_rad;
        let expected = twist / (inclined - angle_deg).to_radians();
        assert!(expected.abs() > 0.1);
        close(by_angle.twist_rad, expected, 1e-6 * expected.abs(), angle_deg);
        close(by_angle.axial_strain, 0.0, 1e-12, angle_deg);
        close(by_angle.volume_strain, 0.0, 1e-12, angle_deg);
    }
}

/// A winding of no modulus is none, but its derivative is that of the energy it would add.
#[test]
fn the_first_fiber_counts() {
    let p =
        wound(tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.2e6)), 30.0, Families::One, 0.0, Placement::Sheet, 0.2);
    let case = Case::new(p, 15e3, 0.0, 0.0);
    let expected = case.by(Parameter::FiberModulus);
    let mut soft = case.p;
    soft.fiber.as_mut().unwrap().modulus_pa = 1.0;
    let soft = Case::new(soft, 15e3, 0.0, 0.0);
    let slope = (soft.state.twist_rad, soft.state.volume_strain - case.state.volume_strain);
    close(expected.twist_rad, slope.0, 1e-5 * slope.0.abs(), "twist");
    close(expected.volume_strain, slope.1, 1e-5 * slope.1.abs(), "volume");
}

/// The limit pressure is stationary along the branch, so that its derivative is the one at a given state; the fold of a bare tube
/// scales with the modulus, and with the radii as the closed form of a thin one.
#[test]
fn at_the_limit_the_pressure_for_a_target_has_the_derivative_of_the_limit() {
    let p = tube(Motion::Expansion, 6.0, 8.0, DRAGONSKIN_30);
    let actuator = Actuator::new(&p).unwrap();
    let ended = actuator.forward(1e6, &Load::none()).unwrap();
    let limit = |p: &ActuatorParameters<f64>| solve(p, 1e6).limit_pressure_pa.expect("the branch ends");
    for parameter in
        [Parameter::YeohC1, Parameter::YeohC2, Parameter::YeohC3, Parameter::InnerRadius, Parameter::OuterRadius]
    {
        let found = actuator.inverse_sensitivity(&ended.state, &Load::none(), Target::OuterRadius(1.0), parameter);
        let at = |k: f64| {
            let mut p = p;
            *place(&mut p, parameter) *= 1.0 + 1e-3 * k;
            limit(&p)
        };
        let mut copy = p;
        let step = 1e-3 * *place(&mut copy, parameter);
        let expected = ((at(1.0) - at(-1.0)) * 2.0 / 3.0 - (at(2.0) - at(-2.0)) / 12.0) / step;
        close(found.unwrap().pressure_pa, expected, 1e-7 * expected.abs(), parameter);
        // At a given pressure there is none.
        let forward = actuator.sensitivity(&ended.state, &Load::none(), parameter);
        assert_eq!(forward, Err(NoDerivative::AtLimit));
    }
}

/// Near a fold `P_limit - P` is a square: the derivatives grow as its root falls.
#[test]
fn towards_a_limit_point_derivatives_grow_like_the_inverse_root() {
    let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
    let limit = solve(&p, 1e6).limit_pressure_pa.unwrap();
    let growth = |below: f64| Case::new(p, limit * (1.0 - below), 0.0, 0.0).by(Parameter::Pressure).volume_strain;
    close(growth(1e-8) / growth(1e-6), 10.0, 0.05, "tenfold");
    close(growth(1e-10) / growth(1e-8), 10.0, 0.005, "tenfold again");
}
