//! One session on one transport: turns the wheel until something is so.

use std::sync::atomic::Ordering;

use softlimb_protocol::{
    Ack, Command, CommandCode, Compatibility, DeviceState, Hello, HelloReply, HostMessage, Message, PROTOCOL_VERSION,
    ResultCode, SCHEMA_HASH,
};

use super::clock::ClockMap;
use super::error::{LinkError, message_name};
use super::event::Event;
use super::fault::DeviceFault;
use super::options::StreamOptions;
use super::session::{Answer, Session};
use super::transport::Transport;

/// Time for which the device's clock is believed to go on after its last word, us. An emulated one need not keep up with the host's.
const UNTOLD_US: u64 = 50_000;

/// Time between two attempts to open a session.
const OCCUPIED_PAUSE_US: u64 = 50_000;

/// Largest lag of the news of a fault behind the state that it caused, us: a few telemetry messages on a bad line.
const FAULT_NEWS_US: u64 = 200_000;

/// Runs a session.
pub(super) struct Driver<'a, T> {
    transport: &'a mut T,
    pub(super) session: Session,
    options: &'a StreamOptions<'a>,
    on_event: &'a mut dyn FnMut(&mut T, Event),
    /// The first fault that stops the device.
    fault: Option<DeviceFault>,
    /// After cancellation or an error, venting is no longer to be canceled.
    pub(super) ending: bool,
    bytes: Vec<u8>,
}

impl<'a, T: Transport> Driver<'a, T> {
    pub(super) fn new(
        transport: &'a mut T,
        options: &'a StreamOptions<'a>,
        on_event: &'a mut dyn FnMut(&mut T, Event),
    ) -> Self {
        let session = Session::new(options.session, options.retry, options.heartbeat_us, options.batch);
        Self { transport, session, options, on_event, fault: None, ending: false, bytes: Vec::new() }
    }

    pub(super) fn now_us(&self) -> u64 {
        self.transport.now_us()
    }

