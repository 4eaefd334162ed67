//! Bending: the model of `fra_model`, which is a bound on this one, figures of an independent program, symmetries.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Limiter, Mesh, Options, Symmetry, Winding};

use crate::section::cases::{DRAGON_SKIN, SOFT, at, curve, tube, wound};

/// Share by which the section bends more than the isochoric trial field, for an ideal winding on the outside.
fn beyond_the_trial_field(parameters: &ActuatorParameters<f64>, pressure_pa: f64) -> f64 {
    let equilibrium = at(parameters, &Options::default(), pressure_pa);
    let rate = equilibrium.state.bend_rates_rad_per_m[0];
    let trial = Actuator::new(parameters).expect("valid").forward(pressure_pa, &Load::none()).expect("valid");
    let error = equilibrium.error.expect("far from any limit").bend_rates_rad_per_m[0];
    assert!(error < 3e-3 * rate, "the estimate of {parameters:?} at {pressure_pa} is {error} of {rate}");
    rate * parameters.length_m / trial.state.bend_angle_rad - 1.0
}

/// The trial field is an admissible one: in the limit of small loads, where the volume is linear in the bend, it is too stiff for certain.
/// An independent program found the section to bend 0.6 to 1.4 % more where `R_o/R_i` is 4/3, 1.3 to 2.7 % where it is 3/2.
#[test]
fn the_trial_field_is_too_stiff_by_what_is_known() {
    for (inner, outer, least, most, pressures_kpa) in [
        (6.0, 8.0, 0.006, 0.014, [0.01, 16.0, 20.0, 30.0, 40.0]),
        (4.0, 6.0, 0.013, 0.027, [0.01, 20.0, 30.0, 40.0, 50.0]),
    ] {
        let parameters = tube(Motion::Bending, inner, outer, SOFT);
        let shares = pressures_kpa.map(|pressure| beyond_the_trial_field(&parameters, 1e3 * pressure));
        println!("{inner}/{outer}: {:.2?} %", shares.map(|share| 1e2 * share));
        assert!(shares[0] > 0.0, "{shares:?}");
        assert!(shares[1..].iter().all(|share| (least..most).contains(share)), "{inner}/{outer}: {shares:?}");
    }
}

/// Over all pressures and laws: the thinner the wall and the tighter the bend, the more the section flattens, which bends it less.
#[test]
fn the_trial_field_is_near_whatever_the_law() {
    for (inner, outer, most) in [(6.0, 7.0, 0.008), (6.0, 8.0, 0.018), (4.0, 6.0, 0.035)] {
        for material in [SOFT, DRAGON_SKIN] {
            let parameters = tube(Motion::Bending, inner, outer, material);
            let shares = [0.01e3, 5e3, 20e3, 40e3].map(|pressure| beyond_the_trial_field(&parameters, pressure));
            println!("{inner}/{outer}: {:.2?} %", shares.map(|share| 1e2 * share));
            assert!(
                shares[0] > 0.0 && shares.iter().all(|share| share.abs() < most),
                "{inner}/{outer} {material:?}: {shares:?}"
            );
        }
    }
}

/// Threads of 772 N at 3 mm on 8 mm, half a millimetre of cover, a strip of 30 degrees: 7.35 rad/m by an independent program.
#[test]
fn a_crosswise_winding_under_a_cover_with_a_strip_bends_as_another_program_says() {
    let mut parameters = wound(tube(Motion::Bending, 6.0, 8.5, SOFT), 5.0, Placement::Sheet, 1.0, 8.0);
    parameters.fiber = parameters.fiber.map(|fiber| Fiber { modulus_pa: 64e3 / fiber.thickness_m, ..fiber });
    let strip = Limiter::Strip { half_angle_rad: 15f64.to_radians(), stiffness_n_per_m: 1e5 };
    let rate =
        at(&parameters, &Options { limiter: Some(strip), ..Options::default() }, 40e3).state.bend_rates_rad_per_m[0];
    assert!((rate / 7.35 - 1.0).abs() < 2e-3, "{rate}");
}

/// Families of 5 degrees in the outer 0.4 mm, 1000 times the shear modulus, and a line: 9.548 rad/m by the same program on a coarser mesh.
#[test]
fn a_layer_with_a_line_bends_as_another_program_says() {
    let parameters = wound(tube(Motion::Bending, 6.0, 8.0, SOFT), 5.0, Placement::Layer, 1000.0, 7.6);
    let rate = at(&parameters, &Options::default(), 40e3).state.bend_rates_rad_per_m[0];
    println!("{rate}");
    assert!((rate / 9.548 - 1.0).abs() < 3e-3, "{rate}");
}

