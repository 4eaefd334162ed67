//! The controller's surroundings on the chip.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer};
use softlimb_firmware::log::{Log, LogMemory};
use softlimb_firmware::{AdcCode, Board, TICK_US};
use softlimb_image_stm32f4::hardware::coils::COILS;
use softlimb_image_stm32f4::hardware::log_flash::LogFlash;
use softlimb_image_stm32f4::hardware::{converter, ports};
use softlimb_image_stm32f4::pins::{CHANNELS, EMERGENCY_STOP, TickInputs, TickOutputs};
use softlimb_image_stm32f4::reception::ErrorCounts;
use softlimb_image_stm32f4::schedule::{PumpDensity, schedule};
use softlimb_protocol::LinkErrors;

/// Bytes from the host that can wait, and one: 11 ms of the line.
pub(crate) const INCOMING: usize = 1024;

/// Bytes to the host that can wait, and one: 3 ms of the line.
pub(crate) const OUTGOING: usize = 257;

/// Counts of events so far, for a debugger; all wrap.
pub(crate) struct Counts {
    pub(crate) ticks: AtomicU32,
    pub(crate) slots: AtomicU32,
    pub(crate) turns: AtomicU32,
    pub(crate) link: AtomicU32,
    pub(crate) stack_used: AtomicU16,
}

pub(crate) static COUNTS: Counts = Counts {
    ticks: AtomicU32::new(0),
    slots: AtomicU32::new(0),
    turns: AtomicU32::new(0),
    link: AtomicU32::new(0),
    stack_used: AtomicU16::new(0),
};

/// Errors of the link's port.
pub(crate) static LINK_ERRORS: ErrorCounts = ErrorCounts::new();

/// Pins, converter and link of the chip.
pub(crate) struct FlashedBoard {
    incoming: Consumer<'static, u8>,
    outgoing: Producer<'static, u8>,
    pump: PumpDensity,
    log: Log,
    /// `None` if the image is damaged: such a program writes no flash.
    log_flash: Option<LogFlash>,
    /// Without exact time, or with a damaged image, nothing may move: no sensor is believed, and the device does not become ready.
    is_trusted: bool,
    ticks: u32,
    now_ticks: u64,
}

impl FlashedBoard {
    pub(crate) fn new(
        (incoming, outgoing): (Consumer<'static, u8>, Producer<'static, u8>),
        log_flash: Option<LogFlash>,
        is_trusted: bool,
    ) -> Self {
        let (pump, log) = (PumpDensity::new(), Log::new());
        Self { incoming, outgoing, pump, log, log_flash, is_trusted, ticks: 0, now_ticks: 0 }
    }

    /// Whether a tick has begun since the last turn.
    pub(crate) fn has_tick(&self) -> bool {
        COUNTS.ticks.load(Ordering::Relaxed) != self.ticks
    }

    /// Start of the present tick, us.
    pub(crate) fn now_us(&self) -> u64 {
        self.now_ticks * u64::from(TICK_US)
    }
}

impl Board<CHANNELS> for FlashedBoard {
    fn inputs(&mut self) -> TickInputs {
        let ticks = COUNTS.ticks.load(Ordering::Relaxed);
        self.now_ticks += u64::from(ticks.wrapping_sub(self.ticks));
        self.ticks = ticks;
        let [pressure @ .., supply, valve_supply] =
            converter::take().map(|code| AdcCode(if self.is_trusted { code } else { 0 }));
        let emergency_stop = ports::is_high(EMERGENCY_STOP);
        TickInputs { now_us: self.now_us(), pressure, supply, valve_supply, emergency_stop }
    }

    fn apply(&mut self, outputs: &TickOutputs) {
        COILS.put(&schedule(outputs, &mut self.pump));
    }

    fn read_link(&mut self, into: &mut [u8]) -> usize {
        let mut count = 0;
        for place in into {
            let Some(byte) = self.incoming.dequeue() else { break };
            *place = byte;
            count += 1;
        }
        count
    }

    fn link_room(&self) -> usize {
        self.outgoing.capacity() - self.outgoing.len()
    }

    fn write_link(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            // There is room: the caller asked.
            let _ = self.outgoing.enqueue(byte);
        }
    }

    fn link_errors(&self) -> LinkErrors {
        LINK_ERRORS.now()
    }

    fn log(&mut self) -> Option<(&mut Log, &mut dyn LogMemory)> {
        Some((&mut self.log, self.log_flash.as_mut()?))
    }

    fn stack_used(&self) -> u16 {
        COUNTS.stack_used.load(Ordering::Relaxed)
    }
}
