//! The serial link of softlimb: every message, how it is framed and checked, and the small state machines both ends share.
//!
//! The interface is one table in [`message`]; structs, encoders, decoders and the schema text behind [`SCHEMA_HASH`] are
//! derived from it. `SPEC.md` beside this crate describes the same bytes for a reader who does not use Rust.
//!
//! Nothing here does IO or reads a clock: bytes and times are arguments.
//!
//! ```
//! use softlimb_protocol::{Decoder, Heartbeat, HostMessage, MAX_FRAME_LEN, encode_frame};
//!
//! let message = HostMessage::from(Heartbeat { session: 7, host_time_us: 1_000 });
//! let mut wire = [0; MAX_FRAME_LEN];
//! let len = encode_frame(&message, 42, &mut wire)?;
//!
//! let mut decoder = Decoder::<HostMessage>::new();
//! let frames: Vec<_> = wire[..len].iter().filter_map(|&byte| decoder.push(byte)).collect();
//! let frame = frames[0].as_ref().unwrap();
//! assert_eq!((frame.seq, &frame.message), (42, &message));
//! # Ok::<(), softlimb_protocol::EncodeError>(())
//! ```
#![no_std]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod batch;
mod code;
mod codec;
mod config_hash;
mod crc;
mod error;
#[macro_use]
mod interface;
mod layout;
mod list;
pub mod message;
mod session;
mod setpoint;
mod version;
mod wire;

pub use batch::{Batch, StepInPlace};
pub use code::{Code, CodeSet};
pub use codec::{Decoder, Frame, LinkCounters, MAX_BODY_LEN, MAX_FRAME_LEN, MAX_PAYLOAD_LEN, Message, encode_frame};
pub use config_hash::ConfigHash;
pub use crc::crc32c;
pub use error::{EncodeError, FrameError, ListLengthError, PayloadError, SetpointError};
pub use layout::{CodeLayout, Delivery, FieldLayout, MessageLayout};
pub use list::List;
pub use message::*;
pub use session::{Arrival, ReliableSender, RetryPolicy, SendError, SenderStep, SeqDedup};
pub use version::{Compatibility, SCHEMA_HASH};
