//! The device's memory of the last reliable message.

use crate::codec::Message;
use crate::layout::Delivery;
use crate::message::{Ack, HostMessage};

/// Treatment of a frame that just arrived.
#[derive(Clone, Debug, PartialEq)]
pub enum Arrival {
    /// Apply it, answer it, and [`record`](SeqDedup::record) the answer.
    New,
    /// It was applied before: give this answer again, with fresh time and free places. A repeated Hello gets a fresh HelloReply.
    Repeated(Ack),
    /// Older than the last reliable message: the host has its answer; drop it.
    Stale,
}

/// Recognises reliable messages that arrive again.
///
/// Reliable messages carry their own sequence numbers, one higher (mod 2^16) for each new message; numbers up to 32767 behind the
/// last one are stale. A Hello is never stale: it opens the sequence. Check the session before asking.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeqDedup {
    last: Option<Handled>,
}

#[derive(Clone, Debug, PartialEq)]
struct Handled {
    session: u16,
    ack: Ack,
}

impl SeqDedup {
    /// Nothing handled yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: None }
    }

    /// Classifies a message; one that is not reliable is always new.
    #[must_use]
    pub fn classify(&self, seq: u16, message: &HostMessage) -> Arrival {
        let reliable = message.delivery() == Delivery::Reliable;
        let Some(last) = self.last.as_ref().filter(|_| reliable) else {
            return Arrival::New;
        };
        if last.session != message.session() {
            return Arrival::New;
        }
        let behind = last.ack.ref_seq.wrapping_sub(seq);
        if behind == 0 && last.ack.ref_type == message.message_type() {
            return Arrival::Repeated(last.ack.clone());
        }
        match (behind, message) {
            (_, HostMessage::Hello(_)) | (0x8000.., _) => Arrival::New,
            _ => Arrival::Stale,
        }
    }

    /// Remembers the answer to a new message; answers to messages that are not reliable are not kept.
    pub fn record(&mut self, message: &HostMessage, ack: &Ack) {
        if message.delivery() == Delivery::Reliable {
            self.last = Some(Handled { session: message.session(), ack: ack.clone() });
        }
    }
}
