//! What a user sees when a scene is wrong, in full.

use crate::scene_support::{SCENE, changed, picture};
use softlimb_scene::parse;

#[test]
fn scene_that_the_other_tests_break_is_right() {
    parse(SCENE, "arm.toml").unwrap();
}

#[test]
fn unknown_key() {
    assert_eq!(
        picture("inner_radius", "inner_radus"),
        r#"error: unknown key `inner_radus` in `[[module]]`
  --> arm.toml:22:1
   |
22 | inner_radus = "10 mm"
   | ^^^^^^^^^^^ unknown key
   |
   = help: did you mean `inner_radius`?"#
    );
    assert_eq!(
        picture("seed = 7", "color = \"red\""),
        r#"error: unknown key `color`
 --> arm.toml:3:1
  |
3 | color = "red"
  | ^^^^^ unknown key
  |
  = help: known keys: format, name, description, seed, materials, windings, limb, module, phase, markers, corrections, obstacle, region, object, design, limits, controller, weight, swing, camera, imu, plant"#
    );
}

#[test]
fn wrong_unit() {
    assert_eq!(
        picture("\"10 mm\"", "\"10 milimeter\""),
        r#"error: unknown unit `milimeter` of `inner_radius`
  --> arm.toml:22:16
   |
22 | inner_radius = "10 milimeter"
   |                ^^^^^^^^^^^^^^ unknown unit
   |
   = help: units of a length: m, dm, cm, mm, um, nm, in"#
    );
    assert_eq!(
        picture("0.2 MPa", "0.2 Mpa"),
        r#"error: unknown unit `Mpa` of `shear_modulus`
 --> arm.toml:7:17
  |
7 | shear_modulus = "0.2 Mpa"
  |                 ^^^^^^^^^ unknown unit
  |
  = help: did you mean `MPa`?"#
    );
}

#[test]
fn wrong_dimension() {
    assert_eq!(
        picture("\"10 mm\"", "\"10 kPa\""),
        r#"error: `inner_radius` needs a length
  --> arm.toml:22:16
   |
22 | inner_radius = "10 kPa"
   |                ^^^^^^^^ this is a pressure
   |
   = help: units of a length: m, dm, cm, mm, um, nm, in"#
    );
}

#[test]
fn number_meant_in_another_unit() {
    assert_eq!(
        picture("\"240 mm\"", "240"),
        r#"error: `length` must be from 5 mm to 5000 mm
  --> arm.toml:24:10
   |
24 | length = 240
   |          ^^^ this is 240 m
   |
   = help: a number without a unit is in m; write "240 mm"?"#
    );
}

#[test]
fn plain_number_meant_in_grams() {
    let picture = picture("[[phase]]", "[[phase]]\npayload = 600");
    assert!(picture.contains("`payload` must be from 0 kg to 100 kg"), "{picture}");
    assert!(picture.ends_with("= help: a number without a unit is in kg; write \"600 g\"?"), "{picture}");
}

#[test]
fn decimal_comma() {
    assert_eq!(
        picture("\"240 mm\"", "\"20,5 mm\""),
        r#"error: `length` needs a length
  --> arm.toml:24:10
   |
24 | length = "20,5 mm"
   |          ^^^^^^^^^ a decimal comma
   |
   = help: write a point, not a comma: "20.5 mm""#
    );
}

#[test]
fn not_a_number() {
    assert_eq!(
        picture("\"240 mm\"", "nan"),
        r#"error: `length` needs a length
  --> arm.toml:24:10
   |
24 | length = nan
   |          ^^^ not a finite number"#
    );
    assert_eq!(
        picture("\"240 mm\"", "true"),
        r#"error: `length` must be a length: a number or a string with a unit
  --> arm.toml:24:10
   |
24 | length = true
   |          ^^^^ this is a boolean"#
    );
    assert_eq!(
        picture("\"240 mm\"", "\"240\""),
        r#"error: `length` needs a length
  --> arm.toml:24:10
   |
24 | length = "240"
   |          ^^^^^ a string needs a unit
   |
   = help: write "240 mm"? units of a length: m, dm, cm, mm, um, nm, in"#
    );
}

