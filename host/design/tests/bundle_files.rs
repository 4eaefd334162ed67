//! What is said about files of bundle problems that are wrong.

use softlimb_design::actuators::ProblemError;
use softlimb_design::bundle::ForceProblem;

const FORCES: &str = include_str!("problems/forces.json");

fn complaint(from: &str, to: &str) -> ProblemError {
    assert!(FORCES.contains(from), "no {from}");
    ForceProblem::read(&FORCES.replacen(from, to, 1)).expect_err("a wrong file")
}

#[test]
fn value_out_of_range_is_named_with_its_range_and_line() {
    assert!(ForceProblem::read(FORCES).is_ok());
    for (from, to, message) in [
        ("\"force_per_n\": 1", "\"force_per_n\": -1", "line 4: weights.force_per_n = -1 is not allowed: >= 0"),
        (
            "\"torque_per_nm\": 20",
            "\"torque_per_nm\": 20, \"effort\": -1",
            "line 4: weights.effort = -1 is not allowed: >= 0",
        ),
        (
            "\"torque_per_nm\": 20",
            "\"torque_per_nm\": 20, \"reference_pressure_pa\": 0",
            "line 4: weights.reference_pressure_pa = 0 is not allowed: > 0",
        ),
        ("2e5", "0", "line 5: material.shear_modulus_pa = 0 is not allowed: > 0"),
        ("neo-hookean", "ogden", "line 5: material.law is not allowed: \"neo-hookean\" or \"yeoh\""),
        ("neo-hookean", "yeoh", "line 5: material.shear_modulus_pa is not allowed: a yeoh material has c_pa"),
        ("2e5", "2e5, \"c_pa\": [1, 2, 3]", "line 5: material.c_pa is not allowed: a neo-hookean material has none"),
        (", \"shear_modulus_pa\": 2e5", "", "line 5: material.shear_modulus_pa is missing: a number, Pa"),
        ("\"families\": 2", "\"families\": 3", "line 6: fiber.families = 3 is not allowed: 1 or 2"),
        ("3.61e8", "-1", "line 6: fiber.modulus_pa = -1 is not allowed: >= 0"),
        ("0.000178", "0", "line 6: fiber.thickness_m = 0 is not allowed: > 0"),
        ("[0.003, 0.006]", "[0, 0.006]", "line 7: bounds.wall_m[0] = 0 is not allowed: > 0"),
        (
            "[0.2, 0.24]",
            "[0.3, 0.24]",
            "line 7: bounds.length_m[1] = 0.24 is not allowed: at least 0.3, the lower bound",
        ),
        ("[0, 30]", "[-95, 30]", "line 7: bounds.angle_deg[0] = -95 is not allowed: >= -90"),
        ("[0, 30]", "[0, 95]", "line 7: bounds.angle_deg[1] = 95 is not allowed: -90 to 90, from the hoop"),
        ("120000", "0", "line 8: bounds.pressure_max_pa = 0 is not allowed: > 0"),
        ("[0.025, 0.05]", "[-1, 0.05]", "line 10: actuators[0].radius_m[0] = -1 is not allowed: >= 0"),
        ("[120, 120]", "[-2e4, 120]", "line 11: actuators[1].azimuth_deg[0] = -20000 is not allowed: >= -10000"),
        (
            "\"families\"",
            "\"placement\": \"woven\", \"families\"",
            "line 6: fiber.placement is not allowed: \"sheet\", \"layer\" or \"smeared\"",
        ),
        (
            "0.000178",
            "0.004, \"placement\": \"layer\"",
            "line 6: fiber.thickness_m = 0.004 is not allowed: > 0, at most 0.003, the thinnest wall",
        ),
        (
            "\"thickness_m\": 0.000178",
            "\"placement\": \"layer\"",
            "line 6: fiber.thickness_m is missing: a layer has one",
        ),
        (
            "0.000178",
            "0.000178, \"placement\": \"smeared\"",
            "line 6: fiber.thickness_m is not allowed: a smeared winding is as thick as the wall",
        ),
        (
            "0.000178",
            "0.000178, \"wall_share\": 1.5",
            "line 6: fiber.wall_share = 1.5 is not allowed: 0, the inner face, to 1, the outer one",
        ),
        (
            "0.000178",
            "0.001, \"placement\": \"layer\", \"wall_share\": 1",
            "line 6: fiber.wall_share is not allowed: only a sheet has a place in the wall",
        ),
        (
            "\"azimuth_deg\": [120, 120]",
            "\"y_m\": [0, 0]",
            "line 11: actuators[1] needs either radius_m and azimuth_deg or x_m and y_m",
        ),
        (
            "\"radius_m\": [0.025, 0.05], \"azimuth_deg\": [120, 120]",
            "\"x_m\": [0.1, 0], \"y_m\": [0, 0]",
            "line 11: actuators[1].x_m[1] = 0 is not allowed: at least 0.1, the lower bound",
        ),
        (
            "[0.025, 0.05], \"azimuth_deg\": [120, 120]",
            "[0.025, 0.06], \"azimuth_deg\": [120, 120]",
            "line 11: actuators[1].radius_m = [0.025, 0.06] is not allowed: [0.025, 0.05], as before: shared_geometry gives all actuators one radius",
        ),
        (
            "\"azimuth_deg\": [120, 120]",
            "\"azimuth_deg\": [120, 120], \"bounds\": {\"wall_m\": [0.004, 0.004]}",
            "line 11: actuators[1].bounds.wall_m is not allowed: shared_geometry gives all actuators one",
        ),
        (
            "\"azimuth_deg\": [120, 120]",
            "\"azimuth_deg\": [120, 120], \"bounds\": {\"pressure_max_pa\": 0}",
            "line 11: actuators[1].bounds.pressure_max_pa = 0 is not allowed: > 0",
        ),
        (
            "\"azimuth_deg\": [120, 120]",
            "\"azimuth_deg\": [120, 120], \"fiber\": {\"families\": 0, \"modulus_pa\": 1, \"thickness_m\": 1}",
            "line 11: actuators[1].fiber.families = 0 is not allowed: 1 or 2",
        ),
        (
            "\"azimuth_deg\": [120, 120]",
            "\"azimuth_deg\": [120, 120], \"material\": {\"law\": \"yeoh\", \"c_pa\": [0, 1, 1]}",
            "line 11: actuators[1].material.c_pa[0] = 0 is not allowed: > 0",
        ),
        (
            "\"held_length_m\": 0.24",
            "\"held_length_m\": 0",
            "line 15: samples[0].held_length_m = 0 is not allowed: > 0",
        ),
    ] {
        assert_eq!(complaint(from, to).to_string(), message);
    }
    let none = FORCES.split_once("\"samples\"").unwrap().0.to_owned() + "\"samples\": []\n}";
    let error = ForceProblem::read(&none).unwrap_err().to_string();
    assert_eq!(error, "line 14: samples = 0 is not allowed: 1 to 100 items");
}

#[test]
fn malformed_problem_files_are_refused_where_the_parser_stopped() {
    for (from, to, line) in [("\"families\"", "\"colour\": \"red\", \"families\"", 6), ("{\"law\"", "[{\"law\"", 5)] {
        let error = complaint(from, to);
        assert!(matches!(error, ProblemError::Format { line: found, .. } if found == line), "{error}");
    }
}
