//! A scene with the modules that a design found: the author's text, and what is read from it.

use std::sync::LazyLock;

use fra_model::{Arrangement, Motion, StateQuantity};
use softlimb_scene as scene;
use softlimb_scene::{Goal, Redesign, Scene, redesigned};

use crate::scene_support::with_sheets;

/// With sheets in place of threads.
static SCENE: LazyLock<String> = LazyLock::new(|| with_sheets(include_str!("../../../scenes/weightless-b.toml")));

fn read(text: &str) -> Scene {
    scene::parse(text, "redesigned.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)))
}

fn word(motion: Motion) -> &'static str {
    match motion {
        Motion::Extension => "extension",
        Motion::Expansion => "expansion",
        Motion::Bending => "bending",
        Motion::Twisting => "twisting",
    }
}

/// The modules of a scene as they are.
fn unchanged(scene: &Scene) -> Vec<Redesign> {
    let modules = scene.modules().iter().map(|module| Redesign {
        name: module.name.to_string(),
        like: module.name.to_string(),
        motion: word(*module.motion),
        bundle: (module.actuators, module.arrangement),
        mount_angle_rad: module.mount_angle_rad,
        radii_m: [*module.inner_radius_m, *module.outer_radius_m],
        length_m: *module.length_m,
        winding: module.fiber.map(|fiber| fiber.angle_rad),
        segments: Vec::new(),
    });
    modules.collect()
}

#[test]
fn modules_as_they_are_make_the_same_limb() {
    let scene = read(&SCENE);
    let again = read(&redesigned(&scene, &unchanged(&scene), None).unwrap());
    for (before, after) in scene.modules().iter().zip(again.modules()) {
        assert_eq!(before.actuator(), after.actuator());
        assert_eq!(before.mount_angle_rad, after.mount_angle_rad);
        assert_eq!((before.actuators, before.arrangement), (after.actuators, after.arrangement));
    }
    assert_eq!(scene.limb(), again.limb());
}

#[test]
fn sizes_and_angles_are_written_and_comments_stay() {
    let scene = read(&SCENE);
    let mut modules = unchanged(&scene);
    modules[0].radii_m = [8.25e-3, 12.5e-3];
    modules[0].winding = Some(31.25_f64.to_radians());
    modules[1].mount_angle_rad = (-90.0_f64).to_radians();
    modules[2].length_m = 0.1875;
    let text = redesigned(&scene, &modules, None).unwrap();
    let again = read(&text);
    let shoulder = again.modules()[0].actuator();
    assert_eq!((shoulder.inner_radius_m, shoulder.outer_radius_m), (8.25e-3, 12.5e-3));
    let fiber = shoulder.fiber.unwrap_or_else(|| panic!("no winding in\n{text}"));
    assert!((fiber.angle_rad - 31.25_f64.to_radians()).abs() < 1e-9);
    assert_eq!(fiber.radius_m, 12.5e-3);
    assert_eq!(fiber.modulus_pa, 361e6);
    assert!((again.modules()[1].mount_angle_rad + 90.0_f64.to_radians()).abs() < 1e-9);
    assert_eq!(*again.modules()[2].length_m, 0.1875);
    assert!(text.contains("# fit to tension up to a stretch of 2"));
    assert!(text.contains("close to the angle of largest twist"));
}

#[test]
fn targets_take_the_place_of_goals() {
    let scene = read(include_str!("../../../scenes/tip-waypoints.toml"));
    let targets: Vec<_> = (0..scene.phases().len())
        .map(|phase| {
            vec![
                (0, StateQuantity::Twist, -0.5),
                (1, StateQuantity::BendAngle, 0.1 * phase as f64),
                (2, StateQuantity::AxialStretch, 1.0625),
            ]
        })
        .collect();
    let again = read(&redesigned(&scene, &unchanged(&scene), Some(&targets)).unwrap());
    for (index, phase) in again.phases().iter().enumerate() {
        let Goal::Targets(found) = &phase.goal else { panic!("phase {index} has no targets") };
        let values: Vec<f64> = found.iter().map(|target| target.value.value).collect();
        for (value, wanted) in values.iter().zip([-0.5, 0.1 * index as f64, 1.0625]) {
            assert!((value - wanted).abs() < 2e-8, "phase {index}: {value} for {wanted}");
        }
    }
}

#[test]
fn new_limb_takes_the_place_of_the_old_one() {
    let scene = read(&SCENE);
    let named = |name: &str, like: &str, motion, winding: Option<f64>| Redesign {
        name: name.into(),
        like: like.into(),
        motion,
        bundle: (3, Arrangement::Circle { radius_m: 0.03 }),
        mount_angle_rad: 0.0,
        radii_m: [0.009, 0.013],
        length_m: 0.2,
        winding,
        segments: Vec::new(),
    };
    let modules = [named("first", "elbow", "bending", None), named("second", "wrist", "extension", Some(0.1))];
    let targets = vec![vec![(0, StateQuantity::BendAngle, 0.3), (1, StateQuantity::AxialStretch, 1.05)]; 4];
    let again = read(&redesigned(&scene, &modules, Some(&targets)).unwrap());
    assert_eq!(again.modules().len(), 2);
    assert_eq!(*again.modules()[0].motion, Motion::Bending);
    assert!(again.modules()[0].fiber.is_none());
    assert!(again.modules()[1].fiber.is_some_and(|fiber| (fiber.angle_rad - 0.1).abs() < 1e-9));
}

#[test]
fn unwritable_entries_are_reported_and_not_left_as_they_were() {
    // Windings on one line are no tables of their own, so that there is no place for a copy.
    let inline = "windings = { hoop-like = { angle = \"3 deg\", families = 2, modulus = \"361 MPa\", thickness = \"0.178 mm\" }, \
                  helix = { angle = \"28 deg\", families = 1, modulus = \"361 MPa\", thickness = \"0.178 mm\" } }\n\n";
    let (before, rest) = SCENE.split_once("[materials").unwrap();
    let from = rest.find("[windings.hoop-like]").unwrap();
    let to = rest.find("[limb]").unwrap();
    let scene = read(&format!("{before}{inline}[materials{}{}", &rest[..from], &rest[to..]));
    let mut modules = unchanged(&scene);
    modules[0].winding = Some(0.5);
    let error = redesigned(&scene, &modules, None).unwrap_err().to_string();
    assert!(error.contains("fiber angle") && error.contains("shoulder"), "{error}");
}
