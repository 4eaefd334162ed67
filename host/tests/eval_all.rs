//! Every solution by finite elements, against their curve on a finer mesh.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde_json::{Value, json};
use softlimb::query::{Scalar, batch};

use crate::eval_reference::states;

fn ask(line: &Value) -> Value {
    let mut out = Vec::new();
    batch(line.to_string().as_bytes(), &mut out, Scalar::F64).expect("in memory");
    serde_json::from_slice(&out).expect("JSON")
}

fn with(mut base: Value, changes: Value) -> Value {
    for (field, value) in changes.as_object().expect("fields") {
        base[field] = value.clone();
    }
    base
}

fn number(answer: &Value, field: &str) -> f64 {
    answer[field].as_f64().unwrap_or_else(|| panic!("no {field} in {answer}"))
}

fn pressures_pa(answer: &Value) -> Vec<f64> {
    let solutions = answer["solutions"].as_array().unwrap_or_else(|| panic!("{answer}"));
    solutions.iter().map(|one| number(one, "pressure_pa")).collect()
}

/// A bender of silicone with this winding.
fn bender(outer_radius_m: f64, fiber: &Value) -> Value {
    json!({"id": 1, "motion": "bending", "problem": "inverse", "inner_radius_m": 6e-3, "outer_radius_m": outer_radius_m, "length_m": 0.1,
        "material": {"law": "neo-hookean", "shear_modulus_pa": 2e5}, "fiber": fiber, "solutions": "all"})
}

/// Windings beyond 35 deg first shorten a tube under pressure and later lengthen it: a bend under a moment falls, then rises.
#[test]
fn bend_that_falls_and_rises_has_two_solutions() {
    let mut random = ChaCha8Rng::seed_from_u64(44);
    let mut uniform = |low: f64, high: f64| low + (high - low) * f64::from(random.next_u32()) / 4_294_967_296.0;
    let mut benders: Vec<Value> = (0..6)
        .map(|_| {
            let (angle_deg, modulus_pa) = (uniform(42.0, 48.0), 10_f64.powf(uniform(6.5, 7.2)));
            let fiber = json!({"angle_deg": angle_deg, "families": 2, "modulus_pa": modulus_pa, "thickness_m": 1e-4});
            bender(6e-3 * (1.0 + uniform(0.3, 0.8)), &fiber)
        })
        .collect();
    let helices = [(53.0, 2.7e5), (-49.0, 1.3e8)];
    let helix =
        |(angle_deg, modulus_pa)| json!({"angle_deg": angle_deg, "modulus_pa": modulus_pa, "thickness_m": 1e-4});
    benders.push(bender(7.5e-3, &json!(helices.map(helix))));
    let reference_pa: Vec<f64> = (0..=24).map(|n| 1e6 * (f64::from(n) / 24.0).powi(2)).collect();
    let mut count = 0;
    for line in benders {
        // A bend of less than 1 rad: about the line that keeps its length a section has I + A R^2.
        let [inner, outer] = [6e-3, number(&line, "outer_radius_m")].map(|radius: f64| radius * radius);
        let area = std::f64::consts::PI * (outer - inner);
        let moment_nm = 3.0 * 2e5 * area * (0.25 * (outer + inner) + outer) * 6.0;
        let line = with(line, json!({"external_torque_nm": moment_nm, "pressure_range": [0.0, 1e6]}));
        let bends: Vec<f64> =
            states(&line, &reference_pa).iter().map_while(|state| Some(state.as_ref()?.bend_angle_rad)).collect();
        // A moment may be more than a thin wall carries.
        let Some(start) = bends.first() else { continue };
        let least = bends.iter().copied().fold(f64::INFINITY, f64::min);
        let target = 0.8 * start + 0.2 * least;
        let crossings: Vec<usize> =
            (1..bends.len()).filter(|n| (bends[n - 1] - target) * (bends[*n] - target) < 0.0).collect();
        // Some saturate below it.
        if crossings.len() != 2 || target < 0.0 {
            println!("{target} {crossings:?} {bends:.3?}");
            continue;
        }
        count += 1;
        let answer = ask(&with(line.clone(), json!({"target": {"bend_angle_rad": target}})));
        let found_pa = pressures_pa(&answer);
        println!("{target:.4} {found_pa:.1?} {bends:.4?}");
        assert_eq!(
            (&answer["status"], &answer["model"], found_pa.len()),
            (&json!("ok"), &json!("section-fe"), 2),
            "{answer}"
        );
        // Samples cannot exclude more.
        assert_eq!((number(&answer, "pressure_pa"), &answer["solutions_complete"]), (found_pa[0], &json!(false)));
        for ((pressure_pa, crossing), state) in found_pa.iter().zip(&crossings).zip(states(&line, &found_pa)) {
            let [low, high] = [reference_pa[crossing - 1], reference_pa[*crossing]];
            assert!((0.98 * low..=1.02 * high).contains(pressure_pa), "{pressure_pa} {low} {high}");
            let off = (state.expect("on the curve").bend_angle_rad / target - 1.0).abs();
            println!("  {pressure_pa:.1} {off:.1e}");
            assert!(off < 5e-3, "{off} {answer}");
        }
        let ordinary = ask(&with(line.clone(), json!({"target": {"bend_angle_rad": target}, "solutions": "first"})));
        let is_same = |found: &f64| (number(&ordinary, "pressure_pa") / found - 1.0).abs() < 1e-6;
        assert!(found_pa.iter().any(is_same), "{ordinary} {answer}");
        let between = json!([0.5 * (found_pa[0] + found_pa[1]), 1e6]);
        let last = ask(&with(line, json!({"target": {"bend_angle_rad": target}, "pressure_range": between})));
        assert!(pressures_pa(&last).iter().all(|found| (found / found_pa[1] - 1.0).abs() < 1e-8), "{last}");
        assert_eq!(pressures_pa(&last).len(), 1, "{last}");
    }
    assert_eq!(count, 7);
}

