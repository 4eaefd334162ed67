//! Segments in series through the batch interface.

use fra_model::{
    Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, Series, SeriesTarget,
};
use serde_json::{Value, json};
use softlimb::query::{Scalar, batch};

fn ask(line: &Value, scalar: Scalar) -> Value {
    let mut out = Vec::new();
    batch(line.to_string().as_bytes(), &mut out, scalar).expect("in memory");
    serde_json::from_slice(&out).expect("JSON")
}

fn bender() -> Value {
    json!({"motion": "bending", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3, "length_m": 0.05,
        "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2e6}, "bend_direction_deg": 90})
}

fn twister() -> Value {
    json!({"motion": "twisting", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3, "length_m": 0.06,
        "material": {"law": "yeoh", "c_pa": [86.56e3, 13.805e3, -1466.1]},
        "fiber": {"angle_deg": 30, "families": 1, "modulus_pa": 50e6, "thickness_m": 0.2e-3}})
}

fn expander() -> Value {
    json!({"motion": "expansion", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3, "length_m": 0.04,
        "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2226e6},
        "fiber": {"angle_deg": 90, "families": 2, "modulus_pa": 361e6, "thickness_m": 0.178e-3}})
}

fn forward(segments: Value, pressure_pa: f64) -> Value {
    json!({"id": "s", "problem": "forward", "segments": segments, "pressure_pa": pressure_pa})
}

fn inverse(segments: Value, target: Value) -> Value {
    json!({"id": "s", "problem": "inverse", "segments": segments, "target": target})
}

fn number(answer: &Value, field: &str) -> f64 {
    answer[field].as_f64().unwrap_or_else(|| panic!("{field} in {answer}"))
}

/// The same segments in the terms of the model.
fn actuators() -> [Actuator<f64>; 2] {
    let bender = ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.05,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: None,
    };
    let twister = ActuatorParameters {
        motion: Motion::Twisting,
        length_m: 0.06,
        material: Material::Yeoh { c_pa: [86.56e3, 13.805e3, -1466.1] },
        fiber: Some(Fiber {
            angle_rad: 30_f64.to_radians(),
            families: Families::One,
            modulus_pa: 50e6,
            placement: Placement::Sheet,
            thickness_m: 0.2e-3,
            radius_m: 8e-3,
        }),
        ..bender
    };
    [bender, twister].map(|p| Actuator::new(&p).expect("valid"))
}

#[test]
fn sums_segments_and_tip_are_those_of_the_model() {
    let segments = actuators();
    let series = Series::new(&segments).unwrap();
    let mut states = vec![];
    let expected = series.forward_each(30e3, &Load::none(), |_, s| states.push(s.state)).unwrap();
    let answer = ask(&forward(json!([bender(), twister()]), 30e3), Scalar::F64);
    assert_eq!((&answer["id"], &answer["status"]), (&json!("s"), &json!("ok")));
    for (field, expected) in [
        ("pressure_pa", 30e3),
        ("length_m", expected.state.length_m),
        ("extension_m", expected.state.extension_m),
        ("twist_rad", expected.state.twist_rad),
        ("bend_angle_rad", expected.state.bend_angle_rad),
        ("volume_m3", expected.state.volume_m3),
    ] {
        assert_eq!(number(&answer, field), expected, "{field}");
    }
    for (answer, state) in answer["segments"].as_array().unwrap().iter().zip(&states) {
        assert_eq!(number(answer, "axial_stretch"), state.axial_stretch);
        assert_eq!(number(answer, "outer_radius_m"), state.outer_radius_m);
    }
    // The bend turns towards y, and the twisted segment goes on along its end.
    let (phi, arc, line) = (states[0].bend_angle_rad, 0.05 * states[0].axial_stretch, 0.06 * states[1].axial_stretch);
    let radius = arc / phi;
    let tip: Vec<f64> = answer["tip_position_m"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let place = [0.0, radius * (1.0 - phi.cos()) + line * phi.sin(), radius * phi.sin() + line * phi.cos()];
    for (found, expected) in tip.iter().zip(place) {
        assert!((found - expected).abs() < 1e-15, "{tip:?} against {place:?}");
    }
    // Half angles: -phi about x, then the twist about the new z.
    let ((bend_s, bend_c), (twist_s, twist_c)) = ((-phi / 2.0).sin_cos(), (states[1].twist_rad / 2.0).sin_cos());
    let turn: Vec<f64> =
        answer["tip_quaternion_wxyz"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let expected = [bend_c * twist_c, bend_s * twist_c, -bend_s * twist_s, bend_c * twist_s];
    let sign = (turn[0] * expected[0]).signum();
    for (found, expected) in turn.iter().zip(expected) {
        assert!((found * sign - expected).abs() < 1e-14, "{turn:?} against {expected:?}");
    }
}

#[test]
fn targets_lead_back_through_text() {
    let segments = json!([bender(), twister(), bender()]);
    let there = ask(&forward(segments.clone(), 25e3), Scalar::F64);
    for field in ["extension_m", "twist_rad", "bend_angle_rad"] {
        let mut target = json!({});
        target[field] = there[field].clone();
        let back = ask(&inverse(segments.clone(), target), Scalar::F64);
        assert_eq!(back["status"], "ok", "{back}");
        assert!((number(&back, "pressure_pa") / 25e3 - 1.0).abs() < 1e-12, "{back}");
    }
    let single = ask(&forward(segments, 25e3), Scalar::F32);
    let bend = number(&single, "bend_angle_rad");
    assert_eq!(f64::from(bend as f32), bend);
    assert!((bend / number(&there, "bend_angle_rad") - 1.0).abs() < 1e-5);
}

#[test]
fn limit_names_its_segment() {
    let answer = ask(&forward(json!([twister(), expander()]), 90e3), Scalar::F64);
    assert_eq!((&answer["status"], &answer["limit_segment"]), (&json!("no_solution"), &json!(1)));
    // 63.5 kPa: tabulated for this expansion actuator.
    assert!((number(&answer, "limit_pressure_pa") / 63.5e3 - 1.0).abs() < 0.02);
    assert!(answer["pressure_pa"].is_null() && answer["tip_position_m"].is_null());
    assert_eq!(answer["segments"], json!([]));
}

#[test]
fn errors_are_named_with_their_segment() {
    let with = |mut base: Value, key: &str, value: Value| {
        base[key] = value;
        base
    };
    let two = |second: Value| forward(json!([twister(), second]), 1e4);
    let bend = json!({"bend_angle_rad": 0.125});
    let cases = [
        (forward(json!([]), 1e4), "line 1: a series needs at least one segment"),
        (forward(json!(null), 1e4), "invalid type: null, expected an array"),
        (forward(json!([3]), 1e4), "expected an object"),
        (
            two(with(bender(), "outer_radius_m", json!(9e-3))),
            "segment 1: outer_radius_m = 0.009 is not allowed: that of the first",
        ),
        (two(with(bender(), "length_m", json!(-1))), "segment 1: length_m = -1 is not allowed: finite and > 0"),
        (two(with(bender(), "stiffness", json!(1))), "unknown field `stiffness`"),
        (two(with(bender(), "material", json!({"law": "yeoh"}))), "segment 1: `material.c_pa` is missing"),
        (
            two(with(
                expander(),
                "fiber",
                json!({"angle_deg": 100, "families": 2, "modulus_pa": 1, "thickness_m": 1e-4}),
            )),
            "segment 1: fiber.angle_deg = 100",
        ),
        (with(two(bender()), "motion", json!("bending")), "unknown field `motion`"),
        (
            with(two(bender()), "external_force_n", json!(1)),
            "external_force_n = 1 is not allowed: zero where straight and bending",
        ),
        (with(two(bender()), "target", bend.clone()), "a forward problem takes no `target`"),
        (
            inverse(json!([twister()]), bend.clone()),
            "bend_angle_rad = 0.125 is not allowed: a target of series with a bending segment",
        ),
        (inverse(json!([bender()]), json!({"axial_stretch": 1.1})), "unknown field `axial_stretch`"),
        (inverse(json!([bender()]), json!({})), "`target` must have exactly one field"),
        (json!({"id": 1, "segments": [bender()], "target": bend}), "missing field `problem`"),
    ];
    for (line, expected) in cases {
        for scalar in [Scalar::F64, Scalar::F32] {
            let answer = ask(&line, scalar);
            assert_eq!((&answer["status"], &answer["id"]), (&json!("invalid"), &line["id"]), "{line}");
            assert!(answer["message"].as_str().unwrap().contains(expected), "{expected}: {answer}");
        }
    }
    let twice = format!("{{\"problem\":\"forward\",\"segments\":[],\"segments\":[{}],\"pressure_pa\":1}}", bender());
    let mut out = Vec::new();
    batch(twice.as_bytes(), &mut out, Scalar::F64).unwrap();
    assert!(String::from_utf8(out).unwrap().contains("duplicate field `segments`"));
}

/// An `id` may hold anything, the word included.
#[test]
fn id_does_not_make_a_series() {
    let mut question = bender();
    question.as_object_mut().unwrap().remove("bend_direction_deg");
    question["id"] = json!({"segments": [1]});
    question["problem"] = json!("forward");
    question["pressure_pa"] = json!(1e4);
    let answer = ask(&question, Scalar::F64);
    assert_eq!((&answer["status"], &answer["id"]), (&json!("ok"), &question["id"]));
    assert!(answer["axial_stretch"].is_number());
}

/// `SeriesTarget` of the model and targets of the interface are the same three.
#[test]
fn targets_of_the_model_are_all_available() {
    for (target, field) in [
        (SeriesTarget::Extension(1e-3), "extension_m"),
        (SeriesTarget::Twist(-0.1), "twist_rad"),
        (SeriesTarget::BendAngle(0.2), "bend_angle_rad"),
    ] {
        let segments = actuators();
        let expected = Series::new(&segments).unwrap().inverse(target, &Load::none()).unwrap();
        let (SeriesTarget::Extension(value) | SeriesTarget::Twist(value) | SeriesTarget::BendAngle(value)) = target;
        let mut asked = json!({});
        asked[field] = json!(value);
        let answer = ask(&inverse(json!([bender(), twister()]), asked), Scalar::F64);
        assert_eq!(number(&answer, "pressure_pa"), expected.state.pressure_pa);
        assert!((number(&answer, field) / value - 1.0).abs() < 1e-12);
    }
}

/// A field of a line in place of another value.
fn with(mut line: Value, field: &str, value: Value) -> Value {
    line[field] = value;
    line
}

/// A bender with two families at 20 deg, whose analytic bend errs by more than 0.5 %.
fn wound_bender() -> Value {
    with(bender(), "fiber", json!({"angle_deg": 20, "families": 2, "modulus_pa": 2e8, "thickness_m": 1e-4}))
}

/// A segment as a question about one actuator.
fn alone(segment: &Value, pressure_pa: f64) -> Value {
    let mut line = segment.clone();
    line.as_object_mut().unwrap().remove("bend_direction_deg");
    with(with(line, "problem", json!("forward")), "pressure_pa", json!(pressure_pa))
}

#[test]
fn wound_segments_have_the_answers_of_single_actuators_with_models_and_errors() {
    let helices = json!([{"angle_deg": 30, "modulus_pa": 2e8, "thickness_m": 1e-4}, {"angle_deg": -10, "modulus_pa": 2e8, "thickness_m": 1e-4}]);
    let rod = json!([{"angle_deg": 30, "modulus_pa": 2e8, "thickness_m": 1e-4}, {"angle_deg": 90, "modulus_pa": 2e8, "thickness_m": 1e-4}]);
    let segments = [wound_bender(), with(twister(), "fiber", rod), with(bender(), "fiber", helices), bender()];
    let there = ask(&forward(json!(segments), 25e3), Scalar::F64);
    let models = [json!("section-fe"), json!(null), json!("section-fe"), json!(null)];
    let (mut bend, mut twist) = (0.0, 0.0);
    for ((segment, model), found) in segments.iter().zip(models).zip(there["segments"].as_array().unwrap()) {
        let single = ask(&alone(segment, 25e3), Scalar::F64);
        for field in
            ["axial_stretch", "inner_radius_m", "outer_radius_m", "twist_rad", "bend_angle_rad", "model", "errors"]
        {
            assert_eq!(found[field], single[field], "{field} of {found}");
        }
        assert_eq!(found["model"], model, "{found}");
        (bend, twist) = (bend + number(&single, "bend_angle_rad"), twist + number(&single, "twist_rad"));
    }
    assert_eq!((number(&there, "bend_angle_rad"), number(&there, "twist_rad")), (bend, twist));
    assert!(there["segments"][0]["errors"]["winding_2deg"].is_number() && there.get("residual").is_none(), "{there}");
    for field in ["extension_m", "twist_rad", "bend_angle_rad"] {
        let target = json!({field: there[field]});
        let back = ask(&inverse(json!(segments), target), Scalar::F64);
        assert_eq!(back["status"], "ok", "{back}");
        assert!((number(&back, "pressure_pa") / 25e3 - 1.0).abs() < 1e-9, "{back}");
        assert_eq!(back["segments"][0]["model"], "section-fe");
    }
}

#[test]
fn model_of_a_series_is_chosen_for_each_segment() {
    let line = forward(json!([wound_bender(), twister()]), 25e3);
    let bend = |line: &Value| number(&ask(line, Scalar::F64), "bend_angle_rad");
    let section = bend(&line);
    let analytic = ask(&with(line.clone(), "model", json!("analytic")), Scalar::F64);
    let off = number(&analytic, "bend_angle_rad") / section - 1.0;
    let stated = number(&analytic["segments"][0]["errors"], "model");
    assert!(off != 0.0 && off.abs() <= stated, "{off} {stated}");
    let tolerant = with(line.clone(), "tolerance", json!(0.5));
    assert_eq!(bend(&tolerant), number(&analytic, "bend_angle_rad"));
    // Without errors the analytic series is that of the library.
    let plain = ask(&with(with(line.clone(), "model", json!("analytic")), "errors", json!(false)), Scalar::F64);
    assert!(plain["segments"][0].get("errors").is_none() && plain["residual"].is_number(), "{plain}");
    assert!((number(&plain, "bend_angle_rad") / number(&analytic, "bend_angle_rad") - 1.0).abs() < 1e-14);
    let all = ask(&with(line.clone(), "errors", json!(true)), Scalar::F64);
    assert!(all["segments"].as_array().unwrap().iter().all(|one| one["errors"]["rounding"].is_number()), "{all}");
    for (line, message) in [
        (with(line.clone(), "tolerance", json!(-1)), "tolerance = -1 is not allowed: finite and > 0"),
        (
            with(with(line.clone(), "tolerance", json!(0.1)), "model", json!("analytic")),
            "`tolerance` is for `model` \"auto\"",
        ),
    ] {
        assert!(ask(&line, Scalar::F64)["message"].as_str().unwrap().contains(message), "{line}");
    }
    // Finite elements compute in double precision, the straight segment does not.
    for line in [line.clone(), with(line.clone(), "model", json!("section-fe"))] {
        let [single, double] = [Scalar::F32, Scalar::F64].map(|scalar| ask(&line, scalar));
        assert_eq!(single["segments"][0], double["segments"][0]);
        let segment = |answer: &Value| number(&answer["segments"][1], "twist_rad");
        assert!((segment(&single) / segment(&double) - 1.0).abs() < 1e-5, "{single} {double}");
        let target = json!({"twist_rad": double["twist_rad"]});
        let inverse = inverse(line["segments"].clone(), target);
        let inverse = with(inverse, "model", line.get("model").cloned().unwrap_or(json!("auto")));
        let [single, double] = [Scalar::F32, Scalar::F64].map(|scalar| number(&ask(&inverse, scalar), "pressure_pa"));
        assert!((single / double - 1.0).abs() < 1e-6, "{single} {double}");
    }
}

/// Beyond the limit pressure of a segment, the answer names this segment and its limit and states no bend.
#[test]
fn limit_of_finite_elements_names_its_segment() {
    let winding = json!({"angle_deg": 5, "families": 2, "modulus_pa": 2e8, "thickness_m": 1e-4});
    let soft = with(with(bender(), "material", json!("Ecoflex 00-30")), "fiber", winding);
    let answer = ask(&forward(json!([twister(), soft]), 40e3), Scalar::F64);
    let single = ask(&alone(&soft, 40e3), Scalar::F64);
    assert_eq!((&answer["status"], &answer["limit_segment"]), (&json!("no_solution"), &json!(1)), "{answer}");
    assert_eq!(answer["limit_pressure_pa"], single["limit_pressure_pa"]);
    assert!(answer["pressure_pa"].is_null() && answer["segments"] == json!([]), "{answer}");
}

#[test]
fn walls_beyond_the_test_of_their_elastomer_are_warned_of() {
    // The test ends at a stretch of 3.75.
    let tube = |segment: Value| with(segment, "outer_radius_m", json!(10e-3));
    let hoops = json!({"angle_deg": 3, "families": 2, "modulus_pa": 3.61e8, "thickness_m": 1.78e-4});
    let named = with(with(twister(), "motion", json!("extension")), "material", json!("Ecoflex 00-50"));
    let named = tube(with(named, "fiber", hoops));
    for (segments, index) in [(json!([named]), 0), (json!([tube(wound_bender()), named]), 1)] {
        let warnings = |pressure_pa: f64| {
            let answer = ask(&forward(segments.clone(), pressure_pa), Scalar::F64);
            assert_eq!(answer["status"], "ok", "{answer}");
            answer["warnings"].as_array().map_or_else(Vec::new, Clone::clone)
        };
        assert_eq!(warnings(60e3), Vec::<Value>::new());
        let [warning] = &warnings(82e3)[..] else { panic!("one warning") };
        let expected = format!("segment {index}: the wall stretches to ");
        assert!(warning.as_str().unwrap().starts_with(&expected), "{warning}");
    }
}
