//! Scenes with a mistake in them: the message points at the line and says the value, and nothing is written.

use crate::cli::desk::{Desk, SCENE};

/// One mistake: what is replaced, by what, and what the message must say.
struct Mistake {
    from: &'static str,
    to: &'static str,
    words: &'static [&'static str],
}

const MISTAKES: &[Mistake] = &[
    Mistake { from: "motion =", to: "motoin =", words: &["unknown key `motoin`", "did you mean `motion`"] },
    Mistake { from: "\"14 mm\"", to: "\"14 kPa\"", words: &["`outer_radius`", "14 kPa", "this is a pressure"] },
    Mistake { from: "\"14 mm\"", to: "\"14 furlong\"", words: &["furlong", "mm"] },
    Mistake { from: "\"10 mm\"", to: "\"16 mm\"", words: &["`inner_radius`", "16 mm", "`outer_radius`", "14 mm"] },
    Mistake { from: "\"240 mm\"", to: "\"-240 mm\"", words: &["`length`", "-240 mm", "5 mm to 5000 mm"] },
    Mistake { from: "\"240 mm\"", to: "nan", words: &["`length`"] },
    Mistake { from: "bend_angle = \"30 deg\"", to: "pressure = \"150 kPa\"", words: &["150 kPa", "100 kPa"] },
    Mistake { from: "\"30 deg\"", to: "\"359 deg\"", words: &["359 deg", "reach", "`finger`"] },
    Mistake { from: "\"30 deg\"", to: "\"400 deg\"", words: &["400 deg", "360 deg"] },
    Mistake { from: "bend_angle = \"30 deg\"", to: "axial_stretch = 1.1", words: &["axial_stretch", "bend_angle"] },
    Mistake {
        from: "targets = { finger = { bend_angle = \"30 deg\" } }",
        to: "tip = [3.0, 0.0, 0.0]",
        words: &["way-point", "3.0", "nearest"],
    },
    Mistake { from: "finger = {", to: "fnger = {", words: &["fnger", "finger"] },
    Mistake { from: "material = \"silicone\"", to: "material = \"silicon\"", words: &["silicon", "silicone"] },
    Mistake { from: "format = 1", to: "format = 2", words: &["format 2", "newer"] },
    Mistake { from: "actuators = 1", to: "actuators = 28", words: &["`actuators`", "28"] },
    Mistake { from: "[limb]", to: "[limb", words: &["[limb"] },
];

#[test]
fn hold_that_is_too_short_for_the_gripper_is_a_warning() {
    let with = |more: &str| Desk::with_scene("hold = \"0.2 s\"", &format!("hold = \"0.2 s\"\n{more}"));
    let short = with("gripper = \"close\"").softlimb("check scene.toml");
    assert_eq!(short.code, Some(3), "{short:?}");
    let words = "`bend` ends before its gripper is closed: `hold` is 0.20 s, `gripper_time` 0.30 s";
    assert!(short.err.contains(words), "{}", short.err);
    let none = with("").softlimb("check scene.toml");
    assert!(!none.err.contains("gripper"), "{}", none.err);
}

/// The line of the scene, from 1, on which the mistake begins.
fn line_of(mistake: &Mistake) -> usize {
    let at = SCENE.find(mistake.from).expect("the scene has the passage");
    1 + SCENE[..at].matches('\n').count()
}

#[test]
fn mistakes_are_pointed_at_and_nothing_is_written() {
    for mistake in MISTAKES {
        let desk = Desk::with_scene(mistake.from, mistake.to);
        let place = format!("scene.toml:{}:", line_of(mistake));
        for verb in ["check", "run --out results"] {
            let answer = desk.softlimb(&format!("{verb} scene.toml")).failed(1, mistake.words).failed(1, &[&place]);
            assert!(answer.err.contains('^'), "nothing is underlined: {}", answer.err);
            assert_eq!(desk.content(), ["scene.toml"], "{verb}, {}", mistake.to);
        }
    }
}

