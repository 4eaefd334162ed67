//! Derivatives of the equilibrium of stresses, and of a bent section's energy: integrals that know nothing of this crate's energy
//! gradient, differentiated by differences of high order at the solved state. No equilibrium is solved here but by their own Jacobian.

use nalgebra::{Matrix3, Vector3};

use super::*;
use crate::common::stresses::resultants;

/// The change of a smooth function over one step, of sixth order; over the step it is the derivative.
fn change(f: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    (f(1.0) - f(-1.0)) * 0.75 - (f(2.0) - f(-2.0)) * 0.15 + (f(3.0) - f(-3.0)) / 60.0
}

/// `P`, `N`, `M` of a shape `(lambda, r_i, Phi)`.
fn loads(p: &ActuatorParameters<f64>, shape: Vector3<f64>) -> Vector3<f64> {
    let found = resultants(p, shape.into());
    Vector3::new(found.pressure_pa, found.force_n, found.torque_nm)
}

/// Derivative of the shape by the implicit function theorem on the stress integrals.
fn shape_change(case: &Case, parameter: Parameter) -> Vector3<f64> {
    let State { axial_stretch, inner_radius_m, twist_rad, .. } = case.state;
    let shape = Vector3::new(axial_stretch, inner_radius_m, twist_rad);
    let steps = [1e-3, 1e-3 * inner_radius_m, 1e-3];
    let columns = [0, 1, 2].map(|axis| {
        let mut step = Vector3::zeros();
        step[axis] = steps[axis];
        change(|k| loads(&case.p, shape + step * k)) / steps[axis]
    });
    let by_parameter = match parameter {
        Parameter::Pressure => -Vector3::x(),
        Parameter::Force => -Vector3::y(),
        Parameter::Torque => -Vector3::z(),
        other => {
            let step = 1e-3 * case.value(other);
            let at = |k: f64| {
                let mut p = case.p;
                *place(&mut p, other) += k * step;
                loads(&p, shape)
            };
            change(at) / step
        }
    };
    -Matrix3::from_columns(&columns).lu().solve(&by_parameter).expect("regular")
}

#[test]
fn derivatives_are_those_of_the_integrated_stresses() {
    // One in five: not the same load, angle, placement or law each time.
    for case in straight_cases().into_iter().step_by(5) {
        for parameter in case.actuator.inputs() {
            let expected = shape_change(&case, parameter);
            let found = case.by(parameter);
            let length = case.p.inner_radius_m;
            let scale = [expected.x.abs(), expected.y.abs() / length, expected.z.abs() * length / case.p.length_m]
                .into_iter()
                .fold(0.0, f64::max);
            let what = (parameter, &case.p, case.load);
            // The second term is the rounding of the differences: some inputs hardly matter.
            let tolerance = 3e-8 * scale + 1e-12 / case.value(parameter).abs().max(1e-6);
            close(found.axial_stretch, expected.x, tolerance, what);
            close(found.inner_radius_m, expected.y, tolerance * length, what);
            close(found.twist_rad, expected.z, tolerance * case.p.length_m / length, what);
            close(found.axial_strain, found.axial_stretch, 0.0, what);
            // V = pi r_i^2 lambda L
            let State { axial_stretch, inner_radius_m, volume_m3, .. } = case.state;
            let stretched = found.axial_stretch / axial_stretch + 2.0 * found.inner_radius_m / inner_radius_m;
            let own = if parameter == Parameter::Length { 1.0 / case.p.length_m } else { 0.0 };
            let size = scale + own;
            close(found.volume_m3, volume_m3 * (stretched + own), 1e-12 * volume_m3 * size, what);
        }
    }
}

