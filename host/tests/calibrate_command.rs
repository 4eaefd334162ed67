//! The command: files in, values, picture and scene out.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use fra_model::{ActuatorParameters, Fiber, Material};
use serde_json::Value;
use softlimb_fea::cross_section::{EndLoad, Options, Section};
use softlimb_scene as scene;

use crate::tube::{Tube, grid};

/// Two modules of one material.
const SCENE: &str = r#"format = 1
name = "two"
weight.simulated = false

[materials.silicone]          # cast in spring
law = "neo-hookean"
shear_modulus = "0.24 MPa"    # from the data sheet

[windings.helix]
angle = 0.35
families = 2
modulus = "4 MPa"
thickness = "0.2 mm"

[limb]
connector = { length = "15 mm", mass = "50 g" }

[[module]]
name = "arm"
motion = "extension"
actuators = 1
inner_radius = "9 mm"
outer_radius = "13 mm"
length = "200 mm"
material = "silicone"
winding = "helix"

[[module]]
name = "finger"
motion = "bending"
actuators = 1
inner_radius = "6 mm"
outer_radius = "8 mm"
length = "100 mm"
material = "silicone"

[[phase]]
name = "out"
duration = "1 s"
hold = "2 s"
targets = { arm = { axial_stretch = 1.03 }, finger = { bend_angle = "20 deg" } }

[[phase]]
name = "further"
duration = "1 s"
hold = "2 s"
targets = { arm = { axial_stretch = 1.07 }, finger = { bend_angle = "45 deg" } }

[[phase]]
name = "furthest"
duration = "1 s"
hold = "2 s"
targets = { arm = { axial_stretch = 1.1 }, finger = { bend_angle = "70 deg" } }

[limits]
pressure_max = "150 kPa"
"#;

/// Stretch of the arm at 0.2 MPa by its stresses, with a column of the pressure in kPa.
fn table() -> String {
    let mut text = "module,pressure_kpa,axial_stretch,outer_radius_mm\n".to_owned();
    for stretch in grid(1.01, 1.12, 8) {
        let held = Tube::soft().at_stretch(stretch);
        let _ = writeln!(text, "arm,{},{},{}", held.pressure * 1e-3, held.stretch, held.outer * 1e3);
    }
    text
}

struct Answer {
    code: i32,
    out: String,
    err: String,
}