#[test]
fn inner_radius_above_outer() {
    assert_eq!(
        picture("\"10 mm\"", "\"15 mm\""),
        r#"error: `inner_radius` must be below `outer_radius`
  --> arm.toml:22:16
   |
22 | inner_radius = "15 mm"
   |                ^^^^^^^ the inner radius is 15 mm
23 | outer_radius = "14 mm"
   |                ------- the outer radius is 14 mm"#
    );
}

#[test]
fn negative_length() {
    assert_eq!(
        picture("\"240 mm\"", "\"-240 mm\""),
        r#"error: `length` must be from 5 mm to 5000 mm
  --> arm.toml:24:10
   |
24 | length = "-240 mm"
   |          ^^^^^^^^^ this is -240 mm"#
    );
}

#[test]
fn missing_key() {
    assert_eq!(
        picture("length = \"240 mm\"\n", "\n"),
        r#"error: missing key `length` in `[[module]]`
  --> arm.toml:17:1
   |
17 | [[module]]
   | ^^^^^^^^^^ `length` is required"#
    );
    assert_eq!(picture("name = \"arm\"\n", ""), "error: missing key `name`\n--> arm.toml");
}

#[test]
fn duplicate_module_name() {
    assert_eq!(
        picture("name = \"elbow\"\nmotion", "name = \"upper\"\nmotion").split("\n\n").next().unwrap(),
        r#"error: there are two modules named `upper`
  --> arm.toml:29:8
   |
18 | name = "upper"
   |        ------- the first one
...
29 | name = "upper"
   |        ^^^^^^^ the second one"#
    );
}

#[test]
fn unknown_material() {
    assert_eq!(
        picture("material = \"silicone\"", "material = \"silicon\""),
        r#"error: unknown material `silicon`
  --> arm.toml:25:12
   |
25 | material = "silicon"
   |            ^^^^^^^^^ no such material
   |
   = help: did you mean `silicone`?"#
    );
}

#[test]
fn target_for_an_unknown_module() {
    assert_eq!(
        picture("elbow = { bend_angle = \"40 deg\" }", "wrist = { bend_angle = \"40 deg\" }"),
        r#"error: target for the unknown module `wrist`
  --> arm.toml:41:46
   |
41 | targets = { upper = { axial_stretch = 1.1 }, wrist = { bend_angle = "40 deg" } }
   |                                              ^^^^^ no such module
   |
   = help: known modules: elbow, upper"#
    );
}

#[test]
fn target_that_does_not_fit_the_motion() {
    assert_eq!(
        picture("axial_stretch = 1.1", "twist = \"20 deg\""),
        r#"error: `twist` does not fit the module `upper`
  --> arm.toml:41:23
   |
19 | motion = "extension"
   |          ----------- because of its motion
...
41 | targets = { upper = { twist = "20 deg" }, elbow = { bend_angle = "40 deg" } }
   |                       ^^^^^ `upper` has no such target
   |
   = help: use one of `axial_stretch`, `pressure`"#
    );
}

#[test]
fn targets_in_different_quantities() {
    assert_eq!(
        picture("upper = { axial_stretch = 1.2 }", "upper = { pressure = \"40 kPa\" }"),
        r#"error: the targets of `upper` are in different quantities
  --> arm.toml:46:23
   |
41 | targets = { upper = { axial_stretch = 1.1 }, elbow = { bend_angle = "40 deg" } }
   |                       ------------- another quantity here
...
46 | targets = { upper = { pressure = "40 kPa" } }
   |                       ^^^^^^^^ `pressure` here
   |
   = help: use the same one in all phases"#
    );
}

#[test]
fn duration_that_is_none() {
    for (text, shown) in [("0 s", "0 s"), ("-1 s", "-1 s"), ("0.01 s", "0.01 s")] {
        let expected = format!(
            r#"error: `duration` must be from 0.02 s to 600 s
  --> arm.toml:40:12
   |
40 | duration = "{text}"
   |            {} this is {shown}"#,
            "^".repeat(text.len() + 2)
        );
        assert_eq!(picture("\"3 s\"", &format!("\"{text}\"")), expected);
    }
}

