//! Table 4: a scene under a load, uncorrected, compensated, with learned corrections.

use std::num::NonZero;

use softlimb_rig::learning::{Settings, under_load};

use crate::weight::repository;

/// The least RMSE in the paper's Table 4, m.
const PAPER_M: f64 = 0.31e-3;

#[test]
fn learning_under_twenty_newtons_is_as_near_as_the_paper_s_best() {
    let runs = NonZero::new(2).unwrap();
    let settings = Settings { limb: 1, noise: 50, iterations: 2, runs, camera_noise_m: 0.0 };
    let found =
        under_load(&repository("loaded/carry-hanging", ""), 20.0, &settings).unwrap_or_else(|error| panic!("{error}"));
    println!("{found:?}");
    assert!((found.time_s - 14.5).abs() < 0.05);
    // Weight is worth centimetres, the spread of the actuators millimetres, noise tenths.
    assert!(found.uncorrected.rmse_m > 20e-3 && found.compensated.rmse_m < 0.5 * found.uncorrected.rmse_m);
    assert!(found.compensated.rmse_m > 1e-3, "three percent of modulus do not vanish by a nominal model");
    assert!(found.corrected.rmse_m <= PAPER_M && found.corrected.repeatability_m <= PAPER_M);
    assert!(found.corrected.max_m >= found.corrected.rmse_m);
}
