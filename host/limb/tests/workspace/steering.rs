//! Steering modules: a pressure for each actuator in either box, against lattices of their arcs.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Load, LoadedLimb, Tangent};
use softlimb_limb::workspace::{Command, Loaded, Points, Workspace, extents, loaded_extents, sample};
use softlimb_scene as scene;

use crate::workspace::{limb_of, limb_with, text_with};

const LENGTH_M: f64 = 0.24;
const CIRCLE_M: f64 = 0.03;

#[test]
fn each_actuator_of_a_steering_module_is_an_axis() {
    let (_, limb) = limb_of("steering");
    let [setpoints, actuators] =
        [Command::Modules, Command::Actuators].map(|command| Workspace::new(&limb, command).expect("a workspace"));
    assert_eq!(setpoints.axes(), actuators.axes());
    assert_eq!(setpoints.axes().len(), limb.drives().len());
    assert_eq!(sample(&setpoints, Points::Even, 50, 1, 1), sample(&actuators, Points::Even, 50, 1, 1));
    // Beside it a plain module keeps its one pressure.
    let mixed = limb_with(&[("extension", 3, "steering = true"), ("extension", 3, ""), ("bending", 3, "")]);
    let axes = |command| Workspace::new(&mixed, command).expect("a workspace").axes().len();
    assert_eq!((axes(Command::Modules), axes(Command::Actuators)), (5, 7));
}

#[test]
fn equal_pressures_are_the_plain_module() {
    let [plain, steering] = ["", "steering = true"].map(|key| limb_with(&[("extension", 3, key)]));
    let [plain, steering] =
        [&plain, &steering].map(|limb| Workspace::new(limb, Command::Modules).expect("a workspace"));
    for share in [0.0, 0.3, 0.77, 1.0] {
        let (one, three) = (plain.tip(&[share]), steering.tip(&[share; 3]));
        assert!(one.iter().zip(three).all(|(a, b)| (a - b).abs() < 1e-9), "{share}: {one:?} {three:?}");
    }
}

/// Tips of one module at all pressures of a lattice: the three equations of the least energy, then an arc.
fn lattice(limb: &Limb, count: usize) -> Vec<[f64; 3]> {
    let module = &limb.modules()[0];
    let most_pa = module.curve.pressure_max_pa();
    let tubes: Vec<Tangent> = (0..=count)
        .map(|k| Tangent::of(&module.actuator, most_pa * k as f64 / count as f64).expect("an equilibrium"))
        .collect();
    let arms = [0.0, 1.0, 2.0].map(|i: f64| {
        let (sin, cos) = (TAU * i / 3.0).sin_cos();
        Vector3::new(1.0, -CIRCLE_M * cos, -CIRCLE_M * sin)
    });
    let tip = |pressures: [usize; 3]| {
        let (mut stiffness, mut force) = (Matrix3::zeros(), Vector3::zeros());
        for (arm, at) in arms.iter().zip(pressures) {
            let Tangent { stretch, axial_n, bending_nm2, .. } = tubes[at];
            stiffness +=
                arm * arm.transpose() * axial_n + Matrix3::from_diagonal(&Vector3::new(0.0, 1.0, 1.0)) * bending_nm2;
            force += arm * (axial_n * stretch);
        }
        let shape = stiffness.lu().solve(&force).expect("a minimum");
        let (bend, length_m) = (LENGTH_M * shape.y.hypot(shape.z), LENGTH_M * shape.x);
        if bend < 1e-9 {
            return [0.0, 0.0, length_m];
        }
        let [aside, along] = [1.0 - bend.cos(), bend.sin()].map(|part| length_m * part / bend);
        let unit = [shape.y, shape.z].map(|part| part * LENGTH_M / bend);
        [unit[0] * aside, unit[1] * aside, along]
    };
    let places = 0..=count;
    let all = places.clone().flat_map(|a| places.clone().flat_map(move |b| (0..=count).map(move |c| [a, b, c])));
    all.map(tip).collect()
}

#[test]
fn extents_are_those_of_a_lattice_of_three_pressures() {
    let limb = limb_with(&[("extension", 3, "steering = true")]);
    let space = Workspace::new(&limb, Command::Modules).expect("a workspace");
    let found = extents(&space).expect("extents");
    let tips = lattice(&limb, 40);
    for axis in 0..3 {
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let dense = tips.iter().map(|tip| sign * tip[axis]).fold(f64::NEG_INFINITY, f64::max);
            let beyond = sign * found.of[axis][side].value_m - dense;
            // A lattice can only miss.
            assert!((-1e-8..1e-3 * found.range_m(axis)).contains(&beyond), "{axis} {side}: {beyond:e} m");
        }
    }
    assert!(found.range_m(0) > 0.2 && found.range_m(1) > 0.2, "it bends both ways: {found:?}");
}

/// Under weight: equal pressures are the plain module, and no pose of a lattice is beyond the extents.
#[test]
fn loaded_extents_hold_a_lattice_of_poses() {
    let built = |key: &str| {
        let text =
            text_with(&[("extension", 3, key)]).replace("base_direction = [0, 0, 1]", "base_direction = [0, 0, -1]");
        let scene = scene::parse(&text, "test.toml").unwrap_or_else(|error| panic!("{error}"));
        let limb = Limb::new(&scene).expect("a limb");
        (scene, limb)
    };
    let (plain, steering) = (built(""), built("steering = true"));
    let hung = |both: &(scene::Scene, Limb), pressures_pa: &[f64]| {
        LoadedLimb::new(&both.0, &both.1, pressures_pa, &[4], &Load { payload_kg: 0.2, ..Load::default() })
    };
    let [one, three] = [&plain, &steering].map(|both| Workspace::new(&both.1, Command::Modules).expect("a workspace"));
    let plain_poses = Loaded::new(&one, |pressures_pa: &[f64]| hung(&plain, pressures_pa));
    let loaded = Loaded::new(&three, |pressures_pa: &[f64]| hung(&steering, pressures_pa));
    let fidelity = softlimb_limb::statics::Fidelity::Linear;
    for share in [0.0, 0.5, 1.0] {
        let pose = plain_poses.pose(|_| share, fidelity, None).expect("it hangs").tip_m;
        let equal = loaded.pose(|_| share, fidelity, None).expect("it hangs").tip_m;
        assert!(pose.iter().zip(equal).all(|(a, b)| (a - b).abs() < 1e-7), "{share}: {pose:?} {equal:?}");
    }
    let samples = loaded.sample(Points::Faces, 200, 1, 2);
    let found = loaded_extents(&loaded, &samples, (Points::Faces, 1), 2).expect("reached");
    for code in 0..216 {
        let place = [code % 6, code / 6 % 6, code / 36].map(|step: usize| step as f64 / 5.0);
        let Ok(pose) = loaded.pose(|axis| place[axis], fidelity, None) else { continue };
        for axis in 0..3 {
            let [least, largest] = &found.of[axis];
            // Extents are by the finest rods.
            let room = 2e-3 * found.range_m(axis) + least.error_m.max(largest.error_m);
            let inside = least.value_m - room..=largest.value_m + room;
            assert!(inside.contains(&pose.tip_m[axis]), "{place:?} {axis}: {:?} {inside:?}", pose.tip_m);
        }
    }
    assert!(found.range_m(0) > 0.05 && found.range_m(1) > 0.05, "{found:?}");
}
