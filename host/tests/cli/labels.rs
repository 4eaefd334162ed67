//! What output says of the models behind its figures: a limb without weight, a winding whose angle is ignored.

use softlimb_chart::WEIGHTLESS;
use softlimb_rig::record;

use crate::cli::desk::{Answer, Desk, SCENE};

/// The scene with a rest that trials can be judged at.
fn weightless() -> String {
    SCENE.replace("0.2 s", "0.6 s")
}

/// The same finger, hanging, under its own weight.
fn weighing() -> String {
    weightless()
        .replace("[limb]", "[limb]\nbase_direction = [0, 0, -1]\nbase_up = [1, 0, 0]")
        .replace("simulated = false", "compensated = false")
}

/// The finger wound at an angle from the hoop.
fn wound(angle: &str, families: u8) -> String {
    let winding = format!(
        "[windings.thread]\nangle = \"{angle}\"\nfamilies = {families}\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\n[controller]\nbending = \"analytic\"\n\n[limb]"
    );
    SCENE
        .replace("[limb]", &winding)
        .replace("material = \"silicone\"\n", "material = \"silicone\"\nwinding = \"thread\"\n")
}

fn desk(scene: &str) -> Desk {
    let desk = Desk::new();
    desk.put("scene.toml", scene);
    desk
}

/// What is printed as a table and as JSON.
fn printed(desk: &Desk, line: &str) -> [Answer; 2] {
    [line.to_owned(), format!("{line} --json")].map(|line| desk.softlimb(&line).done())
}

const OF_A_LIMB: [&str; 4] = [
    "check scene.toml",
    "run scene.toml --out results",
    "learn scene.toml --iterations 0 --trials 1",
    "design limb scene.toml --out designed.toml",
];

#[test]
fn figures_of_a_limb_without_weight_say_so() {
    let desk = desk(&weightless());
    for line in OF_A_LIMB {
        let [table, json] = printed(&desk, line);
        assert!(table.out.lines().next().unwrap().contains(WEIGHTLESS), "{table:?}");
        assert_eq!(json.json()[WEIGHTLESS], true, "{json:?}");
    }
    for line in ["workspace scene.toml --samples 1000", "tolerance scene.toml --samples 10"] {
        let [table, json] = printed(&desk, &format!("{line} --svg picture.svg"));
        assert!(table.out.lines().next().unwrap().contains(WEIGHTLESS), "{table:?}");
        assert_eq!(json.json()[WEIGHTLESS], true, "{json:?}");
        assert!(std::fs::read_to_string(desk.path("picture.svg")).unwrap().contains(WEIGHTLESS), "{line}");
    }
}

#[test]
fn figures_of_a_limb_with_weight_do_not_call_it_weightless() {
    let desk = desk(&weighing());
    for line in OF_A_LIMB.iter().copied().chain(["workspace scene.toml --loaded --samples 64"]) {
        let [table, json] = printed(&desk, line);
        assert!(!table.out.contains(WEIGHTLESS), "{table:?}");
        assert_eq!(json.json()[WEIGHTLESS], false, "{json:?}");
    }
}

#[test]
fn log_and_report_know_whether_the_limb_had_weight() {
    for (scene, without) in [(weightless(), true), (weighing(), false)] {
        let desk = desk(&scene);
        desk.softlimb("run scene.toml --out results").done();
        assert_eq!(record::read(desk.path("results/run.mcap")).unwrap().info.weightless, without);
        let [table, json] = printed(&desk, "report results/run.mcap --out again.html");
        assert_eq!((table.out.contains(WEIGHTLESS), json.json()[WEIGHTLESS] == true), (without, without), "{table:?}");
        let page = std::fs::read_to_string(desk.path("again.html")).unwrap();
        let head = page.split("<h2>").next().unwrap().rsplit("<h1>").next().unwrap();
        assert_eq!(head.contains(WEIGHTLESS), without, "{head}");
        for plot in ["Tip error and its causes", "finger: bending"] {
            let title = format!("\"title\":\"{plot}, {WEIGHTLESS}\"");
            assert_eq!(page.contains(&title), without, "{plot}");
        }
        desk.softlimb("report results/run.mcap --motion results/run.mcap")
            .failed(1, &["give another file with --motion"]);
        desk.softlimb("report results/run.mcap --static --out still.html --motion limb.svg").done();
        let picture = std::fs::read_to_string(desk.path("limb.svg")).unwrap();
        assert_eq!((picture.contains(WEIGHTLESS), picture.contains("<animate ")), (without, true));
        let still = std::fs::read_to_string(desk.path("still.html")).unwrap();
        assert!(!still.contains("<script"));
        for figure in ["Side view", "Tip error", "finger: bending", "finger: pressures"] {
            let label = format!("aria-label=\"{figure}, {WEIGHTLESS}\"");
            assert_eq!(still.contains(&label), without, "{figure}");
        }
    }
}

/// Every command with a bender.
const OF_A_BENDER: [&str; 5] = [
    "check scene.toml",
    "eval scene.toml",
    "run scene.toml --out results",
    "design limb scene.toml --out designed.toml",
    "calibrate pressure bends.csv --scene scene.toml --fit shear_modulus",
];

/// A desk with a finger wound at an angle, and what its model makes of pressures.
fn wound_desk(angle: &str, families: u8) -> Desk {
    let desk = desk(&wound(angle, families));
    let curves = desk.softlimb("eval scene.toml --json --steps 5").json();
    let points = curves["curves"][0]["points"].as_array().unwrap()[1..].iter();
    let row = |point: &serde_json::Value| format!("finger,{},{}\n", point["pressure_pa"], point["bend_angle_rad"]);
    desk.put("bends.csv", "module,pressure_pa,bend_angle_rad\n".to_owned() + &points.map(row).collect::<String>());
    desk
}

