//! Every scene of the repository, end to end: scene, plan, link, controller, plant, log, report.

#[path = "scenes/bars.rs"]
mod bars;
#[path = "scenes/golden.rs"]
mod golden;
#[path = "scenes/nominal.rs"]
mod nominal;
#[path = "scenes/spread.rs"]
mod spread;
mod support;

use std::sync::LazyLock;

use fra_model::StateQuantity;
use softlimb_rig::record::ModuleSample;
use softlimb_scene::Scene;
use support::{Ran, names, run, scene_with};

/// The name of every scene with the scene and its run as it is.
static AS_IT_IS: LazyLock<Vec<(String, Scene, Ran)>> = LazyLock::new(|| {
    let run_of = |name: String| {
        let scene = scene_with(&name, "");
        let ran = run(&scene, scene.seed());
        (name, scene, ran)
    };
    std::thread::scope(|scope| {
        let runs: Vec<_> = names().into_iter().map(|name| scope.spawn(|| run_of(name))).collect();
        runs.into_iter().map(|run| run.join().expect("a run")).collect()
    })
});

/// The value of a quantity at rest, in the unit of the log. Scenes with other quantities than these have no travel to compare with.
fn at_rest(quantity: StateQuantity) -> f64 {
    match quantity {
        StateQuantity::AxialStretch => 1.0,
        StateQuantity::Twist | StateQuantity::BendAngle | StateQuantity::Pressure => 0.0,
        StateQuantity::OuterRadius | StateQuantity::InnerRadius => panic!("a radius at rest depends on the actuator"),
    }
}

/// Largest deviation of the setpoint of a module from rest.
fn travel<'a>(quantity: StateQuantity, samples: impl Iterator<Item = &'a ModuleSample>) -> f64 {
    samples.map(|sample| (sample.setpoint - at_rest(quantity)).abs()).fold(0.0, f64::max)
}