fn softlimb(folder: &Path, line: &str) -> Answer {
    let words = line.split_whitespace();
    let output = Command::new(env!("CARGO_BIN_EXE_softlimb")).args(words).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Answer { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

fn desk(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    folder
}

#[test]
fn table_gives_the_material_and_a_scene_that_keeps_its_comments() {
    let folder = desk(&[("scene.toml", SCENE), ("arm.csv", &table())]);
    let line = "calibrate pressure arm.csv --scene scene.toml --fit shear_modulus,fiber_angle --write fitted.toml --svg fit.svg --json";
    let answer = softlimb(folder.path(), line);
    assert_eq!(answer.code, 0, "{}", answer.err);
    let json: Value = serde_json::from_str(&answer.out).unwrap();
    let [modulus, angle] = [0, 1].map(|k| &json["estimates"][k]);
    assert!((modulus["value"].as_f64().unwrap() / 0.2e6 - 1.0).abs() < 1e-6, "{modulus}");
    assert!((angle["value"].as_f64().unwrap() / 0.35 - 1.0).abs() < 1e-6, "{angle}");
    assert_eq!(modulus["modules"], serde_json::json!(["arm", "finger"]));
    let written = std::fs::read_to_string(folder.path().join("fitted.toml")).unwrap();
    assert!(written.contains("# from the data sheet") && written.contains("# cast in spring"), "{written}");
    assert!(!written.contains("0.24 MPa"), "{written}");
    let fitted = scene::load(folder.path().join("fitted.toml")).unwrap();
    for module in fitted.modules() {
        assert!((module.material.shear_modulus_pa() / 0.2e6 - 1.0).abs() < 1e-6);
    }
    // Ordinary valves step the 17 mL of its finger by 5 kPa; nothing else is amiss.
    let checked = softlimb(folder.path(), "check fitted.toml");
    assert_eq!(checked.code, 3, "{}", checked.err);
    assert!(checked.err.lines().all(|line| line.contains("the valves are coarse")), "{}", checked.err);
    let svg = std::fs::read_to_string(folder.path().join("fit.svg")).unwrap();
    assert!(svg.contains("axial stretch: measured less fit") && svg.ends_with("</svg>\n"), "{}", svg.len());
}

#[test]
fn module_of_its_own_gets_a_material_of_its_own() {
    let folder = desk(&[("scene.toml", SCENE), ("arm.csv", &table())]);
    let line = "calibrate pressure arm.csv --scene scene.toml --fit shear_modulus,wall --per module --write fitted.toml --accuracy 1e-5";
    let answer = softlimb(folder.path(), line);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(answer.out.contains("shear_modulus of arm, MPa") && answer.out.contains("in the scene:"), "{}", answer.out);
    let fitted = scene::load(folder.path().join("fitted.toml")).unwrap();
    let moduli: Vec<f64> = fitted.modules().iter().map(|module| module.material.shear_modulus_pa()).collect();
    assert!((moduli[0] / 0.2e6 - 1.0).abs() < 1e-6, "{moduli:?}");
    assert_eq!(moduli[1], 0.24e6);
}

#[test]
fn the_log_of_a_run_gives_the_moduli_of_the_limb_that_ran() {
    let exact = "\n[plant.chamber]\ncreep_share = 0\n\n[plant.spread]\nmodulus = 0\nwall = 0\nfiber_angle = 0\nsensor_offset = 0\nsensor_gain = 0\n";
    let real = SCENE.replace("0.24 MPa", "0.2 MPa") + exact;
    let folder = desk(&[("real.toml", &real), ("scene.toml", SCENE)]);
    let run = softlimb(folder.path(), "run real.toml --out out");
    assert!(run.code == 0 || run.code == 3, "{}", run.err);
    let answer = softlimb(
        folder.path(),
        "calibrate run out/run.mcap --scene scene.toml --fit shear_modulus --per module --json --accuracy 0.01",
    );
    assert!(answer.code == 0 || answer.code == 3, "{}", answer.err);
    let json: Value = serde_json::from_str(&answer.out).unwrap();
    for estimate in json["estimates"].as_array().unwrap() {
        let value = estimate["value"].as_f64().unwrap();
        println!("{estimate}");
        // Sensors sit at the valves and have 60 Pa of noise and 50 Pa of rounding.
        assert!((value / 0.2e6 - 1.0).abs() < 0.02, "{estimate}");
    }
    assert_eq!(json["estimates"].as_array().unwrap().len(), 2);
    assert!(json.get("tips").is_none(), "a weightless run has no tips to fit to");
    // The command warns of a truncated log and uses the holds before the cut.
    let whole = std::fs::read(folder.path().join("out/run.mcap")).unwrap();
    std::fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() * 9 / 10]).unwrap();
    let cut = softlimb(folder.path(), "calibrate run cut.mcap --scene scene.toml --fit shear_modulus --accuracy 0.01");
    assert_eq!(cut.code, 3, "{}", cut.err);
    assert!(cut.err.contains("warning: cut.mcap: ") && cut.err.contains(": the holds before count"), "{}", cut.err);
    let refused =
        softlimb(folder.path(), "calibrate run out/run.mcap --scene scene.toml --fit shear_modulus --per actuator");
    assert_eq!(refused.code, 2, "{}", refused.out);
    assert!(refused.err.contains("a run under weight"), "{}", refused.err);
}

/// A hanging arm whose modules deviate from their material.
const ARM: &str = include_str!("../rig/tests/calibrate/arm.toml");

