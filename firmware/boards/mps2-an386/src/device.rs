//! The controller on a Cortex-M4F: cost of its turns and of its frames, with nine busy channels.
//!
//! Prints the table of `bench`. On a computer with an operating system the same program prints the same answers: their bits must be equal.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod actuators;
mod answer;
mod bench;
#[cfg(target_os = "none")]
mod board;
mod fixture;
mod frames;
mod tracked;
mod turns;
mod upload;

use bench::Bench;

/// Puts every query; whether each was answered.
fn put_all(bench: &mut impl Bench) -> bool {
    let answered = [frames::put_all(bench), tracked::put_all(bench), turns::put_all(bench)];
    answered.into_iter().all(|well| well)
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    bench::run(put_all)
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    bench::run(put_all)
}
