//! Effect of each message of the host, and its answer.

use core::num::NonZeroU32;

use softlimb_protocol::{
    Ack, Arrival, Command, CommandCode, Compatibility, DeviceState, Heartbeat, HeartbeatReply, Hello, HelloReply,
    HostMessage, Message, PROTOCOL_VERSION, ResultCode, SCHEMA_HASH,
};

use crate::channel::Channel;
use crate::config::{ActiveConfig, ConfigError, StagingError, number};
use crate::controller::Controller;
use crate::queue::KNOTS;
use crate::sensor::Zeros;
use crate::state::Event;
use crate::valve::TICK_US;

/// Outcome of a message and its detail.
pub(crate) type Answer = (ResultCode, u32);

pub(crate) const OK: Answer = (ResultCode::Ok, 0);
pub(crate) const WRONG_STATE: Answer = (ResultCode::WrongState, 0);

impl<const N: usize> Controller<N> {
    /// Applies one message and queues its answer.
    pub(crate) fn dispatch(&mut self, now_us: u64, seq: u16, message: &HostMessage) {
        if self.link.is_owner(message.session()) {
            self.link.heard(now_us);
        }
        match message {
            HostMessage::Heartbeat(heartbeat) => self.heartbeat(now_us, heartbeat),
            HostMessage::Hello(_) => self.reliable(now_us, seq, message),
            // Whoever asks for a stop gets it.
            HostMessage::Command(command) if command.code == CommandCode::EmergencyStop => {
                self.stop_requested = true;
                self.acknowledge(now_us, seq, message, OK);
            }
            _ if self.link.is_stranger(message.session()) => {
                self.acknowledge(now_us, seq, message, (ResultCode::SchemaMismatch, 0));
            }
            _ if !self.link.is_owner(message.session()) => {
                self.acknowledge(now_us, seq, message, (ResultCode::WrongSession, 0));
            }
            _ => self.reliable(now_us, seq, message),
        }
    }

    /// Applies a message once, however often it arrives.
    fn reliable(&mut self, now_us: u64, seq: u16, message: &HostMessage) {
        match self.dedup.classify(seq, message) {
            Arrival::New => {
                let answer = self.handle(now_us, message);
                let ack = self.acknowledge(now_us, seq, message, answer);
                if let (HostMessage::Hello(hello), ResultCode::WrongSession) = (message, answer.0) {
                    self.reply_hello(now_us, self.link.owner().unwrap_or(hello.session));
                }
                if self.link.is_owner(message.session()) {
                    self.dedup.record(message, &ack);
                }
            }
            Arrival::Repeated(ack) => {
                if let HostMessage::Hello(hello) = message {
                    self.reply_hello(now_us, hello.session);
                }
                self.outbox.push(&Ack { free_knots: self.queue.free(), mcu_time_us: now_us, ..ack }.into());
            }
            Arrival::Stale => {}
        }
    }

    fn handle(&mut self, now_us: u64, message: &HostMessage) -> Answer {
        match message {
            HostMessage::Hello(hello) => self.hello(now_us, hello),
            HostMessage::Heartbeat(_) => OK,
            HostMessage::ConfigBegin(begin) => staged(self.staged.begin(begin).map_err(StagingError::from)),
            HostMessage::ConfigSystem(part) => staged(self.staged.add_system(part)),
            HostMessage::ConfigChannel(part) => staged(self.staged.add_channel(part)),
            HostMessage::ConfigVolume(part) => staged(self.staged.add_volume(part)),
            HostMessage::ConfigInverse(part) => staged(self.staged.add_inverse(part)),
            HostMessage::ConfigCommit(commit) => self.commit(now_us, commit.config_hash),
            HostMessage::Command(command) => self.command(now_us, command),
            HostMessage::Setpoint(setpoint) => self.setpoint(now_us, setpoint),
            HostMessage::ManualPulse(pulse) => self.manual_pulse(now_us, pulse),
            HostMessage::SetOutputs(request) => self.set_outputs(request),
            HostMessage::Knots(knots) => self.knots(now_us, knots),
            HostMessage::SetSampling(request) => self.set_sampling(now_us, request),
            HostMessage::ReadLog(request) => self.read_log(request.first),
            HostMessage::ReadLinkErrors(_) => {
                self.send_link_errors(now_us);
                OK
            }
        }
    }

    fn acknowledge(&mut self, now_us: u64, seq: u16, message: &HostMessage, (result, detail): Answer) -> Ack {
        let ack = Ack {
            ref_type: message.message_type(),
            ref_seq: seq,
            result: result.into(),
            detail,
            free_knots: self.queue.free(),
            mcu_time_us: now_us,
        };
        self.outbox.push(&ack.clone().into());
        ack
    }

    fn hello(&mut self, now_us: u64, hello: &Hello) -> Answer {
        if Compatibility::of(hello.protocol_version, hello.schema_hash) != Compatibility::Same {
            self.link.turn_away(hello.session);
            self.reply_hello(now_us, hello.session);
            return (ResultCode::SchemaMismatch, 0);
        }
        let timeout_us = self.config.as_ref().map(|config| config.system.link_timeout_us);
        let is_new = !self.link.is_owner(hello.session);
        if !self.link.open(now_us, hello.session, timeout_us) {
            return (ResultCode::WrongSession, 0);
        }
        if is_new {
            // What another host has begun does not go on under this one.
            self.staged.forget();
            self.start_us = None;
            self.sampling.stop();
        }
        self.reply_hello(now_us, hello.session);
        OK
    }

