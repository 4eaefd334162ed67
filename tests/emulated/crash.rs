//! When the program on the chip cannot go on: the air goes out, it starts anew, and says why it stopped.

#[path = "../../firmware/sim/tests/common/mod.rs"]
pub(crate) mod host;

use softlimb_firmware::{TickOutputs, ValvePulse};
use softlimb_protocol::*;
use softlimb_sim::SimulatedMcu;
use softlimb_sim::emulated::{Flashed, Halt};

use crate::devices::Images;
use host::{Host, SESSION, settings};

const CHANNELS: usize = 9;

/// A device that fills all its channels.
pub(crate) fn filling(flashed: Flashed) -> Host<Flashed> {
    let mut host = Host::on(SimulatedMcu::with_processor(&settings(CHANNELS), flashed).expect("good settings"));
    host.get_ready(CHANNELS, SetpointKind::Pressure);
    // A busy computer hands bytes over to the emulator late, by its time.
    let start_us = host.telemetry().last().expect("telemetry").time_us + 500_000;
    for index in 0..10 {
        host.setpoint(index, start_us + 50_000 * u64::from(index) + 1_000, &[100_000; CHANNELS]);
        host.wait(2_000);
    }
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us });
    let fills = |host: &Host<Flashed>| host.mcu.outputs().valves.iter().filter(|pulse| pulse.fill_us > 0).count();
    let mut waits = 0;
    while fills(&host) < CHANNELS {
        if waits % 20 == 0 {
            host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        }
        host.wait(1_000);
        waits += 1;
        assert!(waits < 700, "{} of {CHANNELS} fill", fills(&host));
    }
    host
}

/// Lets the channels fill up to more than a gauge pressure, Pa.
fn fill(host: &mut Host<Flashed>, above_pa: f64) {
    let mut waits = 0;
    while pressures(host).any(|pressure_pa| pressure_pa < above_pa) {
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        host.wait(10_000);
        waits += 1;
        assert!(waits < 200, "{:?}", pressures(host).collect::<Vec<_>>());
    }
}

/// Gauge pressures in the chambers, Pa.
fn pressures(host: &Host<Flashed>) -> impl Iterator<Item = f64> + use<> {
    host.mcu.truth().channels.into_iter().map(|channel| channel.pressure_pa)
}

/// What the next Hello says: why and where it stopped, and what it does now.
fn reason(host: &mut Host<Flashed>) -> (Option<BootCause>, u32, Option<DeviceState>) {
    let before = host.heard.len();
    host.demand(Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION + 1 });
    let reply = host.heard[before..].iter().find_map(|(_, message)| match message {
        DeviceMessage::HelloReply(reply) => Some((reply.boot_cause.known(), reply.boot_detail, reply.state.known())),
        _ => None,
    });
    reply.expect("a reply")
}

/// Outputs of the board's channels alone.
fn venting() -> TickOutputs {
    let mut outputs = TickOutputs::SAFE;
    outputs.valves[..CHANNELS].fill(ValvePulse::VENTING);
    outputs
}

