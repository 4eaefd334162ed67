//! A quarter of an hour without a tick that is late, lost or told twice.

use softlimb_protocol::DeviceState;
use softlimb_rig::link;
use softlimb_rig::link::{Event, Knot, StreamOptions};

use crate::devices::Images;
use crate::turns::{CYCLES, SHARE, with_scene};

/// Ticks of 1 ms while running.
const TICKS: u64 = 1_000_000;
const TICK_US: u64 = 1_000;

/// A trajectory to its end, back to its beginning, and again, until the ticks are full.
fn back_and_forth(knots: &[Knot]) -> Vec<Knot> {
    let period_us = knots[1].time_us - knots[0].time_us;
    let back = knots[1..knots.len() - 1].iter().rev();
    let round = knots.iter().chain(back).cycle();
    let times = (0..).map(|index| index * period_us).take_while(|time_us| *time_us <= TICKS * TICK_US);
    times.zip(round).map(|(time_us, knot)| Knot { time_us, ..knot.clone() }).collect()
}

#[test]
fn no_tick_of_a_million_is_missed() {
    let Some(images) = Images::find("no_tick_of_a_million_is_missed") else { return };
    let (mut device, configuration, knots) = with_scene(&images);
    let period_us = u64::from(configuration.system.telemetry_period_us);
    let (mut told_us, mut told) = (None, 0);
    link::stream(&mut device, &configuration, &back_and_forth(&knots), &StreamOptions::new(7), |device, event| {
        match event {
            Event::Configured { .. } => drop(device.processor_mut().take_cost()),
            Event::Telemetry { message, .. } if message.state == DeviceState::Running => {
                let before = told_us.replace(message.time_us);
                let follows = before.is_none_or(|before| message.time_us == before + period_us);
                assert!(follows && message.ticks_late == 0 && message.fault_bits == 0, "{before:?}, {message:?}");
                told += 1;
            }
            _ => {}
        }
    })
    .expect("it runs");
    let cost = device.processor().cost();
    println!("{told} messages of {period_us} us, {cost:?}");
    assert!((told + 1) * period_us >= TICKS * TICK_US && cost.turns >= TICKS, "{told} messages, {cost:?}");
    assert!(CYCLES * cost.worst <= SHARE, "a turn may take {SHARE} cycles: {cost:?}");
}
