//! The images in the emulator: bit for bit as here, as good as here, and what happens when they cannot go on.

#[path = "emulated/crash.rs"]
mod crash;
#[path = "support/devices.rs"]
mod devices;
#[path = "emulated/endurance.rs"]
mod endurance;
mod support;
#[path = "emulated/trace.rs"]
mod trace;
#[path = "emulated/turns.rs"]
mod turns;
#[path = "emulated/wire.rs"]
mod wire;

use devices::Images;
use softlimb_limb::Limb;
use softlimb_motion::Sent;
use softlimb_rig::record::{self, Capture, DeviceTick, Direction, RunLog, Sample, WireBytes};
use softlimb_rig::run::{self, Mcu};
use softlimb_scene::Scene;
use support::{Ran, rerun, run_on, scene_of, scene_text, scene_with};

const SCENE: &str = "weightless-a";

/// Everything that the log says but the time that the run took: the run, what the host said, and all inputs and outputs of each tick. What the
/// device said differs where it tells of its board; [`rerun`] compares the rest of it.
fn said(ran: &Ran) -> (RunLog, Vec<WireBytes>, Vec<DeviceTick>) {
    let run = RunLog { wall_s: None, ..record::read(&ran.files.log).unwrap() };
    let Capture { mut wire, ticks, .. } = record::read_capture(&ran.files.log).unwrap();
    wire.retain(|wire| wire.direction == Direction::ToDevice);
    (run, wire, ticks)
}

#[test]
fn the_twin_gives_the_bits_that_the_controller_gives_here() {
    let Some(images) = Images::find("the_twin_gives_the_bits_that_the_controller_gives_here") else { return };
    let scene = scene_with(SCENE, "");
    let here = said(&run_on(Mcu::Here, &scene, 1));
    for round in 0..10 {
        let ran = run_on(Mcu::LockStep(images.twin()), &scene, 1);
        assert!(said(&ran) == here, "round {round}: the logs differ");
        if round == 0 {
            let again = rerun(&ran.files.log);
            assert!(again.is_exact && again.ticks_compared == again.ticks, "{again:?}");
            let speed = ran.files.run.wall_s.map_or(0.0, |wall_s| ran.files.run.samples.len() as f64 * 0.02 / wall_s);
            println!("the twin runs the scene at {speed:.1} times real time");
        }
    }
}

/// The scene up to its second hold: the emulated board takes ten times as long as the scene.
fn begun() -> Scene {
    let text = scene_text(SCENE);
    let phases: Vec<_> = text.match_indices("[[phase]]").map(|(at, _)| at).collect();
    let limits = text.find("[limits]").expect("limits behind the phases");
    assert!(phases.len() == 4 && phases[3] < limits, "{phases:?}");
    scene_of(SCENE, &(text[..phases[2]].to_owned() + &text[limits..]))
}

#[test]
fn the_flashed_image_tracks_as_well_as_the_controller_here() {
    let Some(images) = Images::find("the_flashed_image_tracks_as_well_as_the_controller_here") else { return };
    let scene = begun();
    let here = run_on(Mcu::Here, &scene, 1);
    let flashed = run_on(Mcu::Flashed(images.flashed()), &scene, 1);
    assert!(flashed.summary.faults.is_empty(), "{:?}", flashed.summary.faults);
    // Its pins, tick by tick, are those that the controller here decides on the same codes and frames.
    let again = rerun(&flashed.files.log);
    assert!(again.is_exact && again.ticks_compared == again.ticks, "{again:?}");
    let (rmse, reference) = (tip_rmse_mm(&flashed), tip_rmse_mm(&here));
    println!("RMSE of the tip: {rmse:.2} mm flashed, {reference:.2} mm here");
    assert!((rmse - reference).abs() < 0.05 * reference, "{rmse} mm, here {reference} mm");
    // Most of that is the limb not being the nominal one: what the controller does shows in the pressures. They differ from run to run.
    let limb = Limb::new(&scene).unwrap();
    let plan = softlimb_motion::plan(&scene, &limb).unwrap();
    let end_s = 1e-6 * plan.duration_us() as f64;
    let rmse = pressure_rmse_pa(&flashed.files.run.samples, end_s);
    let sent = Sent::uncorrected(&limb, &plan);
    let of_noise = |noise| {
        let samples = run::samples(&scene, &limb, (&plan, &sent), (1, noise)).unwrap();
        pressure_rmse_pa(&samples, end_s)
    };
    let here: Vec<f64> = (1..=6).map(of_noise).collect();
    let (least, most) = (here.iter().copied().fold(f64::INFINITY, f64::min), here.iter().copied().fold(0.0, f64::max));
    println!("RMSE of the chambers' pressures: {rmse:.1} Pa flashed, {here:.1?} Pa here");
    assert!((0.95 * least..1.05 * most).contains(&rmse), "{rmse} Pa, here {least} to {most} Pa");
}

/// RMSE of the chambers' pressures up to the end of the last hold.
fn pressure_rmse_pa(samples: &[Sample], end_s: f64) -> f64 {
    let channels = samples.iter().filter(|sample| sample.time_s <= end_s).flat_map(|sample| &sample.channels);
    let squares = channels
        .map(|channel| (channel.true_pressure_pa.expect("the plant is observed") - channel.reference_pa).powi(2));
    let (sum, count) = squares.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
    (sum / f64::from(count)).sqrt()
}

fn tip_rmse_mm(ran: &Ran) -> f64 {
    1e3 * ran.summary.tip.error_m.as_ref().expect("the limb is observed").rmse
}