#[test]
fn run_under_weight_is_calibrated_and_the_scene_drives_the_same_limb() {
    let folder = desk(&[("arm.toml", ARM), ("scene.toml", SCENE)]);
    let run = |line: &str| {
        let answer = softlimb(folder.path(), line);
        assert!(answer.code == 0 || answer.code == 3, "{line}: {}", answer.err);
        answer.out
    };
    let error_m = |line: &str| {
        let json: Value = serde_json::from_str(&run(line)).unwrap();
        json["tip"]["error_m"]["rmse"].as_f64().unwrap()
    };
    let before_m = error_m("run arm.toml --out before --json");
    let line = "calibrate run before/run.mcap --fit shear_modulus --per module --write cal.toml";
    let json: Value = serde_json::from_str(&run(&format!("{line} --json"))).unwrap();
    // Four holds; the payload is picked up in the second and put down in the last.
    let payloads: Vec<f64> =
        json["tips"].as_array().unwrap().iter().map(|tip| tip["payload_kg"].as_f64().unwrap()).collect();
    assert!(payloads.len() == 4 && payloads[0] == 0.0 && (payloads[2] - 0.06).abs() < 1e-12, "{payloads:?}");
    assert!((0.05..0.06).contains(&payloads[1]) && (0.0..0.01).contains(&payloads[3]), "{payloads:?}");
    assert!(run(line).contains("tip position"));
    let after_m = error_m("run cal.toml --plant arm.toml --out after --json");
    println!("{before_m} {after_m}");
    assert!(after_m < 0.5 * before_m, "{before_m} {after_m}");
    // Three tubes a module, which bend the arm where they are unequal.
    let bundles = ARM.replace("actuators = 1", "actuators = 3\ncircle_radius = \"40 mm\"");
    std::fs::write(folder.path().join("bundles.toml"), bundles).unwrap();
    let before_m = error_m("run bundles.toml --out bundles --json");
    run("calibrate run bundles/run.mcap --fit shear_modulus --per actuator --write tubes.toml --corrections tubes.csv");
    let tubes = std::fs::read_to_string(folder.path().join("tubes.toml")).unwrap();
    std::fs::write(folder.path().join("tubes.toml"), tubes + "\n[corrections]\nfile = \"tubes.csv\"\n").unwrap();
    let after_m = error_m("run tubes.toml --plant bundles.toml --out after --json");
    println!("{before_m} {after_m}");
    assert!(after_m < 0.3 * before_m, "{before_m} {after_m}");
    for (line, expected) in [
        ("run cal.toml --plant scene.toml --out other", "has other modules: arm, finger"),
        ("calibrate run before/run.mcap --fit length", "length is not fitted to a run under weight"),
    ] {
        let answer = softlimb(folder.path(), line);
        assert_eq!(answer.code, 1, "{line}: {}", answer.out);
        assert!(answer.err.contains(expected), "{line}: {}", answer.err);
    }
}

#[test]
fn tensile_test_goes_into_the_scene_with_a_warning_where_it_does_not_reach() {
    let mut csv = "stretch,nominal_stress_kpa\n".to_owned();
    for stretch in grid(1.01, 1.05, 9) {
        let _ = writeln!(csv, "{stretch},{}", 180.0 * (stretch - stretch.powi(-2)));
    }
    let folder = desk(&[("scene.toml", SCENE), ("test.csv", &csv)]);
    let answer =
        softlimb(folder.path(), "calibrate tension test.csv --scene scene.toml --law neo-hookean --write fitted.toml");
    assert_eq!(answer.code, 3, "{}", answer.err);
    assert!(answer.err.contains("and the test went to 1.05: the law is a guess beyond it"), "{}", answer.err);
    assert!(answer.out.contains("shear_modulus = \"0.1800000 MPa\""), "{}", answer.out);
    let fitted = scene::load(folder.path().join("fitted.toml")).unwrap();
    assert!((fitted.modules()[0].material.shear_modulus_pa() / 180e3 - 1.0).abs() < 1e-8);
    let refused = softlimb(folder.path(), "calibrate tension test.csv");
    assert_eq!(refused.code, 1, "{}", refused.out);
    assert!(refused.err.contains("test.csv: the data do not"), "{}", refused.err);
}

