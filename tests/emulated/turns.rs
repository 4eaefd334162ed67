//! What a turn of the controller costs on the processor of the device.

use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_protocol::{Command, CommandCode, DeviceState, Heartbeat, Outputs, SetpointKind};
use softlimb_rig::link;
use softlimb_rig::link::{DeviceConfiguration, Event, Knot, StreamOptions};
use softlimb_rig::simulate;
use softlimb_sim::SimulatedMcu;
use softlimb_sim::emulated::LockStep;

use crate::crash::host::{Host, SESSION, settings};
use crate::devices::Images;
use crate::support::scene_with;

/// Channels of the board.
const CHANNELS: usize = 9;

/// Cycles of the processor in a tick of 1 ms.
pub(crate) const TICK: u64 = 168_000;

/// Cycles that a turn should leave to everything else: it takes no more of its tick than this.
pub(crate) const SHARE: u64 = 50_000;

/// Cycles of an instruction, more than turns take on average: 1.6 to 1.7 by `firmware/boards/mps2-an386/counts.tsv`, which also has 1.9 for
/// solvers of the wound tube.
pub(crate) const CYCLES: u64 = 2;

#[test]
fn turns_that_solve_the_model_end_within_their_tick() {
    let Some(images) = Images::find("turns_that_solve_the_model_end_within_their_tick") else {
        return;
    };
    let twin = LockStep::start(&images.twin()).expect("the twin starts");
    let mut host = Host::on(SimulatedMcu::with_processor(&settings(CHANNELS), twin).expect("good settings"));
    host.get_ready(CHANNELS, SetpointKind::AxialStretch);
    let configuration = host.mcu.processor_mut().take_cost();
    println!("turns up to the end of the configuration: {configuration:?}");
    assert!(CYCLES * configuration.worst < TICK, "{configuration:?}");
    host.wait(1_000_000);
    let start_us = host.mcu.device_time_us() + 100_000;
    for index in 0..50 {
        let stretch = 1_000_000 + 1_000 * (1 + i32::try_from(index).expect("few"));
        host.setpoint(index, start_us + 20_000 * u64::from(index) + 1_000, &[stretch; CHANNELS]);
        host.wait(1_000);
    }
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us });
    for _ in 0..20 {
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        host.wait(50_000);
    }
    assert!(host.telemetry().any(|telemetry| telemetry.state == DeviceState::Running), "it ran");
    let cost = host.mcu.processor().cost();
    println!("turns with the model solved for every channel: {cost:?}");
    assert!(cost.turns > 1_000 && CYCLES * cost.worst <= SHARE, "{cost:?}");
}

/// The twin with the plant of a scene, the scene's configuration, and its knots.
pub(crate) fn with_scene(images: &Images) -> (SimulatedMcu<LockStep>, DeviceConfiguration, Vec<Knot>) {
    let scene = scene_with("weightless-a", "");
    let limb = Limb::new(&scene).expect("a limb");
    let plan = motion::plan(&scene, &limb).expect("a plan");
    let inverses = motion::inverses(&scene, &limb).expect("tables");
    let configuration = softlimb_rig::configuration(&scene, &inverses, &limb);
    let row = |values: &Vec<i32>| -> Vec<i32> {
        limb.modules().iter().zip(values).flat_map(|(module, value)| module.channels.clone().map(|_| *value)).collect()
    };
    let rows = plan.knots().iter().zip(0..);
    let knot = |(values, index): (&Vec<i32>, u64)| {
        let outputs = Outputs::default().with(Outputs::GRIPPER, index % 2 == 0);
        Knot { time_us: index * plan.knot_period_us(), outputs, values: row(values) }
    };
    let knots = rows.map(knot).collect();
    let twin = LockStep::start(&images.twin()).expect("the twin starts");
    let device = SimulatedMcu::with_processor(&simulate::settings(&scene, &limb, 1), twin).expect("good settings");
    (device, configuration, knots)
}

#[test]
fn turns_of_a_scene_leave_two_thirds_of_their_tick() {
    let Some(images) = Images::find("turns_of_a_scene_leave_two_thirds_of_their_tick") else { return };
    let (mut device, configuration, knots) = with_scene(&images);
    link::stream(&mut device, &configuration, &knots, &StreamOptions::new(7), |device, event| {
        if matches!(event, Event::Configured { .. }) {
            let cost = device.processor_mut().take_cost();
            println!("turns up to the end of the configuration: {cost:?}");
            assert!(CYCLES * cost.worst < TICK, "{cost:?}");
        }
    })
    .expect("it runs");
    let cost = device.processor().cost();
    println!("turns of the scene: {cost:?}");
    assert!(cost.turns > 19_000 && CYCLES * cost.worst <= SHARE, "{cost:?}");
}
