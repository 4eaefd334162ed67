//! Processors in an emulator: the images of `firmware/boards/stm32f4`, run by `qemu-system-arm`.
//!
//! [`LockStep`] runs the twin image, which is told everything over two pipes and is bound to give the bits that the controller gives
//! here. [`Flashed`] runs the very file that is flashed, and reaches it where a board would: at its serial port, at the memory that
//! its converter fills, and at what it tells its ports.

mod channels;
#[cfg(unix)]
mod elf;
#[cfg(unix)]
mod flashed;
#[cfg(not(unix))]
#[path = "unreachable.rs"]
mod flashed;
mod halt;
mod lock_step;
mod pins;
mod qemu;
#[cfg(unix)]
mod remote;

pub use channels::Pins;
pub use flashed::Flashed;
pub use halt::Halt;
pub use lock_step::{Cost, LockStep};
pub use qemu::is_installed;
