//! Runs on a true body: what they say of it, and that the planner's limb is another one.

use std::sync::atomic::AtomicBool;

use nalgebra::Vector3;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_rig::record::RunLog;
use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run, run_on};
use softlimb_scene as scene;
use softlimb_scene::Scene;

const ELASTIC: &str = "hysteresis = false\ncreep = false\nsoftening = false\nassembly = false\n";

/// A small scene without weight, spread and creep, with a limb.
fn with(limb: &str) -> Scene {
    changed(limb, |text| text)
}

/// The same with a change of its text.
fn changed(limb: &str, change: impl FnOnce(String) -> String) -> Scene {
    let path = format!("{}/../../scenes/single-bending.toml", env!("CARGO_MANIFEST_DIR"));
    let none = "[plant.spread]\nmodulus = 0\nwall = 0\nfiber_angle = 0\n[plant.chamber]\ncreep_share = 0\n";
    let text = change(std::fs::read_to_string(path).unwrap()) + "\n" + none + "[plant.truth]\n" + limb;
    scene::parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn ran(scene: &Scene) -> RunLog {
    ran_with(scene, 3)
}

/// A run with a seed of its valves, sensors and noise.
fn ran_with(scene: &Scene, seed: u64) -> RunLog {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_owned();
    let options = RunOptions { seed, out, mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
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

/// A run of a weightless bender with a softer wall, which bends too far, beside a ball at a place, m, that the plan stays clear of.
fn overbent(center_m: [f64; 3], truth: &str) -> RunLog {
    let ball =
        format!("[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = {center_m:?}\nradius = \"20 mm\"\n");
    let limb = format!("{truth}limb = \"body\"\n{ELASTIC}{ball}");
    let (scene, folder) = (with(&limb), tempfile::tempdir().unwrap());
    let plant = changed(&limb, |text| text.replace("0.223 MPa", "0.19 MPa"));
    let planned = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &planned).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let out = folder.path().to_owned();
    let options = RunOptions { seed: 3, out, mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    run_on(&scene, (planned, plan), &plant, &options, &AtomicBool::new(false), |_| ()).unwrap().run
}

#[test]
fn ball_in_the_way_of_a_limb_that_bends_too_far_stops_it() {
    let far = [0.0, 1.0, 0.0];
    let free = overbent(far, "contact = false\n");
    let rounding_m = apart_m(&free, &overbent(far, ""));
    assert!(rounding_m < 1e-13, "a far ball changes nothing: {rounding_m}");
    assert!(free.contacts.is_empty());
    // At the end of the last hold.
    let last = free.samples.iter().rev().find(|sample| sample.time_s < 7.4).unwrap();
    let [planned, reached] = [last.tip_setpoint_m, last.tip_achieved_m.unwrap()].map(Vector3::from);
    // On the way from the plan to where the limb bends: the radii of both, and 20 mm clear of the plan.
    let between_m = 14e-3 + 20e-3 + 20e-3;
    let ball: [f64; 3] = (planned + (reached - planned).normalize() * between_m).into();
    let (through, stopped) = (overbent(ball, "contact = false\n"), overbent(ball, ""));
    let least_m = |log: &RunLog| {
        let distances = log.bodies.iter().filter_map(|body| Some(body.nearest.as_ref()?.0));
        distances.fold(f64::INFINITY, f64::min)
    };
    assert_eq!([&through, &stopped].map(|log| log.info.truth.as_deref()), [Some("body"), Some("body + contact")]);
    assert!(through.contacts.is_empty() && least_m(&through) < -20e-3, "{} m", least_m(&through));
    assert!(least_m(&stopped).abs() < 1e-5, "{} m", least_m(&stopped));
    // The limb moves up to its last goal from 5 to 6.5 s, and holds it to 7.5 s.
    let [contact] = &stopped.contacts[..] else { panic!("{:?}", stopped.contacts) };
    assert_eq!(contact.obstacle, "ball");
    assert!((5.0..6.5).contains(&contact.first_s) && (contact.first_s..7.6).contains(&contact.time_s), "{contact:?}");
    assert!((0.2..0.3).contains(&contact.force_n), "{contact:?}");
    let table = report::summary(&stopped).table();
    assert!(table.contains(&format!("contact  with ball from {:.2} s on, at most", contact.first_s)), "{table}");
    assert!(report::html(&stopped).contains("The limb touched an obstacle: contact with ball from"));
}

#[test]
fn bottle_stands_on_its_table_until_it_is_lifted() {
    let path = format!("{}/../../scenes/pick-and-place-a.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    // The first phase alone: it ends with the bottle, grasped 120 mm above its foot, at a height of 830 mm.
    let phases: Vec<usize> = text.match_indices("[[phase]]").map(|(at, _)| at).collect();
    let pick = text[..phases[1]].to_owned() + &text[text.find("[limits]").unwrap()..];
    let pick = pick.replace("clearance = \"5 mm\"", "clearance = \"0 mm\"");
    let table = "[[obstacle]]\nname = \"table\"\nshape = \"box\"\ncenter = [0.74, 0, 0.7]\nsize = [0.2, 0.3, 0.02]\n";
    let text = format!("{pick}\n[camera]\nfeedback = true\n{table}[plant.truth]\nlimb = \"body\"\n{ELASTIC}");
    let log = ran(&scene::parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{}", error.render(false))));
    let [contact] = &log.contacts[..] else { panic!("{:?}", log.contacts) };
    // It bears some of the 5.9 N of the bottle, which the limb takes over during the hold.
    assert!(contact.carried && contact.obstacle == "table" && (0.01..5.9).contains(&contact.force_n), "{contact:?}");
    assert!(contact.first_s > 9.0, "{contact:?}");
    let html = report::html(&log);
    assert!(html.contains("contact of the object with table") || html.contains("Contact of the object with table"));
    assert!(!html.contains("The limb touched an obstacle"));
}

/// The limb that hangs, with fast valves and its first move in a second, on an elastic body of its nominal parameters.
fn hanging(truth: &str, tables: &str) -> Scene {
    let path = format!("{}/../../scenes/loaded/carry-hanging.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let phases: Vec<usize> = text.match_indices("[[phase]]").map(|(at, _)| at).collect();
    let quick = text[..phases[1]].replace("duration = \"3 s\"", "duration = \"1 s\"");
    let quick = quick.replace("hold = \"0.5 s\"", "hold = \"3 s\"") + &text[text.find("[limits]").unwrap()..];
    let none = "[plant.spread]\nmodulus = 0\nwall = 0\nfiber_angle = 0\n[plant.chamber]\ncreep_share = 0\n";
    let valves = "[plant.valve]\nconductance = \"0.3 dm3/(s bar)\"\n[plant.line]\ninner_diameter = \"6 mm\"\n";
    let text = format!("{quick}\n{none}{valves}{tables}[plant.truth]\nlimb = \"body\"\n{ELASTIC}{truth}");
    scene::parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// Distances of the tips of two runs in the three seconds after the first move, m, by component.
fn apart(swinging: &RunLog, still: &RunLog, from_s: f64) -> Vec<(f64, Vector3<f64>)> {
    let pairs = swinging.samples.iter().zip(&still.samples);
    let window = pairs.filter(|(sample, _)| (from_s..from_s + 3.0).contains(&sample.time_s));
    let tips = window.filter_map(|(a, b)| Some((a.time_s, a.tip_achieved_m?, b.tip_achieved_m?)));
    tips.map(|(time_s, a, b)| (time_s, Vector3::from(a) - Vector3::from(b))).collect()
}

/// The highest peak of the spectrum above 1 Hz: its frequency, Hz, and its amplitude, m.
fn peak(apart: &[(f64, Vector3<f64>)]) -> (f64, f64) {
    let mean = apart.iter().map(|(_, tip)| tip).sum::<Vector3<f64>>() / apart.len() as f64;
    let amplitude = |hz: f64| {
        let part = |by: fn(f64) -> f64| {
            let of = |(time_s, tip): &(f64, Vector3<f64>)| (tip - mean) * by(std::f64::consts::TAU * hz * time_s);
            apart.iter().map(of).sum::<Vector3<f64>>().norm()
        };
        2.0 / apart.len() as f64 * part(f64::sin).hypot(part(f64::cos))
    };
    let all = (100..1000).map(|index| 0.01 * f64::from(index)).map(|hz| (hz, amplitude(hz)));
    all.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
}

/// Seeds of the simulated valves and sensors: the swing differs from seed to seed.
const SEEDS: [u64; 3] = [3, 4, 5];

/// Compares the planner's prediction with a simulated body that shares no code with it, after a move of one second from rest.
#[test]
fn body_swings_at_the_predicted_frequency_and_less_after_a_shaped_move() {
    let swung = |tables: &str| {
        let scene = hanging("swing = true\n", tables);
        let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let plan = motion::plan(&scene, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let predicted = motion::swings(&scene, &limb, &plan).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let told = (predicted[0].moved.frequency_hz[0], predicted[0].residual_m);
        let from_s = (plan.phases[0].start_us + plan.phases[0].move_us) as f64 * 1e-6;
        let still = hanging("", tables);
        let found = SEEDS.map(|seed| {
            let (swinging, still) = (ran_with(&scene, seed), ran_with(&still, seed));
            assert_eq!(swinging.info.truth.as_deref(), Some("body + swing"));
            let (hz, m) = peak(&apart(&swinging, &still, from_s));
            println!("{tables:?} {seed}: {hz:.2} Hz of {:.2} Hz, {:.3} mm of {:.3} mm", told.0, 1e3 * m, 1e3 * told.1);
            (hz, m)
        });
        let median = |mut values: [f64; 3]| {
            values.sort_by(f64::total_cmp);
            values[1]
        };
        [median(found.map(|(hz, _)| hz)) / told.0, median(found.map(|(_, m)| m)), told.1]
    };
    let [plain, shaped] = ["", "[swing]\nshaping = \"adapted\"\n"].map(swung);
    // Three seeds give 2.27 to 2.32 Hz, from the end of the move on and from a second later; the planner predicts 2.40 Hz.
    assert!((plain[0] - 1.0).abs() < 0.05, "{plain:?}");
    assert!((1.0 / 1.5..1.5).contains(&(plain[1] / plain[2])), "{plain:?}");
    assert!(shaped[1] < 0.65 * plain[1], "{plain:?} {shaped:?}");
}
