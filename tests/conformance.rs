//! What holds for every device alike: the controller in this process, its twin on an emulated processor, the flashed file on an
//! emulated chip.

#[path = "support/devices.rs"]
mod devices;
#[path = "../firmware/sim/tests/common/mod.rs"]
mod host;

use devices::Images;
use host::{Host, SESSION, settings};
use softlimb_firmware::{TickOutputs, ValvePulse};
use softlimb_protocol::*;
use softlimb_sim::emulated::{Flashed, LockStep};
use softlimb_sim::plant::PartFault;
use softlimb_sim::{Processor, SimulatedMcu, here};

/// Bytes that a board keeps for the stack.
const STACK: u16 = 8_192;

/// The board has nine channels.
const CHANNELS: usize = 9;

/// Time from the last telemetry to the start of a motion, us. On a busy computer, bytes reach an emulated port late in the emulator's time.
const LEAD_US: u64 = 1_500_000;

type Device = Host<Box<dyn Processor>>;

/// A way to switch a device on.
type Start = Box<dyn Fn() -> Box<dyn Processor>>;

/// All devices there are, with their names.
fn devices(test: &str) -> Vec<(&'static str, Start)> {
    let mut devices: Vec<(&'static str, Start)> = vec![("here", Box::new(|| Box::new(here())))];
    if let Some(images) = Images::find(test) {
        let (twin, flashed) = (images.twin(), images.flashed());
        devices.push(("twin", Box::new(move || Box::new(LockStep::start(&twin).expect("the twin starts")))));
        devices
            .push(("flashed", Box::new(move || Box::new(Flashed::start(&flashed, None).expect("the image starts")))));
    }
    devices
}

/// Runs a check on every device, each with the same plant of nine actuators.
fn on_every_device(test: &str, check: impl Fn(&str, &mut Device)) {
    for (name, start) in devices(test) {
        let mcu = SimulatedMcu::with_processor(&settings(CHANNELS), start()).expect("good settings");
        let mut host = Host::on(mcu);
        check(name, &mut host);
        assert!(host.mcu.failure().is_none(), "{name}: {:?}", host.mcu.failure());
    }
}

fn hello() -> Hello {
    Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION }
}

fn state(host: &Device) -> Option<DeviceState> {
    host.telemetry().last().and_then(|telemetry| telemetry.state.known())
}

/// Lets time pass with a sign of life every 50 ms.
fn live(host: &mut Device, us: u64) {
    for _ in 0..us / 50_000 {
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        host.wait(50_000);
    }
}

/// Waits for a message of the device, 2 s at most: a busy computer may take that long for an emulated port.
fn hear<T>(host: &mut Device, name: &str, wanted: impl Fn(&DeviceMessage) -> Option<T>) -> T {
    let until_us = host.mcu.now_us() + 2_000_000;
    loop {
        if let Some(found) = host.heard.iter().find_map(|(_, message)| wanted(message)) {
            return found;
        }
        assert!(host.mcu.now_us() < until_us, "{name} is silent");
        host.wait(1_000);
    }
}

#[test]
fn a_device_that_is_switched_on_answers_within_100_ms() {
    on_every_device("a_device_that_is_switched_on_answers_within_100_ms", |name, host| {
        host.send(hello());
        let reply = hear(host, name, |message| match message {
            DeviceMessage::HelloReply(reply) => Some(reply.clone()),
            _ => None,
        });
        // On a busy computer, answers of the emulated port arrive late in the emulator's time. Its reply states when it answered.
        let answered_us = if name == "flashed" { reply.mcu_time_us } else { host.mcu.now_us() };
        assert!(answered_us <= 100_000, "{name}: after {answered_us} us");
        assert_eq!((reply.boot_cause.known(), reply.boot_detail), (Some(BootCause::PowerOn), 0), "{name}");
        assert_eq!((reply.state.known(), reply.config_hash), (Some(DeviceState::Idle), 0), "{name}");
        assert_eq!(host.mcu.outputs(), TickOutputs::SAFE, "{name}");
    });
}

#[test]
fn without_a_sensor_nothing_can_be_started() {
    on_every_device("without_a_sensor_nothing_can_be_started", |name, host| {
        host.mcu.inject(4, PartFault::SensorOpen).expect("a channel");
        host.configure(CHANNELS, SetpointKind::Pressure);
        live(host, 500_000);
        assert_eq!(state(host), Some(DeviceState::Idle), "{name}");
        let start = Command { session: SESSION, code: CommandCode::Start.into(), time_us: 0 };
        assert_eq!(host.ask(start), Some(ResultCode::WrongState), "{name}");
        assert_eq!(host.mcu.outputs(), TickOutputs::SAFE, "{name}");
    });
}

