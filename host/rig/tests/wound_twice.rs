//! A twist rod with a helix and an axial thread: planned, tabulated and run, and what takes one winding.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use fra_model::{Load, Status, Target};
use softlimb_fea::cross_section::{EndLoad, Options, Section, Symmetry};
use softlimb_limb::Limb;
use softlimb_limb::statics::{self, Fidelity, LoadedLimb};
use softlimb_motion as motion;
use softlimb_motion::ModuleInverse;
use softlimb_motion::inverse_table::InverseFit;
use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene::{Scene, parse};

pub(crate) const ROD: &str = r#"
format = 1
name = "rod"
seed = 3
weight = { simulated = false, compensated = false }
materials.silicone = { law = "neo-hookean", shear_modulus = "0.2 MPa" }
windings.helix = { angle = "30 deg", families = 1, modulus = "200 MPa", thickness = "0.1 mm" }
windings.axial = { angle = "90 deg", families = 1, modulus = "200 MPa", thickness = "0.1 mm" }
limb.connector = { length = 0, mass = 0 }

[[module]]
name = "rod"
motion = "twisting"
actuators = 1
inner_radius = "6 mm"
outer_radius = "8 mm"
length = "100 mm"
material = "silicone"
winding = ["helix", "axial"]
pressure_max = "100 kPa"

[[phase]]
name = "twist"
duration = "1.5 s"
hold = "1 s"
targets = { rod = { twist = -3 } }

[plant]
spread = { modulus = 0, wall = 0, fiber_angle = 0, dead_volume = 0, valve_conductance = 0, valve_delay = 0, sensor_offset = 0, sensor_gain = 0 }
"#;

