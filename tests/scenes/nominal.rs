//! Scenes on a plant that is exactly what the controller is told: whatever error remains has a name.

use softlimb_rig::record::ModuleSample;

use crate::support::{NO_CREEP, NO_SPREAD, Ran, run, run_planned, scene_with, weightless};
use crate::{PLANNED, travel};

/// Share of a deformation that creeps in, by default.
const CREEP_SHARE: f64 = 0.06;

/// For each module: its name, its travel, and what it did in the time with a setpoint.
fn modules(ran: &Ran) -> Vec<(String, f64, Vec<ModuleSample>)> {
    let log = &ran.files.run;
    let end_s = log.info.phases.last().unwrap().end_s();
    let scheduled = log.samples.iter().filter(|sample| sample.time_s <= end_s);
    let module = |index: usize| {
        let samples: Vec<_> = scheduled.clone().map(|sample| sample.modules[index]).collect();
        let info = &log.info.modules[index];
        (format!("{}: {}", log.info.scene_name, info.name), travel(info.quantity, samples.iter()), samples)
    };
    (0..log.info.modules.len()).map(module).collect()
}

fn largest(errors: impl Iterator<Item = f64>) -> f64 {
    errors.map(f64::abs).fold(0.0, f64::max)
}

#[test]
fn truth_without_spread_and_creep_is_the_model_of_the_controller() {
    for name in weightless() {
        let scene = scene_with(&name, &[NO_SPREAD, NO_CREEP].concat());
        for (module, travel, samples) in modules(&run(&scene, scene.seed())) {
            let apart = largest(samples.iter().map(|m| m.achieved.unwrap() - m.modelled)) / travel;
            let off = samples.iter().map(|m| (m.achieved.unwrap() - m.setpoint).powi(2)).sum::<f64>();
            let rmse = (off / samples.len() as f64).sqrt() / travel;
            println!(
                "{module:<26} truth and model at most {:.1e} apart, RMSE {:.2} % of the travel",
                apart,
                1e2 * rmse
            );
            // One curve read at the mean pressure of three actuators against the mean of three shapes: the curvature over 1 kPa.
            assert!(apart < 1e-4, "{module}: {apart}");
            // Pulses of 20 ms leave about 0.25 kPa, half a percent of the 50 kPa that a deformation takes.
            assert!(rmse < 0.01, "{module}: {rmse}");
        }
    }
}

#[test]
fn actuators_without_spread_are_off_by_their_creep() {
    for name in weightless() {
        let scene = scene_with(&name, NO_SPREAD);
        for (module, travel, samples) in modules(&run(&scene, scene.seed())) {
            let excess: Vec<f64> =
                samples.iter().map(|m| (m.achieved.unwrap() - m.modelled) * m.setpoint.signum() / travel).collect();
            let (least, most) = excess.iter().fold((0.0_f64, 0.0_f64), |(a, b), e| (a.min(*e), b.max(*e)));
            println!("{module:<26} creep up to {:.2} % of the travel", 1e2 * most);
            // A deformation is near to proportional to the volume, whose share creeps in: never more than all of it, never against it, and
            // over 7 s or more with a time constant of 3 s at least half.
            assert!((0.5 * CREEP_SHARE..1.1 * CREEP_SHARE).contains(&most), "{module}: {most}");
            assert!(least > -1e-4, "{module}: {least}");
        }
    }
}

#[test]
fn under_load_truth_without_spread_and_creep_is_where_the_model_has_it() {
    for (name, _, limb, plan) in PLANNED.iter().filter(|(name, ..)| !weightless().contains(name)) {
        // The plant is no matter of the plan.
        let scene = scene_with(name, &[NO_SPREAD, NO_CREEP].concat());
        // Without compensation the model is that of the free limb.
        if scene.weight().is_none_or(|weight| !weight.compensated) {
            continue;
        }
        let ran = run_planned(&scene, (limb.clone(), plan.clone()), scene.seed());
        let log = &ran.files.run;
        // Where pressures rest: on the way they change between the reading and the sample.
        let apart_m = log.info.phases.iter().map(|phase| {
            let end = log.samples.iter().rfind(|sample| sample.time_s <= phase.end_s()).expect("a sample");
            let achieved_m = end.tip_achieved_m.expect("it stands");
            achieved_m.iter().zip(end.tip_modelled_m).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        });
        let (apart_m, length_m) = (largest(apart_m), scene.rest_length_m());
        println!("{name:<18} truth and model at most {:.2} mm apart at rest", 1e3 * apart_m);
        // The truth is the finest rods, and the model those that the scene's tolerance of 0.1 % of the length chooses.
        assert!(apart_m < 1.5e-3 * length_m, "{name}: {apart_m}");
    }
}
