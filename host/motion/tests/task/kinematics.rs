//! Inverse kinematics with more modules than demands, against the whole family of solutions.

use softlimb_limb::Limb;
use softlimb_motion::{TipGoal, TipTask, solutions, solve_tip};

use super::common::repository;

fn shares(limb: &Limb, pressures_pa: &[f64]) -> Vec<f64> {
    limb.modules().iter().zip(pressures_pa).map(|(module, p)| p / module.single_valued_max_pa()).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Extension, bend, extension in a plane reach a point of it in a family of ways. By plane geometry the bend angle fixes the other two,
/// so the family can be gone through; none of it is nearer to where the limb was.
#[test]
fn of_a_family_of_solutions_the_nearest_is_taken() {
    let limb = Limb::new(&repository("weightless-a")).unwrap();
    let modules = limb.modules();
    let (outer, length, connector, tool) = (0.014, 0.24, 0.015, 0.05);
    for (target, home_shares) in [
        ([0.66, 0.0, 0.68], [0.5, 0.5, 0.5]),
        ([0.66, 0.0, 0.68], [0.0, 0.2, 0.9]),
        ([0.80, 0.0, 0.865], [0.9, 0.1, 0.0]),
    ] {
        let home_pa: Vec<f64> =
            modules.iter().zip(home_shares).map(|(module, share)| share * module.single_valued_max_pa()).collect();
        let found = solve_tip(&limb, target, &home_pa);
        assert!(found.reached());
        let taken = distance(&shares(&limb, &found.pressures_pa), &home_shares);
        let (forward, down) = (target[0], 1.1 - target[2]);
        let mut least = f64::INFINITY;
        for step in 1..40_000 {
            let bend = f64::from(step) * 5e-5;
            let radius = length / bend + outer;
            let straight = (down - radius * (1.0 - bend.cos())) / bend.sin();
            let first = forward - connector - radius * bend.sin() - straight * bend.cos();
            let values = [first / length, bend, (straight - 2.0 * connector - tool) / length];
            let states: Option<Vec<_>> = modules.iter().zip(values).map(|(m, value)| m.state_at(value)).collect();
            let Some(states) = states else { continue };
            let pressures: Vec<f64> = states.iter().map(|state| state.pressure_pa).collect();
            assert!((nalgebra::Vector3::from(limb.tip(&states)) - nalgebra::Vector3::from(target)).norm() < 1e-5);
            least = least.min(distance(&shares(&limb, &pressures), &home_shares));
        }
        assert!(taken <= least + 2e-3 && taken >= least - 2e-3, "{target:?}: {taken} against {least}");
    }
}

/// Every solution that is listed is one, and the list begins with the nearest but for the first descent's.
#[test]
fn solutions_meet_the_task() {
    let limb = Limb::new(&repository("weightless-c")).unwrap();
    let task =
        TipTask { goal: TipGoal::Point([0.72, 0.0, 0.98]), aim: None, upright: None, obstacles: &[], clearance_m: 0.0 };
    let found = solutions(&limb, &task, &[0.0; 3]);
    for reach in &found {
        let states: Vec<_> =
            limb.modules().iter().zip(&reach.pressures_pa).map(|(module, p)| module.curve.at(*p)).collect();
        let tip = nalgebra::Vector3::from(limb.tip(&states));
        assert!((tip - nalgebra::Vector3::new(0.72, 0.0, 0.98)).norm() < 1e-4);
        assert!(shares(&limb, &reach.pressures_pa).iter().all(|share| (0.0..=1.0 + 1e-12).contains(share)));
    }
}
