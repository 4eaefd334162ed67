//! Several hosts on one device: one commands, the others look (`protocol/SPEC.md`, section 4.1).

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use softlimb_protocol::{
    Ack, CommandCode, Decoder, DeviceMessage, Frame, Hello, HelloReply, HostMessage, MAX_FRAME_LEN, Message, ResultCode,
};

/// Silence of the commanding client after which another connection may go on with its session number: a reconnected host.
const RECONNECT: Duration = Duration::from_secs(1);
/// Unanswered frames that are remembered.
const ASKED_MAX: usize = 256;

/// Number of a client.
pub(super) type ClientId = u64;

/// Valid frames in a stream of bytes, each with its bytes.
pub(super) struct Frames<M> {
    decoder: Decoder<M>,
    bytes: Vec<u8>,
}

impl<M: Message> Frames<M> {
    pub(super) fn new() -> Self {
        Self { decoder: Decoder::new(), bytes: vec![0] }
    }

    /// Takes a byte; at the end of a valid frame its message, and its bytes with both delimiters.
    pub(super) fn push(&mut self, byte: u8) -> Option<(Frame<M>, Vec<u8>)> {
        // A longer one is not valid.
        if self.bytes.len() < MAX_FRAME_LEN {
            self.bytes.push(byte);
        }
        let frame = self.decoder.push(byte);
        let bytes = (byte == 0).then(|| std::mem::replace(&mut self.bytes, vec![0]));
        frame?.ok().zip(bytes)
    }
}

/// Mark by which an answer of the device is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    Heartbeat { host_time_us: u64 },
    Ack { message_type: u8, seq: u16 },
}

/// Receivers of a message of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Addressee {
    All,
    One(ClientId),
}

struct Commander {
    client: ClientId,
    session: u16,
    heard: Instant,
}

/// Decides which frames reach the device, and which client gets an answer.
#[derive(Default)]
pub(super) struct Gate {
    commander: Option<Commander>,
    /// Forwarded frames without an answer; the device answers in their order.
    asked: VecDeque<(ClientId, Mark)>,
    /// Sessions of the forwarded Hellos, by client.
    hellos: Vec<(ClientId, u16)>,
}

impl Gate {
    /// The client that commands the device.
    pub(super) fn commander(&self) -> Option<ClientId> {
        self.commander.as_ref().map(|commander| commander.client)
    }

    /// Whether a client's frame may go to the device; the outcome of a refusal otherwise.
    pub(super) fn admit(
        &mut self,
        now: Instant,
        client: ClientId,
        frame: &Frame<HostMessage>,
    ) -> Result<(), ResultCode> {
        match &mut self.commander {
            Some(commander) if commander.client == client => commander.heard = now,
            Some(commander) if !is_open_to_all(&frame.message) || commander.is_impersonated(now, &frame.message) => {
                return Err(ResultCode::WrongSession);
            }
            _ => {}
        }
        let message_type = frame.message.message_type();
        match &frame.message {
            HostMessage::Heartbeat(heartbeat) => {
                self.ask(client, Mark::Heartbeat { host_time_us: heartbeat.host_time_us });
            }
            message => {
                if let HostMessage::Hello(Hello { session, .. }) = message {
                    self.hellos.retain(|(known, _)| *known != client);
                    self.hellos.push((client, *session));
                }
                self.ask(client, Mark::Ack { message_type, seq: frame.seq });
            }
        }
        Ok(())
    }

    fn ask(&mut self, client: ClientId, mark: Mark) {
        if self.asked.len() == ASKED_MAX {
            self.asked.pop_front();
        }
        self.asked.push_back((client, mark));
    }

