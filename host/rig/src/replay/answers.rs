//! Finds the tick in which a device took each frame of its host, from the device's answers.

use std::collections::{BTreeMap, HashMap, VecDeque};

use softlimb_protocol::{DeviceMessage, Heartbeat, HostMessage, Message};

use super::frames::Framed;

/// Longest time from a frame to its answer, us: sequence numbers repeat after 65536 frames.
const ANSWER_MAX_US: u64 = 2_000_000;

/// Type of a frame of the host, and its number: what an answer repeats.
type Key = (u8, u64);

/// Device time in a message, us.
pub(super) fn device_us(message: &DeviceMessage) -> Option<u64> {
    match message {
        DeviceMessage::HelloReply(reply) => Some(reply.mcu_time_us),
        DeviceMessage::HeartbeatReply(reply) => Some(reply.mcu_time_us),
        DeviceMessage::Ack(ack) => Some(ack.mcu_time_us),
        DeviceMessage::Telemetry(telemetry) => Some(telemetry.time_us),
        // Sent in the tick of the last one.
        DeviceMessage::Samples(samples) => {
            let steps = samples.samples.len().saturating_sub(1) as u64;
            Some(samples.time_us.saturating_add(steps.saturating_mul(samples.period_us.into())))
        }
        DeviceMessage::Ticks(ticks) => {
            let steps = ticks.ticks.len().saturating_sub(1) as u64;
            Some(ticks.time_us.saturating_add(1_000 * steps))
        }
        DeviceMessage::Fault(_)
        | DeviceMessage::LinkErrors(_)
        | DeviceMessage::LogRecords(_)
        | DeviceMessage::LogState(_) => None,
    }
}

/// Indices of the host's frames by the device time of the tick that took them, and the number of frames without an answer. Those were lost on
/// the line, or change nothing.
pub(super) fn ticks_of(
    told: &[Framed<HostMessage>],
    heard: &[Framed<DeviceMessage>],
) -> (BTreeMap<u64, Vec<usize>>, u64) {
    let mut answers: HashMap<Key, VecDeque<(u64, u64)>> = HashMap::new();
    for frame in heard {
        if let (Some(key), Some(us)) = (answered(&frame.message), device_us(&frame.message)) {
            answers.entry(key).or_default().push_back((frame.host_us, us));
        }
    }
    let (mut taken, mut unanswered): (BTreeMap<u64, Vec<usize>>, _) = (BTreeMap::new(), 0);
    for (index, frame) in told.iter().enumerate() {
        let waiting = answers.get_mut(&asked(frame));
        let answer = waiting.and_then(|waiting| {
            while waiting.front().is_some_and(|(heard_us, _)| *heard_us < frame.host_us) {
                waiting.pop_front();
            }
            let is_near = waiting.front().is_some_and(|(heard_us, _)| *heard_us <= frame.host_us + ANSWER_MAX_US);
            if is_near { waiting.pop_front() } else { None }
        });
        match answer {
            Some((_, us)) => taken.entry(us).or_default().push(index),
            None => unanswered += 1,
        }
    }
    (taken, unanswered)
}

fn asked(frame: &Framed<HostMessage>) -> Key {
    match &frame.message {
        HostMessage::Heartbeat(heartbeat) => (Heartbeat::MESSAGE_TYPE, heartbeat.host_time_us),
        message => (message.message_type(), u64::from(frame.seq)),
    }
}

fn answered(message: &DeviceMessage) -> Option<Key> {
    match message {
        DeviceMessage::HeartbeatReply(reply) => Some((Heartbeat::MESSAGE_TYPE, reply.host_time_us)),
        DeviceMessage::Ack(ack) => Some((ack.ref_type, u64::from(ack.ref_seq))),
        _ => None,
    }
}