/// Energy of a bent section per length of the inextensible line, by Simpson's rule over the wall and midpoints around it; the
/// isochoric map by bisection.
fn section_energy(p: &ActuatorParameters<f64>, curvature: f64) -> f64 {
    let winding = p.fiber.map_or(p.outer_radius_m, |fiber| fiber.radius_m);
    let (radial, around) = (60, 24);
    let width = p.outer_radius_m - p.inner_radius_m;
    let mut sum = 0.0;
    for i in 0..=radial {
        let radius = p.inner_radius_m + width * f64::from(i) / f64::from(radial);
        let weight = if i == 0 || i == radial { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        for j in 0..around {
            let turn = std::f64::consts::PI * (f64::from(j) + 0.5) / f64::from(around);
            sum +=
                weight / f64::from(3 * radial * around) * radius * section_density(p, winding, curvature, radius, turn);
        }
    }
    std::f64::consts::TAU * width * sum
}

fn section_density(p: &ActuatorParameters<f64>, winding: f64, curvature: f64, radius: f64, turn: f64) -> f64 {
    let outside = |r: f64| {
        (1.0 + curvature * p.outer_radius_m) * (winding * winding - r * r) / 2.0
            - curvature * turn.cos() * (winding.powi(3) - r.powi(3)) / 3.0
            - (winding * winding - radius * radius) / 2.0
            < 0.0
    };
    let (mut low, mut high) = (1e-4 * radius, 3.0 * radius);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if outside(middle) { high = middle } else { low = middle }
    }
    let r = 0.5 * (low + high);
    let stretch = 1.0 + curvature * (p.outer_radius_m - r * turn.cos());
    let lean = curvature * turn.sin() * (winding.powi(3) - r.powi(3)) / (3.0 * r * stretch) / radius;
    let i1 = (radius / (r * stretch)).powi(2) + lean * lean + (r / radius).powi(2) + stretch * stretch;
    match p.material {
        Material::NeoHookean { shear_modulus_pa } => shear_modulus_pa / 2.0 * (i1 - 3.0),
        Material::Yeoh { c_pa: [c1, c2, c3] } => (i1 - 3.0) * (c1 + (i1 - 3.0) * (c2 + (i1 - 3.0) * c3)),
    }
}

/// `dU/dkappa - P pi R_f^2 R_o - M - N R_o`, which is zero in balance.
fn unbalance(p: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>, curvature: f64) -> Vector3<f64> {
    let step = 0.005 / p.outer_radius_m;
    let moment = change(|k| Vector3::x() * section_energy(p, curvature + k * step)).x / step;
    let winding = p.fiber.map_or(p.outer_radius_m, |fiber| fiber.radius_m);
    let pressed = pressure_pa * std::f64::consts::PI * winding * winding * p.outer_radius_m;
    Vector3::x() * (moment - pressed - load.torque_nm - load.force_n * p.outer_radius_m)
}

#[test]
fn derivatives_of_a_bend_are_those_of_the_section_energy() {
    for case in bent_cases().into_iter().step_by(3) {
        let curvature = case.state.bend_angle_rad / case.p.length_m;
        let pressure_pa = case.state.pressure_pa;
        let step = 0.005 / case.p.outer_radius_m;
        let stiffness = change(|k| unbalance(&case.p, pressure_pa, case.load, curvature + k * step)).x / step;
        for parameter in case.actuator.inputs().filter(|parameter| *parameter != Parameter::Length) {
            let value = case.value(parameter).abs();
            let step = if value > 0.0 { 2e-3 * value } else { 1e-3 };
            let at = |k: f64| {
                let (mut p, mut pressure_pa, mut load) = (case.p, pressure_pa, case.load);
                match parameter {
                    Parameter::Pressure => pressure_pa += k * step,
                    Parameter::Force => load.force_n += k * step,
                    Parameter::Torque => load.torque_nm += k * step,
                    other => *place(&mut p, other) += k * step,
                }
                unbalance(&p, pressure_pa, load, curvature)
            };
            let expected = -change(at).x / step / stiffness * case.p.length_m;
            close(case.by(parameter).bend_angle_rad, expected, 1e-6 * expected.abs(), (parameter, &case.p));
        }
        let by_length = case.by(Parameter::Length).bend_angle_rad;
        close(by_length, case.state.bend_angle_rad / case.p.length_m, 1e-12 * by_length, "phi = kappa L");
    }
}
