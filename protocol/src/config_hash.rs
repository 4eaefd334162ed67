//! The name of a configuration.

use crate::crc::{crc32c, crc32c_digest};
use crate::message::{ConfigBegin, ConfigChannel, ConfigInverse, ConfigSystem, ConfigVolume};
use crate::wire::{Wire, Writer};

/// Bytes of the session number, with which every payload of an upload begins and which the hash leaves out.
const SESSION_LEN: usize = size_of::<u16>();

// Only what begins with its session may be fed to the hash.
const _: () = {
    assert!(matches!(ConfigBegin::field_number("session"), Some(0)));
    assert!(matches!(ConfigSystem::field_number("session"), Some(0)));
    assert!(matches!(ConfigChannel::field_number("session"), Some(0)));
    assert!(matches!(ConfigVolume::field_number("session"), Some(0)));
    assert!(matches!(ConfigInverse::field_number("session"), Some(0)));
};

/// CRC-32C over the payloads of an upload without their session numbers, in the order of arrival: equal settings have equal
/// hashes in every session.
///
/// Both ends feed it the messages as they send or accept them; the host puts [`value`](Self::value) into `ConfigCommit`.
/// Bytes beyond the known fields of a message are not covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigHash {
    /// The checksum so far, in its final form.
    crc: u32,
}

impl ConfigHash {
    /// The name of nothing, before an upload begins.
    pub const NONE: Self = Self { crc: 0 };

    /// Starts over, as an upload does.
    #[must_use]
    pub fn begin(message: &ConfigBegin) -> Self {
        let mut hash = Self { crc: crc32c(&[]) };
        hash.add(message);
        hash
    }

    /// Adds the system part.
    pub fn add_system(&mut self, message: &ConfigSystem) {
        self.add(message);
    }

    /// Adds one channel.
    pub fn add_channel(&mut self, message: &ConfigChannel) {
        self.add(message);
    }

    /// Adds a channel's volume table.
    pub fn add_volume(&mut self, message: &ConfigVolume) {
        self.add(message);
    }

    /// Adds a channel's inverse table.
    pub fn add_inverse(&mut self, message: &ConfigInverse) {
        self.add(message);
    }

    /// The hash of everything added so far.
    #[must_use]
    pub fn value(&self) -> u32 {
        self.crc
    }

    fn add(&mut self, message: &impl Wire) {
        let mut payload = [0; crate::MAX_PAYLOAD_LEN];
        let writer = &mut Writer::new(&mut payload);
        // Every payload fits: the interface table is checked for it at compile time.
        if message.write(writer).is_ok() {
            self.crc = continue_crc(self.crc, writer.written().get(SESSION_LEN..).unwrap_or_default());
        }
    }
}

/// CRC-32C of a text whose first part has the checksum `crc` and whose second part is `bytes`.
fn continue_crc(crc: u32, bytes: &[u8]) -> u32 {
    // The digest wants its register before the final xor and before reflection of the output.
    let mut digest = crc32c_digest((crc ^ u32::MAX).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_settings_name_a_configuration() {
        let begin = |session, channels| ConfigHash::begin(&ConfigBegin { session, channels }).value();
        // What is left of the payload is the number of channels: one byte.
        assert_eq!(begin(0x0102, 9), crc32c(&[9]));
        assert_eq!(begin(0xFFFF, 9), crc32c(&[9]));
        assert_ne!(begin(0x0102, 9), begin(0x0102, 8));
    }

    #[test]
    fn split_text_has_the_checksum_of_the_whole() {
        let text = b"123456789";
        for cut in 0..=text.len() {
            let (head, tail) = text.split_at(cut);
            assert_eq!(continue_crc(crc32c(head), tail), 0xE306_9283, "cut {cut}");
        }
    }
}
