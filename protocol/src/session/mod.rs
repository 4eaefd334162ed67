//! Session state of both ends: a reliable message is applied once.

mod dedup;
mod sender;

pub use dedup::{Arrival, SeqDedup};
pub use sender::{ReliableSender, RetryPolicy, SendError, SenderStep};
