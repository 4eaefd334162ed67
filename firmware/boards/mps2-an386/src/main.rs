//! The whole model in `f32` on a Cortex-M4F: what it answers, and what each answer costs.
//!
//! Prints the table of `desk`. On a computer with an operating system the same program prints the same answers: their bits must be equal.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod actuators;
mod allocations;
mod answer;
#[cfg(target_os = "none")]
mod board;
mod desk;
mod questions;
mod series;
mod tables;

use desk::Desk;

/// Puts every question; whether each was answered.
fn put_all(desk: &mut impl Desk) -> bool {
    let solved = [questions::put_all(desk), series::put_all(desk), tables::put_all(desk), allocations::put_all(desk)];
    solved.into_iter().all(|well| well)
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
