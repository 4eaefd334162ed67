//! `softlimb fea compare` and `fea calibrate`.

use crate::cli::desk::{Desk, SCENE};

/// A shell script in place of CalculiX.
fn in_place(desk: &Desk, script: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    use std::process::Command;
    desk.put("draft", format!("#!/bin/sh\n{script}\n"));
    std::fs::set_permissions(desk.path("draft"), std::fs::Permissions::from_mode(0o755)).unwrap();
    // A file cannot be started while anybody has it open for writing: a child that another thread forks would have what this process has.
    assert!(Command::new("cp").args([desk.path("draft"), desk.path("program")]).status().unwrap().success());
    desk.path("program").display().to_string()
}

#[test]
fn scene_is_compared() {
    let desk = Desk::with_scene("small", "small");
    let done = desk.softlimb("fea compare scene.toml --json");
    assert_eq!(done.code, Some(0), "{}", done.err);
    let rows = done.json()["rows"].as_array().unwrap().clone();
    assert_eq!(rows.len(), 6);
    for row in &rows {
        assert_eq!(row["case"], "finger");
        assert!(row["analytic_difference"].as_f64().unwrap().abs() < 0.03, "{row}");
        assert!(row["calculix"].is_null(), "{row}");
    }
    let table = desk.softlimb("fea compare scene.toml --svg picture.svg").out;
    assert!(table.starts_with("finger: bend angle, deg\n"), "{table}");
    assert!(table.lines().last().is_some_and(|line| line.starts_with("a curve takes the section ")), "{table}");
    assert!(std::fs::read_to_string(desk.path("picture.svg")).unwrap().starts_with("<svg "));
}

/// The scene's finger with other windings, each of its name, angle in degrees, families and modulus in MPa.
fn rewound(motion: &str, target: &str, windings: [(&str, u32, u32, u32); 2]) -> String {
    let winding = |(name, angle_deg, families, modulus): (&str, u32, u32, u32)| {
        format!(
            "[windings.{name}]\nangle = \"{angle_deg} deg\"\nfamilies = {families}\nmodulus = \"{modulus} MPa\"\nthickness = \"0.1 mm\"\n"
        )
    };
    let [first, second] = windings.map(|(name, ..)| name);
    SCENE
        .replace("[limb]", &format!("{}[limb]", windings.map(winding).concat()))
        .replace("motion = \"bending\"", &format!("motion = \"{motion}\"\nwinding = [\"{first}\", \"{second}\"]"))
        .replace("bend_angle = \"30 deg\"", target)
}

/// The analytic model of a straight rod with two windings is exact; a bender has finite elements and their cubic alone.
#[test]
fn two_windings_are_compared_and_calibrated() {
    let desk = Desk::new();
    desk.put("rod.toml", rewound("twisting", "twist = -1.5", [("helix", 30, 1, 200), ("axial", 90, 1, 200)]));
    desk.put("bender.toml", rewound("bending", "bend_angle = \"30 deg\"", [("hoops", 3, 2, 200), ("helix", 40, 1, 2)]));
    let rows = |scene: &str| {
        let json = desk.softlimb(&format!("fea compare {scene} --json --svg {scene}.svg")).done().json();
        json["rows"].as_array().expect("rows").clone()
    };
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    for row in rows("rod.toml") {
        assert!(number(&row["analytic_difference"]).abs() < 1e-4 && number(&row["section"]).abs() > 0.01, "{row}");
    }
    let bends = rows("bender.toml");
    for row in &bends {
        assert!(row["analytic"].is_null() && row["analytic_difference"].is_null(), "{row}");
        let [cubic, section] = ["calibrated", "section"].map(|key| number(&row[key]));
        assert!(section > 1.0 && (cubic / section - 1.0).abs() < 0.02, "{row}");
    }
    let calibrated = |scene: &str| {
        let answer = desk.softlimb(&format!("fea calibrate {scene} --json"));
        answer.done().json()["modules"][0].clone()
    };
    let module = calibrated("bender.toml");
    let [a, b, c] = [0, 1, 2].map(|k| number(&module["bending"]["coefficients_pa"][k]));
    for row in &bends[2..] {
        let phi = number(&row["section"]).to_radians();
        let pressure_pa = phi * (a + phi * (b + phi * c));
        assert!((pressure_pa / (1e3 * number(&row["pressure_kpa"])) - 1.0).abs() < 0.02, "{row} {pressure_pa}");
    }
    assert!(number(&module["ends"]["axial"]["delta_m"]) > 0.0, "{module}");
    let module = calibrated("rod.toml");
    assert!(module["bending"].is_null() && number(&module["ends"]["twist"]["delta_m"]) > 0.0, "{module}");
    let answer = desk.softlimb("fea calibrate rod.toml --thread 772,3,0.178");
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.out.contains("thread: the module has two windings"), "{answer:?}");
}

#[test]
fn run_of_calculix_that_fails_costs_its_column_only() {
    let desk = Desk::with_scene("small", "small");
    let program = in_place(&desk, "kill -9 $$");
    let done = desk.softlimb(&format!("fea compare scene.toml --calculix --ccx {program}"));
    assert_eq!(done.code, Some(3), "{}", done.err);
    assert!(done.err.contains("warning: finger: CalculiX was killed by signal 9"), "{}", done.err);
    assert!(done.out.contains("finger: bend angle, deg"), "{}", done.out);
    let missing = desk.softlimb("fea compare scene.toml --calculix --ccx no-such-program");
    assert_eq!(missing.code, Some(1));
    assert!(missing.err.contains("apt-get install calculix-ccx"), "{}", missing.err);
}

