//! The batch interface as another program uses it.

use serde_json::{Value, json};
use softlimb::query::{Scalar, batch};

fn ask(lines: &str, scalar: Scalar) -> Vec<Value> {
    let mut out = Vec::new();
    batch(lines.as_bytes(), &mut out, scalar).expect("in memory");
    String::from_utf8(out).expect("UTF-8").lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

fn bender() -> Value {
    json!({"id": "b", "motion": "bending", "problem": "forward", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3,
        "length_m": 0.1, "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2e6}, "pressure_pa": 30e3})
}

fn extender() -> Value {
    json!({"id": 7, "motion": "extension", "problem": "inverse", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3,
        "length_m": 0.1, "material": {"law": "yeoh", "c_pa": [86.56e3, 13.805e3, -1466.1]},
        "fiber": {"angle_deg": 3, "families": 2, "modulus_pa": 361e6, "placement": "sheet", "thickness_m": 0.178e-3},
        "target": {"axial_stretch": 1.1}})
}

fn with(mut base: Value, key: &str, value: Value) -> Value {
    base[key] = value;
    base
}

#[test]
fn answers_come_in_order_with_their_ids() {
    let lines = format!("{}\n\n{}\n", bender(), extender());
    let answers = ask(&lines, Scalar::F64);
    assert_eq!(answers.len(), 2);
    assert_eq!((&answers[0]["id"], &answers[0]["status"]), (&json!("b"), &json!("ok")));
    // 43.0 deg: tabulated by an independent evaluation of the bending model.
    let angle = answers[0]["bend_angle_rad"].as_f64().unwrap();
    assert!((angle.to_degrees() - 43.0).abs() < 0.2, "{angle}");
    assert_eq!((&answers[1]["id"], &answers[1]["status"]), (&json!(7), &json!("ok")));
    assert!((answers[1]["axial_stretch"].as_f64().unwrap() - 1.1).abs() < 1e-14);
}

#[test]
fn inverse_answers_lead_back_through_text() {
    let inverse = &ask(&extender().to_string(), Scalar::F64)[0];
    let mut forward = with(extender(), "problem", json!("forward"));
    forward.as_object_mut().unwrap().remove("target");
    let forward = with(forward, "pressure_pa", inverse["pressure_pa"].clone());
    let again = &ask(&forward.to_string(), Scalar::F64)[0];
    assert_eq!(again["pressure_pa"], inverse["pressure_pa"], "floats read back exactly");
    assert!((again["axial_stretch"].as_f64().unwrap() - 1.1).abs() < 1e-13);
}

#[test]
fn single_precision_answers_are_single_precision() {
    let answer = &ask(&bender().to_string(), Scalar::F32)[0];
    let angle = answer["bend_angle_rad"].as_f64().unwrap();
    assert_eq!(f64::from(angle as f32), angle);
    let exact = ask(&bender().to_string(), Scalar::F64)[0]["bend_angle_rad"].as_f64().unwrap();
    assert!((angle / exact - 1.0).abs() < 1e-5 && angle != exact);
}

#[test]
fn answer_beyond_the_limit_is_the_limit_pressure() {
    let tube = json!({"id": 1, "motion": "expansion", "problem": "forward", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3,
        "length_m": 0.1, "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2226e6},
        "fiber": {"angle_deg": 90, "families": 2, "modulus_pa": 361e6, "placement": "sheet", "thickness_m": 0.178e-3},
        "pressure_pa": 100e3});
    let answer = &ask(&tube.to_string(), Scalar::F64)[0];
    assert_eq!(answer["status"], "no_solution");
    assert!((answer["limit_pressure_pa"].as_f64().unwrap() / 63.5e3 - 1.0).abs() < 0.02);
    assert!(answer["outer_radius_m"].is_null());
}

/// Every value in the order of the fields: what a derived reader would take for the object.
#[test]
fn array_is_no_object_whatever_it_holds() {
    let question = r#"["b","bending","forward",6e-3,8e-3,0.1,{"law":"neo-hookean","shear_modulus_pa":2e5},null,3e4,null,null,null]"#;
    let fiber = json!([[3, 2, 361e6, "sheet", 0.178e-3, null]]);
    let cases = [
        question.to_owned(),
        with(bender(), "material", json!(["neo-hookean", 0.2e6])).to_string(),
        with(extender(), "fiber", fiber).to_string(),
        with(extender(), "target", json!([1.1])).to_string(),
    ];
    for line in cases {
        let answer = &ask(&line, Scalar::F64)[0];
        assert_eq!(answer["status"], "invalid", "{line}");
        assert!(answer["message"].as_str().unwrap().contains("invalid type: array, expected an object"), "{answer}");
    }
}

#[test]
fn messages_are_in_the_words_of_json() {
    let with_target = |target: &str| extender().to_string().replace("{\"axial_stretch\":1.1}", target);
    let families = |value: Value| {
        let mut question = extender();
        question["fiber"]["families"] = value;
        question.to_string()
    };
    let yeoh = |material: Value| with(extender(), "material", material).to_string();
    let one_field = "line 1: `target` must have exactly one field";
    let cases = [
        (with_target(r#"{"axial_stretch":1.1,"twist_rad":1}"#), one_field),
        (with_target("{}"), one_field),
        (with_target(r#"{"axial_stretch":null}"#), "invalid type: null, expected a number"),
        (with_target(r#"{"stretch":1.1}"#), "unknown field `stretch`"),
        (with_target("1.1"), "invalid type: number `1.1`, expected an object"),
        (families(json!(1.5)), "invalid type: number `1.5`, expected 1 or 2"),
        (families(json!(300)), "invalid value: integer `300`, expected 1 or 2"),
        (with(bender(), "motion", json!(0)).to_string(), "invalid type: integer `0`, expected a string"),
        (with(bender(), "motion", json!({"bending": null})).to_string(), "invalid type: object, expected a string"),
        (yeoh(json!({"law": "yeoh", "shear_modulus_pa": 1e5})), "`material.c_pa` is missing"),
        (yeoh(json!({"law": "neo-hookean"})), "`material.shear_modulus_pa` is missing"),
        (yeoh(json!({"law": "neo-hookean", "shear_modulus_pa": 1e5, "c_pa": [1e5, 0, 0]})), "takes no `c_pa`"),
        (yeoh(json!({"law": "yeoh", "shear_modulus_pa": 1e5, "c_pa": [1e5, 0, 0]})), "takes no `shear_modulus_pa`"),
        ("trux".to_owned(), "line 1: not JSON: expected value (column 4)"),
        ("{\"id\":1".to_owned(), "line 1: not JSON: the line ends within an object (column 7)"),
    ];
    for (line, expected) in cases {
        let answer = &ask(&line, Scalar::F64)[0];
        assert_eq!(answer["status"], "invalid", "{line}");
        assert!(answer["message"].as_str().unwrap().contains(expected), "{line}: {answer}");
    }
}

#[test]
fn line_that_cannot_be_answered_says_why_and_the_others_are_answered() {
    let no_pressure = {
        let mut b = bender();
        b.as_object_mut().unwrap().remove("pressure_pa");
        b
    };
    let cases = [
        ("{not json".to_owned(), "line 1"),
        (with(bender(), "inner_radius_m", json!(9e-3)).to_string(), "outer_radius_m = 0.008 is not allowed"),
        (with(bender(), "length_m", json!(-0.1)).to_string(), "length_m = -0.1 is not allowed: finite and > 0"),
        (with(bender(), "presure_pa", json!(1)).to_string(), "unknown field `presure_pa`"),
        (with(bender(), "motion", json!("wriggling")).to_string(), "unknown value `wriggling`"),
        (with(bender(), "target", json!({"bend_angle_rad": 1.0})).to_string(), "takes no `target`"),
        (no_pressure.to_string(), "needs `pressure_pa`"),
        (with(extender(), "target", json!({"bend_angle_rad": 1.0})).to_string(), "bend_angle_rad"),
        (with(extender(), "fiber", json!({"angle_deg": 3, "families": 3, "modulus_pa": 1.0})).to_string(), "1 or 2"),
        (
            with(extender(), "fiber", json!({"angle_deg": 3, "families": 2, "modulus_pa": 1.0})).to_string(),
            "thickness_m",
        ),
        (with(bender(), "pressure_pa", json!("30 kPa")).to_string(), "expected a number"),
        ("[1, 2]".to_owned(), "line 1: invalid type: array, expected an object"),
        ("\u{7f}\u{0}".to_owned(), "line 1"),
        (bender().to_string().replace("30000.0", "1e999"), "out of range"),
    ];
    for (line, expected) in cases {
        let answers = ask(&format!("{line}\n{}", bender()), Scalar::F64);
        assert_eq!(answers[0]["status"], "invalid", "{line}");
        let message = answers[0]["message"].as_str().unwrap();
        assert!(message.contains(expected), "{line}: {message}");
        assert_eq!(answers[1]["status"], "ok");
    }
}

/// A weak winding at 45 deg first shortens the tube and then lengthens it: three pressures give one stretch, as forward answers show.
#[test]
fn pressure_range_and_all_solutions_choose_among_pressures() {
    let weak = json!({"id": 1, "motion": "extension", "problem": "forward", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3,
        "length_m": 0.1, "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2e6},
        "fiber": {"angle_deg": 45, "families": 2, "modulus_pa": 0.1e6, "thickness_m": 0.2e-3}, "pressure_pa": 500});
    let stretch = ask(&weak.to_string(), Scalar::F64)[0]["axial_stretch"].as_f64().unwrap();
    let mut inverse = with(weak.clone(), "problem", json!("inverse"));
    inverse.as_object_mut().unwrap().remove("pressure_pa");
    let inverse = with(inverse, "target", json!({"axial_stretch": stretch}));
    for scalar in [Scalar::F64, Scalar::F32] {
        let tolerance = if scalar == Scalar::F64 { 1e-6 } else { 0.05 };
        let first = &ask(&inverse.to_string(), scalar)[0];
        assert!((first["pressure_pa"].as_f64().unwrap() / 500.0 - 1.0).abs() < tolerance, "{first}");
        assert!(first.get("solutions").is_none());
        let all = with(with(inverse.clone(), "solutions", json!("all")), "pressure_range", json!([-1e5, 3e4]));
        let all = &ask(&all.to_string(), scalar)[0];
        assert_eq!((&all["status"], &all["solutions_complete"]), (&json!("ok"), &json!(true)));
        assert_eq!(all["solutions"][0]["pressure_pa"], all["pressure_pa"]);
        let pressures: Vec<f64> =
            all["solutions"].as_array().unwrap().iter().map(|s| s["pressure_pa"].as_f64().unwrap()).collect();
        assert!(pressures.len() >= 2 && pressures[0] > 0.0 && pressures[1] > pressures[0], "{pressures:?}");
        for pressure in &pressures {
            let again = &ask(&with(weak.clone(), "pressure_pa", json!(pressure)).to_string(), scalar)[0];
            let miss = again["axial_stretch"].as_f64().unwrap() - stretch;
            assert!(miss.abs() < if scalar == Scalar::F64 { 1e-12 } else { 1e-6 }, "{miss}");
        }
        // Between the first and the second nothing is left.
        let [low, high] = [pressures[0], pressures[1]];
        let behind = with(inverse.clone(), "pressure_range", json!([0.5 * (low + high), 3e4]));
        assert!((ask(&behind.to_string(), scalar)[0]["pressure_pa"].as_f64().unwrap() / high - 1.0).abs() < tolerance);
        let between =
            with(inverse.clone(), "pressure_range", json!([low + 0.2 * (high - low), high - 0.2 * (high - low)]));
        let none = &ask(&between.to_string(), scalar)[0];
        assert_eq!((&none["status"], &none["pressure_pa"]), (&json!("no_solution"), &Value::Null));
        let empty = with(with(inverse.clone(), "pressure_range", json!([1e6, 2e6])), "solutions", json!("all"));
        assert_eq!(ask(&empty.to_string(), scalar)[0]["solutions"], json!([]));
    }
}

#[test]
fn pressure_range_is_checked() {
    let refused = |line: &Value| {
        let answer = &ask(&line.to_string(), Scalar::F64)[0];
        assert_eq!(answer["status"], "invalid", "{answer}");
        answer["message"].as_str().unwrap().to_owned()
    };
    let message = refused(&with(extender(), "pressure_range", json!([5e4, 1e4])));
    assert!(message.contains("pressure_range[1] = 10000"), "{message}");
    assert!(refused(&with(extender(), "pressure_range", json!([0.0]))).contains("2"));
    let message = refused(&with(bender(), "pressure_range", json!([0.0, 1e4])));
    assert!(message.contains("a forward problem takes no `pressure_range`"), "{message}");
    let message = refused(&with(bender(), "solutions", json!("all")));
    assert!(message.contains("a forward problem takes no `solutions`"), "{message}");
    let by_section = with(with(extender(), "pressure_range", json!([2e4, 1e4])), "model", json!("section-fe"));
    assert!(refused(&by_section).contains("pressure_range[1]"));
}

#[test]
fn trade_name_stands_for_its_law_and_warns_beyond_its_test() {
    let known = softlimb::scene::castable_elastomer("Ecoflex 00-30").unwrap();
    let named = with(bender(), "material", json!(known.name));
    let named = with(named, "pressure_pa", json!(1e3));
    let stated = with(named.clone(), "material", json!({"law": "yeoh", "c_pa": known.c_pa}));
    let answers = ask(&format!("{named}\n{stated}\n"), Scalar::F64);
    assert_eq!(answers[0], answers[1]);
    // Its test ends at three times the length.
    let stretched = |stretch: f64| {
        let question = with(extender(), "material", json!(known.name));
        ask(&with(question, "target", json!({"axial_stretch": stretch})).to_string(), Scalar::F64).remove(0)
    };
    let (within, beyond) = (stretched(2.9), stretched(3.1));
    assert_eq!((&within["status"], within.get("warnings")), (&json!("ok"), None), "{within}");
    assert_eq!(beyond["status"], "ok", "{beyond}");
    let warning = beyond["warnings"][0].as_str().unwrap();
    assert!(warning.ends_with("the test behind the law ends at 3.00"), "{warning}");
    let unknown = &ask(&with(bender(), "material", json!("Ecoflex 00-31")).to_string(), Scalar::F64)[0];
    let message = "line 1: material = \"Ecoflex 00-31\" is no known elastomer: did you mean \"Ecoflex 00-30\"?";
    assert_eq!((&unknown["status"], &unknown["message"]), (&json!("invalid"), &json!(message)));
}
