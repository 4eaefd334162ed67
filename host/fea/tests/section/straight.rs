//! Extension, expansion and twisting: the thick-wall equations are exact, and `fra_model` solves them by other means.

use fra_model::{Actuator, ActuatorParameters, Load, Motion, Placement, State, Status};
use softlimb_fea::cross_section::{EndLoad, Options, Symmetry};

use crate::section::cases::{DRAGON_SKIN, SOFT, curve, tube, wound};

const PRESSURES_KPA: [f64; 6] = [4.0, 8.0, 12.0, 16.0, 20.0, 24.0];

/// Every motion, placement and law at two sizes.
fn actuators() -> Vec<ActuatorParameters<f64>> {
    let mut all = Vec::new();
    for (inner, outer) in [(6.0, 8.0), (4.0, 7.0)] {
        for material in [SOFT, DRAGON_SKIN] {
            for (motion, angle) in [(Motion::Extension, 5.0), (Motion::Expansion, 80.0), (Motion::Twisting, 30.0)] {
                let tube = tube(motion, inner, outer, material);
                let middle = 0.5 * (inner + outer);
                all.push(wound(tube, angle, Placement::Sheet, 1000.0, outer));
                all.push(wound(tube, angle, Placement::Sheet, 300.0, middle));
                all.push(wound(tube, angle, Placement::Layer, 20.0, outer - 0.4));
                all.push(wound(tube, angle, Placement::Smeared, 3.0, inner));
            }
        }
    }
    all
}

/// Stretch, growth, turn of the outer surface and half of the change of the volume, as strains.
pub(crate) fn motion(state: &State<f64>, outer_radius_m: f64) -> [f64; 4] {
    let growth = state.outer_radius_m / outer_radius_m - 1.0;
    [state.axial_strain, growth, outer_radius_m / 0.1 * state.twist_rad, 0.5 * state.volume_strain]
}

pub(crate) fn largest(values: [f64; 4]) -> f64 {
    values.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()))
}

/// The largest deviation of these strains, relative to the largest of them.
pub(crate) fn deviation(found: &State<f64>, exact: &State<f64>, outer_radius_m: f64) -> f64 {
    let [found, exact] = [found, exact].map(|state| motion(state, outer_radius_m));
    largest(std::array::from_fn(|i| found[i] - exact[i])) / largest(exact)
}

/// Compares at every pressure; returns the worst deviation and how many equilibria there were.
fn compare(parameters: &ActuatorParameters<f64>, load: &Load<f64>) -> (f64, usize) {
    let pressures: Vec<f64> = PRESSURES_KPA.iter().map(|pressure| pressure * 1e3).collect();
    let found = curve(parameters, &Options::default(), &pressures, &EndLoad::of(load, parameters.motion));
    let actuator = Actuator::new(parameters).expect("valid");
    let (mut worst, mut count) = (0.0, 0);
    for answer in &found.answers {
        let exact = actuator.forward(answer.pressure_pa, load).expect("valid");
        assert_eq!(
            answer.equilibrium().is_some(),
            exact.status == Status::Solved,
            "{parameters:?} {answer:?} {exact:?}"
        );
        if let Some(equilibrium) = answer.equilibrium() {
            let state = equilibrium.state.over(parameters.length_m);
            worst = f64::max(worst, deviation(&state, &exact.state, parameters.outer_radius_m));
            let compliance = state.compliance_m3_per_pa / exact.state.compliance_m3_per_pa - 1.0;
            assert!(compliance.abs() < 1e-4, "{parameters:?} {}: compliance {compliance:e}", answer.pressure_pa);
            count += 1;
        }
    }
    (worst, count)
}

#[test]
fn straight_motions_are_those_of_the_thick_wall_equations() {
    let (mut worst, mut count) = (0.0, 0);
    for parameters in actuators() {
        let (deviation, equilibria) = compare(&parameters, &Load::none());
        assert!(deviation < 1e-5, "{parameters:?}: {deviation:e}");
        worst = f64::max(worst, deviation);
        count += equilibria;
    }
    println!("largest deviation of {count} equilibria relative to the motion: {worst:.1e}");
    assert!(count > 250, "only {count} equilibria were compared");
}

#[test]
fn end_force_and_torque_act_as_in_the_thick_wall_equations() {
    let mut worst = 0.0;
    for (motion, angle) in [(Motion::Extension, 5.0), (Motion::Expansion, 70.0), (Motion::Twisting, 30.0)] {
        for material in [SOFT, DRAGON_SKIN] {
            let parameters = wound(tube(motion, 6.0, 8.0, material), angle, Placement::Sheet, 1000.0, 8.0);
            for load in [
                Load { force_n: 2.0, torque_nm: 0.0 },
                Load { force_n: 0.0, torque_nm: 5e-3 },
                Load { force_n: 1.0, torque_nm: -4e-3 },
            ] {
                let (deviation, equilibria) = compare(&parameters, &load);
                assert!(deviation < 1e-5, "{parameters:?} {load:?}: {deviation:e}");
                assert!(equilibria > 3, "{parameters:?} {load:?}");
                worst = f64::max(worst, deviation);
            }
        }
    }
    println!("largest deviation under load: {worst:.1e}");
}

#[test]
fn whole_section_moves_as_its_wedge() {
    let parameters = wound(tube(Motion::Twisting, 6.0, 8.0, DRAGON_SKIN), 30.0, Placement::Sheet, 1000.0, 7.5);
    let load = EndLoad { torque_nm: 2e-3, force_n: 1.0, ..EndLoad::default() };
    let ring = Options { symmetry: Symmetry::Ignore, ..Options::default() };
    let [wedge, whole] = [Options::default(), ring].map(|options| {
        let curve = curve(&parameters, &options, &[20e3], &load);
        curve.answers[0].equilibrium().expect("far from any limit").state
    });
    assert!((whole.axial_strain / wedge.axial_strain - 1.0).abs() < 1e-4, "{whole:?} {wedge:?}");
    assert!((whole.twist_rate_rad_per_m / wedge.twist_rate_rad_per_m - 1.0).abs() < 1e-4, "{whole:?} {wedge:?}");
    let bend = whole.bend_rates_rad_per_m.map(f64::abs);
    assert!(bend[0].max(bend[1]) < 1e-6, "{bend:?}");
}
