//! Scenes with a mistake in them: the message points at the line and says the value, and nothing is written.

use serde_json::Value;

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

#[test]
fn payload_that_changes_without_a_gripper_is_a_warning() {
    let scene = include_str!("../../../scenes/loaded/carry-hanging.toml");
    let desk = Desk::new();
    desk.put("handed.toml", scene);
    let handed = desk.softlimb("check handed.toml");
    assert!(!handed.err.contains("the setpoints jump"), "{}", handed.err);
    desk.put("thrown.toml", scene.replace("gripper = \"open\"\n", "").replace("gripper = \"close\"\n", ""));
    let thrown = desk.softlimb("check thrown.toml");
    assert_eq!(thrown.code, Some(3), "{thrown:?}");
    let words = "`reach` ends with 0.00 kg at the tip and `pick` begins with 1.00 kg: without a `gripper` command \
                 the setpoints jump";
    assert!(thrown.err.contains(words), "{}", thrown.err);
    assert!(!thrown.err.contains("`lift` ends"), "{}", thrown.err);
}

/// Threads at 60 deg shorten an actuator. The model has an equilibrium at twice the length, far above the allowed pressures, on another branch.
#[test]
fn target_that_pressure_moves_away_from_is_refused_with_the_reason() {
    let windings = "[windings.steep]\nangle = \"60 deg\"\nfamilies = 2\nradius = \"12 mm\"\nmodulus = \"200 MPa\"\n\
                    thickness = \"0.2 mm\"\n\n[limb]";
    let desk = Desk::new();
    let scene = SCENE.replace("[limb]", windings).replace("\"bending\"", "\"extension\"\nwinding = \"steep\"");
    desk.put("scene.toml", scene.replace("bend_angle = \"30 deg\"", "axial_stretch = 2.0"));
    desk.softlimb("check scene.toml")
        .failed(1, &["axial_stretch = 2.0", "pressure moves `finger` away from this value"]);
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

/// A twist rod with a helix and an axial thread is checked and designed; the design under weight points at the second winding.
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
    let (from, to) = ("twist = -1.5", "twist = -1.4");
    assert!(scene.contains(from));
    desk.put("open.toml", format!("{}\n[design]\nfiber_angle = [\"20 deg\", \"40 deg\"]\n", scene.replace(from, to)));
    let designed = desk.softlimb("design limb open.toml --out designed.toml --json").done().json();
    let checked = desk.softlimb("check designed.toml --json").done().json();
    let pressure_pa = &designed["answer"]["segments"][0]["phases"][0]["pressure_pa"];
    let found_pa = &checked["modules"][0]["highest_pressure_pa"];
    let share = pressure_pa.as_f64().expect("a pressure") / found_pa.as_f64().expect("a pressure");
    assert!((share - 1.0).abs() < 1e-5, "{designed} {checked}");
    std::fs::remove_file(desk.path("open.toml")).expect("a scene");
    std::fs::remove_file(desk.path("designed.toml")).expect("a scene");
    assert_eq!(desk.content(), ["data.csv", "scene.toml"]);
    for verb in
        ["statics scene.toml", "workspace scene.toml --samples 2000", "workspace scene.toml --loaded --samples 64"]
    {
        let answer = desk.softlimb(verb);
        assert!(matches!(answer.code, Some(0 | 3)), "{verb}: {answer:?}");
    }
    let made = desk.softlimb("fabricate scene.toml --no-mold --out made");
    assert!(matches!(made.code, Some(0 | 3)), "{made:?}");
    let files =
        ["made/finger-second-thread-straight.csv", "made/finger-thread-right.csv", "made/sheet.html", "made/sheet.md"];
    assert!(files.iter().all(|file| desk.content().contains(&file.to_string())), "{:?}", desk.content());
}

