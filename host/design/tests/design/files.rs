//! What is said about problem files that are wrong.

use softlimb_design::actuators::{Problem, ProblemError};

use crate::design::common::extension;

/// The message about a problem after replacements.
fn complaint(changes: &[(&str, &str)]) -> String {
    Problem::read(&extension(changes)).expect_err("a wrong file").to_string()
}

#[test]
fn value_out_of_range_is_named_with_its_range_and_line() {
    for (from, to, message) in [
        ("\"format\": 1", "\"format\": 2", "line 2: format = 2 is not allowed: 1"),
        ("1e6", "-1", "line 3: weights.length_per_m2 = -1 is not allowed: >= 0"),
        ("1e6", "1e6, \"effort\": -1", "line 3: weights.effort = -1 is not allowed: >= 0"),
        (
            "1e6",
            "1e6, \"effort\": 1, \"reference_pressure_pa\": 0",
            "line 3: weights.reference_pressure_pa = 0 is not allowed: > 0",
        ),
        (
            "0.000178",
            "0.000178, \"wall_share\": -0.1",
            "line 9: segments[0].fiber.wall_share = -0.1 is not allowed: 0, the inner face, to 1, the outer one",
        ),
        ("2e5", "0", "line 8: segments[0].material.shear_modulus_pa = 0 is not allowed: finite and > 0"),
        ("3.61e8", "-5", "line 9: segments[0].fiber.modulus_pa = -5 is not allowed: finite and >= 0"),
        ("\"families\": 2", "\"families\": 3", "line 9: segments[0].fiber.families = 3 is not allowed: 1 or 2"),
        ("[0.006, 0.010]", "[0, 0.010]", "line 11: segments[0].bounds.inner_radius_m[0] = 0 is not allowed: > 0"),
        (
            "[0.003, 0.005]",
            "[0.005, 0.003]",
            "line 12: segments[0].bounds.wall_m[1] = 0.003 is not allowed: at least 0.005, the lower bound",
        ),
        (
            "\"wall_m\": [0.003, 0.005]",
            "\"outer_radius_m\": [0.01, 0.02]",
            "line 12: segments[0].bounds.outer_radius_m[0] = 0.01 is not allowed: more than 0.01, the largest inner_radius_m",
        ),
        (
            "[0, 15]",
            "[0, 95]",
            "line 14: segments[0].bounds.angle_deg[1] = 95 is not allowed: -90 to 90, from the hoop",
        ),
        ("60000", "0", "line 15: segments[0].bounds.pressure_max_pa = 0 is not allowed: > 0"),
        (
            "60000",
            "60000, \"limit_margin\": 0",
            "line 15: segments[0].bounds.limit_margin = 0 is not allowed: 0.001 to 0.9",
        ),
        (
            "0.000178",
            "0.0031, \"placement\": \"layer\"",
            "line 9: segments[0].fiber.thickness_m = 0.0031 is not allowed: > 0, at most 0.003, the thinnest wall",
        ),
        ("[0.2, 0.21]", "[0.2, -0.21]", "line 17: segments[0].targets.length_m[1] = -0.21 is not allowed: > 0"),
        ("[0.2, 0.21]", "[]", "line 17: segments[0].targets.length_m = [0 items] is not allowed: 1 to 1000 phases"),
    ] {
        assert_eq!(complaint(&[(from, to)]), message);
    }
}

#[test]
fn missing_surplus_and_unfit_entries_are_named() {
    for (from, to, message) in [
        ("length_per_m2", "twist_per_rad2", "line 3: weights.length_per_m2 is missing: a segment has such targets"),
        (
            "\"wall_m\": [0.003, 0.005],",
            "",
            "line 10: segments[0].bounds needs exactly two of inner_radius_m, outer_radius_m and wall_m: the third follows",
        ),
        (
            "\"length_m\": [0.2, 0.21]",
            "\"twist_rad\": [1]",
            "line 17: segments[0].targets.length_m is missing: one value for each phase",
        ),
        (
            "{\"length_m\": [0.2, 0.21]}",
            "{\"length_m\": [0.2], \"twist_rad\": [1]}",
            "line 17: segments[0].targets.twist_rad is not allowed: no quantity of this motion",
        ),
        ("\"extension\"", "\"bending\"", "line 3: weights.bend_angle_per_rad2 is missing: a segment has such targets"),
    ] {
        assert_eq!(complaint(&[(from, to)]), message);
    }
}

/// A bender may state a winding, of which the model follows two families in a sheet.
#[test]
fn windings_of_benders_are_sheets_of_two_families() {
    let bending = [
        ("\"extension\"", "\"bending\""),
        ("length_per_m2", "bend_angle_per_rad2"),
        ("{\"length_m\": [0.2, 0.21]}", "{\"bend_angle_rad\": [0.2, 0.4]}"),
    ];
    let problem = Problem::read(&extension(&bending)).expect("a wound bender");
    assert_eq!(problem.segments()[0].winding.expect("stated").families, fra_model::Families::Two);
    for (from, to, message) in [
        (
            "\"families\": 2",
            "\"families\": 1",
            "line 9: segments[0].fiber.families = 1 is not allowed: 2: the model of a bend follows two equal families alone",
        ),
        (
            "0.000178",
            "0.000178, \"placement\": \"layer\"",
            "line 9: segments[0].fiber.placement is not allowed: \"sheet\", the only one whose angle the model of a bend follows",
        ),
    ] {
        assert_eq!(complaint(&[&bending[..], &[(from, to)]].concat()), message);
    }
    let hoop = [&bending[..], &[("\"fiber\"", "\"note\"")]].concat();
    assert!(Problem::read(&extension(&hoop)).is_err());
}

#[test]
fn malformed_problem_files_are_refused_where_the_parser_stopped() {
    let error = Problem::read(&extension(&[("\"name\"", "\"nmae\"")])).expect_err("an unknown field");
    assert!(matches!(&error, ProblemError::Format { line: 6, message, .. } if message.contains("nmae")), "{error}");
    let error =
        Problem::read(&extension(&[("\"name\": \"arm\",", "\"name\": \"arm\"")])).expect_err("a comma is missing");
    assert!(matches!(error, ProblemError::Format { line: 7, .. }), "{error}");
    assert!(Problem::read("").is_err() && Problem::read("[]").is_err() && Problem::read("{}").is_err());
}
