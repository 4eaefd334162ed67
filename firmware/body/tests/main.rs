//! Properties and oracles of the true body.

mod laws;
mod memory;
mod motion;
mod rods;
mod statics;
