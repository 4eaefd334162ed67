//! Exact derivatives, and segments in series.

use super::*;

/// An equilibrium of [`examples`] with its derivatives by one input; a change of the input is one of its unit.
struct Changed {
    length: Length,
    volume: Volume,
    twist: Ratio,
}

fn changed(p: &ActuatorParameters<f64>, state: &State<f64>, load: Load<f64>, by: Parameter) -> Changed {
    let change = Actuator::new(p).unwrap().sensitivity(state, &load, by).unwrap();
    Changed {
        length: m(p.length_m) * change.axial_stretch,
        volume: Volume::new::<cubic_meter>(change.volume_m3),
        twist: rad(change.twist_rad).into(),
    }
}

/// `dx/dp = -H^-1 dr/dp` for `x = (l, V, Phi)` and `r = (N, P, M)` less the loads: `H dx + dr = 0`, row by row, for a small change of the
/// shape and of an input. The integrals of the stresses give `H dx` and `dr`, as differences along the change.
#[test]
fn changed_shape_balances_the_changed_stresses() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let outer = m(p.outer_radius_m);
        for by in [Parameter::InnerRadius, Parameter::OuterRadius, Parameter::FiberAngle, Parameter::FiberModulus] {
            let Changed { length, volume, twist } = changed(&p, &state, load, by);
            let tube = Tube::at(&p, &state);
            let share = STEP * input(&p, by);
            let parameters = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| {
                let mut p = p;
                *place(&mut p, by) += k * share;
                p
            });
            let at = |k: f64| Tube {
                p: &parameters[(k + 2.0) as usize],
                length: tube.length + length * (k * share),
                volume: tube.volume + volume * (k * share),
                twist: tube.twist + Angle::from(twist * (k * share)),
            };
            // Of what one such step changes by itself.
            let alone = |k: f64| Tube { p: &parameters[(k + 2.0) as usize], ..tube };
            let pressure = change(|k| alone(k).eq_7_pressure()).abs() + pa(p.material.shear_modulus_pa()) * 1e-4;
            let force: Force = pressure * outer * outer;
            close(change(|k| at(k).eq_7_pressure()), pa(0.0), pressure * 1e-4);
            close(change(|k| at(k).eq_9_force()), Force::new::<newton>(0.0), force * 1e-3);
            let torque = change(|k| force * outer * (at(k).torque() / Torque::from(force * outer)));
            close(torque, 0.0 * force * outer, force * outer * 1e-3);
        }
    }
}

fn place(p: &mut ActuatorParameters<f64>, by: Parameter) -> &mut f64 {
    let fiber = p.fiber.as_mut().expect("wound");
    match by {
        Parameter::InnerRadius => &mut p.inner_radius_m,
        Parameter::OuterRadius => &mut p.outer_radius_m,
        Parameter::FiberAngle => &mut fiber.angle_rad,
        Parameter::FiberModulus => &mut fiber.modulus_pa,
        other => panic!("{other:?}"),
    }
}

fn input(p: &ActuatorParameters<f64>, by: Parameter) -> f64 {
    let mut p = *p;
    *place(&mut p, by)
}

/// `dV/dN = dl/dP`, `dV/dM = dPhi/dP`, `dl/dM = dPhi/dN`.
#[test]
fn cross_derivatives_have_one_dimension_and_one_value() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let by = |parameter| changed(&p, &state, load, parameter);
        let (pressed, pulled, turned) = (by(Parameter::Pressure), by(Parameter::Force), by(Parameter::Torque));
        let (one_pa, one_n) = (pa(1.0), Force::new::<newton>(1.0));
        // A torque as an energy, since angles here are numbers.
        let one_nm: Energy = one_n * m(1.0);
        let length = pressed.length / one_pa;
        close(pulled.volume / one_n, length, length.abs() * 1e-11);
        let twist = pressed.twist / one_pa;
        close(turned.volume / one_nm, twist, twist.abs() * 1e-11);
        let twist = pulled.twist / one_n;
        close(turned.length / one_nm, twist, twist.abs() * 1e-11);
    }
}

/// `dP/dp = -(dq/dp)/(dq/dP)`, and `P` itself for all moduli and loads in proportion.
#[test]
fn pressure_that_holds_a_target_changes_as_the_quotient_says() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let actuator = Actuator::new(&p).unwrap();
        let radius = |parameter| m(actuator.sensitivity(&state, &load, parameter).unwrap().outer_radius_m);
        for by in [Parameter::OuterRadius, Parameter::Force] {
            let expected: Pressure = -radius(by) / (radius(Parameter::Pressure) / pa(1.0));
            let held = actuator.inverse_sensitivity(&state, &load, Target::OuterRadius(0.0), by).unwrap();
            close(pa(held.pressure_pa), expected, expected.abs() * 1e-10);
        }
    }
}

