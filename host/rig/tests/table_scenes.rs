//! What a scene says about tables: defaults, what is sent, what is refused, and that a run by tables is the run by the model.

use std::sync::atomic::AtomicBool;

use softlimb_fea::cross_section::{EndLoad, Options, Section};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::inverse_table::{InverseFit, NoTable};
use softlimb_motion::{ModuleInverse, Sent};
use softlimb_protocol::TableArgument;
use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene::{InverseChoice, Scene, SceneError, load, parse};

/// A finger that bends, one that lengthens and one whose setpoint is a pressure: 4 channels.
const HAND: &str = r#"
format = 1
name = "hand"
seed = 3
weight.simulated = false
materials.silicone = { law = "neo-hookean", shear_modulus = "0.223 MPa" }
windings.hoop = { angle = "3 deg", families = 2, modulus = "361 MPa", thickness = "0.178 mm" }
limb.connector = { length = 0, mass = 0 }

[[module]]
name = "finger"
motion = "bending"
actuators = 1
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"

[[module]]
name = "arm"
motion = "extension"
actuators = 2
circle_radius = "30 mm"
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"
winding = "hoop"

[[module]]
name = "pad"
motion = "bending"
actuators = 1
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"

[[phase]]
name = "move"
duration = "1.5 s"
hold = "1 s"
targets = { finger = { bend_angle = "60 deg" }, arm = { axial_stretch = 1.15 }, pad = { pressure = "40 kPa" } }

[plant]
spread = { modulus = 0, wall = 0, fiber_angle = 0, dead_volume = 0, valve_conductance = 0, valve_delay = 0, sensor_offset = 0, sensor_gain = 0 }
"#;

fn hand(controller: &str) -> Scene {
    parse(&format!("{HAND}\n[controller]\n{controller}\n"), "hand.toml")
        .unwrap_or_else(|e| panic!("{}", e.render(false)))
}

/// The same with tubes that lengthen in place of those that bend: the device solves the model of them all.
fn straight(controller: &str) -> Scene {
    let text = HAND
        .replace("motion = \"bending\"", "motion = \"extension\"\nwinding = \"hoop\"")
        .replace("bend_angle = \"60 deg\"", "axial_stretch = 1.1");
    parse(&format!("{text}\n[controller]\n{controller}\n"), "straight.toml")
        .unwrap_or_else(|e| panic!("{}", e.render(false)))
}

fn inverses(scene: &Scene) -> Result<Vec<ModuleInverse>, SceneError> {
    motion::inverses(scene, &Limb::new(scene)?)
}

#[test]
fn scene_says_how_the_pressure_is_found() {
    let of = |text: &str| {
        let scene = hand(text);
        (scene.controller().inverse, scene.controller().inverse_error)
    };
    assert_eq!(of(""), (InverseChoice::Auto, 1e-4));
    assert_eq!(of("inverse = \"table\"\ninverse_error = \"0.5 %\""), (InverseChoice::Table, 5e-3));
    assert_eq!(of("inverse = \"model\"\ninverse_error = 0.001"), (InverseChoice::Model, 1e-3));
    for (line, word) in [("inverse = \"tables\"", "did you mean `table`"), ("inverse_error = \"2 %\"", "2 %")] {
        let error = parse(&format!("{HAND}\n[controller]\n{line}\n"), "hand.toml").unwrap_err().render(false);
        assert!(error.contains(word) && error.contains(line), "{error}");
    }
}

#[test]
fn channels_get_the_tables_of_their_module() {
    let scene = hand("");
    let limb = Limb::new(&scene).unwrap();
    let inverses = motion::inverses(&scene, &limb).unwrap();
    let sent = softlimb_rig::configuration(&scene, &inverses, &limb);
    assert_eq!(sent.volumes.iter().map(|table| table.channel).collect::<Vec<_>>(), [0, 1, 2, 3]);
    assert_eq!(sent.inverses.iter().map(|table| table.channel).collect::<Vec<_>>(), [0, 1, 2], "a pressure needs none");
    assert!(sent.inverses.iter().all(|table| table.argument == TableArgument::Linear));
    // 97 kPa: the reference stops 3 kPa below the limit of 100 kPa.
    assert!(sent.inverses.iter().all(|table| (table.pressure_max_pa - 97e3).abs() < 0.1));
    assert_eq!((sent.inverses[0].setpoint_from, sent.inverses[1].setpoint_from), (0.0, 1.0));
    for (inverse, needed) in inverses.iter().zip([true, true, false]) {
        assert_eq!(inverse.error().is_some_and(|error| error > 0.0 && error <= 1e-4), needed, "{inverse:?}");
    }
    let by_model = straight("inverse = \"model\"");
    let limb = Limb::new(&by_model).unwrap();
    let by_model = softlimb_rig::configuration(&by_model, &self::inverses(&by_model).unwrap(), &limb);
    assert!(by_model.volumes.is_empty() && by_model.inverses.is_empty());
}