/// A bender with hoops and a helix is checked and tabulated by finite elements; what has no model of it points at the second winding.
#[test]
fn bender_with_two_windings_is_checked_and_otherwise_refused_at_the_line() {
    let scene = SCENE
        .replace(
            "[limb]",
            "[windings.hoops]\nangle = \"3 deg\"\nfamilies = 2\nmodulus = \"200 MPa\"\nthickness = \"0.1 mm\"\n\
             [windings.helix]\nangle = \"40 deg\"\nfamilies = 1\nmodulus = \"2 MPa\"\nthickness = \"0.1 mm\"\n[limb]",
        )
        .replace("motion = \"bending\"", "motion = \"bending\"\nwinding = [\"hoops\", \"helix\"]");
    let desk = Desk::new();
    desk.put("scene.toml", &scene);
    desk.put("data.csv", "");
    let json = desk.softlimb("check scene.toml --json").done().json();
    assert!(json["modules"][0]["tables"] == true && json["warnings"].as_array().is_some_and(Vec::is_empty), "{json}");
    let curve = desk.softlimb("eval scene.toml --json").done().json().to_string();
    assert!(curve.contains("finite elements of the section"), "{curve}");
    let line = 1 + scene[..scene.find("winding = [").expect("wound twice")].matches('\n').count();
    let place = format!("scene.toml:{line}:");
    for (verb, room) in [
        ("statics scene.toml", "statics"),
        ("workspace scene.toml", "workspace"),
        ("workspace scene.toml --loaded", "workspace --loaded"),
        ("payload capacity scene.toml", "payload capacity"),
        ("payload estimate scene.toml --data data.csv", "payload estimate"),
    ] {
        let refused = format!("`finger` twists as it bends, and `{room}` takes benders that do not");
        desk.softlimb(verb).failed(1, &[&refused, &place, "[\"hoops\", \"helix\"]"]);
    }
    let led = scene.replace("targets = { finger = { bend_angle = \"30 deg\" } }", "tip = [0.0, 0.0, 0.5]");
    assert_ne!(led, scene);
    for (text, room) in [
        (&led, "`design limb` for way-points"),
        (&led.replace("[weight]\nsimulated = false\n", "[weight]\n"), "a limb with `[weight]`"),
    ] {
        desk.put("led.toml", text);
        let answer = desk.softlimb("design limb led.toml --out designed.toml");
        answer.failed(1, &[&format!("`finger` twists as it bends, and {room}"), "[\"hoops\", \"helix\"]"]);
    }
    desk.softlimb("tolerance scene.toml --samples 10").done();
    // Two families of the helix mirror each other.
    desk.put("plane.toml", scene.replace("\"40 deg\"\nfamilies = 1", "\"40 deg\"\nfamilies = 2"));
    for verb in ["statics plane.toml", "workspace plane.toml --loaded --samples 64", "payload capacity plane.toml"] {
        let answer = desk.softlimb(verb);
        assert!(matches!(answer.code, Some(0 | 3)) && !answer.err.contains("winding"), "{verb}: {answer:?}");
    }
}

/// `tolerance` bends by the model of `check`: at the pressure of the plan the nominal finger has the bend of its target, and loads bend that one.
#[test]
fn wound_bender_has_one_model_in_all_commands() {
    let thread =
        "[windings.helix]\nangle = \"15 deg\"\nfamilies = 2\nmodulus = \"20 MPa\"\nthickness = \"0.1 mm\"\n[limb]";
    let scene =
        SCENE.replace("[limb]", thread).replace("motion = \"bending\"", "motion = \"bending\"\nwinding = \"helix\"");
    let desk = Desk::new();
    desk.put("scene.toml", scene);
    let checked = desk.softlimb("check scene.toml --json").done().json();
    let bend = &checked["modules"][0]["bend"];
    assert_eq!(bend["model"], "section-fe");
    assert!(bend["analytic_error"].is_null(), "{bend}");
    let found = desk.softlimb("tolerance scene.toml --samples 10 --json").done().json();
    // An arc of 30 deg and a rigid part of 15 mm behind it, whatever the length of the arc.
    let tip_m: Vec<f64> =
        found["phases"][0]["nominal_tip_m"].as_array().expect("a tip").iter().filter_map(Value::as_f64).collect();
    let ([along, up], (sin, cos)) = ([tip_m[0], tip_m[2]], 30_f64.to_radians().sin_cos());
    let slope = (up - 0.015 * sin) / (along - 0.015 * cos);
    assert!((slope / 15_f64.to_radians().tan() - 1.0).abs() < 1e-5 && tip_m[1].abs() < 1e-12, "{found}");
    for verb in ["statics scene.toml", "payload capacity scene.toml"] {
        let answer = desk.softlimb(verb);
        assert!(matches!(answer.code, Some(0 | 3)) && !answer.err.contains("analytic"), "{verb}: {answer:?}");
    }
}

