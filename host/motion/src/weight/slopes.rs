//! The tip's slopes along a plan, under the load that the plan knows.

use nalgebra::Vector3;

use super::nominal::{Nominal, pressures_pa};
use crate::jacobian::tip_slopes;
use crate::payload::{carried, payload_kg};
use crate::plan::Plan;
use softlimb_limb::Limb;
use softlimb_scene::Scene;

/// How the tip moves, m/Pa, and the setpoint, per Pa, with the pressure of each actuator at a time of a plan, us, in the order of the channels: of
/// the loaded limb where the setpoints are corrected for weight. Without weight a drive has the mean of its actuators.
pub fn planned_slopes(scene: &Scene, limb: &Limb, plan: &Plan, time_us: f64) -> Vec<(Vector3<f64>, f64)> {
    let states = plan.states_at(time_us);
    let of_drives = limb.drives().zip(tip_slopes(limb, &states));
    let mut slopes: Vec<(Vector3<f64>, f64)> = of_drives
        .flat_map(|(drive, (velocity, slope))| {
            let count = drive.channels.len();
            std::iter::repeat_n((velocity / count as f64, slope), count)
        })
        .collect();
    let Some(weighed) = plan.weighed() else { return slopes };
    let payload_kg = payload_kg(&carried(scene.phases()), &plan.phases, time_us as u64);
    let pressures_pa = pressures_pa(&states);
    let mut nominal = Nominal::new(scene, limb, weighed.tier);
    let pose = nominal.at(&pressures_pa, payload_kg).ok();
    let loaded = pose.and_then(|pose| nominal.velocities_m_per_pa(&pose, &pressures_pa));
    for ((velocity, _), loaded) in slopes.iter_mut().zip(loaded.iter().flatten()) {
        *velocity = *loaded;
    }
    slopes
}
