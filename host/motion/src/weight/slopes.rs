//! The tip's slopes along a plan, under the load that the plan knows.

use nalgebra::Vector3;

use super::nominal::{Nominal, OnLimb, pressures_pa};
use crate::jacobian::tip_slopes;
use crate::payload::{carried, payload_kg};
use crate::plan::Plan;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::Scene;

/// Slopes by each module's pressure at a time of a plan, us, as [`tip_slopes`] has them: of the loaded limb where the setpoints are corrected
/// for weight.
pub fn planned_slopes(scene: &Scene, limb: &Limb, plan: &Plan, time_us: f64) -> Vec<(Vector3<f64>, f64)> {
    let states = plan.states_at(time_us);
    let mut slopes = tip_slopes(limb, &states);
    let Some(weighed) = plan.weighed() else { return slopes };
    let kg = payload_kg(&carried(scene.phases()), &plan.phases, (time_us as u64).saturating_sub(1));
    let (pressures_pa, on) = (pressures_pa(&states), OnLimb::whole(kg));
    let spans_pa: Vec<f64> = limb.modules().iter().map(LimbModule::single_valued_max_pa).collect();
    let mut nominal = Nominal::new(scene, limb, weighed.tier);
    let pose = nominal.at(&pressures_pa, on).ok();
    let loaded = pose.and_then(|pose| nominal.velocities_m(&pose, &pressures_pa, on, &spans_pa));
    for ((velocity, _), (loaded, span_pa)) in slopes.iter_mut().zip(loaded.iter().flatten().zip(&spans_pa)) {
        *velocity = loaded / *span_pa;
    }
    slopes
}
