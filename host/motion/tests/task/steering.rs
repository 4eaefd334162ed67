//! Steering modules: planned with and without weight.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use softlimb_limb::Limb;
use softlimb_motion::Sent;
use softlimb_scene::Scene;

use super::common::{planned, refused, repository};

/// The scene of two steering modules without weight.
fn weightless() -> String {
    let text = repository("steering").source_text().replace("payload = \"0.3 kg\"\n", "");
    text.replace("[limits]", "[weight]\nsimulated = false\n\n[limits]")
}

/// The tip by itself: the arc whose parallel lines have the actuators' lengths, from three equations in stretch and bends, as one screw a module.
fn tip_m(scene: &Scene, limb: &Limb, stretches: &[f64]) -> Vector3<f64> {
    let mut pose = *limb.base();
    for (index, module) in scene.modules().iter().enumerate() {
        let own = Vector3::from_column_slice(&stretches[3 * index..3 * index + 3]);
        let angle = |actuator: usize| module.mount_angle_rad + std::f64::consts::TAU * actuator as f64 / 3.0;
        let rows = [0, 1, 2].map(|actuator| {
            let (sin, cos) = angle(actuator).sin_cos();
            [1.0, -module.reach_m() * cos, -module.reach_m() * sin]
        });
        let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
        let [stretch, x, y]: [f64; 3] = matrix.try_inverse().map(|inverse| inverse * own).expect("a circle").into();
        let length_m = *module.length_m;
        let parts = 2000;
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(-y, x, 0.0) * (0.5 * length_m / f64::from(parts)));
        let ahead = Translation3::new(0.0, 0.0, stretch * length_m / f64::from(parts));
        let step: Isometry3<f64> = turn * Isometry3::from(ahead) * turn;
        pose = (0..parts).fold(pose, |pose, _| pose * step);
        pose *= Translation3::new(0.0, 0.0, limb.modules()[index].rigid_length_m());
    }
    pose.translation.vector
}

#[test]
fn weightless_tip_is_at_its_goals_by_the_lengths_of_the_actuators() {
    let (scene, limb, plan) = planned(&weightless()).unwrap();
    let goals = [[0.15, 0.0, 0.95], [0.0, 0.15, 0.97], [-0.12, -0.08, 0.96], [0.1, -0.12, 0.97]];
    for (phase, goal) in plan.phases.iter().zip(goals) {
        assert_eq!(phase.values.len(), 6);
        let off_m = (tip_m(&scene, &limb, &phase.values) - Vector3::from(goal)).norm();
        assert!(off_m < 1e-4, "{}: {off_m}", phase.name);
    }
}

#[test]
fn weightless_way_past_a_post_is_clear_by_samples() {
    let post = "[[obstacle]]\nname = \"post\"\nshape = \"capsule\"\nfrom = [0.1, 0.1, 0.5]\nto = [0.1, 0.1, 1.0]\n\
                radius = \"10 mm\"\n\n[limits]\nclearance = \"5 mm\"";
    let (scene, limb, plan) = planned(&weightless().replace("[limits]", post)).unwrap();
    let shape = &scene.obstacles()[0].shape;
    let (mut least_m, mut nearest_m) = (f64::INFINITY, f64::INFINITY);
    for time_us in (0..=plan.duration_us()).step_by(20_000) {
        let tip = Vector3::from(plan.tip_m(&limb, time_us as f64));
        // The tool ends in a ball about the tip.
        least_m = least_m.min(shape.distance(&tip).distance_m - 0.03);
    }
    for phase in &plan.phases {
        nearest_m = nearest_m.min(phase.nearest.expect("an obstacle").distance_m);
    }
    assert!(least_m >= 5e-3 && nearest_m >= 5e-3 && nearest_m <= least_m + 1e-6, "{least_m} {nearest_m}");
}

#[test]
fn every_actuator_is_sent_its_own_setpoint_under_weight() {
    let (_, limb, plan) = planned(repository("steering").source_text()).unwrap();
    let sent = Sent::uncorrected(&limb, &plan);
    let last = sent.knots().last().expect("knots");
    assert_eq!(last.len(), 6);
    let different = |own: &[i32]| own[0] != own[1] && own[1] != own[2] && own[0] != own[2];
    assert!(different(&last[..3]) && different(&last[3..]), "{last:?}");
}

#[test]
fn target_of_a_steering_module_is_that_of_all_its_actuators() {
    let text = weightless().replacen("tip = [0.15, 0.0, 0.95]", "targets = { lower = { axial_stretch = 1.15 } }", 1);
    let (_, _, plan) = planned(&text).unwrap();
    assert_eq!(plan.phases[0].values, [1.0, 1.0, 1.0, 1.15, 1.15, 1.15]);
}

#[test]
fn goal_out_of_reach_names_the_actuators_at_their_ends() {
    let said = refused(&repository("steering").source_text().replace("[0.15, 0.0, 0.95]", "[0.45, 0.0, 1.3]"));
    assert!(said.contains("cannot reach this goal under its load") && said.contains("`upper."), "{said}");
}
