//! From port writes back to valve pulses: the inverse of `schedule`.

use softlimb_firmware::ValvePulse;
#[cfg(unix)]
use softlimb_image_stm32f4::pins::PORTS;
use softlimb_image_stm32f4::pins::{DIGITAL, FILL, PUMP, Pin, SUPPLY, TickOutputs, VENT};
use softlimb_image_stm32f4::schedule::{SLOT_US, SLOTS, Words};

/// Coil times and pump of a tick whose slots are these. A coil counts from the start of the tick for as many slots as it is on.
pub(super) fn outputs(slots: &[Words; SLOTS]) -> TickOutputs {
    let time_us = |pin: Pin| SLOT_US * slots_on(slots, pin);
    let mut outputs = TickOutputs::SAFE;
    for (pulse, (fill, vent)) in outputs.valves.iter_mut().zip(FILL.into_iter().zip(VENT)) {
        *pulse = ValvePulse { fill_us: time_us(fill), vent_us: time_us(vent) };
    }
    outputs.supply_open = slots_on(slots, SUPPLY) > 0;
    for (output, pin) in DIGITAL {
        outputs.digital = outputs.digital.with(output, slots_on(slots, pin) > 0);
    }
    // Ten slots resolve a tenth; over ticks the mean is the duty.
    outputs.pump_duty = u8::try_from(255 * slots_on(slots, PUMP) / SLOTS as u16).unwrap_or(u8::MAX);
    outputs
}

fn slots_on(slots: &[Words; SLOTS], pin: Pin) -> u16 {
    (0..).zip(slots).filter(|(_, words)| words[pin.port as usize] & u32::from(pin.bit()) != 0).map(|_| 1).sum()
}

/// The words of both halves and which one is in use, as they lie in the memory of the device.
#[cfg(unix)]
pub(super) const COILS_LEN: usize = 2 * HALF_LEN + 4;
#[cfg(unix)]
const HALF_LEN: usize = 4 * PORTS * SLOTS;

/// The slots in use; `None` where the bytes are too few or name no half.
#[cfg(unix)]
pub(super) fn active(coils: &[u8]) -> Option<[Words; SLOTS]> {
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(coils.get(at..at + 4)?.try_into().ok()?)) };
    let half = word(2 * HALF_LEN).filter(|half| *half < 2)? as usize;
    let mut slots = [[0; PORTS]; SLOTS];
    for (index, place) in slots.iter_mut().flatten().enumerate() {
        *place = word(half * HALF_LEN + 4 * index)?;
    }
    Some(slots)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use softlimb_image_stm32f4::schedule::{PumpDensity, schedule};
    use softlimb_protocol::Outputs;

    #[test]
    fn schedule_reaches_the_valves_to_the_slot() {
        let mut wanted =
            TickOutputs { supply_open: true, pump_duty: 255, digital: Outputs::GRIPPER, ..TickOutputs::SAFE };
        for (number, pulse) in (0..).zip(&mut wanted.valves) {
            let time_us = 100 * number;
            *pulse = if number % 2 == 0 {
                ValvePulse { fill_us: time_us, vent_us: 0 }
            } else {
                ValvePulse { fill_us: 0, vent_us: time_us }
            };
        }
        assert_eq!(outputs(&schedule(&wanted, &mut PumpDensity::new())), wanted);
        let safe = TickOutputs::SAFE;
        assert_eq!(outputs(&schedule(&safe, &mut PumpDensity::new())), safe);
    }

    #[test]
    fn half_in_use_is_read() {
        let mut coils = vec![0; COILS_LEN];
        coils[HALF_LEN] = 7;
        coils[2 * HALF_LEN] = 1;
        assert_eq!(active(&coils).map(|slots| slots[0][0]), Some(7));
        coils[2 * HALF_LEN] = 0;
        assert_eq!(active(&coils).map(|slots| slots[0][0]), Some(0));
        coils[2 * HALF_LEN] = 2;
        assert_eq!(active(&coils), None);
        assert_eq!(active(&[]), None);
    }
}
