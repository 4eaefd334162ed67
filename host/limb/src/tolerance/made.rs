//! An actuator as it was made, and what a small change of it does to its free shape.

use std::f64::consts::{FRAC_PI_2, PI};

use fra_model::{Actuator, ActuatorParameters, Fiber, Load, Material, NoDerivative, Parameter, State};

use super::input::{Kind, Place};
use crate::fabricate::Tolerances;

/// The actuator at a place within the tolerances, and its second winding. Two windings have one error of angle, away from the hoop: one machine winds
/// them, and those that mirror each other still do.
pub(super) fn made(
    nominal: &ActuatorParameters<f64>,
    second: Option<&Fiber<f64>>,
    tolerances: &Tolerances,
    place: &Place,
) -> (ActuatorParameters<f64>, Option<Fiber<f64>>) {
    let mut second = second.copied();
    let off = |kind: Kind| kind.of(tolerances) * place[kind.index()];
    let inner_m = nominal.inner_radius_m;
    // In this form a wall that is not off leaves every bit as it is.
    let depth = |radius_m: f64| (radius_m - inner_m) / (nominal.outer_radius_m - inner_m);
    let outwards = |radius_m: f64| radius_m + depth(radius_m) * off(Kind::Wall);
    let mut one = ActuatorParameters {
        outer_radius_m: outwards(nominal.outer_radius_m),
        material: scaled(&nominal.material, 1.0 + off(Kind::Modulus)),
        ..*nominal
    };
    for fiber in one.fiber.iter_mut().chain(&mut second) {
        fiber.radius_m = outwards(fiber.radius_m);
        fiber.angle_rad = as_line(fiber.angle_rad + sense(fiber) * off(Kind::Angle));
    }
    (one, second)
}

/// Sign of a change of angle that leads away from the hoop.
fn sense(fiber: &Fiber<f64>) -> f64 {
    1.0_f64.copysign(fiber.angle_rad)
}

/// A thread has no forward end: an angle beyond a quarter turn is the one on the other side.
fn as_line(angle_rad: f64) -> f64 {
    if angle_rad.abs() <= FRAC_PI_2 { angle_rad } else { angle_rad - PI.copysign(angle_rad) }
}

fn scaled(material: &Material<f64>, factor: f64) -> Material<f64> {
    match *material {
        Material::NeoHookean { shear_modulus_pa } => {
            Material::NeoHookean { shear_modulus_pa: shear_modulus_pa * factor }
        }
        Material::Yeoh { c_pa } => Material::Yeoh { c_pa: c_pa.map(|c| c * factor) },
    }
}

/// Change of stretch, bend and twist per length of an actuator in an equilibrium without load, from the middle to the end of a tolerance.
///
/// Zero where the model does not know the parameter: a bending actuator without a helical winding has no fiber angle.
pub(super) fn change(
    actuator: &Actuator<f64>,
    state: &State<f64>,
    kind: Kind,
    tolerances: &Tolerances,
) -> Result<[f64; 3], NoDerivative<f64>> {
    let parameters = actuator.parameters();
    let known: Vec<Parameter> = actuator.inputs().collect();
    let mut sum = [0.0; 3];
    for (parameter, weight) in parts(actuator, kind) {
        if known.contains(&parameter) {
            let by = actuator.sensitivity(state, &Load::none(), parameter)?;
            let weight = weight * kind.of(tolerances);
            let rates = [by.axial_stretch, by.bend_angle_rad / parameters.length_m, by.twist_rad / parameters.length_m];
            sum = [0, 1, 2].map(|i: usize| sum[i] + weight * rates[i]);
        }
    }
    Ok(sum)
}

/// The parameters that change with a kind, and by how much per unit of it.
fn parts(actuator: &Actuator<f64>, kind: Kind) -> Vec<(Parameter, f64)> {
    let parameters = actuator.parameters();
    match (kind, &parameters.material) {
        (Kind::Angle, _) => {
            let first = parameters.fiber.map(|fiber| (Parameter::FiberAngle, sense(&fiber)));
            let second = actuator.second_fiber().map(|fiber| (Parameter::SecondFiberAngle, sense(fiber)));
            first.into_iter().chain(second).collect()
        }
        (Kind::Wall, _) => {
            let inner_m = parameters.inner_radius_m;
            let depth = |radius_m: f64| (radius_m - inner_m) / (parameters.outer_radius_m - inner_m);
            let winding = parameters.fiber.map(|fiber| (Parameter::WindingRadius, depth(fiber.radius_m)));
            let second = actuator.second_fiber().map(|fiber| (Parameter::SecondWindingRadius, depth(fiber.radius_m)));
            [(Parameter::OuterRadius, 1.0)].into_iter().chain(winding).chain(second).collect()
        }
        (Kind::Modulus, Material::NeoHookean { shear_modulus_pa }) => {
            vec![(Parameter::ShearModulus, *shear_modulus_pa)]
        }
        (Kind::Modulus, Material::Yeoh { c_pa }) => {
            [Parameter::YeohC1, Parameter::YeohC2, Parameter::YeohC3].into_iter().zip(*c_pa).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thread_beyond_the_axis_is_the_one_from_the_other_side() {
        let degrees = |angle: f64| as_line(angle.to_radians()).to_degrees();
        for (angle, line) in [(90.0, 90.0), (91.0, -89.0), (-91.5, 88.5), (0.0, 0.0), (-90.0, -90.0)] {
            assert!((degrees(angle) - line).abs() < 1e-12, "{angle}");
        }
    }
}