#[test]
fn bender_with_one_family_far_from_the_hoop_is_warned_of() {
    let desk = wound_desk("20 deg", 1);
    for line in &OF_A_BENDER[..4] {
        for (line, json) in [(line.to_string(), false), (format!("{line} --json"), true)] {
            let answer = desk.softlimb(&line);
            assert_eq!(answer.code, Some(3), "{answer:?}");
            let warnings: Vec<&str> = answer.err.lines().filter(|line| line.contains("winding")).collect();
            let [warning] = warnings[..] else { panic!("{answer:?}") };
            for word in ["warning: ", "toml:", "`finger`", "20.0 deg", "two equal families"] {
                assert!(warning.contains(word), "{word}: {answer:?}");
            }
            if json {
                let found = answer.json()["warnings"].clone();
                let told = warning.trim_start_matches("warning: ");
                assert!(found.as_array().unwrap().iter().any(|one| one == told), "{found}");
            }
        }
    }
    // A calibration takes finite elements, which heed every angle.
    let calibrated = desk.softlimb(OF_A_BENDER[4]).done();
    assert!(calibrated.out.contains("finite elements") && !calibrated.err.contains("winding"), "{calibrated:?}");
    // The line is that of the module's `winding`.
    let line = 1 + wound("20 deg", 1).lines().position(|line| line.starts_with("winding")).unwrap();
    assert!(desk.softlimb("check scene.toml").err.contains(&format!("scene.toml:{line}: ")));
}

#[test]
fn bender_whose_winding_the_model_heeds_is_not_warned_of() {
    for (angle, families) in [("3 deg", 1), ("-5 deg", 2), ("20 deg", 2)] {
        let desk = wound_desk(angle, families);
        for line in OF_A_BENDER {
            let [table, json] = printed(&desk, line);
            assert!(!table.err.contains("winding") && !json.err.contains("winding"), "{table:?}");
            assert_eq!(json.json()["warnings"], serde_json::json!([]), "{json:?}");
        }
    }
}

/// The winding costs half of the bend: a design that took it as a hoop would state far less pressure.
#[test]
fn design_has_the_pressure_of_a_helical_winding_that_check_finds() {
    let scene = wound("20 deg", 2).replace("bend_angle = \"30 deg\"", "bend_angle = \"100 deg\"");
    let desk = desk(&scene);
    let designed = desk.softlimb("design limb scene.toml --out designed.toml --json").json();
    let checked = desk.softlimb("check designed.toml --json").json();
    let pressure_pa = &designed["answer"]["segments"][0]["phases"][0]["pressure_pa"];
    let found_pa = checked["modules"][0]["highest_pressure_pa"].as_f64().unwrap();
    let by_analytic_pa = found_pa;
    assert!((pressure_pa.as_f64().unwrap() / found_pa - 1.0).abs() < 1e-6, "{designed} {checked}");
    desk.put("hoop.toml", scene.replace("20 deg", "5 deg"));
    let hoop_pa = desk.softlimb("check hoop.toml --json").json()["modules"][0]["highest_pressure_pa"].as_f64().unwrap();
    assert!(found_pa > 1.2 * hoop_pa, "{found_pa} {hoop_pa}");
    // Where `check` takes finite elements, the design has their pressure.
    desk.put("auto.toml", scene.replace("bending = \"analytic\"", "bending = \"auto\""));
    let designed = desk.softlimb("design limb auto.toml --out designed-auto.toml --json").done().json();
    assert_eq!(designed["warnings"], serde_json::json!([]), "{designed}");
    let segment = &designed["answer"]["segments"][0];
    assert_eq!(segment["bend"]["model"], "section-fe", "{designed}");
    let checked = desk.softlimb("check designed-auto.toml --json").json();
    let pressure_pa = segment["phases"][0]["pressure_pa"].as_f64().unwrap();
    let found_pa = checked["modules"][0]["highest_pressure_pa"].as_f64().unwrap();
    assert!((pressure_pa / found_pa - 1.0).abs() < 1e-6, "{designed} {checked}");
    assert!((pressure_pa / by_analytic_pa - 1.0).abs() > 1e-3, "{pressure_pa} {by_analytic_pa}");
}

#[test]
fn answers_of_a_batch_have_no_warnings() {
    let question = r#"{"motion":"bending","problem":"forward","inner_radius_m":0.006,"outer_radius_m":0.008,"length_m":0.1,"material":{"law":"neo-hookean","shear_modulus_pa":2e5},"pressure_pa":3e4}"#;
    let answer = Desk::new().softlimb_reading("eval --batch -", question.as_bytes()).done();
    assert_eq!((answer.err.as_str(), answer.json().get("warnings")), ("", None), "{answer:?}");
}

/// A finger whose tip is soft for its size alone.
#[test]
fn margins_are_judged_by_the_bounds_of_the_scene() {
    let finger = include_str!("../../../scenes/finger.toml");
    assert!(finger.contains("tip_stiffness_min = \"10 N/m\""));
    desk(finger).softlimb("check scene.toml").done();
    let stiffer = finger.replace("tip_stiffness_min = \"10 N/m\"", "tip_stiffness_min = \"25 N/m\"");
    let warned = desk(&stiffer).softlimb("check scene.toml");
    assert_eq!(warned.code, Some(3), "{warned:?}");
    assert!(warned.err.contains("the vertical stiffness of the tip is 18.7 N/m, below 25 N/m"), "{warned:?}");
}
