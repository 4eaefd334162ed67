//! Runs that do not go as planned: what the user reads, what becomes of the pressures.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::link_common::*;
use softlimb_protocol::*;
use softlimb_rig::link::{DeviceConfiguration, Ending, Event, LinkError, StreamOptions, Summary, VentOutcome, stream};
use softlimb_sim::plant::PartFault;
use softlimb_sim::{LineFaults, SimSettings, SimulatedMcu};

/// Runs 4 s of setpoints and lets `act` do something once, `after_us` after the start.
fn disturbed(
    mcu: &mut SimulatedMcu,
    channels: usize,
    options: &StreamOptions<'_>,
    after_us: u64,
    act: impl FnOnce(&mut SimulatedMcu),
) -> (Result<Summary, LinkError>, Told) {
    disturbed_with(mcu, &configuration(channels), options, after_us, act)
}

fn disturbed_with(
    mcu: &mut SimulatedMcu,
    configuration: &DeviceConfiguration,
    options: &StreamOptions<'_>,
    after_us: u64,
    act: impl FnOnce(&mut SimulatedMcu),
) -> (Result<Summary, LinkError>, Told) {
    let (mut told, mut act) = (Told::default(), Some(act));
    let knots = knots(configuration.channels.len(), 4.0);
    let result = stream(mcu, configuration, &knots, options, |mcu: &mut SimulatedMcu, event| {
        told.take(event);
        if told.start_us > 0
            && mcu.device_time_us() >= told.start_us + after_us
            && let Some(act) = act.take()
        {
            act(mcu);
        }
    });
    (result, told)
}

/// The cause and the time of a run given up.
fn cause(result: Result<Summary, LinkError>) -> (LinkError, u64, VentOutcome) {
    match result.expect_err("the run cannot succeed") {
        LinkError::Run { at_us, vent, cause } => (*cause, at_us.expect("it had started"), vent),
        error => panic!("not during the run: {error}"),
    }
}

/// Limit of the channel whose reading gets too high, Pa.
const LIMIT_PA: f32 = 60e3;

#[test]
fn over_pressure_is_named_with_channel_and_pressure() {
    let mut mcu = device(&settings(3));
    let options = StreamOptions::new(SESSION);
    // The codes double: 30 kPa read more than 80.
    let mut configuration = configuration(3);
    configuration.channels[1].pressure_max_pa = LIMIT_PA;
    configuration.channels[1].setpoint_max = 50_000;
    configuration.volumes[1].pressure_max_pa = LIMIT_PA;
    let sag = |mcu: &mut SimulatedMcu| mcu.inject(1, PartFault::ReferenceSag { share: 0.5 }).unwrap();
    let (result, told) = disturbed_with(&mut mcu, &configuration, &options, 1_500_000, sag);
    let text = result.as_ref().unwrap_err().to_string();
    let (error, at_us, vent) = cause(result);
    let LinkError::Fault { fault: Some(fault) } = error else { panic!("{error}") };
    assert_eq!((fault.code, fault.channel), (FaultCode::OverPressure.into(), Some(1)));
    assert!(f64::from(fault.value.unwrap()) > f64::from(LIMIT_PA));
    assert_eq!(fault.time_us, Some(told.start_us + at_us));
    assert!((1_500_000..3_000_000).contains(&at_us), "{at_us}");
    assert_eq!(vent, VentOutcome::ByDevice);
    let pressure_kpa = f64::from(fault.value.unwrap()) * 1e-3;
    assert!(text.contains(&format!("over-pressure on channel 1 at {pressure_kpa:.1} kPa")), "{text}");
    assert_eq!(mcu.controller().state(), DeviceState::Faulted);
}