#[test]
fn stretch_below_every_row_of_a_test_is_named_by_its_option() {
    let csv = "stretch,nominal_stress_kpa\n1,0\n1.1,45.7\n1.2,89.9\n1.3,131.9\n1.5,213.9\n";
    let folder = desk(&[("test.csv", csv)]);
    for typed in ["0.5", "1", "50%"] {
        let answer = softlimb(folder.path(), &format!("calibrate tension test.csv --law neo-hookean --up-to {typed}"));
        let expected = format!("test.csv: `--up-to {typed}` keeps no row of the test that has a stress");
        assert_eq!(answer.code, 1, "{}", answer.out);
        assert!(answer.err.contains(&expected) && answer.err.contains("1.1 to 1.5"), "{}", answer.err);
    }
    let kept = softlimb(folder.path(), "calibrate tension test.csv --law neo-hookean --up-to 1.3");
    assert!(kept.code == 0 && kept.out.contains("stretch 1.000 to 1.300"), "{} {}", kept.out, kept.err);
}

/// Kilopascals under a name of pascals.
#[test]
fn law_that_no_scene_takes_is_named_with_its_value_range_and_the_units() {
    let test = "stretch,nominal_stress_pa\n1.1,45.7\n1.2,89.9\n1.3,131.9\n1.5,213.9\n";
    let folder = desk(&[("scene.toml", SCENE), ("test.csv", test), ("finger.csv", &bends("pressure_pa", 1e-3))]);
    let alone = softlimb(folder.path(), "calibrate tension test.csv --law neo-hookean");
    assert_eq!(alone.code, 3, "{}", alone.err);
    assert!(alone.err.contains("shear_modulus = 0.00019"), "{}", alone.err);
    assert!(alone.err.contains("0.001 MPa to 100 MPa: check the units of the columns"), "{}", alone.err);
    for line in [
        "calibrate tension test.csv --law neo-hookean --scene scene.toml",
        "calibrate pressure finger.csv --scene scene.toml --fit shear_modulus",
    ] {
        let refused = softlimb(folder.path(), line);
        assert_eq!(refused.code, 1, "{line}: {}", refused.out);
        for part in ["from 0.001 MPa to 100 MPa: this is 0.000", "check the units of the columns"] {
            assert!(refused.err.contains(part), "{line}: {}", refused.err);
        }
        assert!(!refused.err.contains("scene.toml:"), "{line}: {}", refused.err);
    }
}

/// Bends of a finger of 0.2 MPa, with pressures times a factor, kPa, under a name.
fn bends(column: &str, factor: f64) -> String {
    let unit = if column == "pressure_pa" { 1e3 } else { 1.0 };
    let rows = [(10.0, 12.9), (30.0, 43.0), (60.0, 101.8)];
    let row = |(kpa, deg): (f64, f64)| format!("finger,{},{deg}\n", kpa * unit * factor);
    format!("module,{column},bend_angle_deg\n{}", rows.map(row).concat())
}

/// Pounds per square inch under a name of kilopascals leave no residual.
#[test]
fn modulus_far_from_that_of_the_scene_warns_of_units() {
    let psi = bends("pressure_kpa", 1.0 / 6.894_757);
    let folder = desk(&[("scene.toml", SCENE), ("kpa.csv", &bends("pressure_kpa", 1.0)), ("psi.csv", &psi)]);
    let fit = |file: &str| {
        softlimb(folder.path(), &format!("calibrate pressure {file} --scene scene.toml --fit shear_modulus"))
    };
    let (right, wrong) = (fit("kpa.csv"), fit("psi.csv"));
    assert_eq!((right.code, right.err.as_str()), (0, ""), "{}", right.out);
    assert_eq!(wrong.code, 3, "{}", wrong.err);
    assert!(
        wrong.err.contains("is 0.121 times the scene's 0.240000 MPa: check the units of the columns"),
        "{}",
        wrong.err
    );
}

