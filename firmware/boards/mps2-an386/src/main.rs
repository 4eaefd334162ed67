//! The whole model in `f32` on a Cortex-M4F: its answers and their cost.
//!
//! Prints the table of `bench`. On a computer with an operating system the same program prints the same answers: their bits must be equal.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod actuators;
mod allocations;
mod answer;
mod bench;
#[cfg(target_os = "none")]
mod board;
mod queries;
mod series;
mod tables;

use bench::Bench;

/// Puts every query; whether each was answered.
fn put_all(bench: &mut impl Bench) -> bool {
    let solved = [queries::put_all(bench), series::put_all(bench), tables::put_all(bench), allocations::put_all(bench)];
    solved.into_iter().all(|well| well)
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