    /// Sends a HelloReply: with the session of the Hello, or with the commanding session if the Hello was refused.
    fn reply_hello(&mut self, now_us: u64, session: u16) {
        let version = |text: &str| text.parse().unwrap_or(0);
        let reply = HelloReply {
            protocol_version: PROTOCOL_VERSION,
            schema_hash: SCHEMA_HASH,
            session,
            firmware_major: version(env!("CARGO_PKG_VERSION_MAJOR")),
            firmware_minor: version(env!("CARGO_PKG_VERSION_MINOR")),
            firmware_patch: version(env!("CARGO_PKG_VERSION_PATCH")),
            boot_cause: self.boot.cause.into(),
            boot_detail: self.boot.detail,
            state: self.state.into(),
            channels_max: N as u8,
            knots_capacity: KNOTS as u16,
            tick_us: TICK_US,
            config_hash: self.config.as_ref().map_or(0, |config| config.hash),
            mcu_time_us: now_us,
        };
        self.outbox.push(&reply.into());
    }

    fn heartbeat(&mut self, now_us: u64, heartbeat: &Heartbeat) {
        let reply = HeartbeatReply {
            host_time_us: heartbeat.host_time_us,
            mcu_time_us: now_us,
            state: self.state.into(),
            free_knots: self.queue.free(),
        };
        self.outbox.push(&reply.into());
    }

    /// Swaps to the uploaded configuration as a whole, or leaves everything as it is.
    fn commit(&mut self, now_us: u64, config_hash: u32) -> Answer {
        if !matches!(self.state, DeviceState::Idle | DeviceState::Ready) {
            return WRONG_STATE;
        }
        let sensors = |config: &ActiveConfig<N>| (config.system.sensor, config.channels.len());
        let before = self.config.as_ref().map(sensors);
        let answer = staged(self.staged.commit(config_hash, &mut self.config));
        if answer != OK {
            return answer;
        }
        // The zero belongs to the sensor: the same sensors keep theirs, whatever the pressure now.
        let same_sensors = before == self.config.as_ref().map(sensors);
        if !same_sensors {
            self.channels.clear();
            self.zeros = Zeros::Unknown;
        }
        self.channels.iter_mut().for_each(Channel::reconfigure);
        let count = self.config.as_ref().map_or(0, |config| config.channels.len());
        while self.channels.len() < count && self.channels.push(Channel::new()).is_ok() {}
        self.telemetry_due_us = now_us;
        self.staged.forget();
        self.start_us = None;
        self.sampling.reconfigure(&mut self.outbox);
        self.queue.flush();
        self.apply(now_us, Event::Reconfigured);
        OK
    }

    fn command(&mut self, now_us: u64, command: &Command) -> Answer {
        let Some(code) = command.code.known() else {
            return (ResultCode::UnknownCode, u32::from(number!(Command, "code")));
        };
        match code {
            CommandCode::Start => self.start(now_us, command.time_us),
            // Without a configuration it vents after a crash, and nothing shall keep that air in.
            CommandCode::Hold if self.config.is_none() => WRONG_STATE,
            CommandCode::Hold => self.transition(now_us, Event::Hold),
            CommandCode::Vent if self.config.is_none() => WRONG_STATE,
            CommandCode::Vent => self.transition(now_us, Event::Vent),
            CommandCode::EmergencyStop => OK,
            CommandCode::ClearFaults => self.clear_faults(now_us),
            CommandCode::Flush if self.state == DeviceState::Running => WRONG_STATE,
            CommandCode::Flush => {
                self.start_us = None;
                self.queue.flush();
                OK
            }
            CommandCode::Zero => self.zero(now_us),
        }
    }

    fn transition(&mut self, now_us: u64, event: Event) -> Answer {
        if self.apply(now_us, event) { OK } else { WRONG_STATE }
    }

    /// Arms a start. The first knot must not lie before it: nothing is skipped.
    fn start(&mut self, now_us: u64, time_us: u64) -> Answer {
        if !matches!(self.state, DeviceState::Ready | DeviceState::Holding) {
            return WRONG_STATE;
        }
        if let Some(code) = self.obstacle_to_start() {
            return (ResultCode::WrongState, u32::from(code as u8));
        }
        let start_us = time_us.max(now_us);
        if self.queue.first_time_us().is_none_or(|first_us| first_us < start_us) {
            return (ResultCode::Late, 0);
        }
        self.start_us = Some(start_us);
        OK
    }

    /// The end of the turn answers: the log is the board's.
    fn read_log(&mut self, first: u32) -> Answer {
        if self.state == DeviceState::Running {
            return WRONG_STATE;
        }
        self.log_request = NonZeroU32::new(first.max(1));
        OK
    }

    /// Forgets faults whose cause is gone. Nothing moves: a faulted device drops its setpoints and any armed start.
    fn clear_faults(&mut self, now_us: u64) -> Answer {
        if let Some(code) = self.standing_fault() {
            return (ResultCode::WrongState, u32::from(code as u8));
        }
        self.faults.clear();
        self.channels.iter_mut().for_each(|channel| channel.clear_faults());
        if self.state == DeviceState::Faulted {
            self.queue.flush();
            self.apply(now_us, Event::Clear);
        }
        OK
    }
}

/// The answer to a part of an upload.
fn staged(outcome: Result<(), StagingError>) -> Answer {
    match outcome {
        Ok(()) => OK,
        Err(StagingError::Field(error @ ConfigError::OutOfRange { .. })) => {
            (ResultCode::OutOfRange, error.field().into())
        }
        Err(StagingError::Field(error @ ConfigError::UnknownCode { .. })) => {
            (ResultCode::UnknownCode, error.field().into())
        }
        Err(StagingError::TablesMissing { channel }) => (ResultCode::TablesMissing, u32::from(channel)),
        Err(_) => (ResultCode::ConfigMismatch, 0),
    }
}
