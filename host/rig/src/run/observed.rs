//! The simulated device with an observer beside it: what a camera and a gauge in the chamber would see.

use std::collections::VecDeque;
use std::io;

use softlimb_sim::plant::{Snapshot, Truth};
use softlimb_sim::{EmulatorError, Processor, SimulatedMcu};

use super::RunError;
use super::recording::Bench;
use super::tape::Tape;
use super::timed_fault::{FaultKind, TimedFault};
use crate::link::Transport;
use crate::record::{CoilPulse, DeviceTick};

/// Ticks the observer remembers: longer than any telemetry message takes to arrive.
const MEMORY: usize = 256;

/// A simulated device with a record of its latest ticks. A message finds there the true state at the time it was sent.
pub(super) struct Observed {
    device: SimulatedMcu<Box<dyn Processor>>,
    seen: VecDeque<(u64, Snapshot)>,
    tape: Tape,
    /// Faults to come, by falling time: the next one is the last.
    faults: Vec<TimedFault>,
    /// Device time of the start of the run, us.
    start_us: Option<u64>,
    link: Link,
}

/// State of the link under the faults.
#[derive(Debug, Default)]
struct Link {
    is_silent: bool,
    /// Time up to which the host does nothing, us.
    stalled_until_us: u64,
    /// Bytes to the device that wait for that time.
    to_device: Vec<u8>,
}

impl Observed {
    pub(super) fn new(device: SimulatedMcu<Box<dyn Processor>>) -> Self {
        Self {
            device,
            seen: VecDeque::with_capacity(MEMORY),
            tape: Tape::default(),
            faults: Vec::new(),
            start_us: None,
            link: Link::default(),
        }
    }

    /// The same for a run with a log.
    pub(super) fn recording(device: SimulatedMcu<Box<dyn Processor>>) -> Self {
        Self { tape: Tape::recording(), ..Self::new(device) }
    }

    /// The same with faults on the way; the run lasts for `duration_us`.
    ///
    /// # Errors
    /// [`RunError::Fault`].
    pub(super) fn with_faults(mut self, faults: &[TimedFault], duration_us: u64) -> Result<Self, RunError> {
        for fault in faults {
            let refused = |reason| Err(RunError::Fault { name: fault.name.clone(), reason });
            if fault.time_us > duration_us {
                let (time_s, end_s) = (fault.time_us as f64 * 1e-6, duration_us as f64 * 1e-6);
                return refused(format!("its time is {time_s} s, and the run ends at {end_s} s"));
            }
            if let Err(reason) = self.can_break(fault) {
                return refused(reason);
            }
        }
        self.faults = faults.to_vec();
        self.faults.sort_by_key(|fault| std::cmp::Reverse(fault.time_us));
        Ok(self)
    }

    fn can_break(&self, fault: &TimedFault) -> Result<(), String> {
        let FaultKind::Part(part) = fault.kind else { return Ok(()) };
        self.device.can_break(fault.channel.unwrap_or(0), &part).map_err(|error| error.to_string())
    }

    /// Injects the faults that are due.
    fn break_due_parts(&mut self) {
        let Some(start_us) = self.start_us else { return };
        let run_us = self.device.device_time_us().saturating_sub(start_us);
        while let Some(fault) = self.faults.pop_if(|fault| fault.time_us <= run_us) {
            match fault.kind {
                FaultKind::Part(part) => {
                    // The part was found when the run was made ready.
                    let _ = self.device.inject(fault.channel.unwrap_or(0), part);
                }
                FaultKind::EmergencyStop => self.device.set_emergency_stop(true),
                FaultKind::Reset => {
                    // A processor that does not start again is found at its next turn.
                    let _ = self.device.processor_mut().crash();
                }
                FaultKind::LinkSilent => self.link.is_silent = true,
                FaultKind::HostStall { length_us } => {
                    self.link.stalled_until_us = Transport::now_us(&self.device) + length_us;
                }
            }
        }
    }

    fn is_stalled(&self) -> bool {
        Transport::now_us(&self.device) < self.link.stalled_until_us
    }

    /// Why the device does not run any more, if it does not.
    pub(super) fn take_failure(&mut self) -> Option<EmulatorError> {
        self.device.take_failure()
    }

    fn look(&mut self) {
        let time_us = self.device.device_time_us();
        if self.seen.back().is_some_and(|(last, _)| *last == time_us) {
            return;
        }
        let oldest = if self.seen.len() == MEMORY { self.seen.pop_front() } else { None };
        let (_, mut snapshot) = oldest.unwrap_or_default();
        self.device.snapshot(&mut snapshot);
        self.seen.push_back((time_us, snapshot));
        self.tape.tick(|| latest_tick(&self.device));
    }
}

impl Bench for Observed {
    /// The truth at a device time, if it is remembered.
    fn truth_at(&self, device_us: u64) -> Option<Truth> {
        let index = self.seen.binary_search_by_key(&device_us, |(time_us, _)| *time_us).ok()?;
        Some(self.device.truth_of(&self.seen[index].1))
    }

    fn tape(&mut self) -> &mut Tape {
        &mut self.tape
    }

    fn armed(&mut self, start_us: u64) {
        self.start_us.get_or_insert(start_us);
    }

    fn peak_chamber_pa(&self) -> Vec<f64> {
        self.device.peak_chamber_pa()
    }

    fn is_at_pins(&self) -> bool {
        self.device.processor().is_at_pins()
    }

    fn break_now(&mut self, fault: TimedFault) -> Result<(), String> {
        self.can_break(&fault)?;
        // Faults are taken from the end.
        self.faults.push(fault);
        Ok(())
    }
}

impl Transport for Observed {
    fn now_us(&self) -> u64 {
        Transport::now_us(&self.device)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.link.is_silent {
            return Ok(());
        }
        self.link.to_device.extend_from_slice(bytes);
        if self.is_stalled() {
            return Ok(());
        }
        let bytes = std::mem::take(&mut self.link.to_device);
        self.tape.sent(Transport::now_us(&self.device), &bytes);
        self.device.send(&bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        if self.is_stalled() {
            return Ok(());
        }
        let before = into.len();
        self.device.receive(into)?;
        if self.link.is_silent {
            into.truncate(before);
        }
        self.tape.received(Transport::now_us(&self.device), &into[before..]);
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        while (self.is_stalled() || !self.device.is_readable()) && Transport::now_us(&self.device) < deadline_us {
            let tick_us = self.device.next_tick_us().min(deadline_us);
            self.device.advance_to(tick_us);
            self.look();
            self.break_due_parts();
        }
    }
}

/// Inputs and outputs of the latest tick.
fn latest_tick(device: &SimulatedMcu<Box<dyn Processor>>) -> DeviceTick {
    let (inputs, outputs) = (device.inputs(), device.outputs());
    let codes = inputs.pressure.iter().take(device.channels()).chain([&inputs.supply]);
    let energized = (0..).zip(outputs.valves).filter(|(_, pulse)| pulse.fill_us > 0 || pulse.vent_us > 0);
    let pulse = |(channel, pulse): (u8, softlimb_sim::ValvePulse)| CoilPulse {
        channel,
        fill_us: pulse.fill_us,
        vent_us: pulse.vent_us,
    };
    DeviceTick {
        device_us: inputs.now_us,
        codes: codes.map(|code| code.0).collect(),
        valve_supply_code: inputs.valve_supply.0,
        stop_pressed: inputs.emergency_stop,
        supply_open: outputs.supply_open,
        pump_duty: outputs.pump_duty,
        outputs: outputs.digital.bits(),
        pulses: energized.map(pulse).collect(),
    }
}
