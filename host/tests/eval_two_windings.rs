//! Two windings in the batch interface.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement};
use serde_json::{Value, json};
use softlimb::query::{Scalar, batch};

fn answer(fiber: &Value, changes: &[(&str, Value)], scalar: Scalar) -> Value {
    let mut line = json!({"motion": "twisting", "problem": "forward", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3,
        "length_m": 0.1, "material": {"law": "neo-hookean", "shear_modulus_pa": 0.2e6}, "pressure_pa": 50e3});
    line["fiber"] = fiber.clone();
    for (key, value) in changes {
        line[key] = value.clone();
    }
    let mut out = Vec::new();
    batch(line.to_string().as_bytes(), &mut out, scalar).expect("in memory");
    serde_json::from_slice(&out).expect("JSON")
}

fn thread(angle_deg: f64) -> Value {
    json!({"angle_deg": angle_deg, "modulus_pa": 200e6, "thickness_m": 1e-4})
}

fn number(answer: &Value, field: &str) -> f64 {
    answer[field].as_f64().unwrap_or_else(|| panic!("{field} of {answer}"))
}

#[test]
fn list_of_two_is_the_tube_with_both() {
    let helix = Fiber {
        angle_rad: -30.0_f64.to_radians(),
        families: Families::One,
        modulus_pa: 200e6,
        placement: Placement::Sheet,
        thickness_m: 1e-4,
        radius_m: 8e-3,
    };
    let parameters = ActuatorParameters {
        motion: Motion::Twisting,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.1,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: Some(helix),
    };
    let axial = Fiber { angle_rad: 90.0_f64.to_radians(), ..helix };
    let load = Load { force_n: 1.0, torque_nm: 2e-3 };
    let exact = Actuator::new(&parameters)
        .and_then(|tube| tube.with_second_fiber(&axial))
        .expect("valid")
        .forward(50e3, &load)
        .expect("finite")
        .state;
    let loads = [("external_force_n", json!(1.0)), ("external_torque_nm", json!(2e-3))];
    let found = answer(&json!([thread(-30.0), thread(90.0)]), &loads, Scalar::F64);
    assert_eq!(number(&found, "twist_rad"), exact.twist_rad);
    assert_eq!(number(&found, "axial_stretch"), exact.axial_stretch);
    let single = answer(&json!([thread(-30.0), thread(90.0)]), &loads, Scalar::F32);
    let twist = number(&single, "twist_rad");
    assert!((twist / exact.twist_rad - 1.0).abs() < 1e-5 && twist != exact.twist_rad, "{single}");
}

#[test]
fn mirrored_pair_is_two_families_and_a_list_of_one_is_its_winding() {
    let extends = [("motion", json!("extension")), ("pressure_pa", json!(20e3))];
    let pair = answer(&json!([thread(10.0), thread(-10.0)]), &extends, Scalar::F64);
    let mut both = thread(10.0);
    both["families"] = json!(2);
    let both = answer(&both, &extends, Scalar::F64);
    assert!((number(&pair, "axial_stretch") - number(&both, "axial_stretch")).abs() < 1e-9, "{pair} {both}");
    let mut one = thread(30.0);
    one["families"] = json!(1);
    let twists = [("pressure_pa", json!(20e3))];
    assert_eq!(answer(&json!([thread(30.0)]), &twists, Scalar::F64), answer(&one, &twists, Scalar::F64));
}

#[test]
fn inverse_leads_back() {
    let fiber = json!([thread(30.0), thread(90.0)]);
    let twist = number(&answer(&fiber, &[], Scalar::F64), "twist_rad");
    let changes =
        [("problem", json!("inverse")), ("pressure_pa", Value::Null), ("target", json!({"twist_rad": twist}))];
    let found = answer(&fiber, &changes, Scalar::F64);
    assert!((number(&found, "pressure_pa") / 50e3 - 1.0).abs() < 1e-9, "{found}");
}

