//! A twist rod with a helix and an axial thread: planned, tabulated and run, and what takes one winding.

use std::sync::atomic::AtomicBool;

use fra_model::{Load, Status, Target};
use softlimb_fea::cross_section::{EndLoad, Options, Section};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::ModuleInverse;
use softlimb_motion::inverse_table::InverseFit;
use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene::{Scene, parse};

const ROD: &str = r#"
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

#[test]
fn weight_takes_one_winding() {
    for (from, to) in
        [("simulated = false", "simulated = true"), ("actuators = 1", "actuators = 2\ncircle_radius = \"30 mm\"")]
    {
        let error = Limb::new(&rod(from, to)).unwrap_err().render(false);
        for word in ["two windings are for weightless limbs", "winding = [\"helix\", \"axial\"]", "rod.toml:"] {
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}

#[test]
fn room_for_one_winding_names_the_second() {
    let error = rod("seed = 3", "seed = 4").require_one_winding("`fabricate`").unwrap_err().render(false);
    assert!(error.contains("`rod` has two windings, and `fabricate` takes one"), "{error}");
    assert!(error.contains("winding = [\"helix\", \"axial\"]"), "{error}");
    rod("[\"helix\", \"axial\"]", "\"helix\"").require_one_winding("`fabricate`").unwrap();
}
