//! Runs on a true body: what they say of it, and that the planner's limb is another one.

use std::sync::atomic::AtomicBool;

use softlimb_rig::record::RunLog;
use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene as scene;
use softlimb_scene::Scene;

const ELASTIC: &str = "hysteresis = false\ncreep = false\nsoftening = false\nassembly = false\n";

/// A small scene without weight, spread and creep, with a limb.
fn with(limb: &str) -> Scene {
    let path = format!("{}/../../scenes/single-bending.toml", env!("CARGO_MANIFEST_DIR"));
    let none = "[plant.spread]\nmodulus = 0\nwall = 0\nfiber_angle = 0\n[plant.chamber]\ncreep_share = 0\n";
    let text = std::fs::read_to_string(path).unwrap() + "\n" + none + "[plant.truth]\n" + limb;
    scene::parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn ran(scene: &Scene) -> RunLog {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_owned();
    let options = RunOptions { seed: 3, out, mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    run(scene, &options, &AtomicBool::new(false), |_| ()).unwrap().run
}

/// Largest distance of two runs' tips, m.
fn apart_m(a: &RunLog, b: &RunLog) -> f64 {
    let tips = a.samples.iter().zip(&b.samples);
    let far = tips.filter_map(|(a, b)| Some((a.tip_achieved_m?, b.tip_achieved_m?)));
    let far = far.map(|(a, b)| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt());
    far.fold(f64::NAN, f64::max)
}

#[test]
fn run_on_a_body_says_so_and_the_same_seed_gives_the_same_tips() {
    let (simple, body) = (ran(&with("limb = \"simple\"\n")), ran(&with("limb = \"body\"\ncreep = false\n")));
    assert_eq!(simple.info.truth, None);
    let words = "body + hysteresis + softening + assembly";
    assert_eq!(body.info.truth.as_deref(), Some(words));
    let table = report::summary(&body).table();
    assert!(table.contains(&format!("simulated, seed 3, {words}")), "{table}");
    assert!(body.samples.iter().all(|sample| sample.tip_achieved_m.is_some()));
    // Pressures are the plant's, and no limb changes them.
    let pressures = |log: &RunLog| log.samples.iter().map(|sample| sample.channels[0].pressure_pa).collect::<Vec<_>>();
    assert_eq!(pressures(&simple), pressures(&body));
    let again = ran(&with("limb = \"body\"\ncreep = false\n"));
    assert_eq!(apart_m(&body, &again), 0.0);
    assert!(apart_m(&simple, &body) > 1e-3, "{}", apart_m(&simple, &body));
}

#[test]
fn elastic_body_of_one_bender_without_weight_is_near_the_free_bender() {
    // The analytic bender and finite elements of its section differ by some per cent of a bend of at most a quarter turn.
    let weightless = |limb: &str| {
        let scene = with(limb);
        assert!(scene.weightless(), "the scene is weightless");
        ran(&scene)
    };
    let apart = apart_m(&weightless("limb = \"simple\"\n"), &weightless(&format!("limb = \"body\"\n{ELASTIC}")));
    assert!(apart < 5e-3, "{apart}");
}