#[test]
fn scenes_of_the_repository_need_no_solver_on_the_device() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let scene = load(&path).unwrap();
            for (module, inverse) in scene.modules().iter().zip(inverses(&scene).unwrap()) {
                // This one works so near its limit point that no table of its volume is good enough; the device has its closed forms.
                let steep = (scene.name(), module.name.as_str()) == ("pick-and-place-b", "shoulder");
                assert_eq!(inverse.tables().is_some(), !steep, "{}: {inverse}", path.display());
            }
        }
    }
}

/// The table of a finger built from its section's finite elements gives the bend that these elements have at its pressures.
#[test]
fn table_can_carry_the_finite_elements_of_the_section() {
    let scene = hand("bending = \"section-fe\"");
    let limb = Limb::new(&scene).unwrap();
    let all = inverses(&scene).unwrap();
    let ModuleInverse::Section(tables, calibration) = &all[0] else { panic!("{}", all[0]) };
    assert!(calibration.verified_error < 5e-3, "{calibration:?}");
    assert!(matches!(all[1], ModuleInverse::Table(_)) && matches!(all[2], ModuleInverse::Table(_)));
    let parameters = limb.modules()[0].actuator.parameters();
    let section = Section::new(parameters, &Options::default()).unwrap();
    let table = tables.inverse.as_ref().and_then(InverseFit::table).unwrap();
    for angle_deg in [10.0, 33.0, 61.0, 90.0_f64] {
        let angle = angle_deg.to_radians();
        let pressure_pa = f64::from(table.lookup(angle as f32).unwrap().pressure_pa);
        let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
        let bend = curve.answers[0].equilibrium().unwrap().state.bend_rates_rad_per_m[0] * parameters.length_m;
        assert!((bend / angle - 1.0).abs() < 5e-3, "{angle_deg}: {bend}");
    }
    let error = parse(&format!("{HAND}\n[controller]\nbending = \"section-fe\"\ninverse = \"model\"\n"), "hand.toml")
        .unwrap_err();
    assert!(error.render(false).contains("`bending = \"section-fe\"` needs tables"), "{}", error.render(false));
}