fn rod(from: &str, to: &str) -> Scene {
    assert!(ROD.contains(from), "{from}");
    parse(&ROD.replacen(from, to, 1), "rod.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// The table of the device holds the twist that finite elements of the section have at its pressures; one winding would twist more.
#[test]
fn table_carries_both_windings() {
    let scene = rod("seed = 3", "seed = 4");
    let limb = Limb::new(&scene).unwrap();
    let all = motion::inverses(&scene, &limb).unwrap();
    let ModuleInverse::Table(tables) = &all[0] else { panic!("{}", all[0]) };
    let table = tables.inverse.as_ref().and_then(InverseFit::table).unwrap();
    let actuator = &limb.modules()[0].actuator;
    let parameters = actuator.parameters();
    let section =
        Section::with_two_windings(parameters, actuator.second_fiber().unwrap(), &Options::default()).unwrap();
    for twist_rad in [-0.5, -2.0, -3.5] {
        let pressure_pa = f64::from(table.lookup(twist_rad as f32).unwrap().pressure_pa);
        let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
        let found = curve.answers[0].equilibrium().unwrap().state.over(parameters.length_m).twist_rad;
        assert!((found / twist_rad - 1.0).abs() < 1e-3, "{twist_rad}: {found} at {pressure_pa} Pa");
    }
    let error = motion::inverses(&rod("[plant]", "[controller]\ninverse = \"model\"\n[plant]"), &limb).unwrap_err();
    assert!(error.render(false).contains("the device needs tables for the module `rod`"), "{}", error.render(false));
}

#[test]
fn run_reaches_the_twist_of_both_windings() {
    let scene = rod("seed = 3", "seed = 4");
    let limb = Limb::new(&scene).unwrap();
    let wanted = limb.modules()[0].actuator.inverse(Target::Twist(-3.0), &Load::none()).unwrap();
    assert_eq!(wanted.status, Status::Solved);
    let folder = tempfile::tempdir().unwrap();
    let options =
        RunOptions { seed: 1, out: folder.path().to_owned(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    let files = run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap();
    let held = files.run.samples.iter().filter(|sample| (2.0..2.4).contains(&sample.time_s));
    let references: Vec<f64> = held.map(|sample| sample.channels[0].reference_pa).collect();
    let off_pa = references.iter().map(|pa| (pa - wanted.state.pressure_pa).abs()).fold(0.0, f64::max);
    let rmse = report::summary(&files.run).modules[0].error.unwrap().rmse;
    println!("{} samples, reference {off_pa:.1} Pa off, twist {rmse:.4} rad rms", references.len());
    // The budget of the table, 1e-4 of 97 kPa, and the 10 Pa steps of the telemetry.
    assert!(!references.is_empty() && off_pa < 20.0, "{off_pa} {}", wanted.state.pressure_pa);
    // The simulated rod has both windings: of the helix alone the twist would be off by more than 0.5 rad.
    assert!(rmse < 0.1, "{rmse}");
    let alone = fra_model::Actuator::new(limb.modules()[0].actuator.parameters()).unwrap();
    let alone = alone.forward(wanted.state.pressure_pa, &Load::none()).unwrap().state.twist_rad;
    assert!((alone + 3.0).abs() > 0.5, "{alone}");
}

/// A level rod without pressure droops as a beam with the bending stiffness of finite elements: `w (L^4/8EI + L^2/2GA)`.
#[test]
fn level_rod_droops_as_a_beam_of_the_stiffness_of_finite_elements() {
    let text = ROD
        .replace("simulated = false, compensated = false", "simulated = true")
        .replace("modulus = \"200 MPa\"", "modulus = \"20 MPa\"")
        .replace("shear_modulus = \"0.2 MPa\"", "shear_modulus = \"0.2 MPa\", density = \"100 kg/m3\"")
        .replace("length = \"100 mm\"", "length = \"200 mm\"");
    let scene = parse(&text, "rod.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let limb = Limb::new(&scene).unwrap();
    let module = &limb.modules()[0];
    let parameters = module.actuator.parameters();
    let options = Options { symmetry: Symmetry::Ignore, ..Options::default() };
    let section = Section::with_two_windings(parameters, module.actuator.second_fiber().unwrap(), &options).unwrap();
    let curve = section.curve(&[0.0], &EndLoad::default()).unwrap();
    let bending_nm2 = curve.answers[0].equilibrium().unwrap().stiffness.unwrap().by_strain[1][1];
    let area_m2 = PI * (parameters.outer_radius_m.powi(2) - parameters.inner_radius_m.powi(2));
    let (weight_n_per_m, length_m) = (100.0 * area_m2 * 9.80665, parameters.length_m);
    let expected = weight_n_per_m * (length_m.powi(4) / (8.0 * bending_nm2) + length_m.powi(2) / (0.2e6 * area_m2));
    let loaded = LoadedLimb::new(&scene, &limb, &[0.0], &[1], &statics::Load::default()).unwrap();
    let shape = loaded.settle(Fidelity::Fourfold, None).unwrap().shape;
    let droop = -shape.tip().translation.vector.z;
    println!("{droop} m beside {expected} m");
    assert!((droop / expected - 1.0).abs() < 2e-3, "{droop} {expected}");
}

/// One rod, and three between plates that hold their twist back, each under its weight.
#[test]
fn run_under_weight_reaches_the_twist() {
    for (actuators, twist_rad) in [("actuators = 1", -3.0), ("actuators = 3\ncircle_radius = \"20 mm\"", -0.5)] {
        let text = ROD
            .replace("simulated = false, compensated = false", "simulated = true")
            .replace("actuators = 1", actuators)
            .replace("twist = -3", &format!("twist = {twist_rad:?}"));
        let scene = parse(&text, "rod.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
        let folder = tempfile::tempdir().unwrap();
        let options = RunOptions {
            seed: 1,
            out: folder.path().to_owned(),
            mcu: Mcu::Here,
            link_faults: None,
            faults: Vec::new(),
        };
        let files = run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap();
        let summary = report::summary(&files.run);
        let rmse = summary.modules[0].error.unwrap().rmse;
        println!("{actuators}: twist {rmse:.4} rad rms");
        assert!(rmse < 0.03 * f64::abs(twist_rad), "{rmse}");
    }
}

#[test]
fn room_for_one_winding_names_the_second() {
    let error = rod("seed = 3", "seed = 4").require_one_winding("`design limb`").unwrap_err().render(false);
    assert!(error.contains("`rod` has two windings, and `design limb` takes one"), "{error}");
    assert!(error.contains("winding = [\"helix\", \"axial\"]"), "{error}");
    rod("[\"helix\", \"axial\"]", "\"helix\"").require_one_winding("`design limb`").unwrap();
}
