//! Bundles of unlike actuators, eq. (18): closed forms, differences, symmetry, and bundles that are found again.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb_design::bundle::{ActuatorAnswer, Budget, ForceProblem, Forces, search};
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::LeastSquares;

/// A bundle with the actuators and samples given.
fn text(actuators: &str, samples: &str) -> String {
    format!(
        r#"{{"format": 1, "weights": {{"force_per_n": 1, "torque_per_nm": 20}},
  "material": {{"law": "neo-hookean", "shear_modulus_pa": 2e5}},
  "fiber": {{"families": 2, "modulus_pa": 3.61e8, "thickness_m": 0.000178}},
  "bounds": {{"inner_radius_m": [0.006, 0.012], "wall_m": [0.003, 0.006], "length_m": [0.2, 0.24], "angle_deg": [0, 30],
             "pressure_max_pa": 120000}},
  "actuators": [{actuators}],
  "samples": [{samples}]}}"#
    )
}

fn problem(actuators: &str, samples: &str) -> ForceProblem {
    ForceProblem::read(&text(actuators, samples)).unwrap_or_else(|error| panic!("{error}"))
}

const SAMPLES: &str = r#"{"force_n": [0, 0, 20], "held_length_m": 0.24}, {"force_n": [1, 0, 9], "torque_nm": [0, 0.1, 0], "held_length_m": 0.22}"#;

/// One of each placement, place, hand and material.
const UNLIKE: &str = r#"
  {"name": "sheet within", "x_m": [-0.04, 0.01], "y_m": [-0.03, 0.03], "slope_x": [-0.2, 0.2],
   "fiber": {"families": 2, "modulus_pa": 1e8, "thickness_m": 0.0002, "wall_share": 0.4}},
  {"name": "sheet inside", "x_m": [0.02, 0.04], "y_m": [-0.03, 0.03],
   "fiber": {"families": 1, "modulus_pa": 1e8, "thickness_m": 0.0002, "wall_share": 0, "mirrored": true},
   "bounds": {"angle_deg": [-20, 20], "pressure_max_pa": 60000}},
  {"name": "layer", "radius_m": [0.02, 0.04], "azimuth_deg": [80, 160], "height_m": [-0.01, 0.02],
   "fiber": {"families": 1, "modulus_pa": 2e7, "thickness_m": 0.001, "placement": "layer"},
   "bounds": {"wall_m": [0.002, 0.004], "inner_radius_m": [0.004, 0.008]}},
  {"name": "smeared", "radius_m": [0, 0.03], "azimuth_deg": [200, 250], "slope_y": [-0.1, 0.3],
   "fiber": {"families": 2, "modulus_pa": 1e7, "placement": "smeared"},
   "material": {"law": "yeoh", "c_pa": [86560, 13805, -1466]}, "bounds": {"length_m": [0.15, 0.2]}},
  {"name": "common", "radius_m": [0.02, 0.03], "azimuth_deg": [300, 350]}"#;

#[test]
fn derivatives_of_all_numbers_are_those_of_differences() {
    let problem = problem(UNLIKE, SAMPLES);
    let mut forces = Forces::new(&problem);
    let mut random = Random::new(3, 0);
    for _ in 0..3 {
        let place: Vec<f64> = random.point(forces.width()).iter().map(|x| 0.1 + 0.8 * x).collect();
        let here = forces.evaluate(&place).expect("forces");
        let jacobian = forces.jacobian(&here).expect("derivatives");
        let size = jacobian.iter().flatten().fold(0.0_f64, |most, slope| most.max(slope.abs()));
        for axis in 0..forces.width() {
            let mut at = |by: f64| {
                let mut there = place.clone();
                there[axis] += by;
                let point = forces.evaluate(&there).expect("forces");
                forces.residuals(&point)
            };
            let (below, above) = (at(-1e-5), at(1e-5));
            for row in 0..jacobian.len() {
                let slope = (above[row] - below[row]) / 2e-5;
                let error = (slope - jacobian[row][axis]).abs();
                assert!(error < 1e-7 * size, "axis {axis}, row {row}: {slope} {}", jacobian[row][axis]);
            }
        }
    }
}

