//! Runs over links that go wrong: frames lost, hurt, repeated, swapped and late, and nothing wrong or late is applied.

use crate::link_common::*;
use softlimb_protocol::DeviceState;
use softlimb_rig::link::{Disturbances, DisturbedLink, Knot, LinkFaults, StreamOptions, Summary, stream};
use softlimb_sim::SimulatedMcu;

const CHANNELS: usize = 2;

/// A run over a disturbed link: what was told, and the faults to the device and back.
fn run(faults: LinkFaults, seed: u64, knots: &[Knot]) -> (Summary, Told, u32, [Disturbances; 2]) {
    let mut link = DisturbedLink::new(device(&settings(CHANNELS)), faults, seed);
    let mut told = Told::default();
    let options = StreamOptions::new(SESSION);
    let listen = |_: &mut DisturbedLink<SimulatedMcu>, event| told.take(event);
    let summary = stream(&mut link, &configuration(CHANNELS), knots, &options, listen)
        .unwrap_or_else(|error| panic!("{faults:?}, seed {seed}: {error}"));
    let next_index = link.port().controller().queue().next_index();
    (summary, told, next_index, link.disturbances())
}

/// Every set point was applied once, in order and in time.
fn assert_every_knot_once(faults: LinkFaults, seed: u64, seconds: f64) -> [Disturbances; 2] {
    let knots = knots(CHANNELS, seconds);
    let (summary, told, next_index, disturbances) = run(faults, seed, &knots);
    assert_eq!(summary.setpoints as usize, knots.len() + 1, "{faults:?}, seed {seed}");
    assert_eq!(next_index, summary.setpoints, "the device counts the same: {faults:?}, seed {seed}");
    assert!(!told.states.contains(&DeviceState::Holding), "never without set points: {faults:?}, seed {seed}");
    assert_tracks_the_knots(&told, &knots);
    disturbances
}

#[test]
fn each_kind_of_fault_is_survived() {
    let kinds = [
        LinkFaults { loss: 0.05, ..LinkFaults::NONE },
        LinkFaults { flip: 0.05, ..LinkFaults::NONE },
        LinkFaults { burst: 0.05, ..LinkFaults::NONE },
        LinkFaults { cut: 0.05, ..LinkFaults::NONE },
        LinkFaults { duplicate: 0.2, ..LinkFaults::NONE },
        LinkFaults { reorder: 0.1, ..LinkFaults::NONE },
        LinkFaults { garbage: 0.1, ..LinkFaults::NONE },
        LinkFaults { wrong_baud: 0.05, ..LinkFaults::NONE },
        LinkFaults { stall: 0.01, stall_us: 50_000, ..LinkFaults::NONE },
    ];
    for faults in kinds {
        let disturbances = assert_every_knot_once(faults, 3, 4.0);
        for direction in disturbances {
            let Disturbances { frames, lost, altered, repeated, reordered, garbage, stalls } = direction;
            let hurt = lost + altered + repeated + reordered + garbage + stalls;
            assert!(hurt > 0 && hurt < frames / 2, "{faults:?}: {direction:?}");
        }
    }
}

/// One frame in twenty lost, one in a hundred hurt, and the line stops for 600 ms now and then.
#[test]
fn losses_hurt_frames_and_long_stalls_together_make_no_set_point_late_or_wrong() {
    let faults = LinkFaults { loss: 0.05, flip: 0.005, burst: 0.005, stall: 5e-4, ..LinkFaults::NONE };
    let mut stalls = 0;
    for seed in 0..6 {
        stalls += assert_every_knot_once(faults, seed, 12.0).map(|direction| direction.stalls).iter().sum::<u64>();
    }
    assert!(stalls > 4, "{stalls} stalls");
}

#[test]
fn equal_seeds_hurt_equal_frames() {
    let faults = LinkFaults { loss: 0.02, flip: 0.02, duplicate: 0.02, reorder: 0.02, ..LinkFaults::NONE };
    let once = |seed| {
        let (summary, told, _, disturbances) = run(faults, seed, &knots(CHANNELS, 2.0));
        (summary, told.telemetry, disturbances)
    };
    assert!(once(5) == once(5));
    assert!(once(5).2 != once(6).2);
}

#[test]
fn link_without_faults_is_the_port_itself() {
    let knots = knots(CHANNELS, 2.0);
    let (summary, told, ..) = run(LinkFaults::NONE, 1, &knots);
    let mut plain = Told::default();
    let mut mcu = device(&settings(CHANNELS));
    let options = StreamOptions::new(SESSION);
    let direct = stream(&mut mcu, &configuration(CHANNELS), &knots, &options, |_, event| plain.take(event)).unwrap();
    assert_eq!(summary.setpoints, direct.setpoints);
    assert!(told.telemetry == plain.telemetry && told.states == plain.states);
}
