//! Prints how many times faster than real time the simulated device runs on one core with everything on: controller with the inverse
//! model in every control period, plant, line, telemetry every 10 ms.
//!
//! `cargo run --release -p softlimb-sim --example sim_speed [channels]`

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{Host, SESSION, settings};
use softlimb_plant::{PumpSettings, Supply};
use softlimb_protocol::{Command, CommandCode, DeviceState, Heartbeat, SetpointKind};
use softlimb_sim::SimSettings;

/// Simulated time, s.
const SECONDS: u64 = 30;
const KNOT_US: u64 = 20_000;
const KNOTS_AHEAD: u64 = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let channels = std::env::args().nth(1).map_or(Ok(9), |n| n.parse())?;
    let mut host = Host::new(&supplied(channels));
    host.get_ready(channels, SetpointKind::BendAngle);
    let first_us = host.mcu.device_time_us() + 500_000;
    for index in 0..KNOTS_AHEAD {
        host.setpoint(index as u32, first_us + index * KNOT_US, &values(index, channels));
        host.wait(2_000);
    }
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: first_us });
    while host.mcu.device_time_us() < first_us + KNOT_US {
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        host.wait(20_000);
    }

    let (started, from_us) = (Instant::now(), host.mcu.now_us());
    for index in KNOTS_AHEAD..KNOTS_AHEAD + SECONDS * 1_000_000 / KNOT_US {
        host.setpoint(index as u32, first_us + index * KNOT_US, &values(index, channels));
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        host.wait(KNOT_US);
    }
    let took_s = started.elapsed().as_secs_f64();
    let last = host.telemetry().last().ok_or("no telemetry")?;
    assert_eq!(last.state, DeviceState::Running, "it ran all the time: {last:?}");
    let simulated_us = host.mcu.now_us() - from_us;
    println!(
        "{channels} channels: {:.0} ticks/s, {:.0}x real time",
        simulated_us as f64 / 1_000.0 / took_s,
        simulated_us as f64 * 1e-6 / took_s
    );
    Ok(())
}

/// A supply that grows with the channels.
fn supplied(channels: usize) -> SimSettings {
    let mut settings = settings(channels);
    let times = (channels as f64 / 9.0).max(1.0);
    let nominal = PumpSettings::default();
    settings.plant.supply = Supply::Pump(PumpSettings {
        free_flow_normal_m3_per_s: times * nominal.free_flow_normal_m3_per_s,
        reservoir_volume_m3: times * nominal.reservoir_volume_m3,
        ..nominal
    });
    settings
}

/// Bend angles in microradians: a triangle of 8 s between 0.1 and 0.3 rad, shifted from channel to channel; slow enough for the pump.
fn values(index: u64, channels: usize) -> Vec<i32> {
    let angle = |channel: u64| {
        let phase = (index + 40 * channel) % 400;
        100_000 + 1_000 * phase.min(400 - phase) as i32
    };
    (0..channels as u64).map(angle).collect()
}
