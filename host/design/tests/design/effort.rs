//! The effort of eq. (14): minima against scans of the forward model alone, and one problem solved by both searches.

use fra_model::{Actuator, Load, Status};
use softlimb_design::actuators::{Answer, Budget, Geometry, Problem, SegmentAnswer, solve};

use crate::design::common::objective;

/// A motion with its windings, bounds of the angle and of the pressure, and targets beyond what no pressure does.
struct Case {
    motion: &'static str,
    families: u8,
    angle_deg: [f64; 2],
    pressure_max_pa: f64,
    targets: &'static str,
}

const CASES: [Case; 4] = [
    Case {
        motion: "extension",
        families: 2,
        angle_deg: [0.0, 20.0],
        pressure_max_pa: 80e3,
        targets: "\"length_m\": [0.14, 0.21, 0.24]",
    },
    Case {
        motion: "twisting",
        families: 1,
        angle_deg: [15.0, 45.0],
        pressure_max_pa: 60e3,
        targets: "\"twist_rad\": [-0.2, -1.5, -5]",
    },
    Case {
        motion: "bending",
        families: 0,
        angle_deg: [0.0; 2],
        pressure_max_pa: 60e3,
        targets: "\"bend_angle_rad\": [0.3, 1.2, 4]",
    },
    Case {
        motion: "expansion",
        families: 2,
        angle_deg: [60.0, 90.0],
        pressure_max_pa: 60e3,
        targets: "\"outer_radius_m\": [0.012, 0.02, null]",
    },
];

