//! Whole runs on the simulated device: over a good line, a bad line, with a host that sleeps, and with a wrong clock.

use crate::link_common::*;
use softlimb_protocol::*;
use softlimb_rig::link::{Ending, Event, Knot, StreamOptions, Summary, Transport, stream};
use softlimb_sim::{LineFaults, SimulatedMcu};

fn run(mcu: &mut SimulatedMcu, channels: usize, knots: &[Knot]) -> (Summary, Told) {
    let mut told = Told::default();
    let summary =
        stream(mcu, &configuration(channels), knots, &StreamOptions::new(SESSION), |_, event| told.take(event))
            .expect("the run succeeds");
    (summary, told)
}

#[test]
fn run_over_a_good_line() {
    let (channels, knots) = (2, knots(2, 4.0));
    let mut mcu = device(&settings(channels));
    let (summary, told) = run(&mut mcu, channels, &knots);

    assert_eq!(summary.ending, Ending::Completed);
    assert_eq!(summary.setpoints as usize, knots.len() + 1, "the last one is repeated");
    assert_eq!(summary.statistics.setpoints_repeated, 0);
    assert_eq!(summary.statistics.messages_repeated, 0);
    assert_eq!(summary.statistics.received.rejected(), 0);
    assert!(summary.buffered_min_us.unwrap() > 500_000, "{:?}", summary.buffered_min_us);
    assert_eq!(told.end_us - told.start_us, 4_000_000);
    assert_eq!(told.faults, []);
    use DeviceState::*;
    // Idle lasts for one tick only.
    let states: Vec<_> = told.states.iter().copied().filter(|&state| state != Idle).collect();
    assert_eq!(states, [Ready, Running, Venting, Ready]);
    assert_tracks_the_knots(&told, &knots);
    assert_eq!(mcu.controller().state(), Ready);
    for channel in mcu.truth().channels {
        assert!(channel.pressure_pa < 2_500.0, "vented: {} Pa left", channel.pressure_pa);
    }
    let round_trip = summary.statistics.round_trip;
    assert!(round_trip.mean_us() <= 3_000, "wire and two ticks: {round_trip:?}");
}

#[test]
fn true_pressures_follow() {
    let (channels, knots) = (2, knots(2, 4.0));
    let mut mcu = device(&settings(channels));
    let (mut square, mut count, mut start_us) = (0.0, 0, 0);
    stream(
        &mut mcu,
        &configuration(channels),
        &knots,
        &StreamOptions::new(SESSION),
        |mcu: &mut SimulatedMcu, event| {
            if let Event::Armed { start_us: armed_us, .. } = event {
                start_us = armed_us;
            }
            let is_running =
                matches!(&event, Event::Telemetry { message, .. } if message.state == DeviceState::Running);
            let Some(time_us) = mcu.device_time_us().checked_sub(start_us).filter(|&t| is_running && t < 4_000_000)
            else {
                return;
            };
            for (channel, truth) in mcu.truth().channels.iter().enumerate() {
                square += (truth.pressure_pa - reference_pa(&knots, channel, time_us)).powi(2);
                count += 1;
            }
        },
    )
    .unwrap();
    let rmse_pa = f64::sqrt(square / f64::from(count));
    println!("true pressure against the setpoints: {rmse_pa:.0} Pa RMS over {count} samples");
    assert!(count > 700 && rmse_pa < 1_500.0, "{rmse_pa} Pa");
}

#[test]
fn corrupted_bytes_cost_repetitions_and_nothing_else() {
    let (channels, knots) = (3, knots(3, 6.0));
    for seed in 0..4 {
        let mut settings = settings(channels);
        settings.line_faults = LineFaults { flip: 0.01, ..LineFaults::NONE };
        settings.seed = seed;
        let mut mcu = device(&settings);
        let (summary, told) = run(&mut mcu, channels, &knots);
        // The device accepts only the next index: as many accepted as sent means each once, in order.
        assert_eq!(summary.setpoints as usize, knots.len() + 1);
        assert_eq!(mcu.controller().queue().next_index(), summary.setpoints, "the device counts the same");
        assert!(summary.statistics.setpoints_repeated > 50, "{summary:?}");
        assert!(summary.statistics.received.rejected() > 100);
        assert!(!told.states.contains(&DeviceState::Holding), "never without setpoints: {:?}", told.states);
        assert_tracks_the_knots(&told, &knots);
        println!("seed {seed}: {:?}, buffered at least {:?} us", summary.statistics, summary.buffered_min_us);
    }
}

#[test]
fn lost_and_doubled_bytes_are_survived_too() {
    let (channels, knots) = (1, knots(1, 4.0));
    let mut settings = settings(channels);
    settings.line_faults = LineFaults { drop: 0.005, flip: 0.005, duplicate: 0.005 };
    let (summary, told) = run(&mut device(&settings), channels, &knots);
    assert_eq!(summary.setpoints as usize, knots.len() + 1);
    assert_tracks_the_knots(&told, &knots);
}

