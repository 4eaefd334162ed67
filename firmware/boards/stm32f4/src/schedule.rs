//! Coil times of a tick as port writes every 100 us.
//!
//! Outputs decided in one tick are applied from the start of the next: always one tick later, whatever the computation took. Times are
//! rounded to the grid. Only the last tick of a pulse has one that is not on it, so that a whole pulse is off by 50 us at most.

use crate::pins::{DIGITAL, DIGITALS, FILL, OUTPUTS, PORTS, PUMP, Pin, SUPPLY, TickOutputs, VENT, VENTS};

/// Slots in a tick.
pub const SLOTS: usize = 10;

/// Length of a slot, us.
pub const SLOT_US: u16 = 100;

/// Port writes of one slot: values of their bit set and reset registers.
pub type Words = [u32; PORTS];

/// Everything off.
pub const OFF: Words = words([0; PORTS]);

/// All vents on and everything else off: what a program that cannot go on tells the ports.
pub const VENTING: Words = words(VENTS);

const fn words(on: [u16; PORTS]) -> Words {
    let mut words = [0; PORTS];
    let mut port = 0;
    while port < PORTS {
        let off = OUTPUTS[port] & !on[port];
        words[port] = on[port] as u32 | (off as u32) << 16;
        port += 1;
    }
    words
}

/// What follows words of a slot where the controller is late: everything off but the digital outputs, which stay.
#[must_use]
pub fn late(port: usize, word: u32) -> u32 {
    let (Some(off), Some(&kept)) = (OFF.get(port), DIGITALS.get(port)) else { return word };
    let kept = u32::from(kept) | u32::from(kept) << 16;
    off & !kept | word & kept
}

/// Spreads the pump's duty over slots: the pump is on in that share of them, as evenly as they allow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PumpDensity {
    error: u16,
}

impl PumpDensity {
    /// Off since the beginning.
    #[must_use]
    pub const fn new() -> Self {
        Self { error: 0 }
    }

    /// Whether the pump is on in the next slot at `duty` of 255.
    pub fn next(&mut self, duty: u8) -> bool {
        self.error += u16::from(duty);
        let on = self.error >= 255;
        if on {
            self.error -= 255;
        }
        on
    }
}

/// Port writes of each slot of one tick.
#[must_use]
pub fn schedule(outputs: &TickOutputs, pump: &mut PumpDensity) -> [Words; SLOTS] {
    let mut slots = [OFF; SLOTS];
    for (slot, words_of_slot) in (0..).zip(&mut slots) {
        let mut on = [0; PORTS];
        let mut energize = |pin: Pin| {
            if let Some(port) = on.get_mut(pin.port as usize) {
                *port |= pin.bit();
            }
        };
        let pairs = FILL.into_iter().zip(VENT);
        for (pulse, (fill, vent)) in outputs.valves.iter().zip(pairs) {
            // A fill and a vent at once would blow the supply off.
            if slot < slots_of(pulse.vent_us) {
                energize(vent);
            } else if slot < slots_of(pulse.fill_us) {
                energize(fill);
            }
        }
        if outputs.supply_open {
            energize(SUPPLY);
        }
        for (output, pin) in DIGITAL {
            if outputs.digital.contains(output) {
                energize(pin);
            }
        }
        if pump.next(outputs.pump_duty) {
            energize(PUMP);
        }
        *words_of_slot = words(on);
    }
    slots
}

/// Slots for a coil time, rounded to the nearest.
const fn slots_of(time_us: u16) -> u16 {
    (time_us + SLOT_US / 2) / SLOT_US
}

#[cfg(test)]
mod tests {
    use super::*;
    use softlimb_firmware::ValvePulse;
    use softlimb_protocol::Outputs;

    fn is_on(words: &Words, pin: Pin) -> bool {
        words[pin.port as usize] & u32::from(pin.bit()) != 0
    }

    fn slots_on(slots: &[Words; SLOTS], pin: Pin) -> Vec<usize> {
        (0..SLOTS).filter(|&slot| is_on(&slots[slot], pin)).collect()
    }

