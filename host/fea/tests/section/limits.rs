//! Ends of branches, and fibers however stiff.

use fra_model::{Actuator, Load, Material, Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Limiter, Options, Outcome, Symmetry};

use crate::section::cases::{DRAGON_SKIN, SOFT, at, curve, tube, wound};

/// `fra_model` finds the limit point as the zero of the slope along the branch, here it is where steps end.
#[test]
fn no_pressure_beyond_the_limit_has_an_answer() {
    for (parameters, about) in [
        (tube(Motion::Expansion, 6.0, 8.0, SOFT), Some(43.1e3)),
        (tube(Motion::Expansion, 6.0, 8.0, DRAGON_SKIN), None),
        (wound(tube(Motion::Expansion, 6.0, 8.0, SOFT), 89.0, Placement::Sheet, 1000.0, 7.0), None),
    ] {
        let exact = Actuator::new(&parameters).expect("valid").forward(150e3, &Load::none()).expect("valid");
        let limit = exact.limit_pressure_pa.expect("the tube has a limit");
        if let Some(about) = about {
            assert!((limit / about - 1.0).abs() < 1e-3, "{limit}");
        }
        let pressures = [0.5 * limit, 0.99 * limit, 1.002 * limit, 2.0 * limit];
        let answers = curve(&parameters, &Options::default(), &pressures, &EndLoad::default()).answers;
        assert!(answers[..2].iter().all(|answer| answer.equilibrium().is_some()), "{answers:?}");
        for answer in &answers[2..] {
            let Outcome::NoEquilibrium { limit_pressure_pa } = answer.outcome else { panic!("{answer:?}") };
            assert!((limit_pressure_pa / limit - 1.0).abs() < 1e-6, "{limit_pressure_pa} {limit}");
        }
    }
}

/// Asked for at once, without pressures on the way, what lies beyond the limit is not mistaken for something else.
#[test]
fn pressure_far_beyond_the_limit_is_not_jumped_to() {
    let parameters = tube(Motion::Expansion, 6.0, 8.0, SOFT);
    for pressure in [60e3, 90e3, 400e3] {
        let answer = curve(&parameters, &Options::default(), &[pressure], &EndLoad::default()).answers[0];
        let Outcome::NoEquilibrium { limit_pressure_pa } = answer.outcome else { panic!("{answer:?}") };
        assert!((limit_pressure_pa / 43.1e3 - 1.0).abs() < 2e-3, "{limit_pressure_pa}");
    }
}

/// Two stable branches overlap between 25.196 and 26.122 kPa; the answer is the one that begins without pressure.
#[test]
fn of_two_stable_branches_the_first_answers() {
    let parameters = wound(tube(Motion::Expansion, 6.0, 8.0, SOFT), 75.0, Placement::Smeared, 0.5, 6.0);
    let scale = parameters.material.shear_modulus_pa();
    let actuator = Actuator::new(&parameters).expect("valid");
    let limit = actuator.forward(scale, &Load::none()).expect("valid").limit_pressure_pa.expect("N-shaped");
    let answers =
        curve(&parameters, &Options::default(), &[0.97 * limit, 0.999 * limit, 1.01 * limit], &EndLoad::default());
    for answer in &answers.answers[..2] {
        let exact = actuator.forward(answer.pressure_pa, &Load::none()).expect("valid").state;
        let found = answer.equilibrium().expect("before the limit").state;
        assert!((found.volume_strain / exact.volume_strain - 1.0).abs() < 1e-5, "{found:?} {exact:?}");
    }
    assert!(matches!(answers.answers[2].outcome, Outcome::NoEquilibrium { .. }), "{answers:?}");
}

/// Pulled without pressure, a bare tube is in uniaxial tension, whose greatest nominal stress `2 (l - l^-2) W'(I1)` of a law that softens is
/// a closed form: below it the tube carries the load, beyond it none.
#[test]
fn a_load_that_is_not_carried_is_said_so() {
    let parameters = tube(Motion::Extension, 6.0, 8.0, DRAGON_SKIN);
    let Material::Yeoh { c_pa: [c1, c2, c3] } = DRAGON_SKIN else { unreachable!("a Yeoh law") };
    let nominal = |l: f64| {
        let j = l * l + 2.0 / l - 3.0;
        2.0 * (l - l.powi(-2)) * (c1 + 2.0 * c2 * j + 3.0 * c3 * j * j)
    };
    let greatest = (0..40_000).map(|i| nominal(1.0 + 1e-4 * f64::from(i))).fold(0.0, f64::max);
    let area = std::f64::consts::PI * (8e-3f64.powi(2) - 6e-3f64.powi(2));
    let pulled = |share: f64| {
        let load = EndLoad { force_n: share * greatest * area, ..EndLoad::default() };
        curve(&parameters, &Options::default(), &[0.0], &load).answers[0].outcome
    };
    let Outcome::Equilibrium(carried) = pulled(0.99) else { panic!("{:?}", pulled(0.99)) };
    assert!((nominal(carried.state.axial_stretch) / (0.99 * greatest) - 1.0).abs() < 1e-6, "{carried:?}");
    for share in [1.01, 1.5, 20.0] {
        assert_eq!(pulled(share), Outcome::LoadNotCarried, "{share}");
    }
}