#[test]
fn a_voltage_that_the_valves_lose_is_named_with_its_value() {
    on_every_device("a_voltage_that_the_valves_lose_is_named_with_its_value", |name, host| {
        host.get_ready(CHANNELS, SetpointKind::Pressure);
        live(host, 100_000);
        // The converter reads 24 V of 36.3 V as 2707 codes, and 4.8 V as 541.
        assert_eq!(host.telemetry().last().map(|telemetry| telemetry.valve_supply_mv), Some(23_996), "{name}");
        host.mcu.inject(0, PartFault::ValveSupplySag { share: 0.8 }).expect("a supply");
        live(host, 200_000);
        let fault = hear(host, name, |message| match message {
            DeviceMessage::Fault(fault) => Some(fault.clone()),
            _ => None,
        });
        assert_eq!((fault.code.known(), fault.channel), (Some(FaultCode::ValveSupplyLow), SYSTEM_CHANNEL), "{name}");
        assert_eq!((fault.value, state(host)), (4_795, Some(DeviceState::Faulted)), "{name}");
        let clear = Command { session: SESSION, code: CommandCode::ClearFaults.into(), time_us: 0 };
        assert_eq!(host.ask(clear), Some(ResultCode::WrongState), "{name}");
        host.mcu.inject(0, PartFault::ValveSupplySag { share: 0.0 }).expect("a supply");
        live(host, 50_000);
        let clear = Command { session: SESSION, code: CommandCode::ClearFaults.into(), time_us: 0 };
        assert_eq!(host.ask(clear), Some(ResultCode::Ok), "{name}");
    });
}

#[test]
fn a_pressure_is_reached_and_held() {
    on_every_device("a_pressure_is_reached_and_held", |name, host| {
        host.get_ready(CHANNELS, SetpointKind::Pressure);
        live(host, 1_000_000);
        let device_us = host.telemetry().last().expect("telemetry").time_us;
        let start_us = device_us + LEAD_US;
        for index in 0..20 {
            // A second up, a second held.
            let value = 6_000 * (1 + i32::try_from(index).expect("few")).min(10);
            let time_us = start_us + 100_000 * u64::from(index) + 1_000;
            host.setpoint(index, time_us, &[value; CHANNELS]);
            host.wait(2_000);
        }
        host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us });
        live(host, LEAD_US + 1_800_000);
        let running: Vec<_> = host.telemetry().filter(|telemetry| telemetry.state == DeviceState::Running).collect();
        let last = running.last().unwrap_or_else(|| panic!("{name} did not run"));
        // Ten control periods: the sensor sits at the valves, where the pressure jumps while one of them is open.
        let end = running.get(running.len().saturating_sub(20)..).unwrap_or_default();
        for channel in 0..CHANNELS {
            let samples = end.iter().filter_map(|telemetry| telemetry.channels.get(channel));
            let errors = samples.map(|sample| i32::from(sample.pressure_10pa) - i32::from(sample.reference_10pa));
            let mean = errors.sum::<i32>() / 20;
            // The controller's smallest pulse.
            assert!(mean.abs() < 75, "{name}: channel {channel} is off by {mean}0 Pa");
            assert!(last.channels.get(channel).is_some_and(|sample| sample.reference_10pa > 5_900), "{name}: {last:?}");
        }
        assert_eq!(last.ticks_late, 0, "{name}");
        println!("{name}: {} bytes of stack used", last.stack_used);
        assert!(last.stack_used < STACK / 2, "{name}: {} of {STACK} bytes of stack used", last.stack_used);
    });
}

#[test]
fn an_emergency_stop_opens_every_vent_within_a_tick() {
    on_every_device("an_emergency_stop_opens_every_vent_within_a_tick", |name, host| {
        host.get_ready(CHANNELS, SetpointKind::Pressure);
        host.send(Command { session: SESSION, code: CommandCode::EmergencyStop.into(), time_us: 0 });
        let vents =
            |outputs: &TickOutputs| outputs.valves.iter().filter(|pulse| **pulse == ValvePulse::VENTING).count();
        let until_us = host.mcu.now_us() + 2_000_000;
        while vents(&host.mcu.outputs()) < CHANNELS && host.mcu.now_us() < until_us {
            host.wait(1_000);
        }
        let vented_us = host.mcu.device_time_us() - 1_000;
        assert!(!host.mcu.outputs().supply_open && host.mcu.outputs().pump_duty == 0, "{name}");
        let fault_us = hear(host, name, |message| match message {
            DeviceMessage::Fault(fault) if fault.code == FaultCode::EmergencyStop => Some(fault.time_us),
            _ => None,
        });
        assert!(vented_us.saturating_sub(fault_us) <= 1_000, "{name}: {fault_us} us, vented at {vented_us} us");
    });
}

