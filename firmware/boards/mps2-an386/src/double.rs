//! One product in double precision, which this processor computes in software.
//!
//! `cargo xtask model-image` looks for such arithmetic in the model's image and would not notice that it looks in vain: it must find
//! this.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;

use core::hint::black_box;

fn product() -> f64 {
    black_box(1.5_f64) * black_box(2.5_f64)
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    black_box(product());
    board::leave(true)
}

#[cfg(not(target_os = "none"))]
fn main() {
    black_box(product());
}
