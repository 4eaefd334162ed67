//! The camera's observations of the tip at the ends of phases.

use std::ops::Range;

use nalgebra::Vector3;

use super::Settings;
use crate::camera::Camera;
use crate::payload_estimation::{ACCURACY_M, Observation};
use crate::record::Sample;
use crate::run;
use crate::run::RunError;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_scene::Scene;

/// Time before the end of a phase in which the tip is observed, s.
const WINDOW_S: f64 = 0.1;

/// Runs the setpoints of a scene without and with a load, N, each as often as the settings have runs, and observes the ends of all phases.
/// Weight and load are simulated whatever the scene says. The pressures are the sensors' readings.
///
/// # Errors
/// [`RunError`] where a run fails or the limb falls.
pub fn observe(scene: &Scene, load_n: f64, settings: &Settings) -> Result<Vec<Observation>, RunError> {
    let limb = Limb::new(scene)?;
    let plan = motion::plan(scene, &limb)?;
    let sent = motion::sent(scene, &limb, &plan)?;
    let mut camera = Camera::learning(scene, settings.camera_noise_m, (settings.noise, settings.limb));
    let mut observations = Vec::new();
    let runs = u64::from(settings.runs.get());
    for (loaded, run) in [false, true].into_iter().flat_map(|loaded| (0..runs).map(move |run| (loaded, run))) {
        let load_n = if loaded { load_n } else { 0.0 };
        let hung = scene.carrying(load_n / softlimb_limb::statics::GRAVITY_M_PER_S2, true);
        let noise = settings.noise + 2 * run + u64::from(loaded);
        let samples = run::samples(&hung, &limb, (&plan, &sent), (settings.limb, noise))?;
        for (phase, end_s) in ends_s(&plan).enumerate() {
            let tip_m = mean(&tips_m(&samples, end_s)?) + camera.noise_m();
            let reading_pa = |channels: &Range<usize>| {
                let readings = window(&samples, end_s).flat_map(|sample| &sample.channels[channels.clone()]);
                let (sum, count) =
                    readings.fold((0.0, 0_u32), |(sum, count), channel| (sum + channel.pressure_pa, count + 1));
                sum / f64::from(count.max(1))
            };
            let pressures_pa = limb.drives().map(|drive| reading_pa(&drive.channels)).collect();
            let line = observations.len() + 2;
            observations.push(Observation { line, phase, loaded, tip_m, accuracy_m: ACCURACY_M, pressures_pa });
        }
    }
    Ok(observations)
}

/// Ends of the phases, s.
pub(super) fn ends_s(plan: &Plan) -> impl Iterator<Item = f64> {
    plan.phases.iter().map(|phase| (phase.start_us + phase.move_us + phase.hold_us) as f64 * 1e-6)
}

/// Positions of the tip before the end of a phase, m.
pub(super) fn tips_m(samples: &[Sample], end_s: f64) -> Result<Vec<Vector3<f64>>, RunError> {
    let tips: Option<Vec<_>> = window(samples, end_s).map(|sample| sample.tip_achieved_m.map(Vector3::from)).collect();
    tips.filter(|tips| !tips.is_empty()).ok_or(RunError::NotSeen { time_s: end_s })
}

fn window(samples: &[Sample], end_s: f64) -> impl Iterator<Item = &Sample> {
    samples.iter().filter(move |sample| sample.time_s > end_s - WINDOW_S && sample.time_s <= end_s + 1e-6)
}

/// Mean of positions; zero of none.
pub(super) fn mean(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}
