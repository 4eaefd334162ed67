//! What a right scene says, in SI units.

use std::f64::consts::PI;

use crate::scene_support::{SCENE, changed};
use fra_model::{Arrangement, Families, Fiber, Material, Motion, Placement, StateQuantity};
use softlimb_scene::{Goal, LinkLoss, Scene, Span, Supply, parse};

#[track_caller]
fn scene(text: &str) -> Scene {
    parse(text, "arm.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

#[track_caller]
fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{value} is not {expected}");
}

#[test]
fn numbers_and_strings_with_units_say_the_same() {
    let plain = scene(SCENE);
    for (from, to) in [
        ("\"10 mm\"", "0.010"),
        ("\"10 mm\"", "\"1 cm\""),
        ("\"10 mm\"", "\"10000 µm\""),
        ("\"0.2 MPa\"", "200e3"),
        ("\"0.2 MPa\"", "\"2 bar\""),
        ("\"300 g\"", "0.3"),
        ("\"3 s\"", "\"3000 ms\""),
        ("\"3 s\"", "3"),
        ("seed = 7", "seed = 0x7"),
    ] {
        let other = scene(&changed(from, to));
        assert_eq!(other.modules()[0].actuator(), plain.modules()[0].actuator(), "{to}");
        assert_eq!(other.limb(), plain.limb(), "{to}");
        assert_eq!(other.phases()[0].move_us.map(|time| *time), Some(3_000_000), "{to}");
        assert_eq!(other.seed(), 7, "{to}");
    }
}

#[test]
fn module_is_what_its_table_says() {
    let scene = scene(SCENE);
    let [upper, elbow] = scene.modules() else { panic!("{} modules", scene.modules().len()) };
    let fiber = Fiber {
        angle_rad: 3.0 * PI / 180.0,
        families: Families::Two,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: 0.014,
    };
    assert_eq!(upper.fiber.map(|fiber| fiber.value), Some(fiber));
    assert_eq!(*upper.material, Material::NeoHookean { shear_modulus_pa: 0.2e6 });
    assert_eq!(
        (*upper.motion, upper.actuators, upper.arrangement),
        (Motion::Extension, 3, Arrangement::Circle { radius_m: 0.03 })
    );
    assert_eq!((*elbow.motion, elbow.fiber, *elbow.length_m), (Motion::Bending, None, 0.24));
    assert_eq!((upper.setpoint_kind, elbow.setpoint_kind), (StateQuantity::AxialStretch, StateQuantity::BendAngle));
    assert_eq!(*elbow.pressure_max_pa, 100e3);
    assert_eq!(&SCENE[elbow.pressure_max_pa.span.range()], "\"100 kPa\"", "located where the limit is written");
}

#[test]
fn targets_are_located_and_in_the_order_of_the_modules() {
    let scene = scene(SCENE);
    let Goal::Targets(targets) = &scene.phases()[0].goal else { panic!("a way-point") };
    let said: Vec<_> =
        targets.iter().map(|target| (target.module, target.kind, &SCENE[target.value.span.range()])).collect();
    assert_eq!(said, [(0, StateQuantity::AxialStretch, "1.1"), (1, StateQuantity::BendAngle, "\"40 deg\"")]);
    near(*targets[1].value, 40.0 * PI / 180.0);
    assert_eq!((scene.phases()[0].hold_us, scene.duration_us()), (0, 5_000_000));
}

#[test]
fn percentage_is_a_plain_number_over_100() {
    let scene = scene(&changed("1.1 }", "\"110 %\" }"));
    let Goal::Targets(targets) = &scene.phases()[0].goal else { panic!("a way-point") };
    near(*targets[0].value, 1.1);
}

#[test]
fn pressure_target_sets_the_kind_of_the_module() {
    let text = changed("axial_stretch = 1.1", "pressure = \"6 psi\"");
    let scene = scene(&text.replace("axial_stretch = 1.2", "pressure = \"0.4 bar\""));
    assert_eq!(scene.modules()[0].setpoint_kind, StateQuantity::Pressure);
    let Goal::Targets(targets) = &scene.phases()[0].goal else { panic!("a way-point") };
    near(*targets[0].value, 6.0 * 6_894.757_293_168_361);
}

#[test]
fn way_point_takes_the_place_of_targets() {
    let scene = scene(&changed("targets = { upper = { axial_stretch = 1.2 } }", "tip = [\"50 cm\", 0, -0.125]"));
    let Goal::Tip(tip) = &scene.phases()[1].goal else { panic!("targets") };
    assert_eq!(**tip, [0.5, 0.0, -0.125]);
}

#[test]
fn frame_of_the_base_is_orthonormal() {
    let limb = "[limb]\nbase_position = [\"1 m\", \"20 cm\", -3]\nbase_direction = [3, 0, 4]\nbase_up = [0, 0, 2]";
    let limb = scene(&changed("[limb]", limb)).limb().clone();
    assert_eq!(limb.base_position_m, [1.0, 0.2, -3.0]);
    // The part of z normal to (3, 0, 4)/5 is (-12, 0, 9)/25, of length 3/5.
    for (found, expected) in [(limb.base_direction, [0.6, 0.0, 0.8]), (limb.base_up, [-0.8, 0.0, 0.6])] {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
    }
}

#[test]
fn omitted_entries_have_the_defaults_of_the_reference() {
    let scene = scene(&changed("[limits]\npressure_max = \"100 kPa\"\n", ""));
    assert_eq!(*scene.limits().pressure_max_pa, 100e3);
    assert_eq!(scene.limits().pressure_max_pa.span, Span::NOWHERE);
    let controller = scene.controller();
    assert_eq!((controller.knot_period_us, controller.control_period_us), (20_000, 20_000));
    assert_eq!((controller.link_loss, controller.link_timeout_us), (LinkLoss::HoldThenRamp, 250_000));
    let plant = scene.plant();
    near(plant.valve.conductance_m3_per_s_pa, 1.44e-9);
    near(plant.sensor.full_scale_pa, 30.0 * 6_894.757_293_168_361);
    assert_eq!((plant.sensor.bits, plant.sensor.adc_full_scale()), (12, 4095));
    let Supply::Pump { pressure_pa, flow_m3_per_s, reservoir_volume_m3, .. } = plant.supply else {
        panic!("regulated")
    };
    assert_eq!((pressure_pa, reservoir_volume_m3), (200e3, 1e-3));
    near(flow_m3_per_s, 1e-4);
    near(plant.spread.modulus, 0.03);
}

#[test]
fn plant_of_its_own() {
    let text = format!(
        "{SCENE}\n[controller]\nlink_loss = \"vent\"\ntelemetry_period = \"5 ms\"\n
         [plant]\nsupply = {{ kind = \"regulated\", pressure = \"2.5 bar\" }}\nsensor.bits = 10\nambient.temperature = \"30 °C\"\n"
    );
    let scene = scene(&text);
    assert_eq!(scene.plant().supply, Supply::Regulated { pressure_pa: 250e3 });
    assert_eq!(scene.plant().sensor.adc_full_scale(), 1023);
    near(scene.plant().ambient.temperature_k, 303.15);
    assert_eq!((scene.controller().link_loss, scene.controller().telemetry_period_us), (LinkLoss::Vent, 5000));
}

#[test]
fn layer_smeared_and_yeoh() {
    let layer = scene(&changed("thickness = \"0.178 mm\"", "placement = \"layer\"\nradius = \"13 mm\""));
    let fiber = layer.modules()[0].fiber.unwrap();
    assert_eq!((fiber.placement, fiber.radius_m), (Placement::Layer, 0.013));
    let smeared = scene(&changed("thickness = \"0.178 mm\"", "placement = \"smeared\""));
    assert_eq!(smeared.modules()[0].fiber.unwrap().placement, Placement::Smeared);
    let law = "law = \"yeoh\"\nc = [\"86.56 kPa\", 13805, \"-1466.1 Pa\"]";
    let yeoh = scene(&changed("law = \"neo-hookean\"\nshear_modulus = \"0.2 MPa\"", law));
    let Material::Yeoh { c_pa } = *yeoh.modules()[0].material else { panic!("neo-Hookean") };
    assert_eq!(c_pa, [86_560.0, 13_805.0, -1466.1]);
}
