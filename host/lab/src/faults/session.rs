//! The device behind its link, with a fault at a time, and a look at the controller in each tick.

use std::io;

use softlimb_protocol::{Code, DeviceState, FaultCode};
use softlimb_rig::link::Transport;
use softlimb_sim::plant::PlantError;
use softlimb_sim::{Here, SimSettings, SimulatedMcu, here};

use super::rows::Fault;
use super::trace::Trace;

/// Stall of the host, us.
const STALL_US: u64 = 600_000;

/// A simulated device with faults to come.
pub(super) struct Session {
    mcu: SimulatedMcu<Here>,
    faults: &'static [Fault],
    channel: usize,
    /// Time of the faults after the start, us.
    at_us: i64,
    /// Device times of the start and of the faults, us.
    pub(super) start_us: Option<u64>,
    pub(super) broken_us: Option<u64>,
    error: Option<PlantError>,
    is_silent: bool,
    stalled_until_us: u64,
    seen: u16,
    /// Codes with the device time at which the controller latched them, us.
    pub(super) latched: Vec<(FaultCode, u64)>,
    pub(super) trace: Trace,
    /// Device time at which a device without a fault begins to let its air out, us.
    pub(super) vented_us: Option<u64>,
}

impl Session {
    pub(super) fn new(settings: &SimSettings, faults: &'static [Fault], channel: usize, at_s: f64) -> Self {
        Self {
            mcu: SimulatedMcu::with_processor(settings, here()).expect("the settings of the matrix"),
            faults,
            channel,
            at_us: (at_s * 1e6) as i64,
            start_us: None,
            broken_us: None,
            error: None,
            is_silent: false,
            stalled_until_us: 0,
            seen: 0,
            latched: Vec::new(),
            trace: Trace::default(),
            vented_us: None,
        }
    }

    /// Highest true pressure of all chambers, Pa.
    pub(super) fn peak_pa(&self) -> f64 {
        assert_eq!(self.error, None, "a fault of the matrix");
        self.mcu.peak_chamber_pa().into_iter().fold(0.0, f64::max)
    }

    /// Reading of the channel beyond its true pressure, Pa.
    pub(super) fn deviation_pa(&self) -> f64 {
        let reading_pa = self.mcu.controller().channel(self.channel).map_or(0.0, |channel| channel.pressure_pa());
        f64::from(reading_pa) - self.mcu.chamber_pa().nth(self.channel).unwrap_or_default()
    }

    /// State of the device.
    pub(super) fn state(&self) -> DeviceState {
        self.mcu.controller().state()
    }

    fn step(&mut self, until_us: u64) {
        let tick_us = self.mcu.next_tick_us().max(self.mcu.now_us() + 1);
        self.mcu.advance_to(tick_us.min(until_us.max(self.mcu.now_us() + 1)));
        let now_us = self.mcu.device_time_us();
        self.trace.push(now_us, self.mcu.chamber_pa());
        let is_due = |start_us: u64| now_us as i64 >= start_us as i64 + self.at_us;
        if self.broken_us.is_none() && self.start_us.is_some_and(is_due) {
            self.broken_us = Some(now_us);
            self.faults.iter().for_each(|fault| self.inject(fault));
        }
        if self.state() == DeviceState::Venting {
            self.vented_us.get_or_insert(now_us);
        }
        let bits = self.mcu.controller().faults().bits();
        let codes = (1..=16).filter_map(|number| Code::<FaultCode>::from_raw(number).known());
        let fresh = codes.filter(|code| bits & !self.seen & code.bit() != 0);
        self.latched.extend(fresh.map(|code| (code, now_us)));
        self.seen = bits;
    }

    fn inject(&mut self, fault: &Fault) {
        match fault {
            Fault::Part(part) => self.error = self.mcu.inject(self.channel, *part).err().or(self.error.take()),
            Fault::Stop => self.mcu.set_emergency_stop(true),
            Fault::Reset => *self.mcu.processor_mut() = here(),
            Fault::Silence => self.is_silent = true,
            Fault::Stall => self.stalled_until_us = self.mcu.now_us() + STALL_US,
        }
    }
}

impl Transport for Session {
    fn now_us(&self) -> u64 {
        self.mcu.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        if !self.is_silent {
            self.mcu.write(bytes);
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        let before = into.len();
        self.mcu.read(into);
        if self.is_silent {
            into.truncate(before);
        }
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        while self.mcu.now_us() < deadline_us.max(self.stalled_until_us) {
            self.step(deadline_us.max(self.stalled_until_us));
            let is_readable = self.mcu.is_readable() && !self.is_silent;
            if is_readable && self.mcu.now_us() >= self.stalled_until_us {
                return;
            }
        }
    }
}
