//! Keys of a design under load: objects, and where the limb may start.

use crate::scene_support::changed;
use softlimb_scene::{Located, parse};

const BOTTLE: &str =
    "\n[[object]]\nname = \"bottle\"\nradius = \"33 mm\"\nheight = \"160 mm\"\ngrasp = \"120 mm\"\nmass = \"0.6 kg\"\n";
const REGION: &str = "\n[[region]]\nname = \"frame\"\ncenter = [0, 0, 1]\nsize = [0.2, 0.1, 0.3]\n";

/// A scene of one bender with an object, a region and more keys.
fn with(phase: &str, more: &str) -> String {
    let text = changed(
        "actuators = 3\ncircle_radius = \"30 mm\"\ninner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"240 mm\"\nmaterial = \"silicone\"\n\n",
        "actuators = 1\ninner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"240 mm\"\nmaterial = \"silicone\"\n\n",
    );
    let text = text.replacen("name = \"stretch\"\n", &format!("name = \"stretch\"\n{phase}"), 1);
    format!("{text}{BOTTLE}{REGION}{more}")
}

fn refused(text: &str) -> String {
    parse(text, "arm.toml").unwrap_err().render(false)
}

#[test]
fn an_object_is_a_mass_with_a_shape() {
    let scene = parse(&with("object = \"bottle\"\n", ""), "arm.toml").unwrap_or_else(|e| panic!("{}", e.render(false)));
    let object = &scene.objects()[scene.phases()[1].object.unwrap()];
    assert_eq!((object.radius_m, object.height_m, object.grasp_m, object.mass_kg), (0.033, 0.16, 0.12, 0.6));
    assert_eq!((scene.phases()[0].payload_kg, scene.phases()[1].payload_kg), (0.0, 0.6));
}

#[test]
fn wrong_objects_are_shown_at_their_line() {
    let two = refused(&with("object = \"bottle\"\npayload = \"1 kg\"\n", ""));
    assert!(two.contains("payload") && two.contains("object"), "{two}");
    let unknown = refused(&with("object = \"botle\"\n", ""));
    assert!(unknown.contains("unknown object `botle`") && unknown.contains("did you mean `bottle`"), "{unknown}");
    let weightless = refused(&with("object = \"bottle\"\n", "[weight]\nsimulated = false\n"));
    assert!(weightless.contains("a payload needs weight") && weightless.contains("object = "), "{weightless}");
    let high = refused(&with("", "").replace("grasp = \"120 mm\"", "grasp = \"170 mm\""));
    assert!(high.contains("grasped within its height") && high.contains("160 mm"), "{high}");
}

#[test]
fn tilt_of_an_object_has_a_range_and_a_line() {
    let most = |line: &str| {
        let text =
            with("object = \"bottle\"\n", "").replace("mass = \"0.6 kg\"\n", &format!("mass = \"0.6 kg\"\n{line}"));
        parse(&text, "arm.toml").map(|scene| scene.objects()[0].tilt_max_rad)
    };
    for (line, rad) in [("", 0.610_865_238_198_015_3), ("tilt_max = \"90 deg\"\n", std::f64::consts::FRAC_PI_2)] {
        assert!((most(line).unwrap() - rad).abs() < 1e-15, "{line}");
    }
    for (line, shown) in [("tilt_max = \"0 deg\"\n", "0.1 deg"), ("tilt_max = \"181 deg\"\n", "180 deg")] {
        let said = most(line).unwrap_err().render(false);
        assert!(said.contains("tilt_max") && said.contains(shown) && said.contains(line.trim_end()), "{said}");
    }
}

#[test]
fn a_design_may_open_base_and_spread() {
    let more = "[design]\nbase_region = \"frame\"\nbase_pitch = [\"-20 deg\", \"30 deg\"]\ncircle_radius = [\"40 mm\", \"80 mm\"]\nbay = \"40 mm\"\n";
    let scene = parse(&with("", more), "arm.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let design = scene.design().unwrap();
    assert_eq!((design.bay_m, design.base_region.as_ref().map(|index| index.value)), (0.04, Some(0)));
    let bounds = |bounds: Option<Located<[f64; 2]>>| bounds.map(|bounds| *bounds);
    assert_eq!(bounds(design.modules[0].circle_radius_m), Some([0.04, 0.08]));
    assert!(
        bounds(design.base_pitch_rad).is_some_and(|[low, high]| (low + 20f64.to_radians()).abs() < 1e-12 && high > 0.5)
    );
    let turned = refused(
        &with("", more).replace("size = [0.2, 0.1, 0.3]", "size = [0.2, 0.1, 0.3]\nrotation = [\"5 deg\", 0, 0]"),
    );
    assert!(turned.contains("without `rotation`"), "{turned}");
}

#[test]
fn a_scene_has_weight_unless_it_says_otherwise() {
    let weight = |table: &str| {
        let scene = parse(&with("", table), "arm.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
        (scene.weightless(), scene.weight().map(|weight| (weight.simulated, weight.compensated, weight.error)))
    };
    assert_eq!(weight(""), (false, Some((true, true, 1e-3))));
    assert_eq!(weight("[weight]\n"), weight(""));
    assert_eq!(weight("[weight]\ncompensated = false\n"), (false, Some((true, false, 1e-3))));
    assert_eq!(weight("[weight]\nsimulated = false\n"), (true, None));
    // For a real limb, whose weight the simulated one is spared.
    assert_eq!(weight("[weight]\nsimulated = false\ncompensated = true\n"), (true, Some((false, true, 1e-3))));
}
