//! `softlimb payload capacity` and `design bundle` as their user meets them.

use std::fs;
use std::process::{Command, Output};

use serde_json::Value;

/// A problem of eq. (18).
const FORCES: &str = include_str!("../design/tests/problems/forces.json");

fn softlimb(verb: [&str; 2], words: &[&str]) -> Output {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    Command::new(env!("CARGO_BIN_EXE_softlimb")).args(verb).args(words).current_dir(scenes).output().unwrap()
}

fn payload(words: &[&str]) -> Output {
    softlimb(["payload", "capacity"], words)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

const SCENE: &str = "scenes/weightless-a.toml";

#[test]
fn poses_of_a_scene_have_their_largest_load_with_a_certificate() {
    let output = payload(&[SCENE, "--direction", "-1,0,0", "--spacers", "3", "--json"]);
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let poses = said["poses"].as_array().unwrap();
    assert_eq!(poses.len(), 5, "at rest and four phases");
    let weight = said["mass_kg"].as_f64().unwrap() * 9.80665;
    assert!(poses.iter().all(|pose| pose["own_weights_held"].as_f64().is_none_or(|share| share >= -1e-6)));
    for pose in poses.iter().filter(|pose| pose["outcome"] == "solved") {
        let [load, bound] = ["load_n", "certified_bound_n"].map(|name| pose[name].as_f64().unwrap());
        assert!(bound - load <= 1e-6 * (1.0 + load.abs()) && bound >= load - 1e-6 * (1.0 + load.abs()), "{pose}");
        assert!((pose["load_to_weight"].as_f64().unwrap() - load / weight).abs() < 1e-9);
        assert!(pose["load_without_buckling_n"].as_f64().unwrap() >= load - 1e-6);
        assert!(pose["remainder"].as_f64().unwrap() < 0.03, "{pose}");
        let highest =
            pose["modules"].as_array().unwrap().iter().flat_map(|module| module["pressures_pa"].as_array().unwrap());
        assert!(highest.map(|p| p.as_f64().unwrap()).all(|p| (0.0..=1e5).contains(&p)));
    }
    let designs = said["designs"].as_array().unwrap();
    assert_eq!(designs.len(), 4);
    for design in designs {
        assert!(design["objective"].as_f64().unwrap() <= 1e-16, "{design}");
        let curve = design["push_n_by_pressure_pa"].as_array().unwrap();
        let wanted = design["wanted_n"].as_f64().unwrap();
        assert!(curve.last().unwrap()[1].as_f64().unwrap() >= wanted * (1.0 - 1e-9), "met at the highest pressure");
    }
}

/// Three axially wound tubes that expand. The force of threads nearly along the axis is almost a step of the pressure.
const EXPANDING: &str = r#"format = 1
name = "soft"

[materials.rubber]
law = "neo-hookean"
shear_modulus = "0.1 MPa"

[windings.axial]
angle = "ANGLE"
families = 2
modulus = "300 MPa"
thickness = "0.2 mm"

[limb]
base_direction = [1, 0, 0]
base_up = [0, 0, 1]
connector = { length = "10 mm", mass = "50 g" }

[[module]]
name = "tube"
motion = "expansion"
actuators = 3
circle_radius = "20 mm"
spacers = 2
inner_radius = "6 mm"
outer_radius = "8 mm"
length = "100 mm"
material = "rubber"
winding = "axial"

[weight]
simulated = false

[[phase]]
name = "a"
duration = "1 s"
targets = { tube = { pressure = "15 kPa" } }
"#;

#[test]
fn load_without_an_equilibrium_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("expanding.toml");
    let held = |angle: &str| {
        fs::write(&file, EXPANDING.replace("ANGLE", angle)).unwrap();
        let output = payload(&[file.to_str().unwrap(), "--json"]);
        let said: Value = serde_json::from_slice(&output.stdout).unwrap();
        let pose = said["poses"].as_array().unwrap().iter().find(|pose| pose["name"] == "a").unwrap();
        (pose["remainder"].as_f64().unwrap(), text(&output.stderr), output.status.code())
    };
    let (remainder, told, _) = held("85 deg");
    assert!(remainder <= 0.03 && !told.contains("found no equilibrium for a"), "{remainder}: {told}");
    let (remainder, told, code) = held("89 deg");
    assert!(remainder > 0.03 && told.contains("found no equilibrium for a"), "{remainder}: {told}");
    assert_eq!(code, Some(3));
}

#[test]
fn table_and_the_picture_are_for_people() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("push.svg");
    let polar = folder.path().join("loads.svg");
    let output = payload(&[SCENE, "--svg", picture.to_str().unwrap(), "--polar", polar.to_str().unwrap()]);
    let table = text(&output.stdout);
    for word in ["at rest", "reach", "place", "buckle", "limits", "eq. (18)"] {
        assert!(table.contains(word), "{word}:\n{table}");
    }
    let designs = fs::read_to_string(&picture).unwrap();
    assert!(designs.starts_with("<svg ") && designs.contains(" N required of A<"), "{designs}");
    let diagrams = fs::read_to_string(&polar).unwrap();
    assert!(["at rest", "reach", "force on the tip"].iter().all(|word| diagrams.contains(word)), "{diagrams}");
    let fallen = table.lines().any(|line| line.contains("no pressures balance")) || table.contains(" -");
    assert!(matches!(output.status.code(), Some(0 | 3)), "{table}");
    assert!(output.status.code() == Some(0) || fallen, "{table}");
}

#[test]
fn wrong_words_and_wrong_scenes_are_answered() {
    for (words, code, expected) in [
        (vec![SCENE, "--direction", "0,0,0"], 2, "--direction 0,0,0 is not allowed"),
        (vec![SCENE, "--direction", "1,2"], 2, "--direction has 2 values"),
        (
            vec![SCENE, "--buckling-share", "2"],
            2,
            "invalid value '2' for '--buckling-share <RATIO>': the range is > 0, at most 1",
        ),
        (vec!["nowhere.toml"], 1, "nowhere.toml"),
        (vec![], 2, "required"),
        (vec!["scenes/single-bending.toml", "--svg", "x.svg"], 1, "no module that extends"),
    ] {
        let output = payload(&words);
        let said = text(&output.stderr);
        assert!(said.contains(expected), "{words:?}: {said}");
        assert_eq!(output.status.code(), Some(code), "{words:?}: {said}");
    }
}

#[test]
fn problem_is_answered_and_its_mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("forces.json");
    fs::write(&file, FORCES).unwrap();
    let file = file.to_str().unwrap();
    let bundle = |words: &[&str]| softlimb(["design", "bundle"], words);
    let found: Value = serde_json::from_slice(&bundle(&[file, "--json"]).stdout).unwrap();
    assert_eq!(found["status"], "reached");
    assert!(found["objective"].as_f64().unwrap() <= 1e-18);
    assert!(text(&bundle(&[file]).stdout).starts_with("reached: objective"));
    fs::write(file, FORCES.replace("\"format\": 1", "\"format\": 7")).unwrap();
    let output = bundle(&[file]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("forces.json: line 2: format = 7 is not allowed: 1"));
}
