//! A device operated by hand, over the link.

use softlimb_protocol::{DeviceState, Outputs, PulseDirection};
use softlimb_rig::link::{Direct, Event, LinkError, StreamOptions};
use softlimb_sim::SimulatedMcu;

use crate::link_common::{SESSION, configuration, device, settings};

/// The words of a refusal.
fn refusal(outcome: Result<(), LinkError>) -> String {
    let error = outcome.unwrap_err();
    assert!(matches!(error, LinkError::Refused { .. }), "{error}");
    error.to_string()
}

#[test]
fn valves_zeros_and_gripper_are_operated_by_hand() {
    let mut mcu = device(&settings(2));
    let options = StreamOptions::new(SESSION);
    let mut states = Vec::new();
    let mut on_event = |_: &mut SimulatedMcu, event| {
        if let Event::State(state) = event {
            states.push(state);
        }
    };
    let mut hand = Direct::open(&mut mcu, &options, &mut on_event).unwrap();
    assert!(refusal(hand.set_outputs(Outputs::GRIPPER)).contains("SetOutputs"), "not configured");
    let hash = hand.configure(&configuration(2)).unwrap();
    assert!(hash != 0 && hand.device().config_hash.is_none());

    hand.set_outputs(Outputs::GRIPPER).unwrap();
    hand.wait(30_000).unwrap();
    assert_eq!(hand.telemetry().unwrap().outputs, Outputs::GRIPPER);
    hand.set_outputs(Outputs::default()).unwrap();

    // 20 ms of a coil at 497 kPa/s, as in `firmware/src/pneumatics.rs`, less the delays: about 9 kPa.
    hand.zero().unwrap();
    hand.pulse(1, PulseDirection::Fill, 20_000).unwrap();
    hand.wait(100_000).unwrap();
    let kpa = |hand: &Direct<'_, SimulatedMcu>| {
        let channels = &hand.telemetry().unwrap().channels;
        [0, 1].map(|channel| f64::from(channels[channel].pressure_10pa) * 0.01)
    };
    let [still, filled] = kpa(&hand);
    assert!(still < 0.3 && (5.0..14.0).contains(&filled), "{still} {filled}");
    assert_eq!(hand.state(), Some(DeviceState::Holding));

    assert!(refusal(hand.zero()).contains("Command"), "not ready");
    hand.pulse(1, PulseDirection::Vent, 300_000).unwrap();
    hand.wait(400_000).unwrap();
    assert!(kpa(&hand)[1] < 0.3, "{:?}", kpa(&hand));
    hand.vent().unwrap();
    hand.zero().unwrap();
    let words = refusal(hand.pulse(2, PulseDirection::Fill, 20_000));
    assert!(words.contains("ManualPulse") && words.contains("channel is out of range"), "{words}");
    drop(hand);
    use DeviceState::{Holding, Idle, Ready, Venting};
    states.dedup();
    // After venting the readings are compared with the zeros.
    assert_eq!(states, [Idle, Ready, Idle, Ready, Holding, Venting, Idle, Ready, Idle, Ready]);
}
