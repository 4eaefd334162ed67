//! Keeps the bytes and ticks of a device until the log takes them.

use crate::record::{DeviceTick, Direction, WireBytes};

/// Bytes of the link, and ticks of a device that shows them. Without a log to come only the bytes are counted.
#[derive(Debug, Default)]
pub(crate) struct Tape {
    is_recording: bool,
    bytes_sent: u64,
    bytes_received: u64,
    wire: Vec<WireBytes>,
    ticks: Vec<DeviceTick>,
}

impl Tape {
    /// A tape for a log.
    pub(crate) fn recording() -> Self {
        Self { is_recording: true, ..Self::default() }
    }

    /// Takes what goes to the device.
    pub(crate) fn sent(&mut self, host_us: u64, bytes: &[u8]) {
        self.bytes_sent += bytes.len() as u64;
        self.wire(host_us, Direction::ToDevice, bytes);
    }

    /// Takes what comes from the device.
    pub(crate) fn received(&mut self, host_us: u64, bytes: &[u8]) {
        self.bytes_received += bytes.len() as u64;
        self.wire(host_us, Direction::ToHost, bytes);
    }

    fn wire(&mut self, host_us: u64, direction: Direction, bytes: &[u8]) {
        if self.is_recording && !bytes.is_empty() {
            self.wire.push(WireBytes { host_us, direction, bytes: bytes.to_vec() });
        }
    }

    /// Takes a tick.
    pub(crate) fn tick(&mut self, tick: impl FnOnce() -> DeviceTick) {
        if self.is_recording {
            self.ticks.push(tick());
        }
    }

    /// Bytes to the device and from it, so far.
    pub(crate) fn traffic(&self) -> (u64, u64) {
        (self.bytes_sent, self.bytes_received)
    }

    /// The bytes since the last call.
    pub(crate) fn take_wire(&mut self) -> Vec<WireBytes> {
        std::mem::take(&mut self.wire)
    }

    /// The ticks since the last call, where there are at least `count`.
    pub(crate) fn take_ticks(&mut self, count: usize) -> Vec<DeviceTick> {
        if self.ticks.len() < count { Vec::new() } else { std::mem::take(&mut self.ticks) }
    }
}
