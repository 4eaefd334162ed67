//! The linear route against a neo-Hookean tube whose outer radius rigid hoops hold, alone and in bundles, and against differences.
//!
//! With the outer radius `R_o` held and the wall incompressible, `r^2 = R_o^2 - (R_o^2 - R^2)/l` at a stretch `l`, the lumen's volume is
//! `pi (R_o^2 l - R_o^2 + R_i^2)` per length, and `P pi R_o^2 = dU/dl` with `U = int mu/2 (l^2 + (r/R)^2 + (R/(l r))^2 - 3) 2 pi R dR`.

use softlimb_limb::fabricate::Tolerances;
use softlimb_limb::statics::Tangent;
use softlimb_limb::tolerance::{Kind, Linear, Settings, Study, Varied, linear};

use crate::tolerance::{limb_of, pose, settings};

const INNER_M: f64 = 10e-3;
const LENGTH_M: f64 = 0.24;
const RIGID_M: f64 = 0.02;
const DISTANCE_M: f64 = 0.03;

/// Pressure at a stretch over the shear modulus, by Simpson's rule.
fn pressure_per_modulus(stretch: f64, outer_m: f64) -> f64 {
    let (l, square) = (stretch, outer_m * outer_m);
    let density_slope = |reference_m: f64| {
        let rest = reference_m * reference_m;
        let now = square - (square - rest) / l;
        let now_slope = (square - rest) / (l * l);
        // d/dl of l^2 + r^2/R^2 + R^2/(l^2 r^2)
        2.0 * l + now_slope / rest - rest * (2.0 / (l * l * l * now) + now_slope / (l * l * now * now))
    };
    let (count, step) = (400, (outer_m - INNER_M) / 400.0);
    let term = |k: usize| {
        let reference_m = INNER_M + step * k as f64;
        let weight = if k == 0 || k == count { 1.0 } else { [2.0, 4.0][k % 2] };
        weight * 0.5 * density_slope(reference_m) * 2.0 * reference_m
    };
    (0..=count).map(term).sum::<f64>() * step / 3.0 / square
}

/// The stretch at a pressure, by halving.
fn stretch(pressure_pa: f64, modulus_pa: f64, wall_m: f64) -> f64 {
    let (mut low, mut high) = (1.0, 1.8);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        let below = pressure_per_modulus(middle, INNER_M + wall_m) * modulus_pa < pressure_pa;
        (low, high) = if below { (middle, high) } else { (low, middle) };
    }
    low
}

/// Changes of the stretch per half-width of wall and modulus.
fn changes(pressure_pa: f64, wall_m: f64, modulus: f64) -> [f64; 2] {
    let h = 1e-4;
    let by = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
    [
        by(&|x| stretch(pressure_pa, 0.2e6, 4e-3 + wall_m * x)),
        by(&|x| stretch(pressure_pa, 0.2e6 * (1.0 + modulus * x), 4e-3)),
    ]
}

fn only(found: &[Linear]) -> &Linear {
    assert_eq!(found.len(), 1);
    &found[0]
}

#[test]
fn one_extending_actuator_is_the_closed_form() {
    let limb = limb_of(&[("extension", "hoops", 1, "")]);
    for kpa in [5.0, 30.0, 60.0] {
        let poses = pose(&[kpa]);
        let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
        let nominal = stretch(kpa * 1e3, 0.2e6, 4e-3);
        assert!((study.nominal_tip_m(0).z - (LENGTH_M * nominal + RIGID_M)).abs() < 2e-6 * LENGTH_M);
        let found = linear(&study).expect("derivatives");
        let [wall, modulus] = changes(kpa * 1e3, 1e-4, 0.1).map(|by| (LENGTH_M * by).powi(2) / 3.0);
        for (kind, expected) in [(Kind::Wall, wall), (Kind::Modulus, modulus), (Kind::Angle, 0.0)] {
            let share = only(&found).mean_square_of_m2(Varied::Kind(kind));
            assert!((share - expected).abs() < 2e-5 * (wall + modulus), "{kpa} {kind:?}: {share} {expected}");
        }
        let rms = only(&found).mean_square_m2();
        assert!((rms / (wall + modulus) - 1.0).abs() < 2e-5, "{kpa}: {rms} {}", wall + modulus);
    }
}

/// Three tubes at 120 degrees: lengthened by their mean, and bent by `sum k x dl/(sum k x^2 + 3 EI)`, with the springs of the statics, which
/// finite elements of the section hold.
#[test]
fn three_extending_actuators_also_bend_their_bundle() {
    let limb = limb_of(&[("extension", "hoops", 3, "")]);
    let kpa = 40.0;
    let poses = pose(&[kpa]);
    let by_stretch: f64 = changes(kpa * 1e3, 1e-4, 0.1).iter().map(|by| by * by / 3.0).sum();
    let l = stretch(kpa * 1e3, 0.2e6, 4e-3);
    let tube = Tangent::of(&limb.modules()[0].actuator, kpa * 1e3).expect("an equilibrium");
    let gyration = tube.bending_nm2 / tube.axial_n;
    let square = 1.5 * DISTANCE_M * DISTANCE_M;
    // Both bends have this variance, per length at rest.
    let bend = by_stretch * square / (square + 3.0 * gyration).powi(2);
    let sideways = 2.0 * bend * (LENGTH_M * (0.5 * LENGTH_M * l + RIGID_M)).powi(2);
    let expected = LENGTH_M * LENGTH_M * by_stretch / 3.0 + sideways;
    let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
    let found = only(&linear(&study).expect("derivatives")).mean_square_m2();
    assert!((found / expected - 1.0).abs() < 2e-5, "{found} {expected}");
    // With one modulus for all three the bundle does not bend by it, and lengthens as one tube does.
    let tolerances = Tolerances { wall_m: 0.0, ..settings(0.0, 1.0, 10.0).tolerances };
    let study = Study::new(&limb, &poses, Settings { tolerances, shared_modulus: true }).expect("a study");
    let found = only(&linear(&study).expect("derivatives")).mean_square_m2();
    let expected = (LENGTH_M * changes(kpa * 1e3, 0.0, 0.1)[1]).powi(2) / 3.0;
    assert!((found / expected - 1.0).abs() < 2e-5, "{found} {expected}");
}

/// Every kind moves the tip of a limb of all motions as fast as samples of tiny tolerances say, and shares add up to the whole.
#[test]
fn shares_of_independent_parameters_add_up() {
    let limb = limb_of(&[("extension", "slant", 3, ""), ("twisting", "helix", 3, ""), ("bending", "", 2, "")]);
    let poses = pose(&[30.0, 20.0, 40.0]);
    let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
    let found = linear(&study).expect("derivatives");
    let all = only(&found).mean_square_m2();
    let sum = |few: &[Varied]| few.iter().map(|varied| only(&found).mean_square_of_m2(*varied)).sum::<f64>() / all;
    let (kinds, modules) = (Kind::ALL.map(Varied::Kind), [0, 1, 2].map(Varied::Module));
    assert!((sum(&kinds) - 1.0).abs() < 1e-12 && (sum(&modules) - 1.0).abs() < 1e-12);
    // Half of all widths: a quarter of the mean square.
    let half = Study::new(&limb, &poses, settings(0.05, 0.5, 5.0)).expect("a study");
    let halved = only(&linear(&half).expect("derivatives")).mean_square_m2();
    assert!((4.0 * halved / all - 1.0).abs() < 1e-12);
}