/// Without load the bend is zero at rest, negative, zero again, positive.
#[test]
fn bend_that_comes_back_to_zero_has_two_solutions() {
    let fiber = json!({"angle_deg": 45, "families": 2, "modulus_pa": 1e7, "thickness_m": 1e-4});
    let line = with(bender(9.35e-3, &fiber), json!({"target": {"bend_angle_rad": 0.0}, "pressure_range": [0.0, 1e6]}));
    let answer = ask(&line);
    let found_pa = pressures_pa(&answer);
    assert!(
        found_pa.len() == 2 && found_pa[0].abs() < 1e-3 && number(&answer, "pressure_pa") == found_pa[0],
        "{answer}"
    );
    for target in [0.1, 0.5, 1.5] {
        let line = with(line.clone(), json!({"target": {"bend_angle_rad": target}}));
        let [all, ordinary] =
            ["all", "first"].map(|solutions| ask(&with(line.clone(), json!({"solutions": solutions}))));
        assert_eq!((pressures_pa(&all).len(), &ordinary["status"]), (1, &json!("ok")), "{all} {ordinary}");
        assert!((number(&all, "pressure_pa") / number(&ordinary, "pressure_pa") - 1.0).abs() < 1e-9, "{ordinary}");
    }
    let around = states(&line, &[0.5 * found_pa[1], 0.99 * found_pa[1], 1.01 * found_pa[1]]);
    let bends: Vec<f64> = around.iter().map(|state| state.as_ref().expect("an equilibrium").bend_angle_rad).collect();
    assert!(bends[0] < -0.1 && bends[1] < 0.0 && bends[2] > 0.0, "{bends:?} {answer}");
}