#[test]
fn fill_valve_that_stays_open_is_named_before_the_limit() {
    let mut mcu = device(&settings(3));
    let options = StreamOptions::new(SESSION);
    let open = |mcu: &mut SimulatedMcu| mcu.inject(1, PartFault::FillStuckOpen).unwrap();
    let (result, _) = disturbed(&mut mcu, 3, &options, 1_500_000, open);
    let text = result.as_ref().unwrap_err().to_string();
    let (error, at_us, _) = cause(result);
    let LinkError::Fault { fault: Some(fault) } = error else { panic!("{error}") };
    assert_eq!((fault.code, fault.channel), (FaultCode::ExcessAir.into(), Some(1)));
    assert!((1_500_000..1_800_000).contains(&at_us), "{at_us}");
    let pressure_kpa = f64::from(fault.value.unwrap()) * 1e-3;
    assert!(text.contains("more air than the valves explain"), "{text}");
    assert!(text.contains(&format!("on channel 1 at {pressure_kpa:.1} kPa")), "{text}");
    assert!(mcu.peak_chamber_pa()[1] < f64::from(PRESSURE_MAX_PA), "{:?}", mcu.peak_chamber_pa());
}

#[test]
fn latched_fault_is_reported_and_cleared_only_on_request() {
    let mut mcu = device(&settings(1));
    let options = StreamOptions::new(SESSION);
    let press = |mcu: &mut SimulatedMcu| mcu.set_emergency_stop(true);
    let (result, _) = disturbed(&mut mcu, 1, &options, 500_000, press);
    let (error, _, _) = cause(result);
    assert_eq!(error.to_string(), "the device stopped: emergency stop");

    mcu.set_emergency_stop(false);
    mcu.advance_to(mcu.now_us() + 5_000_000);
    let again = StreamOptions::new(SESSION + 1);
    let error = stream(&mut mcu, &configuration(1), &knots(1, 1.0), &again, |_, _| {}).unwrap_err();
    assert!(matches!(error, LinkError::LatchedFault { .. }), "{error}");
    assert!(error.to_string().contains("emergency stop"), "{error}");

    let clearing = StreamOptions { clear_faults: true, ..StreamOptions::new(SESSION + 2) };
    mcu.advance_to(mcu.now_us() + 1_000_000);
    stream(&mut mcu, &configuration(1), &knots(1, 1.0), &clearing, |_, _| {}).unwrap();
}

#[test]
fn cut_link_ends_the_run_and_the_device_holds_then_ramps_down() {
    let mut mcu = device(&settings(2));
    let options = StreamOptions { silence_max_us: 500_000, ..StreamOptions::new(SESSION) };
    let cut = |mcu: &mut SimulatedMcu| mcu.set_line_faults(LineFaults::CUT).unwrap();
    let (result, told) = disturbed(&mut mcu, 2, &options, 1_500_000, cut);
    let (error, at_us, vent) = cause(result);
    assert!(matches!(error, LinkError::Silent { .. }), "{error}");
    assert!((2_000_000..2_100_000).contains(&at_us), "half a second after the cut: {at_us}");
    assert_eq!(vent, VentOutcome::Unconfirmed);

    // The device follows what it has: 64 knots of 20 ms, all but the one or two on their way when the line was cut.
    let running_until_us = until_state(&mut mcu, DeviceState::Holding) - told.start_us;
    assert!((2_700_000..2_800_000).contains(&running_until_us), "{running_until_us}");
    let held_pa = mcu.truth().channels[0].pressure_pa;
    let holding_us = until_state(&mut mcu, DeviceState::Venting) - told.start_us - running_until_us;
    assert!(holding_us.abs_diff(500_000) <= 2_000, "{holding_us}");
    let kept_pa = mcu.truth().channels[0].pressure_pa;
    assert!((kept_pa - held_pa).abs() < 3_000.0, "held: {held_pa} then {kept_pa}");

    // 20 kPa/s: half way down after half of the time.
    let half_us = (kept_pa / 2.0 / 20_000.0 * 1e6) as u64;
    mcu.advance_to(mcu.now_us() + half_us);
    let half_pa = mcu.truth().channels[0].pressure_pa;
    assert!((half_pa - kept_pa / 2.0).abs() < 2_500.0, "{half_pa} of {kept_pa}");
    until_state(&mut mcu, DeviceState::Ready);
    assert!(mcu.truth().channels.iter().all(|channel| channel.pressure_pa < 2_500.0));
}