#[test]
fn rows_that_no_value_reproduces_are_refused_with_the_cause() {
    let far = "module,pressure_kpa,axial_stretch\nfinger,10,1.1\nfinger,20,1.2\n";
    let mirrored = "module,pressure_kpa,bend_angle_deg\nfinger,10,-12.9\nfinger,30,-43\nfinger,50,-55\n";
    let folder = desk(&[("scene.toml", SCENE), ("far.csv", far), ("mirrored.csv", mirrored)]);
    let fit = |file: &str, what: &str| {
        let answer = softlimb(folder.path(), &format!("calibrate pressure {file} --scene scene.toml --fit {what}"));
        assert_eq!(answer.code, 1, "{file} {what}: {}", answer.out);
        assert!(!answer.err.contains("moves no point"), "{file} {what}: {}", answer.err);
        answer.err
    };
    let refused = fit("far.csv", "shear_modulus");
    assert!(refused.contains("no value of shear_modulus of arm, finger reproduces these data"), "{refused}");
    assert!(refused.contains("Check the units and signs of the columns"), "{refused}");
    for what in ["shear_modulus", "pressure_gain", "pressure_offset", "wall"] {
        let refused = fit("mirrored.csv", what);
        assert!(refused.contains("the measured bend angle of finger changes with the opposite sign"), "{refused}");
        assert!(refused.contains("by -12.9000 deg at 10000 Pa"), "{refused}");
    }
}

#[test]
fn help_names_every_parameter_that_a_fit_takes() {
    let folder = desk(&[]);
    for verb in ["pressure", "run"] {
        let help = softlimb(folder.path(), &format!("calibrate {verb} --help")).out;
        let words = softlimb_rig::calibrate::Property::ALL.map(|property| property.word());
        for word in words {
            assert!(help.contains(word), "{verb}: {word}");
        }
    }
}

#[test]
fn step_gives_the_creep_of_a_scene() {
    let mut csv = "pressure_pa,time_s,bend_angle_rad,module\n".to_owned();
    for time in grid(0.05, 12.0, 60) {
        let _ = writeln!(csv, "30000,{time},{},finger", 0.7 * (1.0 + 0.08 * (1.0 - (-time / 4.0_f64).exp())));
    }
    let folder = desk(&[("scene.toml", SCENE), ("step.csv", &csv)]);
    let answer = softlimb(folder.path(), "calibrate creep step.csv --scene scene.toml");
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(
        answer.out.contains("creep_share = \"8.000 %\"") && answer.out.contains("creep_time = \"4.0000 s\""),
        "{}",
        answer.out
    );
}

#[test]
fn specimens_have_a_mean_and_a_spread() {
    let moduli = [1.8e5, 2.0e5, 2.1e5, 2.3e5];
    let mut rows = "specimen,module,pressure_kpa,axial_stretch\n".to_owned();
    for (index, modulus) in moduli.iter().enumerate() {
        let tube = Tube { c: [0.5 * modulus, 0.0, 0.0], ..Tube::soft() };
        for stretch in grid(1.02, 1.12, 6) {
            let held = tube.at_stretch(stretch);
            let _ = writeln!(rows, "cast {index},arm,{},{}", held.pressure * 1e-3, held.stretch);
        }
    }
    let folder = desk(&[("scene.toml", SCENE), ("casts.csv", &rows)]);
    let line = "calibrate pressure casts.csv --scene scene.toml --fit shear_modulus --per module";
    let answer = softlimb(folder.path(), &format!("{line} --json --write fitted.toml"));
    assert_eq!(answer.code, 0, "{}", answer.err);
    let json: Value = serde_json::from_str(&answer.out).unwrap();
    for (found, modulus) in json["specimens"].as_array().unwrap().iter().zip(moduli) {
        assert!((found["estimates"][0]["value"].as_f64().unwrap() / modulus - 1.0).abs() < 1e-6, "{found}");
    }
    let effect = &json["random_effects"][0];
    let number = |field: &str| effect[field].as_f64().unwrap();
    // Mean and deviation of the four moduli.
    assert!(
        (number("mean") / 2.05e5 - 1.0).abs() < 1e-6 && (number("spread") / 20_816.66 - 1.0).abs() < 1e-5,
        "{effect}"
    );
    let written = scene::load(folder.path().join("fitted.toml")).unwrap();
    assert!((written.modules()[0].actuator().material.shear_modulus_pa() / 2.05e5 - 1.0).abs() < 1e-6);
    let table = softlimb(folder.path(), line).out;
    assert!(table.contains("  cast 3 ") && table.contains("  between specimens "), "{table}");
    let two: String = rows.lines().take(13).map(|row| format!("{row}\n")).collect();
    let folder = desk(&[("scene.toml", SCENE), ("casts.csv", &two)]);
    let refused = softlimb(folder.path(), line);
    assert!(
        refused.code == 1 && refused.err.contains("2 specimens: mean and spread take 3 or more"),
        "{}",
        refused.err
    );
}

