//! Mean and spread over specimens.

use softlimb_rig::calibrate::random_effects;

use crate::calibrate::noise::{Noise, is_binomial};
use crate::samples::samples;

#[test]
fn equal_deviations_give_the_textbook_s_mean_and_deviation() {
    // Without errors of their own: mean 3, variance (4 + 1 + 0 + 9)/3, t of 3 degrees of freedom 3.182, chi-square 0.2158 and 9.348.
    let found = random_effects(&[(1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (6.0, 0.0)], 0.95).unwrap();
    let deviation = (14.0_f64 / 3.0).sqrt();
    assert!((found.mean - 3.0).abs() < 1e-9 && (found.spread - deviation).abs() < 1e-9, "{found:?}");
    assert!((found.interval[1] - 3.0 - 3.182 * deviation / 2.0).abs() < 2e-3, "{found:?}");
    let ends = [9.348, 0.2158].map(|square: f64| (14.0 / square).sqrt());
    assert!(found.spread_interval.iter().zip(ends).all(|(found, end)| (found / end - 1.0).abs() < 2e-3), "{found:?}");
    // Errors of the fits alone explain the differences: no spread.
    let found = random_effects(&[(1.0, 5.0), (2.0, 5.0), (3.0, 5.0)], 0.95).unwrap();
    assert_eq!((found.spread, found.spread_interval[0]), (0.0, 0.0));
    assert!((found.mean - 2.0).abs() < 1e-12);
    assert_eq!(random_effects(&[(1.0, 0.1), (2.0, 0.1)], 0.95), None);
    assert_eq!(random_effects(&[(1.0, 0.1), (2.0, 0.1), (3.0, f64::NAN)], 0.95), None);
}

#[test]
fn intervals_over_specimens_hold_the_truth_as_often_as_they_say() {
    let sets = samples(400) as usize;
    let (mean, spread) = (2e5, 2e4);
    // Fits that are better and worse than the spread, of different accuracy.
    let deviations = [5e3, 1e4, 2e4, 8e3, 1.5e4, 4e3, 3e4, 1e4];
    let mut counts = [0; 2];
    for seed in 0..sets as u64 {
        let mut noise = Noise::seeded(seed);
        let estimates = deviations.map(|own| (mean + spread * noise.normal() + own * noise.normal(), own));
        let found = random_effects(&estimates, 0.95).unwrap();
        let holds = |[low, high]: [f64; 2], truth: f64| usize::from((low..=high).contains(&truth));
        counts[0] += holds(found.interval, mean);
        counts[1] += holds(found.spread_interval, spread);
    }
    println!(
        "of {sets} sets of {} specimens the 95 % intervals hold: mean {}, spread {}",
        deviations.len(),
        counts[0],
        counts[1]
    );
    assert!(counts.iter().all(|count| is_binomial(*count, sets, 0.95)), "{counts:?}");
}
