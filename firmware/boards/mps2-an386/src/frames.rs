//! Queries to the link: a message into bytes, and back, with nine channels.

use core::hint::black_box;

use softlimb_protocol::*;

use crate::Bench;
use crate::answer::{Answer, Note};
use crate::upload::{CHANNELS, knot, knots};

const NAME: &str = "nine channels";

/// A message that came through the decoder.
struct Read(Option<HostMessage>);

impl Answer for Read {
    fn note(&self) -> Note {
        match &self.0 {
            Some(HostMessage::Setpoint(setpoint)) => {
                Note::of("read", 0, setpoint.values.iter().map(|value| *value as f32))
            }
            Some(HostMessage::Knots(knots)) => {
                let steps = knots.knots.in_place().flat_map(|step| step.steps().map(f32::from));
                Note::of("read", 0, steps)
            }
            _ => Note::of("lost", 0, []),
        }
    }
}

/// A frame, and its length.
pub(crate) struct Written(pub(crate) [u8; MAX_FRAME_LEN], pub(crate) usize);

impl Answer for Written {
    fn note(&self) -> Note {
        let Self(bytes, length) = self;
        Note::of("-", 0, [*length as f32].into_iter().chain(bytes[..*length].iter().map(|byte| f32::from(*byte))))
    }
}

/// Puts all queries; whether the frames hold what was put into them.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    let telemetry = DeviceMessage::from(telemetry());
    let sent = bench.put("frame, encode a Telemetry", NAME, || written(black_box(&telemetry)));
    let mut decoder = Decoder::<DeviceMessage>::new();
    let same = |message: DeviceMessage| message == telemetry;
    let kept = sent.0[..sent.1]
        .iter()
        .filter_map(|byte| decoder.push(*byte))
        .any(|frame| frame.is_ok_and(|frame| same(frame.message)));

    let setpoint = HostMessage::from(knot(17, 1_234_567));
    let frame = written(&setpoint);
    let one = bench.put("frame, decode a Setpoint", NAME, || Read(read(black_box(&frame))));
    let knots = HostMessage::from(knots(18));
    let frame = written(&knots);
    let several = bench.put("frame, decode Knots", NAME, || Read(read(black_box(&frame))));
    kept && one.0 == Some(setpoint) && several.0 == Some(knots)
}

pub(crate) fn written<M: Message>(message: &M) -> Written {
    let mut bytes = [0; MAX_FRAME_LEN];
    let length = encode_frame(message, 4_711, &mut bytes).unwrap_or(0);
    Written(bytes, length)
}

fn read(Written(bytes, length): &Written) -> Option<HostMessage> {
    let mut decoder = Decoder::<HostMessage>::new();
    let frames = bytes[..*length].iter().filter_map(|byte| decoder.push(*byte));
    frames.filter_map(Result::ok).map(|frame| frame.message).next()
}

fn telemetry() -> Telemetry {
    let sample = |channel: usize| ChannelSample {
        pressure_10pa: 4_000 + 100 * channel as u16,
        reference_10pa: 4_100,
        duty: 11,
        status: ChannelStatus::from_bits(0),
    };
    Telemetry {
        time_us: 12_345_678,
        state: DeviceState::Running.into(),
        fault_bits: 0,
        supply_10pa: 20_000,
        valve_supply_mv: 24_004,
        free_knots: 44,
        next_index: 617,
        ticks_late: 0,
        stack_used: 2_200,
        outputs: Outputs::GRIPPER,
        channels: List::try_from_iter((0..CHANNELS).map(sample)).expect("as many as there is room for"),
    }
}