/// Bends of wound fingers, by finite elements, which the command chooses and names; a second winding is taken, too.
#[test]
fn wound_fingers_are_calibrated_by_finite_elements() {
    let windings = "[windings.hoops]\nangle = \"5 deg\"\nfamilies = 2\nmodulus = \"300 MPa\"\nthickness = \"0.1 mm\"\n\n\
                    [windings.axial]\nangle = \"90 deg\"\nfamilies = 1\nmodulus = \"0.5 MPa\"\nthickness = \"0.1 mm\"\n\n";
    for (named, why) in [
        ("\"hoops\"", "because the analytic bend errs by up to "),
        ("[\"hoops\", \"axial\"]", "because the analytic bend takes one winding"),
    ] {
        let scene = SCENE
            .replace("[limb]", &format!("{windings}[limb]"))
            .replace("length = \"100 mm\"\nmaterial", &format!("length = \"100 mm\"\nwinding = {named}\nmaterial"));
        let finger = scene::parse(&scene, "scene.toml").unwrap();
        let (parameters, second) = finger.modules()[1].wound_actuator();
        let softer = ActuatorParameters { material: Material::NeoHookean { shear_modulus_pa: 0.2e6 }, ..parameters };
        let section = match second {
            None => Section::new(&softer, &Options::default()),
            Some(second) => Section::with_two_windings(&softer, &second, &Options::default()),
        };
        let curve = section.unwrap().curve(&[10e3, 25e3, 40e3], &EndLoad::default()).unwrap();
        let mut rows = "module,pressure_pa,bend_angle_rad\n".to_owned();
        for answer in curve.answers {
            let bend = answer.equilibrium().unwrap().state.over(parameters.length_m).bend_angle_rad;
            let _ = writeln!(rows, "finger,{},{bend}", answer.pressure_pa);
        }
        let folder = desk(&[("scene.toml", &scene), ("finger.csv", &rows)]);
        let line = "calibrate pressure finger.csv --scene scene.toml --fit shear_modulus --per module";
        let answer = softlimb(folder.path(), &format!("{line} --json"));
        assert_eq!(answer.code, 0, "{}", answer.err);
        let json: Value = serde_json::from_str(&answer.out).unwrap();
        let modulus = json["estimates"][0]["value"].as_f64().unwrap();
        assert!((modulus / 0.2e6 - 1.0).abs() < 1e-6, "{modulus}");
        let model = &json["models"][0];
        assert!(model["module"] == "finger" && model["model"] == "section-fe", "{json}");
        let bends = |off_deg: f64| {
            // 92 deg are -88 deg.
            let angle = |deg: f64| if deg > 90.0 { deg - 180.0 } else { deg };
            let turned = |fiber: Fiber<f64>| Fiber {
                angle_rad: angle(fiber.angle_rad.to_degrees() + off_deg).to_radians(),
                ..fiber
            };
            let wound = ActuatorParameters { fiber: softer.fiber.map(turned), ..softer };
            let section = match second.map(turned) {
                None => Section::new(&wound, &Options::default()),
                Some(second) => Section::with_two_windings(&wound, &second, &Options::default()),
            };
            let curve = section.unwrap().curve(&[40e3 / 3.0, 80e3 / 3.0, 40e3], &EndLoad::default()).unwrap();
            curve
                .answers
                .iter()
                .map(|answer| answer.equilibrium().unwrap().state.bend_rates_rad_per_m[0])
                .collect::<Vec<_>>()
        };
        let own = bends(0.0);
        let changes = [-2.0, 2.0]
            .map(&bends)
            .map(|off| off.iter().zip(&own).map(|(off, own)| (off / own - 1.0).abs()).fold(0.0, f64::max));
        let (stated, most) = (model["winding_2deg"].as_f64().unwrap(), changes[0].max(changes[1]));
        assert!((stated / most - 1.0).abs() < 1e-5 && most > 0.01, "{stated} {changes:?}");
        let table = softlimb(folder.path(), line).out;
        assert!(table.contains(&format!("finger: finite elements of the cross-section, {why}")), "{table}");
        let off = format!("; 2 deg of fiber angle change the bend by up to {:.1} %", 100.0 * stated);
        assert!(table.contains(&off), "{table}");
    }
}