    /// The receivers of a message of the device. An accepted Hello makes its client the commander.
    pub(super) fn addressee(&mut self, now: Instant, message: &DeviceMessage) -> Addressee {
        let mark = match message {
            DeviceMessage::HelloReply(reply) => return self.inquirer(reply),
            DeviceMessage::HeartbeatReply(reply) => Mark::Heartbeat { host_time_us: reply.host_time_us },
            DeviceMessage::Ack(ack) => Mark::Ack { message_type: ack.ref_type, seq: ack.ref_seq },
            _ => return Addressee::All,
        };
        let place = self.asked.iter().position(|(_, asked)| *asked == mark);
        let asker = place.and_then(|place| self.asked.remove(place)).map(|(client, _)| client);
        if let (DeviceMessage::Ack(ack), Some(client)) = (message, asker)
            && ack.ref_type == Hello::MESSAGE_TYPE
            && ack.result == ResultCode::Ok
            && let Some(&(_, session)) = self.hellos.iter().find(|(known, _)| *known == client)
        {
            self.commander = Some(Commander { client, session, heard: now });
        }
        asker.or(self.commander()).map_or(Addressee::All, Addressee::One)
    }

    /// The receivers of a HelloReply: the client whose session it opens. Behind a refusal it carries the session of the commander, and all
    /// others learn about the device.
    fn inquirer(&self, reply: &HelloReply) -> Addressee {
        let asked = self.hellos.iter().rev().find(|(_, session)| *session == reply.session);
        match asked {
            Some(&(client, _)) if self.commander() != Some(client) => Addressee::One(client),
            _ => Addressee::All,
        }
    }

    /// Forgets a client.
    pub(super) fn leave(&mut self, client: ClientId) {
        self.commander.take_if(|commander| commander.client == client);
        self.asked.retain(|(asker, _)| *asker != client);
        self.hellos.retain(|(known, _)| *known != client);
    }
}

impl Commander {
    /// Whether a message of another client opens the commander's session while the commander is there, or would keep its link alive.
    fn is_impersonated(&self, now: Instant, message: &HostMessage) -> bool {
        let is_silent = now.saturating_duration_since(self.heard) >= RECONNECT;
        match message {
            HostMessage::Hello(hello) => hello.session == self.session && !is_silent,
            HostMessage::Heartbeat(heartbeat) => heartbeat.session == self.session,
            _ => false,
        }
    }
}

/// Whether every host may send this message.
fn is_open_to_all(message: &HostMessage) -> bool {
    match message {
        HostMessage::Hello(_) | HostMessage::Heartbeat(_) => true,
        HostMessage::Command(command) => command.code == CommandCode::EmergencyStop,
        _ => false,
    }
}