#[test]
fn sound_scene_is_checked_without_writing() {
    let desk = Desk::with_scene("small", "small");
    let answer = desk.softlimb("check scene.toml").done();
    assert!(answer.out.starts_with("small, weightless: 1 module, 1 channel, 0.255 m at rest"), "{}", answer.out);
    let json = desk.softlimb("check scene.toml --json").done().json();
    // One actuator of 240 mm and a connector of 15 mm; one move of 1 s and a rest of 0.2 s.
    assert_eq!((&json["scene"], &json["channels"]), (&"small".into(), &1.into()));
    assert!((json["rest_length_m"].as_f64().unwrap() - 0.255).abs() < 1e-12, "{json}");
    assert!((json["duration_s"].as_f64().unwrap() - 1.2).abs() < 1e-9, "{json}");
    let highest_pa = json["modules"][0]["highest_pressure_pa"].as_f64().unwrap();
    assert!(highest_pa > 5e3 && highest_pa < 100e3, "{json}");
    // It says how the device will find the pressures, and how well.
    assert!(answer.out.contains(", by table within ") && answer.out.contains("of full scale"), "{}", answer.out);
    let error = json["modules"][0]["inverse_error"].as_f64().unwrap();
    assert!(json["modules"][0]["tables"] == true && error > 0.0 && error <= 1e-4, "{json}");
    assert_eq!(desk.content(), ["scene.toml"]);
}

/// A cup on a finger that is straight at first and bends in the vertical plane tilts by the bend angle.
#[test]
fn tilt_of_a_carried_object_is_checked_and_printed() {
    let object = "[[object]]\nname = \"cup\"\nradius = \"10 mm\"\nheight = \"20 mm\"\ngrasp = \"10 mm\"\nmass = \"0 kg\"\ntilt_max = \"MOST\"\n\n[[phase]]\nobject = \"cup\"";
    let desk = |most: &str| Desk::with_scene("[[phase]]", &object.replace("MOST", most));
    let kept = desk("31 deg");
    let answer = kept.softlimb("check scene.toml").done();
    assert!(answer.out.contains("object tilts by at most 30.0 deg"), "{}", answer.out);
    let json = kept.softlimb("check scene.toml --json").done().json();
    assert!((json["phases"][0]["tilt_rad"].as_f64().unwrap() - 30f64.to_radians()).abs() < 1e-3, "{json}");
    let words = &["tilts too much", "`cup` would tilt by 30.0 deg", "its `tilt_max` is 29.0 deg"];
    desk("29 deg").softlimb("check scene.toml").failed(1, words);
}

/// A twist rod with a helix and an axial thread is checked; commands that compute with one winding point at the second.
#[test]
fn two_windings_are_checked_and_otherwise_refused_at_the_line() {
    let thread = |name: &str, angle_deg: u32| {
        format!(
            "[windings.{name}]\nangle = \"{angle_deg} deg\"\nfamilies = 1\nmodulus = \"200 MPa\"\nthickness = \"0.1 mm\"\n"
        )
    };
    let scene = SCENE
        .replace("[limb]", &format!("{}{}[limb]", thread("helix", 30), thread("axial", 90)))
        .replace("motion = \"bending\"", "motion = \"twisting\"\nwinding = [\"helix\", \"axial\"]")
        .replace("bend_angle = \"30 deg\"", "twist = -1.5");
    let desk = Desk::new();
    desk.put("scene.toml", &scene);
    desk.put("data.csv", "");
    let json = desk.softlimb("check scene.toml --json").done().json();
    assert!(json["modules"][0]["tables"] == true, "{json}");
    let line = 1 + scene[..scene.find("winding = [").expect("wound twice")].matches('\n').count();
    let place = format!("scene.toml:{line}:");
    for (verb, room) in [
        ("fea export scene.toml", "fea"),
        ("fea compare scene.toml", "fea"),
        ("fea calibrate scene.toml", "fea"),
        ("statics scene.toml", "statics"),
        ("workspace scene.toml", "workspace"),
        ("tolerance scene.toml", "tolerance"),
        ("design limb scene.toml --out designed.toml", "design limb"),
        ("payload capacity scene.toml", "payload"),
        ("calibrate pressure data.csv --scene scene.toml --fit shear_modulus", "calibrate"),
        ("calibrate creep data.csv --scene scene.toml", "calibrate"),
    ] {
        let refused = format!("`finger` has two windings, and `{room}` takes one");
        desk.softlimb(verb).failed(1, &[&refused, &place, "[\"helix\", \"axial\"]"]);
    }
    assert_eq!(desk.content(), ["data.csv", "scene.toml"]);
    let made = desk.softlimb("fabricate scene.toml --no-mold --out made");
    assert!(matches!(made.code, Some(0 | 3)), "{made:?}");
    let files =
        ["made/finger-second-thread-straight.csv", "made/finger-thread-right.csv", "made/sheet.html", "made/sheet.md"];
    assert!(files.iter().all(|file| desk.content().contains(&file.to_string())), "{:?}", desk.content());
}
