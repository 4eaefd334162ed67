//! Runs of a limb that weighs something.

#[path = "weight/mass.rs"]
mod mass;
#[path = "weight/mass_command.rs"]
mod mass_command;
#[path = "weight/plans.rs"]
mod plans;
#[path = "weight/runs.rs"]
mod runs;
#[path = "weight/tracked.rs"]
mod tracked;

use std::sync::atomic::AtomicBool;

use fra_model::{Actuator, Load};
use softlimb::record::{RunLog, Sample};
use softlimb::run::{self, Mcu, RunOptions};
use softlimb::scene::{self, Scene};

/// One module that hangs down and carries 50 g for a while, that is put down again.
const HANGING: &str = r#"
format = 1
name = "hanging"
seed = 3
materials.silicone = { law = "neo-hookean", shear_modulus = "0.223 MPa", density = "1080 kg/m3" }
windings.hoop = { angle = "3 deg", families = 2, modulus = "361 MPa", thickness = "0.178 mm" }
phase = [
    { name = "reach", duration = "1 s", hold = "0.4 s", targets = { wrist = { axial_stretch = 1.06 } } },
    { name = "pick", duration = "0.4 s", hold = "0.4 s", payload = "50 g", gripper = "close", targets = { wrist = { axial_stretch = 1.05 } } },
    { name = "carry", duration = "0.4 s", payload = "50 g", targets = { wrist = { axial_stretch = 1.06 } } },
    { name = "place", duration = "0.4 s", hold = "0.4 s", payload = "50 g", gripper = "open", targets = { wrist = { axial_stretch = 1.05 } } },
]
limb = { base_direction = [0, 0, -1], base_up = [1, 0, 0], connector = { length = "15 mm", mass = "100 g" } }

[[module]]
name = "wrist"
motion = "extension"
actuators = 3
circle_radius = "30 mm"
spacers = 2
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"
winding = "hoop"

"#;

/// [`HANGING`] with nothing to pick up, as a limb without weight may be.
fn empty() -> String {
    HANGING.replace("payload = \"50 g\", ", "")
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

/// A scene of the repository with more text behind it.
fn repository(name: &str, more: &str) -> Scene {
    let path = format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    parsed(&(std::fs::read_to_string(path).unwrap() + more))
}

fn log(scene: &Scene) -> RunLog {
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions { seed: scene.seed(), out: folder.path().to_owned(), mcu: Mcu::Here };
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
