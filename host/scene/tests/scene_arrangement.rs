//! Places of a module's actuators: what a scene may say, and what is refused at which line.

use fra_model::Arrangement;
use softlimb_scene::{Redesign, parse, redesigned};

use crate::scene_support::{SCENE, changed, picture};

/// The scene with the elbow's circle replaced.
fn elbow(places: &str) -> String {
    let (before, after) = SCENE.rsplit_once("circle_radius = \"30 mm\"").expect("the elbow's");
    format!("{before}{places}{after}")
}

fn refused(places: &str) -> String {
    parse(&elbow(places), "arm.toml").unwrap_err().render(false)
}

#[test]
fn row_is_read_with_its_places() {
    let scene = parse(&elbow("arrangement = \"row\"\nspacing = \"34 mm\""), "arm.toml").unwrap();
    let elbow = &scene.modules()[1];
    assert_eq!(elbow.arrangement, Arrangement::Row { spacing_m: 0.034 });
    assert_eq!(elbow.positions_m(), [[0.0, -0.034], [0.0, 0.0], [0.0, 0.034]]);
    assert_eq!(elbow.reach_m(), 0.034);
    let circle = parse(&elbow_circle(), "arm.toml").unwrap();
    assert_eq!(circle.modules()[1].arrangement, Arrangement::Circle { radius_m: 0.03 });
}

fn elbow_circle() -> String {
    elbow("arrangement = \"circle\"\ncircle_radius = \"30 mm\"")
}

#[test]
fn one_actuator_needs_no_distance() {
    for places in ["", "arrangement = \"row\"", "arrangement = \"circle\""] {
        let text = elbow(places);
        let at = text.rfind("actuators = 3").expect("the elbow's");
        let text = format!("{}actuators = 1{}", &text[..at], &text[at + "actuators = 3".len()..]);
        let scene = parse(&text, "arm.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((scene.modules()[1].positions_m(), scene.modules()[1].reach_m()), (vec![[0.0; 2]], 0.0));
    }
}

#[test]
fn distance_of_the_other_arrangement_is_shown_at_its_line() {
    assert_eq!(
        refused("spacing = \"34 mm\"\ncircle_radius = \"30 mm\""),
        r#"error: `spacing` has no meaning with `arrangement = "circle"`
  --> arm.toml:32:1
   |
32 | spacing = "34 mm"
   | ^^^^^^^ give `circle_radius`, or `arrangement = "row"`"#
    );
    let other = refused("arrangement = \"row\"\nspacing = \"34 mm\"\ncircle_radius = \"30 mm\"");
    assert!(other.contains("`circle_radius` has no meaning with `arrangement = \"row\"`"), "{other}");
    assert!(
        other.contains("arm.toml:34:1") && other.contains("give `spacing`, or `arrangement = \"circle\"`"),
        "{other}"
    );
    let missing = refused("arrangement = \"row\"");
    assert!(missing.contains("missing key `spacing`") && missing.contains("for two or more actuators"), "{missing}");
    let unknown = refused("arrangement = \"line\"\nspacing = \"34 mm\"");
    assert!(unknown.contains("not one of `circle`, `row`"), "{unknown}");
}

#[test]
fn tubes_of_a_row_do_not_overlap() {
    assert_eq!(
        refused("arrangement = \"row\"\nspacing = \"27 mm\""),
        r#"error: the actuators overlap
  --> arm.toml:33:11
   |
33 | spacing = "27 mm"
   |           ^^^^^^^ the axes are 27 mm apart
34 | inner_radius = "10 mm"
35 | outer_radius = "14 mm"
   |                ------- each is 28 mm wide
   |
   = help: 3 actuators need a `spacing` of at least 28 mm"#
    );
    assert!(parse(&elbow("arrangement = \"row\"\nspacing = \"28 mm\""), "arm.toml").is_ok());
}

#[test]
fn twisting_actuators_need_a_circle() {
    let error = picture(
        "motion = \"extension\"\nactuators = 3\ncircle_radius = \"30 mm\"",
        "motion = \"twisting\"\nactuators = 3\narrangement = \"row\"\nspacing = \"34 mm\"",
    );
    assert!(error.contains("`twisting` actuators need `arrangement = \"circle\"`"), "{error}");
    assert!(error.contains("arm.toml:21:15"), "{error}");
}

#[test]
fn redesign_writes_either_arrangement() {
    let arrangements = [Arrangement::Row { spacing_m: 0.036 }, Arrangement::Circle { radius_m: 0.04 }];
    for before in [elbow_circle(), elbow("arrangement = \"row\"\nspacing = \"34 mm\"")] {
        let scene = parse(&before, "arm.toml").unwrap();
        for arrangement in arrangements {
            let redesign = |index: usize, motion| {
                let module = &scene.modules()[index];
                Redesign {
                    name: module.name.to_string(),
                    like: module.name.to_string(),
                    motion,
                    bundle: (3, arrangement),
                    mount_angle_rad: 0.0,
                    radii_m: [0.010, 0.014],
                    length_m: 0.24,
                    winding: None,
                    segments: Vec::new(),
                }
            };
            let text = redesigned(&scene, &[redesign(0, "extension"), redesign(1, "bending")], None).unwrap();
            let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}"));
            assert!(again.modules().iter().all(|module| module.arrangement == arrangement), "{text}");
        }
    }
}

#[test]
fn steering_module_is_read() {
    let scene = parse(&changed("actuators = 3", "actuators = 3\nsteering = true"), "arm.toml").unwrap();
    assert!(scene.modules()[0].steering && !scene.modules()[1].steering);
}

#[test]
fn module_that_cannot_steer_is_refused_at_its_line() {
    assert_eq!(
        picture("actuators = 3", "actuators = 2\nsteering = true"),
        r#"error: a `steering` module needs 3 actuators or more
  --> arm.toml:21:1
   |
20 | actuators = 2
   |             - there are 2
21 | steering = true
   | ^^^^^^^^ fewer do not bend it in two directions"#
    );
    let bending = refused("circle_radius = \"30 mm\"\nsteering = true");
    assert!(bending.contains("a `steering` module needs extending actuators"), "{bending}");
    assert!(bending.contains("arm.toml:33:1") && bending.contains("these do not extend"), "{bending}");
    let row = picture("circle_radius = \"30 mm\"", "arrangement = \"row\"\nspacing = \"30 mm\"\nsteering = true");
    assert!(row.contains("needs `arrangement = \"circle\"`") && row.contains("arm.toml:23:1"), "{row}");
    let word = picture("actuators = 3", "actuators = 3\nsteering = 1");
    assert!(word.contains("`true` or `false`"), "{word}");
}
