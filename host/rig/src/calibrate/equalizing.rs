//! Setpoints for the unequal actuators of a module: each of them pulls and pushes as the mean one does.
//!
//! A module's tubes get one pressure. Where they differ, their forces differ, and bend the module. At the stretch that a tube has in the planned shape
//! of the limb, its own pressure for the force of the mean tube is found by secants: the force is almost linear in the pressure.

use fra_model::{Actuator, Motion};
use nalgebra::Vector4;
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Drive, Limb};
use softlimb_motion as motion;
use softlimb_motion::{Nominal, Plan, carried, payload_kg};
use softlimb_scene::{Corrections, PhaseCorrections, Scene};

use crate::run::RunError;

/// Longest time between two rows of corrections, us.
const PERIOD_US: u64 = 500_000;
/// Most secants, and the change of a pressure that ends them, Pa: a device sends its pressures in steps of 10.
const SECANTS: usize = 20;
const CONVERGED_PA: f64 = 0.1;

/// Corrections of the setpoints of a scene's extending modules with unequal actuators: these, one a channel, of which the scene has the means.
/// What bends and twists has none: its tubes are held to one motion.
///
/// # Errors
/// [`RunError`] where the scene cannot be planned.
pub fn equalizing(scene: &Scene, actuators: &[Actuator<f64>]) -> Result<PhaseCorrections, RunError> {
    let limb = Limb::new(scene)?;
    let plan = motion::plan(scene, &limb)?;
    let carried = carried(scene.phases());
    let tier = plan.weighed().map_or(Fidelity::Linear, |weighed| weighed.tier);
    let mut nominal = Nominal::new(scene, &limb, tier);
    let mut corrections = Corrections::default();
    for time_us in times_us(&plan) {
        let states = plan.states_at(time_us as f64);
        let pressures_pa: Vec<f64> = states.iter().map(|state| state.pressure_pa.max(0.0)).collect();
        let pose = nominal.at(&pressures_pa, payload_kg(&carried, &plan.phases, time_us));
        let pose = pose.map_err(|_| RunError::NotSeen { time_s: 1e-6 * time_us as f64 })?;
        let strains = pose.limb.strains(&pose.rod, &pose.shape.q);
        let of_drive = |(drive, pressure_pa): (Drive<'_>, &f64)| {
            let own = actuators.get(drive.channels.clone()).unwrap_or_default();
            of_drive(&drive, *pressure_pa, own, &strains[drive.index])
        };
        corrections.times_s.push(1e-6 * time_us as f64);
        corrections.rows.push(limb.drives().zip(&pressures_pa).flat_map(of_drive).collect());
    }
    Ok(plan.by_phase(&limb, &corrections))
}

/// The ends of moves and holds, and times between them.
fn times_us(plan: &Plan) -> Vec<u64> {
    let regular = (0..=plan.duration_us() / PERIOD_US).map(|step| step * PERIOD_US);
    let ends = plan.phases.iter().map(|phase| phase.start_us + phase.move_us);
    let mut all: Vec<u64> = regular.chain(ends).chain([plan.duration_us()]).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Corrections of the channels of a drive at a pressure, Pa, and strains of its module.
fn of_drive(drive: &Drive<'_>, pressure_pa: f64, own: &[Actuator<f64>], strain: &Vector4<f64>) -> Vec<f64> {
    let value = |pressure_pa: f64| drive.measure(&drive.curve.at(pressure_pa));
    let of_tube = |(actuator, [x, y]): (&Actuator<f64>, [f64; 2])| {
        let stretch = strain.x - strain.y * x - strain.z * y;
        let force_n = drive.actuator.blocked(pressure_pa, stretch, 0.0).ok()?.force_n;
        Some(value(pressure_with(actuator, force_n, stretch, pressure_pa)?) - value(pressure_pa))
    };
    if drive.motion != Motion::Extension || pressure_pa <= 0.0 || own.len() != drive.channels.len() {
        return vec![0.0; drive.channels.len()];
    }
    let places_m = if drive.is_steering() { vec![drive.position_m()] } else { drive.positions_m() };
    own.iter().zip(places_m).map(|tube| of_tube(tube).unwrap_or(0.0)).collect()
}

/// The gauge pressure, Pa, from a pressure nearby, at which a tube has a force, N, at a stretch; 0 at least.
fn pressure_with(actuator: &Actuator<f64>, force_n: f64, stretch: f64, near_pa: f64) -> Option<f64> {
    let off = |pressure_pa: f64| Some(actuator.blocked(pressure_pa, stretch, 0.0).ok()?.force_n - force_n);
    let (mut before, mut here) = (near_pa, 1.02 * near_pa);
    let mut off_before = off(before)?;
    for _ in 0..SECANTS {
        let off_here = off(here)?;
        let step = -off_here * (here - before) / (off_here - off_before);
        if !step.is_finite() || step.abs() <= CONVERGED_PA {
            break;
        }
        (before, off_before, here) = (here, off_here, here + step);
    }
    Some(here.max(0.0))
}
