//! Clearance of the limb under load.

use fra_model::State;
use nalgebra::Vector3;

use crate::goal::shapes;
use crate::plan::{PlannedPhase, phase_at};
use crate::unreachable::Unreachable;
use softlimb_limb::Limb;
use softlimb_scene::Scene;

/// Points between two of a centre line.
const BETWEEN: usize = 4;

/// Holds the centre line of the loaded limb to the clearance from obstacles: points along it at a knot.
///
/// # Errors
/// [`Unreachable::LoadedTooNear`].
pub(super) fn check(
    scene: &Scene,
    limb: &Limb,
    (phases, time_us): (&[PlannedPhase], u64),
    (line_m, states): (&[[f64; 3]], &[State<f64>]),
) -> Result<(), Unreachable> {
    let radii_m = limb.modules().iter().zip(states).map(|(module, state)| module.radius_m(state));
    let radius_m = radii_m.fold(0.0, f64::max);
    for (obstacle, shape) in shapes(scene).iter().enumerate() {
        for pair in line_m.windows(2) {
            let [from, to] = [Vector3::from(pair[0]), Vector3::from(pair[1])];
            let distance_m = (0..=BETWEEN)
                .map(|point| shape.distance(&from.lerp(&to, point as f64 / BETWEEN as f64)).distance_m - radius_m)
                .fold(f64::INFINITY, f64::min);
            if distance_m < scene.limits().clearance_m {
                let phase = phase_at(phases, time_us);
                return Err(Unreachable::LoadedTooNear { phase, time_us, obstacle, distance_m });
            }
        }
    }
    Ok(())
}
