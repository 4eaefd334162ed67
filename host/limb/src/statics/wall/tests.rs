//! Stiffnesses of a wall beside finite elements of its section, a membrane and a beam.

use fra_model::{Load, Motion};
use nalgebra::{Matrix3, Vector3};
use softlimb_fea::cross_section::{EndLoad, Mesh, Options, Section, Symmetry};

use super::*;

const NEO_HOOKEAN: Material<f64> = Material::NeoHookean { shear_modulus_pa: 0.3e6 };

fn wound(placement: Placement, families: Families, degrees: f64) -> Fiber<f64> {
    let angle_rad = degrees.to_radians();
    Fiber { angle_rad, families, modulus_pa: 2e8, placement, thickness_m: 2e-4, radius_m: 22e-3 }
}

/// Bending stiffness in a frame that turns, rad/m.
fn turning_nm2(actuator: &Actuator<f64>, state: &State<f64>, turn: f64) -> Option<f64> {
    if kinks_m(actuator).count() < 2 {
        turning::<9, 8, 18>(actuator, state, turn)
    } else {
        turning::<11, 10, 22>(actuator, state, turn)
    }
}

fn turning<const S: usize, const I: usize, const N: usize>(
    actuator: &Actuator<f64>,
    state: &State<f64>,
    turn: f64,
) -> Option<f64> {
    let [own, mixed, slopes] = parts::<S, N>(&Wall::<S, N>::new(actuator, state, turn).form());
    let whole = own + (mixed + mixed.transpose()) * turn + slopes * (turn * turn);
    let bend = inside::<S, I>(&whole)?.bend(&whole);
    Some(bend.dot(&(whole * bend)))
}

/// An actuator with up to two windings; it twists where one of them has one family.
fn tube(radii_m: [f64; 2], material: Material<f64>, fibers: &[Fiber<f64>]) -> Actuator<f64> {
    let motion =
        if fibers.iter().any(|fiber| fiber.families == Families::One) { Motion::Twisting } else { Motion::Extension };
    let [inner_radius_m, outer_radius_m] = radii_m;
    let fiber = fibers.first().copied();
    let parameters = ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m: 0.2, material, fiber };
    let actuator = Actuator::new(&parameters).expect("valid");
    fibers.get(1).map_or(actuator, |second| actuator.with_second_fiber(second).expect("valid"))
}

/// Stiffness here and by finite elements of the section, whose frame turns with the wall.
#[track_caller]
fn agrees(fibers: &[Fiber<f64>], material: Material<f64>, pressures_pa: &[f64], within: f64) {
    let actuator = tube([15e-3, 23e-3], material, fibers);
    let parameters = actuator.parameters();
    let options = Options { symmetry: Symmetry::Ignore, mesh: Mesh { radial: 8, around: 8 }, ..Options::default() };
    let section = match actuator.second_fiber() {
        None => Section::new(parameters, &options),
        Some(second) => Section::with_two_windings(parameters, second, &options),
    };
    let section = section.expect("valid");
    let curve = section.curve(pressures_pa, &EndLoad::default()).expect("in range");
    for (pressure_pa, answer) in pressures_pa.iter().zip(&curve.answers) {
        let state = actuator.forward(*pressure_pa, &Load::none()).expect("valid").state;
        let found = turning_nm2(&actuator, &state, state.twist_rad / parameters.length_m).expect("stable");
        let reference = answer.equilibrium().and_then(|found| found.stiffness).expect("an equilibrium").by_strain[1][1];
        println!("{pressure_pa} Pa: {found} beside {reference}, {:.1e}", found / reference - 1.0);
        assert!((found / reference - 1.0).abs() < within, "{pressure_pa} Pa: {found} beside {reference}");
    }
}

#[test]
fn stiffness_of_an_extending_wall_is_that_of_finite_elements() {
    let at = |placement| wound(placement, Families::Two, 4.0);
    agrees(&[at(Placement::Sheet)], NEO_HOOKEAN, &[0.0, 40e3, 120e3], 3e-4);
    // Stiff threads all through the wall bend it in ways that four functions do not have.
    agrees(&[at(Placement::Layer)], NEO_HOOKEAN, &[0.0, 40e3, 120e3], 3e-3);
    agrees(&[at(Placement::Smeared)], NEO_HOOKEAN, &[0.0, 40e3, 120e3], 1e-2);
}

#[test]
fn stiffness_of_an_expanding_and_of_a_bare_wall_is_that_of_finite_elements() {
    agrees(&[wound(Placement::Sheet, Families::Two, 70.0)], NEO_HOOKEAN, &[0.0, 20e3, 40e3], 3e-4);
    agrees(&[], NEO_HOOKEAN, &[0.0, 20e3, 40e3], 3e-4);
}

