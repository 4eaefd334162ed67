//! The flashed image behind a pseudo-terminal, at the emulator's pace, and a host that keeps time by this computer's clock.

use std::sync::Barrier;
use std::sync::atomic::{AtomicBool, Ordering};

use softlimb_limb::Limb;
use softlimb_rig::link::SampleRequest;
use softlimb_rig::link::port::{Address, ClientPort, serve};
use softlimb_rig::replay::Replay;
use softlimb_rig::report;
use softlimb_rig::report::Summary;
use softlimb_rig::run;
use softlimb_rig::run::{Mcu, RunError};
use softlimb_scene::Scene;

use crate::devices::Images;
use crate::support::{agrees, replayed, run_on, scene_with};

/// Samples that meet the pulses of the valves at every phase: at the default period they meet them at one, which differs from run to run.
const OFTEN: &str = "\n[controller]\ntelemetry_period = \"3 ms\"\n";

/// Runs in which a computer that is too busy for the emulator may let bytes come too late, or not at all, at either end.
const ATTEMPTS: usize = 3;

#[test]
fn the_flashed_image_behind_a_terminal_tracks_as_the_controller_here() {
    let Some(images) = Images::find("the_flashed_image_behind_a_terminal_tracks_as_the_controller_here") else {
        return;
    };
    let scene = scene_with("single-bending", OFTEN);
    let reference = measured_rmse_pa(&run_on(Mcu::Here, &scene, scene.seed()).summary);
    let mcu = Mcu::Flashed(images.flashed());
    let too_late = |ended: &Result<(Summary, Replay), RunError>| match ended {
        Err(error) => matches!(error, RunError::Link(_) | RunError::Stopped { .. }),
        Ok((summary, rerun)) => rerun.gap_us.is_some() || rerun.messages_missing > 0 || !summary.faults.is_empty(),
    };
    let mut ended = behind_a_terminal(&scene, &mcu);
    for _ in 1..ATTEMPTS {
        if too_late(&ended) {
            println!("run again: {:?}", ended.map(|(summary, rerun)| (summary.faults, rerun)));
            ended = behind_a_terminal(&scene, &mcu);
        }
    }

    let (summary, rerun) = ended.unwrap();
    println!("{} ticks run again, outputs of {} compared", rerun.ticks, rerun.ticks_compared);
    agrees(&rerun);
    assert!(rerun.is_exact && rerun.gap_us.is_none() && rerun.ticks_compared > 5_000, "{rerun:?}");
    assert!(!summary.simulated && summary.faults.is_empty(), "{:?}", summary.faults);
    let (found, pace) = (measured_rmse_pa(&summary), summary.real_time_factor.unwrap());
    println!(
        "RMSE of the measured pressure: {found:.1} Pa behind the terminal, {reference:.1} Pa here; pace {pace:.2}"
    );
    assert!((found - reference).abs() < 0.05 * reference, "{found} Pa, here {reference} Pa");
}

/// Runs the scene on a newly served device, and replays the controller on the log.
fn behind_a_terminal(scene: &Scene, mcu: &Mcu) -> Result<(Summary, Replay), RunError> {
    let limb = Limb::new(scene).unwrap();
    let mut port = ClientPort::terminal().unwrap();
    let Ok(Address::Port(address)) = port.address().unwrap().parse() else { panic!("{port:?}") };
    let (folder, started, stop) = (tempfile::tempdir().unwrap(), Barrier::new(2), AtomicBool::new(false));
    std::thread::scope(|scope| {
        let server = scope.spawn(|| {
            let device = run::simulated_device((scene, &limb), scene.seed(), mcu);
            started.wait();
            serve(&mut device.unwrap(), &mut port, &stop, |time_us, news| println!("{time_us} us: {news:?}"))
        });
        started.wait();
        let plan = softlimb_motion::plan(scene, &limb).unwrap();
        let planned = (limb.clone(), plan);
        let ended = run::run_behind(
            scene,
            planned,
            (&address, Some(SampleRequest::Codes)),
            None,
            folder.path(),
            &AtomicBool::new(false),
            |_| (),
        );
        stop.store(true, Ordering::Relaxed);
        server.join().unwrap().unwrap();
        ended.map(|files| (report::summary(&files.run), replayed(&files.log)))
    })
}

fn measured_rmse_pa(summary: &Summary) -> f64 {
    summary.pressure.measured_error_pa.as_ref().expect("the device measures").rmse
}
