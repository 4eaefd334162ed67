//! Everything of the image for STM32F4 that needs no register: pins, the schedule of the coils, when the watchdog is fed, what is
//! remembered over a reset, what the port received. It runs, and is tested, on any computer. What touches the chip is in `hardware`, which
//! only the chip has.
#![cfg_attr(not(test), no_std)]

pub mod backstop;
pub mod brown_out;
pub mod exchange;
pub mod health;
pub mod pins;
pub mod reception;
pub mod record;
pub mod samples;
pub mod schedule;
pub mod seal;
pub mod watchdog;

#[cfg(target_os = "none")]
pub mod hardware;
