//! Port and clock of the link, simulated or real.

use std::io;

/// Bytes to and from one device, and the time that goes with them.
///
/// The clock is monotonic, in us, from any epoch. A simulated transport advances its clock in [`wait_until`](Self::wait_until) and
/// nowhere else, so that a run is the same program in virtual and in real time.
pub trait Transport {
    /// The time now, us.
    fn now_us(&self) -> u64;

    /// Hands bytes to the port; returns without waiting for them to leave.
    ///
    /// # Errors
    /// What the operating system says.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Appends the bytes that have arrived; returns at once, with none if there are none.
    ///
    /// # Errors
    /// What the operating system says.
    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()>;

    /// Waits until `deadline_us`, or shorter if bytes arrive.
    fn wait_until(&mut self, deadline_us: u64);
}