#[test]
fn too_many_channels() {
    let wide = |text: &str| {
        text.replace("actuators = 3\ncircle_radius = \"30 mm\"", "actuators = 9\ncircle_radius = \"50 mm\"")
    };
    let elbow = SCENE.find("[[module]]\nname = \"elbow\"").unwrap();
    let end = SCENE.find("[[phase]]").unwrap();
    let more: String = (1..=2).map(|i| SCENE[elbow..end].replace("\"elbow\"", &format!("\"extra-{i}\""))).collect();
    let text = wide(&format!("{}{more}{}", &SCENE[..end], &SCENE[end..]));
    assert_eq!(
        parse(&text, "arm.toml").unwrap_err().render(false),
        r#"error: too many actuators: a controller has 27 channels
  --> arm.toml:51:13
   |
51 | actuators = 9
   |             ^ 9 here after 27 in the modules before"#
    );
}

#[test]
fn actuators_that_overlap() {
    assert_eq!(
        picture("\"30 mm\"", "\"15 mm\""),
        r#"error: the actuators overlap
  --> arm.toml:21:17
   |
21 | circle_radius = "15 mm"
   |                 ^^^^^^^ the axes are 25.9808 mm apart
22 | inner_radius = "10 mm"
23 | outer_radius = "14 mm"
   |                ------- each is 28 mm wide
   |
   = help: 3 actuators need a `circle_radius` of at least 16.1658 mm"#
    );
}

#[test]
fn pressure_beyond_the_sensor() {
    assert_eq!(
        picture("pressure_max = \"100 kPa\"", "pressure_max = \"250 kPa\""),
        r#"error: `pressure_max` is not below what the supply gives: 200 kPa
  --> arm.toml:49:16
   |
49 | pressure_max = "250 kPa"
   |                ^^^^^^^^^ this is 250 kPa"#
    );
    assert_eq!(
        picture(
            "[limits]\npressure_max = \"100 kPa\"",
            "[plant]\nsupply = { kind = \"regulated\", pressure = \"90 kPa\" }"
        ),
        r"error: `pressure_max` is not below what the supply gives: 90 kPa
--> arm.toml
 = note: this is 100 kPa, by default"
    );
}

#[test]
fn format_of_a_newer_softlimb() {
    assert_eq!(
        picture("format = 1", "format = 2\nfuture = true"),
        r#"error: the scene has format 2, newer than this softlimb knows
 --> arm.toml:1:10
  |
1 | format = 2
  |          ^ the newest known format is 1
  |
  = help: update softlimb, or write the scene in an older format"#
    );
}

