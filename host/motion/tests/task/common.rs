//! Scenes made from those of the repository.

use nalgebra::{Isometry3, Translation3};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_scene as scene;
use softlimb_scene::Scene;

pub(crate) fn repository(name: &str) -> Scene {
    scene::load(format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a scene of the repository")
}

/// A scene of the repository with other phases, and with more tables.
pub(crate) fn with_phases(name: &str, tables: &str) -> String {
    let text = repository(name).source_text().to_owned();
    let cut = text.find("[[phase]]").expect("phases");
    let rest = text.find("[limits]").expect("limits after the phases");
    let head = text.find("[[obstacle]]").map_or(cut, |obstacles| obstacles.min(cut));
    format!("{}{tables}\n{}", &text[..head], &text[rest..])
}

pub(crate) fn planned(text: &str) -> Result<(Scene, Limb, Plan), String> {
    let shown = |error: scene::SceneError| error.render(false);
    let scene = scene::parse(text, "task.toml").map_err(shown)?;
    let limb = Limb::new(&scene).map_err(shown)?;
    let plan = motion::plan(&scene, &limb).map_err(shown)?;
    Ok((scene, limb, plan))
}

/// The error of a scene that cannot be planned.
pub(crate) fn refused(text: &str) -> String {
    match planned(text) {
        Ok(_) => panic!("this was planned:\n{text}"),
        Err(message) => message,
    }
}

/// Where the tip is at the end of a phase's move.
pub(crate) fn tip_after(limb: &Limb, plan: &Plan, phase: usize) -> Isometry3<f64> {
    let phase = &plan.phases[phase];
    limb.tip_pose(&plan.states_at((phase.start_us + phase.move_us) as f64))
}

pub(crate) fn off(limb: &Limb, plan: &Plan, phase: usize, tip_m: [f64; 3]) -> f64 {
    (tip_after(limb, plan, phase).translation.vector - nalgebra::Vector3::from(tip_m)).norm()
}

/// Least distance of body and obstacles over the whole plan, by samples in time and along the limb, from the poses of the kinematics.
pub(crate) fn sampled_clearance(scene: &Scene, limb: &Limb, plan: &Plan) -> f64 {
    let mut least = f64::INFINITY;
    for step in 0..=plan.duration_us() / 5_000 {
        let states = plan.states_at((step * 5_000) as f64);
        let mut pose = *limb.base();
        for (module, state) in limb.modules().iter().zip(&states) {
            let link = module.link(state);
            let [connector, tool] = module.rigid_parts_m();
            let rest = module.radius_m(&module.curve.states()[0]);
            let tool_radius = scene.limb().end_effector.as_ref().map_or(0.0, |tool| tool.radius_m);
            let parts = [(connector, rest, 0.0), (tool, tool_radius, connector)];
            for index in 0..=40 {
                let share = f64::from(index) / 40.0;
                let mut look = |at: Isometry3<f64>, radius: f64| {
                    for obstacle in scene.obstacles() {
                        least = least.min(obstacle.shape.distance(&at.translation.vector).distance_m - radius);
                    }
                };
                look(pose * link.pose_at(share), module.radius_m(state));
                for (length, radius, before) in parts.into_iter().filter(|(length, ..)| *length > 0.0) {
                    look(pose * link.pose_at(1.0) * Translation3::new(0.0, 0.0, before + share * length), radius);
                }
            }
            pose *= link.pose();
        }
    }
    least
}
