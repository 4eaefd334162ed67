//! Between the channels of the simulation and those that the board has.

use softlimb_firmware::{AdcCode, TickInputs, TickOutputs};
use softlimb_image_stm32f4::pins::{self, CHANNELS};
use softlimb_image_stm32f4::schedule::{PumpDensity, schedule};

/// The part of the inputs that the board has channels for.
pub(super) fn narrowed(inputs: &TickInputs) -> pins::TickInputs {
    let TickInputs { now_us, pressure: all, supply, valve_supply, emergency_stop } = *inputs;
    let mut pressure = [AdcCode(0); CHANNELS];
    pressure.iter_mut().zip(all).for_each(|(place, code)| *place = code);
    pins::TickInputs { now_us, pressure, supply, valve_supply, emergency_stop }
}

/// The outputs of the board, and nothing on the channels that it has not.
pub(super) fn widened(outputs: &pins::TickOutputs) -> TickOutputs {
    let pins::TickOutputs { valves: some, supply_open, pump_duty, digital } = *outputs;
    let mut all = TickOutputs { supply_open, pump_duty, digital, ..TickOutputs::SAFE };
    all.valves.iter_mut().zip(some).for_each(|(place, pulse)| *place = pulse);
    all
}

/// The outputs of a board as its pins show them: coil times on the grid of its schedule, the pump in slots.
#[derive(Debug, Default)]
pub struct Pins(PumpDensity);

impl Pins {
    /// What the pins show of these outputs, tick after tick.
    pub fn show(&mut self, outputs: &TickOutputs) -> TickOutputs {
        let TickOutputs { valves: all, supply_open, pump_duty, digital } = *outputs;
        let mut board = pins::TickOutputs { supply_open, pump_duty, digital, ..pins::TickOutputs::SAFE };
        board.valves.iter_mut().zip(all).for_each(|(place, pulse)| *place = pulse);
        widened(&super::pins::outputs(&schedule(&board, &mut self.0)))
    }
}
