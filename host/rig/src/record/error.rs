//! Errors of a log.

use super::cdr::CdrError;
use std::path::{Path, PathBuf};

/// Why a log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The operating system refused an operation on the file.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// The action, as a verb.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The file does not begin as an MCAP file does.
    #[error("{} is not an MCAP file", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// An MCAP file, but of something else, or cut off before its first record.
    #[error("{} holds no softlimb run (no `softlimb.run` metadata)", path.display())]
    NotARun {
        /// The file.
        path: PathBuf,
    },
    /// The layout of the log is of another version.
    #[error("log format {found:?} in {}; this version reads {:?}", path.display(), super::FORMAT_VERSION)]
    Version {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: String,
    },
    /// The metadata does not describe a run.
    #[error("metadata `{name}`: {reason}")]
    Metadata {
        /// Name of the metadata record.
        name: &'static str,
        /// Reason.
        reason: String,
    },
    /// A topic carries another message type than this version writes.
    #[error("topic {topic} carries {found:?}, not the {expected:?} of this version")]
    Schema {
        /// The topic.
        topic: String,
        /// Type in the file.
        found: String,
        /// Type that belongs there.
        expected: &'static str,
    },
    /// A message does not decode.
    #[error("message {sequence} of {topic}: {source}")]
    Message {
        /// The topic.
        topic: &'static str,
        /// Number of the message within the run.
        sequence: u32,
        /// Error of decoding.
        source: CdrError,
    },
    /// Two parts of the log contradict each other.
    #[error("message {sequence} of {topic}: {reason}")]
    Inconsistent {
        /// The topic.
        topic: &'static str,
        /// Number of the message within the run.
        sequence: u32,
        /// The contradiction.
        reason: String,
    },
    /// The caller's sample does not fit the run.
    #[error("sample at {time_s} s: {reason}")]
    Sample {
        /// Time of the sample, s.
        time_s: f64,
        /// Reason.
        reason: String,
    },
    /// The container could not be written or is damaged beyond its opening.
    #[error("{context}: {source}")]
    Container {
        /// The action.
        context: &'static str,
        /// The container library's reason.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl RecordError {
    /// Wraps an operating system error with what was tried on which file.
    pub(super) fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> RecordError {
        move |source| RecordError::File { action, path: path.to_owned(), source }
    }

    /// Wraps a reason of the container library, whose types stay in this room.
    pub(super) fn container(context: &'static str) -> impl FnOnce(mcap::McapError) -> RecordError {
        move |source| RecordError::Container { context, source: Box::new(source) }
    }

    /// Wraps a reason of the container library that writes a file: the operating system's, with the file, or the library's own.
    pub(super) fn written(context: &'static str, path: &Path) -> impl FnOnce(mcap::McapError) -> RecordError {
        move |reason| match reason {
            mcap::McapError::Io(source) => RecordError::File { action: "write", path: path.to_owned(), source },
            other => RecordError::Container { context, source: Box::new(other) },
        }
    }
}