#[test]
fn stiff_strip_comes_to_be_the_line() {
    let parameters = tube(Motion::Bending, 6.0, 8.0, SOFT);
    let line = at(&parameters, &Options::default(), 30e3).state.bend_rates_rad_per_m[0];
    let mut before = f64::INFINITY;
    for half_angle_deg in [10.0, 5.0, 2.5f64] {
        let strip = Limiter::Strip { half_angle_rad: half_angle_deg.to_radians(), stiffness_n_per_m: 1e9 };
        let options = Options { limiter: Some(strip), ..Options::default() };
        let away = at(&parameters, &options, 30e3).state.bend_rates_rad_per_m[0] / line - 1.0;
        assert!(away.abs() < 0.6 * before, "{half_angle_deg}: {away} after {before}");
        before = away.abs();
    }
    assert!(before < 2e-3, "{before}");
}

#[test]
fn half_a_section_bends_as_the_whole_one() {
    let parameters = wound(tube(Motion::Bending, 6.0, 8.0, DRAGON_SKIN), 5.0, Placement::Sheet, 1000.0, 8.0);
    let ring = Options { symmetry: Symmetry::Ignore, ..Options::default() };
    let load = EndLoad { force_n: 0.5, bending_moments_nm: [5e-3, 0.0], torque_nm: 0.0 };
    let [half, whole] = [Options::default(), ring].map(|options| {
        curve(&parameters, &options, &[30e3], &load).answers[0].equilibrium().expect("far from any limit").state
    });
    assert!((whole.bend_rates_rad_per_m[0] / half.bend_rates_rad_per_m[0] - 1.0).abs() < 1e-9, "{whole:?} {half:?}");
    assert!((whole.axial_strain / half.axial_strain - 1.0).abs() < 1e-9, "{whole:?} {half:?}");
    assert!(whole.bend_rates_rad_per_m[1].abs() < 1e-7 && whole.twist_rate_rad_per_m.abs() < 1e-7, "{whole:?}");
}

/// One family and a line: the tube bends and twists. The mirrored winding twists the other way and bends the same.
#[test]
fn single_family_with_a_line_bends_and_twists() {
    let mut parameters = wound(tube(Motion::Twisting, 6.0, 8.0, SOFT), 20.0, Placement::Sheet, 1000.0, 8.0);
    let options = Options { limiter: Some(Limiter::Line), ..Options::default() };
    let right = at(&parameters, &options, 30e3);
    parameters.fiber = parameters.fiber.map(|fiber| Fiber { angle_rad: -fiber.angle_rad, ..fiber });
    let left = at(&parameters, &options, 30e3);
    assert!(right.state.twist_rate_rad_per_m < -10.0 && right.state.bend_rates_rad_per_m[0] > 4.0, "{right:?}");
    assert!((left.state.twist_rate_rad_per_m / right.state.twist_rate_rad_per_m + 1.0).abs() < 1e-9);
    assert!((left.state.bend_rates_rad_per_m[0] / right.state.bend_rates_rad_per_m[0] - 1.0).abs() < 1e-9);
    assert!(right.error.expect("two meshes").bend_rates_rad_per_m[0] < 3e-3 * right.state.bend_rates_rad_per_m[0]);
}

/// Pure bending of a slender thin-walled tube by a moment: `M = E I kappa` with `E = 3 mu`, small bends.
#[test]
fn small_moment_bends_a_bare_tube_as_a_beam() {
    let parameters = tube(Motion::Extension, 6.0, 8.0, SOFT);
    let load = EndLoad { bending_moments_nm: [1e-6, 0.0], ..EndLoad::default() };
    let bent = curve(&parameters, &Options::default(), &[0.0], &load);
    let rate = bent.answers[0].equilibrium().expect("stable").state.bend_rates_rad_per_m[0];
    let inertia = std::f64::consts::FRAC_PI_4 * (8e-3f64.powi(4) - 6e-3f64.powi(4));
    let beam = 1e-6 / (3.0 * 0.2e6 * inertia);
    assert!((rate / beam - 1.0).abs() < 1e-4, "{rate} {beam}");
}

