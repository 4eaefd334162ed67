//! Hardware-independent part of the STM32F4 image: pin assignment, coil schedule, watchdog feeding, crash records and counts of serial-port
//! errors. It compiles on any computer, and its tests run there. The module `hardware` accesses the registers and compiles for the chip
//! alone.
#![cfg_attr(not(test), no_std)]

pub mod backstop;
pub mod brown_out;
pub mod exchange;
pub mod health;
pub mod log_sectors;
pub mod pins;
pub mod reception;
pub mod record;
pub mod samples;
pub mod schedule;
pub mod seal;
pub mod watchdog;

#[cfg(target_os = "none")]
pub mod hardware;