#[test]
fn push_of_stiff_thread_is_that_of_its_radius_in_the_wall() {
    // dF/dP = pi R_f^2 (1 - 2 tan^2 a) and dM/dP = -2 pi R_f^3 tan a of inextensible threads at rest; two families have no moment.
    let bounds =
        r#""inner_radius_m": [0.006, 0.006], "wall_m": [0.004, 0.004], "length_m": [0.2, 0.2], "pressure_max_pa": 100"#;
    for (share, angle_deg) in [(0.0_f64, 10.0_f64), (0.25, 25.0), (0.5, 40.0), (1.0, 30.0)] {
        for (families, mirrored) in [(2, false), (1, false), (1, true)] {
            let one = format!(
                r#"{{"name": "one", "x_m": [0.03, 0.03], "y_m": [-0.02, -0.02],
                "fiber": {{"families": {families}, "modulus_pa": 1e13, "thickness_m": 0.0002, "wall_share": {share}, "mirrored": {mirrored}}},
                "bounds": {{{bounds}, "angle_deg": [{angle_deg}, {angle_deg}]}}}}"#
            );
            let problem = problem(&one, r#"{"force_n": [0, 0, 0]}"#);
            let mut forces = Forces::new(&problem);
            assert_eq!(forces.width(), 1, "the pressure alone is free");
            let wrench = forces.evaluate(&[1.0]).expect("forces").wrenches[0];
            let (radius, tangent) = (0.006 + share * 0.004, angle_deg.to_radians().tan());
            let push = 100.0 * std::f64::consts::PI * radius.powi(2) * (1.0 - 2.0 * tangent.powi(2));
            let hand = if mirrored { -1.0 } else { 1.0 };
            let twist = -2.0 * 100.0 * std::f64::consts::PI * radius.powi(3) * tangent * hand;
            let twist = if families == 2 { 0.0 } else { twist };
            // A point at (0.03, -0.02) m: moments -0.02 F about x and -0.03 F about y.
            let expected = [0.0, 0.0, push, -0.02 * push, -0.03 * push, twist];
            for row in 0..6 {
                let size = if row < 3 { 100.0 * radius.powi(2) } else { 100.0 * radius.powi(3) };
                assert!(
                    (wrench[row] - expected[row]).abs() < 1e-3 * size,
                    "{share} {families} {row}: {wrench} {expected:?}"
                );
            }
        }
    }
}

#[test]
fn opposite_hands_push_without_a_moment() {
    // A one-family tube and its mirror image beside it: by symmetry equal pressures push along the axis, and their moments cancel.
    let wound = |mirrored: bool| {
        format!(r#""fiber": {{"families": 1, "modulus_pa": 3.61e8, "thickness_m": 0.000178, "mirrored": {mirrored}}}"#)
    };
    let pair = |second: bool| {
        format!(
            r#"{{"name": "left", "x_m": [-0.03, -0.03], "y_m": [0, 0], {}}}, {{"name": "right", "x_m": [0.03, 0.03], "y_m": [0, 0], {}}}"#,
            wound(false),
            wound(second)
        )
    };
    let sample = r#"{"force_n": [0, 0, 25], "held_length_m": 0.24}"#;
    let with = |second: bool| {
        let fixed = text(&pair(second), sample)
            .replace("[0.006, 0.012]", "[0.01, 0.01]")
            .replace("[0.003, 0.006]", "[0.004, 0.004]")
            .replace("[0.2, 0.24]", "[0.22, 0.22]")
            .replace("[0, 30]", "[20, 20]");
        search(&ForceProblem::read(&fixed).expect("a problem"), &Budget::default()).expect("an answer")
    };
    let answer = with(true);
    assert!(answer.objective < 1e-12, "{}", answer.objective);
    let pressures: Vec<f64> = answer.actuators.iter().map(|one| one.pressures_pa[0]).collect();
    assert!((pressures[0] / pressures[1] - 1.0).abs() < 1e-6, "{pressures:?}");
    assert_eq!(answer.actuators.iter().map(|one| one.angle_deg.round()).collect::<Vec<_>>(), [20.0, -20.0]);
    assert!(with(false).objective > 1e-3, "two of one hand turn");
}

/// Force along the axis and moment about it on the connector, by the model's public face.
fn load(one: &ActuatorAnswer, fiber: Fiber<f64>, material: Material<f64>, length_m: f64, sample: usize) -> [f64; 2] {
    let parameters = ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m: one.inner_radius_m,
        outer_radius_m: one.outer_radius_m,
        length_m: one.length_m,
        material,
        fiber: Some(Fiber { angle_rad: one.angle_deg.to_radians(), ..fiber }),
    };
    let actuator = Actuator::new(&parameters).expect("an actuator");
    let held = actuator.blocked(one.pressures_pa[sample], length_m / one.length_m, 0.0).expect("forces");
    [-held.force_n, -held.torque_nm]
}

