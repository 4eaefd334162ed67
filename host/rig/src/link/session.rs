//! The host's side of a session, without ports or clocks: bytes and times in, bytes and events out.

use std::collections::VecDeque;

use softlimb_protocol::{
    Ack, Compatibility, Decoder, DeviceMessage, DeviceState, Heartbeat, HeartbeatReply, HelloReply, HostMessage, Knots,
    LogRecord, LogState, MAX_FRAME_LEN, ReliableSender, RetryPolicy, SendError, SenderStep, Setpoint, Telemetry,
    encode_frame,
};

use super::clock::{ClockEstimator, ClockMap};
use super::error::{LinkError, message_name};
use super::event::Event;
use super::statistics::{LinkStatistics, PortErrors};
use super::trajectory::{Knot, Trajectory};
use super::window::Window;

/// Time from knots to the next heartbeat, us: the longest frame of a single knot has left a line of 115200 baud long before.
const HEARTBEAT_APART_US: u64 = 10_000;

/// The answer to a reliable message.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// To a Hello that was not refused.
    Hello(HelloReply),
    /// To everything else.
    Ack(Ack),
}

/// One session with one device: numbers and repeats messages, keeps the link alive, learns the device's clock, streams setpoints.
#[derive(Debug)]
pub struct Session {
    id: u16,
    heartbeat_us: u64,
    sender: ReliableSender,
    answer: Option<Answer>,
    /// The device's answer to a Hello that it refused: it carries the session that commands it.
    refused_reply: Option<HelloReply>,
    decoder: Decoder<DeviceMessage>,
    window: Window,
    clock: ClockEstimator,
    events: VecDeque<Event>,
    /// `None` until a compatible device has answered.
    heartbeat_due_us: Option<u64>,
    heartbeat_sent_us: u64,
    frame_seq: u16,
    heard_us: u64,
    state: Option<DeviceState>,
    told_state: Option<DeviceState>,
    telemetry: Option<Telemetry>,
    device_time_us: u64,
    buffered_min_us: Option<u64>,
    statistics: LinkStatistics,
    log_records: Vec<LogRecord>,
    log_state: Option<LogState>,
}

impl Session {
    /// A session that has not spoken yet. `id` should differ from the last session's; a heartbeat goes out every `heartbeat_us`, a frame has
    /// up to `batch` knots.
    #[must_use]
    pub fn new(id: u16, retry: RetryPolicy, heartbeat_us: u64, batch: u8) -> Self {
        Self {
            id,
            heartbeat_us,
            sender: ReliableSender::new(retry),
            answer: None,
            refused_reply: None,
            decoder: Decoder::new(),
            window: Window::new(retry.timeout_us, batch),
            clock: ClockEstimator::default(),
            events: VecDeque::new(),
            heartbeat_due_us: None,
            heartbeat_sent_us: 0,
            frame_seq: 0,
            heard_us: 0,
            state: None,
            told_state: None,
            telemetry: None,
            device_time_us: 0,
            buffered_min_us: None,
            statistics: LinkStatistics::default(),
            log_records: Vec::new(),
            log_state: None,
        }
    }

    /// Takes a reliable message; its answer comes from [`take_answer`](Self::take_answer).
    ///
    /// # Errors
    /// [`SendError`] while another one is unanswered, or for a message that is not reliable.
    pub fn request(&mut self, now_us: u64, message: &HostMessage) -> Result<(), SendError> {
        self.answer = None;
        self.sender.send(message, now_us).map(|_| ())
    }

    /// The answer to the last request, once.
    pub fn take_answer(&mut self) -> Option<Answer> {
        self.answer.take()
    }

    /// The answer of a device that another host commands.
    #[must_use]
    pub fn refused_reply(&self) -> Option<&HelloReply> {
        self.refused_reply.as_ref()
    }