impl Case {
    fn segment(&self, sizes: [[f64; 2]; 4]) -> String {
        let [inner, wall, length, angle] = sizes.map(|[low, high]| format!("[{low}, {high}]"));
        let wound =
            format!(r#""fiber": {{"families": {}, "modulus_pa": 3.61e8, "thickness_m": 0.000178}}, "#, self.families);
        let (wound, angle) = if self.families == 0 {
            (String::new(), String::new())
        } else {
            (wound, format!(r#""angle_deg": {angle}, "#))
        };
        format!(
            r#"{{"name": "one", "motion": "{}", {wound}"material": {{"law": "neo-hookean", "shear_modulus_pa": 2e5}},
    "bounds": {{"inner_radius_m": {inner}, "wall_m": {wall}, "length_m": {length}, {angle}"pressure_max_pa": {}}},
    "targets": {{{}}}}}"#,
            self.motion, self.pressure_max_pa, self.targets
        )
    }

    fn open(&self) -> String {
        self.segment([[0.006, 0.010], [0.003, 0.005], [0.1, 0.2], self.angle_deg])
    }

    /// With the geometry of an answer.
    fn given(&self, found: &SegmentAnswer) -> String {
        let sizes = [found.inner_radius_m, found.wall_m, found.length_m, found.angle_deg];
        self.segment(sizes.map(|size| [size; 2]))
    }
}

fn problem(weights: &str, is_shared: bool, segments: &[String]) -> Problem {
    let text = format!(
        r#"{{"format": 1, "shared_pressure": {is_shared},
  "weights": {{"length_per_m2": 1e6, "outer_radius_per_m2": 1e6, "bend_angle_per_rad2": 1e4, "twist_per_rad2": 1e4{weights}}},
  "segments": [{}]}}"#,
        segments.join(", ")
    );
    Problem::read(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn solved(problem: &Problem) -> Answer {
    solve(problem, &Budget::default()).expect("an answer")
}

fn actuator(problem: &Problem, answer: &Answer, index: usize) -> Actuator<f64> {
    let found = &answer.segments[index];
    let geometry = Geometry {
        inner_radius_m: found.inner_radius_m,
        outer_radius_m: found.outer_radius_m,
        length_m: found.length_m,
        angle_rad: found.angle_deg.to_radians(),
    };
    Actuator::new(&problem.segments()[index].parameters(&geometry)).expect("a geometry of the model")
}

/// The mean of `(P/P_ref)^2` by the printed pressures.
fn mean(answer: &Answer, reference_pa: f64) -> f64 {
    let phases = answer.segments.iter().flat_map(|segment| &segment.phases);
    let squares: Vec<f64> = phases.map(|phase| (phase.pressure_pa / reference_pa).powi(2)).collect();
    squares.iter().sum::<f64>() / squares.len() as f64
}

#[test]
fn pressures_of_a_given_tube_are_the_least_of_a_scan() {
    for case in &CASES {
        let middle =
            case.segment([[0.008; 2], [0.004; 2], [0.15; 2], [0.5 * (case.angle_deg[0] + case.angle_deg[1]); 2]]);
        for effort in [1.0, 100.0, 10_000.0] {
            let problem = problem(
                &format!(", \"effort\": {effort}, \"reference_pressure_pa\": 50000"),
                false,
                std::slice::from_ref(&middle),
            );
            let (answer, segment) = (solved(&problem), &problem.segments()[0]);
            let actuator = actuator(&problem, &answer, 0);
            let cap = answer.segments[0].pressure_cap_pa;
            assert!(effort > 1.0 || mean(&answer, cap) > 0.1, "{}: hardly any pressure", case.motion);
            let mut least = 0.0;
            for goal in segment.goals.iter().flatten() {
                let at = |pressure_pa: f64| {
                    let solution = actuator.forward(pressure_pa, &Load::none()).expect("finite");
                    assert_eq!(solution.status, Status::Solved);
                    let away = segment.measure(&solution.state, 0.15) - goal.value;
                    goal.weight * away * away + effort / 3.0 * (pressure_pa / 50e3).powi(2)
                };
                // Two hundred pressures, and between the best one's neighbours again, six times.
                let (mut low, mut high, mut best) = (0.0, cap, f64::INFINITY);
                for _ in 0..6 {
                    let step = (high - low) / 200.0;
                    let pressures: Vec<f64> = (0..=200).map(|i| (low + step * f64::from(i)).min(cap)).collect();
                    let values: Vec<f64> = pressures.iter().map(|pressure| at(*pressure)).collect();
                    let nearest = (0..=200).min_by(|a, b| values[*a].total_cmp(&values[*b])).expect("some");
                    best = values[nearest].min(best);
                    (low, high) = (pressures[nearest.saturating_sub(1)], pressures[(nearest + 1).min(200)]);
                }
                least += best;
            }
            let found = answer.objective;
            assert!((found / least - 1.0).abs() < 1e-9, "{} {effort}: {found} {least}", case.motion);
        }
    }
}

#[test]
fn objective_is_that_of_the_printed_numbers() {
    let segments: Vec<String> = CASES[..2].iter().map(Case::open).collect();
    for is_shared in [false, true] {
        let problem = problem(", \"effort\": 20, \"reference_pressure_pa\": 40000", is_shared, &segments);
        let answer = solved(&problem);
        let (goals, effort) = (objective(&problem, &answer), 20.0 * mean(&answer, 40e3));
        assert!((answer.objective / (goals + effort) - 1.0).abs() < 1e-12, "{} {goals} {effort}", answer.objective);
        let term = answer.terms.effort.expect("a term");
        assert!((term / effort - 1.0).abs() < 1e-12, "{term} {effort}");
    }
}

#[test]
fn reference_is_by_default_the_highest_pressure() {
    let segments = [CASES[0].open(), CASES[1].open()];
    let answer = solved(&problem(", \"effort\": 30", false, &segments));
    let of = |index: usize, reference_pa: f64| {
        let phases = &answer.segments[index].phases;
        phases.iter().map(|phase| (phase.pressure_pa / reference_pa).powi(2)).sum::<f64>()
    };
    let effort = 30.0 * (of(0, 80e3) + of(1, 60e3)) / 6.0;
    assert!((answer.terms.effort.expect("a term") / effort - 1.0).abs() < 1e-12);
}

#[test]
fn one_segment_has_the_same_minimum_on_a_supply_line() {
    // Pressures eliminated with exact derivatives against pressures searched by differences and an augmented Lagrangian.
    for case in &CASES {
        for effort in [3.0, 300.0] {
            let weights = format!(", \"effort\": {effort}");
            let [own, line] =
                [false, true].map(|is_shared| solved(&problem(&weights, is_shared, &[case.open()])).objective);
            assert!((own / line - 1.0).abs() < 2e-6, "{} {effort}: {own} {line}", case.motion);
        }
    }
}

#[test]
fn neighbouring_geometries_are_no_better() {
    for case in &CASES {
        let weights = ", \"effort\": 50";
        let answer = solved(&problem(weights, false, &[case.open()]));
        let best = &answer.segments[0];
        let again = solved(&problem(weights, false, &[case.given(best)])).objective;
        assert!((again / answer.objective - 1.0).abs() < 1e-9, "{}: {again} {}", case.motion, answer.objective);
        let bounds = [[0.006, 0.010], [0.003, 0.005], [0.1, 0.2], case.angle_deg];
        for axis in 0..4 {
            for share in [1e-3, -1e-3, 3e-2, -3e-2] {
                let mut there = best.clone();
                let [low, high] = bounds[axis];
                let [inner, wall, length, angle] =
                    [0, 1, 2, 3].map(|of| if of == axis { share * (high - low) } else { 0.0 });
                there.inner_radius_m += inner;
                there.wall_m += wall;
                there.length_m += length;
                there.angle_deg += angle;
                let sizes = [there.inner_radius_m, there.wall_m, there.length_m, there.angle_deg];
                if sizes[axis] < low - 1e-12 || sizes[axis] > high + 1e-12 {
                    continue;
                }
                let other = solved(&problem(weights, false, &[case.given(&there)])).objective;
                assert!(other >= answer.objective * (1.0 - 1e-9), "{} {axis} {share}: {other}", case.motion);
            }
        }
    }
}

#[test]
fn effort_is_traded_for_deformation() {
    // Of minima of A + e B, a larger e has no larger B and no smaller A.
    for is_shared in [false, true] {
        let segments = [CASES[0].open(), CASES[2].open()];
        let mut before: Option<[f64; 2]> = None;
        for effort in [0.0, 1.0, 10.0, 100.0, 1e9] {
            let answer = solved(&problem(
                &format!(", \"effort\": {effort}, \"reference_pressure_pa\": 50000"),
                is_shared,
                &segments,
            ));
            let spent = mean(&answer, 50e3);
            let missed = answer.objective - effort * spent;
            if let Some([less_missed, more_spent]) = before {
                assert!(spent <= more_spent * (1.0 + 1e-4), "{effort}: {spent} {more_spent}");
                assert!(missed >= less_missed * (1.0 - 1e-4), "{effort}: {missed} {less_missed}");
            }
            before = Some([missed, spent]);
        }
        // Without pressure only lengths are left: 0.14, 0.21 and 0.24 m against at most 0.2 m, and all bends against none.
        let rest: f64 = 1e6 * (0.14 - 0.59 / 3.0_f64).powi(2)
            + 1e6 * ((0.21 - 0.59 / 3.0_f64).powi(2) + (0.24 - 0.59 / 3.0_f64).powi(2))
            + 1e4 * (0.3_f64.powi(2) + 1.2 * 1.2 + 16.0);
        // For so large an effort the deformation is linear in the pressure: half of the gain is spent.
        let [missed, spent] = before.expect("answers");
        let sum = missed + 2.0 * 1e9 * spent;
        assert!((sum / rest - 1.0).abs() < 1e-6 && spent < 1e-7, "{missed} {rest} {spent}");
    }
}

#[test]
fn no_weight_is_no_effort() {
    for is_shared in [false, true] {
        let segments = [CASES[0].open(), CASES[1].open()];
        let [none, zero] = ["", ", \"effort\": 0, \"reference_pressure_pa\": 1"]
            .map(|weights| solved(&problem(weights, is_shared, &segments)));
        assert_eq!(none, zero);
        assert_eq!(none.terms.effort, None);
    }
}
