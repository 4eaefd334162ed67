//! Limbs made by seed: repeatable, as the linear route has them where tolerances are small, and not where they are not.

use softlimb_limb::tolerance::{Kind, Settings, Statistics, Study, ToleranceError, Varied, linear, picture, sample};

use crate::tolerance::{limb_of, pose, settings};

fn statistics(modules: &[(&str, &str, u8, &str)], kpa: &[f64], settings: Settings, count: usize) -> Statistics {
    let limb = limb_of(modules);
    let poses = pose(kpa);
    let study = Study::new(&limb, &poses, settings).expect("a study");
    let found = linear(&study).expect("derivatives");
    Statistics::new(&found, &sample(&study, &found, count, 1, 2), modules.len())
}

const ALL_MOTIONS: [(&str, &str, u8, &str); 4] = [
    ("extension", "slant", 3, "material = \"other\""),
    ("twisting", "helix", 3, "mount_angle = \"40 deg\""),
    ("bending", "", 2, "mount_angle = \"-70 deg\""),
    ("extension", "slant", 2, ""),
];
const PRESSURES_KPA: [f64; 4] = [30.0, 20.0, 40.0, 35.0];

/// The model of each limb against its derivatives: what they leave out falls with the square of the tolerances.
#[test]
fn small_tolerances_move_the_tip_as_its_derivatives_say() {
    for shared_modulus in [false, true] {
        let off = |scale: f64| {
            let settings = Settings { shared_modulus, ..settings(0.1 * scale, 1.0 * scale, 10.0 * scale) };
            let found = statistics(&ALL_MOTIONS, &PRESSURES_KPA, settings, 40);
            let found = &found.poses[0];
            assert_eq!((found.answered, found.lost_in_all()), (40, 0));
            found.departure()
        };
        let [coarse, fine] = [0.02, 0.01].map(off);
        assert!(coarse < 5e-3 && (coarse / fine - 2.0).abs() < 0.1, "{coarse} {fine}");
    }
}

/// Two equal windings are one of twice the stiffness: the derivatives of that one are exact, those of two are differences.
#[test]
fn two_equal_windings_move_the_tip_as_one_of_twice_the_stiffness() {
    for modules in [
        [("extension", "slant slant", 3, ""), ("extension", "double", 3, "")],
        [("extension", "slant slant", 1, ""), ("extension", "double", 1, "")],
    ] {
        let [two, one] = modules.map(|module| {
            let limb = limb_of(&[module]);
            let poses = pose(&[45.0]);
            let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
            let found = linear(&study).expect("derivatives");
            let sampled = sample(&study, &found, 10, 1, 1);
            let tips = sampled.iter().map(|limb| limb[0].displacement_m.expect("an equilibrium"));
            (
                Varied::all(1).into_iter().map(|varied| found[0].mean_square_of_m2(varied)).collect::<Vec<_>>(),
                Vec::from_iter(tips),
            )
        });
        for (two, one) in two.0.iter().zip(&one.0) {
            assert!((two / one - 1.0).abs() < 1e-5, "{two} {one}");
        }
        for (two, one) in two.1.iter().zip(&one.1) {
            assert!((two - one).norm() < 1e-8, "{two} {one}");
        }
    }
}

/// A helix and an axial thread: the model of each limb against its derivatives, as above.
#[test]
fn small_tolerances_of_two_windings_move_the_tip_as_its_derivatives_say() {
    for actuators in [1, 3] {
        let modules = [("twisting", "helix lines", actuators, ""), ("extension", "slant", 3, "")];
        let off = |scale: f64| {
            let found = statistics(&modules, &[30.0, 30.0], settings(0.1 * scale, scale, 10.0 * scale), 40);
            let found = &found.poses[0];
            assert_eq!((found.answered, found.lost_in_all()), (40, 0));
            found.departure()
        };
        let [coarse, fine] = [0.02, 0.01].map(off);
        assert!(coarse < 5e-3 && (coarse / fine - 2.0).abs() < 0.1, "{actuators}: {coarse} {fine}");
    }
}

/// RMS and shares of many limbs within four standard errors of the linear route.
#[test]
fn figures_of_samples_are_those_of_the_linear_route_within_their_errors() {
    for shared_modulus in [false, true] {
        let settings = Settings { shared_modulus, ..settings(0.01, 0.1, 1.0) };
        let found = statistics(&ALL_MOTIONS, &PRESSURES_KPA, settings, 1500);
        let found = &found.poses[0];
        assert!(found.linear_is_enough());
        assert!((found.rms_m.value - found.linear_rms_m).abs() < 4.0 * found.rms_m.error, "{found:?}");
        assert!(found.rms_m.error < 0.03 * found.rms_m.value);
        assert_eq!(found.shares.len(), Kind::ALL.len() + ALL_MOTIONS.len());
        for share in &found.shares {
            let off = (share.sampled.value - share.linear).abs();
            assert!(off < 4.0 * share.sampled.error + 2e-3 * share.linear, "{share:?}");
            assert!(share.sampled.error > 0.0 && share.sampled.error < 0.1);
        }
        // Three standard errors of a mean of numbers with this RMS.
        assert!(found.mean_m.norm() < 3.0 * found.rms_m.value / 1500_f64.sqrt() + found.departure_m);
        assert!(found.max_m >= found.p95_m[1] && found.p95_m[1] > found.rms_m.value);
    }
}