/// A host that is not scheduled for a while: the device goes on, bytes pile up.
struct Sleepy {
    mcu: SimulatedMcu,
    from_us: u64,
    length_us: u64,
}

impl Transport for Sleepy {
    fn now_us(&self) -> u64 {
        self.mcu.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        Transport::send(&mut self.mcu, bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> std::io::Result<()> {
        Transport::receive(&mut self.mcu, into)
    }

    fn wait_until(&mut self, deadline_us: u64) {
        if self.length_us > 0 && self.mcu.now_us() >= self.from_us {
            self.mcu.advance_to(self.from_us + std::mem::take(&mut self.length_us));
        }
        self.mcu.wait_until(deadline_us);
    }
}

#[test]
fn host_stall_of_600_ms_is_bridged_by_the_buffer() {
    let (channels, knots) = (2, knots(2, 4.0));
    let mut sleepy = Sleepy { mcu: device(&settings(channels)), from_us: 2_000_000, length_us: 600_000 };
    let mut told = Told::default();
    let summary =
        stream(&mut sleepy, &configuration(channels), &knots, &StreamOptions::new(SESSION), |_, e| told.take(e))
            .unwrap();
    assert_eq!(sleepy.length_us, 0, "it did sleep");
    assert_eq!(summary.setpoints as usize, knots.len() + 1);
    assert!(!told.states.contains(&DeviceState::Holding), "{:?}", told.states);
    assert_tracks_the_knots(&told, &knots);
    let left_us = summary.buffered_min_us.unwrap();
    assert!((500_000..750_000).contains(&left_us), "1.28 s of buffer less 0.6 s: {left_us}");
}

#[test]
fn device_whose_clock_is_wrong_and_fast_runs_by_its_own_time() {
    let (channels, knots) = (1, knots(1, 20.0));
    let mut settings = settings(channels);
    settings.clock_offset_us = 86_400_000_000;
    settings.clock_drift_ppm = 150.0;
    let mut mcu = device(&settings);
    let (mut worst_us, mut sleep) = (0.0_f64, None);
    let summary = stream(
        &mut mcu,
        &configuration(channels),
        &knots,
        &StreamOptions::new(SESSION),
        |mcu: &mut SimulatedMcu, e| {
            if let Event::Armed { start_us, .. } = e {
                sleep = Some((start_us, mcu.now_us()));
            }
        },
    )
    .unwrap();
    let (start_us, armed_us) = sleep.unwrap();
    let lead_us = start_us as f64 - (86_400e6 + armed_us as f64 * 1.000_15);
    assert!((100_000.0..300_000.0).contains(&lead_us), "{lead_us}");
    for host_us in (10_000_000..20_000_000_u64).step_by(500_000) {
        let device_us = 86_400e6 + host_us as f64 * 1.000_15;
        worst_us = worst_us.max((summary.clock.device_us(host_us) as f64 - device_us).abs());
    }
    println!("clock: {worst_us:.0} us, {:.1} ppm of 150", summary.clock.drift_ppm());
    assert!(worst_us < 2_000.0 && (summary.clock.drift_ppm() - 150.0).abs() < 60.0);
}

#[test]
fn slow_line_needs_a_longer_lead_and_gets_it() {
    let (channels, knots) = (9, knots(9, 2.0));
    let mut settings = settings(channels);
    settings.baud = 115_200;
    let (summary, told) = run(&mut device(&settings), channels, &knots);
    assert_eq!(summary.setpoints as usize, knots.len() + 1);
    assert_tracks_the_knots(&told, &knots);
    println!("{:?}", summary.statistics);
}

#[test]
fn same_run_twice_gives_the_same_bits() {
    let (channels, knots) = (2, knots(2, 2.0));
    let once = || {
        let mut settings = settings(channels);
        settings.line_faults = LineFaults { drop: 0.001, flip: 0.002, duplicate: 0.001 };
        settings.seed = 5;
        let mut mcu = device(&settings);
        let (summary, told) = run(&mut mcu, channels, &knots);
        (summary, told.telemetry, mcu.now_us(), mcu.truth())
    };
    let (first, second) = (once(), once());
    assert!(first.0.statistics.setpoints_repeated > 0, "there was something to be repeated");
    assert!(first == second);
}

#[test]
fn runs_follow_each_other_on_one_device() {
    let (channels, knots) = (1, knots(1, 1.5));
    let mut mcu = device(&settings(channels));
    run(&mut mcu, channels, &knots);
    mcu.advance_to(mcu.now_us() + 1_000_000);
    let options = StreamOptions::new(SESSION + 1);
    let summary = stream(&mut mcu, &configuration(channels), &knots, &options, |_, _| {}).unwrap();
    assert_eq!(summary.setpoints as usize, knots.len() + 1);
    assert!(summary.device.config_hash.is_some(), "the device remembers the first run");
}