    /// Whether a request is unanswered.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.sender.is_busy()
    }

    /// Appends the frames that are due and returns the time of the next one, us. Call it then, and after every [`receive`](Self::receive).
    ///
    /// # Errors
    /// [`LinkError::NoAnswer`] when a reliable message was repeated often enough.
    pub fn transmit(&mut self, now_us: u64, out: &mut Vec<u8>) -> Result<u64, LinkError> {
        let request_due_us = self.transmit_request(now_us, out)?;
        while let Some(knots) = self.window.send(now_us, self.id, self.frame_seq) {
            self.push_frame(&knots, out);
            self.shift_heartbeat(now_us);
        }
        if self.heartbeat_due_us.is_some_and(|due_us| now_us >= due_us) {
            (self.heartbeat_due_us, self.heartbeat_sent_us) = (Some(now_us + self.heartbeat_us), now_us);
            self.push_frame(&Heartbeat { session: self.id, host_time_us: now_us }.into(), out);
        }
        Ok(request_due_us.min(self.heartbeat_due_us.unwrap_or(u64::MAX)).min(self.window.due_us()))
    }

    /// Moves the heartbeat away from knots sent now: neither shall wait for the other on a slow line. No two are further apart by that.
    fn shift_heartbeat(&mut self, now_us: u64) {
        let (period_us, sent_us) = (self.heartbeat_us, self.heartbeat_sent_us);
        let apart_us = (now_us + HEARTBEAT_APART_US).max(sent_us + period_us / 2);
        self.heartbeat_due_us = self.heartbeat_due_us.map(|_| apart_us.min(sent_us + period_us));
    }

    fn transmit_request(&mut self, now_us: u64, out: &mut Vec<u8>) -> Result<u64, LinkError> {
        loop {
            match self.sender.poll(now_us) {
                SenderStep::Transmit(bytes) => {
                    out.extend_from_slice(bytes);
                    self.statistics.frames_sent += 1;
                }
                SenderStep::WaitUntil(due_us) => return Ok(due_us),
                SenderStep::Idle => return Ok(u64::MAX),
                SenderStep::GaveUp { message_type, .. } => {
                    return Err(LinkError::NoAnswer { message: message_name(message_type) });
                }
            }
        }
    }

    fn push_frame(&mut self, message: &HostMessage, out: &mut Vec<u8>) {
        let mut frame = [0; MAX_FRAME_LEN];
        // A whole-frame buffer is never too small.
        let len = encode_frame(message, self.frame_seq, &mut frame).unwrap_or_default();
        out.extend_from_slice(&frame[..len]);
        self.frame_seq = self.frame_seq.wrapping_add(1);
        self.statistics.frames_sent += 1;
    }

    /// Takes bytes from the device, in any chunking.
    ///
    /// # Errors
    /// The first answer that ends the run: a setpoint refused for good. All bytes are taken nevertheless.
    pub fn receive(&mut self, now_us: u64, bytes: &[u8]) -> Result<(), LinkError> {
        let mut outcome = Ok(());
        for &byte in bytes {
            if let Some(Ok(frame)) = self.decoder.push(byte) {
                self.heard_us = now_us;
                outcome = outcome.and(self.on_message(now_us, frame.message));
            }
        }
        outcome
    }

    fn on_message(&mut self, now_us: u64, message: DeviceMessage) -> Result<(), LinkError> {
        let answers = self.sender.on_message(&message);
        match message {
            DeviceMessage::HelloReply(reply) if answers => self.on_hello(now_us, reply),
            DeviceMessage::Ack(ack) if answers => self.answer = Some(Answer::Ack(ack)),
            DeviceMessage::Ack(ack) if [Setpoint::MESSAGE_TYPE, Knots::MESSAGE_TYPE].contains(&ack.ref_type) => {
                self.window.on_ack(now_us, &ack)?;
            }
            DeviceMessage::HeartbeatReply(reply) => self.on_heartbeat(now_us, &reply),
            DeviceMessage::Telemetry(message) => self.on_telemetry(now_us, message),
            DeviceMessage::Samples(message) => self.events.push_back(Event::Samples { host_time_us: now_us, message }),
            DeviceMessage::Fault(message) => self.events.push_back(Event::Fault { host_time_us: now_us, message }),
            DeviceMessage::LogRecords(message) => self.log_records = message.records.iter().collect(),
            DeviceMessage::LogState(state) => self.log_state = Some(state),
            DeviceMessage::LinkErrors(errors) => self.statistics.port_errors = Some(PortErrors::from(&errors)),
            DeviceMessage::HelloReply(reply) if reply.session != self.id => self.refused_reply = Some(reply),
            // Ticks are for a replay: the log has the bytes.
            DeviceMessage::HelloReply(_) | DeviceMessage::Ack(_) | DeviceMessage::Ticks(_) => {}
        }
        Ok(())
    }

    fn on_hello(&mut self, now_us: u64, reply: HelloReply) {
        if Compatibility::of(reply.protocol_version, reply.schema_hash) == Compatibility::Same {
            (self.heartbeat_due_us, self.heartbeat_sent_us) = (Some(now_us), now_us);
            self.enter(reply.state.known());
        }
        self.answer = Some(Answer::Hello(reply));
    }

    fn on_heartbeat(&mut self, now_us: u64, reply: &HeartbeatReply) {
        // An answer to another host's heartbeat may carry any time.
        let round_trip_us = now_us.checked_sub(reply.host_time_us).filter(|_| self.heartbeat_due_us.is_some());
        if let Some(round_trip_us) = round_trip_us {
            self.clock.add(reply.host_time_us, now_us, reply.mcu_time_us);
            self.device_time_us = reply.mcu_time_us;
            self.statistics.round_trip.add(round_trip_us);
        }
        self.window.on_places(reply.free_knots);
        self.enter(reply.state.known());
    }

    fn on_telemetry(&mut self, now_us: u64, message: Telemetry) {
        self.window.on_progress(now_us, message.time_us, message.next_index, message.free_knots);
        self.device_time_us = message.time_us;
        self.enter(message.state.known());
        if message.state == DeviceState::Running && !self.window.is_complete() {
            let buffered_us = self.window.accepted_until_us().map(|until_us| until_us.saturating_sub(message.time_us));
            self.buffered_min_us = self.buffered_min_us.into_iter().chain(buffered_us).min();
        }
        self.telemetry = Some(message.clone());
        self.events.push_back(Event::Telemetry { host_time_us: now_us, message });
    }

    fn enter(&mut self, state: Option<DeviceState>) {
        self.state = state;
        if let Some(state) = state.filter(|_| state != self.told_state) {
            self.told_state = Some(state);
            self.events.push_back(Event::State(state));
        }
    }

    /// Wants to hear the state anew. The line keeps the order: whatever arrives after an answer was said after it.
    pub(super) fn forget_state(&mut self) {
        self.state = None;
    }

    /// Waits for a part of the log anew.
    pub(super) fn forget_log(&mut self) {
        self.log_records.clear();
        self.log_state = None;
    }

    /// The message that ends a part of the log.
    pub(super) fn log_state(&self) -> Option<&LogState> {
        self.log_state.as_ref()
    }

    /// The records of that part.
    pub(super) fn take_log_records(&mut self) -> Vec<LogRecord> {
        std::mem::take(&mut self.log_records)
    }

    /// Next event, in order.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Sets the knots that [`open_window`](Self::open_window) streams.
    pub(super) fn load(&mut self, trajectory: Trajectory) {
        self.window.load(trajectory);
    }

    /// Begins to stream from knot 0, with times from device time `start_us`, into an empty buffer of `free` places.
    pub(super) fn open_window(&mut self, now_us: u64, start_us: u64, free: u16) {
        self.window.open(now_us, start_us, free);
    }

    /// Adds a knot behind the last one; its time counts from the start of the window.
    ///
    /// # Errors
    /// [`LinkError::KnotTime`], [`LinkError::KnotValues`].
    pub(super) fn push(&mut self, knot: &Knot) -> Result<(), LinkError> {
        self.window.push(knot)
    }

    /// Streams no more.
    pub(super) fn close_window(&mut self) {
        self.window.close();
    }

    pub(super) fn window(&self) -> &Window {
        &self.window
    }

    /// The number that every message carries.
    #[must_use]
    pub fn id(&self) -> u16 {
        self.id
    }

    /// The device's state by its last word; `None` before that.
    #[must_use]
    pub fn state(&self) -> Option<DeviceState> {
        self.state
    }

    /// The state in the device's latest message, of any age.
    pub(super) fn last_state(&self) -> Option<DeviceState> {
        self.told_state
    }

    /// The last measurements.
    #[must_use]
    pub fn telemetry(&self) -> Option<&Telemetry> {
        self.telemetry.as_ref()
    }

    /// The device's time by its last word, us; 0 before that.
    #[must_use]
    pub fn device_time_us(&self) -> u64 {
        self.device_time_us
    }

    /// The device's clock; `None` before the first exchange.
    #[must_use]
    pub fn clock(&self) -> Option<ClockMap> {
        self.clock.map()
    }

    /// Time since the last valid frame of a connected device, us.
    #[must_use]
    pub fn silence_us(&self, now_us: u64) -> u64 {
        self.heartbeat_due_us.map_or(0, |_| now_us.saturating_sub(self.heard_us))
    }

    /// The shortest stretch of setpoints that was buffered on the running device while more were to come, us.
    #[must_use]
    pub fn buffered_min_us(&self) -> Option<u64> {
        self.buffered_min_us
    }

    /// Statistics of the link so far.
    #[must_use]
    pub fn statistics(&self) -> LinkStatistics {
        LinkStatistics {
            messages_repeated: u64::from(self.sender.retransmissions()),
            setpoints_repeated: self.window.repeated(),
            received: self.decoder.counters(),
            ..self.statistics
        }
    }
}