#[test]
fn a_crash_empties_the_limb_and_is_told_at_the_next_hello() {
    let Some(images) = Images::find("a_crash_empties_the_limb_and_is_told_at_the_next_hello") else { return };
    let cases = [
        (Halt::HardFault, BootCause::HardFault, 0xf000_0000),
        (Halt::Panic { line: 4711 }, BootCause::Panic, 4711),
        // Without a stack nobody knows where it was.
        (Halt::StackOverflow, BootCause::HardFault, 0),
        (Halt::ClockFailure, BootCause::ClockFailure, 0),
    ];
    for (halt, cause, detail) in cases {
        let mut host = filling(Flashed::start(&images.flashed(), None).expect("the image starts"));
        fill(&mut host, 40e3);
        host.mcu.processor_mut().halt(halt).expect("the emulator takes it");
        // The tick in which it happens; what the next is told is what the new start begins with.
        host.wait(2_000);
        assert_eq!(host.mcu.outputs(), venting(), "{halt:?}");
        assert_eq!(reason(&mut host), (Some(cause), detail, Some(DeviceState::Venting)), "{halt:?}");
        let mut open_ms = 0;
        while host.mcu.outputs() == venting() && open_ms < 6_000 {
            host.wait(1_000);
            open_ms += 1;
        }
        let left_pa = pressures(&host).fold(f64::NEG_INFINITY, f64::max);
        println!("{halt:?}: at most {left_pa:.1} Pa are left");
        assert!(left_pa < 200.0, "{halt:?}: {left_pa} Pa are left");
        assert_eq!(host.mcu.outputs(), TickOutputs::SAFE, "{halt:?}: after {open_ms} ms");
        host.wait(500_000);
        assert_eq!(host.mcu.outputs(), TickOutputs::SAFE, "{halt:?}: nothing moves by itself");
        host.get_ready(CHANNELS, SetpointKind::Pressure);
        // The emulator discards what is written to its flash: the device says so, and goes on.
        host.demand(ReadLog { session: SESSION, first: 0 });
        let told = |host: &Host<Flashed>| {
            host.heard.iter().find_map(|(_, message)| match message {
                DeviceMessage::LogState(state) => Some((state.condition.known(), state.unstored, state.records)),
                _ => None,
            })
        };
        // On a busy computer, messages of the device arrive late in the emulator's time.
        let until_us = host.mcu.now_us() + 2_000_000;
        while told(&host).is_none() && host.mcu.now_us() < until_us {
            host.wait(1_000);
        }
        let log = told(&host);
        assert_eq!(log, Some((Some(LogCondition::Failed), 1, 0)), "{halt:?}: the start alone");
    }
}

#[test]
fn turn_that_never_ends_leaves_no_valve_energized_after_two_ticks() {
    let Some(images) = Images::find("turn_that_never_ends_leaves_no_valve_energized_after_two_ticks") else { return };
    let mut host = filling(Flashed::start(&images.flashed(), None).expect("the image starts"));
    let began_us = host.mcu.now_us();
    assert_ne!(host.mcu.outputs(), TickOutputs::SAFE);
    host.mcu.processor_mut().halt(Halt::EndlessTurn).expect("the emulator takes it");
    // The tick whose turn was over, and the one that it decided.
    host.wait(2_000);
    for _ in 0..100 {
        host.wait(1_000);
        assert_eq!(host.mcu.outputs(), TickOutputs::SAFE, "{} us", host.mcu.now_us() - began_us);
    }
}

/// Entry of the vector table for an interrupt that the image never enables, from the start of flash.
const UNUSED_VECTOR: usize = 0x100;

#[test]
fn damaged_image_empties_the_limb_and_takes_part_in_nothing() {
    let Some(images) = Images::find("damaged_image_empties_the_limb_and_takes_part_in_nothing") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("damaged.elf");
    let mut image = std::fs::read(images.flashed()).expect("the image");
    // The first program header names the place of the vector table in the file, and its address.
    let word = |at: usize| u32::from_le_bytes(image[at..at + 4].try_into().expect("four bytes")) as usize;
    let header = word(0x1c);
    assert_eq!(word(header + 12), 0x0800_0000, "the first segment is the start of flash");
    let place = word(header + 4) + UNUSED_VECTOR;
    image[place] ^= 1 << 4;
    std::fs::write(&path, image).expect("a file");
    let flashed = Flashed::start(&path, None).expect("the image starts");
    let mut host = Host::on(SimulatedMcu::with_processor(&settings(CHANNELS), flashed).expect("good settings"));
    host.wait(5_000);
    assert_eq!(reason(&mut host), (Some(BootCause::ImageDamaged), 0, Some(DeviceState::Venting)));
    assert_eq!(host.mcu.outputs(), venting());
    host.wait(5_100_000);
    assert_eq!(host.mcu.outputs(), TickOutputs::SAFE);
    host.configure(CHANNELS, SetpointKind::Pressure);
    host.wait(500_000);
    let state = host.telemetry().last().map(|telemetry| telemetry.state.known());
    assert_ne!(state, Some(Some(DeviceState::Ready)));
    let start = Command { session: SESSION, code: CommandCode::Start.into(), time_us: host.mcu.now_us() };
    assert_eq!(host.ask(start), Some(ResultCode::WrongState));
    assert_eq!(host.mcu.outputs(), TickOutputs::SAFE);
}
