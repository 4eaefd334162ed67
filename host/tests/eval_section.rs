//! Questions to the section's finite elements, as another program asks them.

use serde_json::{Value, json};
use softlimb::query::{Scalar, batch};

fn ask_as(line: &Value, scalar: Scalar) -> Value {
    let mut out = Vec::new();
    batch(line.to_string().as_bytes(), &mut out, scalar).expect("in memory");
    serde_json::from_slice(&out).expect("JSON")
}

fn ask(line: &Value) -> Value {
    ask_as(line, Scalar::F64)
}

fn tube(motion: &str, problem: &str) -> Value {
    json!({"id": 1, "model": "section-fe", "motion": motion, "problem": problem, "inner_radius_m": 6e-3, "outer_radius_m": 8e-3,
        "length_m": 0.1, "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2e6}})
}

fn number(answer: &Value, field: &str) -> f64 {
    answer[field].as_f64().unwrap_or_else(|| panic!("no {field} in {answer}"))
}

fn with(mut base: Value, key: &str, value: Value) -> Value {
    base[key] = value;
    base
}

/// 42.6 deg: an independent program's finite elements, with a thin stiff layer and a narrow strip in place of the ideal ones.
#[test]
fn bend_comes_with_its_discretisation_error() {
    let answer = ask(&with(tube("bending", "forward"), "pressure_pa", json!(30e3)));
    assert_eq!(answer["status"], "ok");
    let angle = number(&answer, "bend_angle_rad");
    assert!((angle.to_degrees() - 42.6).abs() < 0.9, "{angle}");
    let error = number(&answer["discretisation_error"], "bend_angle_rad");
    assert!(error > 0.0 && error < 3e-3 * angle, "{error}");
    assert!(answer.get("residual").is_none());
}

#[test]
fn straight_tubes_have_the_analytic_answers() {
    let fiber = json!({"angle_deg": 30, "families": 1, "modulus_pa": 5e7, "thickness_m": 2e-4});
    let question = with(with(tube("twisting", "forward"), "fiber", fiber), "pressure_pa", json!(20e3));
    let by_section = ask(&question);
    let analytic = ask(&with(question, "model", json!("analytic")));
    for field in ["twist_rad", "outer_radius_m", "axial_stretch"] {
        let [a, b] = [&by_section, &analytic].map(|answer| number(answer, field));
        assert!((a - b).abs() < 1e-5 * b.abs(), "{field}: {a} {b}");
    }
}

#[test]
fn inverse_leads_back() {
    let inverse = ask(&with(tube("bending", "inverse"), "target", json!({"bend_angle_rad": 0.6})));
    assert_eq!(inverse["status"], "ok", "{inverse}");
    assert!((number(&inverse, "bend_angle_rad") - 0.6).abs() < 1e-9);
    let forward = ask(&with(tube("bending", "forward"), "pressure_pa", inverse["pressure_pa"].clone()));
    assert!((number(&forward, "bend_angle_rad") - 0.6).abs() < 1e-9);
}

/// A target that the actuator has at rest takes no pressure.
#[test]
fn inverse_of_rest_is_no_pressure() {
    let fiber = json!({"angle_deg": 30, "families": 1, "modulus_pa": 5e7, "thickness_m": 2e-4});
    for (motion, target) in [
        ("bending", json!({"bend_angle_rad": 0})),
        ("twisting", json!({"twist_rad": 0})),
        ("extension", json!({"axial_stretch": 1})),
        ("expansion", json!({"outer_radius_m": 8e-3})),
    ] {
        let question = with(tube(motion, "inverse"), "target", target);
        let question = if motion == "bending" { question } else { with(question, "fiber", fiber.clone()) };
        let answer = ask(&question);
        assert_eq!(answer["status"], "ok", "{motion}: {answer}");
        assert!(number(&answer, "pressure_pa").abs() < 1e-3, "{motion}: {answer}");
    }
}

/// A radius next to the limit point, which the secant may overstep.
#[test]
fn inverse_next_to_a_limit_point_is_found() {
    for radius_m in [8.5e-3, 9e-3, 9.4e-3] {
        let answer = ask(&with(tube("expansion", "inverse"), "target", json!({"outer_radius_m": radius_m})));
        assert_eq!(answer["status"], "ok", "{radius_m}: {answer}");
        assert!((number(&answer, "outer_radius_m") - radius_m).abs() < 1e-9, "{answer}");
    }
}

#[test]
fn pressures_beyond_the_limit_point_have_no_number() {
    // 0.75 mu ln(R_o/R_i) = 43.15 kPa.
    let answer = ask(&with(tube("extension", "forward"), "pressure_pa", json!(60e3)));
    assert_eq!((&answer["status"], &answer["outer_radius_m"]), (&json!("no_solution"), &Value::Null));
    assert!((number(&answer, "limit_pressure_pa") / 43.15e3 - 1.0).abs() < 2e-3, "{answer}");
    let wide = ask(&with(tube("extension", "inverse"), "target", json!({"outer_radius_m": 0.1})));
    assert_eq!(wide["status"], "no_solution");
}

#[test]
fn queries_beyond_the_section_are_refused() {
    let message = |answer: Value| {
        assert_eq!(answer["status"], "invalid", "{answer}");
        answer["message"].as_str().expect("a message").to_owned()
    };
    let single = with(tube("bending", "forward"), "pressure_pa", json!(1e4));
    assert_eq!(ask_as(&single, Scalar::F32), ask(&single));
    assert!(message(ask(&with(single.clone(), "model", json!("shell")))).contains("unknown value"));
    assert!(
        message(ask(&with(single.clone(), "pressure_pa", json!(-1e3)))).contains("pressure_pa = -1000 is not allowed")
    );
    assert!(
        message(ask(&with(single, "outer_radius_m", json!(5e-3)))).contains("outer_radius_m = 0.005 is not allowed")
    );
}