/// A moment about any direction bends a round tube that way.
#[test]
fn a_round_tube_bends_alike_in_all_directions() {
    let parameters = wound(tube(Motion::Extension, 6.0, 8.0, SOFT), 5.0, Placement::Sheet, 1000.0, 8.0);
    let rates = [0.0f64, 30.0, 90.0, 200.0].map(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let load = EndLoad { bending_moments_nm: [0.01 * cos, 0.01 * sin], ..EndLoad::default() };
        let options = Options { symmetry: Symmetry::Ignore, ..Options::default() };
        let [first, second] = curve(&parameters, &options, &[40e3], &load).answers[0]
            .equilibrium()
            .expect("stable")
            .state
            .bend_rates_rad_per_m;
        // Along the moment, and across it.
        (first * cos + second * sin, second * cos - first * sin)
    });
    for (along, across) in rates {
        assert!((along / rates[0].0 - 1.0).abs() < 1e-5, "{rates:?}");
        assert!((across / along).abs() < 1e-5, "{rates:?}");
    }
}

#[test]
fn ideal_winding_is_the_limit_of_a_stiff_one() {
    let bare = tube(Motion::Bending, 6.0, 8.0, SOFT);
    let ideal = at(&bare, &Options::default(), 40e3).state.bend_rates_rad_per_m[0];
    let hoop = |ratio: f64| {
        let parameters = wound(bare, 0.0, Placement::Sheet, ratio, 8.0);
        at(&parameters, &Options::default(), 40e3).state.bend_rates_rad_per_m[0] / ideal - 1.0
    };
    let (stiff, stiffer) = (hoop(1e4), hoop(1e5));
    assert!((stiff / stiffer - 10.0).abs() < 0.1, "the rest falls as the inverse of the stiffness: {stiff} {stiffer}");
    let stated = wound(bare, 30.0, Placement::Smeared, 1.0, 8.0);
    let options = Options { winding: Winding::Ideal, ..Options::default() };
    assert_eq!(at(&stated, &options, 40e3).state.bend_rates_rad_per_m[0], ideal);
}

/// With a line that keeps its length a force along the axis is a moment, its lever the way from the axis to the line. Both bend about as
/// in the trial field, which balances work about the line.
#[test]
fn force_is_a_moment_about_the_line() {
    let parameters = tube(Motion::Bending, 6.0, 7.0, SOFT);
    let rate = |load: &Load<f64>| {
        let answer = curve(&parameters, &Options::default(), &[20e3], &EndLoad::of(load, Motion::Bending)).answers[0];
        let rate = answer.equilibrium().expect("stable").state.bend_rates_rad_per_m[0];
        let trial = Actuator::new(&parameters).expect("valid").forward(20e3, load).expect("valid");
        let share = rate * 0.1 / trial.state.bend_angle_rad - 1.0;
        assert!(share.abs() < 0.03, "{load:?}: {share}");
        rate
    };
    let bare = rate(&Load::none());
    let (force, moment) =
        (rate(&Load { force_n: 0.5, torque_nm: 0.0 }), rate(&Load { force_n: 0.0, torque_nm: 3.5e-3 }));
    println!("{bare} {force} {moment}");
    assert!(force > 1.1 * bare && (force / moment - 1.0).abs() < 0.01, "{bare} {force} {moment}");
}

/// Two families are needed for a bend in one plane; a single hoop family, which has no sense of twist, also does.
#[test]
fn hoop_family_bends_in_its_plane() {
    let mut parameters = wound(tube(Motion::Bending, 6.0, 8.0, SOFT), 0.0, Placement::Sheet, 1000.0, 8.0);
    let two = at(&parameters, &Options::default(), 40e3).state;
    // Two families along the hoop are one of twice the stiffness.
    parameters.fiber =
        parameters.fiber.map(|fiber| Fiber { families: Families::One, modulus_pa: 2.0 * fiber.modulus_pa, ..fiber });
    let one = at(&parameters, &Options::default(), 40e3).state;
    assert!((one.bend_rates_rad_per_m[0] / two.bend_rates_rad_per_m[0] - 1.0).abs() < 1e-10);
    let coarse = Options { mesh: Mesh { radial: 2, around: 8 }, ..Options::default() };
    let rate = at(&parameters, &coarse, 40e3).state.bend_rates_rad_per_m[0];
    assert!((rate / one.bend_rates_rad_per_m[0] - 1.0).abs() < 1e-3);
}
