//! Table 4: a scene under a load, uncorrected, corrected, taught.

use softlimb_rig::track::{Trial, track};

use crate::weight::repository;

/// The least RMSE in the paper's Table 4, m.
const PAPER_M: f64 = 0.31e-3;

#[test]
fn a_taught_limb_under_twenty_newtons_is_as_near_as_the_paper_s_best() {
    let trial = Trial { load_n: 20.0, repeats: 2, rehearsals: 2, parts: 1, noise: 50 };
    let found = track(&repository("loaded/carry-hanging", ""), &trial).unwrap_or_else(|error| panic!("{error}"));
    println!("{found:?}");
    assert!((found.time_s - 14.5).abs() < 0.05);
    // Weight is worth centimetres, the spread of the actuators millimetres, noise tenths.
    assert!(found.uncorrected.rmse_m > 20e-3 && found.corrected.rmse_m < 0.5 * found.uncorrected.rmse_m);
    assert!(found.corrected.rmse_m > 1e-3, "three percent of modulus do not vanish by a nominal model");
    assert!(found.taught.rmse_m <= PAPER_M && found.taught.repeatability_m <= PAPER_M);
    assert!(found.taught.max_m >= found.taught.rmse_m);
}
