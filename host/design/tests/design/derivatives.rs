//! That an answer is a stationary point: no small change of the geometry within the bounds does better.

use softlimb_design::actuators::kinds::Kind;
use softlimb_design::actuators::{Budget, Problem, solve};

/// The problem with every size of the geometry given: the pressures alone are left.
fn fixed(problem: &str, sizes: [f64; 4]) -> Problem {
    let [inner, wall, length, angle] = sizes;
    let text = problem
        .replace("[0.006, 0.010]", &format!("[{inner}, {inner}]"))
        .replace("[0.003, 0.005]", &format!("[{wall}, {wall}]"))
        .replace("[0.1, 0.3]", &format!("[{length}, {length}]"))
        .replace("[0, 15]", &format!("[{angle}, {angle}]"));
    Problem::read(&text).expect("a problem")
}

#[test]
fn answers_are_better_than_their_neighbours() {
    let text = crate::design::common::extension(&[("[0.2, 0.21]", "[0.12, 0.31, 0.2]")]);
    let problem = Problem::read(&text).expect("a problem");
    let answer = solve(&problem, &Budget::default()).expect("an answer");
    let best = &answer.segments[0];
    let sizes = [best.inner_radius_m, best.wall_m, best.length_m, best.angle_deg];
    let bounds = [[0.006, 0.010], [0.003, 0.005], [0.1, 0.3], [0.0, 15.0]];
    assert!(answer.objective > 1.0);
    for axis in 0..4 {
        for share in [1e-4, -1e-4, 1e-2, -1e-2] {
            let mut there = sizes;
            let [low, high] = bounds[axis];
            there[axis] = (sizes[axis] + share * (high - low)).clamp(low, high);
            let other = solve(&fixed(&text, there), &Budget::default()).expect("an answer").objective;
            assert!(other >= answer.objective * (1.0 - 1e-10), "{axis} {share}: {other} and {}", answer.objective);
        }
    }
}

#[test]
fn same_seed_gives_the_same_answer() {
    for kind in [Kind::B, Kind::D] {
        let once = solve(&kind.problem(7), &Budget::default()).expect("an answer");
        assert_eq!(once, solve(&kind.problem(7), &Budget::default()).expect("an answer"));
    }
}
