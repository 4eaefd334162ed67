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
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_rig::record::ModuleSample;
use softlimb_scene::Scene;
use support::{Ran, names, run_planned, scene_with};

/// The name of every scene with the scene, its limb and its plan.
static PLANNED: LazyLock<Vec<(String, Scene, Limb, Plan)>> = LazyLock::new(|| {
    in_parallel(&names(), |name| {
        let scene = scene_with(name, "");
        let limb = Limb::new(&scene).expect("a limb");
        let plan = motion::plan(&scene, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
        (name.clone(), scene, limb, plan)
    })
});

/// The name of every scene with the scene and its run as it is.
static AS_IT_IS: LazyLock<Vec<(String, Scene, Ran)>> = LazyLock::new(|| {
    in_parallel(&PLANNED, |(name, scene, limb, plan)| {
        let ran = run_planned(scene, (limb.clone(), plan.clone()), scene.seed());
        (name.clone(), scene.clone(), ran)
    })
});

/// One thread for each.
fn in_parallel<A: Sync, B: Send>(all: &[A], of: impl Fn(&A) -> B + Sync) -> Vec<B> {
    std::thread::scope(|scope| {
        let threads: Vec<_> = all.iter().map(|one| scope.spawn(|| of(one))).collect();
        threads.into_iter().map(|thread| thread.join().expect("an answer")).collect()
    })
}

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
