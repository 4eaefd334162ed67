//! A limb moved by hand on the simulated device: its task, its latency, its log.

#[path = "jog/script.rs"]
mod script;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use script::{Script, Timed};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_motion::jog::{Order, Way};
use softlimb_rig::link::LinkFaults;
use softlimb_rig::record::Sample;
use softlimb_rig::run::{JogDevice, JogOptions, Mcu, Operator, Press, RunError, RunFiles, attempts, jog};
use softlimb_scene as scene;
use softlimb_scene::Scene;

const WITHIN_M: f64 = 0.01;
/// From a key to its setpoint on the wire, us.
const TO_WIRE_US: u64 = 20_000;

fn repository(name: &str) -> Scene {
    scene::load(format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a scene of the repository")
}

fn session(scene: &Scene, link_faults: Option<LinkFaults>, script: &mut dyn Operator) -> RunFiles {
    session_with(scene, None, link_faults, script)
}

fn session_with(
    scene: &Scene,
    task: Option<Plan>,
    link_faults: Option<LinkFaults>,
    script: &mut dyn Operator,
) -> RunFiles {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_owned();
    let options = JogOptions { out, within_m: WITHIN_M, link_faults, task: task.map(Arc::new) };
    let device = JogDevice { seed: scene.seed(), mcu: Mcu::Here, in_real_time: false };
    jog(scene, &device, &options, script, &AtomicBool::new(false)).unwrap_or_else(|error| panic!("{error}"))
}

fn check_pressures(scene: &Scene, files: &RunFiles) {
    for sample in &files.run.samples {
        for channel in &sample.channels {
            // What the device watches, at every sample.
            let most_pa = *scene.limits().pressure_max_pa;
            assert!(channel.true_pressure_pa.unwrap() <= most_pa, "{} s: {channel:?}", sample.time_s);
        }
    }
}

#[test]
fn hand_does_the_task_on_a_limb_that_is_not_its_model() {
    for holds in [false, true] {
        let scene = repository("steering");
        let mut script = Script::towards_targets(holds);
        let files = session(&scene, None, &mut script);
        let attempts = attempts(&scene, &files.run, WITHIN_M).unwrap();
        assert_eq!(attempts.len(), 4);
        for attempt in &attempts {
            println!("{attempt:?}");
            assert!(attempt.time_s.is_some() && attempt.least_m <= WITHIN_M, "{attempt:?}");
        }
        check_pressures(&scene, &files);
        assert!(files.run.faults.is_empty(), "{:?}", files.run.faults);
        assert!(script.waited_us.len() > 20, "{}", script.waited_us.len());
        assert!(script.waited_us.iter().all(|waited_us| *waited_us <= TO_WIRE_US), "{:?}", script.waited_us);
        check_vented(&files);
    }
}

fn check_vented(files: &RunFiles) {
    let last = files.run.samples.last().unwrap();
    assert!(last.channels.iter().all(|channel| channel.pressure_pa < 3e3), "vented at the end: {last:?}");
}

#[test]
fn setpoints_are_those_of_the_keys_and_stay_where_a_key_is_let_go() {
    let scene = repository("weightless-a");
    let raise = Press::Order(Order::Hold(Way { axis: 0, with: true }));
    let keys =
        [(0.1, Press::Order(Order::SelectDrive(1))), (0.5, raise), (1.5, Press::Order(Order::Stop)), (3.0, Press::End)];
    let mut script = Timed::new(&keys);
    let files = session(&scene, None, &mut script);
    let at = |time_s: f64| {
        let sample = files.run.samples.iter().find(|sample| sample.time_s >= time_s).unwrap();
        sample.modules[1].setpoint.to_degrees()
    };
    // 20 deg/s for a second, with the lead of the knots.
    assert!(at(0.4) == 0.0 && (at(2.0) - 20.0).abs() < 1.0, "{}", at(2.0));
    assert_eq!(at(2.0), at(2.9), "held");
    assert!((at(1.4) - at(0.9) - 10.0).abs() < 0.1, "{}", at(1.4) - at(0.9));
    assert_eq!(
        files.run.samples.iter().map(|sample| sample.modules[0].setpoint).fold(0.0, f64::max),
        1.0,
        "no other module"
    );
}

#[test]
fn limb_is_led_to_setpoints_and_back() {
    let scene = repository("weightless-a");
    let limb = Limb::new(&scene).unwrap();
    let rest: Vec<f64> = limb.drives().map(|drive| drive.range().0).collect();
    let bent = vec![rest[0], 0.4, 1.1];
    let keys = [
        (0.1, Press::Lead(bent.clone())),
        (4.0, Press::Lead(rest.clone())),
        // Turned round on its way.
        (4.4, Press::Lead(bent.clone())),
        (8.0, Press::Lead(vec![0.0; 3])),
        (9.0, Press::End),
    ];
    let files = session(&scene, None, &mut Timed::new(&keys));
    let at = |time_s: f64| {
        let sample = files.run.samples.iter().find(|sample| sample.time_s >= time_s).unwrap();
        sample.modules.iter().map(|module| module.setpoint).collect::<Vec<_>>()
    };
    let is = |found: &[f64], wanted: &[f64]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(is(&at(3.9), &bent), "{:?}", at(3.9));
    assert!(!is(&at(4.5), &bent), "on its way: {:?}", at(4.5));
    // No limb has a stretch of 0: it stays.
    assert!(is(&at(7.9), &bent) && is(&at(8.9), &bent), "{:?}", at(8.9));
    check_pressures(&scene, &files);
    check_vented(&files);
}

#[test]
fn rod_with_two_windings_twists_by_hand() {
    let scene = scene::parse(crate::wound_twice::ROD, "rod.toml").unwrap_or_else(|error| panic!("{error}"));
    let raise = Press::Order(Order::Hold(Way { axis: 0, with: true }));
    let keys =
        [(0.1, Press::Order(Order::SelectDrive(0))), (0.5, raise), (3.5, Press::Order(Order::Stop)), (5.0, Press::End)];
    let files = session(&scene, None, &mut Timed::new(&keys));
    let held = files.run.samples.iter().find(|sample| sample.time_s >= 4.9).unwrap().modules[0];
    println!("{held:?}");
    assert!(held.setpoint.abs() > 0.5, "{held:?}");
    assert!((held.achieved.unwrap() / held.setpoint - 1.0).abs() < 0.05, "{held:?}");
}

#[test]
fn vented_limb_waits_and_goes_on_from_rest() {
    let scene = repository("weightless-a");
    let step = Press::Order(Order::Go(Way { axis: 2, with: false }));
    let longer = Press::Order(Order::Longer);
    let keys = [
        (0.1, longer),
        (0.2, step.clone()),
        (1.0, step.clone()),
        (2.0, Press::Vent),
        (2.1, step.clone()),
        (6.0, Press::Resume),
        (8.0, step.clone()),
        (9.5, Press::End),
    ];
    let files = session(&scene, None, &mut Timed::new(&keys));
    let highest_pa = |from_s: f64, to_s: f64| {
        let samples = files.run.samples.iter().filter(|sample| (from_s..to_s).contains(&sample.time_s));
        samples.flat_map(|sample| &sample.channels).map(|channel| channel.pressure_pa).fold(0.0, f64::max)
    };
    assert!(highest_pa(1.5, 2.0) > 500.0, "{}", highest_pa(1.5, 2.0));
    assert!(highest_pa(5.0, 8.0) < 300.0, "a key without pressure moves nothing: {}", highest_pa(5.0, 8.0));
    assert!(highest_pa(9.0, 9.5) > 250.0, "{}", highest_pa(9.0, 9.5));
    assert!(files.run.faults.is_empty(), "{:?}", files.run.faults);
    check_vented(&files);
}

#[test]
fn wish_to_go_on_waits_until_the_pressures_are_down() {
    let scene = repository("weightless-a");
    let step = Press::Order(Order::Go(Way { axis: 2, with: false }));
    let keys = [
        (0.1, Press::Order(Order::Longer)),
        (0.2, step.clone()),
        (2.0, Press::Vent),
        // Of these the last one counts.
        (2.05, Press::Resume),
        (2.1, Press::Vent),
        (2.15, Press::Resume),
        (7.0, step),
        (8.5, Press::End),
    ];
    let files = session(&scene, None, &mut Timed::new(&keys));
    let highest_pa = |from_s: f64, to_s: f64| {
        let samples = files.run.samples.iter().filter(|sample| (from_s..to_s).contains(&sample.time_s));
        samples.flat_map(|sample| &sample.channels).map(|channel| channel.pressure_pa).fold(0.0, f64::max)
    };
    assert!(highest_pa(1.5, 2.0) > 250.0, "{}", highest_pa(1.5, 2.0));
    assert!(highest_pa(5.0, 7.0) < 300.0, "at rest: {}", highest_pa(5.0, 7.0));
    assert!(highest_pa(8.0, 8.5) > 250.0, "moved again: {}", highest_pa(8.0, 8.5));
    check_vented(&files);
}

#[test]
fn device_that_ran_out_of_setpoints_is_led_on_from_where_it_holds() {
    let scene = repository("weightless-a");
    let raise = Press::Order(Order::Hold(Way { axis: 0, with: true }));
    let keys = [
        (0.1, Press::Order(Order::SelectDrive(1))),
        (0.5, raise),
        (30.0, Press::Order(Order::Stop)),
        (31.0, Press::End),
    ];
    let faults = "stall=0.002:300ms".parse().unwrap();
    let files = session(&scene, Some(faults), &mut Timed::new(&keys));
    assert!(!files.run.faults.is_empty(), "the link stalled");
    // No jump of the reference anywhere.
    let most_pa = 100e3 * 0.1;
    for pair in files.run.samples.windows(2).filter(|pair| pair[1].time_s < 31.0) {
        let seconds = pair[1].time_s - pair[0].time_s;
        for (a, b) in pair[0].channels.iter().zip(&pair[1].channels) {
            let change_pa = (b.reference_pa - a.reference_pa).abs();
            assert!(change_pa <= most_pa * (seconds / 0.02), "{} s: {change_pa} Pa", pair[1].time_s);
        }
    }
    let bent = files.run.samples.iter().map(|sample| sample.modules[1].setpoint.to_degrees()).fold(0.0, f64::max);
    assert!(bent > 2.0, "{bent}");
    check_vented(&files);
}

#[test]
fn task_is_the_plan_with_a_pause_where_it_is_held() {
    let scene = repository("steering");
    let limb = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &limb).unwrap();
    let duration_s = plan.duration_us() as f64 * 1e-6;
    let (start_s, held_s, pause_s) = (0.5, 2.0, 1.5);
    let end_s = start_s + duration_s + pause_s;
    let step = Press::Order(Order::Go(Way { axis: 2, with: true }));
    let keys = [
        (start_s, Press::Task),
        (held_s, Press::Order(Order::Stop)),
        // Refused while the task is under way.
        (held_s + 0.5, step.clone()),
        (held_s + pause_s, Press::Task),
        (end_s + 1.0, step),
        (end_s + 3.0, Press::End),
    ];
    let files = session_with(&scene, Some(plan.clone()), None, &mut Timed::new(&keys));
    assert!(files.run.faults.is_empty(), "{:?}", files.run.faults);
    let setpoints = |sample: &Sample| sample.modules.iter().map(|module| module.setpoint).collect::<Vec<_>>();
    let at = |time_s: f64| files.run.samples.iter().find(|sample| sample.time_s >= time_s).unwrap();
    // The keys are seen with the next sample and knots are ahead of the clock: the plan is found by its largest setpoints.
    let shift_s = |from_s: f64, to_s: f64| {
        let distance = |shift_s: f64| {
            let samples = files.run.samples.iter().filter(|sample| (from_s..to_s).contains(&sample.time_s));
            let error = |sample: &Sample| {
                let planned = plan.values_at(1e6 * (sample.time_s - shift_s).clamp(0.0, duration_s));
                let errors = setpoints(sample).into_iter().zip(planned).map(|(a, b)| (a - b).abs());
                errors.fold(0.0, f64::max)
            };
            samples.map(error).fold(0.0, f64::max)
        };
        let shifts = (0..400).map(|step| start_s + f64::from(step) * 0.01);
        shifts.map(|shift_s| (distance(shift_s), shift_s)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    };
    let (before, after) = (shift_s(start_s + 0.5, held_s), shift_s(held_s + pause_s + 0.5, end_s));
    println!("{before:?} {after:?}");
    // The plan, before and after the pause.
    assert!(before.0 < 1e-12 && after.0 < 1e-12, "{before:?} {after:?}");
    assert!((before.1 - start_s - 0.1).abs() < 0.15, "{before:?}");
    assert!((after.1 - before.1 - pause_s).abs() < 0.025, "{before:?} {after:?}");
    assert_eq!(setpoints(at(held_s + 0.4)), setpoints(at(held_s + pause_s - 0.1)), "held, and no step");
    let (ended, stepped) = (setpoints(at(end_s + 0.9)), setpoints(at(end_s + 2.9)));
    assert!(ended.iter().zip(&stepped).any(|(a, b)| (a - b).abs() > 1e-3), "moved by hand behind the task");
    check_vented(&files);
}

#[test]
fn part_that_the_operator_breaks_is_in_the_log() {
    let scene = repository("steering");
    let raise = Press::Order(Order::Hold(Way { axis: 0, with: true }));
    let keys = [
        (0.1, Press::Order(Order::SelectDrive(0))),
        (0.2, raise),
        (1.0, Press::Break("no-such-part".into(), None)),
        (1.2, Press::Break("sensor-zero".into(), Some(0))),
    ];
    let folder = tempfile::tempdir().unwrap();
    let options = JogOptions { out: folder.path().to_owned(), within_m: WITHIN_M, link_faults: None, task: None };
    let device = JogDevice { seed: scene.seed(), mcu: Mcu::Here, in_real_time: false };
    let ended = jog(&scene, &device, &options, &mut Timed::new(&keys), &AtomicBool::new(false));
    let Err(RunError::Stopped { files, .. }) = ended else { panic!("a hose off the sensor stops the limb") };
    let purpose =
        files.run.faults.iter().find(|fault| fault.text.contains("on purpose")).expect("the fault on purpose");
    assert!(purpose.text.starts_with("sensor-zero") && purpose.channel == 0, "{purpose:?}");
    assert!((1.0..1.6).contains(&purpose.time_s), "{purpose:?}");
    assert!(files.run.faults.iter().any(|fault| fault.code < 240), "{:?}", files.run.faults);
}
