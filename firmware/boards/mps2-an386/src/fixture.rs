//! A device with sensors that rise while a valve fills and fall while one vents, and a host at its link.

use softlimb_firmware::{AdcCode, Board, BootInfo, Controller, TICK_US, TickInputs, turn};
use softlimb_protocol::*;

use crate::upload::CHANNELS;

/// Outputs of a tick.
pub(crate) type TickOutputs = softlimb_firmware::TickOutputs<CHANNELS>;

/// Codes of a sensor without pressure, and of the supply's at 200 kPa.
const EMPTY: i32 = 410;
const SUPPLY: i32 = 1_360;

/// Code of 24 V at the valves' supply.
const VALVE_SUPPLY: u16 = 2_708;

/// A code has as many parts as a tick has microseconds. Filling adds `FILL` parts a microsecond; venting takes half a part, and three thousandths for
/// each code above that of an empty chamber. This is about what the device expects: else it would find its valves faulty.
const PARTS: i32 = 1_000;
const FILL: i32 = 5;
const VENT: [i32; 2] = [500, 3];

/// Time of each pulse in which its valve is not open yet, less the time that it stays open, us.
const DELAY_US: i32 = 1_500;

/// While a chamber fills, its sensor at the manifold reads this many codes more; while it vents, this share less of the codes above an empty one's.
const FILLING: i32 = 300;
const VENTING: i32 = 8;

/// Bytes that a line of 921 600 baud carries in a tick.
pub(crate) const LINE: usize = 92;

/// The device and its surroundings.
pub(crate) struct Fixture {
    controller: Controller<CHANNELS>,
    surroundings: Surroundings,
    sequence: u16,
    decoder: Decoder<DeviceMessage>,
    /// A message was refused.
    refused: bool,
    /// Channels that have filled, and that have vented: a bit each.
    moved: [u32; 2],
}

struct Surroundings {
    now_us: u64,
    /// Codes in parts.
    levels: [i32; CHANNELS],
    /// Rest of the delay of each fill and vent valve, us.
    delays_us: [[i32; 2]; CHANNELS],
    /// Drops of the lines, codes.
    drops: [i32; CHANNELS],
    received: [u8; MAX_FRAME_LEN],
    arrived: usize,
    taken: usize,
    sent: [u8; 4 * MAX_FRAME_LEN],
    sent_len: usize,
}

impl Fixture {
    /// A device that was just switched on.
    pub(crate) fn new() -> Self {
        Self {
            controller: Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 }),
            surroundings: Surroundings {
                now_us: u64::from(TICK_US),
                levels: [EMPTY * PARTS; CHANNELS],
                delays_us: [[DELAY_US; 2]; CHANNELS],
                drops: [0; CHANNELS],
                received: [0; MAX_FRAME_LEN],
                arrived: 0,
                taken: 0,
                sent: [0; 4 * MAX_FRAME_LEN],
                sent_len: 0,
            },
            sequence: 0,
            decoder: Decoder::new(),
            refused: false,
            moved: [0; 2],
        }
    }

    /// State of the device.
    pub(crate) fn state(&self) -> DeviceState {
        self.controller.state()
    }

    /// Whether the device took every message, raised no fault, and every channel has filled and vented.
    pub(crate) fn is_well(&self) -> bool {
        let faultless = self.controller.faults().bits() == 0;
        faultless && !self.refused && self.moved == [(1 << CHANNELS) - 1; 2]
    }

    /// Time of the device, us.
    pub(crate) fn now_us(&self) -> u64 {
        self.surroundings.now_us
    }

    /// Puts a message on the line; the next turn reads it.
    pub(crate) fn send(&mut self, message: &HostMessage) {
        self.sequence += 1;
        self.surroundings.taken = 0;
        self.surroundings.arrived = encode_frame(message, self.sequence, &mut self.surroundings.received).unwrap_or(0);
    }

    /// Puts bytes on the line, at most as many as it carries in a tick.
    pub(crate) fn send_bytes(&mut self, bytes: &[u8]) {
        self.surroundings.received[..bytes.len()].copy_from_slice(bytes);
        (self.surroundings.taken, self.surroundings.arrived) = (0, bytes.len());
    }

    /// One turn of the device.
    pub(crate) fn turn(&mut self) -> TickOutputs {
        turn(&mut self.controller, &mut self.surroundings)
    }

    /// Advances the surroundings to the next turn.
    pub(crate) fn pass(&mut self, outputs: &TickOutputs) {
        let Surroundings { levels, delays_us, drops, .. } = &mut self.surroundings;
        for (channel, ((level, delays_us), pulse)) in levels.iter_mut().zip(delays_us).zip(&outputs.valves).enumerate()
        {
            let (fill, vent) = (i32::from(pulse.fill_us), i32::from(pulse.vent_us));
            let [filling, venting] = [0, 1].map(|valve| open_us(&mut delays_us[valve], [fill, vent][valve]));
            let above = *level / PARTS - EMPTY;
            *level += FILL * filling - (VENT[0] + VENT[1] * above) * venting / PARTS;
            *level = (*level).max(EMPTY * PARTS);
            drops[channel] = match (filling > 0, venting > 0) {
                (true, _) => FILLING,
                (false, true) => -above / VENTING,
                (false, false) => 0,
            };
            self.moved[0] |= u32::from(fill > 0) << channel;
            self.moved[1] |= u32::from(vent > 0) << channel;
        }
        self.surroundings.now_us += u64::from(TICK_US);
        for byte in &self.surroundings.sent[..self.surroundings.sent_len] {
            let refuses = |frame: &Frame<DeviceMessage>| matches!(&frame.message, DeviceMessage::Ack(ack) if ack.result != ResultCode::Ok);
            self.refused |= self.decoder.push(*byte).is_some_and(|frame| frame.as_ref().map_or(true, refuses));
        }
        self.surroundings.sent_len = 0;
    }

    /// A message and the turn that reads it.
    pub(crate) fn tell(&mut self, message: &HostMessage) {
        self.send(message);
        let outputs = self.turn();
        self.pass(&outputs);
    }
}

/// Time for which a valve is open in a tick of its coil, us.
fn open_us(delay_us: &mut i32, coil_us: i32) -> i32 {
    let open_us = (coil_us - *delay_us).max(0);
    *delay_us = if coil_us == 0 { DELAY_US } else { (*delay_us - coil_us).max(0) };
    open_us
}

impl Board<CHANNELS> for Surroundings {
    fn inputs(&mut self) -> TickInputs<CHANNELS> {
        let code = |channel: usize| AdcCode((self.levels[channel] / PARTS + self.drops[channel]) as u16);
        let pressure = core::array::from_fn(code);
        let (supply, valve_supply) = (AdcCode(SUPPLY as u16), AdcCode(VALVE_SUPPLY));
        TickInputs { now_us: self.now_us, pressure, supply, valve_supply, emergency_stop: false }
    }

    fn apply(&mut self, _: &TickOutputs) {}

    fn read_link(&mut self, into: &mut [u8]) -> usize {
        let bytes = &self.received[self.taken..self.arrived];
        let count = into.len().min(bytes.len());
        into[..count].copy_from_slice(&bytes[..count]);
        self.taken += count;
        count
    }

    fn link_room(&self) -> usize {
        self.sent.len() - self.sent_len
    }

    fn write_link(&mut self, bytes: &[u8]) {
        self.sent[self.sent_len..][..bytes.len()].copy_from_slice(bytes);
        self.sent_len += bytes.len();
    }
}
