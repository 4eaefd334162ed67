//! Creep of the walls at the ends of phases.
//!
//! The scene's `creep_share` `x` and `creep_time` `tau` as `docs/explanation/plant.md` has them, one branch in the volume of an actuator,
//! `tau dV_c/dt = x (V - V_0) - V_c`, along the setpoints. The shape is that of the volume with its creep, at a higher pressure.

use fra_model::{Load, State, Status};

use softlimb_limb::{Drive, Limb, LimbModule, StateCurve};
use softlimb_motion::Plan;
use softlimb_scene::Scene;

/// Time between two volumes that the branch is led along, us; its goal is taken as linear between them.
const STEP_US: f64 = 20_000.0;
/// Steps of Newton's method, and the one at which it ends, Pa.
const STEPS: usize = 20;
const CONVERGED_PA: f64 = 1e-3;
/// Pressure up to which creep is looked for, as a multiple of the module's limit.
const LONGER: f64 = 1.3;

/// Volume by which one actuator of each drive has crept at the end of each phase, m3: by phase, then by drive.
pub(super) fn at_ends_m3(scene: &Scene, limb: &Limb, plan: &Plan) -> Vec<Vec<f64>> {
    let chamber = &scene.plant().chamber;
    let goals = |time_us: f64| -> Vec<f64> {
        let states = plan.states_at(time_us);
        let of = |(state, drive): (&State<f64>, Drive<'_>)| {
            chamber.creep_share * (state.volume_m3 - drive.actuator.rest().volume_m3)
        };
        states.iter().zip(limb.drives()).map(of).collect()
    };
    let (mut time_us, mut last) = (0.0, goals(0.0));
    let mut crept = vec![0.0; limb.drives().len()];
    let mut ends = Vec::with_capacity(plan.phases.len());
    for phase in &plan.phases {
        let end_us = (phase.start_us + phase.move_us + phase.hold_us) as f64;
        while time_us < end_us {
            let next_us = end_us.min(time_us + STEP_US);
            let next = goals(next_us);
            let follows = -(-1e-6 * (next_us - time_us) / chamber.creep_time_s).exp_m1();
            for ((crept, before), after) in crept.iter_mut().zip(&last).zip(&next) {
                *crept += (0.5 * (before + after) - *crept) * follows;
            }
            (time_us, last) = (next_us, next);
        }
        ends.push(crept.clone());
    }
    ends
}

/// The state whose volume is larger by `crept_m3` than that at a gauge pressure; `None` where the branch of equilibria ends before.
pub(super) fn crept(module: &LimbModule, pressure_pa: f64, crept_m3: f64) -> Option<State<f64>> {
    if module.is_by_section() {
        let (parameters, limit_pa) = (module.actuator.parameters(), LONGER * module.pressure_max_pa);
        let longer = || StateCurve::by_section(parameters, module.second_fiber(), limit_pa).ok();
        let find = |curve: &StateCurve| {
            let is_known = pressure_pa <= curve.pressure_max_pa();
            let wanted_m3 = is_known.then(|| curve.at(pressure_pa).volume_m3 + crept_m3)?;
            curve.find(|state| state.volume_m3, wanted_m3)
        };
        return find(&module.curve).or_else(|| find(&longer()?));
    }
    let actuator = &module.actuator;
    let solved = |solution: fra_model::Solution<f64>| (solution.status == Status::Solved).then_some(solution.state);
    let mut state = solved(actuator.forward(pressure_pa, &Load::none()).ok()?)?;
    let wanted_m3 = state.volume_m3 + crept_m3;
    for _ in 0..STEPS {
        let step_pa = (wanted_m3 - state.volume_m3) / state.compliance_m3_per_pa;
        if step_pa.abs() <= CONVERGED_PA {
            return Some(state);
        }
        state = solved(actuator.forward_from(&state, state.pressure_pa + step_pa, &Load::none()).ok()?)?;
    }
    None
}
