//! `eval`: batches line by line, and the curves of a scene. What the numbers are is tested where they are computed.

use serde_json::Value;

use crate::cli::desk::Desk;

const GOOD: &str = r#"{"id":"a","motion":"bending","problem":"forward","inner_radius_m":0.006,"outer_radius_m":0.008,"length_m":0.1,"material":{"law":"neo-hookean","shear_modulus_pa":2e5},"pressure_pa":3e4}"#;

/// Good, cut off, blank, not JSON, good in another way, and the wrong type.
fn questions() -> String {
    let inside_out = GOOD.replace("0.006", "0.009").replace("\"a\"", "7");
    [GOOD, "{\"id\":1", "", "garbage", &inside_out, "[1, 2]", &GOOD.replace("\"a\"", "null"), ""].join("\n")
}

fn answers(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("one JSON object a line")).collect()
}

fn statuses(text: &str) -> Vec<(Value, String)> {
    let pair = |answer: Value| (answer["id"].clone(), answer["status"].as_str().expect("a status").to_owned());
    answers(text).into_iter().map(pair).collect()
}

#[test]
fn good_and_bad_lines_are_answered_in_order() {
    let desk = Desk::new();
    desk.put("questions.jsonl", questions());
    let answer = desk.softlimb("eval --batch questions.jsonl").done();
    let expected = [("a", "ok"), ("", "invalid"), ("", "invalid"), ("7", "invalid"), ("", "invalid"), ("", "ok")];
    let told = statuses(&answer.out);
    assert_eq!(told.len(), expected.len(), "{}", answer.out);
    for ((id, status), (wanted_id, wanted)) in told.iter().zip(expected) {
        let id = if id.is_null() { String::new() } else { id.to_string().replace('"', "") };
        assert_eq!((id.as_str(), status.as_str()), (wanted_id, wanted), "{}", answer.out);
    }
    // The message counts lines of the file, the blank one included.
    assert!(answers(&answer.out)[2]["message"].as_str().unwrap().starts_with("line 4"), "{}", answer.out);
}

#[test]
fn standard_input_is_a_file_like_any_other() {
    let desk = Desk::new();
    desk.put("questions.jsonl", questions());
    let from_file = desk.softlimb("eval --batch questions.jsonl").done();
    let from_input = desk.softlimb_reading("eval --batch -", questions().as_bytes()).done();
    assert_eq!(from_file.out, from_input.out);
    assert_eq!(desk.softlimb("eval --batch -").done().out, "");
}

#[test]
fn single_precision_is_near_to_double_and_not_the_same() {
    let desk = Desk::new();
    let bend = |scalar: &str| {
        let answer = desk.softlimb_reading(&format!("eval --batch - --scalar {scalar}"), GOOD.as_bytes()).done();
        answer.json()["bend_angle_rad"].as_f64().unwrap()
    };
    let (double, single) = (bend("f64"), bend("f32"));
    assert!(double != single && (double / single - 1.0).abs() < 1e-5, "{double} {single}");
}

#[test]
fn batch_that_cannot_be_read() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("folder")).unwrap();
    desk.softlimb("eval --batch missing.jsonl").failed(1, &["cannot read missing.jsonl"]);
    desk.softlimb("eval --batch folder").failed(1, &["folder"]);
}

#[test]
fn lines_that_are_not_utf_8_are_invalid_and_the_next_is_answered() {
    let desk = Desk::new();
    desk.put("questions.jsonl", [b"\xff\xfe\n", GOOD.as_bytes()].concat());
    let told = statuses(&desk.softlimb("eval --batch questions.jsonl").done().out);
    assert_eq!(told.iter().map(|(_, status)| status.as_str()).collect::<Vec<_>>(), ["invalid", "ok"]);
}

#[test]
fn curves_start_at_rest_and_end_at_the_highest_pressure() {
    let desk = Desk::with_scene("small", "small");
    let json = desk.softlimb("eval scene.toml --json --steps 4").done().json();
    let points = json["curves"][0]["points"].as_array().unwrap();
    let pressures: Vec<f64> = points.iter().map(|point| point["pressure_pa"].as_f64().unwrap()).collect();
    // The scene names no limit of its own; that of the reference is 100 kPa.
    assert_eq!(pressures, [0.0, 25e3, 50e3, 75e3, 100e3]);
    assert_eq!(points[0]["bend_angle_rad"], 0.0);
    assert!(points.windows(2).all(|pair| pair[0]["bend_angle_rad"].as_f64() < pair[1]["bend_angle_rad"].as_f64()));
    let table = desk.softlimb("eval scene.toml --steps 4").done();
    // A heading of three lines and five points.
    assert_eq!(table.out.lines().count(), 8, "{}", table.out);
}