#[test]
fn broken_toml() {
    assert_eq!(
        picture("\"240 mm\"", "240 mm"),
        r#"error: this is not TOML
  --> arm.toml:24:10
   |
24 | length = 240 mm
   |          ^^^^^^ string values must be quoted, expected literal string
   |
   = help: write a number with its unit as a string: "240 mm""#
    );
    assert_eq!(
        picture("[limits]", "[limits"),
        r#"error: this is not TOML
  --> arm.toml:48:8
   |
48 | [limits
   |        ^ unclosed table, expected `]`"#
    );
}

#[test]
fn marks_of_a_word_processor() {
    for (typed, code) in [("\u{201c}240 mm\u{201d}", "U+201C"), ("\u{2212}5", "U+2212"), ("\u{a0}\"240 mm\"", "U+00A0")]
    {
        let picture = picture("\"240 mm\"", typed);
        assert!(picture.starts_with("error: this is not TOML"), "{picture}");
        assert!(picture.contains(&format!("this line holds the character {code}")), "{picture}");
    }
}

#[test]
fn tables_with_one_bracket() {
    let text = changed("[[phase]]", "[phase]") + "\n[phase]\n";
    let picture = parse(&text, "arm.toml").unwrap_err().render(false);
    assert!(picture.contains("begins with two brackets: [[phase]]"), "{picture}");
}

#[test]
fn problems_come_together_and_in_the_order_of_the_text() {
    let text = changed("seed = 7", "seed = -7").replace("\"2 s\"", "\"2 m\"").replacen("\"240 mm\"", "\"24 deg\"", 1);
    assert_eq!(
        parse(&text, "arm.toml").unwrap_err().render(false),
        r#"error: `seed` must be a whole number from 0 to 2^63-1
 --> arm.toml:3:8
  |
3 | seed = -7
  |        ^^ out of range

error: `length` needs a length
  --> arm.toml:24:10
   |
24 | length = "24 deg"
   |          ^^^^^^^^ this is an angle
   |
   = help: units of a length: m, dm, cm, mm, um, nm, in

error: `duration` needs a time
  --> arm.toml:45:12
   |
45 | duration = "2 m"
   |            ^^^^^ this is a length
   |
   = help: units of a time: s, ms, us, min, h

error: 3 problems in arm.toml"#
    );
}

#[test]
fn twenty_problems_are_shown_and_the_rest_is_counted() {
    let junk: String = (0..30).map(|i| format!("junk-{i} = {i}\n")).collect();
    let error = parse(&changed("seed = 7\n", &junk), "arm.toml").unwrap_err();
    let text = error.render(false);
    assert_eq!(text.matches("error: unknown key").count(), 20);
    assert!(text.ends_with("error: 30 problems in arm.toml, the first 20 are shown"), "{text}");
    assert_eq!(error.to_string(), "arm.toml:3:1: unknown key `junk-0` (and 29 more)");
}

#[test]
fn color_is_only_in_the_colored_picture() {
    let error = parse(&changed("seed = 7", "sed = 7"), "arm.toml").unwrap_err();
    assert!(!error.render(false).contains('\u{1b}'));
    assert!(error.render(true).contains('\u{1b}'));
}

#[test]
fn diagnostics_point_at_a_value_of_the_scene() {
    let scene = parse(SCENE, "arm.toml").unwrap();
    let softlimb_scene::Goal::Targets(targets) = &scene.phases()[1].goal else { panic!("a way-point") };
    let span = targets[0].value.span;
    assert_eq!(scene.position(span), (46, 39));
    let error = scene.diagnostic(span, "the stretch is out of reach", "needs 130 kPa", Some("at most 1.15"));
    assert_eq!(
        error.render(false),
        r#"error: the stretch is out of reach
  --> arm.toml:46:39
   |
46 | targets = { upper = { axial_stretch = 1.2 } }
   |                                       ^^^ needs 130 kPa
   |
   = help: at most 1.15"#
    );
}

#[test]
fn payload_on_a_limb_without_weight() {
    let payload = "[weight]\nsimulated = false\n\n[[phase]]\npayload = \"0.5 kg\"";
    assert_eq!(
        picture("[[phase]]", payload),
        r#"error: a payload needs weight
  --> arm.toml:42:11
   |
42 | payload = "0.5 kg"
   |           ^^^^^^^^ the limb is weightless: this mass would be ignored
   |
   = help: leave out `simulated = false` of `[weight]` so that the limb carries itself and its load, or leave out this key; `softlimb statics --payload KG` loads a scene without it"#
    );
    // A mass of nothing is none.
    let scene = parse(&changed("[[phase]]", &payload.replace("0.5", "0")), "arm.toml").unwrap();
    assert!(scene.weightless());
}

/// The scene with these keys in its two phases and a third.
fn gripping(first: &str, second: &str, third: &str) -> String {
    let text = changed("name = \"reach\"", &format!("name = \"reach\"\n{first}"));
    let text = text.replacen("name = \"stretch\"", &format!("name = \"stretch\"\n{second}"), 1);
    let last = format!(
        "[[phase]]\nname = \"back\"\n{third}\nduration = \"2 s\"\ntargets = {{ upper = {{ axial_stretch = 1.0 }} }}\n\n[limits]"
    );
    text.replacen("[limits]", &last, 1)
}

#[test]
fn payload_in_open_jaws() {
    let text =
        gripping("gripper = \"close\"\npayload = \"1 kg\"", "gripper = \"open\"\npayload = \"1 kg\"", "payload = 1");
    let opened = parse(&text, "arm.toml").unwrap_err().render(false);
    assert_eq!(
        opened,
        r#"error: a payload needs closed jaws
  --> arm.toml:54:11
   |
47 | gripper = "open"
   |           ------ it opens here
...
54 | payload = 1
   |           ^ the gripper is open on the way here: nothing holds this
   |
   = help: close the gripper in this phase or before it (`gripper = "close"`), or leave out this key"#
    );
    // Open until its first command closes it, and where an open gripper opens again.
    for [first, second, third] in [
        ["payload = \"1 kg\"", "gripper = \"close\"\npayload = \"1 kg\"", "payload = \"1 kg\""],
        ["gripper = \"open\"", "", "gripper = \"open\"\npayload = \"1 kg\""],
    ] {
        let said = parse(&gripping(first, second, third), "arm.toml").unwrap_err().render(false);
        assert!(said.contains("a payload needs closed jaws") && said.matches("error").count() == 1, "{said}");
    }
    // Without commands it is fixed to the tip.
    assert!(parse(&gripping("payload = 1", "", "payload = 2"), "arm.toml").is_ok());
}

#[test]
fn payload_that_changes_in_closed_jaws() {
    let text = gripping("gripper = \"close\"\npayload = \"1 kg\"", "payload = \"0.4 kg\"", "gripper = \"open\"");
    let said = parse(&text, "arm.toml").unwrap_err().render(false);
    assert_eq!(
        said,
        r#"error: a payload changes in closed jaws
  --> arm.toml:47:11
   |
47 | payload = "0.4 kg"
   |           ^^^^^^^^ 0.4 kg here, 1 kg in `reach`
   |
   = help: the gripper keeps what it holds until it opens: give the same `payload` or `object` in all phases until then"#
    );
    // Closed from the start on, until its first command opens it.
    let held = |second: &str| parse(&gripping("payload = 1", second, "gripper = \"open\"\npayload = 1"), "arm.toml");
    assert!(held("payload = 1").is_ok());
    assert!(held("").unwrap_err().render(false).contains("0 kg here, 1 kg in `reach`"));
}

#[test]
fn feedback_has_one_observer() {
    let both = "[camera]\nfeedback = true\n\n[imu]\nfeedback = true\n\n[limits]";
    assert_eq!(
        picture("[limits]", both),
        r#"error: feedback has one observer, the camera or the IMUs
  --> arm.toml:52:12
   |
49 | feedback = true
   |            ---- the camera corrects them, too
...
52 | feedback = true
   |            ^^^^ the IMUs correct the setpoints
   |
   = help: set one of them to `false`"#
    );
    for one in [both.replacen("true", "false", 1), both.replace("[imu]\nfeedback = true", "[imu]")] {
        parse(&changed("[limits]", &one), "arm.toml").unwrap();
    }
}

#[test]
fn imus_have_the_errors_of_a_data_sheet() {
    assert_eq!(parse(SCENE, "arm.toml").unwrap().imu(), None);
    let imu = *parse(&changed("[limits]", "[imu]\n[limits]"), "arm.toml").unwrap().imu().unwrap();
    let degrees = [imu.tilt_error_rad, imu.heading_error_rad, imu.noise_rad, imu.rate_noise_rad_per_s];
    for (found, stated) in degrees.map(f64::to_degrees).into_iter().zip([1.5, 3.0, 0.1, 0.05]) {
        assert!((found - stated).abs() < 1e-12, "{found} {stated}");
    }
    assert!(!imu.feedback);
    assert_eq!([imu.period_s, imu.latency_s, imu.drop_outs], [0.01, 0.01, 0.0]);
}