/// Pulled without pressure, a tube would shrink, and a stiff hoop winding is compressed. A surface that cannot bend folds then, at the
/// shortest wave there is: the whole section shows it in its eigenvalues, although Newton's method finds the round state.
#[test]
fn compressed_winding_folds() {
    let parameters = wound(tube(Motion::Extension, 6.0, 8.0, SOFT), 0.0, Placement::Sheet, 1e4, 8.0);
    let pulled = |symmetry, pressure, force_n| {
        let options = Options { symmetry, ..Options::default() };
        let load = EndLoad { force_n, ..EndLoad::default() };
        curve(&parameters, &options, &[pressure], &load).answers[0].outcome
    };
    assert!(matches!(pulled(Symmetry::Exploit, 0.0, 3.0), Outcome::Equilibrium(_)));
    assert_eq!(pulled(Symmetry::Ignore, 0.0, 3.0), Outcome::LoadNotCarried);
    // Not where the pressure keeps the winding in tension.
    assert!(matches!(pulled(Symmetry::Ignore, 20e3, 0.0), Outcome::Equilibrium(_)));
}

/// `mu2 t` up to 1e6 times what the wall has, from zero load.
#[test]
fn stiff_fiber_surfaces_take_few_steps() {
    let mut most = (0, 0);
    for ratio in [1.0, 1e2, 1e4, 1e6] {
        // The sheet is 0.1 mm thick, the wall 2 mm: stiffness ratio * mu1 * wall.
        let modulus = 20.0 * ratio;
        for (motion, angle) in
            [(Motion::Extension, 5.0), (Motion::Expansion, 80.0), (Motion::Twisting, 30.0), (Motion::Bending, 5.0)]
        {
            let parameters = wound(tube(motion, 6.0, 8.0, SOFT), angle, Placement::Sheet, modulus, 8.0);
            for pressures in [&[30e3][..], &[5e3, 10e3, 15e3, 20e3, 25e3, 30e3]] {
                let curve = curve(&parameters, &Options::default(), pressures, &EndLoad::default());
                assert!(
                    curve.answers.iter().all(|answer| answer.equilibrium().is_some()),
                    "{motion:?} {ratio}: {curve:?}"
                );
                for effort in [curve.effort, curve.coarse_effort] {
                    let steps = effort.increments + effort.rejected;
                    assert!(steps <= 20, "{motion:?} {ratio}: {effort:?}");
                    most = (most.0.max(steps), most.1.max(effort.newton_iterations));
                }
            }
        }
    }
    println!("at most {} steps and {} iterations for a curve on one of its two meshes", most.0, most.1);
}

/// Inextensible fibers: `lambda^2 s^2 + (r_f/R_f)^2 c^2 = 1`, whatever the wall.
#[test]
fn stiff_families_keep_their_length() {
    for (motion, angle) in [(Motion::Extension, 15.0f64), (Motion::Expansion, 60.0)] {
        let parameters = wound(tube(motion, 6.0, 8.0, DRAGON_SKIN), angle, Placement::Sheet, 1e8, 8.0);
        let state = at(&parameters, &Options::default(), 25e3).state;
        let (sin, cos) = angle.to_radians().sin_cos();
        let length = (sin * state.axial_stretch).powi(2) + (cos * state.outer_radius_m / 8e-3).powi(2);
        assert!((length - 1.0).abs() < 1e-6, "{length}");
    }
}

/// A line is as good as inextensible: its stretch from the strains of the axis, the outer surface being a circle of the winding.
#[test]
fn line_keeps_its_length() {
    let parameters = tube(Motion::Bending, 6.0, 8.0, SOFT);
    let line = Options { limiter: Some(Limiter::Line), ..Options::default() };
    let state = at(&parameters, &line, 40e3).state;
    // The section is not quite round: the deviation is that of its shape, not of the line.
    let stretch = state.axial_stretch - state.bend_rates_rad_per_m[0] * 8e-3;
    assert!((stretch - 1.0).abs() < 1e-3, "{stretch}");
}
