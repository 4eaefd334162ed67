//! Problems that are degenerate, contradictory or at the end of what the model can do.

use fra_model::{Actuator, Load};
use softlimb_design::actuators::{Answer, Budget, Geometry, Problem, solve};

use crate::design::common::{extension, objective};

fn answered(text: &str) -> (Problem, Answer) {
    let problem = Problem::read(text).unwrap_or_else(|error| panic!("{error}"));
    let answer = solve(&problem, &Budget::default()).expect("an answer");
    (problem, answer)
}

#[test]
fn goal_that_is_the_start_needs_no_pressure() {
    let text = extension(&[("[0.2, 0.21]", "[0.2, 0.2]"), ("[0.1, 0.3]", "[0.2, 0.2]")]);
    let (_, answer) = answered(&text);
    assert_eq!((answer.objective, answer.status), (0.0, "reached"));
    for phase in &answer.segments[0].phases {
        assert_eq!((phase.pressure_pa, phase.bound), (0.0, Some("rest")));
    }
    assert!(answer.segments[0].active_bounds.contains(&"length_m min".to_owned()));
}

#[test]
fn goals_that_contradict_each_other_are_balanced() {
    // A geometry that is given but for its length: the longest length and the rest length pull with their weights. With stretch `s` at the
    // highest pressure the optimum of w1 (L - a)^2 + w2 (s L - b)^2 is L = (w1 a + w2 s b)/(w1 + w2 s^2).
    let text = extension(&[
        ("[0.2, 0.21]", "[0.15, 0.3]"),
        ("\"targets\"", "\"target_weights\": [1, 3], \"targets\""),
        ("[0.006, 0.010]", "[0.008, 0.008]"),
        ("[0.003, 0.005]", "[0.004, 0.004]"),
        ("[0, 15]", "[3, 3]"),
    ]);
    let (problem, answer) = answered(&text);
    let geometry =
        Geometry { inner_radius_m: 0.008, outer_radius_m: 0.012, length_m: 0.2, angle_rad: 3f64.to_radians() };
    let actuator = Actuator::new(&problem.segments()[0].parameters(&geometry)).expect("an actuator");
    let s = actuator.forward(60e3, &Load::none()).expect("finite").state.axial_stretch;
    let length = (0.15 + 3.0 * s * 0.3) / (1.0 + 3.0 * s * s);
    let least = 1e6 * ((length - 0.15).powi(2) + 3.0 * (s * length - 0.3).powi(2));
    let found = answer.segments[0].length_m;
    assert!((found / length - 1.0).abs() < 1e-6, "{found} and {length}");
    assert!((answer.objective / least - 1.0).abs() < 1e-8, "{} and {least}", answer.objective);
    let bounds: Vec<_> = answer.segments[0].phases.iter().map(|phase| phase.bound).collect();
    assert_eq!(bounds, [Some("rest"), Some("pressure_max_pa")]);
}

/// An expanding tube with axial fibers, whose limit point is far below the highest pressure.
const EXPANSION: &str = r#"{
  "format": 1,
  "weights": {"outer_radius_per_m2": 1e6},
  "segments": [{
    "name": "grip", "motion": "expansion",
    "material": {"law": "neo-hookean", "shear_modulus_pa": 222600},
    "fiber": {"families": 2, "modulus_pa": 3.61e8, "thickness_m": 0.000178},
    "bounds": {"inner_radius_m": [0.006, 0.006], "wall_m": [0.002, 0.0024], "length_m": [0.1, 0.1], "angle_deg": [90, 90],
               "pressure_max_pa": 100000, "limit_margin": 0.1},
    "targets": {"outer_radius_m": [0.009, 0.015]}
  }]
}"#;