#[test]
fn errors_name_the_winding() {
    let with = |field: &str, value: Value| {
        let mut thread = thread(90.0);
        thread[field] = value;
        thread
    };
    let good = thread(30.0);
    let cases = [
        (json!([good, thread(95.0)]), vec![], "fiber, second winding: angle_deg = 95 is not allowed: -90 to 90"),
        (json!([thread(-91.0), good]), vec![], "fiber, first winding: angle_deg = -91 is not allowed"),
        (json!([good, with("modulus_pa", json!(-1))]), vec![], "fiber, second winding: modulus_pa = -1 is not"),
        (json!([good, with("radius_m", json!(9e-3))]), vec![], "fiber, second winding: radius_m = 0.009 is not"),
        (json!([good, with("thickness_m", Value::Null)]), vec![], "fiber, second winding: `thickness_m` is missing"),
        (json!([good, with("families", json!(3))]), vec![], "fiber, second winding: families = 3 is not allowed"),
        (json!([]), vec![], "fiber has 0 windings: 1 or 2 are allowed"),
        (json!([good, good, good]), vec![], "fiber has 3 windings"),
        (json!([good, with("pitch", json!(1))]), vec![], "unknown field `pitch`"),
        (
            json!([good, good]),
            vec![("motion", json!("bending")), ("model", json!("analytic"))],
            "`motion` \"bending\" with `model` \"analytic\" takes one winding",
        ),
        (
            json!([good, with("thickness_m", Value::Null)]),
            vec![("motion", json!("bending"))],
            "fiber, second winding: `thickness_m` is missing",
        ),
    ];
    for (fiber, changes, expected) in cases {
        for scalar in [Scalar::F64, Scalar::F32] {
            let answer = answer(&fiber, &changes, scalar);
            assert_eq!(answer["status"], "invalid", "{fiber}");
            assert!(answer["message"].as_str().is_some_and(|message| message.contains(expected)), "{answer}");
        }
    }
}

#[test]
fn errors_come_with_two_windings() {
    let errors = ("errors", json!(true));
    for (changes, discretised, is_bender) in [
        (vec![errors.clone()], false, false),
        (vec![errors.clone(), ("model", json!("section-fe"))], true, false),
        (vec![errors.clone(), ("motion", json!("bending")), ("pressure_pa", json!(20e3))], true, true),
    ] {
        let fiber = json!([thread(-10.0), thread(15.0)]);
        let found = answer(&fiber, &changes, Scalar::F64);
        let error = |field: &str| found["errors"][field].as_f64();
        assert!(error("rounding").is_some_and(|error| error > 1e-16 && error < 1e-8), "{found}");
        assert_eq!(error("model"), Some(0.0), "{found}");
        assert!(error("discretisation").is_some_and(|error| (error > 0.0) == discretised && error < 1e-3), "{found}");
        let off = error("winding_2deg");
        assert_eq!(off.is_some_and(|off| (1e-3..0.2).contains(&off)), is_bender, "{found}");
        if is_bender {
            // Both windings farther from the hoop bend less.
            let wider = answer(&json!([thread(-12.0), thread(17.0)]), &changes, Scalar::F64);
            let change = (number(&wider, "bend_angle_rad") / number(&found, "bend_angle_rad") - 1.0).abs();
            assert!(off.is_some_and(|off| off >= change * (1.0 - 1e-9)), "{found} {wider}");
        }
    }
}