/// Lets time pass until the controller is in a state; the device's time then.
fn until_state(mcu: &mut SimulatedMcu, state: DeviceState) -> u64 {
    for _ in 0..20_000 {
        if mcu.controller().state() == state {
            return mcu.device_time_us();
        }
        mcu.advance_to(mcu.next_tick_us());
    }
    panic!("still {:?}", mcu.controller().state());
}

#[test]
fn next_run_after_a_cut_takes_the_device_over_and_vents_it_first() {
    let mut mcu = device(&settings(1));
    let cut = |mcu: &mut SimulatedMcu| mcu.set_line_faults(LineFaults::CUT).unwrap();
    let impatient = StreamOptions { silence_max_us: 500_000, ..StreamOptions::new(SESSION) };
    let (result, _) = disturbed(&mut mcu, 1, &impatient, 1_500_000, cut);
    assert!(result.is_err());
    mcu.set_line_faults(LineFaults::NONE).unwrap();
    assert_eq!(mcu.controller().state(), DeviceState::Running, "it still has setpoints");
    let mut told = Told::default();
    let options = StreamOptions::new(SESSION + 1);
    stream(&mut mcu, &configuration(1), &knots(1, 1.0), &options, |_, event| told.take(event)).unwrap();
    assert_eq!(told.states[..2], [DeviceState::Running, DeviceState::Venting]);
}

#[test]
fn short_interruption_is_survived_even_if_the_device_noticed() {
    let mut mcu = device(&settings(1));
    // Nobody hears anybody for 300 ms; what the device says meanwhile is lost.
    let interrupt = |mcu: &mut SimulatedMcu| {
        mcu.set_line_faults(LineFaults::CUT).unwrap();
        mcu.advance_to(mcu.now_us() + 300_000);
        mcu.set_line_faults(LineFaults::NONE).unwrap();
    };
    let (result, told) = disturbed(&mut mcu, 1, &StreamOptions::new(SESSION), 1_500_000, interrupt);
    assert_eq!(result.unwrap().setpoints as usize, knots(1, 4.0).len() + 1);
    let noticed = told.running().filter(|message| message.fault_bits & FaultCode::LinkLost.bit() != 0).count();
    assert!(noticed > 0, "longer than the link timeout");
    let gap_us = told.running().zip(told.running().skip(1)).map(|(a, b)| b.time_us - a.time_us).max();
    assert!(gap_us >= Some(300_000), "{gap_us:?}");
}

#[test]
fn canceled_run_is_vented_and_no_error() {
    let cancel = AtomicBool::new(false);
    let mut mcu = device(&settings(2));
    let options = StreamOptions { cancel: Some(&cancel), ..StreamOptions::new(SESSION) };
    let (result, told) = disturbed(&mut mcu, 2, &options, 1_500_000, |_| cancel.store(true, Ordering::Relaxed));
    let summary = result.unwrap();
    assert_eq!(summary.ending, Ending::Canceled);
    assert_eq!(summary.start_us, Some(told.start_us));
    assert_eq!(mcu.controller().state(), DeviceState::Ready);
    assert!(mcu.truth().channels.iter().all(|channel| channel.pressure_pa < 2_500.0));
    let last_us = told.running().map(|message| message.time_us).max().unwrap() - told.start_us;
    assert!((1_490_000..1_540_000).contains(&last_us), "it stops at once: {last_us}");
}

#[test]
fn canceling_before_the_start_moves_nothing_and_during_venting_changes_nothing() {
    let run = |at: fn(&Event) -> bool| {
        let cancel = AtomicBool::new(false);
        let options = StreamOptions { cancel: Some(&cancel), ..StreamOptions::new(SESSION) };
        let mut mcu = device(&settings(1));
        let summary = stream(&mut mcu, &configuration(1), &knots(1, 1.0), &options, |_, event| {
            cancel.fetch_or(at(&event), Ordering::Relaxed);
        });
        (summary.unwrap(), mcu.truth().air_used_kg)
    };
    let (before, air_kg) = run(|event| matches!(event, Event::Configured { .. }));
    assert_eq!((before.ending, before.start_us, air_kg), (Ending::Canceled, None, 0.0));
    let (after, air_kg) = run(|event| matches!(event, Event::State(DeviceState::Venting)));
    assert_eq!(after.ending, Ending::Completed);
    assert!(air_kg > 0.0);
}