/// Two equal windings are one of twice the stiffness, under weight, in studies, runs, learning, sweeps and calibration.
#[test]
fn two_equal_windings_are_one_of_twice_the_stiffness() {
    let thread = |name: &str, modulus: u32| {
        format!(
            "[windings.{name}]\nangle = \"30 deg\"\nfamilies = 1\nmodulus = \"{modulus} MPa\"\nthickness = \"0.1 mm\"\n"
        )
    };
    let desk = Desk::new();
    let study = "format = 1\nscenes = [\"NAME.toml\"]\nlimbs = 2\n[[parameter]]\nkey = \"module.finger.outer_radius\"\nvalues = [\"14 mm\", \"15 mm\"]\n";
    for (name, winding) in [("two", "[\"half\", \"half\"]"), ("one", "\"whole\"")] {
        desk.put(&format!("{name}-study.toml"), study.replace("NAME", name));
        let scene = SCENE
            .replace("[limb]", &format!("{}{}[limb]", thread("half", 100), thread("whole", 200)))
            .replace("motion = \"bending\"", &format!("motion = \"twisting\"\nwinding = {winding}"))
            .replace("[weight]\nsimulated = false\n", "")
            .replace("hold = \"0.2 s\"", "hold = \"0.6 s\"")
            .replace("bend_angle = \"30 deg\"", "twist = -1.5");
        desk.put(&format!("{name}.toml"), scene);
    }
    desk.put("twists.csv", "pressure_kpa,twist_rad\n5,-0.235\n10,-0.47\n15,-0.725\n20,-0.98\n25,-1.25\n");
    for verb in [
        "check SCENE --json",
        "statics SCENE --json",
        "workspace SCENE --json --samples 2000",
        "workspace SCENE --json --loaded --samples 64",
        "tolerance SCENE --json --samples 20",
        "payload capacity SCENE --json",
        "run SCENE --json --out SCENE.run",
        "learn SCENE --iterations 1 --trials 1 --json",
        "calibrate pressure twists.csv --scene SCENE --fit shear_modulus --json --write fitted-SCENE",
        "check fitted-SCENE --json",
    ] {
        let [two, one] = ["two.toml", "one.toml"].map(|scene| {
            let answer = desk.softlimb(&verb.replace("SCENE", scene));
            assert!(matches!(answer.code, Some(0 | 3)), "{answer:?}");
            answer.json()
        });
        let mut numbers = 0;
        same(&two, &one, verb, &mut numbers);
        println!("{verb}: {numbers} numbers");
        assert!(numbers > 5, "{two}");
    }
    let [two, one] = ["two", "one"].map(|name| {
        let swept = desk.softlimb(&format!("sweep {name}-study.toml --out {name}.csv"));
        assert!(matches!(swept.code, Some(0 | 3)), "{swept:?}");
        let table = std::fs::read_to_string(desk.path(&format!("{name}.csv"))).expect("a table");
        let rows = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        rows.map(|row| row.split(',').filter_map(|cell| cell.parse::<f64>().ok()).collect::<Value>()).collect::<Value>()
    });
    let mut numbers = 0;
    same(&two, &one, "sweep", &mut numbers);
    assert!(numbers > 40, "{two}");
}

