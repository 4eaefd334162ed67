//! Brings a controller into the state of a device that was configured before its log began.

use softlimb_protocol::{Hello, HostMessage, MAX_FRAME_LEN, PROTOCOL_VERSION, SCHEMA_HASH, encode_frame};

use super::frames::Framed;

/// Time that a device is given before the log, us: longer than a link timeout, so that the log's session can follow, and than the zeroing of sensors.
pub(super) const BEFORE_US: u64 = 11_000_000;

/// The frames that configure a device in a session before that of the log. The configuration is the log's: that of before is not in it, and the
/// zeros of the sensors, which are kept from it, matter only to what depends on their codes.
pub(super) fn frames(told: &[Framed<HostMessage>], session_of_log: u16) -> Vec<u8> {
    let session = session_of_log.wrapping_add(1);
    let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session };
    let begin = told.iter().rposition(|frame| matches!(frame.message, HostMessage::ConfigBegin(_))).unwrap_or(0);
    let upload = told.iter().skip(begin).filter_map(|frame| of_session(&frame.message, session));
    let mut bytes = Vec::new();
    for (seq, message) in (0..).zip([hello.into()].into_iter().chain(upload)) {
        let mut frame = [0; MAX_FRAME_LEN];
        // A whole-frame buffer is never too small.
        let len = encode_frame(&message, seq, &mut frame).unwrap_or_default();
        bytes.extend_from_slice(&frame[..len]);
    }
    bytes
}

/// A part of an upload, of another session.
fn of_session(message: &HostMessage, session: u16) -> Option<HostMessage> {
    let mut message = message.clone();
    match &mut message {
        HostMessage::ConfigBegin(part) => part.session = session,
        HostMessage::ConfigSystem(part) => part.session = session,
        HostMessage::ConfigChannel(part) => part.session = session,
        HostMessage::ConfigVolume(part) => part.session = session,
        HostMessage::ConfigInverse(part) => part.session = session,
        HostMessage::ConfigCommit(part) => part.session = session,
        _ => return None,
    }
    Some(message)
}
