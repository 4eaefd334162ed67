//! Finite elements of the actuator of a query line, on a finer mesh than the command's: the reference of its answers.

use fra_model::{ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, State};
use serde_json::Value;
use softlimb_fea::cross_section::{EndLoad, Mesh, Options, Section};

/// States at gauge pressures, Pa; `None` where there is no equilibrium.
pub(crate) fn states(line: &Value, pressures_pa: &[f64]) -> Vec<Option<State<f64>>> {
    let number = |field: &str| line[field].as_f64().unwrap_or(0.0);
    let motion = match line["motion"].as_str() {
        Some("bending") => Motion::Bending,
        Some("extension") => Motion::Extension,
        other => panic!("{other:?}"),
    };
    let law = &line["material"];
    let material = match law["shear_modulus_pa"].as_f64() {
        Some(shear_modulus_pa) => Material::NeoHookean { shear_modulus_pa },
        None => Material::Yeoh { c_pa: [0, 1, 2].map(|i| law["c_pa"][i].as_f64().expect("three numbers")) },
    };
    let outer_radius_m = number("outer_radius_m");
    let fiber = |spec: &Value, families: Families| Fiber {
        angle_rad: spec["angle_deg"].as_f64().expect("an angle").to_radians(),
        families: spec["families"].as_u64().map_or(families, |n| if n == 1 { Families::One } else { Families::Two }),
        modulus_pa: spec["modulus_pa"].as_f64().expect("a modulus"),
        placement: if spec["placement"] == "layer" { Placement::Layer } else { Placement::Sheet },
        thickness_m: spec["thickness_m"].as_f64().unwrap_or(0.0),
        radius_m: spec["radius_m"].as_f64().unwrap_or(outer_radius_m),
    };
    let [first, second] = match &line["fiber"] {
        Value::Array(list) => [0, 1].map(|i| Some(fiber(&list[i], Families::One))),
        Value::Null => [None, None],
        one => [Some(fiber(one, Families::Two)), None],
    };
    let parameters = ActuatorParameters {
        motion,
        inner_radius_m: number("inner_radius_m"),
        outer_radius_m,
        length_m: number("length_m"),
        material,
        fiber: first,
    };
    let fine = Options { mesh: Mesh { radial: 8, around: 32 }, ..Options::default() };
    let section = match second {
        None => Section::new(&parameters, &fine),
        Some(second) => Section::with_two_windings(&parameters, &second, &fine),
    };
    let load = Load { force_n: number("external_force_n"), torque_nm: number("external_torque_nm") };
    let curve = section.and_then(|section| section.curve(pressures_pa, &EndLoad::of(&load, motion)));
    let answers = curve.unwrap_or_else(|error| panic!("{error} {line}")).answers;
    answers.iter().map(|answer| Some(answer.equilibrium()?.state.over(parameters.length_m))).collect()
}
