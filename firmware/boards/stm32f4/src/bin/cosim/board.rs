//! The controller's surroundings in lock-step: one query and one answer a tick.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use softlimb_firmware::Board;
use softlimb_image_stm32f4::exchange::{ANSWER_LEN, Answer, QUERY_LEN, Query, RECEIVED_MAX, SENT_MAX};
use softlimb_image_stm32f4::hardware::host::{Gone, Streams};
use softlimb_image_stm32f4::pins::{CHANNELS, TickInputs, TickOutputs};

/// The processor's timer counts from here to zero.
const LARGEST: u32 = 0x00ff_ffff;

/// Inputs and answers of the present tick.
pub(crate) struct LockStep {
    query: Query,
    received: [u8; RECEIVED_MAX],
    /// Of the bytes received, those that the controller has, and all.
    taken: usize,
    arrived: usize,
    /// The answer: its fixed part, filled in last, and the link's bytes.
    answer: [u8; ANSWER_LEN + SENT_MAX],
    sent: usize,
    room: usize,
    outputs: TickOutputs,
    cost: u32,
}

impl LockStep {
    pub(crate) const fn new() -> Self {
        Self {
            query: Query::END,
            received: [0; RECEIVED_MAX],
            taken: 0,
            arrived: 0,
            answer: [0; ANSWER_LEN + SENT_MAX],
            sent: 0,
            room: 0,
            outputs: TickOutputs::SAFE,
            cost: 0,
        }
    }

    /// Makes the timer ready to measure turns.
    pub(crate) fn begin(&self, timer: &mut SYST) {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(LARGEST);
    }

    /// Waits for the next query; false for the last one.
    pub(crate) fn ask(&mut self, streams: &Streams) -> Result<bool, Gone> {
        let mut fixed = [0; QUERY_LEN];
        streams.read(&mut fixed)?;
        // Here and not in the turn, whose cost is that of the device.
        self.query = Query::decode(&fixed);
        // A look may have left bytes to the next turn.
        let left = self.arrived - self.taken;
        self.received.copy_within(self.taken..self.arrived, 0);
        self.arrived = left + usize::from(self.query.received);
        streams.read(self.received.get_mut(left..self.arrived).ok_or(Gone)?)?;
        self.room = usize::from(self.query.room).min(SENT_MAX);
        (self.taken, self.sent) = (0, 0);
        Ok(!self.query.last)
    }

    /// Whether this is the first tick after a crash.
    pub(crate) fn is_after_crash(&self) -> bool {
        self.query.after_crash
    }

    /// Time of a look at the link without a tick, us.
    pub(crate) fn link_alone_us(&self) -> Option<u64> {
        self.query.link_alone.then_some(self.query.inputs.now_us)
    }

    /// Takes what the turn has cost, from the timer that was cleared when it began.
    pub(crate) fn note_cost(&mut self, timer: &mut SYST) {
        let left = SYST::get_current();
        timer.disable_counter();
        self.cost = if timer.has_wrapped() { u32::MAX } else { LARGEST - left };
    }

    /// Gives the answer.
    pub(crate) fn answer(&mut self, streams: &Streams) -> Result<(), Gone> {
        let sent = u16::try_from(self.sent).map_err(|_| Gone)?;
        let fixed = Answer { cost: self.cost, outputs: self.outputs, sent }.encode();
        for (place, byte) in self.answer.iter_mut().zip(fixed) {
            *place = byte;
        }
        streams.write(self.answer.get(..ANSWER_LEN + self.sent).ok_or(Gone)?)
    }
}

impl Board<CHANNELS> for LockStep {
    fn inputs(&mut self) -> TickInputs {
        self.query.inputs
    }

    fn apply(&mut self, outputs: &TickOutputs) {
        self.outputs = *outputs;
    }

    fn read_link(&mut self, into: &mut [u8]) -> usize {
        let bytes = self.received.get(self.taken..self.arrived).unwrap_or(&[]);
        let count = into.len().min(bytes.len());
        for (place, byte) in into.iter_mut().zip(bytes) {
            *place = *byte;
        }
        self.taken += count;
        count
    }

    fn link_room(&self) -> usize {
        self.room - self.sent.min(self.room)
    }

    fn write_link(&mut self, bytes: &[u8]) {
        let space = self.answer.iter_mut().skip(ANSWER_LEN + self.sent);
        for (place, byte) in space.zip(bytes) {
            *place = *byte;
        }
        self.sent += bytes.len();
    }
}