    /// Sends what is due, waits for bytes or until `deadline_us`, takes what arrived.
    pub(super) fn turn(&mut self, deadline_us: u64) -> Result<(), LinkError> {
        let due_us = self.send()?;
        self.transport.wait_until(due_us.min(deadline_us));
        self.bytes.clear();
        self.transport.receive(&mut self.bytes)?;
        let now_us = self.transport.now_us();
        let outcome = self.session.receive(now_us, &self.bytes);
        self.tell_events();
        outcome?;
        let silence_us = self.session.silence_us(now_us);
        if silence_us > self.options.silence_max_us {
            return Err(LinkError::Silent { silence_us });
        }
        if !self.ending && self.options.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
            return Err(LinkError::Canceled);
        }
        Ok(())
    }

    /// Sends what is due. Returns the time at which more will be due, us.
    pub(super) fn send(&mut self) -> Result<u64, LinkError> {
        self.bytes.clear();
        let due_us = self.session.transmit(self.transport.now_us(), &mut self.bytes)?;
        if !self.bytes.is_empty() {
            self.transport.send(&self.bytes)?;
        }
        Ok(due_us)
    }

    fn tell_events(&mut self) {
        while let Some(event) = self.session.next_event() {
            if let Event::Fault { message, .. } = &event
                && self.fault.is_none()
            {
                self.fault = Some(DeviceFault::from(message)).filter(DeviceFault::stops_the_device);
            }
            self.tell(event);
        }
    }

    pub(super) fn tell(&mut self, event: Event) {
        (self.on_event)(self.transport, event);
    }

    /// Turns until the condition holds, at most for `limit_us`; whether it does.
    pub(super) fn until(&mut self, limit_us: u64, mut condition: impl FnMut(&Self) -> bool) -> Result<bool, LinkError> {
        let deadline_us = self.now_us().saturating_add(limit_us);
        loop {
            if condition(self) {
                return Ok(true);
            }
            if self.now_us() >= deadline_us {
                return Ok(false);
            }
            self.turn(deadline_us)?;
        }
    }

    /// Sends a reliable message and waits for its answer, however often it has to be repeated.
    fn request(&mut self, message: &HostMessage) -> Result<Answer, LinkError> {
        if self.session.request(self.now_us(), message).is_err() {
            return Err(LinkError::NoAnswer { message: message_name(message.message_type()) });
        }
        loop {
            self.turn(u64::MAX)?;
            if let Some(answer) = self.session.take_answer() {
                return Ok(answer);
            }
        }
    }

    /// Sends a message other than Hello; its answer, whatever it is.
    fn acknowledged(&mut self, message: &HostMessage) -> Result<Ack, LinkError> {
        match self.request(message)? {
            Answer::Ack(ack) => Ok(ack),
            Answer::Hello(_) => Err(LinkError::NoAnswer { message: message_name(message.message_type()) }),
        }
    }

    /// Sends a message and wants it applied.
    pub(super) fn demand(&mut self, message: &HostMessage) -> Result<(), LinkError> {
        let ack = self.acknowledged(message)?;
        if ack.result != ResultCode::Ok {
            return Err(LinkError::refused(message, &ack, self.session.last_state()));
        }
        self.session.forget_state();
        Ok(())
    }

    /// Sends a command and wants it applied.
    pub(super) fn command(&mut self, code: CommandCode) -> Result<(), LinkError> {
        let message = self.message(code, 0);
        self.demand(&message)
    }

    /// Sends a start for a device time; false when it came too late.
    pub(super) fn start(&mut self, start_us: u64) -> Result<bool, LinkError> {
        let message = self.message(CommandCode::Start, start_us);
        let ack = self.acknowledged(&message)?;
        match ack.result.known() {
            Some(ResultCode::Ok) => Ok(true),
            Some(ResultCode::Late) => Ok(false),
            _ => Err(LinkError::refused(&message, &ack, self.session.last_state())),
        }
    }

    /// Sends a command whatever goes wrong; its answer if one comes within `limit_us`.
    pub(super) fn try_command(&mut self, code: CommandCode, limit_us: u64) -> Option<Ack> {
        self.settle(limit_us);
        let (now_us, message) = (self.now_us(), self.message(code, 0));
        self.session.request(now_us, &message).ok()?;
        self.settle(limit_us);
        self.session.forget_state();
        match self.session.take_answer()? {
            Answer::Ack(ack) => Some(ack),
            Answer::Hello(_) => None,
        }
    }

    /// Turns until no request is unanswered, whatever goes wrong, at most for `limit_us`.
    pub(super) fn settle(&mut self, limit_us: u64) {
        let deadline_us = self.now_us().saturating_add(limit_us);
        while self.session.is_busy() && self.now_us() < deadline_us {
            // These two come without a wait and will not get better; all others come after one.
            if let Err(LinkError::Port(_) | LinkError::NoAnswer { .. }) = self.turn(deadline_us) {
                return;
            }
        }
    }

    fn message(&self, code: CommandCode, time_us: u64) -> HostMessage {
        Command { session: self.session.id(), code: code.into(), time_us }.into()
    }

    /// Opens the session, once the last host has been silent for long enough.
    pub(super) fn hello(&mut self) -> Result<HelloReply, LinkError> {
        let give_up_us = self.now_us().saturating_add(self.options.occupied_max_us);
        loop {
            let again_us = self.now_us().saturating_add(OCCUPIED_PAUSE_US);
            match self.try_hello() {
                Err(LinkError::Occupied) if again_us <= give_up_us => {
                    self.until(OCCUPIED_PAUSE_US, |_| false)?;
                }
                outcome => return outcome,
            }
        }
    }

    /// Opens the session with a device that speaks the same interface.
    fn try_hello(&mut self) -> Result<HelloReply, LinkError> {
        let hello =
            Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: self.session.id() }.into();
        let reply = match self.request(&hello)? {
            Answer::Hello(reply) => reply,
            Answer::Ack(ack) if ack.result == ResultCode::WrongSession => return Err(LinkError::Occupied),
            Answer::Ack(ack) => return Err(LinkError::refused(&hello, &ack, self.session.last_state())),
        };
        if Compatibility::of(reply.protocol_version, reply.schema_hash) != Compatibility::Same {
            return Err(LinkError::Incompatible {
                firmware: super::device::DeviceInfo::from(&reply).firmware,
                version: reply.protocol_version,
                hash: reply.schema_hash,
            });
        }
        Ok(reply)
    }

    /// The device's clock, after the first exchange.
    pub(super) fn clock(&mut self) -> Result<ClockMap, LinkError> {
        loop {
            if let Some(clock) = self.session.clock() {
                return Ok(clock);
            }
            self.turn(u64::MAX)?;
        }
    }

    /// The device's time now, us: by its clock, but never far from its last word.
    pub(super) fn device_now_us(&mut self) -> Result<u64, LinkError> {
        let clock = self.clock()?;
        Ok(clock.device_us(self.now_us()).min(self.session.device_time_us().saturating_add(UNTOLD_US)))
    }

    /// Waits for one of the states; an error when the device faults instead or takes longer than `limit_us`.
    pub(super) fn until_state(
        &mut self,
        states: &[DeviceState],
        limit_us: u64,
        late: impl FnOnce(&Self) -> LinkError,
    ) -> Result<(), LinkError> {
        let is_one = |state: Option<DeviceState>, states: &[DeviceState]| state.is_some_and(|s| states.contains(&s));
        let faulted = [DeviceState::Faulted];
        let reached = self.until(limit_us, |driver| {
            let state = driver.session.state();
            is_one(state, states) || is_one(state, &faulted)
        })?;
        match reached {
            true if is_one(self.session.state(), states) => Ok(()),
            true => Err(LinkError::Fault { fault: self.fault_news() }),
            false => Err(late(self)),
        }
    }

    /// The fault that stopped the device. Its message may have been lost; the bits in Telemetry stay.
    pub(super) fn fault_news(&mut self) -> Option<DeviceFault> {
        // An error on the way takes nothing from what is known.
        let _ = self.until(FAULT_NEWS_US, |driver| driver.known_fault().is_some());
        self.known_fault()
    }

    /// The fault that stops the device, as far as it is known.
    pub(super) fn known_fault(&self) -> Option<DeviceFault> {
        let bits = self.session.telemetry().map_or(0, |telemetry| telemetry.fault_bits);
        self.fault.or_else(|| DeviceFault::from_bits(bits))
    }

    /// Faults from before do not count any more.
    pub(super) fn forget_faults(&mut self) {
        self.fault = None;
    }
}