#[test]
fn run_and_compare_end_calculix_by_the_same_option() {
    let desk = Desk::with_scene("small", "small");
    let program = in_place(&desk, "exec sleep 60");
    for verb in ["run", "compare --calculix"] {
        for seconds in ["0", "-1", "nan", "soon"] {
            let done = desk.softlimb(&format!("fea {verb} scene.toml --timeout {seconds}"));
            assert_eq!(done.code, Some(2), "{verb} {seconds}: {}", done.err);
            assert!(done.err.contains("--timeout"), "{verb} {seconds}: {}", done.err);
        }
        let done = desk.softlimb(&format!("fea {verb} scene.toml --ccx {program} --timeout 0.3"));
        let expected = if verb == "run" { (1, "the time was up") } else { (3, "took more than 0.3 s") };
        assert_eq!(done.code, Some(expected.0), "{verb}: {}", done.err);
        assert!(done.err.contains(expected.1), "{verb}: {}", done.err);
    }
}

#[test]
fn scene_is_calibrated() {
    let desk = Desk::with_scene("small", "small");
    let done = desk.softlimb("fea calibrate scene.toml --thread 772,3,0.18 --json");
    assert_eq!(done.code, Some(0), "{}", done.err);
    let module = &done.json()["modules"][0];
    assert!(module["bending"]["verified_error"].as_f64().unwrap() < 5e-3, "{module}");
    // A winding on the surface: 0.2 to 0.3 walls of 4 mm.
    let axial_m = module["ends"]["axial"]["delta_m"].as_f64().unwrap();
    assert!((0.8e-3..1.25e-3).contains(&axial_m), "{module}");
    let [effective, ideal] = ["effective_n_per_m", "ideal_n_per_m"].map(|key| module["thread"][key].as_f64().unwrap());
    assert!(effective < 0.5 * ideal && (ideal - 772.0 / 0.012).abs() < 1e-6 * ideal, "{module}");
}

/// What one module cannot be told keeps the rest, and the reason is given.
#[test]
fn impossible_calibrations_are_reported() {
    let winding =
        "[windings.net]\nangle = \"60 deg\"\nfamilies = 2\nmodulus = \"1 MPa\"\nthickness = \"0.1 mm\"\n\n[limb]";
    let desk = Desk::with_scene("[limb]", winding);
    desk.put(
        "scene.toml",
        std::fs::read_to_string(desk.path("scene.toml"))
            .unwrap()
            .replace("material =", "winding = \"net\"\nmaterial ="),
    );
    let done = desk.softlimb("fea calibrate scene.toml --thread 772,3,0.18 --json");
    assert_eq!(done.code, Some(3), "{}", done.err);
    let module = &done.json()["modules"][0];
    assert!(module["thread"]["error"].as_str().unwrap().contains("the winding is at 60 deg"), "{module}");
}

#[test]
fn calibration_that_makes_no_sense_is_refused() {
    let desk = Desk::with_scene("small", "small");
    for (arguments, code, word) in [
        ("--thread 772,3", 2, "--thread has 2 values"),
        ("--thread 772,0.1,0.18", 1, "is not allowed: less than the spacing"),
        ("--thread 772,-3mm,0.18", 2, "--thread: -3mm is not allowed: the range is > 0 mm, at most 10000 mm"),
        ("--module toe", 1, "there is no module \"toe\": one of finger"),
    ] {
        let done = desk.softlimb(&format!("fea calibrate scene.toml {arguments}"));
        assert!(done.code == Some(code) && done.err.contains(word), "{word}: {}", done.err);
    }
}

const FINGER: &str = r#"{"motion":"extension","problem":"forward","inner_radius_m":0.006,"outer_radius_m":0.008,"length_m":0.1,
"material":{"law":"neo-hookean","shear_modulus_pa":2e5},
"fiber":{"angle_deg":3,"families":2,"modulus_pa":3.61e8,"thickness_m":0.000178},"pressure_pa":4e4}"#;

#[test]
fn actuator_needs_no_scene() {
    let desk = Desk::with_scene("small", "small");
    desk.put("finger.json", FINGER);
    let done = desk.softlimb("fea export finger.json --out decks --points 2");
    assert_eq!(done.code, Some(0), "{}", done.err);
    let deck = std::fs::read_to_string(desk.path("decks/finger.inp")).unwrap();
    // The last step ends at the pressure of the file, in MPa.
    assert_eq!(deck.matches("*STEP").count(), 2, "{deck}");
    let load = deck.lines().rfind(|line| line.starts_with("LUMEN")).and_then(|line| line.rsplit(',').next());
    assert_eq!(load.and_then(|mpa| mpa.trim().parse().ok()), Some(0.04), "{deck}");
    for (from, to, expected) in [
        (
            "\"pressure_pa\":4e4",
            "\"pressure_pa\":-1",
            "finger.json: pressure_pa = -1 is not allowed here: finite and > 0",
        ),
        ("\"outer_radius_m\":0.008", "\"outer_radius_m\":0.004", "outer_radius_m = 0.004 is not allowed"),
        ("\"angle_deg\":3", "\"angle_deg\":93", "fiber.angle_deg = 93 is not allowed"),
        ("\"motion\"", "\"moton\"", "unknown field `moton`"),
        ("\"pressure_pa\"", "\"external_force_n\":1,\"pressure_pa\"", "external_force_n = 1 is not allowed here: 0"),
    ] {
        assert!(FINGER.contains(from));
        desk.put("finger.json", FINGER.replace(from, to));
        let done = desk.softlimb("fea export finger.json --out refused");
        assert_eq!(done.code, Some(1), "{}", done.err);
        assert!(done.err.contains(expected), "{expected}: {}", done.err);
        assert!(!desk.path("refused").exists());
    }
    let done = desk.softlimb("fea export finger.json --bundle");
    assert_eq!(done.code, Some(2), "{}", done.err);
}
