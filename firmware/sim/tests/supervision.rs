//! Supervision: broken parts are noticed before a chamber gets too much pressure, and sound plants raise no fault.

use crate::common::{Host, SESSION, settings};
use crate::samples::samples;
use softlimb_plant::{MotionSettings, PartFault, PlantSettings, Spread, Supply};
use softlimb_protocol::*;
use softlimb_sim::SimSettings;

const CHANNELS: usize = 3;
const KNOT_US: u64 = 20_000;
/// Knots in the buffer at least, and in one portion.
const LEAD: u64 = 40;
const PORTION: u64 = 10;

/// Limit of the channels, Pa, and the excess that a chamber of 30 mL or more survives.
const LIMIT_PA: f64 = 150e3;
const EXCESS_PA: f64 = 12e3;

/// Reference of the matrix, Pa: a fill to near the limit, a hold, a fall, a hold, and a sine.
fn reference_pa(time_s: f64) -> f64 {
    let ramp = |from_s: f64, to_s: f64| ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
    let sine = if time_s > 12.0 { 35e3 * (3.0 * (time_s - 12.0)).sin() } else { 0.0 };
    5e3 + 135e3 * ramp(0.5, 1.5) - 80e3 * ramp(7.0, 8.0) + sine
}

/// Phases of that reference: name and the time at which a part breaks, s.
const PHASES: [(&str, f64); 4] = [("fill", 1.2), ("hold", 2.5), ("fall", 7.4), ("tracking", 12.6)];
const END_S: f64 = 17.0;

/// What a device told: the first fault with its time after the start, and all that were told.
struct Told {
    first: Option<(FaultCode, u8, f64)>,
    all: Vec<(FaultCode, u8)>,
    host: Host,
}

/// Runs a reference for `end_s`, and breaks a part at a time.
fn run(mut host: Host, reference_pa: &dyn Fn(f64) -> f64, end_s: f64, fault: Option<(PartFault, usize, f64)>) -> Told {
    host.get_ready(CHANNELS, SetpointKind::Pressure);
    let start_us = host.mcu.device_time_us() + 100_000;
    let end = (end_s * 1e6) as u64 / KNOT_US;
    let mut sent = 0;
    let mut send = |host: &mut Host, until: u64| {
        while sent < until.min(end) {
            let value = reference_pa((sent * KNOT_US) as f64 * 1e-6) as i32;
            host.setpoint(sent as u32, start_us + sent * KNOT_US, &[value; CHANNELS]);
            sent += 1;
        }
    };
    send(&mut host, LEAD);
    host.wait(90_000 - 40_000);
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us });
    let mut fault = fault;
    let mut portion = 0;
    while portion < end {
        if let Some((part, channel, _)) = fault.take_if(|(_, _, at_s)| portion * KNOT_US >= (*at_s * 1e6) as u64) {
            host.mcu.inject(channel, part).expect("a part of the plant");
        }
        host.send(Heartbeat { session: SESSION, host_time_us: host.mcu.now_us() });
        send(&mut host, portion + LEAD + PORTION);
        host.wait(PORTION * KNOT_US);
        portion += PORTION;
    }
    let told = host.heard.iter().filter_map(|(_, message)| match message {
        DeviceMessage::Fault(fault) => {
            Some((fault.code.known()?, fault.channel, (fault.time_us as f64 - start_us as f64) * 1e-6))
        }
        _ => None,
    });
    let told: Vec<_> = told.filter(|(code, ..)| *code != FaultCode::SetpointsExhausted).collect();
    Told { first: told.first().copied(), all: told.iter().map(|&(code, channel, _)| (code, channel)).collect(), host }
}

/// A plant of workshop tolerances.
fn plant(seed: u64) -> SimSettings {
    let mut settings = settings(CHANNELS);
    (settings.plant.seed, settings.plant.noise_seed, settings.seed) = (seed, seed, seed);
    settings
}

/// A fault, the codes that may name it, and the phases in which it has to be found.
type Row = (&'static str, &'static [FaultCode], &'static [&'static str]);