    fn outputs(channel: usize, fill_us: u16, vent_us: u16) -> TickOutputs {
        let mut outputs = TickOutputs::SAFE;
        outputs.valves[channel] = ValvePulse { fill_us, vent_us };
        outputs
    }

    #[test]
    fn pulse_is_on_from_the_start_for_its_time_and_nothing_else_is() {
        for (time_us, expected) in [(0, 0), (49, 0), (50, 1), (400, 4), (449, 4), (450, 5), (1_000, 10)] {
            for (channel, pin) in FILL.into_iter().enumerate() {
                let slots = schedule(&outputs(channel, time_us, 0), &mut PumpDensity::new());
                assert_eq!(slots_on(&slots, pin), (0..expected).collect::<Vec<_>>());
                let all = slots.iter().flatten().map(|word| (word & 0xffff).count_ones()).sum::<u32>();
                assert_eq!(all, expected as u32, "{time_us} us of channel {channel}");
            }
        }
    }

    #[test]
    fn every_output_is_told_in_every_slot() {
        let slots = schedule(&outputs(3, 300, 0), &mut PumpDensity::new());
        for words in slots.iter().chain([&OFF]) {
            for (word, mask) in words.iter().zip(OUTPUTS) {
                let (set, reset) = ((word & 0xffff) as u16, (word >> 16) as u16);
                assert_eq!((set | reset, set & reset), (mask, 0));
            }
        }
    }

    #[test]
    fn digital_output_is_on_for_the_whole_tick_and_stays_where_the_controller_is_late() {
        for (output, pin) in DIGITAL {
            for on in [false, true] {
                let run = TickOutputs { digital: Outputs::default().with(output, on), ..outputs(0, 1_000, 0) };
                for words in schedule(&run, &mut PumpDensity::new()) {
                    assert_eq!(is_on(&words, pin), on);
                    let late: Words = std::array::from_fn(|port| late(port, words[port]));
                    let (set, reset) = (late[pin.port as usize] & 0xffff, late[pin.port as usize] >> 16);
                    assert_eq!(set & u32::from(pin.bit()) != 0, on);
                    assert_eq!(reset & u32::from(pin.bit()) == 0, on);
                    let others = late.iter().map(|word| (word & 0xffff).count_ones()).sum::<u32>();
                    assert_eq!(others, u32::from(on), "all valves are off");
                }
            }
        }
    }

    #[test]
    fn program_that_cannot_go_on_lets_all_the_air_out_and_none_in() {
        for vent in VENT {
            assert!(is_on(&VENTING, vent), "{vent}");
        }
        let on = VENTING.iter().map(|word| (word & 0xffff).count_ones()).sum::<u32>();
        assert_eq!(on as usize, VENT.len(), "nothing else is on");
        for (word, mask) in VENTING.iter().zip(OUTPUTS) {
            assert_eq!((word | word >> 16) as u16, mask, "every output is told");
        }
    }

    #[test]
    fn pair_is_never_energized_together() {
        let slots = schedule(&outputs(2, 1_000, 300), &mut PumpDensity::new());
        assert_eq!(slots_on(&slots, VENT[2]), [0, 1, 2]);
        assert_eq!(slots_on(&slots, FILL[2]), [3, 4, 5, 6, 7, 8, 9]);
    }

    #[test]
    fn pump_runs_for_its_share_of_the_slots() {
        for duty in [0, 1, 64, 128, 254, 255] {
            let mut density = PumpDensity::new();
            let run = TickOutputs { supply_open: true, pump_duty: duty, ..TickOutputs::SAFE };
            let slots: Vec<_> = (0..255).flat_map(|_| schedule(&run, &mut density)).collect();
            assert!(slots.iter().all(|words| is_on(words, SUPPLY)));
            assert_eq!(slots.iter().filter(|words| is_on(words, PUMP)).count(), usize::from(duty) * SLOTS);
        }
    }
}