#[test]
fn limbs_depend_on_their_seed_and_number_alone() {
    let limb = limb_of(&ALL_MOTIONS);
    let poses = pose(&PRESSURES_KPA);
    let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
    let found = linear(&study).expect("derivatives");
    let one = sample(&study, &found, 23, 7, 1);
    for threads in [2, 3, 50] {
        assert_eq!(one, sample(&study, &found, 23, 7, threads));
    }
    assert_eq!(one[..5], sample(&study, &found, 5, 7, 2));
    assert_ne!(one[..5], sample(&study, &found, 5, 8, 2));
    assert!(sample(&study, &found, 0, 7, 2).is_empty());
    let svg = picture("limb", &study, &one);
    assert!(svg.contains("pose") && !svg.contains("NaN"));
}

/// One kind switched off leaves the others as they were drawn.
#[test]
fn exact_tips_stay() {
    let found = statistics(&ALL_MOTIONS, &PRESSURES_KPA, settings(0.0, 0.0, 0.0), 12);
    let found = &found.poses[0];
    assert_eq!((found.rms_m.value, found.linear_rms_m, found.max_m, found.departure()), (0.0, 0.0, 0.0, 0.0));
    assert!(found.shares.is_empty() && found.linear_is_enough());
    let at_rest = statistics(&ALL_MOTIONS, &[0.0; 4], settings(0.1, 1.0, 10.0), 12);
    assert!(at_rest.poses[0].max_m < 1e-12 && at_rest.poses[0].linear_rms_m < 1e-12, "{at_rest:?}");
    let [both, walls] = [10.0, 0.0].map(|modulus| {
        let found = statistics(&ALL_MOTIONS, &PRESSURES_KPA, settings(0.1, 0.0, modulus), 12);
        let share =
            found.poses[0].shares.iter().find(|share| share.varied == Varied::Kind(Kind::Wall)).expect("a share");
        share.sampled.value * found.poses[0].rms_m.value.powi(2)
    });
    assert!((both / walls - 1.0).abs() < 1e-12);
}

/// A bending actuator has no fiber angle in the model, and two families along the axis are the same on both sides of it: the linear
/// route knows nothing of that angle, the samples do.
#[test]
fn where_a_derivative_vanishes_the_linear_route_is_not_enough() {
    let found = statistics(&[("bending", "", 3, "")], &[40.0], settings(0.0, 1.0, 0.0), 12);
    assert_eq!((found.poses[0].max_m, found.poses[0].linear_rms_m), (0.0, 0.0));
    let found = statistics(&[("expansion", "lines", 1, "")], &[12.0], settings(0.0, 3.0, 0.0), 50);
    let found = &found.poses[0];
    assert!(found.linear_rms_m < 1e-9 && found.rms_m.value > 1e-6, "{found:?}");
    assert!(!found.linear_is_enough() && (found.departure() - 1.0).abs() < 1e-3);
}

/// An expanding actuator just below its limit point: thinner and softer ones are beyond theirs.
#[test]
fn limbs_without_an_answer_are_counted_where_they_end() {
    let modules = [("extension", "slant", 1, ""), ("expansion", "lines", 1, "")];
    let limb = limb_of(&modules);
    let limit_pa = limb.modules()[1].curve.pressure_max_pa() / 0.98;
    let kpa = [20.0, 0.99e-3 * limit_pa];
    let found = statistics(&modules, &kpa, settings(0.1, 1.0, 10.0), 200);
    let found = &found.poses[0];
    assert_eq!((found.lost[0], found.answered + found.lost[1]), (0, 200));
    assert!(found.lost[1] > 50 && found.answered > 50 && !found.linear_is_enough(), "{found:?}");
    let poses = pose(&[20.0, 1.01e-3 * limit_pa]);
    let error = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect_err("beyond the limit point");
    assert!(matches!(&error, ToleranceError::Nominal { module, .. } if module == "m1"), "{error}");
}

#[test]
fn tolerances_out_of_range_are_named() {
    let limb = limb_of(&ALL_MOTIONS);
    let poses = pose(&PRESSURES_KPA);
    for (settings, words) in [
        (settings(-0.1, 1.0, 10.0), ["wall_m", "-0.0001", "0 to 0.005"]),
        (settings(4.0, 1.0, 10.0), ["wall_m", "0.004", "less than the wall of `m0`, 0.004"]),
        (settings(0.1, 11.0, 10.0), ["angle_rad", "0.19", "10 degrees"]),
        (settings(0.1, f64::NAN, 10.0), ["angle_rad", "NaN", "10 degrees"]),
        (settings(0.1, 1.0, 60.0), ["modulus", "0.6", "0 to 0.5"]),
    ] {
        let text = Study::new(&limb, &poses, settings).expect_err("out of range").to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
}