#[test]
fn stiffness_of_a_stiffening_elastomer_is_that_of_finite_elements() {
    let yeoh = Material::Yeoh { c_pa: [0.1e6, 0.02e6, 0.004e6] };
    agrees(&[wound(Placement::Sheet, Families::Two, 4.0)], yeoh, &[0.0, 40e3, 120e3], 3e-4);
}

#[test]
fn stiffness_of_a_twisting_wall_is_that_of_finite_elements_in_its_frame() {
    for placement in [Placement::Sheet, Placement::Layer] {
        agrees(&[wound(placement, Families::One, 28.0)], NEO_HOOKEAN, &[0.0, 40e3, 100e3], 2e-3);
    }
}

/// Shear stiffness at rest, N.
fn shear_n(inner_radius_m: f64, fibers: &[Fiber<f64>]) -> f64 {
    let actuator = tube([inner_radius_m, 22e-3], NEO_HOOKEAN, fibers);
    bending_and_shear(&actuator, &actuator.rest()).expect("stable").1
}

/// The same of a thin wall over `mu A/2`, by walls of 2 and 4 % of the outer radius.
fn thin_shear(fibers: impl Fn(f64) -> Vec<Fiber<f64>>) -> f64 {
    let of = |share: f64| {
        let inner_m = 22e-3 * (1.0 - share);
        shear_n(inner_m, &fibers(share)) / (0.5 * 0.3e6 * PI * (22e-3_f64.powi(2) - inner_m * inner_m))
    };
    2.0 * of(0.02) - of(0.04)
}

/// Energy of the shear flow `q sin theta` in a thin tube with a stiff helix at the angle `a` from the hoop, of a bend that is prevented.
///
/// With tension `T` along the helix and axial flow `n sin theta` the elastomer has `[n - T s2, -T c2, q - T s c]` along, around and in shear; the energy
/// `(N_z^2 + N_t^2 - N_z N_t + 3 N_zt^2)/(6 mu b)` is least for `T = 4 s q/(c (c2 + 4 s2))` and `n = T (s2 - c2/2)`.
#[test]
fn shear_of_a_thin_wall_with_a_helix_is_that_of_a_membrane() {
    for degrees in [10.0_f64, 28.0, 45.0, 60.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let tension = 4.0 * s / (c * (c * c + 4.0 * s * s));
        let along = tension * (s * s - 0.5 * c * c);
        let [z, t, zt] = [along - tension * s * s, -tension * c * c, 1.0 - tension * s * c];
        let expected = 3.0 / (z * z + t * t - z * t + 3.0 * zt * zt);
        let found = thin_shear(|_| vec![wound(Placement::Sheet, Families::One, degrees)]);
        println!("{degrees} deg: {found} beside {expected}");
        assert!((found / expected - 1.0).abs() < 3e-3, "{degrees} deg: {found} beside {expected}");
    }
}

/// Two windings on one surface and apart in the wall, of different angles, families, moduli and places. The axis of the finite elements is that of the
/// first sheet, so that the outer one comes first.
#[test]
fn stiffness_of_a_wall_with_two_windings_is_that_of_finite_elements_in_its_frame() {
    let at = |placement, families, degrees, radius_m, modulus_pa| Fiber {
        radius_m,
        modulus_pa,
        ..wound(placement, families, degrees)
    };
    let sheet = |families, degrees, radius_m, modulus_pa| at(Placement::Sheet, families, degrees, radius_m, modulus_pa);
    let helix = |radius_m| sheet(Families::One, 28.0, radius_m, 2e8);
    for (outer, inner, within) in [
        (sheet(Families::One, 90.0, 22e-3, 2e8), helix(22e-3), 3e-4),
        (sheet(Families::One, 90.0, 21e-3, 2e8), helix(18e-3), 3e-4),
        (sheet(Families::One, -50.0, 21e-3, 5e7), helix(18e-3), 3e-4),
        (sheet(Families::Two, 10.0, 21e-3, 2e7), helix(18e-3), 1e-3),
        (sheet(Families::One, 90.0, 21e-3, 2e6), sheet(Families::Two, 4.0, 18e-3, 2e8), 1e-3),
        (helix(21e-3), at(Placement::Smeared, Families::Two, 60.0, 20e-3, 2e6), 1e-3),
        (helix(18e-3), at(Placement::Layer, Families::One, 60.0, 20e-3, 2e6), 8e-3),
    ] {
        agrees(&[outer, inner], NEO_HOOKEAN, &[0.0, 40e3, 100e3], within);
        let both = [[outer, inner], [inner, outer]].map(|fibers| {
            let actuator = tube([15e-3, 23e-3], NEO_HOOKEAN, &fibers);
            let state = actuator.forward(60e3, &Load::none()).expect("valid").state;
            bending_and_shear(&actuator, &state).expect("stable")
        });
        let [(a, b), (c, d)] = both;
        assert!((a / c - 1.0).abs() < 1e-9 && (b / d - 1.0).abs() < 1e-9, "{both:?}");
    }
}

