//! Messages between the co-simulated controller and the simulator of its surroundings, each tick and between ticks.
//!
//! One query, one answer, little-endian, each a fixed part and the link's bytes behind it. Both sides wait for each other, so that
//! nothing depends on how long either takes.

use softlimb_firmware::{AdcCode, ValvePulse};
use softlimb_protocol::Outputs;

use crate::pins::{CHANNELS, SENSORS, TickInputs, TickOutputs};

/// The most bytes of the link in one query; more wait for the next tick.
pub const RECEIVED_MAX: usize = 2048;

/// The most bytes of the link in one answer.
pub const SENT_MAX: usize = 256;

/// Length of the fixed part of a query, bytes.
pub const QUERY_LEN: usize = 8 + 1 + 2 + 2 + 2 * SENSORS;

/// Length of the fixed part of an answer, bytes.
pub const ANSWER_LEN: usize = 4 + 4 * CHANNELS + 1 + 1 + 1 + 2;

const STOP_PRESSED: u8 = 1;
const LAST: u8 = 2;
const AFTER_CRASH: u8 = 4;
const LINK_ALONE: u8 = 8;

/// Start of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Query {
    /// Time and samples.
    pub inputs: TickInputs,
    /// Bytes that the link takes, at most [`SENT_MAX`].
    pub room: u16,
    /// Bytes of the link that follow, at most [`RECEIVED_MAX`].
    pub received: u16,
    /// There is no tick: the emulation ends.
    pub last: bool,
    /// This is the first tick, after a fault of the processor.
    pub after_crash: bool,
    /// There is no tick: a look at the link between two of them. The outputs of the answer mean nothing.
    pub link_alone: bool,
}

/// End of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Counts of the processor's timer that the turn has taken.
    pub cost: u32,
    /// Coil times.
    pub outputs: TickOutputs,
    /// Bytes of the link that follow, at most the room for them.
    pub sent: u16,
}

impl Query {
    /// The end of an emulation.
    pub const END: Self = Self {
        inputs: TickInputs {
            now_us: 0,
            pressure: [AdcCode(0); CHANNELS],
            supply: AdcCode(0),
            valve_supply: AdcCode(0),
            emergency_stop: false,
        },
        room: 0,
        received: 0,
        last: true,
        after_crash: false,
        link_alone: false,
    };

    /// The fixed part.
    #[must_use]
    pub fn encode(&self) -> [u8; QUERY_LEN] {
        let mut bytes = [0; QUERY_LEN];
        let mut writer = Writer(bytes.iter_mut());
        let flags = u8::from(self.inputs.emergency_stop) * STOP_PRESSED
            + u8::from(self.last) * LAST
            + u8::from(self.after_crash) * AFTER_CRASH
            + u8::from(self.link_alone) * LINK_ALONE;
        writer.put(self.inputs.now_us.to_le_bytes());
        writer.put([flags]);
        writer.put(self.room.to_le_bytes());
        writer.put(self.received.to_le_bytes());
        for code in self.inputs.pressure {
            writer.put(code.0.to_le_bytes());
        }
        writer.put(self.inputs.supply.0.to_le_bytes());
        writer.put(self.inputs.valve_supply.0.to_le_bytes());
        bytes
    }

    /// The query behind a fixed part. Every sequence of bytes is one.
    #[must_use]
    pub fn decode(bytes: &[u8; QUERY_LEN]) -> Self {
        let mut reader = Reader(bytes.iter());
        let now_us = u64::from_le_bytes(reader.take());
        let [flags] = reader.take();
        let (room, received) = (u16::from_le_bytes(reader.take()), u16::from_le_bytes(reader.take()));
        let mut pressure = [AdcCode(0); CHANNELS];
        for code in &mut pressure {
            *code = AdcCode(u16::from_le_bytes(reader.take()));
        }
        let supply = AdcCode(u16::from_le_bytes(reader.take()));
        let valve_supply = AdcCode(u16::from_le_bytes(reader.take()));
        let inputs = TickInputs { now_us, pressure, supply, valve_supply, emergency_stop: flags & STOP_PRESSED != 0 };
        Self {
            inputs,
            room,
            received,
            last: flags & LAST != 0,
            after_crash: flags & AFTER_CRASH != 0,
            link_alone: flags & LINK_ALONE != 0,
        }
    }
}

