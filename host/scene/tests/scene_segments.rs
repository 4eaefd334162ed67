//! Modules of several segments: what is read, and what is refused at which line.

use fra_model::{Motion, StateQuantity};
use softlimb_scene::{Redesign, Scene, parse, redesigned, rewritten};

use crate::scene_support::SCENE;

/// The elbow as a bending segment behind an extending one.
const ELBOW: &str = r#"actuators = 1
inner_radius = "10 mm"
outer_radius = "14 mm"
end_length = "2 mm"
material = "silicone"

[[module.segments]]
motion = "extension"
length = "100 mm"
winding = "hoop"

[[module.segments]]
motion = "bending"
length = "140 mm"
bend_direction = "90 deg"
"#;

/// The scene with the elbow of segments, the first `from` in it replaced.
#[track_caller]
fn text(from: &str, to: &str) -> String {
    let (before, rest) = SCENE.split_once("motion = \"bending\"\n").unwrap();
    let (_, after) = rest.split_once("material = \"silicone\"\n").unwrap();
    let module = format!("motion = \"bending\"\n{ELBOW}");
    assert!(module.contains(from), "{from}");
    format!("{before}{}{after}", module.replacen(from, to, 1))
}

#[track_caller]
fn read(from: &str, to: &str) -> Scene {
    parse(&text(from, to), "arm.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

#[track_caller]
fn refused(from: &str, to: &str) -> String {
    parse(&text(from, to), "arm.toml").unwrap_err().render(false)
}

#[test]
fn segments_have_their_own_motion_length_winding_and_direction() {
    let scene = read("", "");
    let module = &scene.modules()[1];
    assert_eq!(module.segments.len(), 2);
    assert!((*module.length_m - 0.24).abs() < 1e-15);
    assert_eq!(module.setpoint_kind, StateQuantity::BendAngle);
    let [(first, None), (second, None)] = module.segment_actuators()[..] else { panic!("{module:?}") };
    assert_eq!((first.motion, second.motion), (Motion::Extension, Motion::Bending));
    // An end cap takes from the first and from the last.
    assert!((first.length_m - 0.098).abs() < 1e-15 && (second.length_m - 0.138).abs() < 1e-15);
    assert!((module.moving_length_m() - first.length_m - second.length_m).abs() < 1e-15);
    assert!((first.fiber.unwrap().angle_rad.to_degrees() - 3.0).abs() < 1e-12 && second.fiber.is_none());
    assert_eq!((first.outer_radius_m, second.inner_radius_m), (0.014, 0.010));
    let directions = module.segments.iter().map(|segment| segment.bend_direction_rad.to_degrees());
    assert_eq!(directions.collect::<Vec<_>>(), [0.0, 90.0]);
    // The bending segment stands for the module.
    assert_eq!(module.actuator().motion, Motion::Bending);
    assert!(module.fiber.is_none());
}

#[test]
fn motion_of_the_setpoint_is_that_of_the_module() {
    let text = text("motion = \"bending\"\nactuators", "motion = \"extension\"\nactuators")
        .replace("elbow = { bend_angle = \"40 deg\" }", "elbow = { axial_stretch = 1.1 }");
    let scene = parse(&text, "arm.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let module = &scene.modules()[1];
    assert_eq!(module.setpoint_kind, StateQuantity::AxialStretch);
    assert!(module.fiber.is_some(), "wound as the extending segment");
}

#[test]
fn two_places_for_a_length_are_shown() {
    assert_eq!(
        refused("end_length", "length = \"240 mm\"\nend_length"),
        r#"error: `length` has no meaning with `segments`, which have their own
  --> arm.toml:34:1
   |
34 | length = "240 mm"
   | ^^^^^^ remove this key"#
    );
}

#[test]
fn segment_keys_are_checked_at_their_lines() {
    let missing = refused("length = \"100 mm\"\n", "");
    assert!(missing.contains("missing key `length` in `[[module.segments]]`"), "{missing}");
    let unwound = refused("winding = \"hoop\"\n", "");
    assert!(unwound.contains("missing key `winding` in `[[module.segments]]`"), "{unwound}");
    let wall = refused("bend_direction", "outer_radius = \"15 mm\"\nbend_direction");
    assert!(wall.contains("unknown key `outer_radius` in `[[module.segments]]`"), "{wall}");
    let straight = refused("winding = \"hoop\"", "winding = \"hoop\"\nbend_direction = \"90 deg\"");
    assert!(straight.contains("`bend_direction` has no meaning in a segment that does not bend"), "{straight}");
    let twisting = refused("motion = \"extension\"", "motion = \"twisting\"");
    assert!(twisting.contains("a `twisting` module needs a winding of one family"), "{twisting}");
    let ends = refused("\"2 mm\"", "\"110 mm\"");
    assert!(ends.contains("less than the `length` of the first and of the last segment"), "{ends}");
}

#[test]
fn module_of_segments_has_one_actuator() {
    assert_eq!(
        refused("actuators = 1", "actuators = 3\ncircle_radius = \"30 mm\""),
        r#"error: a module with `segments` has one actuator
  --> arm.toml:31:13
   |
31 | actuators = 3
   |             ^ several here
   |
   = help: write `actuators = 1`"#
    );
    let places = refused("actuators = 1", "actuators = 1\ncircle_radius = \"30 mm\"");
    assert!(
        places.contains("`circle_radius` has no meaning with `segments`, whose actuator is in the middle"),
        "{places}"
    );
}

#[test]
fn setpoint_needs_a_segment_of_its_motion() {
    let unmoved = refused("motion = \"bending\"\nlength", "motion = \"extension\"\nwinding = \"hoop\"\nlength");
    assert!(unmoved.contains("`bend_direction` has no meaning"), "{unmoved}");
    let text = text("bend_direction = \"90 deg\"\n", "winding = \"hoop\"\n");
    let (before, after) = text.rsplit_once("motion = \"bending\"").unwrap();
    let text = format!("{before}motion = \"extension\"{after}");
    let error = parse(&text, "arm.toml").unwrap_err().render(false);
    assert!(error.contains("no segment of this module is for `bending`"), "{error}");
    let radius = refused("motion = \"bending\"", "motion = \"expansion\"");
    assert!(radius.contains("a module with `segments` has no radius as its setpoint"), "{radius}");
}

#[test]
fn number_of_segments_is_bounded() {
    let (from, _) = ELBOW.split_once("\n[[module.segments]]\nmotion = \"bending\"").unwrap();
    let first = &from[from.find("[[module.segments]]").unwrap()..];
    let one = refused(&ELBOW[ELBOW.find("[[module.segments]]\nmotion = \"extension\"").unwrap()..], first);
    assert!(one.contains("`segments` needs 2 to 8 tables") && one.contains("the number here is 1"), "{one}");
    let nine = refused(first, &first.repeat(8));
    assert!(nine.contains("the number here is 9"), "{nine}");
}

#[test]
fn bounds_of_lengths_and_fiber_angles_are_those_of_segments() {
    let bounds = "bounds = { length = [\"80 mm\", \"120 mm\"], fiber_angle = [\"2 deg\", \"9 deg\"] }";
    let scene = read("winding = \"hoop\"", &format!("winding = \"hoop\"\n{bounds}"));
    let [first, second] = &scene.modules()[1].segments[..] else { panic!("two segments") };
    let length_m = first.bounds.length_m.map(|bounds| *bounds);
    assert!(length_m.is_some_and(|[low, high]| (low - 0.08).abs() < 1e-15 && (high - 0.12).abs() < 1e-15));
    assert!(first.bounds.fiber_angle_rad.is_some() && first.bounds.inner_radius_m.is_none());
    assert!(second.bounds.length_m.is_none());
    let of_module =
        refused("actuators = 1", "actuators = 1\nbounds = { wall = [3, 5], length = [200, 300], spacing = [1, 2] }");
    let place = "for a module with `segments`, each of which has its own in `[module.segments.bounds]`";
    assert!(of_module.contains(&format!("`length` has no meaning {place}")), "{of_module}");
    assert!(of_module.contains("`spacing` has no meaning for a module with `segments`"), "{of_module}");
    let bender = refused("bend_direction", "bounds = { fiber_angle = [\"2 deg\", \"9 deg\"] }\nbend_direction");
    assert!(bender.contains("`fiber_angle` has no meaning in a bending segment"), "{bender}");
}

/// The first segment is wound with a thread that another module has, too.
#[test]
fn segments_that_a_design_found_are_written_and_comments_stay() {
    let scene = read("length = \"100 mm\"", "length = \"100 mm\"   # extends");
    let modules: Vec<Redesign> = scene
        .modules()
        .iter()
        .map(|module| Redesign {
            name: module.name.to_string(),
            like: module.name.to_string(),
            motion: if *module.motion == Motion::Bending { "bending" } else { "extension" },
            bundle: (module.actuators, module.arrangement),
            mount_angle_rad: module.mount_angle_rad,
            radii_m: [*module.inner_radius_m, *module.outer_radius_m + 1e-3],
            length_m: *module.length_m + module.segments.len() as f64 * 5e-3,
            winding: module.fiber.filter(|_| module.segments.is_empty()).map(|fiber| fiber.angle_rad),
            segments: module
                .segments
                .iter()
                .map(|segment| (*segment.length_m + 5e-3, segment.fiber.map(|fiber| fiber.angle_rad + 0.1)))
                .collect(),
        })
        .collect();
    let text = redesigned(&scene, &modules, None).unwrap();
    let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)));
    for (before, after) in scene.modules().iter().zip(again.modules()) {
        assert_eq!(before.segments.len(), after.segments.len());
        for (before, after) in before.segments.iter().zip(&after.segments) {
            assert!((*after.length_m - *before.length_m - 5e-3).abs() < 1e-9);
            assert_eq!(before.bend_direction_rad, after.bend_direction_rad);
            let [fiber, found] = [before.fiber, after.fiber];
            assert_eq!(fiber.is_some(), found.is_some());
            if let (Some(fiber), Some(found)) = (fiber, found) {
                assert!((found.angle_rad - fiber.angle_rad - 0.1).abs() < 1e-8);
                // What the thread is in the author's scene stays as its radius grows.
                assert!(
                    (found.modulus_pa / fiber.modulus_pa - 1.0).abs() < 1e-6,
                    "{} {}",
                    found.modulus_pa,
                    fiber.modulus_pa
                );
            }
        }
        if before.segments.is_empty() {
            assert_eq!(before.fiber.map(|fiber| fiber.angle_rad), after.fiber.map(|fiber| fiber.angle_rad));
        }
    }
    assert!(text.contains("length = \"105 mm\"   # extends"), "{text}");
}

#[test]
fn rooms_of_one_segment_name_the_second() {
    let scene = read("", "");
    let error = scene.require_no_segments("`fea`").unwrap_err().render(false);
    assert!(error.contains("`elbow` has several segments, and `fea` takes modules of one"), "{error}");
    assert!(error.contains("arm.toml:42:1"), "{error}");
    let actuators: Vec<_> = scene.modules().iter().map(|module| module.wound_actuator()).collect();
    let error = rewritten(&scene, &actuators).unwrap_err();
    assert!(error.to_string().contains("a rewritten scene takes modules of one"), "{error}");
}