/// `sum |p| max|dd/dp| / max|d|` is a number.
#[test]
fn condition_has_no_dimension() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let actuator = Actuator::new(&p).unwrap();
        let inner = m(p.inner_radius_m);
        let rest: Volume = PI * inner * inner * m(p.length_m);
        // `g = Phi R_i/L`; a change of either length counts as well.
        let g: Ratio = Ratio::from(rad(state.twist_rad)) * inner / m(p.length_m);
        let largest = |strain: Ratio, volume: Ratio, g: Ratio| strain.abs().max(volume.abs()).max(g.abs());
        let deformation = largest(state.axial_strain * ONE, state.volume_strain * ONE, g);
        let relative = |parameter: Parameter, value: f64| {
            let change = changed(&p, &state, load, parameter);
            let (own_radius, own_length, own_rest): (Ratio, Ratio, Ratio) = match parameter {
                Parameter::InnerRadius => (m(value) / inner, 0.0 * ONE, 2.0 * m(value) / inner),
                Parameter::Length => (0.0 * ONE, m(value) / m(p.length_m), m(value) / m(p.length_m)),
                _ => (0.0 * ONE, 0.0 * ONE, 0.0 * ONE),
            };
            let volume = change.volume * value / rest - Volume::new::<cubic_meter>(state.volume_m3) / rest * own_rest;
            let twist =
                Ratio::from(change.twist * value * inner / m(p.length_m)) + Ratio::from(g) * (own_radius - own_length);
            largest(change.length * value / m(p.length_m), volume, twist)
        };
        let inputs =
            actuator.inputs().map(|parameter| relative(parameter, value(&p, pressure_pa, load, parameter).abs()));
        let sum = inputs.fold(0.0 * ONE, |sum, term| sum + term);
        close(actuator.condition(&state, &load).unwrap() * ONE, sum / deformation, 1e-9 * ONE);
    }
}

fn value(p: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>, parameter: Parameter) -> f64 {
    let fiber = p.fiber.expect("wound");
    match (parameter, p.material) {
        (Parameter::InnerRadius, _) => p.inner_radius_m,
        (Parameter::OuterRadius, _) => p.outer_radius_m,
        (Parameter::Length, _) => p.length_m,
        (Parameter::ShearModulus, Material::NeoHookean { shear_modulus_pa }) => shear_modulus_pa,
        (Parameter::YeohC1, Material::Yeoh { c_pa }) => c_pa[0],
        (Parameter::YeohC2, Material::Yeoh { c_pa }) => c_pa[1],
        (Parameter::YeohC3, Material::Yeoh { c_pa }) => c_pa[2],
        (Parameter::FiberAngle, _) => fiber.angle_rad,
        (Parameter::FiberModulus, _) => fiber.modulus_pa,
        (Parameter::SheetThickness, _) => fiber.thickness_m,
        (Parameter::WindingRadius, _) => fiber.radius_m,
        (Parameter::Pressure, _) => pressure_pa,
        (Parameter::Force, _) => load.force_n,
        (Parameter::Torque, _) => load.torque_nm,
        other => panic!("{other:?}"),
    }
}

/// `l = sum lambda L`, `V = sum V`, `Phi = sum Phi`, `phi = sum phi`, `dV/dP = sum dV/dP`.
#[test]
fn segments_in_series_add_up() {
    let (p, _) = bender(0.0);
    let straight = tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.2e6));
    let straight = wound(straight, 20.0, Families::One, 1e6, Placement::Sheet, 0.2);
    let segments = [p, straight].map(|p| Actuator::new(&p).unwrap());
    let pressure = pa(30e3);
    let state = Series::new(&segments).unwrap().forward(pressure.get::<pascal>(), &Load::none()).unwrap().state;
    let states = [p, straight].map(|p| (m(p.length_m), solved(&p, pressure.get::<pascal>(), Load::none())));
    let length = states.iter().fold(m(0.0), |sum, (length, s)| sum + *length * s.axial_stretch);
    close(m(state.length_m), length, length * 1e-14);
    let volume = |s: &State<f64>| Volume::new::<cubic_meter>(s.volume_m3);
    let total = states.iter().map(|(_, s)| volume(s)).fold(Volume::new::<cubic_meter>(0.0), |sum, v| sum + v);
    close(Volume::new::<cubic_meter>(state.volume_m3), total, total * 1e-14);
    let turn = states.iter().fold(rad(0.0), |sum, (_, s)| sum + rad(s.twist_rad) + rad(s.bend_angle_rad));
    close(rad(state.twist_rad) + rad(state.bend_angle_rad), turn, rad(1e-14));
    let step = pa(10.0);
    let at = |k: f64| {
        let pressure = (pressure + step * k).get::<pascal>();
        Volume::new::<cubic_meter>(
            Series::new(&segments).unwrap().forward(pressure, &Load::none()).unwrap().state.volume_m3,
        )
    };
    let compliance = Volume::new::<cubic_meter>(state.compliance_m3_per_pa) / pa(1.0);
    close(change(at) / step, compliance, compliance * 1e-7);
}
