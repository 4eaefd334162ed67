//! Which interface this is, and whether the other end speaks the same.

use crate::crc::crc32c_const;
use crate::message::{PROTOCOL_VERSION, SCHEMA_TEXT};

/// CRC-32C of [`SCHEMA_TEXT`]: changes with any name, number, type or order in the interface.
pub const SCHEMA_HASH: u32 = crc32c_const(SCHEMA_TEXT.as_bytes());

/// Outcome of comparing the two ends' versions after a handshake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compatibility {
    /// Same interface: everything is allowed.
    Same,
    /// Same protocol version, other messages: only the handshake and the heartbeat are safe.
    OtherSchema,
    /// Other protocol version.
    OtherVersion,
}

impl Compatibility {
    /// Compares the peer's announcement with this crate.
    #[must_use]
    pub fn of(protocol_version: u16, schema_hash: u32) -> Self {
        match (protocol_version == PROTOCOL_VERSION, schema_hash == SCHEMA_HASH) {
            (false, _) => Self::OtherVersion,
            (true, false) => Self::OtherSchema,
            (true, true) => Self::Same,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_equal_announcements_are_the_same() {
        use Compatibility::*;
        assert_eq!(Compatibility::of(PROTOCOL_VERSION, SCHEMA_HASH), Same);
        assert_eq!(Compatibility::of(PROTOCOL_VERSION, SCHEMA_HASH ^ 1), OtherSchema);
        assert_eq!(Compatibility::of(PROTOCOL_VERSION + 1, SCHEMA_HASH), OtherVersion);
    }
}
