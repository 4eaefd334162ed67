//! The controller on a Cortex-M4F: what its turns and the frames of its link cost, with nine channels that are busy.
//!
//! Prints the table of `desk`. On a computer with an operating system the same program prints the same answers: their bits must be equal.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod actuators;
mod answer;
#[cfg(target_os = "none")]
mod board;
mod desk;
mod frames;
mod rig;
mod tracked;
mod turns;
mod upload;

use desk::Desk;

/// Puts every question; whether each was answered.
fn put_all(desk: &mut impl Desk) -> bool {
    let answered = [frames::put_all(desk), tracked::put_all(desk), turns::put_all(desk)];
    answered.into_iter().all(|well| well)
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    desk::run(put_all)
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    desk::run(put_all)
}
