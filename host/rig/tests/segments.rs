//! A module whose actuator is a series of segments: planned, tabulated and run as its segments together.

use std::sync::atomic::AtomicBool;

use fra_model::{Actuator, Load, Series, SeriesTarget, State, Status};
use nalgebra::Matrix4;
use softlimb_limb::Limb;
use softlimb_limb::statics::{self, Fidelity, LoadedLimb, Spring};
use softlimb_motion as motion;
use softlimb_motion::ModuleInverse;
use softlimb_motion::inverse_table::InverseFit;
use softlimb_rig::run::{Mcu, RunFiles, RunOptions, run};
use softlimb_scene::{Scene, parse};
use softlimb_sim::plant::Plant;

const SCENE: &str = include_str!("../../../scenes/extend-and-bend.toml");

/// The shipped scene with `from` replaced everywhere.
#[track_caller]
fn scene(changes: &[(&str, &str)]) -> Scene {
    let mut text = format!("{SCENE}\n[plant]\nchamber = {{ creep_share = 0 }}\n");
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    parse(&text, "series.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// Two straight segments: one wound 3 deg from the hoop, the other as a helix that twists, too.
const STRAIGHT: [(&str, &str); 5] = [
    (
        "[limb]\n",
        "[windings.helix]\nangle = \"30 deg\"\nfamilies = 1\nmodulus = \"200 MPa\"\nthickness = \"0.1 mm\"\n\n[limb]\n",
    ),
    ("motion = \"bending\"\nactuators", "motion = \"extension\"\nactuators"),
    ("motion = \"bending\"\nlength = \"100 mm\"", "motion = \"twisting\"\nlength = \"100 mm\"\nwinding = \"helix\""),
    ("bend_angle = \"60 deg\"", "axial_stretch = 1.03"),
    ("bend_angle = \"25 deg\"", "axial_stretch = 1.01"),
];

fn limb(scene: &Scene) -> Limb {
    Limb::new(scene).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn actuators(limb: &Limb) -> Vec<Actuator<f64>> {
    limb.modules()[0].segments().iter().map(|segment| segment.actuator).collect()
}

fn at(actuator: &Actuator<f64>, pressure_pa: f64) -> State<f64> {
    let solution = actuator.forward(pressure_pa, &Load::none()).unwrap();
    assert_eq!(solution.status, Status::Solved);
    solution.state
}

fn table_pa(scene: &Scene, limb: &Limb, value: f64) -> f64 {
    let all = motion::inverses(scene, limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let ModuleInverse::Table(tables) = &all[0] else { panic!("{}", all[0]) };
    let table = tables.inverse.as_ref().and_then(InverseFit::table).unwrap();
    f64::from(table.lookup(value as f32).unwrap().pressure_pa)
}

fn along(length_m: f64) -> Matrix4<f64> {
    Matrix4::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, length_m, 0.0, 0.0, 0.0, 1.0)
}

fn about_z(angle_rad: f64) -> Matrix4<f64> {
    let (s, c) = angle_rad.sin_cos();
    Matrix4::new(c, -s, 0.0, 0.0, s, c, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
}

/// An arc that bends towards `x`.
fn arc(length_m: f64, angle_rad: f64) -> Matrix4<f64> {
    let ((s, c), radius_m) = (angle_rad.sin_cos(), length_m / angle_rad);
    Matrix4::new(c, 0.0, s, radius_m * (1.0 - c), 0.0, 1.0, 0.0, 0.0, -s, 0.0, c, radius_m * s, 0.0, 0.0, 0.0, 1.0)
}

/// The tip in the frame of the base: `x` up, `z` along the limb.
fn tip_of(limb: &Limb, tip_m: [f64; 3]) -> [f64; 3] {
    (limb.base().inverse() * nalgebra::Point3::from(tip_m)).coords.into()
}

#[track_caller]
fn near(a: [f64; 3], b: &Matrix4<f64>, tolerance_m: f64) {
    let off_m = (0..3).map(|i| (a[i] - b[(i, 3)]).abs()).fold(0.0, f64::max);
    assert!(off_m <= tolerance_m, "{a:?} {b}");
}

#[test]
fn straight_segments_have_one_pressure_and_their_lengths_twists_and_volumes_add_up() {
    let scene = scene(&STRAIGHT);
    let limb = limb(&scene);
    let each = actuators(&limb);
    let module = &limb.modules()[0];
    for pressure_pa in [0.0, 7e3, 31.7e3, 60e3] {
        let [first, second] = [0, 1].map(|index| at(&each[index], pressure_pa));
        let whole = module.curve.at(pressure_pa);
        let length_m = 0.06 * first.axial_stretch + 0.1 * second.axial_stretch;
        assert!((whole.axial_stretch * 0.16 - length_m).abs() < 1e-9, "{whole:?}");
        assert!((whole.twist_rad - second.twist_rad).abs() < 1e-6 && second.twist_rad <= 0.0, "{whole:?}");
        assert!((whole.volume_m3 / (first.volume_m3 + second.volume_m3) - 1.0).abs() < 1e-7, "{whole:?}");
        assert!((module.measure(&whole) - whole.axial_stretch).abs() < 1e-15);
        let expected = about_z(0.0) * along(length_m + 0.015);
        near(tip_of(&limb, limb.tip([&whole])), &expected, 1e-9);
    }
    let series = Series::new(&each).unwrap();
    for stretch in [1.005, 1.02, 1.03] {
        let wanted = series.inverse(SeriesTarget::Extension(0.16 * (stretch - 1.0)), &Load::none()).unwrap();
        assert_eq!(wanted.status, Status::Solved);
        let found_pa = table_pa(&scene, &limb, stretch);
        // The default error of a table, 1e-4 of 97 kPa.
        assert!((found_pa - wanted.state.pressure_pa).abs() < 10.0, "{found_pa} {wanted:?}");
    }
}

#[test]
fn arcs_in_two_directions_are_composed_as_by_hand() {
    let scene = scene(&[
        ("motion = \"extension\"\nlength = \"60 mm\"\nwinding = \"hoop\"", "motion = \"bending\"\nlength = \"60 mm\""),
        ("length = \"100 mm\"", "length = \"100 mm\"\nbend_direction = \"90 deg\""),
        ("actuators = 1", "actuators = 1\nmount_angle = \"20 deg\"\nend_length = \"4 mm\""),
    ]);
    let limb = limb(&scene);
    let each = actuators(&limb);
    for pressure_pa in [11e3, 52e3, 90e3] {
        let [first, second] = [0, 1].map(|index| at(&each[index], pressure_pa));
        assert!(first.bend_angle_rad > 0.0 && second.bend_angle_rad > first.bend_angle_rad);
        let mount = 20f64.to_radians();
        let turned = |angle: f64, arc: Matrix4<f64>| about_z(angle) * arc * about_z(-angle);
        let expected = turned(mount, arc(0.056 * first.axial_stretch, first.bend_angle_rad))
            * turned(mount + std::f64::consts::FRAC_PI_2, arc(0.096 * second.axial_stretch, second.bend_angle_rad))
            * along(0.004 + 0.015);
        let state = limb.modules()[0].curve.at(pressure_pa);
        near(tip_of(&limb, limb.tip([&state])), &expected, 1e-8);
        let bends_rad = first.bend_angle_rad + second.bend_angle_rad;
        assert!((limb.modules()[0].measure(&state) - bends_rad).abs() < 1e-7);
        let wanted = Series::new(&each).unwrap().inverse(SeriesTarget::BendAngle(bends_rad), &Load::none()).unwrap();
        assert!((wanted.state.pressure_pa - pressure_pa).abs() < 1e-3);
        let found_pa = table_pa(&scene, &limb, bends_rad);
        assert!((found_pa - pressure_pa).abs() < 10.0, "{found_pa} {pressure_pa}");
    }
}

/// The base twists, and the direction of the bend behind it goes round with it.
#[test]
fn twist_of_a_segment_turns_the_bend_behind_it() {
    let scene = scene(&[
        STRAIGHT[0],
        (
            "motion = \"extension\"\nlength = \"60 mm\"\nwinding = \"hoop\"",
            "motion = \"twisting\"\nlength = \"60 mm\"\nwinding = \"helix\"",
        ),
    ]);
    let limb = limb(&scene);
    let each = actuators(&limb);
    let [first, second] = [0, 1].map(|index| at(&each[index], 60e3));
    assert!(first.twist_rad < -0.3);
    let expected = along(0.06 * first.axial_stretch)
        * about_z(first.twist_rad)
        * arc(0.1 * second.axial_stretch, second.bend_angle_rad)
        * along(0.015);
    let state = limb.modules()[0].curve.at(60e3);
    near(tip_of(&limb, limb.tip([&state])), &expected, 1e-7);
    // Body and drawn line end where the tip is.
    let [body, line] = [limb.body([&state]).end().translation.vector.into(), *limb.backbone([&state]).last().unwrap()];
    near(tip_of(&limb, body), &expected, 1e-7);
    near(tip_of(&limb, line), &expected, 1e-7);
    assert_eq!(limb.body([&state]).pieces().len(), 3);
}

fn files(scene: &Scene) -> RunFiles {
    let folder = tempfile::tempdir().unwrap();
    let options =
        RunOptions { seed: 5, out: folder.path().to_owned(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    run(scene, &options, &AtomicBool::new(false), |_| ()).unwrap()
}

/// The true actuator has another wall, modulus and winding than its model. Its tip is where its own segments put it at the true pressure.
#[test]
fn tip_of_a_run_is_that_of_the_true_segments_at_the_true_pressure() {
    let scene = scene(&[]);
    let limb = limb(&scene);
    let settings = softlimb_rig::simulate::settings(&scene, &limb, 5);
    let made = Plant::new(&settings.plant).unwrap().truth().channels.remove(0).parameters;
    let nominal = limb.modules()[0].actuator.parameters().material.shear_modulus_pa();
    assert!((made.actuator.material.shear_modulus_pa() / nominal - 1.0).abs() > 0.01);
    let each: Vec<_> = made.segments.iter().map(|segment| segment.model().unwrap()).collect();
    let run = files(&scene).run;
    let (mut most_rad, mut counted) = (0.0_f64, 0);
    for sample in run.samples.iter().filter(|sample| sample.channels[0].true_pressure_pa.unwrap() > 1.0) {
        let pressure_pa = sample.channels[0].true_pressure_pa.unwrap();
        let [first, second] = [0, 1].map(|index| at(&each[index], pressure_pa));
        let expected =
            along(0.06 * first.axial_stretch) * arc(0.1 * second.axial_stretch, second.bend_angle_rad) * along(0.015);
        near(tip_of(&limb, sample.tip_achieved_m.unwrap()), &expected, 1e-7);
        let achieved = sample.modules[0].achieved.unwrap();
        assert!((achieved - second.bend_angle_rad).abs() < 1e-6, "{achieved} {second:?}");
        let modelled = limb.modules()[0].curve.at(sample.channels[0].true_pressure_pa.unwrap());
        most_rad = most_rad.max((modelled.bend_angle_rad - achieved).abs());
        counted += 1;
    }
    println!("{counted} samples, model and truth {most_rad:.4} rad apart");
    // The truth is not the model's.
    assert!(counted > 100 && most_rad > 0.005, "{counted} {most_rad}");
    let shape = run.shapes.last().unwrap();
    assert_eq!(shape.setpoint.len(), shape.achieved.as_ref().unwrap().len());
}

#[test]
fn run_reaches_the_bend_of_a_limb_that_is_as_modelled() {
    let spread = "spread = { modulus = 0, wall = 0, fiber_angle = 0, dead_volume = 0, valve_conductance = 0, valve_delay = 0, sensor_offset = 0, sensor_gain = 0 }";
    let scene = scene(&[("chamber = { creep_share = 0 }", &format!("chamber = {{ creep_share = 0 }}\n{spread}"))]);
    let run = files(&scene).run;
    let held = run.samples.iter().filter(|sample| (3.5..3.9).contains(&sample.time_s));
    let bends: Vec<f64> = held.map(|sample| sample.modules[0].achieved.unwrap()).collect();
    let off_rad = bends.iter().map(|bend| (bend - 60f64.to_radians()).abs()).fold(0.0, f64::max);
    println!("{} samples, {off_rad:.4} rad off", bends.len());
    // The least pulse of the valves leaves that.
    assert!(!bends.is_empty() && off_rad < 0.015, "{off_rad}");
}

#[test]
fn what_has_no_model_of_a_series_says_so_at_its_line() {
    let refused = |from: &str, to: &str| Limb::new(&scene(&[(from, to)])).unwrap_err().render(false);
    let body = refused("chamber = { creep_share = 0 }", "truth = { limb = \"body\" }");
    assert!(body.contains("and a true body takes modules of one"), "{body}");
    let cubic = scene(&[("[plant]", "[controller]\nbending = \"section-fe\"\n[plant]")]);
    let error = motion::inverses(&cubic, &limb(&cubic)).unwrap_err().render(false);
    assert!(error.contains("each of its segments has a separate bending model"), "{error}");
    let model = scene(&[("[plant]", "[controller]\ninverse = \"model\"\n[plant]")]);
    let error = motion::inverses(&model, &limb(&model)).unwrap_err().render(false);
    assert!(error.contains("the device needs tables for the module `finger`"), "{error}");
}

/// As made as modelled, so that only the valves' pulses are left.
const NO_SPREAD: &str = "spread = { modulus = 0, wall = 0, fiber_angle = 0, dead_volume = 0, valve_conductance = 0, valve_delay = 0, sensor_offset = 0, sensor_gain = 0 }";

/// The shipped limb under its weight, hanging down at an end of each move.
fn heavy(spread: &str) -> Scene {
    let plant = format!("chamber = {{ creep_share = 0 }}\n{spread}");
    scene(&[
        ("[weight]\nsimulated = false\n", "[weight]\n"),
        ("base_direction = [1, 0, 0]\nbase_up = [0, 0, 1]", "base_direction = [0, 0, -1]\nbase_up = [1, 0, 0]"),
        ("mass = \"50 g\"", "mass = \"4 g\""),
        ("chamber = { creep_share = 0 }", &plant),
    ])
}

/// Planned, corrected for weight, hung and measured: at rest the tip is where the statics have it at the true pressure.
#[test]
fn run_under_weight_is_the_equilibrium_of_its_segments() {
    let scene = heavy(NO_SPREAD);
    let limb = limb(&scene);
    let run = files(&scene).run;
    let held: Vec<_> = run.samples.iter().filter(|sample| (3.5..3.9).contains(&sample.time_s)).collect();
    assert!(!held.is_empty());
    for sample in held {
        let pressure_pa = sample.channels[0].true_pressure_pa.unwrap();
        let load = statics::Load::default();
        let loaded = LoadedLimb::new(&scene, &limb, &[pressure_pa], &[1], &load).unwrap();
        let settled = loaded.settle(Fidelity::Fourfold, None).unwrap();
        let wanted = settled.shape.tip().translation.vector;
        let tip = nalgebra::Vector3::from(sample.tip_achieved_m.unwrap());
        let sag_m = (wanted - loaded.free_tip().translation.vector).norm();
        assert!((tip - wanted).norm() < 1e-6 && sag_m > 5e-3, "{tip} {wanted} {sag_m}");
        // The setpoint is the total bend, to which the extending segment adds its own under weight.
        let deformed = settled.limb.deformed(&settled.rod, &settled.shape);
        let achieved = sample.modules[0].achieved.unwrap();
        assert!((achieved - deformed[0].bend_angle_rad[0]).abs() < 1e-6, "{achieved} {deformed:?}");
    }
}

/// Segments as they are made, drawn like all true actuators, hang by their own springs.
#[test]
fn true_segments_hang_by_their_own_springs() {
    let scene = heavy("");
    let limb = limb(&scene);
    let settings = softlimb_rig::simulate::settings(&scene, &limb, 5);
    let truth = Plant::new(&settings.plant).unwrap().truth();
    let made = &truth.channels[0].parameters;
    let files = files(&scene);
    let run = &files.run;
    let mut counted = 0;
    for sample in run.samples.iter().filter(|sample| sample.time_s > 3.0 && sample.time_s < 3.9) {
        let pressure_pa = sample.channels[0].true_pressure_pa.unwrap();
        let tubes: Vec<Spring> =
            made.segments.iter().map(|one| Spring::new(&one.model().unwrap(), pressure_pa).unwrap()).collect();
        let loaded = LoadedLimb::of_springs(&scene, &limb, &tubes, &statics::Load::default()).unwrap();
        let wanted = loaded.settle(Fidelity::Fourfold, None).unwrap().shape.tip().translation.vector;
        let tip = nalgebra::Vector3::from(sample.tip_achieved_m.unwrap());
        assert!((tip - wanted).norm() < 1e-5, "{tip} {wanted}");
        counted += 1;
    }
    assert!(counted > 5, "{counted}");
}
