//! Properties and oracles of the true body.

mod contact;
mod laws;
mod memory;
mod motion;
mod rods;
mod statics;