/// The same numbers, to 1e-4 of them, in the same places.
fn same(two: &Value, one: &Value, place: &str, numbers: &mut u32) {
    match (two, one) {
        (Value::Object(two), Value::Object(one)) => {
            assert!(two.keys().eq(one.keys()), "{place}: {two:?} {one:?}");
            // How fast a run was is no result of its scene.
            let each = two
                .iter()
                .zip(one.values())
                .filter(|((key, _), _)| !matches!(key.as_str(), "wall_s" | "real_time_factor"));
            each.for_each(|((key, two), one)| same(two, one, &format!("{place} {key}"), numbers));
        }
        (Value::Array(two), Value::Array(one)) => {
            assert_eq!(two.len(), one.len(), "{place}");
            two.iter().zip(one).for_each(|(two, one)| same(two, one, place, numbers));
        }
        (Value::Number(two), Value::Number(one)) => {
            let [two, one] = [two, one].map(|number| number.as_f64().expect("finite"));
            assert!((two - one).abs() <= 1e-4 * one.abs() + 1e-7, "{place}: {two} {one}");
            *numbers += 1;
        }
        _ => {}
    }
}

/// The limb reaches its goals in many postures, and the tilt of its bottle counts from that of the grasp, which the design states.
#[test]
fn planner_keeps_the_limb_that_is_designed_for_group_c() {
    let desk = Desk::new();
    desk.put("scene.toml", include_str!("../../../scenes/open/loaded-group-c.toml"));
    let designed = desk.softlimb("design limb scene.toml --seed 3 --out designed.toml --json").done().json();
    assert_eq!((&designed["reached"], &designed["refused"]), (&true.into(), &serde_json::Value::Null), "{designed}");
    assert!(std::fs::read_to_string(desk.path("designed.toml")).unwrap().contains("\ndirection = ["));
}

/// A module of segments is checked, drawn and made segment by segment; what has no model of it points at the second one.
#[test]
fn module_of_segments_is_checked_and_otherwise_refused_at_the_line() {
    let scene = include_str!("../../../scenes/extend-and-bend.toml");
    let desk = Desk::new();
    desk.put("scene.toml", scene);
    desk.put("data.csv", "");
    let checked = desk.softlimb("check scene.toml --json");
    assert!(checked.json()["modules"][0]["tables"] == true, "{checked:?}");
    let curve = desk.softlimb("eval scene.toml --json").done().json().to_string();
    assert!(curve.contains("segments in series at one pressure"), "{curve}");
    let line = 1 + scene[..scene.rfind("[[module.segments]]").expect("two of them")].matches('\n').count();
    let place = format!("scene.toml:{line}:1");
    for (verb, room) in [
        ("tolerance scene.toml", "tolerance"),
        ("payload capacity scene.toml", "payload capacity"),
        ("payload estimate scene.toml --data data.csv", "payload estimate"),
        ("payload track scene.toml --loads 1N", "payload track"),
        ("fea compare scene.toml", "fea"),
        ("fea calibrate scene.toml", "fea"),
        ("fea export scene.toml", "fea"),
        ("fea run scene.toml", "fea"),
        ("calibrate pressure data.csv --scene scene.toml --fit shear_modulus", "calibrate"),
        ("calibrate creep data.csv --scene scene.toml", "calibrate"),
    ] {
        let refused = format!("`finger` has several segments, and `{room}` takes modules of one");
        desk.softlimb(verb).failed(1, &[&refused, &place, "[[module.segments]]"]);
    }
    assert_eq!(desk.content(), ["data.csv", "scene.toml"]);
    for verb in
        ["statics scene.toml", "workspace scene.toml --samples 2000", "workspace scene.toml --loaded --samples 64"]
    {
        let answer = desk.softlimb(verb);
        assert!(matches!(answer.code, Some(0 | 3)), "{verb}: {answer:?}");
    }
    // With all sizes given the design is the scene with its pressures.
    let text = desk.softlimb("design limb scene.toml --out designed.toml").done().out;
    assert!(
        text.contains("reached: highest pressure") && text.contains("finger segment 2: inner radius 6.0000 mm"),
        "{text}"
    );
    let curl = text.lines().find(|line| line.starts_with("curl")).expect("a line for the phase");
    assert_eq!(curl.split_whitespace().skip(2).take(4).collect::<Vec<_>>(), ["60.0000", "deg", "60.0000", "deg"]);
    let designed = desk.softlimb("design limb scene.toml --out designed.toml --json").done().json();
    assert_eq!(designed["answer"]["modules"].as_array().map(Vec::len), Some(2), "{designed}");
    assert!(matches!(desk.softlimb("check designed.toml").code, Some(0)));
    let made = desk.softlimb("fabricate scene.toml --no-mold --out made");
    assert!(matches!(made.code, Some(0 | 3)), "{made:?}");
    assert!(desk.content().contains(&"made/finger.1-thread-right.csv".to_owned()), "{:?}", desk.content());
}

