//! The tip's slopes along a plan, under the load that the plan knows.

use nalgebra::Vector3;

use super::nominal::{Nominal, pressures_pa};
use crate::jacobian::tip_slopes;
use crate::payload::{carried, payload_kg};
use crate::plan::Plan;
use softlimb_limb::Limb;
use softlimb_scene::Scene;

/// Slopes by each module's pressure at a time of a plan, us, as [`tip_slopes`] has them: of the loaded limb where the setpoints are corrected
/// for weight.
pub fn planned_slopes(scene: &Scene, limb: &Limb, plan: &Plan, time_us: f64) -> Vec<(Vector3<f64>, f64)> {
    let states = plan.states_at(time_us);
    let mut slopes = tip_slopes(limb, &states);
    let Some(weighed) = plan.weighed() else { return slopes };
    let payload_kg = payload_kg(&carried(scene.phases()), &plan.phases, time_us as u64);
    let pressures_pa = pressures_pa(&states);
    let mut nominal = Nominal::new(scene, limb, weighed.tier);
    let pose = nominal.at(&pressures_pa, payload_kg).ok();
    let loaded = pose.and_then(|pose| nominal.velocities_m_per_pa(&pose, &pressures_pa, payload_kg));
    for ((velocity, _), loaded) in slopes.iter_mut().zip(loaded.iter().flatten()) {
        *velocity = *loaded;
    }
    slopes
}
