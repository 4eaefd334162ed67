//! Creep from steps, by its closed form.

use softlimb_rig::calibrate::{CalibrationError, Settings, Step, fit_creep};

use crate::calibrate::noise::{Noise, is_binomial};
use crate::calibrate::tube::grid;

/// 6 % of 0.15 with 3 s, on top of a stretch of 1.
fn response(time: f64) -> f64 {
    1.0 + 0.15 * (1.0 + 0.06 * (1.0 - (-time / 3.0).exp()))
}

fn step(until: f64, count: usize, noise: impl FnMut() -> f64, accuracy: f64) -> Step {
    let mut noise = noise;
    let points = grid(0.05, until, count).into_iter().map(|time| [time, response(time) + noise()]).collect();
    Step { rest: 1.0, points, accuracy }
}

#[test]
fn exact_step_gives_share_and_time() {
    let fit = fit_creep(&step(12.0, 60, || 0.0, 1e-6), &Settings::default()).unwrap();
    for (value, truth) in fit.values.iter().zip([0.15, 0.06, 3.0]) {
        assert!((value.value / truth - 1.0).abs() < 1e-8, "{}: {}", value.name, value.value);
    }
}

#[test]
fn intervals_of_creep_hold_the_truth_about_as_often_as_they_say() {
    let mut counts = [0; 3];
    for seed in 0..400 {
        let mut noise = Noise::seeded(5000 + seed);
        let fit = fit_creep(&step(15.0, 150, || 2e-4 * noise.normal(), 2e-4), &Settings::default()).unwrap();
        for (count, (value, truth)) in counts.iter_mut().zip(fit.values.iter().zip([0.15, 0.06, 3.0])) {
            *count += usize::from((value.interval[0]..=value.interval[1]).contains(&truth));
        }
    }
    println!("of 400 steps the 95 % intervals hold the truth: {counts:?}");
    assert!(counts.iter().all(|count| is_binomial(*count, 400, 0.95)), "{counts:?}");
}

/// Readings with a digit wrong make a descent towards times of no creep at all.
#[test]
fn reading_far_off_is_named() {
    for share in [-0.5, 0.1, 0.2, 0.5, 0.7, 1.5, 10.0] {
        let mut wrong = step(20.0, 8, || 0.0, 3e-4);
        wrong.points[4][1] = 1.0 + share * (wrong.points[4][1] - 1.0);
        let refused = fit_creep(&wrong, &Settings::default()).unwrap_err();
        assert!(matches!(refused, CalibrationError::NotReproduced { point: 4, .. }), "{share}: {refused}");
    }
}

#[test]
fn a_step_too_short_for_its_creep_is_refused() {
    let mut noise = Noise::seeded(7);
    let short = fit_creep(&step(0.6, 40, || 2e-4 * noise.normal(), 2e-4), &Settings::default()).unwrap_err();
    assert!(matches!(short, CalibrationError::NotIdentified { .. }), "{short}");
    assert!(short.to_string().contains("two or three time constants"), "{short}");
    let still = Step { rest: 1.0, points: vec![[0.1, 1.0], [0.2, 1.0], [0.3, 1.0], [0.4, 1.0]], accuracy: 1e-4 };
    assert!(fit_creep(&still, &Settings::default()).unwrap_err().to_string().contains("different from that at rest"));
    let few = Step { points: vec![[0.1, 1.1], [0.2, 1.2]], ..still };
    assert!(matches!(fit_creep(&few, &Settings::default()), Err(CalibrationError::TooFewPoints { needed: 4, .. })));
}