#[test]
fn only_solution_is_that_of_the_ordinary_question() {
    let mut random = ChaCha8Rng::seed_from_u64(45);
    let mut uniform = |low: f64, high: f64| low + (high - low) * f64::from(random.next_u32()) / 4_294_967_296.0;
    for model in ["auto", "auto", "auto", "auto", "section-fe", "section-fe"] {
        let fiber = json!({"angle_deg": uniform(3.0, 25.0), "families": 2, "modulus_pa": 1e8, "thickness_m": 1e-4});
        let target = json!({"bend_angle_rad": uniform(0.2, 2.0)});
        let line = bender(6e-3 * (1.0 + uniform(0.2, 0.9)), &fiber);
        let line = with(line, json!({"target": target, "model": model, "pressure_range": [0.0, 1e6]}));
        let (mut all, first) = (ask(&line), ask(&with(line.clone(), json!({"solutions": "first"}))));
        assert_eq!((&all["status"], &all["model"]), (&json!("ok"), &json!("section-fe")), "{all}");
        let found_pa = pressures_pa(&all);
        assert!(found_pa.len() == 1 && all["solutions_complete"] == false, "{all}");
        assert!((found_pa[0] / number(&first, "pressure_pa") - 1.0).abs() < 1e-9, "{all} {first}");
        all.as_object_mut().unwrap().retain(|field, _| first.get(field).is_some());
        assert_eq!(all.as_object().unwrap().len(), first.as_object().unwrap().len(), "{all} {first}");
        // Within a generous tolerance both are analytic.
        if model == "auto" {
            let tolerant = json!({"tolerance": 0.9});
            let [all, first] = [json!({}), json!({"solutions": "first"})]
                .map(|change| ask(&with(with(line.clone(), tolerant.clone()), change)));
            assert_eq!((&all["model"], &all["errors"]), (&json!("analytic"), &first["errors"]), "{all} {first}");
            assert_eq!(
                (pressures_pa(&all), &all["solutions_complete"]),
                (vec![number(&first, "pressure_pa")], &json!(true))
            );
        }
    }
}

/// A weak winding at 45 deg first shortens the tube and then lengthens it. The reference is the analytic search.
#[test]
fn straight_tubes_have_the_analytic_solutions_without_the_vacuums() {
    let fiber = json!({"angle_deg": 45, "families": 2, "modulus_pa": 0.1e6, "thickness_m": 0.2e-3});
    let line = with(bender(8e-3, &fiber), json!({"motion": "extension", "pressure_range": [-1e5, 3e4]}));
    let forward = json!({"problem": "forward", "pressure_pa": 500, "solutions": null, "pressure_range": null});
    let line = with(line.clone(), json!({"target": {"axial_stretch": ask(&with(line, forward))["axial_stretch"]}}));
    let [exact, found] = ["analytic", "section-fe"].map(|model| ask(&with(line.clone(), json!({"model": model}))));
    let exact_pa: Vec<f64> = pressures_pa(&exact).into_iter().filter(|pressure_pa| *pressure_pa >= 0.0).collect();
    let found_pa = pressures_pa(&found);
    assert_eq!((found_pa.len(), exact_pa.len()), (2, 2), "{exact} {found}");
    for (found, exact) in found_pa.iter().zip(&exact_pa) {
        assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
    }
    assert_eq!((&exact["solutions_complete"], &found["solutions_complete"]), (&json!(true), &json!(false)));
}

/// Beyond the end of the curve there cannot be a solution; between samples and in a vacuum there can.
#[test]
fn solutions_are_complete_beyond_the_limit_alone() {
    let fiber = json!({"angle_deg": 5, "families": 2, "modulus_pa": 2e8, "thickness_m": 1e-4});
    let soft = with(bender(8e-3, &fiber), json!({"material": {"law": "yeoh", "c_pa": [1e5, 0.0, -1e3]}}));
    let forward = json!({"problem": "forward", "pressure_pa": 1e6, "solutions": null, "model": "section-fe"});
    let limit_pa = number(&ask(&with(soft.clone(), forward)), "limit_pressure_pa");
    let asked = |range: Value| {
        let answer = ask(&with(soft.clone(), json!({"target": {"bend_angle_rad": 80.0}, "pressure_range": range})));
        assert_eq!((&answer["status"], &answer["solutions"]), (&json!("no_solution"), &json!([])), "{answer}");
        (answer["solutions_complete"] == true, answer.get("limit_pressure_pa").map(|limit| limit.as_f64().unwrap()))
    };
    let near = |limit: Option<f64>| limit.is_some_and(|limit| (limit / limit_pa - 1.0).abs() < 1e-3);
    let beyond = asked(json!([1.1 * limit_pa, 2.0 * limit_pa]));
    assert!(beyond.0 && near(beyond.1), "{beyond:?} {limit_pa}");
    let across = asked(json!([0.9 * limit_pa, 2.0 * limit_pa]));
    assert!(!across.0 && near(across.1), "{across:?}");
    assert_eq!(asked(json!([0.0, 0.5 * limit_pa])), (false, None));
    assert_eq!(asked(json!([-1e5, -1e3])), (false, None));
}
