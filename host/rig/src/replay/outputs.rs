//! Coils, supply, pump and digital outputs of a tick beside those of the log.

use softlimb_sim::TickOutputs;
use softlimb_sim::emulated::Pins;

use super::Difference;
use crate::record::{CoilPulse, DeviceTick};

/// Compares tick after tick.
pub(super) struct Coils {
    /// Where the log has what pins show: they, and their outputs of the tick before.
    pins: Option<(Pins, TickOutputs)>,
}

impl Coils {
    pub(super) fn new(at_pins: bool) -> Self {
        Self { pins: at_pins.then(|| (Pins::default(), TickOutputs::SAFE)) }
    }

    /// The first difference in a tick.
    pub(super) fn compare(&mut self, tick: &DeviceTick, outputs: &TickOutputs) -> Option<Difference> {
        let outputs = match &mut self.pins {
            // Decided now, applied in the next tick.
            Some((pins, before)) => std::mem::replace(before, pins.show(outputs)),
            None => *outputs,
        };
        let differs = |at: String, expected: String, got: String| {
            (expected != got).then_some(Difference { device_us: tick.device_us, at, expected, got })
        };
        let coils = |pulse: (u16, u16)| format!("fill {} us, vent {} us", pulse.0, pulse.1);
        let channels = (0_u8..).zip(outputs.valves).find_map(|(channel, got)| {
            let logged = tick.pulses.iter().find(|pulse| pulse.channel == channel);
            let expected = logged.map_or((0, 0), |&CoilPulse { fill_us, vent_us, .. }| (fill_us, vent_us));
            let got = (got.fill_us, got.vent_us);
            if expected == got {
                None
            } else {
                differs(format!("channel {channel}, coils"), coils(expected), coils(got))
            }
        });
        channels
            .or_else(|| differs("supply valve".into(), on(tick.supply_open), on(outputs.supply_open)))
            .or_else(|| differs("pump".into(), tick.pump_duty.to_string(), outputs.pump_duty.to_string()))
            .or_else(|| {
                let bits = |bits: u8| format!("{bits:08b}");
                differs("digital outputs".into(), bits(tick.outputs), bits(outputs.digital.bits()))
            })
    }
}

fn on(is_on: bool) -> String {
    if is_on { "open" } else { "closed" }.to_owned()
}