#[test]
fn hidden_bundles_are_found_and_do_what_is_printed() {
    for seed in 0..5 {
        let mut problem = problem(UNLIKE, SAMPLES);
        let hidden = {
            let mut forces = Forces::new(&problem);
            let mut random = Random::new(seed, 1);
            let place: Vec<f64> = random.point(forces.width()).iter().map(|x| 0.1 + 0.8 * x).collect();
            forces.evaluate(&place).expect("forces").wrenches
        };
        problem.samples.iter_mut().zip(&hidden).for_each(|(sample, wrench)| sample.wrench = (*wrench).into());
        let answer = search(&problem, &Budget::default()).expect("an answer");
        assert!(answer.objective <= 1e-18, "seed {seed}: {:e}", answer.objective);
        for (index, length_m) in [0.24, 0.22].into_iter().enumerate() {
            let mut sum = [0.0; 6];
            for one in &answer.actuators {
                let (inner, outer) = (one.inner_radius_m, one.outer_radius_m);
                let fiber = |families, modulus_pa, placement, radius_m| Fiber {
                    angle_rad: 0.0,
                    families,
                    modulus_pa,
                    placement,
                    thickness_m: 0.0002,
                    radius_m,
                };
                let rubber = Material::NeoHookean { shear_modulus_pa: 2e5 };
                let yeoh = Material::Yeoh { c_pa: [86560.0, 13805.0, -1466.0] };
                let (fiber, material) = match one.name.as_str() {
                    "sheet within" => {
                        (fiber(Families::Two, 1e8, Placement::Sheet, inner + 0.4 * (outer - inner)), rubber)
                    }
                    "sheet inside" => (fiber(Families::One, 1e8, Placement::Sheet, inner), rubber),
                    "layer" => (fiber(Families::One, 2e7, Placement::Layer, outer - 0.001), rubber),
                    "smeared" => (fiber(Families::Two, 1e7, Placement::Smeared, outer), yeoh),
                    _ => {
                        let common = fiber(Families::Two, 3.61e8, Placement::Sheet, outer);
                        (Fiber { thickness_m: 0.000178, ..common }, rubber)
                    }
                };
                let [force, moment] = load(one, fiber, material, length_m, index);
                let (d, a) = (one.point_m, one.axis);
                let arm = [d[1] * a[2] - d[2] * a[1], d[2] * a[0] - d[0] * a[2], d[0] * a[1] - d[1] * a[0]];
                for axis in 0..3 {
                    sum[axis] += force * a[axis];
                    sum[3 + axis] += force * arm[axis] + moment * a[axis];
                }
            }
            for row in 0..6 {
                assert!((sum[row] - hidden[index][row]).abs() < 1e-8, "seed {seed}, sample {index}, row {row}");
            }
        }
        let within = |name: &str, x: [f64; 2], y: [f64; 2]| {
            let one = answer.actuators.iter().find(|one| one.name == name).expect("an actuator");
            (x[0]..=x[1]).contains(&one.point_m[0]) && (y[0]..=y[1]).contains(&one.point_m[1])
        };
        assert!(
            within("sheet within", [-0.04, 0.01], [-0.03, 0.03]) && within("sheet inside", [0.02, 0.04], [-0.03, 0.03])
        );
    }
}

#[test]
fn place_by_coordinates_is_that_by_radius_and_azimuth() {
    let polar = r#"{"name": "one", "radius_m": [0.05, 0.05], "azimuth_deg": [30, 30]}"#;
    let cartesian = format!(r#"{{"name": "one", "x_m": [{0}, {0}], "y_m": [0.025, 0.025]}}"#, 0.05 * 0.75_f64.sqrt());
    let [one, other] = [polar, &cartesian].map(|actuators| {
        let problem = problem(actuators, SAMPLES);
        let mut forces = Forces::new(&problem);
        let place = vec![0.6; forces.width()];
        forces.evaluate(&place).expect("forces").wrenches
    });
    for (one, other) in one.iter().zip(&other) {
        assert!((one - other).norm() < 1e-12 * one.norm(), "{one} {other}");
    }
}