#[test]
fn every_solution_leads_to_the_target() {
    let fiber = json!([thread(30.0), thread(60.0)]);
    let twist = number(&answer(&fiber, &[], Scalar::F64), "twist_rad");
    let changes = [
        ("problem", json!("inverse")),
        ("pressure_pa", Value::Null),
        ("target", json!({"twist_rad": twist})),
        ("pressure_range", json!([-5e4, 2e5])),
        ("solutions", json!("all")),
    ];
    for (scalar, within) in [(Scalar::F64, 1e-9), (Scalar::F32, 1e-3)] {
        let found = answer(&fiber, &[&changes[..], &[("errors", json!(true))]].concat(), scalar);
        assert!(number(&found["errors"], "rounding") < 0.1 * within, "{found}");
        let solutions = found["solutions"].as_array().expect("a list");
        assert!(!solutions.is_empty() && found["solutions_complete"] == true, "{found}");
        assert!(solutions.iter().any(|one| (number(one, "pressure_pa") / 50e3 - 1.0).abs() < within), "{found}");
        for one in solutions {
            let back = answer(&fiber, &[("pressure_pa", one["pressure_pa"].clone())], Scalar::F64);
            assert!((number(&back, "twist_rad") / twist - 1.0).abs() < within, "{one} {back}");
        }
    }
    let bends = [&changes[..], &[("motion", json!("bending")), ("target", json!({"bend_angle_rad": 0.1}))]].concat();
    let refused = answer(&fiber, &[&bends[..], &[("model", json!("analytic"))]].concat(), Scalar::F64);
    let words = "`motion` \"bending\" with `model` \"analytic\" takes one winding";
    assert!(refused["message"].as_str().is_some_and(|message| message.contains(words)), "{refused}");
}

#[test]
fn finite_elements_answer_like_the_analytic_model() {
    let fiber = json!([thread(-30.0), thread(90.0)]);
    let exact = answer(&fiber, &[], Scalar::F64);
    let section_fe = ("model", json!("section-fe"));
    let found = answer(&fiber, std::slice::from_ref(&section_fe), Scalar::F64);
    for field in ["twist_rad", "outer_radius_m"] {
        assert!((number(&found, field) / number(&exact, field) - 1.0).abs() < 1e-5, "{found} {exact}");
    }
    let twist = json!({"twist_rad": number(&found, "twist_rad")});
    let inverse = [("problem", json!("inverse")), ("pressure_pa", Value::Null), ("target", twist), section_fe];
    let back = answer(&fiber, &inverse, Scalar::F64);
    assert!((number(&back, "pressure_pa") / 50e3 - 1.0).abs() < 1e-6, "{back}");
    assert_eq!(answer(&fiber, &[("model", json!("section-fe"))], Scalar::F32), found);
}

/// Different windings make a bending actuator twist: finite elements say by how much.
#[test]
fn bending_actuator_also_twists() {
    let bends = [("motion", json!("bending")), ("pressure_pa", json!(30e3))];
    let fiber = json!([thread(5.0), thread(-10.0)]);
    let found = answer(&fiber, &bends, Scalar::F64);
    assert_eq!((&found["status"], &found["model"]), (&json!("ok"), &json!("section-fe")), "{found}");
    let [bend, twist] = ["bend_angle_rad", "twist_rad"].map(|field| number(&found, field));
    assert!(bend > 0.5 && twist > 0.05, "{found}");
    let mirrored = answer(&json!([thread(5.0), thread(-5.0)]), &bends, Scalar::F64);
    assert_eq!(number(&mirrored, "twist_rad"), 0.0, "{mirrored}");
    let target = json!({"bend_angle_rad": bend});
    let inverse =
        [("motion", json!("bending")), ("problem", json!("inverse")), ("pressure_pa", Value::Null), ("target", target)];
    let back = answer(&fiber, &inverse, Scalar::F64);
    assert!((number(&back, "pressure_pa") / 30e3 - 1.0).abs() < 1e-6, "{back}");
    assert_eq!(answer(&fiber, &bends, Scalar::F32), found);
    let all = answer(&fiber, &[&inverse[..], &[("solutions", json!("all"))]].concat(), Scalar::F64);
    let solutions = all["solutions"].as_array().unwrap();
    assert_eq!((solutions.len(), &solutions[0]["pressure_pa"]), (1, &all["pressure_pa"]), "{all}");
    assert!((number(&all, "pressure_pa") / number(&back, "pressure_pa") - 1.0).abs() < 1e-9, "{all} {back}");
    assert!(number(&solutions[0], "twist_rad").abs() > 0.05 && all["solutions_complete"] == false, "{all}");
}
