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

/// A bender with hoops and a soft helix beside them: it bends and twists.
fn bender(from: &str, to: &str) -> Scene {
    let text = ROD
        .replace("motion = \"twisting\"", "motion = \"bending\"")
        .replace(
            "angle = \"90 deg\", families = 1, modulus = \"200 MPa\"",
            "angle = \"3 deg\", families = 2, modulus = \"200 MPa\"",
        )
        .replace(
            "angle = \"30 deg\", families = 1, modulus = \"200 MPa\"",
            "angle = \"30 deg\", families = 1, modulus = \"10 MPa\"",
        )
        .replace("pressure_max = \"100 kPa\"", "pressure_max = \"60 kPa\"")
        .replace("[\"helix\", \"axial\"]", "[\"axial\", \"helix\"]")
        // A chamber of 12 mL wants fine valves.
        .replace("[plant]\n", "[plant]\nvalve = { conductance = \"0.02 dm3/(s bar)\" }\n")
        .replace("twist = -3", "bend_angle = \"40 deg\"");
    assert!(text.contains(from), "{from}");
    parse(&text.replacen(from, to, 1), "bender.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// The tip of a line of constant bend and twist per length, by small steps of its frame.
fn tip_of_line(length_m: f64, bend_rad: f64, twist_rad: f64) -> [f64; 3] {
    const STEPS: u32 = 20_000;
    let step = nalgebra::Vector3::new(0.0, bend_rad, twist_rad) / f64::from(STEPS);
    let [half, whole] = [0.5, 1.0].map(|share| nalgebra::UnitQuaternion::from_scaled_axis(step * share));
    let (mut frame, mut tip) = (nalgebra::UnitQuaternion::identity(), nalgebra::Vector3::zeros());
    for _ in 0..STEPS {
        let middle = frame * half;
        tip += middle * nalgebra::Vector3::z() * (length_m / f64::from(STEPS));
        frame *= whole;
    }
    tip.into()
}

#[test]
fn bender_with_two_windings_runs_to_the_bend_of_finite_elements() {
    let scene = bender("seed = 3", "seed = 4");
    let limb = Limb::new(&scene).unwrap();
    let module = &limb.modules()[0];
    let parameters = module.actuator.parameters();
    let section = Section::with_two_windings(parameters, module.second_fiber().unwrap(), &Options::default()).unwrap();
    let at = |pressure_pa: f64| {
        let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
        curve.answers[0].equilibrium().unwrap().state.over(parameters.length_m)
    };
    let all = motion::inverses(&scene, &limb).unwrap();
    let ModuleInverse::Table(tables) = &all[0] else { panic!("{}", all[0]) };
    let table = tables.inverse.as_ref().and_then(InverseFit::table).unwrap();
    for degrees in [5.0, 20.0, 40.0] {
        let bend_rad = f64::to_radians(degrees);
        let pressure_pa = f64::from(table.lookup(bend_rad as f32).unwrap().pressure_pa);
        let found = at(pressure_pa);
        assert!((found.bend_angle_rad / bend_rad - 1.0).abs() < 1e-3, "{degrees}: {found:?}");
        let kept = module.curve.at(pressure_pa);
        assert!((kept.bend_angle_rad - found.bend_angle_rad).abs() < 1e-6, "{kept:?} {found:?}");
        assert!((kept.twist_rad - found.twist_rad).abs() < 1e-6, "{kept:?} {found:?}");
        assert!((kept.volume_m3 / found.volume_m3 - 1.0).abs() < 1e-6, "{kept:?} {found:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let options =
        RunOptions { seed: 1, out: folder.path().to_owned(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    let files = run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap();
    let rmse = report::summary(&files.run).modules[0].error.unwrap().rmse;
    let wanted = module.state_at(40f64.to_radians()).unwrap();
    let last = files.run.samples.iter().rfind(|sample| (2.0..2.4).contains(&sample.time_s)).unwrap();
    let tip = limb.tip([&wanted]);
    let [x, y, z] = tip_of_line(wanted.axial_stretch * 0.1, wanted.bend_angle_rad, wanted.twist_rad);
    println!(
        "bend {rmse:.4} rad rms, twist {:.3} rad at {:.1} kPa, tip {tip:?}",
        wanted.twist_rad,
        1e-3 * wanted.pressure_pa
    );
    assert!(rmse < 0.02, "{rmse}");
    assert!((last.channels[0].reference_pa - wanted.pressure_pa).abs() < 20.0, "{}", last.channels[0].reference_pa);
    // Of the hoops alone the bend is another, and there is no twist.
    let alone = module.actuator.forward(wanted.pressure_pa, &Load::none()).unwrap().state;
    assert!(
        alone.bend_angle_rad > 1.05 * wanted.bend_angle_rad && wanted.twist_rad.abs() > 0.05,
        "{alone:?} {wanted:?}"
    );
    let own = limb.base().inverse() * nalgebra::Point3::from(tip);
    let off_m = (own.coords - nalgebra::Vector3::new(x, y, z)).norm();
    assert!(off_m < 1e-8, "{own} {x} {y} {z}");
}

/// The plant's benders have the equilibria of their own sections: with a softer wall they bend more than the table's.
#[test]
fn true_bender_with_two_windings_is_solved_with_its_own_wall() {
    let scene = bender("modulus = 0, wall", "modulus = \"10 %\", wall");
    let limb = Limb::new(&scene).unwrap();
    let settings = softlimb_rig::simulate::settings(&scene, &limb, 5);
    let plant = softlimb_sim::plant::Plant::new(&settings.plant).unwrap();
    let made = plant.truth().channels.remove(0).parameters;
    let nominal = limb.modules()[0].actuator.parameters();
    let ratio = made.actuator.material.shear_modulus_pa() / nominal.material.shear_modulus_pa();
    assert!((ratio - 1.0).abs() > 0.01, "{ratio}");
    assert_eq!(made.second_fiber.as_ref(), limb.modules()[0].second_fiber());
    let law = settings.plant.channels[0].law.unwrap();
    let pressures_pa = [0.0, 10e3, 20e3, 40e3];
    let states = law.0(&made.actuator, made.second_fiber.as_ref(), &pressures_pa).unwrap();
    let section =
        Section::with_two_windings(&made.actuator, made.second_fiber.as_ref().unwrap(), &Options::default()).unwrap();
    for (state, pressure_pa) in states.iter().zip(pressures_pa) {
        let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
        let exact = curve.answers[0].equilibrium().unwrap().state.over(nominal.length_m);
        assert!((state.bend_angle_rad - exact.bend_angle_rad).abs() < 1e-6, "{state:?} {exact:?}");
    }
}

/// The parts of two families are two windings without a twist: the curve is that of the whole, three of them may stand in a row.
#[test]
fn row_of_benders_with_mirrored_windings_bends_as_one_winding() {
    let mirrored = |modulus: &str| format!("angle = \"3 deg\", families = 2, modulus = \"{modulus}\", thickness");
    let text = ROD
        .replace("angle = \"30 deg\", families = 1, modulus = \"200 MPa\", thickness", &mirrored("50 MPa"))
        .replace("angle = \"90 deg\", families = 1, modulus = \"200 MPa\", thickness", &mirrored("150 MPa"))
        .replace(
            "motion = \"twisting\"\nactuators = 1",
            "motion = \"bending\"\nactuators = 3\narrangement = \"row\"\nspacing = \"20 mm\"",
        )
        .replace("twist = -3", "bend_angle = \"40 deg\"")
        .replace("pressure_max = \"100 kPa\"", "pressure_max = \"60 kPa\"");
    let scene = parse(&text, "row.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let limb = Limb::new(&scene).unwrap();
    let module = &limb.modules()[0];
    let whole = fra_model::Fiber { modulus_pa: 200e6, ..module.actuator.parameters().fiber.unwrap() };
    let parameters = fra_model::ActuatorParameters { fiber: Some(whole), ..*module.actuator.parameters() };
    let curve = Section::new(&parameters, &Options::default()).unwrap().curve(&[30e3], &EndLoad::default()).unwrap();
    let one = curve.answers[0].equilibrium().unwrap().state.over(parameters.length_m);
    let two = module.curve.at(30e3);
    assert!((two.bend_angle_rad / one.bend_angle_rad - 1.0).abs() < 1e-6 && two.twist_rad == 0.0, "{two:?} {one:?}");
    let plan = motion::plan(&scene, &limb).unwrap();
    assert!((plan.phases[0].values[0] - 40f64.to_radians()).abs() < 1e-9);
}

#[test]
fn what_has_no_bender_with_two_windings_says_so_at_the_line() {
    let refused = |text: String| match parse(&text, "bender.toml").and_then(|scene| Limb::new(&scene).map(|_| ())) {
        Ok(()) => panic!("{text}"),
        Err(error) => error.render(false),
    };
    let text = bender("seed = 3", "seed = 4").source_text().to_owned();
    for (from, to, words) in [
        (
            "simulated = false, compensated = false",
            "simulated = true",
            "twists as it bends, and a limb with `[weight]` takes benders that do not",
        ),
        (
            "[plant]",
            "[plant.truth]\nlimb = \"body\"\n[plant]",
            "twists as it bends, and a true body takes benders that do not",
        ),
        (
            "actuators = 1",
            "actuators = 2\narrangement = \"row\"\nspacing = \"20 mm\"",
            "plates hold the twist of several benders back",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = refused(text.replace(from, to));
        assert!(error.contains(words) && error.contains("winding = [\"axial\", \"helix\"]"), "{error}");
    }
    let scene = bender("seed = 3", "seed = 4");
    let error = Limb::new(&scene).unwrap().require_plane_benders(&scene, "`statics`").unwrap_err().render(false);
    assert!(error.contains("`rod` twists as it bends, and `statics` takes benders that do not"), "{error}");
}