#[test]
fn rows_that_repeat_a_measurement_count_once() {
    let rows = table();
    let line = rows.lines().nth(3).unwrap();
    let folder = desk(&[("scene.toml", SCENE), ("once.csv", &rows), ("again.csv", &format!("{rows}{line}\n{line}\n"))]);
    let fit = |file: &str| {
        softlimb(folder.path(), &format!("calibrate pressure {file} --scene scene.toml --fit shear_modulus --json"))
    };
    let (once, again) = (fit("once.csv"), fit("again.csv"));
    let [of_once, of_again] = [&once, &again].map(|answer| serde_json::from_str::<Value>(&answer.out).unwrap());
    assert_eq!((once.code, &of_once["estimates"]), (0, &of_again["estimates"]), "{}", once.err);
    assert_eq!(again.code, 3, "{}", again.err);
    assert_eq!(again.err, "warning: line 4 is repeated 2 times to the last digit: it counts once\n");
    let copies = format!("module,pressure_kpa,axial_stretch\n{}", "arm,20,1.05\n".repeat(5));
    let folder = desk(&[("scene.toml", SCENE), ("copies.csv", &copies)]);
    let refused = softlimb(folder.path(), "calibrate pressure copies.csv --scene scene.toml --fit shear_modulus");
    assert!(refused.code == 1 && refused.err.contains("2 points are the fewest"), "{} {}", refused.code, refused.err);
}

#[test]
fn errors_have_their_place() {
    let bad = "module,pressure_pa,axial_stretch\narm,1e3,1.01\nleg,2e3,1.02\n";
    let folder = desk(&[("scene.toml", SCENE), ("bad.csv", bad), ("arm.csv", &table())]);
    for (line, code, expected) in [
        ("calibrate", 2, "Usage: softlimb calibrate <COMMAND>"),
        ("calibrate pressure arm.csv --scene scene.toml", 2, "--fit <WHAT>"),
        ("calibrate pressure arm.csv --scene scene.toml --fit stiffness", 2, "known are shear_modulus"),
        ("calibrate creep arm.csv --scene scene.toml", 1, "creep needs a column time_s"),
        (
            "calibrate pressure bad.csv --scene scene.toml --fit wall",
            1,
            "bad.csv: line 3, column `module`: `leg` is not allowed: one of arm, finger",
        ),
        ("calibrate pressure none.csv --scene scene.toml --fit wall", 1, "cannot read none.csv"),
        ("calibrate pressure arm.csv --scene scene.toml --fit yeoh_c2", 1, "no module of these data has a yeoh_c2"),
        (
            "calibrate pressure arm.csv --scene scene.toml --fit wall --accuracy 0",
            2,
            "invalid value '0' for '--accuracy <RATIO>': the range is > 0",
        ),
        (
            "calibrate pressure arm.csv --scene scene.toml --fit wall --confidence 2",
            1,
            "confidence = 2 of the settings is not allowed",
        ),
        ("calibrate run scene.toml --scene scene.toml --fit wall", 1, "scene.toml"),
    ] {
        let answer = softlimb(folder.path(), line);
        assert_eq!(answer.code, code, "{line}: {}", answer.err);
        assert!(answer.err.contains(expected), "{line}: {}", answer.err);
    }
}
