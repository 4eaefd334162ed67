//! The host's side of reliable messages: one in flight, sent again until answered.

use core::error::Error;
use core::fmt;

use crate::codec::{MAX_FRAME_LEN, Message, encode_frame};
use crate::layout::Delivery;
use crate::message::{Ack, DeviceMessage, Hello, HostMessage, ResultCode};

/// When to send again and when to give up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RetryPolicy {
    /// Silence after which the frame is sent again, us.
    pub timeout_us: u64,
    /// Transmissions in all, at least 1.
    pub attempts_max: u32,
}

impl Default for RetryPolicy {
    /// 100 ms (twice the round trip of the longest frames at 115200 baud), ten times.
    fn default() -> Self {
        Self { timeout_us: 100_000, attempts_max: 10 }
    }
}

/// Why a message was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SendError {
    /// The previous message is still unanswered.
    Busy,
    /// The message is not of the reliable class.
    NotReliable,
}

impl fmt::Display for SendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Busy => "the previous reliable message is still unanswered",
            Self::NotReliable => "this message is not of the reliable class",
        })
    }
}

impl Error for SendError {}

/// Next action of the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SenderStep<'a> {
    /// Nothing in flight.
    Idle,
    /// Write these bytes to the link.
    Transmit(&'a [u8]),
    /// Nothing to do before this time, us.
    WaitUntil(u64),
    /// No answer to the last attempt; the message is dropped. The device may or may not have applied it.
    GaveUp {
        /// Type byte of the dropped message.
        message_type: u8,
        /// Its sequence number.
        seq: u16,
    },
}

/// Sends reliable messages one at a time and numbers them.
#[derive(Clone, Debug)]
pub struct ReliableSender {
    policy: RetryPolicy,
    next_seq: u16,
    retransmissions: u32,
    pending: Option<Pending>,
}

#[derive(Clone, Debug)]
struct Pending {
    frame: [u8; MAX_FRAME_LEN],
    len: usize,
    message_type: u8,
    seq: u16,
    session: u16,
    attempts: u32,
    due_us: u64,
}

impl ReliableSender {
    /// Nothing in flight; the first message gets number 0.
    #[must_use]
    pub const fn new(policy: RetryPolicy) -> Self {
        Self { policy, next_seq: 0, retransmissions: 0, pending: None }
    }

    /// Takes a message; the next [`poll`](Self::poll) transmits it. Returns its sequence number.
    ///
    /// # Errors
    /// [`SendError`] while another message is in flight, or for a message that is not reliable.
    pub fn send(&mut self, message: &HostMessage, now_us: u64) -> Result<u16, SendError> {
        if message.delivery() != Delivery::Reliable {
            return Err(SendError::NotReliable);
        }
        if self.pending.is_some() {
            return Err(SendError::Busy);
        }
        let seq = self.next_seq;
        let mut frame = [0; MAX_FRAME_LEN];
        // A whole-frame buffer is never too small.
        let len = encode_frame(message, seq, &mut frame).unwrap_or_default();
        self.pending = Some(Pending {
            frame,
            len,
            message_type: message.message_type(),
            seq,
            session: message.session(),
            attempts: 0,
            due_us: now_us,
        });
        self.next_seq = seq.wrapping_add(1);
        Ok(seq)
    }

    /// Action that is due now.
    pub fn poll(&mut self, now_us: u64) -> SenderStep<'_> {
        let attempts_max = self.policy.attempts_max.max(1);
        let exhausted = self.pending.take_if(|pending| now_us >= pending.due_us && pending.attempts >= attempts_max);
        if let Some(Pending { message_type, seq, .. }) = exhausted {
            return SenderStep::GaveUp { message_type, seq };
        }
        let Some(pending) = self.pending.as_mut() else {
            return SenderStep::Idle;
        };
        if now_us < pending.due_us {
            return SenderStep::WaitUntil(pending.due_us);
        }
        if pending.attempts > 0 {
            self.retransmissions = self.retransmissions.saturating_add(1);
        }
        pending.attempts += 1;
        pending.due_us = now_us.saturating_add(self.policy.timeout_us);
        SenderStep::Transmit(pending.frame.get(..pending.len).unwrap_or_default())
    }

    /// Shows the sender what arrived. True when it answers the message in flight, which is then done.
    ///
    /// A Hello is answered by the HelloReply of its session, or by an Ack that refuses it.
    pub fn on_message(&mut self, message: &DeviceMessage) -> bool {
        self.pending.take_if(|pending| pending.is_answered_by(message)).is_some()
    }

    /// True while a message waits for its answer.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.pending.is_some()
    }

    /// Frames sent again since the start; stays at its maximum.
    #[must_use]
    pub fn retransmissions(&self) -> u32 {
        self.retransmissions
    }
}

impl Pending {
    fn is_answered_by(&self, message: &DeviceMessage) -> bool {
        let hello = self.message_type == Hello::MESSAGE_TYPE;
        match message {
            DeviceMessage::HelloReply(reply) => hello && reply.session == self.session,
            DeviceMessage::Ack(ack) => self.matches(ack) && !(hello && ack.result == ResultCode::Ok),
            _ => false,
        }
    }

    fn matches(&self, ack: &Ack) -> bool {
        (ack.ref_type, ack.ref_seq) == (self.message_type, self.seq)
    }
}