#[test]
fn supply_that_never_comes_up_is_named() {
    let mut settings = settings(1);
    settings.plant.supply = softlimb_sim::plant::Supply::Regulated { pressure_pa: 80e3 };
    let options = StreamOptions { supply_max_us: 3_000_000, ..StreamOptions::new(SESSION) };
    let error = stream(&mut device(&settings), &configuration(1), &knots(1, 1.0), &options, |_, _| {}).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("after 3 s; 150.0 kPa are needed"), "{text}");
    let LinkError::Run { at_us: None, cause, .. } = error else { panic!("{text}") };
    assert!(matches!(*cause, LinkError::NoSupply { found_pa, .. } if (found_pa - 80e3).abs() < 3e3));
}

#[test]
fn open_sensor_keeps_the_device_from_becoming_ready() {
    let mut mcu = device(&settings(2));
    mcu.inject(1, PartFault::SensorOpen).unwrap();
    let result = stream(&mut mcu, &configuration(2), &knots(2, 1.0), &StreamOptions::new(SESSION), |_, _| {});
    let LinkError::Run { cause, .. } = result.unwrap_err() else { panic!() };
    assert!(matches!(*cause, LinkError::NotReady { state: Some(DeviceState::Idle), .. }), "{cause}");
}

#[test]
fn refused_value_is_named_with_its_field_and_channel() {
    let mut configuration = configuration(3);
    configuration.channels[2].inner_radius_m = f32::NAN;
    let mut mcu = device(&settings(3));
    let error = stream(&mut mcu, &configuration, &knots(3, 1.0), &StreamOptions::new(SESSION), |_, _| {}).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("refuses ConfigChannel: inner_radius_m is out of range on channel 2"), "{text}");
    assert!(mcu.controller().config().is_none());
}

#[test]
fn setpoint_out_of_range_is_named_with_its_channel() {
    let mut knots = knots(2, 1.0);
    knots[20].values[1] = 110_001;
    let mut mcu = device(&settings(2));
    let error = stream(&mut mcu, &configuration(2), &knots, &StreamOptions::new(SESSION), |_, _| {}).unwrap_err();
    assert!(error.to_string().contains("refuses setpoint 20: channel 1 cannot take its value"), "{error}");
    assert!(error.to_string().ends_with("the limb is being vented"), "{error}");
    assert_eq!(mcu.controller().state(), DeviceState::Ready, "and nothing starts any more");
}

#[test]
fn setpoints_too_dense_for_the_buffer_are_refused_before_anything_moves() {
    let mut knots = knots(1, 4.0);
    (0..).zip(&mut knots).for_each(|(index, knot)| knot.time_us = index * 5_000);
    let error = stream(&mut device(&settings(1)), &configuration(1), &knots, &StreamOptions::new(SESSION), |_, _| {});
    let error = error.unwrap_err();
    assert!(matches!(error, LinkError::TooDense { capacity: 64, span_us: 315_000, .. }), "{error}");
}

#[test]
fn second_program_is_turned_away_while_the_first_one_speaks() {
    let mut mcu = device(&settings(1));
    let mut second = None;
    stream(
        &mut mcu,
        &configuration(1),
        &knots(1, 1.5),
        &StreamOptions::new(SESSION),
        |mcu: &mut SimulatedMcu, event| {
            if let Event::Telemetry { message, .. } = event
                && message.state == DeviceState::Running
                && second.is_none()
            {
                let options = StreamOptions::new(SESSION + 1);
                second = Some(stream(mcu, &configuration(1), &knots(1, 1.0), &options, |_, _| {}).unwrap_err());
            }
        },
    )
    .unwrap();
    assert!(matches!(second, Some(LinkError::Occupied)), "{second:?}");
}

#[test]
fn device_that_is_switched_off_is_a_clear_message() {
    let settings = SimSettings { line_faults: LineFaults::CUT, ..settings(1) };
    let error =
        stream(&mut device(&settings), &configuration(1), &knots(1, 1.0), &StreamOptions::new(SESSION), |_, _| {});
    assert_eq!(error.unwrap_err().to_string(), "no answer to Hello: is the device connected and switched on?");
}
