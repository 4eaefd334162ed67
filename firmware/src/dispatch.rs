//! Effect of each message of the host, and its answer.

use softlimb_protocol::{
    Ack, Arrival, Command, CommandCode, Compatibility, ConfigChannel, ConfigInverse, ConfigSystem, ConfigVolume,
    DeviceState, Heartbeat, HeartbeatReply, Hello, HelloReply, HostMessage, Message, PROTOCOL_VERSION, ResultCode,
    SCHEMA_HASH, Setpoint,
};

use crate::channel::Channel;
use crate::config::{ActiveConfig, ConfigError, StagedConfig, StagingError};
use crate::controller::Controller;
use crate::manual::has_unknown;
use crate::queue::{KNOTS, QueueError};
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
            HostMessage::ConfigBegin(begin) => match self.staged.begin(begin) {
                Ok(()) => OK,
                Err(error) => refused_field(error, softlimb_protocol::ConfigBegin::field_number),
            },
            HostMessage::ConfigSystem(part) => self.stage(|staged| staged.add_system(part), ConfigSystem::field_number),
            HostMessage::ConfigChannel(part) => {
                self.stage(|staged| staged.add_channel(part), ConfigChannel::field_number)
            }
            HostMessage::ConfigVolume(part) => self.stage(|staged| staged.add_volume(part), ConfigVolume::field_number),
            HostMessage::ConfigInverse(part) => {
                self.stage(|staged| staged.add_inverse(part), ConfigInverse::field_number)
            }
            HostMessage::ConfigCommit(commit) => self.commit(now_us, commit.config_hash),
            HostMessage::Command(command) => self.command(now_us, command),
            HostMessage::Setpoint(setpoint) => self.setpoint(now_us, setpoint),
            HostMessage::ManualPulse(pulse) => self.manual_pulse(now_us, pulse),
            HostMessage::SetOutputs(request) => self.set_outputs(request),
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
        }
        self.reply_hello(now_us, hello.session);
        OK
    }

    /// Tells who this is, with the session of the Hello, or with the one that commands where the Hello was refused.
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

    fn stage(
        &mut self,
        add: impl FnOnce(&mut StagedConfig<N>) -> Result<(), StagingError>,
        field_number: fn(&str) -> Option<u32>,
    ) -> Answer {
        match add(&mut self.staged) {
            Ok(()) => OK,
            Err(StagingError::Field(error)) => refused_field(error, field_number),
            Err(error) => mismatch(error),
        }
    }

    /// Swaps to the uploaded configuration as a whole, or leaves everything as it is.
    fn commit(&mut self, now_us: u64, config_hash: u32) -> Answer {
        if !matches!(self.state, DeviceState::Idle | DeviceState::Ready) {
            return WRONG_STATE;
        }
        let sensors = |config: &ActiveConfig<N>| (config.system.sensor, config.channels.len());
        let before = self.config.as_ref().map(sensors);
        if let Err(error) = self.staged.commit(config_hash, &mut self.config) {
            return mismatch(error);
        }
        // The zero belongs to the sensor: the same sensors keep theirs, whatever the pressure now.
        let same_sensors = before == self.config.as_ref().map(sensors);
        if !same_sensors {
            self.channels.clear();
        }
        self.channels.iter_mut().for_each(Channel::reconfigure);
        let count = self.config.as_ref().map_or(0, |config| config.channels.len());
        while self.channels.len() < count && self.channels.push(Channel::new()).is_ok() {}
        self.zeroed &= same_sensors;
        self.telemetry_due_us = now_us;
        self.staged.forget();
        self.start_us = None;
        self.queue.flush();
        self.apply(now_us, Event::Reconfigured);
        OK
    }

    fn command(&mut self, now_us: u64, command: &Command) -> Answer {
        let Some(code) = command.code.known() else {
            return (ResultCode::UnknownCode, Command::field_number("code").unwrap_or(0));
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

    fn setpoint(&mut self, now_us: u64, setpoint: &Setpoint) -> Answer {
        let Some(config) = &self.config else { return WRONG_STATE };
        if !matches!(self.state, DeviceState::Ready | DeviceState::Running | DeviceState::Holding) {
            return WRONG_STATE;
        }
        if setpoint.values.len() != config.channels.len() {
            return (ResultCode::WrongChannelCount, config.channels.len() as u32);
        }
        let outside = setpoint.values.iter().zip(&config.channels).position(|(value, channel)| {
            let (low, high) = channel.setpoint_range;
            !(low..=high).contains(value)
        });
        if let Some(channel) = outside {
            return (ResultCode::OutOfRange, channel as u32);
        }
        if has_unknown(setpoint.outputs) {
            return (ResultCode::UnknownCode, Setpoint::field_number("outputs").unwrap_or(0));
        }
        match self.queue.push(now_us, setpoint.index, setpoint.time_us, (setpoint.outputs, &setpoint.values)) {
            Ok(()) => OK,
            Err(QueueError::UnexpectedIndex { expected }) => (ResultCode::UnexpectedIndex, expected),
            Err(QueueError::Full) => (ResultCode::QueueFull, 0),
            Err(QueueError::Late) => (ResultCode::Late, 0),
            Err(QueueError::TooManyValues) => (ResultCode::WrongChannelCount, config.channels.len() as u32),
        }
    }
}

/// Why an upload as a whole is refused.
fn mismatch(error: StagingError) -> Answer {
    match error {
        StagingError::TablesMissing { channel } => (ResultCode::TablesMissing, u32::from(channel)),
        _ => (ResultCode::ConfigMismatch, 0),
    }
}

/// The number of the offending field, as the protocol counts them.
fn refused_field(error: ConfigError, field_number: fn(&str) -> Option<u32>) -> Answer {
    let detail = field_number(error.field()).unwrap_or(0);
    match error {
        ConfigError::OutOfRange { .. } => (ResultCode::OutOfRange, detail),
        ConfigError::UnknownCode { .. } => (ResultCode::UnknownCode, detail),
    }
}
