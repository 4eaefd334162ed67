//! What `docs/evidence/accuracy.md` says beside its tables.

use crate::bench_accuracy::published;

/// Largest and median error of a line of the published table.
fn errors(problem: &str, method: &str, motion: &str, scalar: &str) -> [f64; 2] {
    let names = [problem, method, motion, scalar];
    let report = published();
    let row = report.rows.iter().find(|row| row.names == names).unwrap_or_else(|| panic!("no line {names:?}"));
    [row.accuracy.max_error, row.accuracy.median_error]
}

const STRAIGHT: [&str; 3] = ["extension", "expansion", "twisting"];
const ALL: [&str; 4] = ["extension", "expansion", "twisting", "bending"];

#[test]
fn the_solver_answers_every_question_to_the_rounding_of_its_scalar() {
    for row in published().rows.iter().filter(|row| row.names[1].starts_with(&row.names[0])) {
        let bound = if row.names[3] == "f64" { 1e-13 } else { 1e-5 };
        assert!(row.accuracy.max_error < bound, "{:?}: {:e}", row.names, row.accuracy.max_error);
        assert_eq!(row.accuracy.asked, row.accuracy.solved, "{:?}", row.names);
    }
}

#[test]
fn each_node_is_worth_more_than_a_digit_and_eight_are_enough() {
    for motion in STRAIGHT {
        for count in 2..=6 {
            let [fewer, more] =
                [count, count + 1].map(|count| errors("forward", &format!("{count} nodes"), motion, "f64")[0]);
            assert!(more < 0.1 * fewer, "{motion}: {fewer:e} to {more:e}");
        }
        assert!(errors("forward", "8 nodes", motion, "f64")[0] < 1e-12, "{motion}");
        assert!(errors("forward", "4 nodes", motion, "f64")[0] < 1e-5, "{motion}");
    }
}

#[test]
fn printed_equations_are_no_approximations() {
    assert!(errors("forward", "printed (13)", "bending", "f64")[1] > 3.0);
    for motion in STRAIGHT {
        assert!(errors("inverse", "printed (8)", motion, "f64")[1] > 0.2, "{motion}");
    }
    for balance in ["B0", "B1"] {
        assert!(errors("forward", balance, "bending", "f64")[1] > 0.05, "{balance}");
    }
}

#[test]
fn plain_newton_in_single_precision_loses_the_pressure_of_stiff_sheets_and_the_solver_does_not() {
    let [newton, _] = errors("inverse", "Newton, warm, 3 steps", "extension", "f32");
    let [solver, _] = errors("inverse", "inverse_near", "extension", "f32");
    assert!(newton > 5.0 * solver, "{newton:e} against {solver:e}");
}

#[test]
fn a_series_is_cheap_and_its_worst_actuator_is_far_from_its_median() {
    for motion in ALL {
        let [worst, median] = errors("inverse", "Chebyshev, degree 8", motion, "f64");
        assert!(median < 1e-5 && worst > 30.0 * median, "{motion}: {worst:e}, {median:e}");
    }
}

#[test]
fn the_grid_of_the_table_bounds_its_error_whatever_the_degree() {
    for motion in ALL {
        let [low, high] =
            ["table, degree 12", "table, degree 16"].map(|method| errors("inverse", method, motion, "f32")[1]);
        assert!(low > 1e-6 && high > 0.5 * low && high < 1e-4, "{motion}: {low:e}, {high:e}");
        assert!(errors("inverse", "Chebyshev, degree 16", motion, "f64")[1] < 1e-9, "{motion}");
    }
}

#[test]
fn newton_from_rest_may_land_elsewhere() {
    let [worst, median] = errors("forward", "Newton, cold, to 1e-10", "twisting", "f64");
    assert!(worst > 0.1 && median < 1e-14, "{worst:e}, {median:e}");
}