const ALWAYS: &[&str] = &["fill", "hold", "fall", "tracking"];

/// No fault brings a chamber far above its limit. Faults that would fill one unnoticed have to be named.
fn matrix() -> Vec<Row> {
    use FaultCode::*;
    let any: &[FaultCode] =
        &[SensorFrozen, ReadingJumped, FillWithoutEffect, ExcessAir, MissingAir, OverPressure, SupplyLow];
    vec![
        ("sensor-open", &[SensorImplausible], ALWAYS),
        ("sensor-frozen", &[SensorFrozen], ALWAYS),
        ("sensor-zero", &[ReadingJumped], ALWAYS),
        ("sensors-swapped", any, &["fill"]),
        ("coils-swapped", any, ALWAYS),
        ("fill-stuck-open", any, ALWAYS),
        ("fill-stuck-closed", any, ALWAYS),
        ("vent-stuck-open", any, ALWAYS),
        ("vent-stuck-closed", any, ALWAYS),
        ("burst", any, ALWAYS),
        ("leak", any, &[]),
        ("hose-kinked", any, &[]),
        ("supply-stuck-open", any, &[]),
        ("supply-stuck-closed", any, &["fill"]),
        ("valve-supply-sag", &[ValveSupplyLow], ALWAYS),
    ]
}

