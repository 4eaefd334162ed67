//! Errors against the size of the elements.

use fra_model::{Actuator, ActuatorParameters, Fiber, Load, Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Limiter, Mesh, Options};

use crate::section::cases::{DRAGON_SKIN, SOFT, at, curve, tube, wound};

fn mesh(radial: usize, around: usize) -> Options {
    Options { mesh: Mesh { radial, around }, ..Options::default() }
}

/// How often three successive differences halve.
fn orders(values: &[f64]) -> Vec<f64> {
    let differences: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    differences.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

/// Quadratic places and linear pressures: the energy, and with it what is conjugate to a load, is of the fourth order.
#[test]
fn a_strip_of_half_a_turn_converges_with_the_fourth_power() {
    let parameters = tube(Motion::Bending, 6.0, 8.0, SOFT);
    let strip = Limiter::Strip { half_angle_rad: std::f64::consts::FRAC_PI_4, stiffness_n_per_m: 1e5 };
    let rates: Vec<f64> = [1, 2, 4, 8]
        .map(|n| {
            let options = Options { limiter: Some(strip), ..mesh(2 * n, 8 * n) };
            at(&parameters, &options, 40e3).state.bend_rates_rad_per_m[0]
        })
        .into();
    let orders = orders(&rates);
    println!("orders {orders:.2?}");
    assert!(orders.iter().all(|order| (3.7..4.4).contains(order)), "{orders:?} of {rates:?}");
}

#[test]
fn bending_by_a_moment_converges_with_the_fourth_power() {
    let mut parameters = wound(tube(Motion::Extension, 6.0, 8.0, DRAGON_SKIN), 5.0, Placement::Sheet, 1000.0, 8.0);
    parameters.fiber = parameters.fiber.map(|fiber| Fiber { modulus_pa: 64e7, ..fiber });
    let load = EndLoad { bending_moments_nm: [0.02, 0.0], ..EndLoad::default() };
    let rates: Vec<f64> = [1, 2, 4, 8]
        .map(|n| {
            let answer = curve(&parameters, &mesh(2 * n, 8 * n), &[40e3], &load).answers[0];
            answer.equilibrium().expect("stable").state.bend_rates_rad_per_m[0]
        })
        .into();
    let orders = orders(&rates);
    println!("orders {orders:.2?}");
    assert!(orders.iter().all(|order| (3.6..4.6).contains(order)), "{orders:?} of {rates:?}");
}

/// Against the exact answer, which is known where the tube stays straight.
#[test]
fn straight_motions_converge_with_the_fourth_power() {
    for parameters in [
        wound(tube(Motion::Twisting, 4.0, 8.0, SOFT), 30.0, Placement::Smeared, 3.0, 4.0),
        wound(tube(Motion::Expansion, 4.0, 8.0, DRAGON_SKIN), 80.0, Placement::Sheet, 300.0, 6.0),
    ] {
        let exact = Actuator::new(&parameters).expect("valid").forward(30e3, &Load::none()).expect("valid").state;
        let errors = [2, 4, 8].map(|radial| {
            let equilibrium = at(&parameters, &mesh(radial, 8), 30e3);
            let error = (equilibrium.state.volume_strain - exact.volume_strain).abs();
            let estimate = equilibrium.error.expect("two meshes").volume_strain;
            assert!((0.5..2.0).contains(&(estimate / error)), "estimated {estimate:e}, found {error:e}");
            error
        });
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        println!("orders {orders:.2?}");
        assert!(orders.iter().all(|order| (3.6..4.5).contains(order)), "{orders:?} of {errors:?}");
    }
}

/// The estimate covers what four times as many elements in each direction change, on the mesh that is used by default.
#[test]
fn the_error_estimate_covers_the_error_of_bends() {
    let bare = tube(Motion::Bending, 6.0, 8.0, SOFT);
    let strip = |half_angle_rad| Some(Limiter::Strip { half_angle_rad, stiffness_n_per_m: 1e5 });
    for (name, parameters, limiter) in [
        ("line", bare, None),
        ("thick wall", tube(Motion::Bending, 4.0, 8.0, DRAGON_SKIN), None),
        ("strip", bare, strip(0.6)),
        ("winding inside, strip", wound(bare, 5.0, Placement::Sheet, 3000.0, 7.0), strip(0.3)),
        ("winding inside, line", wound(bare, 5.0, Placement::Sheet, 3000.0, 7.0), None),
        ("smeared, line", wound(bare, 5.0, Placement::Smeared, 10.0, 6.0), None),
    ] {
        let rate = |radial, around| at(&parameters, &Options { limiter, ..mesh(radial, around) }, 40e3);
        let (usual, fine) = (rate(4, 16), rate(16, 64));
        let value = usual.state.bend_rates_rad_per_m[0];
        let error = (value - fine.state.bend_rates_rad_per_m[0]).abs() / value;
        let estimate = usual.error.expect("two meshes").bend_rates_rad_per_m[0] / value;
        println!("{name}: estimated {estimate:.1e}, found {error:.1e}");
        // Where errors of the two directions cancel in the difference of the meshes, all of them are small.
        assert!(error < f64::max(3.0 * estimate, 1e-5), "{name}: estimated {estimate:e}, found {error:e}");
    }
}

/// Not more than needed: the usual mesh keeps 0.3 %.
#[test]
fn the_usual_mesh_is_fine_enough() {
    let estimate = |parameters: &ActuatorParameters<f64>, pressure| {
        let equilibrium = at(parameters, &Options::default(), pressure);
        equilibrium.error.expect("two meshes").bend_rates_rad_per_m[0] / equilibrium.state.bend_rates_rad_per_m[0]
    };
    let mut worst = 0.0;
    for (inner, outer) in [(6.0, 7.0), (6.0, 8.0), (6.0, 9.0), (4.0, 8.0)] {
        for material in [SOFT, DRAGON_SKIN] {
            for pressure in [1e3, 20e3, 60e3] {
                worst = f64::max(worst, estimate(&tube(Motion::Bending, inner, outer, material), pressure));
            }
        }
    }
    println!("largest estimate with an ideal winding and a line: {worst:.1e}");
    assert!(worst < 3e-3, "{worst}");
}