/// A thin wall flattens as it bends, which the analytic model does not know: of two goals within its reach the finite elements allow one.
#[test]
fn goal_beyond_the_finite_elements_is_refused_where_it_is_written() {
    let thin = HAND.replacen("inner_radius = \"10 mm\"", "inner_radius = \"12.5 mm\"\npressure_max = \"54 kPa\"", 1);
    let with = |angle_rad: f64, bending: &str| {
        let target = format!("bend_angle = \"{} deg\"", angle_rad.to_degrees());
        let text = thin.replace("bend_angle = \"60 deg\"", &target);
        parse(&format!("{text}\n[controller]\nbending = \"{bending}\"\n"), "hand.toml").unwrap()
    };
    let checked = |scene: &Scene| {
        let limb = Limb::new(scene)?;
        let plan = motion::plan(scene, &limb)?;
        motion::check_goals(scene, &limb, &plan, &Sent::uncorrected(&limb, &plan), &motion::inverses(scene, &limb)?)
    };
    // The bend that the elements themselves have at the highest pressure the device follows.
    let limb = Limb::new(&with(0.5, "section-fe")).unwrap();
    let module = &limb.modules()[0];
    let section = Section::new(module.actuator.parameters(), &Options::default()).unwrap();
    let curve = section.curve(&[module.reference_max_pa], &EndLoad::default()).unwrap();
    let rate = curve.answers[0].equilibrium().unwrap().state.bend_rates_rad_per_m[0];
    let (found, analytic) = (rate * module.actuator.parameters().length_m, module.range().1);
    assert!(found < 0.992 * analytic, "the goals below would not tell them apart: {found} {analytic}");
    checked(&with(0.99 * found, "section-fe")).expect("within reach of both");
    let beyond = with(0.999 * analytic, "section-fe");
    let error = checked(&beyond).unwrap_err().render(false);
    for word in ["hand.toml:", "bend_angle = ", "finite elements", "`finger`", "at 51.00 kPa", "`pressure_max`"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    checked(&with(0.999 * analytic, "analytic")).expect("within reach of the analytic model");
    // No run of it either.
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("results");
    let options = RunOptions { seed: 1, out: out.clone(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    assert!(run(&beyond, &options, &AtomicBool::new(false), |_| ()).is_err());
    assert!(!out.exists());
}

#[test]
fn table_that_errs_more_than_the_scene_allows_is_not_sent() {
    let scene = hand("inverse = \"table\"\ninverse_error = \"0.0001 %\"");
    let error = inverses(&scene).unwrap_err().render(false);
    for word in ["no inverse table for the module `finger`", "more than 1.0e-6", "`inverse_error`"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    assert!(!error.contains("inverse = \"auto\""), "the device does not solve what bends: {error}");
    let tubes = inverses(&straight("inverse = \"table\"\ninverse_error = \"0.0001 %\"")).unwrap_err().render(false);
    assert!(tubes.contains("or `inverse = \"auto\"`"), "{tubes}");
    // What the help says is enough is enough.
    let said = error.split("`inverse_error` in [controller] to \"").nth(1).unwrap().split('"').next().unwrap();
    let eased = hand(&format!("inverse = \"table\"\ninverse_error = \"{said}\""));
    match inverses(&eased) {
        Ok(all) => assert!(all.iter().all(|inverse| inverse.tables().is_some())),
        Err(error) => assert!(error.render(false).contains("module `arm`"), "{}", error.render(false)),
    }
    // Left to itself the device solves its model.
    let auto = inverses(&straight("inverse_error = \"0.0001 %\"")).unwrap();
    assert!(
        matches!(auto[0].reason(), Some(NoTable::Inverse { least: Some(_), budget }) if (budget - 1e-6).abs() < 1e-18)
    );
    assert!(auto[2].tables().is_some(), "a pressure has nothing to err");
    // A run that is refused leaves nothing behind.
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("results");
    let options = RunOptions { seed: 1, out: out.clone(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    assert!(run(&scene, &options, &AtomicBool::new(false), |_| ()).is_err());
    assert!(!out.exists());
}

#[test]
fn module_that_the_device_does_not_solve_needs_tables_within_the_budget() {
    let error = inverses(&hand("inverse = \"model\"")).unwrap_err().render(false);
    for word in
        ["hand.toml", "the device needs tables for the module `finger`", "straight", "leave out `inverse = \"model\"`"]
    {
        assert!(error.contains(word), "{word}: {error}");
    }
    let error = inverses(&hand("inverse_error = \"0.0001 %\"")).unwrap_err().render(false);
    for word in ["tables for the module `finger`", "more than 1.0e-6", "without tables", "set `inverse_error`"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    // At the neutral angle a tube lengthens with the square of the pressure: at rest no pressure is the next.
    let neutral = HAND.replace("angle = \"3 deg\"", "angle = \"35.26438968 deg\"").replace("1.15", "1.0005");
    let neutral = neutral.replace("motion = \"bending\"", "motion = \"extension\"\nwinding = \"hoop\"");
    let neutral = neutral.replace("bend_angle = \"60 deg\"", "axial_stretch = 1.0005");
    let neutral = parse(&format!("{neutral}\n[controller]\ninverse = \"model\"\n"), "neutral.toml");
    let neutral = neutral.unwrap_or_else(|error| panic!("{}", error.render(false)));
    let limb = Limb::new(&neutral).unwrap();
    let plan = motion::plan(&neutral, &limb).unwrap();
    let checked =
        motion::check_goals(&neutral, &limb, &plan, &Sent::uncorrected(&limb, &plan), &inverses(&neutral).unwrap());
    let error = checked.unwrap_err().render(false);
    for word in ["tables for the module `finger`", "the device loses its way"] {
        assert!(error.contains(word), "{word}: {error}");
    }
}

#[test]
fn run_by_tables_is_the_run_by_the_model() {
    let reached = |controller: &str| {
        let folder = tempfile::tempdir().unwrap();
        let options = RunOptions {
            seed: 1,
            out: folder.path().to_owned(),
            mcu: Mcu::Here,
            link_faults: None,
            faults: Vec::new(),
        };
        let files = run(&straight(controller), &options, &AtomicBool::new(false), |_| ()).unwrap();
        let summary = report::summary(&files.run);
        // At rest at the end of the move: on the way there the upload, which is longer with tables, shifts the periods of the
        // controller against the knots.
        let followed = files.run.samples.iter().filter(|sample| (1.7..2.3).contains(&sample.time_s));
        let references: Vec<f64> =
            followed.flat_map(|sample| sample.channels.iter().map(|channel| channel.reference_pa)).collect();
        (references, summary.modules.iter().map(|module| module.error.unwrap().rmse).collect::<Vec<_>>())
    };
    let (by_table, table_errors) = reached("inverse = \"table\"");
    let (by_model, model_errors) = reached("inverse = \"model\"");
    assert_eq!(by_table.len(), by_model.len());
    assert!(by_table.len() >= 100, "{}", by_table.len());
    let most_pa = by_table.iter().zip(&by_model).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("references differ by {most_pa} Pa at most; {table_errors:?} {model_errors:?}");
    // The budget of 9.7 Pa, and the 10 Pa steps of the telemetry.
    assert!(most_pa <= 20.0, "{most_pa}");
    for (table, model) in table_errors.iter().zip(&model_errors) {
        assert!((table - model).abs() <= 0.25 * model.abs(), "{table_errors:?} {model_errors:?}");
    }
}
