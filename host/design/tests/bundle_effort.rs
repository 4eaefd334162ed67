//! The effort of a bundle: conditions of its minimum by differences of the forward model, and symmetry.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb_design::bundle::{Answer, Budget, ForceProblem, search};

/// Actuators of one geometry on the axis, held at 0.24 m.
fn problem(weights: &str, count: usize, force_n: f64) -> ForceProblem {
    let actuators = vec![r#"{"name": "one", "radius_m": [0, 0], "azimuth_deg": [0, 0]}"#; count].join(", ");
    let text = format!(
        r#"{{"format": 1, "shared_geometry": true, "weights": {{"force_per_n": 1, "torque_per_nm": 0{weights}}},
  "material": {{"law": "neo-hookean", "shear_modulus_pa": 2e5}},
  "fiber": {{"families": 2, "modulus_pa": 3.61e8, "thickness_m": 0.000178}},
  "bounds": {{"inner_radius_m": [0.009, 0.009], "wall_m": [0.004, 0.004], "length_m": [0.22, 0.22], "angle_deg": [5, 5],
             "pressure_max_pa": 120000}},
  "actuators": [{actuators}],
  "samples": [{{"force_n": [0, 0, {force_n}], "held_length_m": 0.24}}]}}"#
    );
    ForceProblem::read(&text).expect("a problem")
}

fn solved(problem: &ForceProblem) -> Answer {
    search(problem, &Budget { starts: 3, ..Budget::default() }).expect("an answer")
}

/// Push of one actuator, N.
fn push_n(pressure_pa: f64) -> f64 {
    let fiber = Fiber {
        angle_rad: 5.0_f64.to_radians(),
        families: Families::Two,
        modulus_pa: 3.61e8,
        placement: Placement::Sheet,
        thickness_m: 0.000178,
        radius_m: 0.013,
    };
    let parameters = ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m: 0.009,
        outer_radius_m: 0.013,
        length_m: 0.22,
        material: Material::NeoHookean { shear_modulus_pa: 2e5 },
        fiber: Some(fiber),
    };
    let actuator = Actuator::new(&parameters).expect("an actuator");
    -actuator.blocked(pressure_pa, 0.24 / 0.22, 0.0).expect("a force").force_n
}

#[test]
fn effort_of_one_actuator_trades_force_for_pressure() {
    // The derivative of (F(P) - F*)^2 + e (P/P_ref)^2 is zero: (F - F*) dF/dP + e P/P_ref^2 = 0.
    for (effort, reference_pa) in [(5.0, 120e3), (50.0, 120e3), (5.0, 30e3)] {
        let weights = format!(r#", "effort": {effort}, "reference_pressure_pa": {reference_pa}"#);
        let answer = solved(&problem(&weights, 1, 8.0));
        let pressure_pa = answer.actuators[0].pressures_pa[0];
        let slope = (push_n(pressure_pa + 10.0) - push_n(pressure_pa - 10.0)) / 20.0;
        let pull = (push_n(pressure_pa) - 8.0) * slope;
        let other = effort * pressure_pa / (reference_pa * reference_pa);
        assert!((pull + other).abs() < 1e-5 * other, "effort {effort}: {pull:e} {other:e}");
        let objective = (push_n(pressure_pa) - 8.0).powi(2) + effort * (pressure_pa / reference_pa).powi(2);
        assert!((answer.objective / objective - 1.0).abs() < 1e-9, "{} {objective}", answer.objective);
    }
}

#[test]
fn effort_shares_a_force_among_equal_actuators() {
    // Without it any sum of pushes serves; with it, by symmetry, equal pressures do.
    let apart = |weights: &str, start: u64| {
        let found = search(&problem(weights, 3, 20.0), &Budget { seed: start, starts: 2, ..Budget::default() });
        let pressures: Vec<f64> = found.expect("an answer").actuators.iter().map(|one| one.pressures_pa[0]).collect();
        pressures.iter().fold(0.0, |most: f64, one| most.max((one - pressures[0]).abs()))
    };
    for seed in 1..4 {
        assert!(apart(r#", "effort": 1"#, seed) < 1.0, "seed {seed}");
    }
}
