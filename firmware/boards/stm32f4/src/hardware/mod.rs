//! Access to the chip. The one place of the workspace with unsafe code: registers, memory that the start-up leaves alone, and the
//! handler of faults, which has no stack to rely on.
#![allow(unsafe_code, reason = "addresses of registers and of the linker; each use says why it is sound")]

pub mod backstop;
pub mod clocks;
pub mod coils;
pub mod converter;
pub mod crash;
pub mod host;
pub mod image;
pub mod log_flash;
pub mod option_bytes;
pub mod ports;
pub mod receiver;
pub mod stack;
pub mod watchdog;
