//! Prints how many times faster than real time the simulated device runs on one core with everything on: controller with the inverse
//! model in every control period, plant, line, telemetry every 10 ms.
//!
//! `cargo run --release -p softlimb-sim --example speed [channels]`

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{Host, SESSION, settings};
use softlimb_protocol::{Command, CommandCode, DeviceState, Heartbeat, SetpointKind};

/// Simulated time, s.
const SECONDS: u64 = 30;
const KNOT_US: u64 = 20_000;
const KNOTS_AHEAD: u64 = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let channels = std::env::args().nth(1).map_or(Ok(9), |n| n.parse())?;
    let mut host = Host::new(&settings(channels));
    host.get_ready(channels, SetpointKind::BendAngle);
    let first_us = host.mcu.device_time_us() + 500_000;
    for index in 0..KNOTS_AHEAD {
        host.setpoint(index as u32, first_us + index * KNOT_US, &values(index, channels));
        host.wait(2_000);
    }
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: first_us });
    while host.mcu.device_time_us() < first_us + KNOT_US {
        host.wait(1_000);
    }

    let (started, from_us) = (Instant::now(), host.mcu.now_us());
    for index in KNOTS_AHEAD..KNOTS_AHEAD + SECONDS * 1_000_000 / KNOT_US {
        host.setpoint(index as u32, first_us + index * KNOT_US, &values(index, channels));
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        host.wait(KNOT_US);
    }
    let took_s = started.elapsed().as_secs_f64();
    assert_eq!(host.mcu.controller().state(), DeviceState::Running, "it ran all the time");
    let simulated_us = host.mcu.now_us() - from_us;
    println!(
        "{channels} channels: {:.0} ticks/s, {:.0}x real time",
        simulated_us as f64 / 1_000.0 / took_s,
        simulated_us as f64 * 1e-6 / took_s
    );
    Ok(())
}

/// Bend angles in microradians: a triangle of 2.8 s between 0.1 and 0.31 rad, shifted from channel to channel.
fn values(index: u64, channels: usize) -> Vec<i32> {
    let angle = |channel: u64| {
        let phase = (index + 15 * channel) % 140;
        100_000 + 3_000 * phase.min(140 - phase) as i32
    };
    (0..channels as u64).map(angle).collect()
}