#[test]
fn limit_point_within_the_pressure_range_is_kept_away_from() {
    let (problem, answer) = answered(EXPANSION);
    let segment = &answer.segments[0];
    assert_eq!(segment.phases[1].bound, Some("limit_margin"));
    let at = |wall_m: f64| {
        let geometry = Geometry {
            inner_radius_m: 0.006,
            outer_radius_m: 0.006 + wall_m,
            length_m: 0.1,
            angle_rad: segment.angle_deg.to_radians(),
        };
        let actuator = Actuator::new(&problem.segments()[0].parameters(&geometry)).expect("an actuator");
        let limit = actuator.forward(1e5, &Load::none()).expect("finite").limit_pressure_pa.expect("a limit point");
        let radius = |p: f64| actuator.forward(p, &Load::none()).expect("finite").state.outer_radius_m;
        (0.9 * limit, radius(0.9 * limit), 0.006 + wall_m)
    };
    let (cap, ..) = at(segment.wall_m);
    assert!((segment.phases[1].pressure_pa / cap - 1.0).abs() < 1e-9);
    assert!((segment.pressure_cap_pa / cap - 1.0).abs() < 1e-9);
    // By a scan of the wall, the one variable: clipped at rest and at the margin to the limit.
    let least = (0..=400).map(|i| {
        let (_, widest, rest) = at(0.002 + 0.0004 * f64::from(i) / 400.0);
        let short = |value: f64| (rest - value).max(value - widest).max(0.0);
        1e6 * (short(0.009).powi(2) + short(0.015).powi(2))
    });
    let least = least.fold(f64::INFINITY, f64::min);
    assert!(answer.objective <= least * (1.0 + 1e-9), "{} and {least}", answer.objective);
}

#[test]
fn terms_without_weight_and_phases_without_goal_change_nothing() {
    let plain = answered(&extension(&[("[0.2, 0.21]", "[0.11, 0.45]")])).1;
    let more = extension(&[
        ("[0.2, 0.21]", "[0.11, 7.0, 0.45, null]"),
        ("\"targets\"", "\"target_weights\": [1, 0, 1, 1], \"targets\""),
    ]);
    let more = answered(&more).1;
    assert!(plain.objective > 1.0);
    assert!((more.objective / plain.objective - 1.0).abs() < 1e-8);
    assert_eq!(more.segments[0].phases[1].term, 0.0);
    assert_eq!((more.segments[0].phases[3].target, more.segments[0].phases[3].pressure_pa), (None, 0.0));
    let nothing = answered(&extension(&[("1e6", "0")])).1;
    assert_eq!((nothing.objective, nothing.status), (0.0, "reached"));
}

#[test]
fn phase_that_is_there_twice_counts_twice() {
    let twice = answered(&extension(&[("[0.2, 0.21]", "[0.11, 0.45, 0.45]")])).1;
    let weighed =
        extension(&[("[0.2, 0.21]", "[0.11, 0.45]"), ("\"targets\"", "\"target_weights\": [1, 2], \"targets\"")]);
    let weighed = answered(&weighed).1;
    assert!((twice.objective / weighed.objective - 1.0).abs() < 1e-8);
    let [a, b] = [1, 2].map(|phase| twice.segments[0].phases[phase]);
    assert_eq!(a, b);
}

#[test]
fn fiber_angles_of_both_signs_twist_both_ways() {
    // One family at a positive angle twists to the negative side: both goals want their own sign, the farther one wins.
    let text = extension(&[
        ("extension", "twisting"),
        ("length_per_m2", "twist_per_rad2"),
        ("\"families\": 2", "\"families\": 1"),
        ("[0, 15]", "[-40, 40]"),
        ("\"length_m\": [0.2, 0.21]", "\"twist_rad\": [0.3, -0.2]"),
    ]);
    let (problem, answer) = answered(&text);
    assert!(answer.segments[0].angle_deg < 0.0);
    // What is left is the goal on the other side, from rest.
    assert!((answer.objective - 1e6 * 0.04).abs() < 1e-3, "{}", answer.objective);
    assert!((objective(&problem, &answer) - answer.objective).abs() < 1e-6);
}

#[test]
fn layer_as_thick_as_the_wall_is_a_smeared_winding() {
    let with = |fiber: &str| {
        let text = extension(&[
            ("[0.2, 0.21]", "[0.11, 0.45]"),
            ("[0.003, 0.005]", "[0.004, 0.004]"),
            ("3.61e8", "3.61e6"),
            ("0.000178", fiber),
        ]);
        answered(&text).1
    };
    let [layer, smeared] = ["0.004, \"placement\": \"layer\"", "0.004, \"placement\": \"smeared\""].map(with);
    assert!(layer.objective > 1.0);
    assert!((layer.objective / smeared.objective - 1.0).abs() < 1e-10, "{} {}", layer.objective, smeared.objective);
    let [a, b] = [&layer, &smeared].map(|answer| answer.segments[0].inner_radius_m);
    assert!((a - b).abs() < 1e-9, "{a} {b}");
    // A layer half as thick holds half as much: less stiff, so that it reaches farther.
    let thin = with("0.002, \"placement\": \"layer\"");
    assert!(thin.objective < layer.objective);
}