#[test]
fn every_part_that_breaks_is_noticed_before_it_hurts() {
    println!("{:<20} {:<9} {:>7}  {:<18} {:>6}  {:>8}", "fault", "phase", "channel", "told", "s", "peak kPa");
    let mut wrong = Vec::new();
    for (name, codes, phases) in matrix() {
        let part = PartFault::named(name).expect("a name");
        for ((phase, at_s), channel) in PHASES.into_iter().flat_map(|phase| (0..CHANNELS).map(move |c| (phase, c))) {
            let told = run(Host::new(&plant(7 + channel as u64)), &reference_pa, END_S, Some((part, channel, at_s)));
            let peak_pa = told.host.mcu.peak_chamber_pa().into_iter().fold(0.0, f64::max);
            let (code, after_s) =
                told.first.map_or(("-".into(), f64::NAN), |(code, _, time_s)| (format!("{code:?}"), time_s - at_s));
            println!("{name:<20} {phase:<9} {channel:>7}  {code:<18} {after_s:>6.2}  {:>8.1}", peak_pa * 1e-3);
            let is_named = told.first.is_some_and(|(code, ..)| codes.contains(&code));
            let is_as_told = if told.first.is_some() || phases.contains(&phase) { is_named } else { true };
            if peak_pa > LIMIT_PA + EXCESS_PA || !is_as_told {
                wrong.push(format!("{name} {phase} {channel}: {peak_pa:.0} Pa, {:?}", told.all));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Plain loops have no balance of the air. They vent the air of an open fill valve, and report another cause or none.
#[test]
fn plain_loops_keep_chambers_below_the_limit_and_do_not_name_the_valve() {
    use FaultCode::{OverPressure, SensorFrozen, SupplyLow};
    let open = PartFault::FillStuckOpen;
    for pressure_loop in [PressureLoopKind::ProportionalIntegral, PressureLoopKind::OnOff] {
        for ((phase, at_s), channel) in PHASES.into_iter().flat_map(|phase| (0..CHANNELS).map(move |c| (phase, c))) {
            let on = |settings: SimSettings| {
                let mut host = Host::new(&settings);
                host.system.pressure_loop = pressure_loop.into();
                let told = run(host, &reference_pa, END_S, Some((open, channel, at_s)));
                let peak_pa = told.host.mcu.peak_chamber_pa().into_iter().fold(0.0, f64::max);
                assert!(peak_pa < LIMIT_PA + 4e3, "{pressure_loop:?} {phase} {channel}: {peak_pa:.0} Pa");
                told.first.map(|(code, of, _)| (code, of))
            };
            let settings = plant(7 + channel as u64);
            assert_eq!(on(settings.clone()), Some((SupplyLow, SYSTEM_CHANNEL)), "{pressure_loop:?} {phase} {channel}");
            let supply = Supply::Regulated { pressure_pa: 200e3 };
            let told = on(SimSettings { plant: PlantSettings { supply, ..settings.plant }, ..settings });
            let of_channel = told.filter(|(_, of)| usize::from(*of) == channel).map(|(code, _)| code);
            assert!(
                told.is_none() || matches!(of_channel, Some(OverPressure | SensorFrozen)),
                "{pressure_loop:?} {phase} {channel}: {told:?}"
            );
        }
    }
}

/// Valves that are large for the chamber empty it between two measurements of a settled line.
#[test]
fn sound_plants_that_vent_to_zero_raise_no_fault() {
    for (seed, conductance_m3_per_s_pa) in (0..12).flat_map(|seed| [(seed, 1.44e-9), (seed, 3e-9), (seed, 5e-9)]) {
        let mut settings = plant(seed);
        settings.plant.supply = Supply::Regulated { pressure_pa: 200e3 };
        settings
            .plant
            .channels
            .iter_mut()
            .for_each(|channel| channel.valve.conductance_m3_per_s_pa = conductance_m3_per_s_pa);
        let mut host = Host::new(&settings);
        host.system.valve_conductance_m3_per_s_pa = conductance_m3_per_s_pa as f32;
        // A fill within 1 s, a rest, and a fall to zero within 60 ms, from another pressure each time.
        let reference = |time_s: f64| {
            let [turn, time_s] = [(time_s / 3.0).floor(), time_s % 3.0];
            let high_pa = 3e3 + 2e3 * (turn % 10.0);
            high_pa * (time_s.min(1.0) - ((time_s - 2.0) / 0.06).clamp(0.0, 1.0))
        };
        let told = run(host, &reference, 30.0, None);
        assert_eq!(told.all, [], "seed {seed}, {conductance_m3_per_s_pa} m3/(s Pa)");
    }
}

/// 3000 plants of 120 s are 100 h of a limb, the tenth of them 10 h.
#[test]
fn sound_plants_raise_no_fault() {
    for seed in 0..samples(3000) as u64 {
        let mut settings = plant(seed);
        settings.plant.supply = Supply::Regulated { pressure_pa: 200e3 };
        settings.plant.spread = Spread { volume: 0.1, valve_conductance: 0.067, valve_delay: 0.1, ..Spread::default() };
        for (channel, index) in settings.plant.channels.iter_mut().zip(0..) {
            channel.creep_share = 0.15;
            channel.wall_w_per_k = [0.25, 0.5, 1.0][(seed as usize / 2 + index) % 3];
            channel.leak_m3_per_s_pa = 1e-12;
            let amplitude_m3 = if (seed as usize + index).is_multiple_of(2) { 0.7e-6 } else { 0.0 };
            channel.motion = MotionSettings { amplitude_m3, frequency_hz: 2.0 };
        }
        let turn = seed as f64;
        let reference = |time_s: f64| {
            if seed % 4 == 3 {
                // Steps of 0.3 s, and rests of 2.2 s.
                let level_pa = |step: f64| 5e3 + 65e3 * (1.0 + (2.4 * step + turn).sin());
                let step = (time_s / 2.5).floor();
                let share = ((time_s - 2.5 * step) / 0.3).min(1.0);
                return level_pa(step - 1.0) + share * (level_pa(step) - level_pa(step - 1.0));
            }
            // Two sines, and a rest of 4 s in 16 s.
            let moved_s = 12.0 * (time_s / 16.0).floor() + (time_s % 16.0).min(12.0);
            70e3 + 40e3 * (0.7 * moved_s + turn).sin() + 25e3 * ((1.5 + turn % 3.0) * moved_s + 2.0 * turn).sin()
        };
        let told = run(Host::new(&settings), &reference, 120.0, None);
        assert_eq!(told.all, [], "seed {seed}");
    }
}