/// `check` has a line and an entry for the bend of each wound segment, as for a module of one.
#[test]
fn check_names_the_bend_of_each_segment() {
    let scene = include_str!("../../../scenes/extend-and-bend.toml");
    let helix =
        "[windings.helix]\nangle = \"15 deg\"\nfamilies = 2\nmodulus = \"20 MPa\"\nthickness = \"0.1 mm\"\n[limb]";
    let hoop = "[[module.segments]]\nmotion = \"bending\"\nlength = \"30 mm\"\nwinding = \"hoop\"\n";
    let wound = scene.replace("[limb]", helix).replace(
        "motion = \"bending\"\nlength = \"100 mm\"",
        &format!("motion = \"bending\"\nlength = \"100 mm\"\nwinding = \"helix\"\n{hoop}"),
    );
    // The same segments as modules, which are checked by themselves.
    let module = |winding: &str, length: &str| {
        let (before, after) = scene.split_once("[[module.segments]]").expect("two");
        let weight = &after[after.find("[weight]").expect("behind the modules")..];
        let own = format!("{before}length = \"{length}\"\nwinding = \"{winding}\"\n{weight}");
        own.replace("[limb]", helix).replace("60 deg", "20 deg").replace("25 deg", "10 deg")
    };
    let desk = Desk::new();
    desk.put("scene.toml", wound);
    desk.put("helix.toml", module("helix", "100 mm"));
    desk.put("hoop.toml", module("hoop", "30 mm"));
    let bends = &desk.softlimb("check scene.toml --json").json()["modules"][0]["segment_bends"];
    let [helix, hoop] =
        ["helix", "hoop"].map(|name| desk.softlimb(&format!("check {name}.toml --json")).json()["modules"][0].clone());
    assert_eq!(bends.as_array().map(Vec::len), Some(3), "{bends}");
    assert!(bends[0].is_null() && helix.get("segment_bends").is_none(), "{bends} {helix}");
    let model = |bend: &Value| bend["model"].as_str().map(str::to_owned);
    assert_eq!(model(&bends[1]), Some("section-fe".to_owned()));
    for (own, alone) in [(&bends[1], &helix["bend"]), (&bends[2], &hoop["bend"])] {
        assert!(model(own).is_some() && model(own) == model(alone), "{own} {alone}");
    }
    let evaluated = desk.softlimb("eval scene.toml --json").done().json();
    assert_eq!(&evaluated["segment_bends"], &serde_json::json!([bends]), "{evaluated}");
    // At 15 deg two more or less change the bend by some per cent.
    let off = bends[1]["winding_2deg"].as_f64().expect("a share");
    assert!((0.03..0.1).contains(&off), "{bends}");
    // Every verb that plans with the bend says so, too.
    for verb in [
        "statics helix.toml",
        "workspace helix.toml --samples 2000",
        "workspace helix.toml --loaded --samples 64",
        "tolerance helix.toml --samples 100",
        "payload capacity helix.toml",
        "design limb helix.toml --out designed.toml",
        "run helix.toml",
    ] {
        let json = desk.softlimb(&format!("{verb} --json")).json();
        assert_eq!(json["bends"], serde_json::json!([helix["bend"]]), "{verb}: {json}");
        let words = desk.softlimb(verb);
        assert!((words.out + &words.err).contains("2 deg of fiber angle change the bend by up to"), "{verb}");
    }
    let text = desk.softlimb("check scene.toml").out;
    assert!(text.contains("  finger.2         bends by finite elements"), "{text}");
    assert!(text.contains(&format!("2 deg of fiber angle change the bend by up to {:.1} %", 100.0 * off)), "{text}");
    assert!(text.contains("  finger.3         bends by") && !text.contains("finger.1 "), "{text}");
}
