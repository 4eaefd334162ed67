//! Runs of a limb that weighs something.

mod mass;
mod plans;
mod runs;
mod tracked;

use std::sync::atomic::AtomicBool;

use fra_model::{Actuator, Load};
use softlimb_rig::record::{RunLog, Sample};
use softlimb_rig::run;
use softlimb_rig::run::{Mcu, RunOptions};
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// One module that hangs down and carries 50 g for a while, that is put down again.
const HANGING: &str = include_str!("weight/hanging.toml");

/// Makes a limb weightless.
const WEIGHTLESS: &str = "[weight]\nsimulated = false\n";

/// [`HANGING`] without weight and with nothing to pick up.
fn empty() -> String {
    HANGING.replace("payload = \"50 g\", ", "") + WEIGHTLESS
}

/// A plant whose actuators are exactly those of the scene and take their shape at once.
const NO_SPREAD: &str = "
[plant.spread]
modulus = 0
wall = 0
fiber_angle = 0
dead_volume = 0
valve_conductance = 0
valve_delay = 0
sensor_offset = 0
sensor_gain = 0
[plant.chamber]
creep_share = 0
";

fn parsed(text: &str) -> Scene {
    scene::parse(text, "scene.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// A scene of the repository, with weight, with more text behind it.
fn repository(name: &str, more: &str) -> Scene {
    let path = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    parsed(&(std::fs::read_to_string(path).unwrap().replace(WEIGHTLESS, "") + more))
}

fn log(scene: &Scene) -> RunLog {
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions {
        seed: scene.seed(),
        out: folder.path().to_owned(),
        mcu: Mcu::Here,
        link_faults: None,
        faults: Vec::new(),
    };
    run::run(scene, &options, &AtomicBool::new(false), |_| ()).unwrap_or_else(|error| panic!("{error}")).run
}

/// The last sample before a time, s.
fn before(log: &RunLog, time_s: f64) -> &Sample {
    log.samples.iter().rfind(|sample| sample.time_s < time_s).unwrap()
}

/// By how much the first module hangs longer with `kg` below it and its own walls, by the nonlinear model of its tubes, m.
fn longer_m(scene: &Scene, pressure_pa: f64, kg: f64) -> f64 {
    let module = &scene.modules()[0];
    let actuator = Actuator::new(&module.actuator()).unwrap();
    let force_n = (kg + 0.5 * module.elastomer_mass_kg()) * 9.806_65 / 3.0;
    let load = |force_n| Load { force_n, torque_nm: 0.0 };
    let stretch = |force_n: f64| actuator.forward(pressure_pa, &load(force_n)).unwrap().state.axial_stretch;
    (stretch(force_n) - stretch(0.0)) * *module.length_m
}
