//! Stiffnesses of a wall beside finite elements of its section, a membrane and a beam.

use fra_model::{Actuator, Load, Motion};
use softlimb_fea::cross_section::{EndLoad, Mesh, Options, Section, Symmetry};

use super::*;

const NEO_HOOKEAN: Material<f64> = Material::NeoHookean { shear_modulus_pa: 0.3e6 };

fn wound(placement: Placement, families: Families, degrees: f64) -> Fiber<f64> {
    let angle_rad = degrees.to_radians();
    Fiber { angle_rad, families, modulus_pa: 2e8, placement, thickness_m: 2e-4, radius_m: 22e-3 }
}

/// Bending stiffness in a frame that turns, rad/m.
fn turning_nm2(parameters: &ActuatorParameters<f64>, state: &State<f64>, turn: f64) -> Option<f64> {
    let [own, mixed, slopes] = parts(&Wall::<SLOPES>::new(parameters, state, turn).form());
    let whole = own + (mixed + mixed.transpose()) * turn + slopes * (turn * turn);
    let bend = inside(&whole)?.bend(&whole);
    Some(bend.dot(&(whole * bend)))
}

/// Stiffness here and by finite elements of the section, whose frame turns with the wall.
#[track_caller]
fn agrees(fiber: Option<Fiber<f64>>, material: Material<f64>, pressures_pa: &[f64], within: f64) {
    let motion =
        if fiber.is_some_and(|fiber| fiber.families == Families::One) { Motion::Twisting } else { Motion::Extension };
    let parameters =
        ActuatorParameters { motion, inner_radius_m: 15e-3, outer_radius_m: 23e-3, length_m: 0.2, material, fiber };
    let actuator = Actuator::new(&parameters).expect("valid");
    let options = Options { symmetry: Symmetry::Ignore, mesh: Mesh { radial: 8, around: 8 }, ..Options::default() };
    let section = Section::new(&parameters, &options).expect("valid");
    let curve = section.curve(pressures_pa, &EndLoad::default()).expect("in range");
    for (pressure_pa, answer) in pressures_pa.iter().zip(&curve.answers) {
        let state = actuator.forward(*pressure_pa, &Load::none()).expect("valid").state;
        let found = turning_nm2(&parameters, &state, state.twist_rad / parameters.length_m).expect("stable");
        let reference = answer.equilibrium().and_then(|found| found.stiffness).expect("an equilibrium").by_strain[1][1];
        assert!((found / reference - 1.0).abs() < within, "{pressure_pa} Pa: {found} beside {reference}");
    }
}

#[test]
fn stiffness_of_an_extending_wall_is_that_of_finite_elements() {
    let at = |placement| Some(wound(placement, Families::Two, 4.0));
    agrees(at(Placement::Sheet), NEO_HOOKEAN, &[0.0, 40e3, 120e3], 3e-4);
    // Stiff threads all through the wall bend it in ways that four functions do not have.
    agrees(at(Placement::Layer), NEO_HOOKEAN, &[0.0, 40e3, 120e3], 3e-3);
    agrees(at(Placement::Smeared), NEO_HOOKEAN, &[0.0, 40e3, 120e3], 1e-2);
}

#[test]
fn stiffness_of_an_expanding_and_of_a_bare_wall_is_that_of_finite_elements() {
    agrees(Some(wound(Placement::Sheet, Families::Two, 70.0)), NEO_HOOKEAN, &[0.0, 20e3, 40e3], 3e-4);
    agrees(None, NEO_HOOKEAN, &[0.0, 20e3, 40e3], 3e-4);
}

#[test]
fn stiffness_of_a_stiffening_elastomer_is_that_of_finite_elements() {
    let yeoh = Material::Yeoh { c_pa: [0.1e6, 0.02e6, 0.004e6] };
    agrees(Some(wound(Placement::Sheet, Families::Two, 4.0)), yeoh, &[0.0, 40e3, 120e3], 3e-4);
}

#[test]
fn stiffness_of_a_twisting_wall_is_that_of_finite_elements_in_its_frame() {
    for placement in [Placement::Sheet, Placement::Layer] {
        agrees(Some(wound(placement, Families::One, 28.0)), NEO_HOOKEAN, &[0.0, 40e3, 100e3], 2e-3);
    }
}

fn at_rest(motion: Motion, inner_radius_m: f64, fiber: Option<Fiber<f64>>) -> (ActuatorParameters<f64>, State<f64>) {
    let outer_radius_m = 22e-3;
    let parameters =
        ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m: 0.2, material: NEO_HOOKEAN, fiber };
    (parameters, Actuator::new(&parameters).expect("valid").rest())
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
        // Over `mu A/2`, of two walls, and of none.
        let of = |share: f64| {
            let inner_m = 22e-3 * (1.0 - share);
            let fiber = wound(Placement::Sheet, Families::One, degrees);
            let (parameters, state) = at_rest(Motion::Twisting, inner_m, Some(fiber));
            let half_n = 0.5 * 0.3e6 * PI * (22e-3_f64.powi(2) - inner_m * inner_m);
            bending_and_shear(&parameters, &state).expect("stable").1 / half_n
        };
        let found = 2.0 * of(0.02) - of(0.04);
        println!("{degrees} deg: {found} beside {expected}");
        assert!((found / expected - 1.0).abs() < 3e-3, "{degrees} deg: {found} beside {expected}");
    }
}

/// Flexure of an incompressible hollow round beam (Saint-Venant): a bend `k Z` has the shears `k (r2 - S + P/r2) cos` outwards and `k (S + P/r2) sin`
/// around, with `S = a2 + b2` and `P = a2 b2`; the moment grows by `3 mu I k`.
#[test]
fn shear_of_a_bare_wall_is_that_of_a_hollow_beam() {
    let outer_m = 22e-3_f64;
    for inner_m in [5e-3_f64, 11e-3, 16e-3, 21e-3] {
        let (parameters, state) = at_rest(Motion::Extension, inner_m, None);
        let found = bending_and_shear(&parameters, &state).expect("stable").1;
        let (sum, product) = (outer_m.powi(2) + inner_m.powi(2), (outer_m * inner_m).powi(2));
        let part =
            |r: f64| r.powi(6) / 6.0 - 0.5 * sum * r.powi(4) + (sum * sum + product) * r * r - (product / r).powi(2);
        let moment = 0.75 * PI * (outer_m.powi(4) - inner_m.powi(4));
        let expected = 0.3e6 * moment * moment / (PI * (part(outer_m) - part(inner_m)));
        assert!((found / expected - 1.0).abs() < 1e-4, "{inner_m}: {found} beside {expected}");
    }
}