/// The server's own answer to a frame that it does not hand on.
pub(super) fn refusal(frame: &Frame<HostMessage>, result: ResultCode, mcu_time_us: u64) -> DeviceMessage {
    let (ref_type, ref_seq) = (frame.message.message_type(), frame.seq);
    Ack { ref_type, ref_seq, result: result.into(), detail: 0, free_knots: 0, mcu_time_us }.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use softlimb_protocol::{Command, DeviceState, Heartbeat, HeartbeatReply, PROTOCOL_VERSION, SCHEMA_HASH};

    const VENT: CommandCode = CommandCode::Vent;

    fn hello(session: u16) -> HostMessage {
        Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session }.into()
    }

    fn command(session: u16, code: CommandCode) -> HostMessage {
        Command { session, code: code.into(), time_us: 0 }.into()
    }

    /// A gate at one moment, and a device whose answers the test chooses.
    struct Scene {
        gate: Gate,
        now: Instant,
    }

    impl Scene {
        fn admit(&mut self, client: ClientId, seq: u16, message: HostMessage) -> Result<(), ResultCode> {
            self.gate.admit(self.now, client, &Frame { seq, message })
        }

        fn answer(&mut self, ref_seq: u16, message: &HostMessage, result: ResultCode) -> Addressee {
            let frame = Frame { seq: ref_seq, message: message.clone() };
            self.gate.addressee(self.now, &refusal(&frame, result, 0))
        }
    }

    /// Client 1 commands with session 5.
    fn commanded() -> Scene {
        let mut scene = Scene { gate: Gate::default(), now: Instant::now() };
        assert_eq!(scene.admit(1, 0, hello(5)), Ok(()));
        assert_eq!(scene.answer(0, &hello(5), ResultCode::Ok), Addressee::One(1));
        assert_eq!(scene.gate.commander(), Some(1));
        scene
    }

    #[test]
    fn first_client_commands_and_the_others_look() {
        let mut scene = commanded();
        assert_eq!(scene.admit(1, 1, command(5, VENT)), Ok(()));
        // Even with the session number of the commander.
        assert_eq!(scene.admit(2, 1, command(5, VENT)), Err(ResultCode::WrongSession));
        assert_eq!(scene.admit(2, 2, hello(5)), Err(ResultCode::WrongSession));
        assert_eq!(scene.admit(2, 3, command(9, CommandCode::EmergencyStop)), Ok(()));
        assert_eq!(scene.admit(2, 4, hello(9)), Ok(()));
        assert_eq!(scene.answer(4, &hello(9), ResultCode::WrongSession), Addressee::One(2));
        assert_eq!(scene.gate.commander(), Some(1));
    }

    #[test]
    fn answers_go_to_the_client_that_asked_first() {
        let mut scene = commanded();
        let beat = |session| HostMessage::from(Heartbeat { session, host_time_us: 7 });
        for (client, session) in [(2, 9), (1, 5)] {
            assert_eq!(scene.admit(client, 0, beat(session)), Ok(()));
            assert_eq!(scene.admit(client, 9, command(5, CommandCode::EmergencyStop)), Ok(()));
        }
        let reply = HeartbeatReply { host_time_us: 7, mcu_time_us: 0, state: DeviceState::Idle.into(), free_knots: 0 };
        for client in [2, 1, 1] {
            // Nobody asked for the third answer: the commander gets it.
            assert_eq!(scene.gate.addressee(scene.now, &reply.clone().into()), Addressee::One(client));
            let stop = command(5, CommandCode::EmergencyStop);
            assert_eq!(scene.answer(9, &stop, ResultCode::Ok), Addressee::One(client));
        }
    }

    #[test]
    fn hello_reply_goes_to_the_client_whose_session_it_opens_and_behind_a_refusal_to_all() {
        let mut scene = commanded();
        assert_eq!(scene.admit(2, 0, hello(9)), Ok(()));
        let reply = |session| HelloReply {
            protocol_version: PROTOCOL_VERSION,
            schema_hash: SCHEMA_HASH,
            session,
            firmware_major: 0,
            firmware_minor: 1,
            firmware_patch: 0,
            boot_cause: softlimb_protocol::BootCause::PowerOn.into(),
            boot_detail: 0,
            state: DeviceState::Idle.into(),
            channels_max: 9,
            knots_capacity: 64,
            tick_us: 1_000,
            config_hash: 0,
            mcu_time_us: 0,
        };
        assert_eq!(scene.gate.addressee(scene.now, &reply(9).into()), Addressee::One(2));
        assert_eq!(scene.gate.addressee(scene.now, &reply(5).into()), Addressee::All);
    }

    #[test]
    fn next_client_commands_once_the_first_is_gone_or_silent() {
        let mut scene = commanded();
        scene.gate.leave(1);
        assert_eq!(scene.admit(2, 1, command(9, VENT)), Ok(()), "the device itself decides");
        let mut scene = commanded();
        scene.now += RECONNECT;
        let beat = HostMessage::from(Heartbeat { session: 5, host_time_us: 7 });
        assert_eq!(scene.admit(2, 1, beat), Err(ResultCode::WrongSession), "it would hide that the link is lost");
        assert_eq!(scene.admit(2, 0, hello(5)), Ok(()), "the same host, connected again");
        scene.answer(0, &hello(5), ResultCode::Ok);
        assert_eq!(scene.gate.commander(), Some(2));
        assert_eq!(scene.admit(1, 1, command(5, VENT)), Err(ResultCode::WrongSession));
    }

    #[test]
    fn frames_keep_their_bytes_and_noise_is_left_out() {
        let mut encoded = [0; MAX_FRAME_LEN];
        let len = softlimb_protocol::encode_frame(&command(5, VENT), 3, &mut encoded).unwrap();
        let noise = [9; 2 * MAX_FRAME_LEN];
        let mut frames = Frames::<HostMessage>::new();
        let stream = [&encoded[..len], &noise, &encoded[..len], &encoded[1..len]].concat();
        let found: Vec<_> = stream.iter().filter_map(|&byte| frames.push(byte)).collect();
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|(frame, bytes)| frame.seq == 3 && bytes == &encoded[..len]));
    }
}