impl Answer {
    /// The fixed part.
    #[must_use]
    pub fn encode(&self) -> [u8; ANSWER_LEN] {
        let mut bytes = [0; ANSWER_LEN];
        let mut writer = Writer(bytes.iter_mut());
        writer.put(self.cost.to_le_bytes());
        for pulse in self.outputs.valves {
            writer.put(pulse.fill_us.to_le_bytes());
            writer.put(pulse.vent_us.to_le_bytes());
        }
        let TickOutputs { supply_open, pump_duty, digital, .. } = self.outputs;
        writer.put([u8::from(supply_open), pump_duty, digital.bits()]);
        writer.put(self.sent.to_le_bytes());
        bytes
    }

    /// The answer behind a fixed part. Every sequence of bytes is one.
    #[must_use]
    pub fn decode(bytes: &[u8; ANSWER_LEN]) -> Self {
        let mut reader = Reader(bytes.iter());
        let cost = u32::from_le_bytes(reader.take());
        let mut valves = [ValvePulse::CLOSED; CHANNELS];
        for pulse in &mut valves {
            let (fill_us, vent_us) = (u16::from_le_bytes(reader.take()), u16::from_le_bytes(reader.take()));
            *pulse = ValvePulse { fill_us, vent_us };
        }
        let [supply, pump_duty, digital] = reader.take();
        let digital = Outputs::from_bits(digital);
        let outputs = TickOutputs { valves, supply_open: supply != 0, pump_duty, digital };
        Self { cost, outputs, sent: u16::from_le_bytes(reader.take()) }
    }
}

struct Writer<'a>(core::slice::IterMut<'a, u8>);

impl Writer<'_> {
    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        for (byte, place) in bytes.into_iter().zip(self.0.by_ref()) {
            *place = byte;
        }
    }
}

struct Reader<'a>(core::slice::Iter<'a, u8>);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        for place in &mut bytes {
            *place = self.0.next().copied().unwrap_or(0);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn questions_and_answers_come_back_whole() {
        let mut pressure = [AdcCode(0); CHANNELS];
        let mut valves = [ValvePulse::CLOSED; CHANNELS];
        for (number, (code, pulse)) in (1..).zip(pressure.iter_mut().zip(&mut valves)) {
            (*code, *pulse) = (AdcCode(257 * number), ValvePulse { fill_us: 3 * number, vent_us: 1_000 - number });
        }
        for (emergency_stop, last) in [(false, false), (true, false), (false, true), (true, true)] {
            let (supply, valve_supply) = (AdcCode(0xabcd), AdcCode(0x1357));
            let inputs = TickInputs { now_us: u64::MAX - 7, pressure, supply, valve_supply, emergency_stop };
            let (after_crash, link_alone) = (emergency_stop != last, !emergency_stop);
            let query = Query { inputs, room: 0x1234, received: 0x0567, last, after_crash, link_alone };
            assert_eq!(Query::decode(&query.encode()), query);
            let outputs = TickOutputs { valves, supply_open: last, pump_duty: 200, digital: Outputs::from_bits(0x5a) };
            let answer = Answer { cost: 0x89ab_cdef, outputs, sent: 0x00fe };
            assert_eq!(Answer::decode(&answer.encode()), answer);
        }
    }

    #[test]
    fn last_byte_of_each_part_is_in_use() {
        let inputs = TickInputs { valve_supply: AdcCode(0xff00), ..Query::END.inputs };
        let query = Query { inputs, room: 0, received: 0, last: false, after_crash: false, link_alone: false };
        assert_eq!(query.encode().last(), Some(&0xff));
        assert_eq!(Answer { cost: 0, outputs: TickOutputs::SAFE, sent: 0xff00 }.encode().last(), Some(&0xff));
    }
}