#[test]
fn after_a_crash_the_limb_is_emptied_before_the_device_takes_a_configuration() {
    let test = "after_a_crash_the_limb_is_emptied_before_the_device_takes_a_configuration";
    on_every_device(test, |name, host| {
        host.get_ready(CHANNELS, SetpointKind::Pressure);
        let start_us = host.telemetry().last().expect("telemetry").time_us + LEAD_US;
        for index in 0..10 {
            host.setpoint(index, start_us + 100_000 * u64::from(index) + 1_000, &[60_000; CHANNELS]);
            host.wait(2_000);
        }
        host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us });
        live(host, LEAD_US + 1_300_000);
        let pressures = |host: &Device| host.mcu.truth().channels.into_iter().map(|channel| channel.pressure_pa);
        let lowest_pa = pressures(host).fold(f64::INFINITY, f64::min);
        assert!(lowest_pa > 50e3, "{name}: {lowest_pa} Pa");
        host.mcu.processor_mut().crash().expect("it does");
        // The tick in which it happens, and the first of the new start.
        host.wait(2_000);
        let mut open_ms = 0;
        while is_venting(&host.mcu.outputs()) && open_ms < 6_000 {
            host.wait(1_000);
            open_ms += 1;
            if open_ms == 100 {
                let before = host.heard.len();
                host.demand(Hello { session: SESSION + 1, ..hello() });
                let reply = host.heard[before..].iter().find_map(|(_, message)| match message {
                    DeviceMessage::HelloReply(reply) => Some((reply.boot_cause.known(), reply.state.known())),
                    _ => None,
                });
                assert_eq!(reply, Some((Some(BootCause::HardFault), Some(DeviceState::Venting))), "{name}");
                for code in [CommandCode::Start, CommandCode::Hold, CommandCode::Vent] {
                    let refused = host.ask(Command { session: SESSION + 1, code: code.into(), time_us: 0 });
                    assert_eq!(refused, Some(ResultCode::WrongState), "{name}: {code:?}");
                }
                let commit = host.ask(ConfigCommit { session: SESSION + 1, config_hash: 0 });
                assert_eq!(commit, Some(ResultCode::WrongState), "{name}");
            }
        }
        let highest_pa = pressures(host).fold(f64::NEG_INFINITY, f64::max);
        println!("{name}: from {lowest_pa:.0} Pa at least to {highest_pa:.1} Pa at most");
        assert!(highest_pa < 200.0, "{name}: {highest_pa} Pa are left");
        assert_eq!(host.mcu.outputs(), TickOutputs::SAFE, "{name}: after {open_ms} ms");
        host.get_ready(CHANNELS, SetpointKind::Pressure);
    });
}

/// Whether the vents of all channels are open and nothing else is on.
fn is_venting(outputs: &TickOutputs) -> bool {
    let vents = outputs.valves.iter().take(CHANNELS).all(|pulse| *pulse == ValvePulse::VENTING);
    let fills = outputs.valves.iter().any(|pulse| pulse.fill_us > 0);
    vents && !fills && !outputs.supply_open && outputs.pump_duty == 0
}

#[test]
fn a_flood_of_garbage_delays_no_tick() {
    on_every_device("a_flood_of_garbage_delays_no_tick", |name, host| {
        host.get_ready(CHANNELS, SetpointKind::Pressure);
        let before = host.telemetry().count();
        let mut word = 0x2545_f491_u32;
        for _ in 0..500 {
            // As much as the line carries: 92 bytes a millisecond.
            let garbage: Vec<u8> = std::iter::repeat_with(|| {
                word ^= word << 13;
                word ^= word >> 17;
                word ^= word << 5;
                word as u8
            })
            .take(92)
            .collect();
            host.mcu.write(&garbage);
            host.wait(1_000);
        }
        let times: Vec<u64> = host.telemetry().skip(before).map(|telemetry| telemetry.time_us).collect();
        assert!(times.len() > 45, "{name}: {} messages", times.len());
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] == 10_000), "{name}: {times:?}");
        assert_eq!(host.telemetry().last().map(|telemetry| telemetry.ticks_late), Some(0), "{name}");
    });
}