/// Helices of opposite hand are two families, and a winding without stiffness is none.
#[test]
fn two_windings_have_the_walls_of_one_in_the_limits() {
    let both = |actuator: &Actuator<f64>, pressure_pa: f64| {
        let state = actuator.forward(pressure_pa, &Load::none()).expect("valid").state;
        let (bending, shear) = bending_and_shear(actuator, &state).expect("stable");
        [bending_nm2(actuator, &state).expect("stable"), bending, shear]
    };
    let radii_m = [15e-3, 23e-3];
    for placement in [Placement::Sheet, Placement::Layer] {
        let one = wound(placement, Families::One, 28.0);
        let pair = [one, Fiber { angle_rad: -one.angle_rad, ..one }];
        let none = [one, Fiber { modulus_pa: 0.0, ..one }];
        for (two, alone) in [(pair, Fiber { families: Families::Two, ..one }), (none, one)] {
            let [two, alone] = [tube(radii_m, NEO_HOOKEAN, &two), tube(radii_m, NEO_HOOKEAN, &[alone])];
            for pressure_pa in [0.0, 20e3, 60e3] {
                let [two, alone] = [&two, &alone].map(|actuator| both(actuator, pressure_pa));
                assert!(
                    two.iter().zip(alone).all(|(two, alone)| (two / alone - 1.0).abs() < 1e-9),
                    "{two:?} {alone:?}"
                );
            }
        }
    }
}

/// As above, of two helices that give way: the least energy over their tensions `N` and the axial flow, with `N^2/2k` a helix, `k = 4 E t`.
#[test]
fn shear_of_a_thin_wall_with_two_helices_is_that_of_a_membrane() {
    for (degrees, moduli_pa) in [([28.0, 90.0], [2e8, 2e8]), ([28.0, -28.0], [1e6, 1e6]), ([20.0, -50.0], [2e6, 5e5])] {
        let helix = |i: usize, share: f64| Fiber {
            modulus_pa: moduli_pa[i] * share,
            ..wound(Placement::Sheet, Families::One, degrees[i])
        };
        // Twice the energy times `3 mu b` is `N_z2 + N_t2 - N_z N_t + 3 N_zt2` and what the helices have, of the flow `n` and the tensions.
        let rows = [0, 1].map(|i: usize| {
            let (s, c) = f64::to_radians(degrees[i]).sin_cos();
            [-s * s, -c * c, -s * c]
        });
        let flow = |axis: usize| Vector3::new(f64::from(axis == 0), rows[0][axis], rows[1][axis]);
        let [z, t, zt] = [0, 1, 2].map(flow);
        let own = z * z.transpose() + t * t.transpose() - (z * t.transpose() + t * z.transpose()) * 0.5
            + zt * zt.transpose() * 3.0;
        let gives = [0, 1].map(|i: usize| 3.0 * 0.3e6 * 22e-3 / (4.0 * moduli_pa[i] * helix(i, 1.0).thickness_m));
        let own = own + Matrix3::from_diagonal(&Vector3::new(0.0, gives[0], gives[1]));
        let least = 3.0 - 9.0 * zt.dot(&own.cholesky().expect("positive").solve(&zt));
        let expected = 3.0 / least;
        let found = thin_shear(|share| vec![helix(0, share), helix(1, share)]);
        println!("{degrees:?} deg: {found} beside {expected}");
        assert!((found / expected - 1.0).abs() < 3e-3, "{degrees:?} deg: {found} beside {expected}");
    }
}

/// Flexure of an incompressible hollow round beam (Saint-Venant): a bend `k Z` has the shears `k (r2 - S + P/r2) cos` outwards and `k (S + P/r2) sin`
/// around, with `S = a2 + b2` and `P = a2 b2`; the moment grows by `3 mu I k`.
#[test]
fn shear_of_a_bare_wall_is_that_of_a_hollow_beam() {
    let outer_m = 22e-3_f64;
    for inner_m in [5e-3_f64, 11e-3, 16e-3, 21e-3] {
        let found = shear_n(inner_m, &[]);
        let (sum, product) = (outer_m.powi(2) + inner_m.powi(2), (outer_m * inner_m).powi(2));
        let part =
            |r: f64| r.powi(6) / 6.0 - 0.5 * sum * r.powi(4) + (sum * sum + product) * r * r - (product / r).powi(2);
        let moment = 0.75 * PI * (outer_m.powi(4) - inner_m.powi(4));
        let expected = 0.3e6 * moment * moment / (PI * (part(outer_m) - part(inner_m)));
        assert!((found / expected - 1.0).abs() < 1e-4, "{inner_m}: {found} beside {expected}");
    }
}
